-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes docs/images/metallophone.svg: a fish, a leaf and a bone tuned to C, E and G, with their modes.
local root = arg[0]:match "^(.*)/scripts/" or "."
package.path = root .. "/scripts/metallophone/?.lua;" .. package.path
local bw = require "barwright"
local page = require "page"
local script = require "barwright.command.script"
local shapes = require "shapes"

script.read {summary = "docs/images/metallophone.svg: a fish, a leaf and a bone tuned to C, E and G"}

local images, x = {}, 0
for _, one in ipairs {{"fish", "C5"}, {"leaf", "E5"}, {"bone", "G5"}} do
  local bar = assert(bw.responsive.metallophone {outline = assert(shapes[one[1]]():scaled(0.18)),
    thickness = 0.004, material = bw.material.aluminium, elements = 150})
  assert(bar:tune(one[2]))
  local svg = page.picture(bar, one[2])
  local width = tonumber(svg:match 'width="(%d+)"')
  images[#images + 1] = svg:gsub("<svg ", ('<svg x="%d" '):format(x), 1)
  x = x + width
end
local height = 0
for _, svg in ipairs(images) do height = math.max(height, tonumber(svg:match 'height="(%d+)"')) end
local file = assert(io.open(root .. "/docs/images/metallophone.svg", "w"))
file:write(('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 %d %d">\n'):format(x, height),
  table.concat(images, "\n"), "\n</svg>\n")
file:close()
