-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes docs/images/bracket_faces.png and solids.png: what docs/tutorial_geometry.md says.
local bw = require "barwright"
local script = require "barwright.command.script"
local root = arg[0]:match "^(.*)/scripts/" or "."

local opts = script.read {
  summary = "docs/images/bracket_faces.png and solids.png: what docs/tutorial_geometry.md says",
  arguments = {{name = "out", type = "folder", optional = true, default = root .. "/docs/images",
    what = "the folder of the pictures"}},
}

local mm = 1e-3

local function draw(surface, path, options)
  for key, value in pairs {width = 480, height = 380} do options[key] = options[key] or value end
  assert(bw.picture(surface, path, options))
end

-- ---- the bracket, with the names of its faces ----------------------------------------------------------

local arm, wall, thick, width = 60 * mm, 50 * mm, 6 * mm, 40 * mm
local corners = {{0, 0}, {arm, 0}, {arm, thick}, {thick, thick}, {thick, wall}, {0, wall}}
local profile = assert(bw.outline {points = corners, tags = {tip = 2, back = 6}}:fillet(6 * mm, {vertices = 4}))
local drill = bw.surface.cylinder({base = {-thick, 0.7 * wall, width / 4}, axis = {3 * thick, 0, 0},
  radius = 3 * mm}):named "bolt hole"
local drills = assert(drill:linear_array {count = 2, step = {0, 0, width / 2}})
local angle = assert(bw.surface.extrude(profile, {height = width}))
local bracket = assert(angle:difference(drills))
draw(bracket, opts.out .. "/bracket_faces.png", {up = {0, 1, 0}, direction = {1, 0.9, 1.1}, width = 640,
  height = 480, labels = {{at = {arm, thick / 2, width / 2}, text = "tip"},
    {at = {thick + 1.8 * mm, thick + 1.8 * mm, 0.8 * width}, text = "fillet"},
    {at = {thick, 0.7 * wall, 0.75 * width}, text = "bolt hole"},
    {at = {arm / 2, thick / 2, width}, text = "end"}}})

-- ---- what the functions make ---------------------------------------------------------------------------

local bore = bw.outline.circle {radius = 3 * mm, tag = "bore"}
local pulley = assert(bw.outline {points = {{5 * mm, 0}, {20 * mm, 0}, {20 * mm, 3 * mm}, {14 * mm, 6 * mm},
  {20 * mm, 9 * mm}, {20 * mm, 12 * mm}, {5 * mm, 12 * mm}}, tags = {groove = {3, 4}, bore = 7}})
local tube = bw.outline.circle {radius = 4 * mm, holes = {bore}}
local square = bw.outline.rectangle {width = 30 * mm, height = 30 * mm, centre = {0, 0}, radius = 3 * mm}
local flange = assert(bw.surface.cylinder {axis = {0, 0, 6 * mm}, radius = 25 * mm, tolerance = 0.02 * mm}
  :difference(assert(bw.surface.cylinder({base = {18 * mm, 0, -mm}, axis = {0, 0, 8 * mm}, radius = 3 * mm})
    :named "bolt hole":polar_array {count = 6})))
local list = {
  {"extrude", angle, {up = {0, 1, 0}, direction = {1, 0.9, 1.1}}},
  {"revolve", assert(bw.surface.revolve(pulley, {angle = 1.5 * math.pi, tolerance = 0.02 * mm}))},
  {"sweep", assert(bw.surface.sweep(tube, {path = {{0, 0, 0}, {0, 0, 30 * mm}, {30 * mm, 0, 30 * mm},
    {30 * mm, 30 * mm, 45 * mm}}}))},
  {"loft", assert(bw.surface.loft({square, bw.outline.circle {radius = 8 * mm}}, {heights = {0, 30 * mm}}))},
  {"difference, polar_array", flange},
  {"cone, prism, torus", assert(assert(bw.surface.cone {axis = {0, 0, 20 * mm}, radius = 12 * mm,
    top_radius = 5 * mm}
    :union(bw.surface.prism {base = {0, 0, -6 * mm}, axis = {0, 0, 8 * mm}, radius = 16 * mm, sides = 6}))
    :union(bw.surface.torus {centre = {0, 0, 20 * mm}, radius = 6 * mm, tube = 2.5 * mm}))},
}
local pictures, files = {}, {}
for i, entry in ipairs(list) do
  local path = os.tmpname() .. ".png"
  local options = entry[3] or {direction = {1, -1.3, 0.9}}
  options.title = ""
  draw(entry[2], path, options)
  pictures[i], files[i] = {path = path, caption = entry[1]}, path
end
assert(bw.plot.contact_sheet({pictures = pictures, columns = 3, cell = 300}):write(opts.out .. "/solids.png"))
for _, path in ipairs(files) do os.remove(path) end
