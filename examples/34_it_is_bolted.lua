-- SPDX-License-Identifier: MIT
-- Lesson 29: it is bolted.
--   build/barwright examples/34_it_is_bolted.lua [FOLDER]
--
-- A steel bolt of 10 x 10 mm clamps two aluminium plates of 30 x 30 x 10 mm between head and nut. The plates
-- are pulled apart at two of their sides. When do they part, and what does the bolt carry then?
local bw = require "barwright"
local folder = arg and arg[1]

-- Regions of one mesh: each has nodes of its own. The bolt is cut in its shank, where it is tightened.
local mesh = bw.mesh.box {min = {-0.015, -0.015, -0.02}, max = {0.015, 0.015, 0.02}, cells = {6, 6, 4}}
local function shank(x, y) return math.abs(x) < 0.005 and math.abs(y) < 0.005 end
mesh = mesh:split(function(x, y, z) return z > 0 and (z > 0.01 or shank(x, y)) end, "head")
mesh = mesh:split(function(x, y, z) return z < 0 and (z < -0.01 or shank(x, y)) end, "nut")
mesh = mesh:split(function(x, y, z) return z > 0 and z < 0.01 and not shank(x, y) end, "upper")
for _, region in ipairs {"head", "nut", "upper"} do mesh = assert(mesh:separated(region)) end
local boundary = mesh.boundary
local function at(z, region) return boundary:plane({0, 0, z}, {0, 0, 1}, 1e-9) & boundary:region(region) end
local function sides(region)
  return (boundary:below("x", -0.015) | boundary:above("x", 0.015)) & boundary:region(region)
end

-- Between the plates is contact. So it is under head and nut, where nothing else holds the bolt.
local steel, aluminium = bw.material.steel, bw.material.aluminium
local part = bw.model {mesh = mesh, materials = {head = steel, nut = steel, upper = aluminium, rest = aluminium}}
part:fix(sides "rest")
local pairs = {{on = at(0, "upper"), with = at(0, "rest")}, {on = at(0.01, "head"), with = at(0.01, "upper")},
  {on = at(-0.01, "nut"), with = at(-0.01, "rest")}}
for _, pair in ipairs(pairs) do pair.friction = 0.2 end

-- First it is tightened with 10 kN. The nut stays as it was turned: from now on the shortening is given.
part:bond {a = at(0, "head"), b = at(0, "nut"), preload = 1e4}
local tight = assert(part:contact(pairs))
local turned = tight.static.bonds[1].shortening
print(tight)
print(("the shank is %.1f um shorter"):format(1e6 * turned))
part:clear_bonds():bond {a = at(0, "head"), b = at(0, "nut"), shortening = turned}

-- Then it is pulled. While the plates touch, the bolt takes a small part of the load; behind that, all of it.
local last
for _, pull in ipairs {0, 3e3, 6e3, 9e3, 12e3, 15e3} do
  part:clear_loads()
  if pull > 0 then part:load {on = sides "upper", force = {0, 0, pull}} end
  last = assert(part:contact(pairs))
  local bolt, touch = last.static.bonds[1].preload, last.pairs[1]
  print(("pulled by %2.0f kN the bolt carries %5.2f kN, the plates press with %5.2f kN on %3.0f mm2"):format(
    pull / 1e3, bolt / 1e3, touch.force[3] / 1e3, touch.area * 1e6))
  assert(math.abs(bolt - touch.force[3] - pull) < 1e-3)
end
assert(last.pairs[1].area == 0)
if folder then assert(last.static:picture(folder .. "/bolt.png")) end
