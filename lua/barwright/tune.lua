-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The change of an outline of any shape that hits a pitch while it moves the outline least:
--
--   min p . W p  subject to  ln f(x0 + p) = ln f*,
--
-- p the displacements of the outline's points, W the square of their size over the local width and of
-- how unevenly they run along a loop. With g the gradient of ln f at p, c = ln f - ln f*, z = W^-1 g, a
-- step of sequential quadratic programming has two parts in closed form: across, -c z / (g . z), to the
-- pitch on the shortest way, and along, z (g . p) / (g . z) - p, to the least change at the same pitch.
-- The second is taken as far as it lowers p . W p / 2 + m |c|. The cheapest change of all would be to
-- pinch the narrowest place; a point that has moved by a fifth of the width there stays where it is.
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

-- How far it is from each point straight through the material to the other side, at most `most`.
local function widths(outline, most)
  local points, found = outline.points:totable(), {}
  local edges = {}
  local polygons, message, details = outline:polygons(1e-3 * most)
  if not polygons then return nil, message, details end
  for _, loop in ipairs(polygons) do
    local list = loop:totable()
    for i, a in ipairs(list) do edges[#edges + 1] = {a, list[i % #list + 1]} end
  end
  for _, ring in ipairs(tune.rings(outline)) do
    for i, point in ipairs(ring) do
      local a, b = points[ring[(i - 2) % #ring + 1]], points[ring[i % #ring + 1]]
      local at, best = points[point], most
      local length = math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2) + 1e-300
      local nx, ny = -(b[2] - a[2]) / length, (b[1] - a[1]) / length -- inwards
      for _, edge in ipairs(edges) do
        local ux, uy = edge[1][1] - at[1], edge[1][2] - at[2]
        local vx, vy = edge[2][1] - edge[1][1], edge[2][2] - edge[1][2]
        local across = nx * vy - ny * vx
        if across ~= 0 then
          local t, along = (ux * vy - uy * vx) / across, (ux * ny - uy * nx) / across
          if along >= 0 and along <= 1 and t > 0.02 * most then best = math.min(best, t) end
        end
      end
      found[point] = best
    end
  end
  return found
end

-- W of one direction, loop by loop: int (|p|^2 + s^2 |p'|^2) (m / w)^2 along the polygon of points, w the
-- local width and m the mean one. Points that are kept have no unknown.
local function measures(outline, stiffness, kept, width)
  local points, list, mean = outline.points:totable(), {}, 0
  for i = 1, #points do mean = mean + width[i] / #points end
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
      local dear = (mean / math.min(width[a], width[b])) ^ 2
      local spring = dear * stiffness ^ 2 / length
      length = dear * length
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

-- p . W p
local function measured(list, p)
  local sum = 0
  for _, loop in ipairs(list) do
    local l, free = loop.factor, loop.free
    for c = 1, 2 do
      for j = 1, #free do
        local column = 0
        for i = j, #free do column = column + l[i][j] * p[free[i]][c] end
        sum = sum + column * column
      end
    end
  end
  return sum
end

local function dot(a, b)
  local sum = 0
  for i = 1, #a do sum = sum + a[i][1] * b[i][1] + a[i][2] * b[i][2] end
  return sum
end

local function longest(a)
  local most = 0
  for i = 1, #a do most = math.max(most, a[i][1] ^ 2 + a[i][2] ^ 2) end
  return math.sqrt(most)
end

-- p + a s + b t
local function combined(p, a, s, b, t)
  local found = {}
  for i = 1, #p do
    found[i] = {p[i][1] + a * s[i][1] + b * t[i][1], p[i][2] + a * s[i][2] + b * t[i][2]}
  end
  return found
end

-- ---- the search ----------------------------------------------------------------------------------

-- Largest part of ln f to be gone in one step and largest move in parts of `smooth`; how exactly the
-- pitch has to be met; how little the way along may still be worth; rounds; smallest part of it tried.
local STRIDE, REACH, EXACT, STILL, ROUNDS, LEAST = 0.08, 0.5, 1e-6, 1e-2, 80, 1 / 32
-- Part of the local width that a point may move by.
local ROOM = 0.2

-- Points of a try that went beyond their room, set back to it and kept; whether there were any.
local function confine(try, width, kept)
  local any = false
  for i = 1, #try do
    local moved, room = math.sqrt(try[i][1] ^ 2 + try[i][2] ^ 2), ROOM * width[i]
    if moved > room and not kept[i] then
      try[i] = {try[i][1] * room / moved, try[i][2] * room / moved}
      kept[i] = true
      any = true
    end
  end
  return any
end

-- Takes the bar to origin + p. nil and why where the outline folds or no mesh follows.
local function take(bar, outline, origin, p)
  local to = {}
  for i = 1, #p do to[i] = {origin[i][1] + p[i][1], origin[i][2] + p[i][2]} end
  local tried, message, details = outline:with_points(to)
  if not tried then return nil, message, details end
  return bar:become(tried)
end

--- Moves `bar` (a metallophone bar) until its frequency is `wanted`, from `outline`. `wish`: keep (set
--- of points), smooth (length), watch (called with the bar after every round; false ends the search).
--- Returns the bar's outline, rounds.
function tune.search(bar, wanted, outline, wish)
  local count = outline.points.row_count
  local origin, now = outline.points:totable(), bar.outline.points:totable()
  local most = 10 * wish.smooth
  local p, kept = {}, {}
  local width, unknown, because = widths(outline, most)
  if not width then return nil, unknown, because end
  for point in pairs(wish.keep) do kept[point] = true end
  local list = measures(outline, wish.smooth, kept, width)
  for i = 1, count do p[i] = {now[i][1] - origin[i][1], now[i][2] - origin[i][2]} end
  local along = 1 -- part of the way along that was good last
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
      return nil, ("%.6g Hz is as near to %.6g Hz as the points that may move get (by a fifth of the "
        .. "width where they are)"):format(frequency, wanted), {status = "infeasible",
        frequency = frequency}
    end
    local size, rest = measured(list, p), {}
    local share = dot(g, p) / curvature
    for i = 1, count do rest[i] = {share * z[i][1] - p[i][1], share * z[i][2] - p[i][2]} end
    local worth = measured(list, rest)
    if math.abs(c) < EXACT and worth <= STILL ^ 2 * size then return bar.outline, round - 1 end
    local across = -math.max(-STRIDE, math.min(STRIDE, c)) / curvature
    across = across * math.min(1, REACH * wish.smooth / (math.abs(across) * longest(z) + 1e-300))
    local price = 2 * math.abs(share) + 2 * math.abs(across)
    local merit = size / 2 + price * math.abs(c)
    -- not along while the pitch is far: it will be another way from there
    local part = math.abs(c) > STRIDE / 2 and 0
      or math.min(1, 2 * along, REACH * wish.smooth / (longest(rest) + 1e-300))
    local fine, confined
    for _ = 1, 16 do
      local try = combined(p, across, z, part, rest)
      confined = confine(try, width, kept) or confined
      fine, message, details = take(bar, outline, origin, try)
      if fine then
        local off = math.abs(math.log(bar.frequency / wanted))
        fine = part == 0 or confined or measured(list, try) / 2 + price * off < merit
      end
      if fine then
        p = try
        if part > 0 then along = part end
        break
      end
      if part > 0 then
        part = part > LEAST and part / 2 or 0
      else
        across = across / 2
      end
    end
    if confined then list = measures(outline, wish.smooth, kept, width) end
    if not fine then
      take(bar, outline, origin, p)
      return nil, message or "no step towards the pitch was found", details
    end
    if wish.watch and wish.watch(bar) == false then return nil, "stopped", {status = "cancelled"} end
    -- nothing along is worth it any more: the last of it, and the pitch is met
    if not confined and part == 0 and math.abs(c) < EXACT then return bar.outline, round end
  end
  return nil, ("%d rounds led to %.6g Hz instead of %.6g Hz"):format(ROUNDS, bar.frequency, wanted),
    {status = "convergence", frequency = bar.frequency}
end

return tune
