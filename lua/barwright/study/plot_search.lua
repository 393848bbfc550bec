-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How a search came closer to what it found.
local front = require "barwright.study.front"
local says = require "barwright.study.plot_data"

local search = {}

--- By how much the best so far was worse than the best of all: numbers of trials, gaps, and the best.
function search.gaps(trials, objective)
  local sign = objective.goal == "max" and -1 or 1
  local x, y, best = {}, {}, nil
  for i = 1, #trials do
    local value = says.keeps(trials.problem, trials[i]) and trials[i].results[objective.name]
    if value and (not best or sign * value < best) then
      best = sign * value
      x[#x + 1], y[#y + 1] = trials[i].number or i, best
    end
  end
  for i = 1, #y do y[i] = y[i] - best end
  y[#y] = nil -- the best itself: its gap is 0
  local at = table.remove(x)
  return x, y, at, best and sign * best
end

--- How much of the space of costs the trials so far beat, up to the worst that any cost.
function search.volumes(trials, objectives)
  local costs, order, worst = {}, {}, {}
  for i = 1, #trials do
    if says.keeps(trials.problem, trials[i]) then
      local row, whole = {}, true -- measures may be optional
      for k, objective in ipairs(objectives) do
        local value = trials[i].results[objective.name]
        row[k] = value and (objective.goal == "max" and -value or value)
        whole = whole and value ~= nil
      end
      if whole then
        for k = 1, #row do worst[k] = math.max(worst[k] or row[k], row[k]) end
        costs[#costs + 1], order[#order + 1] = row, trials[i].number or i
      end
    end
  end
  local x, y, kept = {}, {}, {}
  local every = math.max(1, #costs // 100)
  for i, row in ipairs(costs) do
    kept[#kept + 1] = row
    if i % every == 0 or i == #costs then
      local few = {}
      for _, place in ipairs(front.of(kept)) do few[#few + 1] = kept[place] end
      kept = few
      x[#x + 1], y[#y + 1] = order[i], front.hypervolume(kept, worst)
    end
  end
  local last = y[#y]
  for i = 1, #y do y[i] = last > 0 and y[i] / last or 0 / 0 end
  return x, y
end

return search
