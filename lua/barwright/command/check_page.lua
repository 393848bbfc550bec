-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The picture and the page of `barwright check`: the surface with what is marked on it.
local body_page = require "barwright.body_page"
local core = require "barwright.core"
local distance = require("barwright.points").distance
local html = require "barwright.html"

local check_page = {}

--- So many faces are listed, and drawn with their names.
check_page.MAX_FACES = 24
-- A triangle is seen where its normal has this part of its length towards the viewer.
local TOWARDS = 0.2
-- A triangle may be so many times the radius of its inner circle farther away than another one.
local WIDE = 4
-- The arms of a cross at a defect, over the diagonal of the box.
local CROSS = 0.012

-- The radius of the circle that fits into a triangle.
local function inner_radius(a, b, c, twice_area)
  return twice_area / (distance(a, b) + distance(b, c) + distance(c, a))
end

--- Of every face a label in the middle of a triangle: near the middle of what faces the viewer, and a wide one.
function check_page.face_labels(surface, picture)
  local faces, of = surface:faces()
  local view = core.picture_direction(surface, nil, picture)
  local length = math.sqrt(view[1] ^ 2 + view[2] ^ 2 + view[3] ^ 2)
  local points, seen = surface.points:totable(), {}
  for i = 1, #faces do seen[i] = {0, 0, 0, area = 0, centroids = {}} end
  for t, corners in ipairs(surface.triangles:totable()) do
    local a, b, c = points[corners[1]], points[corners[2]], points[corners[3]]
    local normal, centroid = {}, {}
    for k = 1, 3 do
      local i, j = k % 3 + 1, (k + 1) % 3 + 1
      normal[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i])
      centroid[k] = (a[k] + b[k] + c[k]) / 3
    end
    local towards = (normal[1] * view[1] + normal[2] * view[2] + normal[3] * view[3]) / length
    local size = math.sqrt(normal[1] ^ 2 + normal[2] ^ 2 + normal[3] ^ 2)
    if towards > TOWARDS * size then
      centroid.clearance = WIDE * inner_radius(a, b, c, size)
      local sum = seen[of(t, 1)]
      for k = 1, 3 do sum[k] = sum[k] + towards * centroid[k] end
      sum.area = sum.area + towards
      sum.centroids[#sum.centroids + 1] = centroid
    end
  end
  local labels = {}
  for i = 1, math.min(#seen, check_page.MAX_FACES) do
    local sum, best, min = seen[i], nil, nil
    for _, centroid in ipairs(sum.centroids) do
      local away = distance(centroid, {sum[1] / sum.area, sum[2] / sum.area, sum[3] / sum.area})
        - centroid.clearance
      if not min or away < min then best, min = centroid, away end
    end
    if best then labels[#labels + 1] = {at = best, text = faces[i].name} end
  end
  return labels
end

--- Crosses at places of a box, as lines of two points.
function check_page.crosses(places, box)
  local arm, lines = CROSS * distance(box.min, box.max), {}
  for _, at in ipairs(places) do
    for k = 1, 3 do
      local from, to = {table.unpack(at)}, {table.unpack(at)}
      from[k], to[k] = from[k] - arm, to[k] + arm
      lines[#lines + 1] = {from, to}
    end
  end
  return lines
end

--- Writes the page of a surface. marked: options of surface:picture (title, lines, line_name, labels, direction);
--- about: {head = (report_verdict.lua), answer =, callout =, tables = list of {heading, head, rows}, manifest =}.
function check_page.write(surface, path, marked, about)
  local body = {}
  for i, one in ipairs(about.tables) do
    body[i] = ("<h2>%s</h2>\n%s"):format(html.escape(one[1]), html.table(one[2], one[3]))
  end
  return body_page.write(path, nil, {surface = surface, title = marked.title, verdict = about.head,
    answer = about.answer, fields = {}, callout = about.callout, lines = marked.lines,
    line_name = marked.line_name, body = table.concat(body), manifest = about.manifest,
    view = marked.direction and function() return marked.direction end,
    picture = function(name) return surface:picture(name, marked) end})
end

return check_page
