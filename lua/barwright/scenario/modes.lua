-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Whether two lists of modes are the same ones. A mode is known up to its sign, and of modes with one
-- frequency only the space that they span is known: so modes are put into groups of nearly equal
-- frequencies, and groups are compared by how far one space leans out of the other.
local numbers = require "barwright.scenario.numbers"

local modes = {}

-- Groups of consecutive frequencies {first, last} that are nearer than `degenerate` in either list.
local function groups_of(a, b, degenerate)
  local list, first = {}, 1
  local function apart(f, i) return math.abs(f[i + 1] - f[i]) > degenerate * math.abs(f[i + 1]) end
  for i = 1, #a do
    if i == #a or apart(a, i) and apart(b, i) then
      list[#list + 1] = {first, i}
      first = i + 1
    end
  end
  return list
end

-- Orthonormal columns that span the same space; nil where they do not span as many dimensions.
local function orthonormal(columns)
  local out = {}
  for i, column in ipairs(columns) do
    local v, before = column, column:norm()
    for _ = 1, 2 do -- twice is enough
      for _, q in ipairs(out) do v = v - q * q:dot(v) end
    end
    local length = v:norm()
    if length <= 1e-8 * before or length ~= length then return nil end
    out[i] = v * (1 / length)
  end
  return out
end

-- The root of the sum of squares of the sines between two spaces of the same dimension.
local function lean(p, q)
  local sum = 0
  for _, v in ipairs(q) do
    local rest = v
    for _, u in ipairs(p) do rest = rest - u * u:dot(v) end
    sum = sum + rest:norm() ^ 2
  end
  return math.sqrt(sum)
end

local function shapes_of(list, first, last)
  local out = {}
  for i = first, last do out[#out + 1] = list:shape(i) end
  return out
end

--- Compares modes a with modes b (objects with count, frequencies and shape(i)):
--- {frequency = largest relative difference, shape = largest lean of a group, at =, group =, message =}.
--- `last` false leaves the shapes of the last group out, which the number of modes may have cut.
function modes.compare(a, b, opts)
  local fa, fb = a.frequencies, b.frequencies
  if (fa == nil) ~= (fb == nil) then
    return {message = "modes with frequencies beside modes without: of the Laplacian, or of no known density"}
  end
  fa, fb = fa or a.eigenvalues, fb or b.eigenvalues
  local left, right = {}, {}
  for i = 1, a.count do left[i] = fa[i] end
  for i = 1, b.count do right[i] = fb[i] end
  if #left ~= #right then
    return {message = ("%d modes, %d expected"):format(#left, #right)}
  end
  local found = {frequency = 0, at = 1, shape = 0, group = {1, 1}, groups = 0}
  for i = 1, #left do
    local d = left[i] == right[i] and 0 or math.abs(left[i] - right[i]) / math.abs(right[i])
    if numbers.over(d, found.frequency) then found.frequency, found.at = d, i end
  end
  if opts.shapes == false then return found end
  local list = groups_of(left, right, opts.degenerate)
  found.groups = #list
  for g, group in ipairs(list) do
    if g == #list and opts.last == false then break end
    local p, q = shapes_of(a, group[1], group[2]), shapes_of(b, group[1], group[2])
    if p[1].row_count ~= q[1].row_count or p[1].column_count ~= q[1].column_count then
      return {message = ("shapes of %d x %d values, of %d x %d expected: modes on another mesh can be compared "
        .. "by their frequencies alone ({shapes = false})"):format(p[1].row_count, p[1].column_count,
        q[1].row_count, q[1].column_count)}
    end
    p, q = orthonormal(p), orthonormal(q)
    if not p or not q then
      return {message = ("modes %d to %d are not independent"):format(group[1], group[2])}
    end
    local sine = lean(p, q)
    if numbers.over(sine, found.shape) then
      found.shape, found.group, found.is_last = sine, group, g == #list
    end
  end
  return found
end

return modes
