-- SPDX-License-Identifier: MIT
-- Lesson 32: a slice of a wheel.
--   build/barwright examples/32_a_slice_of_a_wheel.lua [FOLDER]
--
-- A wheel of twelve equal sectors: a hub, a thin web and a spoke-like blade each. One sector has all of its modes.
-- Between neighbours a mode turns by a phase, which is counted by its nodal diameters.
local bw = require "barwright"
local folder = arg and arg[1]

local count, pi = 12, math.pi
local function sector(cells)
  local box = bw.mesh.box {max = {1, 1, 1}, cells = cells, order = 2}
  local places, keep, centre = {}, {}, {}
  for i, p in ipairs(box.nodes:totable()) do
    local r, angle = 0.03 + 0.12 * p[1], 2 * pi / count * (p[2] - 0.5)
    places[i] = {r * math.cos(angle), r * math.sin(angle), (p[3] - 0.5) * (p[1] < 0.25 and 0.03 or 0.008)}
    centre[i] = {p[1], p[2]}
  end
  -- Beyond the web a gap separates the blades.
  for e, row in ipairs(box.elements:totable()) do
    local x, y = 0, 0
    for k = 1, 4 do x, y = x + centre[row[k]][1] / 4, y + centre[row[k]][2] / 4 end
    keep[e] = (x < 0.5 or math.abs(y - 0.5) < 0.25) and 1 or 0
  end
  local mesh = assert(assert(box:moved(places)):subset(bw.array(keep)))
  local function cut(side)
    local angle = pi / count
    return mesh.boundary:plane({0, 0, 0}, {-math.sin(angle), side * math.cos(angle), 0}, 1e-6)
  end
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  part:fix(mesh.boundary:where(function(x, y) return x * x + y * y < 0.0301 ^ 2 end))
  return assert(part:cyclic {low = cut(-1), high = cut(1), count = count})
end

local part = sector {12, 8, 2}
print(part)
local modes = assert(part:modes {count = 12})

-- The whole wheel beside it: twelve times the elements, the same frequencies, and an estimate of their error.
local whole = assert(part:whole())
local all = assert(whole:modes {count = 12})
local cents, difference = assert(all:error_estimate()):totable(), 0
for i = 1, modes.count do
  print(("%8.1f Hz, %d nodal diameters; too high by about %.0f cents"):format(modes.frequencies[i],
    modes.nodal_diameters[i], cents[i]))
  difference = math.max(difference, math.abs(all.frequencies[i] / modes.frequencies[i] - 1))
end
print(("the whole wheel: %d nodes in place of %d; frequencies differ by at most %.1e"):format(
  whole.mesh.node_count, part.mesh.node_count, difference))
assert(difference < 1e-6)
if folder then
  local wheel = assert(modes:whole())
  for i, d in ipairs(modes.nodal_diameters) do
    if d == 3 then assert(wheel:picture(i, folder .. "/three_diameters.png")) break end
  end
end
