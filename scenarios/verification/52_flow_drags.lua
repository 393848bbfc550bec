-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Drags: what is reused changes no answer, moving meshes keep what is uniform, nothing breaks.
local bw = require "barwright"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Flow and heat: drags",
  text = [[A body is dragged at random in a tunnel and in a heated box, with a time step after each drag. Two
flows go the same way, one as it is by default (lagged factors, relocation, reconnecting), with its linear
tolerance at 1e-10, one with everything refactorised for the same meshes: the figure is the largest difference
of their velocities, of the largest velocity. Uniform flow on a mesh whose nodes move within it,
with the velocity of the mesh in the equations (ale) and without it, stays uniform. In the long form 10,000 drags
of any handle, also far too large: refused ones leave all as it was, nothing inverts.]]}

local function tunnel(tags)
  return assert(bw.outline {points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, tags = tags,
    holes = {bw.outline.circle {centre = {0.5, 0.5}, radius = 0.1, name = "body", tag = "body"}}})
end

local function wind(more)
  local options = {outline = tunnel {sides = {1, 3}, outlet = 2, inlet = 4}, viscosity = 5e-3, elements = 1000,
    step = 0.02, conditions = {inlet = {x = 1, y = 0}, sides = {y = 0}, body = "wall"}}
  for key, value in pairs(more) do options[key] = value end
  return assert(bw.responsive.flow(options))
end

local function box(more)
  local cold = {x = 0, y = 0, temperature = 0}
  local options = {outline = tunnel {floor = 1, others = {2, 3, 4}}, viscosity = 1e-2, diffusivity = 1e-2,
    expansion = 1, gravity = {0, -1}, elements = 1000, step = 0.1,
    conditions = {floor = {x = 0, y = 0, temperature = 1}, others = cold, body = "wall"}}
  for key, value in pairs(more) do options[key] = value end
  return assert(bw.responsive.thermal(options))
end

local function random_of(seed)
  return function()
    seed = (seed * 1103515245 + 12345) % 2147483648
    return seed / 2147483648
  end
end

local function same_answers(name, make, drags)
  local followed = make {solver = bw.solver.bicgstab {tolerance = 1e-10}}
  local rebuilt = make {max_lag = 0,
    solver = bw.solver.bicgstab {preconditioner = bw.solver.lu {full = true}, tolerance = 1e-10}}
  local random, worst, levels = random_of(5), 0, {}
  for _ = 1, drags do
    local by = {0.15 * (random() - 0.5), 0.15 * (random() - 0.5)}
    local ok = followed:drag({loop = "body"}, by)
    assert((rebuilt:drag({loop = "body"}, by) ~= nil) == (ok ~= nil))
    assert(followed:step())
    assert(rebuilt:step())
    levels[followed.reused.level] = (levels[followed.reused.level] or 0) + 1
    local difference = (followed.velocity - rebuilt.velocity):map "abs(a)"
    worst = math.max(worst, difference:max() / rebuilt.velocity:map("abs(a)"):max())
  end
  expect(worst, name .. ": reused beside from scratch")
    :below(1e-6, {how = ("%d drags: %d relocations, %d reconnections"):format(drags,
      levels.relocation or 0, levels.reconnecting or 0)})
end

local function stays_uniform(ale)
  local flow = assert(bw.responsive.flow {outline = tunnel {sides = {1, 3}, outlet = 2, inlet = 4},
    viscosity = 5e-3, elements = 600, step = 0.02, ale = ale, solver = bw.solver.bicgstab {tolerance = 1e-12},
    conditions = {inlet = {x = 1, y = 0.25}, sides = {x = 1, y = 0.25}, body = {x = 1, y = 0.25}}})
  local random, worst = random_of(9), 0
  assert(flow:settle())
  for _ = 1, 40 do
    flow:drag({loop = "body"}, {0.05 * (random() - 0.5), 0.05 * (random() - 0.5)})
    assert(flow:step())
    local velocity, pressure = flow.velocity, flow.pressure
    for i = 1, flow.node_count do
      worst = math.max(worst, math.abs(velocity[i][1] - 1), math.abs(velocity[i][2] - 0.25),
        math.abs(pressure[i]))
    end
  end
  expect(worst, ("uniform flow on a moving mesh, %s mesh velocity"):format(ale and "with" or "without"))
    :below(1e-9, {how = "40 drags"})
end

local function breaks(name, make, drags)
  local flow = make {elements = 250}
  local initial = flow.outline
  local random, done, refused, broken, quality = random_of(77), 0, 0, 0, 1
  for i = 1, drags do
    local handle = random() < 0.5 and {loop = "body"}
      or {vertex = 1 + math.floor(random() * flow.outline.edge_count)}
    local reach = random() < 0.1 and 3 or 0.1
    local before = flow.velocity:max()
    local ok, message = flow:drag(handle, {reach * (random() - 0.5), reach * (random() - 0.5)})
    if ok then
      done = done + 1
      quality = math.min(quality, flow.reused.quality or 1)
    else
      refused = refused + 1
      if type(message) ~= "string" or before ~= flow.velocity:max() then broken = broken + 1 end
    end
    local stepped = flow:step()
    local max = flow.velocity:max()
    if not stepped or max ~= max or max > 1e4 then broken = broken + 1 end
    if i % 40 == 0 then assert(flow:become(initial)) end
  end
  local how = ("%d drags done, %d refused"):format(done, refused)
  expect(broken, name .. ": states broken by random drags"):below(0, {how = how})
  expect(quality, name .. ": worst triangle after them (1: equilateral)"):above(1e-3, {how = how})
end

for _, one in ipairs {{"flow", wind}, {"thermal flow", box}} do
  local name, make = one[1], one[2]
  scenario(("What is reused changes no answer: %s"):format(name), {tags = {"slow"}},
    function() same_answers(name, make, 60) end)
  scenario(("Nothing breaks in 300 drags: %s"):format(name), {tags = {"slow"}},
    function() breaks(name, make, 300) end)
  scenario(("Nothing breaks in 10,000 drags: %s"):format(name), {tags = {"slow", "long"}, seconds = 7200},
    function() breaks(name, make, 10000) end)
end

scenario("Uniform flow on a moving mesh", {tags = {"slow"}}, function()
  stays_uniform(true)
  stays_uniform(false)
end)
