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

if not json then print(("%d of %d within what is allowed"):format(count - failed, count)) end
if not only and not json then
  local file = assert(io.open(out .. ".partial", "w"))
  file:write(table.concat(lines, "\n"), "\n")
  file:close()
  assert(os.rename(out .. ".partial", out))
  print("wrote " .. out)
end
os.exit(failed == 0 and 0 or 1, true)
