-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A plate that is pulled, with a hole that may take any shape: for scenarios and for the quick tests.
local bw = require "barwright"
local form_of = require "barwright.free_form"

local pulled_plate = {}
local plastic = bw.material.isotropic {name = "plastic", young = 3e9, poisson = 0.35, density = 1200}

--- A form and a problem: the right half of a square plate of half width 1, pulled by sx and sy (Pa) along x
--- and y, with a round hole of so large a radius in its middle; what is free is the hole. It is fixed at the
--- axis, and along y by a short edge that carries nothing, since the forces balance.
function pulled_plate.with_hole(sx, sy, radius, over)
  local function vertex(x, y) return {controls = {{x, y, "fixed"}}} end
  local hole, count = {}, 14
  for i = 0, count do
    local angle = math.pi / 2 * (1 - 2 * i / count)
    hole[i + 1] = {radius * math.cos(angle), radius * math.sin(angle)}
  end
  for _, last in ipairs {hole[1], hole[count + 1]} do last[1], last[3] = 0, "y" end
  local form = form_of.create {{name = "plate", vertex(0, -1), {line = true, tag = "bottom"}, vertex(0.98, -1),
    {line = true, tag = "fixed"}, vertex(1, -1), {line = true, tag = "right"}, vertex(1, 1),
    {line = true, tag = "top"}, vertex(0, 1), {line = true, tag = "axis"},
    {controls = hole, first = "axis", last = "axis"}, {line = true, tag = "axis"}}}
  return form, {material = plastic, thickness = 1, limit = over * (sx + sy), wall = 0.04, gap = 0.04,
    axis = true, size = "0.008 + 0.15*max(0, sqrt(x^2 + y^2) - 0.2)", spacing = 0.035, smooth = 0.3,
    margin = 0.003, idle = 0.3, holes = 0, rounds = 90,
    conditions = {axis = {x = 0}, fixed = {y = 0}, right = {traction = {sx, 0}}, top = {traction = {0, sy}},
      bottom = {traction = {0, -sy}}}}
end

--- Half width and half height of the hole in an outline, and the least and the largest stress at its edge.
function pulled_plate.hole(sheet, outline)
  local hole = {wide = 0, high = 0, min = math.huge, max = 0}
  local mises, edges = sheet.von_mises, sheet.mesh.node_edges
  for i, at in ipairs(sheet.points:totable()) do
    if edges[i] > 0 and outline:edge(edges[i]).tag == "free" then
      hole.wide, hole.high = math.max(hole.wide, at[1]), math.max(hole.high, math.abs(at[2]))
      hole.min, hole.max = math.min(hole.min, mises[i]), math.max(hole.max, mises[i])
    end
  end
  return hole
end

return pulled_plate
