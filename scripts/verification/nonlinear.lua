-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Verifies nonlinear solids and writes a part of the verification manual; exits with 1 when a figure is
-- not within what is allowed.
--   build/barwright scripts/verification/nonlinear.lua [--full] [--only TEXT] [--out FILE]
-- --full: finer grids and more of them. --only: parts whose name holds the text; nothing is written then.
local bw = require "barwright"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. package.path

io.stdout:setvbuf "line"
local wish = require "arguments" {full = true, only = "value", out = "value"}
local lines, count, failed = {}, 0, 0
local function write(...) lines[#lines + 1] = (...):format(select(2, ...)) end

write "## Nonlinear solids"
write ""
write("Made by `build/barwright scripts/verification/nonlinear.lua%s`. Theory:", wish.full and " --full" or "")
write "[data_driven.md](theory/data_driven.md). The rows are those of the engine's tests, which check more than"
write "can be a row (gradients against differences, bits on any number of threads, failures); grids are the only"
write "meshes, so bodies with other sides are embedded in cells that count by the part inside."
write ""

-- Programs of the tests, which print rows: VERIFY | case | quantity | reference | figure | allowed | source
local parts = {
  {"convergence_test_hex8", "Elements", "Eight-node hexahedra with 2 × 2 × 2 points at finite strain: patch tests, and manufactured solutions with body forces by each law."},
  {"nonlinear_test_closed_forms", "Laws", "Whole solids pulled with free sides, sheared, and pressed by a pressure that follows, against the closed forms of each law."},
  {"nonlinear_test_hex8_calculix", "CalculiX", "The same displacements under tiny loads. CalculiX prints seven digits."},
  {"nonlinear_test_beams", "Slender solids", "Rods by one row of cells. An element of length l and depth t resists bending too much, by the factor 1 + (G / E)(l / t)²; the error falls with order 2."},
  {"nonlinear_test_embedded", "Cut cells", "Cook's membrane (plane strain by holding z) and a hollow sphere under inner pressure; the surface is in cells that count by the part inside."},
  {"nonlinear_test_motion", "Motion", "Implicit Euler and Newmark's average acceleration."},
}
for _, part in ipairs(parts) do
  local program, title, text = table.unpack(part)
  local file = io.open("build/tests/" .. program)
  if file and not (wish.only and not title:find(wish.only, 1, true)) then
    file:close()
    local start = bw.seconds()
    local pipe = assert(io.popen((wish.full and "BARWRIGHT_FULL=1 " or "") .. "build/tests/" .. program .. " 2>&1"))
    local rows = {}
    for line in pipe:lines() do
      local cells = {}
      if line:match "^VERIFY | " then
        for cell in line:sub(10):gmatch "[^|]+" do cells[#cells + 1] = cell:match "^%s*(.-)%s*$" end
        rows[#rows + 1] = "| " .. table.concat(cells, " | ") .. " |"
        print(rows[#rows])
      elseif line:match "%[  FAILED  %]" or line:match "%[  ERROR   %]" then
        print(line)
      end
    end
    local good = pipe:close()
    count, failed = count + #rows, failed + (good and 0 or 1)
    if #rows > 0 then
      write("### %s", title)
      write ""
      write("%s", text)
      if not good then write "\n**Some of these are outside what is allowed.**" end
      write ""
      write "| case | quantity | reference | barwright | allowed | source |"
      write "|---|---|---|---|---|---|"
      for _, row in ipairs(rows) do lines[#lines + 1] = row end
      write ""
    end
    print(("   %s took %.0f s%s"):format(title, bw.seconds() - start, good and "" or " and failed"))
  end
end

print(("%d rows, %d programs failed"):format(count, failed))
if not wish.only then
  local out = wish.out or "docs/verification_nonlinear.md"
  local file = assert(io.open(out .. ".partial", "w"))
  file:write(table.concat(lines, "\n"), "\n")
  file:close()
  assert(os.rename(out .. ".partial", out))
  print("wrote " .. out)
end
os.exit(failed == 0 and count > 0 and 0 or 1, true)
