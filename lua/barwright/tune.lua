-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The change of an outline of any shape that hits pitches while it moves the outline least:
--
--   min p . W p  subject to  ln f_k(x0 + p) = ln f*_k,
--
-- p the displacements of the outline's points, W the square of their size over the local width and of
-- how unevenly they run along a loop. With g_k the gradient of ln f_k at p, c_k = ln f_k - ln f*_k,
-- z_k = W^-1 g_k and G_kl = g_k . z_l, a step of sequential quadratic programming has two parts in closed
-- form: across, -sum (G^-1 c)_k z_k, to the pitches on the shortest way, and along,
-- sum (G^-1 (g . p))_k z_k - p, to the least change at the same pitches.
-- The second is taken as far as it lowers p . W p / 2 + m sum |c_k|. The cheapest change of all would be to
-- pinch the narrowest place; a point that has moved by a fifth of the width there stays where it is.
--
-- docs/theory/responsive.md, "Plate modes".
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

--- The distance from each point straight through the material to the other side of the outline, between `min`
--- and `max`.
function tune.widths(outline, min, max)
  local points, found = outline.points:totable(), {}
  local edges = {}
  local polygons, message, details = outline:polygons(1e-3 * max)
  if not polygons then return nil, message, details end
  for _, loop in ipairs(polygons) do
    local list = loop:totable()
    for i, a in ipairs(list) do edges[#edges + 1] = {a, list[i % #list + 1]} end
  end
  for _, ring in ipairs(tune.rings(outline)) do
    for i, point in ipairs(ring) do
      local a, b = points[ring[(i - 2) % #ring + 1]], points[ring[i % #ring + 1]]
      local at, best = points[point], max
      local length = math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2) + 1e-300
      local nx, ny = -(b[2] - a[2]) / length, (b[1] - a[1]) / length -- inwards
      for _, edge in ipairs(edges) do
        local ux, uy = edge[1][1] - at[1], edge[1][2] - at[2]
        local vx, vy = edge[2][1] - edge[1][1], edge[2][2] - edge[1][2]
        local across = nx * vy - ny * vx
        if across ~= 0 then
          local t, along = (ux * vy - uy * vx) / across, (ux * ny - uy * nx) / across
          if along >= 0 and along <= 1 and t > min then best = math.min(best, t) end
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
      local weight = (mean / math.min(width[a], width[b])) ^ 2
      local spring = weight * stiffness ^ 2 / length
      length = weight * length
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
  local max = 0
  for i = 1, #a do max = math.max(max, a[i][1] ^ 2 + a[i][2] ^ 2) end
  return math.sqrt(max)
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
-- pitch has to be met; below which part of the change the step along ends; rounds; smallest part of it tried.
local STRIDE, REACH, EXACT, STILL, ROUNDS, MIN = 0.08, 0.5, 1e-6, 1e-2, 80, 1 / 32
-- Several pitches count as met this near (0.2 cents) where no step leads nearer: meshes that are rebuilt on
-- the way move each by about that.
local NEARLY = 1.2e-4
-- Sets points of a trial that are beyond their move limit back to it; returns a list of them.
local function confine(try, width, part, kept)
  local list = {}
  for i = 1, #try do
    local moved, allowed = math.sqrt(try[i][1] ^ 2 + try[i][2] ^ 2), part * width[i]
    if moved > allowed and not kept[i] then
      try[i] = {try[i][1] * allowed / moved, try[i][2] * allowed / moved}
      list[#list + 1] = i
    end
  end
  return list
end

-- Takes the bar to origin + p. nil and why where the outline folds or no mesh follows.
local function take(bar, outline, origin, p)
  local to = {}
  for i = 1, #p do to[i] = {origin[i][1] + p[i][1], origin[i][2] + p[i][2]} end
  local tried, message, details = outline:with_points(to)
  if not tried then return nil, message, details end
  return bar:become(tried)
end

-- Solves a small symmetric system; nil where it is singular: pitches that no moves can part.
local function solve_small(G, b)
  local n, A = #b, {}
  for i = 1, n do
    A[i] = table.move(G[i], 1, n, 1, {})
    A[i][n + 1] = b[i]
  end
  for i = 1, n do
    if A[i][i] <= 1e-9 * G[i][i] or A[i][i] ~= A[i][i] then return nil end
    for j = i + 1, n do
      local f = A[j][i] / A[i][i]
      for k = i, n + 1 do A[j][k] = A[j][k] - f * A[i][k] end
    end
  end
  local x = {}
  for i = n, 1, -1 do
    local sum = A[i][n + 1]
    for k = i + 1, n do sum = sum - A[i][k] * x[k] end
    x[i] = sum / A[i][i]
  end
  return x
end

local function sum_of(z, factors, count)
  local found = {}
  for i = 1, count do
    found[i] = {0, 0}
    for k, factor_k in ipairs(factors) do
      found[i][1] = found[i][1] + factor_k * z[k][i][1]
      found[i][2] = found[i][2] + factor_k * z[k][i][2]
    end
  end
  return found
end

-- c of every pitch, the largest in size, the sum of sizes; nil where the modes are not there.
local function distances(bar, wanted, modes)
  if not modes then return nil end
  local c, max, sum = {}, 0, 0
  for k, mode in ipairs(modes) do
    c[k] = math.log(bar.frequencies[mode] / wanted[k])
    max, sum = math.max(max, math.abs(c[k])), sum + math.abs(c[k])
  end
  return c, max, sum
end

local function largest(list)
  local max = 0
  for _, value in ipairs(list) do max = math.max(max, math.abs(value)) end
  return max
end

-- The gradients of ln f by the points, W^-1 times them, and G.
local function slopes(bar, modes, list, count)
  local g, z, G = {}, {}, {}
  for k, mode in ipairs(modes) do
    local gradient, message, details = bar:gradient(mode)
    if not gradient then return nil, message, details end
    g[k] = gradient:totable()
    local frequency = bar.frequencies[mode]
    for i = 1, count do g[k][i] = {g[k][i][1] / frequency, g[k][i][2] / frequency} end
    z[k] = smoothed(list, g[k], count)
  end
  for k = 1, #modes do
    G[k] = {}
    for l = 1, #modes do G[k][l] = dot(g[k], z[l]) end
  end
  return g, z, G
end

-- "348.1 Hz, 960.2 Hz"
local function hertz(list)
  local words = {}
  for k, frequency in ipairs(list) do words[k] = ("%.2f Hz"):format(frequency) end
  return table.concat(words, ", ")
end

local function frequencies_of(bar, modes)
  local list = {}
  for k, mode in ipairs(modes) do list[k] = bar.frequencies[mode] end
  return list
end

--- Moves `bar` (a metallophone bar) until its modes have the frequencies `wanted`, from `outline`. `opts`: keep
--- (set of points), smooth (length), move_limit (fraction of the local width that a point may move by), choose
--- (the numbers of the modes on the bar as it is; nil: they are not there), enough (how near in ln f is near
--- enough to stop, or nil), watch (called with the bar after every round; false ends the search). Returns the
--- bar's outline, rounds.
function tune.search(bar, wanted, outline, opts)
  local count = outline.points.row_count
  local origin, now = outline.points:totable(), bar.outline.points:totable()
  local p, kept = {}, {}
  local width, unknown, because = tune.widths(outline, 0.02 * 10 * opts.smooth, 10 * opts.smooth)
  if not width then return nil, unknown, because end
  for point in pairs(opts.keep) do kept[point] = true end
  local list = measures(outline, opts.smooth, kept, width)
  for i = 1, count do p[i] = {now[i][1] - origin[i][1], now[i][2] - origin[i][2]} end
  local along = 1 -- part of the way along that was good last
  local best, nearest = nil, NEARLY -- of several pitches
  for round = 1, ROUNDS do
    local modes = opts.choose(bar)
    if not modes then
      return nil, "the modes to be tuned are no longer among those computed: give the bar more modes",
        {status = "convergence"}
    end
    local c, max, sum = distances(bar, wanted, modes)
    if opts.enough and max < opts.enough then return bar.outline, round - 1 end
    local frequencies = frequencies_of(bar, modes)
    if #modes > 1 and max < nearest then best, nearest = p, max end
    local g, z, G = slopes(bar, modes, list, count)
    if not g then return nil, z, G end
    local by_p, short = {}, {}
    for k = 1, #modes do
      by_p[k], short[k] = dot(g[k], p), math.max(-STRIDE, math.min(STRIDE, c[k]))
    end
    local projection = solve_small(G, by_p)
    local correction = projection and solve_small(G, short)
    if not correction and best then
      take(bar, outline, origin, best)
      return bar.outline, round
    elseif not correction then
      return nil, ("the outline reaches %s, not %s, with points that move by at most %.4g of the local width: "
        .. "give a larger move_limit or more stages"):format(hertz(frequencies), hertz(wanted), opts.move_limit),
        {status = "infeasible", frequency = frequencies[1], frequencies = frequencies}
    end
    local size, rest, across = measured(list, p), sum_of(z, projection, count), sum_of(z, correction, count)
    for i = 1, count do rest[i] = {rest[i][1] - p[i][1], rest[i][2] - p[i][2]} end
    local residual = measured(list, rest)
    if max < EXACT and residual <= STILL ^ 2 * size then return bar.outline, round - 1 end
    local reach = -math.min(1, REACH * opts.smooth / (longest(across) + 1e-300))
    local penalty = 2 * largest(projection) + 2 * largest(correction)
    local merit = size / 2 + penalty * sum
    -- not along while the pitch is far: it will be another way from there
    local part = max > STRIDE / 2 and 0
      or math.min(1, 2 * along, REACH * opts.smooth / (longest(rest) + 1e-300))
    local ok, message, details
    local confined, halted = false, {}
    for _ = 1, 16 do
      local try = combined(p, reach, across, part, rest)
      local list_of_try = confine(try, width, opts.move_limit, kept)
      for _, i in ipairs(list_of_try) do halted[i] = true end
      ok, message, details = take(bar, outline, origin, try)
      if ok then
        local _, _, off = distances(bar, wanted, opts.choose(bar))
        ok = off and (#modes == 1 and (part == 0 or #list_of_try > 0)
          or (part == 0 or #list_of_try > 0) and off < sum
          or measured(list, try) / 2 + penalty * off < merit)
      end
      if ok then
        p, confined = try, #list_of_try > 0
        for _, i in ipairs(list_of_try) do kept[i] = true end
        if part > 0 then along = part end
        break
      end
      if part > 0 then
        part = part > MIN and part / 2 or 0
      else
        reach = reach / 2
      end
    end
    if not ok then
      take(bar, outline, origin, best or p)
      if best then return bar.outline, round end
      if next(halted) == nil then
        return nil, ("no step from %s towards %s was found%s"):format(hertz(frequencies), hertz(wanted),
          message and ": " .. message or ""), {status = details and details.status or "convergence",
          frequency = frequencies[1], frequencies = frequencies}
      end
      -- points at their move limit stay; the others may go on
      for i in pairs(halted) do kept[i] = true end
      confined = true
    end
    if confined then list = measures(outline, opts.smooth, kept, width) end
    if opts.watch and opts.watch(bar) == false then
      return nil, "tuning was stopped by 'watch'", {status = "cancelled"}
    end
    -- the step along is done and the pitch is met
    if not confined and part == 0 and max < EXACT then return bar.outline, round end
  end
  if best and take(bar, outline, origin, best) then return bar.outline, ROUNDS end
  local frequencies = frequencies_of(bar, opts.choose(bar) or {})
  return nil, ("the search reached %s instead of %s in %d rounds"):format(hertz(frequencies), hertz(wanted),
    ROUNDS), {status = "convergence", frequency = frequencies[1], frequencies = frequencies}
end

return tune
