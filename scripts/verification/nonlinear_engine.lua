-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the engine's tests of nonlinear solids print: lines
--   VERIFY | case | quantity | reference | figure | allowed | source
-- of programs that fail when a figure is not within what is allowed.
local parts = {}

local function part(program, title, text)
  parts[#parts + 1] = {title = title, text = text, run = function(wish)
    local path = "build/tests/" .. program
    local there = io.open(path)
    if not there then return {{"tests that are not built: " .. program, 1, "at most", 0}} end
    there:close()
    local pipe = assert(io.popen((wish.full and "BARWRIGHT_FULL=1 " or "") .. path .. " 2>&1"))
    local rows, failed = {}, 0
    for line in pipe:lines() do
      if line:find("VERIFY | ", 1, true) == 1 then
        local cells = {}
        for cell in line:sub(10):gmatch "[^|]+" do cells[#cells + 1] = cell:match "^%s*(.-)%s*$" end
        rows[#rows + 1] = cells
      elseif line:match "^%[  FAILED  %] test" or line:match "^%[  ERROR   %] test" then
        failed = failed + 1
      end
    end
    if not pipe:close() then failed = math.max(failed, 1) end
    return {{"tests that fail", failed, "at most", 0, "`" .. path .. "`"}},
      {{heads = {"case", "quantity", "reference", "barwright", "allowed", "source"}, rows = rows}}
  end}
end

part("convergence_test_hex8", "Elements", "Hexahedra with eight nodes and 2 × 2 × 2 points at finite strain: "
  .. "patch tests, and manufactured solutions with the body forces that each law asks for.")
part("nonlinear_test_closed_forms", "Laws", "Whole solids pulled with free sides, sheared, and pressed by a "
  .. "pressure that follows.")
part("nonlinear_test_hex8_calculix", "CalculiX", "Displacements under tiny loads, where every law is linear. "
  .. "CalculiX prints seven digits. Not there where it is not installed.")
part("nonlinear_test_beams", "Slender solids", "Rods that are one row of cells, ν = 0. An element of length l and "
  .. "depth t resists bending too much, by the factor 1 + (G / E)(l / t)²: the error falls with order 2.")
part("nonlinear_test_embedded", "Cut cells", "Cook's membrane at finite strain, plane strain by holding z, beside "
  .. "quadratic elements along its sides; and a hollow sphere under a pressure inside that follows, beside the "
  .. "solution of its equation. Their sides are not the grid's.")
part("nonlinear_test_motion", "Motion", "Implicit Euler's method and Newmark's average acceleration.")

return parts
