-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Shapes of least area with known answers.
local bw = require "barwright"
local pulled_plate = require "pulled_plate"
local form_of = require "barwright.free_form"
local shape_design = require "barwright.shape_design"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Shapes of least area",
  text = [[What the search behind `bw.responsive.bridge` finds where the best shape is known.]]}

local plastic = bw.material.isotropic {name = "plastic", young = 3e9, poisson = 0.35, density = 1200}

-- A strip pulled at its right end, fixed at x = 0; its upper edge is free, width w at both ends.
local function strip(width, bulge)
  local top = {}
  for i = 0, 10 do
    local x = 0.4 * (1 - i / 10)
    top[i + 1] = {x, width + bulge * math.sin(math.pi * x / 0.4) ^ 2, "free"}
  end
  top[1][3], top[11][3] = "fixed", "y"
  return form_of.create {{name = "strip", {controls = {{0, 0, "fixed"}}}, {line = true, tag = "bottom"},
    {controls = {{0.4, 0, "fixed"}}}, {line = true, tag = "end"},
    {controls = top, first = "clamped", last = "axis"}, {line = true, tag = "wall"}}}
end

scenario("A pulled strip takes the constant width force / (thickness limit)", {tags = {"slow"}}, function(t)
  local limit = 1.02e6 -- the end pulls with 1 MPa
  local found = t:require(shape_design.search({material = plastic, thickness = 1, limit = limit, wall = 0.01,
    gap = 0.01, size = 0.012, spacing = 0.04, conditions = {wall = {x = 0}, bottom = {y = 0},
    ["end"] = {traction = {1e6, 0}}}, smooth = 0.3, margin = 0.003, idle = 0.3, holes = 0, rounds = 45},
    strip(0.05, 0.03)))
  expect(found.passes, "it passes"):is_true()
  expect(found.area, "area", "m2"):near(0.4 * 0.05 * 1e6 / limit, {relative = 0.02,
    source = "force / limit", how = "0.3 % is the margin kept from the limit"})
end)

-- Where the half beam ends above x: the only crossing of the vertical with its upper curve.
local function height_at(outline, x)
  local max = 0
  for _, polygon in ipairs(outline:polygons()) do
    local list = polygon:totable()
    for k, a in ipairs(list) do
      local b = list[k % #list + 1]
      if (a[1] > x) ~= (b[1] > x) then
        max = math.max(max, a[2] + (x - a[1]) / (b[1] - a[1]) * (b[2] - a[2]))
      end
    end
  end
  return max
end

scenario("A beam with a straight underside takes the height sqrt(6 M / limit)", {tags = {"slow"},
  about = "The right half of a beam supported at its end and loaded in its middle. Its stresses stand below the "
  .. "limit along the beam, as a place near the end, where eleven controls cannot follow the root, stands at "
  .. "it."}, function(t)
  local L, foot, pad, middle, limit = 1, 0.05, 0.06, 0.12, 30e6
  local R = limit * middle ^ 2 / (6 * L)
  local top = {}
  for i = 0, 10 do
    local x = (L + foot / 2) * (1 - i / 10)
    top[i + 1] = {x, 0.14 - 0.06 * (1 - i / 10), "free"}
  end
  top[1] = {L + foot / 2, 0.03, "fixed"}
  top[11][3] = "y"
  local function vertex(x) return {controls = {{x, 0, "fixed"}}} end
  local form = form_of.create {{name = "beam", vertex(0), {line = true, tag = "fixed"}, vertex(0.004),
    {line = true, tag = "pad"}, vertex(pad), {line = true, tag = "under"}, vertex(L - foot / 2),
    {line = true, tag = "foot"}, vertex(L + foot / 2), {line = true, tag = "end"},
    {controls = top, first = "clamped", last = "axis"}, {line = true, tag = "axis"}}}
  local found = t:require(shape_design.search({material = plastic, thickness = 1, limit = limit,
    wall = 0.02, gap = 0.02, size = 0.02, spacing = 0.1, smooth = 0.3, margin = 0.003, idle = 0.3,
    holes = 0, rounds = 40, conditions = {axis = {x = 0}, fixed = {y = 0},
      pad = {traction = {0, -R / pad}}, foot = {traction = {0, R / foot}}}}, form))
  expect(found.passes, "it passes"):is_true()
  local outline = found.form:outline()
  for i = 1, 9 do
    expect(height_at(outline, i / 10), ("height at %g"):format(i / 10), "m")
      :near(math.sqrt(6 * R * (L - i / 10) / limit), {relative = 0.08, source = "beam theory"})
  end
end)

-- In an endless plate an ellipse with its axes in the ratio of the stresses has the same stress all around,
-- sx + sy, which no hole can be below (Inglis 1913, Cherepanov 1974). With a limit of m (sx + sy), m = 1.08, other
-- ratios r = a / b pass too: at the ends of an ellipse the stresses are sy (1 + 2 r) - sx and
-- sx (1 + 2 / r) - sy, so that r lies from 2 sx / (m (sx + sy) + sy - sx) to (m (sx + sy) + sx - sy) / (2 sy).
for _, case in ipairs {{1e6, 1e6}, {3e6, 2e6}, {2e6, 1e6}} do
  local sx, sy = case[1], case[2]
  scenario(("The largest hole in a plate pulled by stresses in the ratio %g is an ellipse"):format(sx / sy),
    {tags = {"slow"}, seconds = 1800}, function(t)
    local form, problem = pulled_plate.with_hole(sx, sy, 0.12, 1.08)
    local found = t:require(shape_design.search(problem, form))
    local outline = t:require(found.form:outline())
    local hole = pulled_plate.hole(t:require(shape_design.sheet(problem, outline, problem.size)), outline)
    expect(hole.wide / hole.high,
      ("ratio of its axes, which is %g with no more than the least stress"):format(sx / sy))
      :between(2 * sx / (problem.limit + sy - sx), (problem.limit + sx - sy) / (2 * sy),
        {source = "Inglis 1913, Cherepanov 1974"})
    expect(hole.min / hole.max, "least stress at its edge over the largest"):above(0.8)
    expect(hole.max / problem.limit, "largest stress at its edge over the limit"):near(1, {relative = 0.04})
  end)
end
