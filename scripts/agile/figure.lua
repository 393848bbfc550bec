-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Figures of rounded limbs: a list of parts, in millimetres, becomes a surface. A part is
--   {from = {x, y, z}, to = {x, y, z}, r = 3, r_to = 2}   a limb, its radius going from r to r_to
--   {from = {x, y, z}, r = 3}                             a ball
--   {chain = {{x, y, z, r}, {x, y, z, r}, ...}}           a limb along a curve through these points
--   {min = {x, y, z}, max = {x, y, z}, r = 1}            a block with edges rounded by r
--   {disc = {x, y, z}, radius = 10, height = 4, r = 1}    a disc about z, edges rounded by r
-- and may have `squash = {x, y, z}`: measured in lengths divided by these, about its middle; and
-- `round`: its own distance of rounding where it joins. Parts are joined in their order.
local bw = require "barwright"

local figure = {}

local sqrt, min, max, abs, huge = math.sqrt, math.min, math.max, math.abs, math.huge

-- Distance to a straight limb between two knots {x, y, z, r}; lengths squashed about (mx, my, mz).
local function limb_of(a, b, mx, my, mz, sx, sy, sz)
  local ax, ay, az = (a[1] - mx) / sx, (a[2] - my) / sy, (a[3] - mz) / sz
  local bx, by, bz = (b[1] - a[1]) / sx, (b[2] - a[2]) / sy, (b[3] - a[3]) / sz
  local ra, rd = a[4], b[4] - a[4]
  local square = bx * bx + by * by + bz * bz
  local per = square > 0 and 1 / square or 0
  return function(x, y, z)
    local px, py, pz = x - ax, y - ay, z - az
    local t = max(0, min(1, (px * bx + py * by + pz * bz) * per))
    local dx, dy, dz = px - t * bx, py - t * by, pz - t * bz
    return sqrt(dx * dx + dy * dy + dz * dz) - ra - t * rd
  end
end

-- Knots of a smooth curve (Catmull and Rom's) through the given ones.
local function refined(knots)
  local steps, out = 4, {knots[1]}
  for i = 1, #knots - 1 do
    local a, b = knots[i], knots[i + 1]
    local before, after = knots[i - 1] or a, knots[i + 2] or b
    for s = 1, steps do
      local t, knot = s / steps, {}
      for k = 1, 4 do
        local va, vb = (b[k] - before[k]) / 2, (after[k] - a[k]) / 2
        if k == 4 then va, vb = 0, 0 end -- radii do not overshoot
        knot[k] = (2 * t ^ 3 - 3 * t ^ 2 + 1) * a[k] + (t ^ 3 - 2 * t ^ 2 + t) * va
          + (3 * t ^ 2 - 2 * t ^ 3) * b[k] + (t ^ 3 - t ^ 2) * vb
      end
      out[#out + 1] = knot
    end
  end
  return out
end

-- The pieces of a part, each a function of the place; where it lies: `reach` around its box. `scale`
-- (nil: 1) scales what pieces say into a distance, after places were squashed about (x, y, z).
local function part_of(p)
  local sx, sy, sz = table.unpack(p.squash or {1, 1, 1})
  local thinnest, widest = min(sx, sy, sz), max(sx, sy, sz)
  if p.min then
    local r = p.r or 0
    local cx, cy, cz = (p.min[1] + p.max[1]) / 2, (p.min[2] + p.max[2]) / 2, (p.min[3] + p.max[3]) / 2
    local hx, hy, hz = (p.max[1] - p.min[1]) / 2 - r, (p.max[2] - p.min[2]) / 2 - r,
      (p.max[3] - p.min[3]) / 2 - r
    local function f(x, y, z)
      local dx, dy, dz = abs(x - cx) - hx, abs(y - cy) - hy, abs(z - cz) - hz
      local ox, oy, oz = max(dx, 0), max(dy, 0), max(dz, 0)
      return sqrt(ox * ox + oy * oy + oz * oz) + min(max(dx, dy, dz), 0) - r
    end
    return {pieces = {f}, min = p.min, max = p.max, reach = 0}
  end
  if p.disc then
    local r = p.r or 0
    local cx, cy, cz = table.unpack(p.disc)
    local radius, height = p.radius - r, p.height / 2 - r
    local function f(x, y, z)
      local dx, dy = (x - cx) / sx, (y - cy) / sy
      local side, up = sqrt(dx * dx + dy * dy) - radius, abs(z - cz) - height
      local os, ou = max(side, 0), max(up, 0)
      return sqrt(os * os + ou * ou) + min(max(side, up), 0) - r
    end
    return {pieces = {f}, min = p.disc, max = p.disc, reach = max(p.radius * widest, p.height)}
  end
  local knots = p.chain
    or {{p.from[1], p.from[2], p.from[3], p.r}, {(p.to or p.from)[1], (p.to or p.from)[2],
      (p.to or p.from)[3], p.r_to or p.r}}
  if #knots > 2 then knots = refined(knots) end
  local lower, upper, thick = {huge, huge, huge}, {-huge, -huge, -huge}, 0
  for _, knot in ipairs(knots) do
    for k = 1, 3 do
      lower[k], upper[k] = min(lower[k], knot[k]), max(upper[k], knot[k])
    end
    thick = max(thick, knot[4])
  end
  local mx, my, mz = (lower[1] + upper[1]) / 2, (lower[2] + upper[2]) / 2, (lower[3] + upper[3]) / 2
  local pieces = {}
  for i = 1, #knots - 1 do pieces[i] = limb_of(knots[i], knots[i + 1], mx, my, mz, sx, sy, sz) end
  return {pieces = pieces, x = mx, y = my, z = mz, sx = sx, sy = sy, sz = sz, scale = thinnest,
    min = lower, max = upper, reach = thick * widest}
end

local BLOCK = 6 -- mm

local function distance_to(body, pieces, x, y, z)
  local scale = body.scale
  if scale then x, y, z = (x - body.x) / body.sx, (y - body.y) / body.sy, (z - body.z) / body.sz end
  local d = pieces[1](x, y, z)
  for i = 2, #pieces do d = min(d, pieces[i](x, y, z)) end
  return scale and d * scale or d
end

-- What counts within a block around (x, y, z): a number where all of it is inside or outside, else
-- bodies with their pieces near enough to matter. Functions change by no more than 1.5 per distance.
local function block_at(bodies, x, y, z)
  local radius = 1.5 * BLOCK * sqrt(3) / 2
  local nearest, round, list = huge, 0, {}
  local found = {}
  for i, body in ipairs(bodies) do
    found[i] = {}
    for k, piece in ipairs(body.pieces) do
      found[i][k] = distance_to(body, {piece}, x, y, z)
      nearest = min(nearest, found[i][k])
    end
    round = max(round, body.round)
  end
  if nearest > radius + round then return nearest - radius end
  if nearest < -radius then return nearest + radius end
  for i, body in ipairs(bodies) do
    local near = {}
    for k, piece in ipairs(body.pieces) do
      if found[i][k] <= nearest + 2 * radius + round then near[#near + 1] = piece end
    end
    if #near > 0 then list[#list + 1] = {body = body, pieces = near, round = body.round} end
  end
  return list
end

-- Joined parts, one after the other; `before` is what is there already, or nil.
local function joined(parts, rounding, before)
  local bodies, blocks = {}, {}
  for i, p in ipairs(parts) do
    bodies[i] = part_of(p)
    bodies[i].round = p.round or rounding
  end
  return function(x, y, z)
    local i, j, k = x // BLOCK, y // BLOCK, z // BLOCK
    local key = (i * 4096 + j) * 4096 + k
    local list = blocks[key]
    if not list then
      list = block_at(bodies, (i + 0.5) * BLOCK, (j + 0.5) * BLOCK, (k + 0.5) * BLOCK)
      blocks[key] = list
    end
    local d = before and before(x, y, z) or huge
    if type(list) == "number" then return min(d, list) end
    for n = 1, #list do
      local item = list[n]
      local e, h = distance_to(item.body, item.pieces, x, y, z), item.round
      local t = h > 0 and d < huge and max(h - abs(d - e), 0) / h or 0
      d = min(d, e) - t * t * h / 4
    end
    return d
  end, bodies
end

--- A figure as a surface. about: parts; rounding, mm; cell, that of the grid, mm; cuts: parts taken
--- away; more: parts added after that.
function figure.surface(about)
  local lower, upper = {huge, huge, huge}, {-huge, -huge, -huge}
  local f, bodies = joined(about.parts, about.rounding or 0)
  for _, body in ipairs(bodies) do
    for k = 1, 3 do
      lower[k] = min(lower[k], body.min[k] - body.reach)
      upper[k] = max(upper[k], body.max[k] + body.reach)
    end
  end
  local longest = 0
  for k = 1, 3 do
    lower[k], upper[k] = lower[k] - 1.5, upper[k] + 1.5
    longest = max(longest, upper[k] - lower[k])
  end
  if about.cuts then
    local whole, tools = f, {}
    for i, p in ipairs(about.cuts) do tools[i] = part_of(p).pieces[1] end
    f = function(x, y, z)
      local d = whole(x, y, z)
      for i = 1, #tools do d = max(d, -tools[i](x, y, z)) end
      return d
    end
  end
  if about.more then f = joined(about.more, about.rounding or 0, f) end
  for k = 1, 3 do lower[k], upper[k] = lower[k] * 1e-3, upper[k] * 1e-3 end
  return bw.surface.implicit(function(x, y, z) return 1e-3 * f(1e3 * x, 1e3 * y, 1e3 * z) end,
    {min = lower, max = upper, cells = math.ceil(longest / about.cell)})
end

--- The parts with those that are named a pair twice: as they are and mirrored in y.
function figure.pairs(parts, twice)
  local function mirrored(v) return v and {v[1], -v[2], v[3]} end
  for _, p in ipairs(twice) do
    parts[#parts + 1] = p
    local other = {}
    for key, value in pairs(p) do other[key] = value end
    other.from, other.to = mirrored(p.from), mirrored(p.to)
    if p.chain then
      other.chain = {}
      for i, knot in ipairs(p.chain) do other.chain[i] = {knot[1], -knot[2], knot[3], knot[4]} end
    end
    if p.min then
      other.min, other.max = {p.min[1], -p.max[2], p.min[3]}, {p.max[1], -p.min[2], p.max[3]}
    end
    parts[#parts + 1] = other
  end
  return parts
end

return figure
