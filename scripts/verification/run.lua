-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Runs the verification cases, writes docs/verification.md (or --out FILE), and exits with 1 when a
-- case is outside its tolerance.
--   build/barwright scripts/verification/run.lua [--out FILE] [--only TEXT]
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. package.path

local wish = require "arguments" {out = "value", only = "value"}
local out, only = wish.out, wish.only

local lines, failed, count = {}, 0, 0
local function write(...) lines[#lines + 1] = (...):format(select(2, ...)) end

local function number(x)
  local a = math.abs(x)
  if a ~= 0 and (a < 1e-3 or a >= 1e5) then return ("%.5e"):format(x) end
  return ("%.6g"):format(x)
end

local function show(name, rows)
  write("### %s", name)
  write ""
  write "| quantity | reference | barwright | difference | tolerance | source |"
  write "|---|---|---|---|---|---|"
  for _, row in ipairs(rows) do
    local quantity, reference, value, tolerance, source = table.unpack(row)
    local difference = (value - reference) / math.abs(reference)
    local good = math.abs(difference) <= tolerance
    count, failed = count + 1, failed + (good and 0 or 1)
    write("| %s | %s | %s | %+.3g %%%s | %g %% | %s |", quantity, number(reference), number(value),
      100 * difference, good and "" or " **outside**", 100 * tolerance, source)
    print(("%s %s: %s: %s, reference %s (%+.3g %%)"):format(good and "ok" or "OUTSIDE", name, quantity,
      number(value), number(reference), 100 * difference))
  end
  write ""
end

write "# Verification manual"
write ""
write "Made by `build/barwright scripts/verification/run.lua`; do not edit. Every row is computed when"
write "this page is made. What is only true or false (patch tests, rigid motions, symmetry, the same"
write "bits on any number of threads, agreement with CalculiX, optimality of the programmes) is in"
write "`tests/` and runs with `scripts/test`."
write ""

for _, part in ipairs {{"Statics", "statics"}, {"Natural frequencies", "modes"}} do
  write("## %s", part[1])
  write ""
  for _, case in ipairs(require(part[2])) do
    if not only or case.name:find(only, 1, true) then show(case.name, case.run()) end
  end
end

-- Orders of convergence, as the test of manufactured solutions prints them.
local test = io.open "build/tests/convergence_test_manufactured"
if test and not only then
  test:close()
  write "## Convergence"
  write ""
  write "Manufactured solutions on shaken grids (`tests/engine/convergence`): the error of a smooth field"
  write "must fall with the power of the mesh size that theory gives."
  write ""
  write "| problem | quantity | theory | measured |"
  write "|---|---|---|---|"
  local pipe = assert(io.popen "build/tests/convergence_test_manufactured 2>/dev/null")
  for line in pipe:lines() do
    local problem, quantity, theory, measured =
      line:match "^VERIFY | (.-) | (.-) | (.-) | (.-) |"
    if problem then write("| %s | %s | %s | %s |", problem, quantity, theory, measured) end
  end
  pipe:close()
  write ""
end

-- Parts that take long are made by scripts of their own, and kept.
for _, part in ipairs {"docs/verification_edit.md", "docs/verification_brute_force.md",
  "docs/verification_models.md", "docs/verification_plane.md", "docs/verification_flow.md",
  "docs/verification_nonlinear.md"} do
  local file = not only and io.open(part)
  if file then
    lines[#lines + 1] = file:read "a"
    file:close()
  end
end

print(("%d of %d within their tolerance"):format(count - failed, count))
if not only or out then
  local path = out or "docs/verification.md"
  local file = assert(io.open(path .. ".partial", "w"))
  file:write(table.concat(lines, "\n"), "\n")
  file:close()
  assert(os.rename(path .. ".partial", path))
  print("wrote " .. path)
end
os.exit(failed == 0 and 0 or 1, true)
