-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Dragged sheets beside CalculiX, on the same mesh.
--
-- CalculiX makes a layer of wedges of plane elements. For plane strain (CPE3, CPE6) that is the same
-- problem. Its plane stress is not: the strain across varies from node to node of the wedges, which
-- bends them; so the plane-stress sheet is given to it as the plane strain of E (1 + 2 nu) / (1 + nu)^2
-- and nu / (1 + nu), which is the same in the plane. Sides have to be straight: wedges are integrated at
-- fewer points than curved sides ask for.
local bw = require "barwright"
local tools = require "tools"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Sheets: dragged ones beside CalculiX",
  text = [[The largest difference of a displacement relative to the largest displacement, after twelve random
drags. CalculiX prints seven digits.]]}

local YOUNG, POISSON, THICKNESS, LOAD = 3e9, 0.35, 0.004, {2e5, -7e5}

local function outline()
  local hole = {name = "hole"}
  for i = 0, 11 do
    local a = 2 * math.pi * i / 12
    hole[i + 1] = {0.03 + 0.012 * math.cos(a), 0.03 + 0.012 * math.sin(a)}
  end
  return assert(bw.outline {points = {{0, 0}, {0.1, 0}, {0.12, 0.03}, {0.1, 0.05}, {0, 0.06}},
    tags = {left = 5, tip = 3}, holes = {hole}})
end

local function solve(s, plane, order)
  local mesh, stem = s.mesh, os.tmpname()
  local deck = assert(io.open(stem .. ".inp", "w"))
  local function put(...) deck:write((...):format(select(2, ...)), "\n") end
  put "*NODE, NSET=NALL" -- it reads twenty characters of a number
  local points = mesh.points:totable()
  for i, p in ipairs(points) do put("%d, %.12g, %.12g, 0", i, p[1], p[2]) end
  put("*ELEMENT, TYPE=CPE%d, ELSET=EALL", 3 * order)
  for e, nodes in ipairs(mesh.elements:totable()) do put("%d, %s", e, table.concat(nodes, ", ")) end
  local e, nu = YOUNG, POISSON
  if plane == "stress" then e, nu = YOUNG * (1 + 2 * nu) / (1 + nu) ^ 2, nu / (1 + nu) end
  put("*MATERIAL, NAME=M\n*ELASTIC\n%.15g, %.15g", e, nu)
  put("*DENSITY\n1200\n*SOLID SECTION, ELSET=EALL, MATERIAL=M\n%.15g", THICKNESS)
  put "*BOUNDARY"
  local force = {}
  local edges = mesh.side_edges
  for i, side in ipairs(mesh.sides:totable()) do
    local tag = s.outline:edge(edges[i]).tag
    if tag == "left" then
      for _, n in ipairs(side) do put("%d, 1, 2, 0", n) end
    elseif tag == "tip" then
      local a, b = points[side[1]], points[side[2]]
      local length = math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2)
      local fraction = order == 1 and {1 / 2, 1 / 2} or {1 / 6, 1 / 6, 2 / 3}
      for k, n in ipairs(side) do
        force[n] = (force[n] or 0) + fraction[k] * length * THICKNESS
      end
    end
  end
  put "*STEP\n*STATIC\n*CLOAD"
  for n, fraction in pairs(force) do
    for k = 1, 2 do put("%d, %d, %.12g", n, k, fraction * LOAD[k]) end
  end
  put "*DLOAD\nEALL, GRAV, 9.81, 0.6, -0.8, 0\n*NODE PRINT, NSET=NALL\nU\n*END STEP"
  deck:close()
  os.execute(("OMP_NUM_THREADS=1 ccx -i '%s' >'%s.log' 2>&1"):format(stem, stem))
  local u, file = {}, io.open(stem .. ".dat")
  for line in file and file:lines() or function() end do
    local n, x, y = line:match "^%s*(%d+)%s+(%S+)%s+(%S+)%s+%S+%s*$"
    if n then u[tonumber(n)] = {tonumber(x), tonumber(y)} end
  end
  if file then file:close() end
  os.execute(("rm -f '%s' '%s'.*"):format(stem, stem))
  assert(#u == #points, "ccx did not solve the deck")
  return u
end

local function random_of(seed)
  return function()
    seed = (seed * 1103515245 + 12345) % 2147483648
    return seed / 2147483648 - 0.5
  end
end

scenario("Dragged sheets beside CalculiX", function(t)
  if not os.execute "command -v ccx >/dev/null 2>&1" then t:skip "ccx is not installed" end
  local random = random_of(7)
  for _, plane in ipairs {"stress", "strain"} do
    for order = 1, 2 do
      local s = t:require(bw.responsive.steady {outline = outline(), order = order, plane = plane,
        elements = 600, thickness = THICKNESS, material = tools.elastic(YOUNG, POISSON, 1200),
        gravity = {0.6 * 9.81, -0.8 * 9.81}, conditions = {left = "fixed", tip = {traction = LOAD}}})
      local made = 0
      while made < 12 do
        local handle = made % 2 == 0 and {loop = "hole"} or {vertex = 1 + made % 5}
        if s:drag(handle, {0.01 * random(), 0.01 * random()}) then made = made + 1 end
      end
      local top, off, own = 0, 0, s.displacement:totable()
      for n, other in ipairs(solve(s, plane, order)) do
        for k = 1, 2 do
          top = math.max(top, math.abs(own[n][k]))
          off = math.max(off, math.abs(own[n][k] - other[k]))
        end
      end
      expect(off / top, ("tri%d, plane %s, %d elements"):format(3 * order, plane, s.element_count))
        :below(1e-6, {source = "CalculiX"})
    end
  end
end)
