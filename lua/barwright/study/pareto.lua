-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A search for the front of several objectives: NSGA-II (Deb, Pratap, Agarwal, Meyarivan, IEEE Trans.
-- Evolutionary Computation 6, 2002) with constraints by feasibility. Each generation is one batch.
--
-- A member is its place in the unit cube. Places of integers and choices are those of their values, so
-- that equal points are recognised; of those only one stays. All that is drawn comes from one generator
-- in one order, so that the search is the same wherever and by how many its trials are run.
local core = require "barwright.core"
local front = require "barwright.study.front"
local random = require "barwright.study.random"
local sampling = require "barwright.study.sampling"

local pareto = {}

pareto.pareto = {
  summary = "NSGA-II: the front of several objectives",
  rules = {
    population = {type = "integer", default = 40, min = 4, max = 100000},
    generations = {type = "integer", default = 25, min = 0, max = 1000000},
    crossover = {type = "number", default = 0.9, min = 0, max = 1},
    crossover_index = {type = "number", default = 15, min = 0},
    mutation = {type = "number", above = 0, max = 1}, -- of each variable; default 1 / their number
    mutation_index = {type = "number", default = 20, min = 0},
    seed = {type = "integer"},
  },
}
local design = pareto.pareto

function design.check(problem)
  if #problem.objectives == 0 then core.raise "design pareto: objectives expected, the study has none" end
end

function design.total(_, opts)
  return opts.population * (opts.generations + 1)
end

-- ---- making members ----------------------------------------------------------------------------------

local function clamp(u) return u < 0 and 0.0 or u > 1 and 1.0 or u end

-- Simulated binary crossover between bounds 0 and 1: children as far apart as the parents on average, and
-- never outside.
local function cross(a, b, index, source)
  if math.abs(a - b) < 1e-14 then return a, b end
  local low, high = math.min(a, b), math.max(a, b)
  local u = source:uniform()
  local function child(allowed)
    local beta = 1 + 2 * allowed / (high - low)
    local alpha = 2 - beta ^ -(index + 1)
    if u <= 1 / alpha then return (u * alpha) ^ (1 / (index + 1)) end
    return (1 / (2 - u * alpha)) ^ (1 / (index + 1))
  end
  local c1 = clamp(0.5 * (low + high - child(low) * (high - low)))
  local c2 = clamp(0.5 * (low + high + child(1 - high) * (high - low)))
  if source:uniform() < 0.5 then return c1, c2 end
  return c2, c1
end

-- Polynomial mutation between 0 and 1.
local function mutate(x, index, source)
  local u, power = source:uniform(), 1 / (index + 1)
  if u < 0.5 then
    local value = 2 * u + (1 - 2 * u) * (1 - x) ^ (index + 1)
    return clamp(x + value ^ power - 1)
  end
  local value = 2 * (1 - u) + 2 * (u - 0.5) * x ^ (index + 1)
  return clamp(x + 1 - value ^ power)
end

local function recombine(problem, opts, a, b, source)
  local c, e = {}, {}
  local crossing = source:uniform() < opts.crossover
  for k, v in ipairs(problem.variables) do
    c[k], e[k] = a[k], b[k]
    if crossing and source:uniform() < 0.5 then
      if v.kind == "choice" then c[k], e[k] = b[k], a[k]
      else c[k], e[k] = cross(a[k], b[k], opts.crossover_index, source) end
    end
  end
  return c, e
end

local function vary(problem, opts, place, source)
  local chance = opts.mutation or 1 / #problem.variables
  for k, v in ipairs(problem.variables) do
    if source:uniform() < chance then
      if v.kind == "choice" then
        place[k] = source:uniform()
      else
        local moved = mutate(place[k], opts.mutation_index, source)
        local n = v:count()
        -- A step that an integer does not feel becomes one to a neighbour.
        if n and math.floor(moved * n) == math.floor(place[k] * n) then
          moved = clamp(place[k] + (moved < place[k] and -1 or 1) / n)
        end
        place[k] = moved
      end
    end
  end
  return place
end

-- ---- judging members ---------------------------------------------------------------------------------

-- Feasible beats infeasible, less violation beats more, and among feasible ones dominance decides.
local function beats(a, b)
  if a.violation ~= b.violation then
    if a.violation == 0 or b.violation == 0 then return a.violation == 0 end
    return a.violation < b.violation
  end
  return a.violation == 0 and front.dominates(a.costs, b.costs)
end

local function assess(members)
  local costs = {}
  for i, m in ipairs(members) do costs[i] = m.costs or {} end
  local fronts = front.ranks(#members, function(i, j) return beats(members[i], members[j]) end)
  for rank, list in ipairs(fronts) do
    local gap = {}
    if members[list[1]].violation == 0 then gap = front.crowding(list, costs) end
    for _, i in ipairs(list) do members[i].rank, members[i].gap = rank, gap[i] or 0.0 end
  end
  return fronts
end

local function better(a, b)
  if a.rank ~= b.rank then return a.rank < b.rank end
  if a.gap ~= b.gap then return a.gap > b.gap end
  return a.born < b.born
end

-- The best of parents and children, as many as a population has.
local function survivors(members, count)
  local distinct, seen = {}, {}
  for _, m in ipairs(members) do
    if not seen[m.name] then
      seen[m.name] = true
      distinct[#distinct + 1] = m
    end
  end
  assess(distinct)
  table.sort(distinct, better)
  for i = #distinct, count + 1, -1 do distinct[i] = nil end
  return distinct
end

-- Results for places, as members.
local function members_of(search, places)
  local points, members = {}, {}
  for i, place in ipairs(places) do
    points[i] = search.problem:point(place)
    place = search.problem:place(points[i])
    local words = {}
    for k, u in ipairs(place) do words[k] = ("%.17g"):format(u) end
    search.born = search.born + 1
    members[i] = {place = place, name = table.concat(words, " "), born = search.born}
  end
  local results = search.evaluate(points)
  for i, m in ipairs(members) do
    m.costs = results[i] and search.problem:costs(results[i])
    m.violation = m.costs and search.problem:violation(results[i]) or math.huge
    if m.violation == 0 then search.feasible[#search.feasible + 1] = m.costs end
  end
  return members
end

local function tournament(population, source)
  local a, b = population[source:integer(1, #population)], population[source:integer(1, #population)]
  return better(b, a) and b or a
end

local function children(search, population, source)
  local places, opts = {}, search.opts
  while #places < opts.population do
    local c, e = recombine(search.problem, opts, tournament(population, source).place,
      tournament(population, source).place, source)
    places[#places + 1] = vary(search.problem, opts, c, source)
    if #places < opts.population then places[#places + 1] = vary(search.problem, opts, e, source) end
  end
  return places
end

-- Hypervolume after each generation, by the worst that any feasible trial cost.
local function volumes(search, counts)
  local m = #search.problem.objectives
  if m > 3 or #search.feasible == 0 then return nil end
  local worst, list, out = {}, {}, {}
  for k = 1, m do
    worst[k] = -math.huge
    for _, costs in ipairs(search.feasible) do worst[k] = math.max(worst[k], costs[k]) end
  end
  local at = 0
  for g, count in ipairs(counts) do
    for i = at + 1, count do list[#list + 1] = search.feasible[i] end
    at = count
    local kept = {}
    for _, i in ipairs(front.of(list)) do kept[#kept + 1] = list[i] end
    list = kept
    out[g] = front.hypervolume(list, worst)
  end
  return out
end

--- {generations, population, hypervolume = {after each generation, ...} up to three objectives}
function design.run(evaluate, problem, opts)
  local source = random.new(opts.seed)
  local search = {evaluate = evaluate, problem = problem, opts = opts, born = 0, feasible = {}}
  local population = members_of(search, sampling.latin(opts.population, #problem.variables, source, true))
  assess(population)
  local counts = {#search.feasible}
  for g = 1, opts.generations do
    local born = members_of(search, children(search, population, source))
    population = survivors(table.move(born, 1, #born, #population + 1, population), opts.population)
    counts[g + 1] = #search.feasible
  end
  return {generations = opts.generations, population = opts.population, hypervolume = volumes(search, counts)}
end

return pareto
