-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Right halves made whole at the line x = 0: outlines, and meshes of them as bodies of a thickness.
local core = require "barwright.core"

local mirror = {}

local function key(p)
  return ("%.9e %.9e"):format(p[1] + 0.0, p[2] + 0.0)
end

local function flipped(p)
  return {p[1] == 0 and 0.0 or -p[1], p[2]}
end

-- Edges of the whole by where they begin: those of the half that are not on the axis, and their images,
-- which run the other way.
local function all_edges(outline, axis)
  local from, order = {}, {}
  local function add(edge)
    from[key(edge.from)] = edge
    order[#order + 1] = edge
  end
  for n = 1, outline.edge_count do
    local e = outline:edge(n)
    if e.tag ~= axis then
      add {from = e.from, to = e.to, control = e.control, tag = e.tag}
      add {from = flipped(e.to), to = flipped(e.from), tag = e.tag,
        control = e.control and {flipped(e.control[2]), flipped(e.control[1])}}
    end
  end
  return from, order
end

--- The outline of which the given one is the half at x >= 0; edges with the tag `axis` go.
function mirror.outline(outline, axis)
  local from, order = all_edges(outline, axis)
  local points, segments, loops, tags, number = {}, {}, {}, {}, {}
  for i, name in ipairs(outline.tags) do
    if name ~= axis then
      tags[#tags + 1] = name
      number[name] = #tags
    end
    order.last = i
  end
  for _, first in ipairs(order) do
    if not first.done then
      local start, count, edge, area = #points + 1, 0, first, 0
      while edge and not edge.done do
        edge.done = true
        count = count + 1
        points[#points + 1] = edge.from
        local at, c = #points, 0
        if edge.control then
          points[at + 1], points[at + 2] = edge.control[1], edge.control[2]
          c = at + 1
        end
        area = area + edge.from[1] * edge.to[2] - edge.from[2] * edge.to[1]
        segments[#segments + 1] = {at, c, c > 0 and c + 1 or 0, 0, number[edge.tag]}
        edge = from[key(edge.to)]
      end
      for k = #segments - count + 1, #segments do
        segments[k][4] = k < #segments and segments[k + 1][1] or start
      end
      loops[#loops + 1] = {count = count, region = area > 0 and 1 or 0,
        name = area > 0 and "bridge" or ("hole %d"):format(#loops)}
    end
  end
  return core.outline.make(points, segments, loops, tags)
end

--- The mesh (points, triangles by corners) and its image as a closed surface of a thickness.
function mirror.body(points, triangles, thickness)
  local list, flat, image = {}, #points, {}
  for i = 1, flat do list[i] = points[i] end
  for i = 1, flat do
    image[i] = points[i][1] == 0 and i or #list + 1
    if image[i] ~= i then list[image[i]] = flipped(points[i]) end
  end
  local all = {}
  for _, t in ipairs(triangles) do
    all[#all + 1] = {t[1], t[2], t[3]}
    all[#all + 1] = {image[t[1]], image[t[3]], image[t[2]]}
  end
  -- sides stand on the edges that one triangle alone has
  local count, solid, twin = #list, {}, {}
  for _, t in ipairs(all) do
    for k = 1, 3 do twin[t[k] * (count + 1) + t[k % 3 + 1]] = true end
    solid[#solid + 1] = {t[1] + count, t[2] + count, t[3] + count}
    solid[#solid + 1] = {t[1], t[3], t[2]}
  end
  for _, t in ipairs(all) do
    for k = 1, 3 do
      local a, b = t[k], t[k % 3 + 1]
      if not twin[b * (count + 1) + a] then
        solid[#solid + 1] = {a, b, b + count}
        solid[#solid + 1] = {a, b + count, a + count}
      end
    end
  end
  local corner, used, kept = {}, {}, {}
  for i = 1, count do
    corner[i] = {list[i][1], list[i][2], 0}
    corner[i + count] = {list[i][1], list[i][2], thickness}
  end
  -- mid-edge nodes are no corners of triangles
  for _, t in ipairs(solid) do
    for k = 1, 3 do
      if not used[t[k]] then
        kept[#kept + 1] = corner[t[k]]
        used[t[k]] = #kept
      end
      t[k] = used[t[k]]
    end
  end
  return core.surface.new {points = kept, triangles = solid}
end

return mirror
