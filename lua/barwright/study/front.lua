-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Vectors of costs, all to be small: which are beaten by none, ranks of fronts, crowding, hypervolume.
local core = require "barwright.core"

local raise = core.raise

local front = {}

--- Whether a is nowhere worse than b, and somewhere better.
local function dominates(a, b)
  local better = false
  for k = 1, #a do
    if a[k] > b[k] then return false end
    better = better or a[k] < b[k]
  end
  return better
end
front.dominates = dominates

local function before(costs)
  return function(i, j)
    local a, b = costs[i], costs[j]
    for k = 1, #a do
      if a[k] ~= b[k] then return a[k] < b[k] end
    end
    return i < j
  end
end

--- The numbers of those that none dominates, in order; of equal ones all. In the order of the first cost
--- only earlier ones can dominate, and of those it is enough to ask the ones that are in the front.
function front.of(costs)
  local order = {}
  for i = 1, #costs do order[i] = i end
  table.sort(order, before(costs))
  local kept = {}
  for _, i in ipairs(order) do
    local beaten = false
    for k = #kept, 1, -1 do
      if dominates(costs[kept[k]], costs[i]) then
        beaten = true
        break
      end
    end
    if not beaten then kept[#kept + 1] = i end
  end
  table.sort(kept)
  return kept
end

--- Lists of numbers, front after front (Deb et al. 2002), by a relation beats(i, j).
function front.ranks(count, beats)
  local beaten_by, over, fronts = {}, {}, {{}}
  for i = 1, count do beaten_by[i], over[i] = 0, {} end
  for i = 1, count do
    for j = i + 1, count do
      if beats(i, j) then
        beaten_by[j] = beaten_by[j] + 1
        over[i][#over[i] + 1] = j
      elseif beats(j, i) then
        beaten_by[i] = beaten_by[i] + 1
        over[j][#over[j] + 1] = i
      end
    end
  end
  for i = 1, count do
    if beaten_by[i] == 0 then fronts[1][#fronts[1] + 1] = i end
  end
  local f = 1
  while #fronts[f] > 0 do
    local after = {}
    for _, i in ipairs(fronts[f]) do
      for _, j in ipairs(over[i]) do
        beaten_by[j] = beaten_by[j] - 1
        if beaten_by[j] == 0 then after[#after + 1] = j end
      end
    end
    table.sort(after)
    f = f + 1
    fronts[f] = after
  end
  fronts[f] = nil
  return fronts
end

--- How far from its neighbours each of a front is: the sum over costs of the gap between the two beside
--- it, parts of the whole width; infinite at the ends.
function front.crowding(list, costs)
  local gap = {}
  for _, i in ipairs(list) do gap[i] = 0.0 end
  if #list == 0 then return gap end
  for k = 1, #costs[list[1]] do
    local order = table.move(list, 1, #list, 1, {})
    table.sort(order, function(i, j)
      if costs[i][k] ~= costs[j][k] then return costs[i][k] < costs[j][k] end
      return i < j
    end)
    local width = costs[order[#order]][k] - costs[order[1]][k]
    gap[order[1]], gap[order[#order]] = math.huge, math.huge
    if width > 0 and width < math.huge then
      for p = 2, #order - 1 do
        gap[order[p]] = gap[order[p]] + (costs[order[p + 1]][k] - costs[order[p - 1]][k]) / width
      end
    end
  end
  return gap
end

-- By slices along the last cost; in two dimensions a sum of rectangles.
local function volume(points, reference, m)
  if #points == 0 then return 0.0 end
  if m == 1 then
    local min = math.huge
    for _, p in ipairs(points) do min = math.min(min, p[1]) end
    return reference[1] - min
  end
  table.sort(points, function(a, b) return a[m] < b[m] end)
  local sum, slab = 0.0, {}
  for i, p in ipairs(points) do
    slab[#slab + 1] = p
    local top = points[i + 1] and points[i + 1][m] or reference[m]
    if top > p[m] then
      local copy = table.move(slab, 1, #slab, 1, {})
      sum = sum + (top - p[m]) * volume(copy, reference, m - 1)
    end
  end
  return sum
end

local function check_costs(where, list, count)
  if type(list) ~= "table" or rawlen(list) ~= count or count == 0 then
    raise(("hypervolume: %s: a list of %d numbers expected, got %s"):format(where, math.max(1, count),
      type(list) == "table" and rawlen(list) or core.got(list)))
  end
  for k = 1, count do
    local cost = rawget(list, k)
    if type(cost) ~= "number" or cost ~= cost then
      raise(("hypervolume: %s: numbers expected, got %s at %d"):format(where, core.got(cost), k))
    end
  end
end

--- The volume that is dominated by the vectors, below a reference.
function front.hypervolume(costs, reference)
  if type(costs) ~= "table" then
    raise("hypervolume: costs: a list of lists of numbers expected, got " .. core.got(costs))
  end
  check_costs("reference", reference, type(reference) == "table" and rawlen(reference) or 1)
  for i = 1, rawlen(costs) do check_costs(("costs %d"):format(i), rawget(costs, i), rawlen(reference)) end
  local inside = {}
  for _, i in ipairs(front.of(costs)) do
    local within = true
    for k = 1, #reference do within = within and costs[i][k] < reference[k] end
    if within then inside[#inside + 1] = costs[i] end
  end
  if #reference == 2 then
    table.sort(inside, function(a, b) return a[1] < b[1] end)
    local sum, floor = 0.0, reference[2]
    for _, p in ipairs(inside) do
      if p[2] < floor then
        sum = sum + (reference[1] - p[1]) * (floor - p[2])
        floor = p[2]
      end
    end
    return sum
  end
  return volume(inside, reference, #reference)
end

return front
