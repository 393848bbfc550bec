-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Free forms: outlines whose curves are uniform cubic B-splines, for shapes that a quadratic program moves.
--
-- A form is a list of loops with the material on the left, a loop a list of pieces that follow each
-- other:
--   {controls = {control, ...}, first = end, last = end, tag = name}   an open curve
--   {controls = {control, ...}, closed = true, tag = name}             a closed one, the whole loop
--   {line = true, tag = name}                                          from the piece before to the next
--   {bezier = {{at =, control =, control2 =}, ...}, tag = name}        a whole loop that stays, bit for bit
-- A curve of a single control is a vertex. An end is "clamped" (the curve ends in the control, without
-- curvature) or "axis" (on x = 0, the curve goes on as its mirror image). A control is {x, y, mode}:
-- "free" moves along the curve's normal, "x" and "y" along an axis, "fixed" not at all.
--
-- Points of the outline are linear in the controls: point = sum of {control, wx, wy}, so that
-- gradients by points become gradients by controls, and curves are smooth (C2) whatever the controls do.
local core = require "barwright.core"

local form = {}
form.__index = form

-- ---- points of the outline from controls ---------------------------------------------------------

-- The control in place k of a chain, beyond its ends too, as {{index, wx, wy}}.
local function reach(chain, k)
  local count, first = #chain.controls, chain.start
  if chain.closed then return {{first + (k - 1) % count, 1, 1}} end
  if k >= 1 and k <= count then return {{first + k - 1, 1, 1}} end
  local at_end = k < 1 and chain.first or chain.last
  local edge, inner = k < 1 and 1 or count, k < 1 and 2 or count - 1
  if at_end == "axis" then return {{first + inner - 1, -1, 1}} end
  return {{first + edge - 1, 2, 2}, {first + inner - 1, -1, -1}}
end

local function blend(chain, weights)
  local sum, order = {}, {}
  for _, one in ipairs(weights) do
    for _, term in ipairs(reach(chain, one[1])) do
      local c = term[1]
      if not sum[c] then
        sum[c] = {c, 0, 0}
        order[#order + 1] = sum[c]
      end
      sum[c][2] = sum[c][2] + one[2] * term[2]
      sum[c][3] = sum[c][3] + one[2] * term[3]
    end
  end
  return order
end

-- Place, and derivative, of parameter t in segment k (from control k to control k + 1).
local function at_parameter(chain, k, t)
  local s = 1 - t
  return blend(chain, {{k - 1, s ^ 3 / 6}, {k, (3 * t ^ 3 - 6 * t ^ 2 + 4) / 6},
    {k + 1, (3 * s ^ 3 - 6 * s ^ 2 + 4) / 6}, {k + 2, t ^ 3 / 6}}),
    blend(chain, {{k - 1, -s ^ 2 / 2}, {k, (3 * t ^ 2 - 4 * t) / 2},
      {k + 1, -(3 * s ^ 2 - 4 * s) / 2}, {k + 2, t ^ 2 / 2}})
end

local function place(self, row)
  local x, y = 0, 0
  for _, term in ipairs(row) do
    local c = self.controls[term[1]]
    x = x + term[2] * c[1]
    y = y + term[3] * c[2]
  end
  return x, y
end

local function add_chain(self, chain, segments, tag)
  local rows, count = self.rows, #chain.controls
  local first = #rows + 1
  local last = chain.closed and count or count - 1
  rows[first] = blend(chain, count == 1 and {{1, 1}} or {{0, 1 / 6}, {1, 4 / 6}, {2, 1 / 6}})
  local from = first
  for k = 1, last do
    local n = #rows
    rows[n + 1] = blend(chain, {{k, 2 / 3}, {k + 1, 1 / 3}})
    rows[n + 2] = blend(chain, {{k, 1 / 3}, {k + 1, 2 / 3}})
    local to = first
    if not (chain.closed and k == last) then
      to = n + 3
      rows[to] = blend(chain, {{k, 1 / 6}, {k + 1, 4 / 6}, {k + 2, 1 / 6}})
    end
    segments[#segments + 1] = {from, n + 1, n + 2, to, tag}
    from = to
  end
  return first, from
end

-- A loop that stays: each of its points is a control of its own that does not move.
local function add_bezier(self, piece, segments, tag)
  local function point(at)
    if not at then return 0 end
    self.controls[#self.controls + 1] = {at[1], at[2], "fixed"}
    self.rows[#self.rows + 1] = {{#self.controls, 1, 1}}
    return #self.rows
  end
  local at, first = {}, #segments
  for k, one in ipairs(piece.bezier) do at[k] = point(one.at) end
  for k, one in ipairs(piece.bezier) do
    segments[first + k] = {at[k], point(one.control), point(one.control2), at[k % #at + 1], tag}
  end
  piece.segments = table.move(segments, first + 1, #segments, 1, {})
end

-- Place, and derivative, in a segment of such a loop.
local function on_bezier(self, segment, t)
  local s = 1 - t
  local weights = segment[2] > 0 and {s ^ 3, 3 * s * s * t, 3 * s * t * t, t ^ 3} or {s, 0, 0, t}
  local slopes = segment[2] > 0 and {-s * s, s * s - 2 * s * t, 2 * s * t - t * t, t * t} or {-1, 0, 0, 1}
  local row, slope = {}, {}
  for i = 1, 4 do
    if segment[i] > 0 then
      local c = self.rows[segment[i]][1][1]
      row[#row + 1], slope[#slope + 1] = {c, weights[i], weights[i]}, {c, slopes[i], slopes[i]}
    end
  end
  return row, slope
end

--- A form of loops (copied), {{name =, hole = true, pieces...}}.
function form.create(loops)
  local self = setmetatable({loops = {}, chains = {}, controls = {}, rows = {}, segments = {},
    tags = {}}, form)
  local number = {}
  local function tag_of(piece)
    local tag = piece.tag or "free"
    if not number[tag] then
      self.tags[#self.tags + 1] = tag
      number[tag] = #self.tags
    end
    return number[tag]
  end
  self.draft_loops = {}
  for l, loop in ipairs(loops) do
    local own = {name = loop.name, hole = loop.hole}
    local ends, before = {}, #self.segments
    for i, piece in ipairs(loop) do
      if piece.line then
        own[i] = {line = true, tag = piece.tag}
      elseif piece.bezier then
        own[i] = {bezier = piece.bezier, tag = piece.tag}
      else
        local chain = {controls = {}, first = piece.first, last = piece.last, closed = piece.closed,
          tag = piece.tag, start = #self.controls + 1}
        for k, c in ipairs(piece.controls) do
          chain.controls[k] = {c[1], c[2], c[3] or "free"}
          self.controls[#self.controls + 1] = chain.controls[k]
        end
        own[i] = chain
        self.chains[#self.chains + 1] = chain
      end
    end
    -- lines need to know where the curve after them begins, so curves in advance
    local made = {}
    for i, piece in ipairs(own) do
      if piece.bezier then
        made[i] = {}
        add_bezier(self, piece, made[i], tag_of(piece))
      elseif not piece.line then
        made[i] = {}
        local from, to = add_chain(self, piece, made[i], tag_of(piece))
        ends[i] = {from, to}
      end
    end
    for i, piece in ipairs(own) do
      if piece.line then
        local previous, next_one = (i - 2) % #own + 1, i % #own + 1
        self.segments[#self.segments + 1] = {ends[previous][2], 0, 0, ends[next_one][1], tag_of(piece)}
      else
        for _, segment in ipairs(made[i]) do self.segments[#self.segments + 1] = segment end
      end
    end
    self.loops[l] = own
    self.draft_loops[l] = {count = #self.segments - before, region = loop.hole and 0 or 1,
      name = loop.name or ("loop %d"):format(l)}
  end
  return self
end

function form:copy()
  return form.create(self.loops)
end

--- Points of the outline as it stands.
function form:points()
  local list = {}
  for i, row in ipairs(self.rows) do list[i] = {place(self, row)} end
  return list
end

--- The outline; nil, message, details where it crosses itself.
function form:outline()
  local points = self:points()
  if self.made then return self.made:with_points(points) end
  local made, message, details = core.outline.make(points, self.segments, self.draft_loops, self.tags)
  self.made = made
  return made, message, details
end

-- ---- moving --------------------------------------------------------------------------------------

local function unit(x, y)
  local length = math.sqrt(x * x + y * y)
  if length == 0 then return 0, 0 end
  return x / length, y / length
end

--- Direction {x, y} in which every control moves, out of the material; {0, 0} for those that stay.
function form:directions()
  local list = {}
  for c = 1, #self.controls do list[c] = {0, 0} end
  for _, chain in ipairs(self.chains) do
    for k, c in ipairs(chain.controls) do
      local dx, dy = 0, 0
      if c[3] ~= "fixed" and #chain.controls > 1 then
        local tx, ty = place(self, blend(chain, {{k + 1, 0.5}, {k - 1, -0.5}}))
        dx, dy = unit(ty, -tx)
        if c[3] == "x" then
          dx, dy = dx < 0 and -1 or 1, 0
        elseif c[3] == "y" then
          dx, dy = 0, dy < 0 and -1 or 1
        end
      end
      list[chain.start + k - 1] = {dx, dy}
    end
  end
  return list
end

--- A gradient by points of the outline as one by moves along the directions.
function form:pull_back(gradient, directions)
  local out = {}
  for c = 1, #self.controls do out[c] = 0 end
  for i, row in ipairs(self.rows) do
    local g = gradient[i]
    for _, term in ipairs(row) do
      local d = directions[term[1]]
      out[term[1]] = out[term[1]] + g[1] * term[2] * d[1] + g[2] * term[3] * d[2]
    end
  end
  return out
end

--- Moves the controls along the directions.
function form:move(directions, step)
  for c, control in ipairs(self.controls) do
    control[1] = control[1] + step[c] * directions[c][1]
    control[2] = control[2] + step[c] * directions[c][2]
  end
end

-- ---- even spacing --------------------------------------------------------------------------------

-- The chain as a fine polygon with lengths along it.
local function trace(self, chain)
  local list, length = {}, 0
  local segments = chain.closed and #chain.controls or #chain.controls - 1
  for k = 1, segments do
    for j = k == 1 and 0 or 1, 8 do
      local x, y = place(self, (at_parameter(chain, k, j / 8)))
      local last = list[#list]
      if last then length = length + math.sqrt((x - last[1]) ^ 2 + (y - last[2]) ^ 2) end
      list[#list + 1] = {x, y, length}
    end
  end
  return list, length
end

local function along(list, length, from)
  local i = from
  while i < #list - 1 and list[i + 1][3] < length do i = i + 1 end
  local a, b = list[i], list[i + 1]
  local t = b[3] > a[3] and (length - a[3]) / (b[3] - a[3]) or 0
  return {a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])}, i
end

--- Controls of the spline through points at its knots: Gauss-Seidel, which the matrix 1 4 1 suits.
function form.through(chain, knots)
  local count = #knots
  local d = {}
  for k, q in ipairs(knots) do d[k] = {q[1], q[2], "free"} end
  local old = chain.controls
  if not chain.closed then
    for _, pair in ipairs {{1, 1, 2, chain.first}, {count, #old, #old - 1, chain.last}} do
      local k, was, inner = pair[1], pair[2], pair[3]
      d[k][3] = old[was][3]
      local next_one = k == 1 and 2 or count - 1
      d[next_one][3] = old[inner][3] == "fixed" and "free" or old[inner][3]
      if d[next_one][3] == "y" then d[next_one][1] = d[k][1] end
      if d[next_one][3] == "x" then d[next_one][2] = d[k][2] end
    end
  end
  for _ = 1, 60 do
    for k = 1, count do
      local c, q = d[k], knots[k]
      for axis = 1, 2 do
        local fixed = c[3] == "y" and axis == 1 or c[3] == "x" and axis == 2
        if chain.closed then
          c[axis] = (6 * q[axis] - d[(k - 2) % count + 1][axis] - d[k % count + 1][axis]) / 4
        elseif k > 1 and k < count then
          if not fixed then c[axis] = (6 * q[axis] - d[k - 1][axis] - d[k + 1][axis]) / 4 end
        elseif (k == 1 and chain.first or chain.last) == "axis" then
          local inner = d[k == 1 and 2 or count - 1]
          c[axis] = axis == 1 and 0 or (6 * q[2] - 2 * inner[2]) / 4
        end
      end
    end
  end
  return d
end

--- The same shape, closely, with knots at even distances of about `spacing` along every curve.
function form:respaced(spacing)
  local loops = {}
  for l, loop in ipairs(self.loops) do
    loops[l] = {name = loop.name, hole = loop.hole}
    for i, piece in ipairs(loop) do
      loops[l][i] = piece
      if piece.controls and #piece.controls > 1 then
        local list, length = trace(self, piece)
        local count = math.max(piece.closed and 8 or 4, math.floor(length / spacing + 0.5))
        local knots, from = {}, 1
        for k = 0, piece.closed and count - 1 or count do
          knots[k + 1], from = along(list, length * k / count, from)
        end
        loops[l][i] = {controls = form.through(piece, knots), first = piece.first, last = piece.last,
          closed = piece.closed, tag = piece.tag}
      end
    end
  end
  return form.create(loops)
end

-- ---- distances through material and through the void ---------------------------------------------

--- Places along the curves: {x, y, nx, ny (out of the material), row, loop}, and their mirror images
--- near x = 0 where the form has an axis.
function form:samples(mirrored)
  local list = {}
  for l, loop in ipairs(self.loops) do
    for _, chain in ipairs(loop) do
      local segments = chain.line and 0 or chain.bezier and #chain.segments
        or chain.closed and #chain.controls or #chain.controls - 1
      for k = 1, segments do
        for j = 0, 1 do
          local row, slope
          if chain.bezier then
            row, slope = on_bezier(self, chain.segments[k], j / 2)
          else
            row, slope = at_parameter(chain, k, j / 2)
          end
          local x, y = place(self, row)
          local tx, ty = unit(place(self, slope))
          list[#list + 1] = {x = x, y = y, nx = ty, ny = -tx, row = row, loop = l, sign = 1,
            chain = chain, k = k + j / 2}
        end
      end
    end
  end
  for i = 1, mirrored and #list or 0 do
    local s = list[i]
    list[#list + 1] = {x = -s.x, y = s.y, nx = -s.nx, ny = s.ny, row = s.row, loop = s.loop,
      sign = -1, chain = s.chain, k = s.k}
  end
  return list
end

--- For every sample the nearest one across the material and across the void: {distance, sample}.
function form.across(samples)
  local inner, outer = {}, {}
  for i, s in ipairs(samples) do
    if s.sign > 0 then
      local best_in, best_out = math.huge, math.huge
      for j, o in ipairs(samples) do
        local vx, vy = o.x - s.x, o.y - s.y
        local d2 = vx * vx + vy * vy
        if j ~= i and d2 > 0 and (d2 < best_in or d2 < best_out) then
          local d = math.sqrt(d2)
          local here, there = (vx * s.nx + vy * s.ny) / d, (vx * o.nx + vy * o.ny) / d
          if here < -0.75 and there > 0.5 and d2 < best_in then
            best_in = d2
            inner[i] = {math.sqrt(d2), o}
          elseif here > 0.75 and there < -0.5 and d2 < best_out then
            best_out = d2
            outer[i] = {math.sqrt(d2), o}
          end
        end
      end
    end
  end
  return inner, outer
end

-- Adds sign * (u . move of the sample) to a row over the controls.
local function add_move(out, sample, ux, uy, directions)
  for _, term in ipairs(sample.row) do
    local d = directions[term[1]]
    out[term[1]] = out[term[1]] + ux * sample.sign * term[2] * d[1] + uy * term[3] * d[2]
  end
end

--- Rows A, b of A s <= b: distances through material stay above `wall`, through the void above `gap`;
--- only those that a move of `reach` each could break. Returns the least of both too.
function form:distance_rows(samples, directions, wall, gap, reach_of)
  local inner, outer = form.across(samples)
  local A, b, thinnest, narrowest = {}, {}, math.huge, math.huge
  local list = {}
  for i in ipairs(samples) do
    if inner[i] then
      thinnest = math.min(thinnest, inner[i][1])
      list[#list + 1] = {inner[i][1] - wall, samples[i], inner[i][2], inner[i][1]}
    end
    if outer[i] then
      narrowest = math.min(narrowest, outer[i][1])
      list[#list + 1] = {outer[i][1] - gap, samples[i], outer[i][2], outer[i][1]}
    end
  end
  for _, one in ipairs(list) do
    local allowed, s, o, d = one[1], one[2], one[3], one[4]
    if allowed < 2 * reach_of then
      local row = {}
      for c = 1, #self.controls do row[c] = 0 end
      local ux, uy = (s.x - o.x) / d, (s.y - o.y) / d
      add_move(row, s, -ux, -uy, directions)
      add_move(row, o, ux, uy, directions)
      -- a place that is too thin already grows back in a few rounds
      A[#A + 1], b[#b + 1] = row, math.max(allowed, -0.5 * reach_of)
    end
  end
  return A, b, thinnest, narrowest, inner
end

return form
