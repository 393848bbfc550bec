-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bodies by formula of the sizes in table 1 of the paper worst-case, to compare weak regions with brute
-- force on.
local bw = require "barwright"
local shapes = bw.shapes

local bodies = {}

local function dumbbell()
  return shapes.join({shapes.sphere({-0.03, 0, 0}, 0.012), shapes.sphere({0.03, 0, 0}, 0.012),
    shapes.limb({-0.03, 0, 0}, {0.03, 0, 0}, 0.006)}, 0.004), {-0.05, -0.02, -0.02}, {0.05, 0.02, 0.02}
end

local function stool()
  local parts = {shapes.box({-0.03, -0.02, 0.03}, {0.03, 0.02, 0.038})}
  for _, x in ipairs {-0.025, 0.025} do
    for _, y in ipairs {-0.015, 0.015} do
      parts[#parts + 1] = shapes.limb({x, y, 0}, {x * 0.9, y * 0.9, 0.033}, 0.0035, 0.0045)
    end
  end
  return shapes.join(parts, 0.003), {-0.04, -0.03, -0.006}, {0.04, 0.03, 0.047}
end

local function hook()
  local parts = {shapes.limb({0, 0, 0}, {0, 0, 0.05}, 0.004, 0.003)}
  local last = {0, 0, 0.05}
  for step = 1, 8 do
    local a = math.pi * step / 8
    local at = {0.012 * (1 - math.cos(a)), 0, 0.05 + 0.012 * math.sin(a)}
    parts[#parts + 1] = shapes.limb(last, at, 0.003, 0.0028)
    last = at
  end
  parts[#parts + 1] = shapes.sphere({0, 0, -0.003}, 0.008)
  return shapes.join(parts, 0.0015), {-0.015, -0.015, -0.015}, {0.04, 0.015, 0.08}
end

-- Elements as in the paper's table, the shape, cells of its first surface.
bodies.list = {
  {name = "dumbbell", elements = 2723, make = dumbbell, cells = 40},
  {name = "stool", elements = 2869, make = stool, cells = 48},
  {name = "hook", elements = 5332, make = hook, cells = 64},
  {name = "opener", elements = 11020, make = shapes.opener, cells = 64},
  {name = "foal", elements = 16008, make = shapes.foal, cells = 64},
}

--- The worst case of a body by the paper's weak regions and by brute force: {seconds (of weak regions), weak,
--- brute, both, elements}.
function bodies.compare(body, elements)
  local f, min, max = body.make()
  local surface = assert(bw.surface.implicit(f, {min = min, max = max, cells = body.cells}))
  local mesh = assert(bw.mesh.fill(surface, {elements = elements or body.elements, tolerance = 0.05}))
  local part = bw.model {mesh = mesh, material = bw.material.green_state_stainless_steel}
  local load = {force = math.min(20, 0.05 * 2e5 * mesh.boundary.area), pressure = 2e5}
  local start = bw.seconds()
  local weak = assert(bw.worst_case(part, {force = load.force, pressure = load.pressure, method = "paper"}))
  local seconds = bw.seconds() - start
  local brute = assert(bw.brute_force(part, load))
  return {seconds = seconds, weak = weak, brute = brute, both = brute:compare(weak, 99.75),
    elements = mesh.element_count}
end

return bodies
