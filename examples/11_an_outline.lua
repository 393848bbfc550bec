-- SPDX-License-Identifier: MIT
-- Lesson 11: an outline, drawn, dragged, and cut.
--   build/barwright examples/11_an_outline.lua [FOLDER]
--
-- Shapes in the plane are lists of points and curves. They move by handles, are always valid, and go to
-- the cutter as SVG or DXF. Lengths in metres.
local bw = require "barwright"
local out = arg[1] or "."

-- 1. A plate with rounded corners and a bore, 80 x 50 mm. Curves are {control, control, point}.
local plate = assert(bw.outline.rectangle {
  width = 0.08, height = 0.05, radius = 0.006,
  holes = {bw.outline.circle {centre = {0.02, 0.025}, radius = 0.008, name = "bore"}},
})
plate = assert(plate:hole {name = "drop", {0.05, 0.015}, {{0.075, 0.015}, {0.065, 0.045}, {0.05, 0.035}}})
print(plate)

-- 2. Tags say later where it is fixed and loaded. Edges are found by place.
plate = assert(plate:tag("fixed", {near = {0, 0.025}}))
plate = assert(plate:tag("loaded", {near = {0.08, 0.025}}))
assert(plate:picture(out .. "/plate.png", {numbers = true}))

-- 3. Drag the bore to the right until the drop is in its way: the drag is refused, with the place, and
-- the last good outline is still there.
local moved, frames = plate, 0
while true do
  local next_one, message, details = moved:moved({loop = "bore"}, {0.001, 0})
  if not next_one then
    print(("after %d mm: %s"):format(frames, message))
    assert(details.status == "geometry" and details.x > 0.04)
    break
  end
  moved, frames = next_one, frames + 1
end
assert(moved:same_topology(plate))
assert(math.abs(moved.area - plate.area) < 1e-12)

-- 4. Pull the top edge's middle up between its ends, as one would a wire that two pins hold.
local finer = plate
for _ = 1, 4 do -- more vertices for the curve to bend in
  for edge = finer.edge_count, 1, -1 do
    local e = finer:edge(edge)
    if e.from[2] > 0.0499 and e.to[2] > 0.0499 then finer = assert(finer:split(edge)) end
  end
end
local middle = finer:nearest({0.04, 0.051}).vertex
local pulled = assert(finer:pull(middle, {0.04, 0.06}, {reach = 0.025}))
print(("pulled: %.1f mm2 more"):format((pulled.area - plate.area) * 1e6))

-- 5. To the cutter, and back from the file.
assert(pulled:write(out .. "/plate.svg"))
assert(pulled:write(out .. "/plate.dxf"))
local again = assert(bw.outline.read(out .. "/plate.dxf"))
assert(math.abs(again.area - pulled.area) < 1e-9)
