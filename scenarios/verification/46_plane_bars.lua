-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Metallophone bars of any shape beside solids of tet10: the outline extruded to a closed surface, filled
-- with tetrahedra, its free modes. The paper does not give the shapes of its figure 10; these are of
-- their size and thickness.
local bw = require "barwright"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Metallophone bars",
  text = [[Aluminium, 6 mm thick, 140 to 175 mm long. The solid is the same outline extruded, of tet10. Bars are
tuned on a mesh four times as fine as they are shown on; the solid shows how far the equations of Reissner and
Mindlin are from three dimensions.]]}

local mm = 1e-3
local THICKNESS = 6 * mm
local aluminium = bw.material.isotropic {name = "aluminium", young = 70e9, poisson = 0.33, density = 2700}

local shapes = {
  fish = function()
    return bw.outline {
      {{-40 * mm, 42 * mm}, {-75 * mm, 22 * mm}, {-80 * mm, 0}},
      {{-75 * mm, -22 * mm}, {-40 * mm, -42 * mm}, {0, -30 * mm}},
      {{25 * mm, -22 * mm}, {40 * mm, -12 * mm}, {52 * mm, -10 * mm}},
      {85 * mm, -32 * mm},
      {{72 * mm, -12 * mm}, {72 * mm, 12 * mm}, {85 * mm, 32 * mm}},
      {52 * mm, 10 * mm},
      {{40 * mm, 12 * mm}, {25 * mm, 22 * mm}, {0, 30 * mm}},
    }
  end,
  leaf = function()
    return bw.outline {
      {{-45 * mm, 45 * mm}, {-70 * mm, 12 * mm}, {-80 * mm, 4 * mm}},
      {-95 * mm, 6 * mm}, {-95 * mm, -2 * mm},
      {-78 * mm, -4 * mm},
      {{-50 * mm, -35 * mm}, {10 * mm, -45 * mm}, {80 * mm, 10 * mm}},
      {{50 * mm, 12 * mm}, {20 * mm, 45 * mm}, {-10 * mm, 36 * mm}},
    }
  end,
  star = function()
    local list = {}
    for i = 0, 9 do
      local r, a = (i % 2 == 0 and 70 or 42) * mm, math.rad(90 + 36 * i)
      list[i + 1] = {1.25 * r * math.cos(a), r * math.sin(a)}
    end
    return bw.outline.rounded {points = list, radius = 6 * mm}
  end,
}

-- The outline as a polygon whose sides are about `size` long: a bar and a solid of the same shape.
local function polygon(outline, size)
  local list = {}
  for edge = 1, outline.edge_count do
    local length, last = 0, outline:at(edge, 0)
    for i = 1, 20 do
      local p = outline:at(edge, i / 20)
      length = length + math.sqrt((p[1] - last[1]) ^ 2 + (p[2] - last[2]) ^ 2)
      last = p
    end
    local n = math.max(1, math.floor(length / size + 0.5))
    for i = 0, n - 1 do list[#list + 1] = outline:at(edge, i / n) end
  end
  return assert(bw.outline(list))
end

-- The closed surface between two copies of the outline's triangles.
local function extruded(outline, thickness, size)
  local mesh = assert(bw.plane.fill(outline, {size = size}))
  local flat, n = mesh.points:totable(), mesh.node_count
  local points, triangles = {}, {}
  for level = 0, 1 do
    for i, p in ipairs(flat) do points[n * level + i] = {p[1], p[2], (level - 0.5) * thickness} end
  end
  for _, t in ipairs(mesh.elements:totable()) do
    triangles[#triangles + 1] = {t[1], t[3], t[2]}
    triangles[#triangles + 1] = {n + t[1], n + t[2], n + t[3]}
  end
  -- sides run with the material on their left
  for _, s in ipairs(mesh.sides:totable()) do
    triangles[#triangles + 1] = {s[1], s[2], n + s[2]}
    triangles[#triangles + 1] = {s[1], n + s[2], n + s[1]}
  end
  return assert(bw.surface.new {points = points, triangles = triangles})
end

local function solid_modes(outline, size, count)
  local mesh, log = bw.mesh.fill(extruded(outline, THICKNESS, size), {order = 2, size = size})
  assert(mesh, log)
  local part = bw.model {mesh = mesh, material = aluminium}
  return assert(part:modes {count = count}).frequencies, mesh.element_count
end

local function bar_of(outline, elements, modes)
  return assert(bw.responsive.metallophone {outline = outline, material = aluminium, thickness = THICKNESS,
    elements = elements, modes = modes})
end

local names = {"fish", "leaf", "star"}

local function beside_solids(size)
  for _, name in ipairs(names) do
    local outline = polygon(assert(shapes[name]()), 4 * mm)
    local bar = bar_of(outline, 1500, 4)
    local solid, elements = solid_modes(outline, size, 4)
    for i = 1, 4 do
      expect(bar.frequencies[i], ("%s, mode %d"):format(name, i), "Hz")
        :near(solid[i], {relative = 0.01, source = ("%d tet10"):format(elements)})
    end
  end
end

-- `tune` asks the plate on a mesh four times as fine; the solid shows how far the equations of Reissner and
-- Mindlin are from three dimensions.
local function tuned(t, name, size)
  -- a larger bar, as long as bars of that pitch are
  local outline = assert(assert(shapes[name]()):scaled(name == "fish" and 1.55 or 1.7))
  local bar = bar_of(outline, 400, 1)
  local from = bar.frequency
  local done = t:require(bar:tune(523))
  expect(done.frequency, ("%s from %.1f Hz"):format(name, from), "Hz")
    :near(523, {relative = 0.000577, source = "1 cent is 0.0577 %"})
  local made = polygon(bar.outline, 4 * mm)
  local checked = bar_of(made, 1500, 1).frequency
  local solid, elements = solid_modes(made, size, 1)
  expect(1200 * math.log(checked / solid[1], 2), name .. ": the plate above the solid", "cents")
    :between(-8, 8, {source = ("%d tet10, same polygon"):format(elements)})
end

scenario("Bars beside solids", {tags = {"slow"}}, function() beside_solids(6 * mm) end)

scenario("Bars beside finer solids", {tags = {"slow", "long"}, seconds = 3600},
  function() beside_solids(3.5 * mm) end)

for _, name in ipairs(names) do
  scenario(("Tuned to C5: %s"):format(name), {tags = {"slow"}}, function(t) tuned(t, name, 6 * mm) end)
  scenario(("Tuned to C5, beside a finer solid: %s"):format(name), {tags = {"slow", "long"}, seconds = 3600},
    function(t) tuned(t, name, 4 * mm) end)
end
