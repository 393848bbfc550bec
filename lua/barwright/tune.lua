-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The change of an outline of any shape that hits a pitch while it moves the outline least:
--
--   min p . W p  subject to  ln f(x0 + p) = ln f*,
--
-- p the displacements of the outline's points, W the square of their size and of how unevenly they run
-- along a loop. Sequential quadratic programming with the one constraint has its solution in closed
-- form: with g the gradient of ln f at the last point p_k and c = ln f - ln f* there,
--
--   p_{k+1} = W^-1 g (g . p_k - c) / (g . W^-1 g).
--
-- docs/theory/responsive.md, "Plates that ring".
local tune = {}

-- ---- the measure of change -----------------------------------------------------------------------

--- Points of every loop in order, controls between their vertices: {{point numbers}}.
function tune.rings(outline)
  local found = {}
  local segments = outline.segments
  for _, loop in ipairs(outline.loops) do
    local ring = {}
    for k = loop.first, loop.first + loop.count - 1 do
      ring[#ring + 1] = segments[k][1]
      if segments[k][2] > 0 then
        ring[#ring + 1] = segments[k][2]
        ring[#ring + 1] = segments[k][3]
      end
    end
    found[#found + 1] = ring
  end
  return found
end

-- Cholesky's factor (lower, rows) of a dense matrix.
local function factor(a)
  local n = #a
  for i = 1, n do
    local row = a[i]
    for j = 1, i do
      local other, sum = a[j], row[j]
      for k = 1, j - 1 do sum = sum - row[k] * other[k] end
      row[j] = i == j and math.sqrt(sum) or sum / other[j]
    end
  end
  return a
end

local function solve(l, b)
  local n, x = #l, {}
  for i = 1, n do
    local sum = b[i]
    for k = 1, i - 1 do sum = sum - l[i][k] * x[k] end
    x[i] = sum / l[i][i]
  end
  for i = n, 1, -1 do
    local sum = x[i]
    for k = i + 1, n do sum = sum - l[k][i] * x[k] end
    x[i] = sum / l[i][i]
  end
  return x
end

-- W of one direction, loop by loop: int |p|^2 + s^2 |p'|^2 along the polygon of points. Points that are
-- kept have no unknown.
local function measures(outline, stiffness, kept)
  local points, list = outline.points, {}
  for _, ring in ipairs(tune.rings(outline)) do
    local free, place = {}, {}
    for _, point in ipairs(ring) do
      if not kept[point] then
        free[#free + 1] = point
        place[point] = #free
      end
    end
    local w = {}
    for i = 1, #free do
      w[i] = {}
      for j = 1, #free do w[i][j] = 0 end
    end
    for i = 1, #ring do
      local a, b = ring[i], ring[i % #ring + 1]
      local length = math.max(math.sqrt((points[b][1] - points[a][1]) ^ 2
        + (points[b][2] - points[a][2]) ^ 2), 1e-9)
      local spring = stiffness ^ 2 / length
      local i1, i2 = place[a], place[b]
      if i1 then w[i1][i1] = w[i1][i1] + length / 2 + spring end
      if i2 then w[i2][i2] = w[i2][i2] + length / 2 + spring end
      if i1 and i2 then
        w[i1][i2] = w[i1][i2] - spring
        w[i2][i1] = w[i2][i1] - spring
      end
    end
    list[#list + 1] = {free = free, factor = factor(w)}
  end
  return list
end

-- W^-1 g, as {x, y} by point.
local function smoothed(list, gradient, count)
  local found = {}
  for i = 1, count do found[i] = {0, 0} end
  for _, loop in ipairs(list) do
    for c = 1, 2 do
      local b = {}
      for k, point in ipairs(loop.free) do b[k] = gradient[point][c] end
      local x = solve(loop.factor, b)
      for k, point in ipairs(loop.free) do found[point][c] = x[k] end
    end
  end
  return found
end

local function dot(a, b)
  local sum = 0
  for i = 1, #a do sum = sum + a[i][1] * b[i][1] + a[i][2] * b[i][2] end
  return sum
end

-- ---- the search ----------------------------------------------------------------------------------

-- Largest part of ln f to be gone in one step, and how exactly the end has to be met.
local STRIDE, EXACT, STILL, ROUNDS = 0.08, 1e-6, 1e-3, 60

--- Moves `bar` (a metallophone bar) until its frequency is `wanted`, from `outline`. `wish`: keep (set
--- of points), smooth (length), watch (called with the bar after every round; false ends the search).
--- Returns the bar's outline, rounds.
function tune.search(bar, wanted, outline, wish)
  local count = outline.points.row_count
  local origin = outline.points:totable()
  local list = measures(outline, wish.smooth, wish.keep)
  local p = {}
  local now = bar.outline.points:totable()
  for i = 1, count do p[i] = {now[i][1] - origin[i][1], now[i][2] - origin[i][2]} end
  for round = 1, ROUNDS do
    local frequency = bar.frequency
    local c = math.log(frequency / wanted)
    local gradient, message, details = bar:gradient()
    if not gradient then return nil, message, details end
    local g = gradient:totable()
    for i = 1, count do g[i] = {g[i][1] / frequency, g[i][2] / frequency} end
    local z = smoothed(list, g, count)
    local curvature = dot(g, z)
    if curvature <= 0 then
      return nil, "the tone does not depend on the points that may move", {status = "infeasible"}
    end
    local stride = math.min(1, STRIDE / math.abs(c))
    local factor_of = (dot(g, p) - stride * c) / curvature
    local moved, size = 0, 0
    local step = {}
    for i = 1, count do
      step[i] = {z[i][1] * factor_of - p[i][1], z[i][2] * factor_of - p[i][2]}
      moved = moved + step[i][1] ^ 2 + step[i][2] ^ 2
      size = size + (p[i][1] + step[i][1]) ^ 2 + (p[i][2] + step[i][2]) ^ 2
    end
    if math.abs(c) < EXACT and moved <= STILL ^ 2 * size then return bar.outline, round - 1 end
    if size == 0 then return bar.outline, round - 1 end
    -- a step that folds the outline, or that no mesh can follow, is halved
    local part, fine = 1, nil
    for _ = 1, 8 do
      local to = {}
      for i = 1, count do
        to[i] = {origin[i][1] + p[i][1] + part * step[i][1],
          origin[i][2] + p[i][2] + part * step[i][2]}
      end
      local tried
      tried, message, details = outline:with_points(to)
      fine = tried
      if tried then fine, message, details = bar:become(tried) end
      if fine then break end
      part = part / 2
    end
    if not fine then return nil, message, details end
    if wish.watch and wish.watch(bar) == false then return nil, "stopped", {status = "cancelled"} end
    for i = 1, count do
      p[i] = {p[i][1] + part * step[i][1], p[i][2] + part * step[i][2]}
    end
  end
  return nil, ("%d rounds led to %.6g Hz instead of %.6g Hz"):format(ROUNDS, bar.frequency, wanted),
    {status = "convergence", frequency = bar.frequency}
end

return tune
