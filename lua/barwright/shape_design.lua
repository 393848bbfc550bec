-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Shapes of least area under a stress limit: the controls of a free form are moved until no smaller
-- shape nearby passes. docs/theory/responsive.md, "Bridges: shapes under a stress limit".
--
-- A round: statics of the form as it is; the p-norm N of von Mises stresses with its gradient; the largest
-- stress M = c N, c taken as it is now; then the quadratic program
--
--   min  a . s + 1/2 s . H s   such that   ln (c N / limit) + g . s <= 0,  walls, gaps, box, |s_i| <= r,
--
-- a the gradient of the area, g that of ln N, s the moves of the controls along normals.
local core = require "barwright.core"
local form_of = require "barwright.free_form"
local sheets = require "barwright.sheets"

local design = {}

-- ---- analysis of a form --------------------------------------------------------------------------

--- Statics of an outline under the problem's conditions.
function design.sheet(problem, outline, size, order)
  return sheets.steady {outline = outline, material = problem.material, size = size,
    thickness = problem.thickness, order = order or 2, conditions = problem.conditions}
end

-- The sheet goes over to the form's outline; a new one where that has another topology.
local function analyse(problem, state, form)
  local outline, message, details = form:outline()
  if not outline then return nil, message, details end
  local sheet = state.sheet
  if sheet and sheet.outline:same_topology(outline) then
    local ok
    ok, message, details = sheet:become(outline)
    if not ok then return nil, message, details end
  else
    sheet, message, details = design.sheet(problem, outline, problem.size)
    if not sheet then return nil, message, details end
    state.sheet = sheet
  end
  return {outline = outline, area = outline.area, max = sheet.von_mises:max()}
end

-- ---- one round -----------------------------------------------------------------------------------

local function dot(a, b)
  local sum = 0
  for i = 1, #a do sum = sum + a[i] * b[i] end
  return sum
end

-- Local width of the material at every control, from samples at knots.
local function widths(form, samples, inner, wall)
  local width = {}
  for c = 1, #form.controls do width[c] = 6 * wall end
  for i, found in pairs(inner) do
    local s = samples[i]
    local w = math.min(math.max(found[1], wall), 6 * wall)
    for _, term in ipairs(s.row) do
      if math.abs(term[2]) > 0.3 then width[term[1]] = math.min(width[term[1]], w) end
    end
  end
  return width
end

-- Bounds of every control's move: the trust radius, and the box.
local function bounds(problem, form, directions, radius)
  local lower, upper = {}, {}
  local box = problem.box
  for c, control in ipairs(form.controls) do
    local d = directions[c]
    local l, h = -radius, radius
    if d[1] == 0 and d[2] == 0 then l, h = 0, 0 end
    for axis = 1, 2 do
      if box and math.abs(d[axis]) > 1e-6 then
        local a = (box[1][axis] - control[axis]) / d[axis]
        local b = (box[2][axis] - control[axis]) / d[axis]
        -- what is outside comes back in steps
        l = math.max(l, math.min(math.min(a, b), radius))
        h = math.min(h, math.max(math.max(a, b), -radius))
      end
    end
    if l > h then l, h = math.min(l, h), math.min(l, h) end
    lower[c], upper[c] = l, h
  end
  return lower, upper
end

-- The moves: {s}, and the multiplier of the stress constraint.
local function program(problem, state, form, here, radius)
  local directions = form:directions()
  local scale = here.area
  local a = form:pull_back(here.outline.area_gradient:totable(), directions)
  for c = 1, #a do a[c] = a[c] / scale end
  local norms = {}
  for i, p in ipairs {state.p, 3 * state.p} do
    local norm, by_points, details = state.sheet:stress_norm(p)
    if not norm then return nil, by_points, details end
    norms[i] = form:pull_back(by_points:totable(), directions)
    for c = 1, #a do norms[i][c] = norms[i][c] / norm end
  end
  local g = norms[1]
  local samples = form:samples(problem.axis)
  local A, b, thinnest, narrowest, inner = form:distance_rows(samples, directions, problem.wall,
    problem.gap, radius)
  local width = widths(form, samples, inner, problem.wall)
  local price = state.price
  if not price then
    price = {math.max(-dot(a, g) / math.max(dot(g, g), 1e-300), 1e-3), 0}
  end
  -- The norm of members whose stress falls with their width w has the curvature p |g_i| / w_i in move i.
  local H = {}
  local n = #g
  local mean = 0
  for c = 1, n do mean = mean + math.abs(a[c]) / n end
  for c = 1, n do
    H[c] = {}
    for k = 1, n do H[c][k] = 0 end
    H[c][c] = (price[1] * math.abs(g[c]) + price[2] * 3 * math.abs(norms[2][c])) * state.p / width[c]
      + 0.05 * mean / radius
  end
  -- uneven moves of neighbours cost
  for _, chain in ipairs(form.chains) do
    local count = #chain.controls
    for k = 1, chain.closed and count or count - 1 do
      local i, j = chain.start + k - 1, chain.start + k % count
      local weight = problem.smooth * mean / radius
      H[i][i], H[j][j] = H[i][i] + weight, H[j][j] + weight
      H[i][j], H[j][i] = H[i][j] - weight, H[j][i] - weight
    end
  end
  local lower, upper = bounds(problem, form, directions, radius)
  -- Of a large excess no more is to go in one round than a part of what all moves together could do: what
  -- helps little then stays where it is.
  local rows, right = {g, norms[2]}, {}
  for i, row in ipairs(rows) do
    local can = 0
    for c = 1, n do can = can + math.max(row[c] * lower[c], row[c] * upper[c], -row[c] * lower[c], 0) end
    right[i] = math.max(-math.log(here.max / problem.limit) - problem.margin, -0.25, -0.7 * can)
  end
  for k = 1, #A do rows[k + 2], right[k + 2] = A[k], b[k] end
  -- unknowns in units of the radius
  for i = 1, n do
    for k = 1, n do H[i][k] = H[i][k] * radius * radius end
    a[i], lower[i], upper[i] = a[i] * radius, lower[i] / radius, upper[i] / radius
    for k = 1, #rows do rows[k][i] = rows[k][i] * radius end
  end
  for k = 3, #rows do
    for i = 1, n do rows[k][i] = rows[k][i] / problem.wall end
    right[k] = right[k] / problem.wall
  end
  local x, _, prices = core.quadratic_program {H = H, g = a, A = rows, b = right, min = lower,
    max = upper}
  if not x then return nil, _, prices end
  local s = x:totable()
  for c = 1, n do s[c] = s[c] * radius end
  local paid = prices:totable()
  if paid[1] + paid[2] > 0 then
    state.price = {math.min(0.5 * (price[1] + paid[1]), 10), math.min(0.5 * (price[2] + paid[2]), 10)}
  end
  return {moves = s, directions = directions, thinnest = thinnest, narrowest = narrowest}
end

-- ---- holes ---------------------------------------------------------------------------------------

local function loop_area(loop)
  local controls, sum = loop[1].controls, 0
  for i, c in ipairs(controls) do
    local d = controls[i % #controls + 1]
    sum = sum + (c[1] * d[2] - c[2] * d[1]) / 2
  end
  return math.abs(sum)
end

--- The form without holes smaller than an area; whether there were any.
function design.without_small_holes(form, min)
  local loops, gone = {}, 0
  for _, loop in ipairs(form.loops) do
    if loop.hole and loop[1].controls and loop_area(loop) < min then
      gone = gone + 1
    else
      loops[#loops + 1] = loop
    end
  end
  return gone > 0 and form_of.create(loops) or form, gone
end

--- A circle as a hole: clockwise, so that the material is on the left.
function design.circle(name, x, y, radius, count)
  local controls = {}
  -- controls of the spline lie outside of the circle that it draws
  local out = radius * 3 / (2 + math.cos(2 * math.pi / count))
  for i = 0, count - 1 do
    local a = -2 * math.pi * i / count
    controls[#controls + 1] = {x + out * math.cos(a), y + out * math.sin(a)}
  end
  return {name = name, hole = true, {controls = controls, closed = true}}
end

-- Centre and radius of the largest circle in material stressed below a part of the limit.
local function idle_circle(problem, state, form, part)
  local points, mises = state.sheet.points:totable(), state.sheet.von_mises:totable()
  local busy = form:samples(problem.axis)
  for i, s in ipairs(busy) do busy[i] = {s.x, s.y, problem.wall} end
  for _, p in ipairs(problem.stay or {}) do busy[#busy + 1] = {p[1], p[2], 2 * problem.wall} end
  for i, p in ipairs(points) do
    if mises[i] > part * problem.limit then busy[#busy + 1] = {p[1], p[2], 0} end
  end
  local best, radius = nil, 0
  for i, p in ipairs(points) do
    if mises[i] <= part * problem.limit then
      local clearance = problem.axis and p[1] - problem.wall / 2 or math.huge
      for _, q in ipairs(busy) do
        if clearance <= radius then break end
        local d = math.sqrt((p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2) - q[3]
        clearance = math.min(clearance, d)
      end
      if clearance > radius then best, radius = p, clearance end
    end
  end
  return best, radius
end

local function try_hole(problem, state, form)
  local holes, names = 0, {}
  for _, loop in ipairs(form.loops) do
    if loop.hole and loop[1].controls then holes = holes + 1 end
    if loop.name then names[loop.name] = true end
  end
  if holes >= problem.holes then return nil end
  local at, clearance = idle_circle(problem, state, form, problem.idle)
  if not at or clearance < problem.wall then return nil end
  local n = 1
  while names["hole " .. n] do n = n + 1 end
  local loops = table.move(form.loops, 1, #form.loops, 1, {})
  local radius = 0.7 * clearance
  local count = math.max(8, math.floor(2 * math.pi * radius / problem.spacing + 0.5))
  loops[#loops + 1] = design.circle("hole " .. n, at[1], at[2], radius, count)
  return form_of.create(loops)
end

-- The nearest controls of two rings: their places in the rings, and how far they are apart.
local function nearest_controls(a, b)
  local best, i, j = math.huge, nil, nil
  for k, p in ipairs(a) do
    for l, q in ipairs(b) do
      local d = math.sqrt((p[1] - q[1]) ^ 2 + (p[2] - q[2]) ^ 2)
      if d < best then best, i, j = d, k, l end
    end
  end
  return i, j, best
end

-- The largest stress at nodes within a radius of a place.
local function stress_near(state, x, y, radius)
  local max, mises = 0, state.sheet.von_mises
  for i, p in ipairs(state.sheet.points:totable()) do
    if (p[1] - x) ^ 2 + (p[2] - y) ^ 2 < radius ^ 2 then max = math.max(max, mises[i]) end
  end
  return max
end

--- The form with two holes made one: those with the thinnest wall between them that is stressed below the
--- problem's `idle` part of the limit and is no wider than `1.5 wall`. nil where there are none. Both run
--- clockwise, so that the ring of one opens into that of the other where they are nearest.
function design.merged(problem, state, form)
  local best
  for l, one in ipairs(form.loops) do
    for m = l + 1, #form.loops do
      local other = form.loops[m]
      if one.hole and other.hole and one[1].controls and other[1].controls then
        local a, b = one[1].controls, other[1].controls
        local i, j, apart = nearest_controls(a, b)
        if apart < 1.5 * problem.wall and (not best or apart < best.apart) then
          local x, y = (a[i][1] + b[j][1]) / 2, (a[i][2] + b[j][2]) / 2
          if stress_near(state, x, y, math.max(apart, problem.wall) / 2) < problem.idle * problem.limit then
            best = {l = l, m = m, i = i, j = j, apart = apart}
          end
        end
      end
    end
  end
  if not best then return nil end
  local ring = {}
  for _, part in ipairs {{form.loops[best.l][1].controls, best.i}, {form.loops[best.m][1].controls, best.j}} do
    local controls, opened = part[1], part[2]
    for k = 1, #controls - 1 do
      local c = controls[(opened + k - 1) % #controls + 1]
      ring[#ring + 1] = {c[1], c[2], c[3]}
    end
  end
  local loops = {}
  for l, loop in ipairs(form.loops) do
    if l == best.l then
      loops[#loops + 1] = {name = loop.name, hole = true, {controls = ring, closed = true}}
    elseif l ~= best.m then
      loops[#loops + 1] = loop
    end
  end
  return form_of.create(loops)
end

-- ---- the search ----------------------------------------------------------------------------------

local function restored(form, saved)
  for c, control in ipairs(form.controls) do control[1], control[2] = saved[c][1], saved[c][2] end
end

local function saved_of(form)
  local list = {}
  for c, control in ipairs(form.controls) do list[c] = {control[1], control[2]} end
  return list
end

-- Stresses above the limit cost more than the area that would take them down: a bar's area goes with 1 / limit.
-- A shape passes within this of the limit less the margin that is steered for.
local PRICE, SLACK, TIGHT = 3, 0.002, 0.003

local function merit(problem, here)
  return math.log(here.area) + PRICE * math.max(0, math.log(here.max / problem.limit) + problem.margin)
end

-- A round may be worse than the one before, but not worse than all of the last ones.
local function worst_of(list)
  return math.max(table.unpack(list))
end

--- The best so far, by area once something passes; `stalled` counts rounds without a better one.
local function keep(self)
  local problem, here, best = self.problem, self.here, self.best
  local passes = math.log(here.max / problem.limit) + problem.margin <= TIGHT
  local better = not best or passes and (not best.passes or here.area < best.area)
    or not passes and not best.passes and here.max < best.max
  self.stalled = self.stalled + 1
  if not better then return end
  if not best or not passes or not best.passes or here.area < best.area * (1 - 1e-3) then
    self.stalled = 0
  end
  self.best = {form = self.form:copy(), area = here.area, max = here.max, passes = passes}
end

-- Knots respaced, holes that closed taken out, two made one, one put in where little is stressed.
local function renew(self, may_hole)
  local problem, here = self.problem, self.here
  local fewer, gone = design.without_small_holes(self.form, problem.wall ^ 2)
  local calm = here.max < 1.1 * problem.limit and gone == 0
  local one = calm and design.merged(problem, self.state, fewer)
  local with = not one and may_hole and calm and try_hole(problem, self.state, fewer)
  for _, form in ipairs {one or with or fewer, fewer} do
    local changed = form:respaced(problem.spacing)
    local state = {p = self.state.p, price = self.state.price}
    local there = analyse(problem, state, changed)
    if there and not (form == one and there.max > 1.1 * math.max(here.max, problem.limit)) then
      self.form, self.state, self.here, self.recent = changed, state, there, {}
      return
    end
  end
end

-- Takes moves of the quadratic program, or half, a quarter ... of them. Returns the part; nothing if none will do.
local function try(self, step)
  local problem, form = self.problem, self.form
  local saved, part = saved_of(form), 1
  self.recent[#self.recent + 1] = merit(problem, self.here)
  if #self.recent > 4 then table.remove(self.recent, 1) end
  for _ = 1, 6 do
    local moves = {}
    for c = 1, #step.moves do moves[c] = part * step.moves[c] end
    form:move(step.directions, moves)
    local there = analyse(problem, self.state, form)
    if there and merit(problem, there) < worst_of(self.recent) + SLACK then return part, there end
    restored(form, saved)
    if core.interrupted() then return nil end
    part = part / 2
  end
end

-- A round from where it stands; false where there is nowhere to go.
local function advance(self, done)
  local problem, wall = self.problem, self.problem.wall
  local step = program(problem, self.state, self.form, self.here, self.radius)
  if not step then return false end
  local part, there = try(self, step)
  if core.interrupted() then return false end
  if not part then
    -- a new mesh, shorter steps
    self.refusals = self.refusals + 1
    self.radius = math.max(self.radius / 4, 0.01 * wall)
    self.state.sheet = nil
    self.here = analyse(problem, self.state, self.form)
    return self.here and self.refusals <= 4
  end
  self.refusals = 0
  if part < 1 or merit(problem, self.here) - merit(problem, there) < -0.01 then
    self.radius = math.max(self.radius * math.max(part, 0.6), 0.02 * wall)
  else
    self.radius = math.min(self.radius * 1.25, (done > 0.7 and 0.3 or 0.6) * wall)
  end
  if problem.polish or done > 0.85 then self.radius = math.min(self.radius, 0.15 * wall) end
  self.here = there
  return true
end

-- Whether the area of the best shape has come to rest: it fell by less than 1 % in the last fifth of the rounds.
local function settle(best, problem)
  local last = math.max(6, problem.rounds // 5)
  local before = best.history[#best.history - last]
  best.falling = best.passes and before and before.best_area and 1 - best.area / before.best_area or nil
  best.falling_rounds = last
  best.converged = best.falling ~= nil and best.falling < 0.01
end

--- Moves a form to least area under the problem's limit.
--- problem: material, thickness, conditions, limit (Pa), wall, gap, size (of elements), spacing (of controls),
--- box = {min, max}, axis (x = 0 mirrors), holes (at most), idle (part of the limit), rounds, smooth, margin,
--- polish (the form is nearly there). report(round, here, best) may return false to stop.
--- Returns {form, area, max, passes, rounds, history, converged, falling}: the smallest that passes, or that
--- of the least excess; `falling`: the part by which its area fell in the last rounds.
function design.search(problem, form, report)
  local self = {problem = problem, form = form, state = {p = 8}, recent = {}, stalled = 0, refusals = 0,
    radius = (problem.polish and 0.05 or 0.3) * problem.wall}
  local message, details
  self.here, message, details = analyse(problem, self.state, form)
  if not self.here then return nil, message, details end
  local history = {}
  for round = 1, problem.rounds do
    local done = round / problem.rounds
    self.state.p = problem.polish and 24 or done < 0.3 and 8 or done < 0.6 and 14 or 24
    keep(self)
    history[round] = {area = self.here.area, max = self.here.max, radius = self.radius,
      best_area = self.best.passes and self.best.area or nil}
    if report and report(round, self.here, self.best) == false or core.interrupted() then break end
    if self.stalled > 25 and done > 0.65 then break end
    if round % 8 == 0 and not problem.polish then renew(self, done < 0.6) end
    if not advance(self, done) then break end
  end
  if self.here then keep(self) end
  self.best.history, self.best.rounds = history, #history
  settle(self.best, problem)
  return self.best
end

return design
