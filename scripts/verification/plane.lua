-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Verifies the analyses in the plane and writes a part of the verification manual; exits with 1 when a
-- figure is not within what is allowed.
--   build/barwright scripts/verification/plane.lua [--full] [--only TEXT] [--json] [--out FILE]
-- --full: finer meshes and more of them. --only: parts whose name holds the text; nothing is written
-- then. --json: the rows go to standard output as one line of JSON each.
local bw = require "barwright"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. package.path

io.stdout:setvbuf "line"
local wish = require "arguments" {full = true, only = "value", json = true, out = "value"}
local out, only, json = wish.out or "docs/verification_plane.md", wish.only, wish.json

local lines, count, failed = {}, 0, 0
local function write(...) lines[#lines + 1] = (...):format(select(2, ...)) end

local function number(x)
  if x == nil then return "" end
  if math.type(x) == "integer" then return tostring(x) end
  local a = math.abs(x)
  if a ~= 0 and (a < 1e-3 or a >= 1e5) then return ("%.4e"):format(x) end
  return ("%.6g"):format(x)
end

-- A row: {quantity, reference, value, tolerance (relative), source}, or with `most` in place of a
-- reference: {quantity, most = bound, value = , source = }, which must not be above it.
local function show(name, row)
  local quantity, source, difference = row[1], row.source or row[5], ""
  local good, allowed
  local value, reference = row.value or row[3], row[2]
  if row.most then
    good, allowed, reference = value <= row.most, "at most " .. number(row.most), nil
  else
    local off = (value - reference) / math.abs(reference)
    good, allowed, difference = math.abs(off) <= row[4], ("%g %%"):format(100 * row[4]),
      ("%+.3g %%"):format(100 * off)
  end
  count, failed = count + 1, failed + (good and 0 or 1)
  if json then
    print(bw.json.encode {case = name, quantity = quantity, reference = reference, value = value,
      allowed = allowed, good = good, source = source})
    return
  end
  write("| %s | %s | %s | %s%s | %s | %s |", quantity, number(reference), number(value), difference,
    good and "" or " **outside**", allowed, source)
  print(("%s %s: %s: %s%s (%s %s)"):format(good and "ok" or "OUTSIDE", name, quantity, number(value),
    reference and (", reference %s"):format(number(reference)) or "", difference, allowed))
end

write "## Analyses in the plane"
write ""
write("Made by `build/barwright scripts/verification/plane.lua%s`. Theory: [responsive.md](theory/responsive.md).",
  wish.full and " --full" or "")
write "After any drag the answer with everything reused is that of a body made anew on the same mesh, within"
write "1e-6, for each of the elastic applications: `tests/engine/responsive/test_drags.c`."
write ""
for _, name in ipairs {"statics", "convergence", "calculix", "large", "motion", "plates", "bars"} do
  if not only or name:find(only, 1, true) then
    local start = bw.seconds()
    for _, case in ipairs(require("plane_" .. name)) do
      local rows = case.run(wish)
      if rows then
        write("### %s", case.name)
        write ""
        if case.text then write("%s\n", case.text) end
        write "| quantity | reference | barwright | difference | allowed | source |"
        write "|---|---|---|---|---|---|"
        for _, row in ipairs(rows) do show(case.name, row) end
        write ""
      end
    end
    if not json then print(("   %s took %.0f s"):format(name, bw.seconds() - start)) end
  end
end
write("%s", [[
### Shapes of least area with known answers

`tests/lua/bridge_spec.lua`: a strip pulled at its end takes the constant width force / (thickness limit) from a
bulged one, its area within 2 % (measured 1 %, of which 0.3 % is the margin kept from the limit). A beam with a
straight underside takes the height sqrt(6 M / limit), the root of the distance from its end, within 8 % at nine
places (measured 3 to 6 %: its stresses stand at 91 % of the limit along the beam, as a place near the end where
eleven controls cannot follow the root is at 99 %). The largest hole in a plate pulled along both axes by
stresses in the ratio 1, 3/2 and 2, with a limit of 1.08 times their sum, becomes an ellipse with its axes in
that ratio within 6 % (what such a limit leaves open), its edge stressed to at least 85 % of its largest stress.

### Modes of plates by ARPACK

`tests/engine/responsive/test_plate_arpack.c`: the four lowest frequencies of random curved plates, some holed,
isotropic and orthotropic, 1 and 4 mm thick, before and after a pull at the rim, within 1e-8 of what ARPACK finds
for the same matrices on a factor by UMFPACK.]])

if not json then print(("%d of %d within what is allowed"):format(count - failed, count)) end
if not only and not json then
  local file = assert(io.open(out .. ".partial", "w"))
  file:write(table.concat(lines, "\n"), "\n")
  file:close()
  assert(os.rename(out .. ".partial", out))
  print("wrote " .. out)
end
os.exit(failed == 0 and 0 or 1, true)
