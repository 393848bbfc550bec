-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The probability of failure by subset simulation (Au and Beck, Probabilistic Engineering Mechanics 16, 2001). A
-- small probability is a product of larger ones: of a margin below g1, of one below g2 < g1 where it is below g1,
-- and so on to 0. Trials below a level come from Markov chains that begin at those of the level before. A step is
-- conditional sampling, y' = a y + sqrt(1 - a^2) noise, taken where it stays below the level (Papaioannou et al.,
-- 2015). It needs no gradient, finds failures in several places, and its effort grows with the logarithm of the
-- probability alone.
local random = require "barwright.study.random"
local reliability = require "barwright.study.reliability"

local subset = {}

subset.subset = {
  summary = "small probability of failure by levels, without gradients",
  rules = {
    count = {type = "integer", default = 1000, min = 50, max = 1000000}, -- of each level
    share = {type = "number", default = 0.1, min = 0.01, max = 0.5}, -- of the trials that begin the next level
    levels = {type = "integer", default = 12, min = 1, max = 40},
    seed = {type = "integer"},
  },
  scatter = true,
}
local design = subset.subset

function design.check(problem) reliability.check("subset", problem) end

local function seeds_of(opts) return math.max(1, math.floor(opts.share * opts.count + 0.5)) end

function design.total(_, opts)
  return opts.count + (opts.levels - 1) * (opts.count - seeds_of(opts))
end

local WANTED = 0.44 -- the share of accepted steps at which chains forget their beginning fastest

-- Trials at some places: {y, margin}.
local function samples_at(run, places)
  local points = {}
  for i, y in ipairs(places) do points[i] = run.problem:normal_point(y) end
  local results, list = run.evaluate(points), {}
  for i, y in ipairs(places) do
    if not results[i] then run.missing = run.missing + 1 end
    list[i] = {y = y, margin = reliability.least(run.limits, results[i])}
  end
  run.trials = run.trials + #places
  return list
end

-- Chains from the seeds below a level, a step of all of them at a time; by chains, for their correlation.
local function chains_below(run, seeds, level)
  local chains, left, step = {}, run.opts.count - #seeds, 0
  for i, seed in ipairs(seeds) do chains[i] = {seed} end
  while left > 0 do
    step = step + 1
    local spread = math.min(1, run.spread)
    local keep, places, moved = math.sqrt(1 - spread * spread), {}, math.min(left, #chains)
    for i = 1, moved do
      local from, y = chains[i][step].y, {}
      for k = 1, #from do y[k] = keep * from[k] + spread * run.source:normal() end
      places[i] = y
    end
    local accepted = 0
    for i, sample in ipairs(samples_at(run, places)) do
      local taken = sample.margin <= level
      if taken then accepted = accepted + 1 end
      chains[i][step + 1] = taken and sample or chains[i][step]
    end
    run.spread = math.max(1e-3, math.min(1, run.spread * math.exp((accepted / moved - WANTED) / math.sqrt(step))))
    left = left - moved
  end
  return chains
end

-- The factor 1 + gamma by which the variance of the share below `level` exceeds that of independent trials.
local function excess(chains, level, p)
  local longest, count = #chains[1], 0
  for _, chain in ipairs(chains) do count = count + #chain end
  local variance = p * (1 - p)
  if variance <= 0 then return 1 end
  local gamma = 0.0
  for lag = 1, longest - 1 do
    local sum, pairs_seen = 0.0, 0
    for _, chain in ipairs(chains) do
      for i = 1, #chain - lag do
        sum = sum + (chain[i].margin <= level and chain[i + lag].margin <= level and 1 or 0)
        pairs_seen = pairs_seen + 1
      end
    end
    local correlation = (sum / pairs_seen - p * p) / variance
    if correlation <= 0 then break end
    gamma = gamma + 2 * pairs_seen / count * correlation
  end
  return 1 + gamma
end

local function of_chains(chains)
  local list = {}
  for _, chain in ipairs(chains) do
    for _, sample in ipairs(chain) do list[#list + 1] = sample end
  end
  -- Equal margins keep their order: table.sort is not stable.
  for i, sample in ipairs(list) do list[i] = {sample = sample, number = i} end
  table.sort(list, function(a, b)
    if a.sample.margin ~= b.sample.margin then return a.sample.margin < b.sample.margin end
    return a.number < b.number
  end)
  for i, item in ipairs(list) do list[i] = item.sample end
  return list
end

local function summary_of(run, p, variance, levels)
  -- The logarithm of a product of many factors is nearly normal.
  local factor = math.exp(1.959963984540054 * math.sqrt(variance))
  local out = {probability = p, low = p / factor, high = math.min(1, p * factor),
    deviation = p * math.sqrt(variance), count = run.trials, levels = levels}
  local lines = {reliability.text(p, out.low, out.high)
    .. (" from %d trials in %d levels"):format(run.trials, #levels)}
  if run.missing > 0 then
    lines[#lines + 1] = ("%d of %d trials without results count as failures"):format(run.missing, run.trials)
  end
  return out, lines
end

-- What is known where no failure was found: p, the probability of the level before, times an upper bound of the
-- fraction of `count` trials that lies below the last level.
local function unseen(run, p, variance, levels, count)
  local last = levels[#levels]
  local share = select(2, reliability.wilson(math.floor(last.share * count + 0.5), count, 1.959963984540054))
  local high = math.min(1, p * share * math.exp(1.959963984540054 * math.sqrt(variance)))
  local out = {low = 0.0, high = high, count = run.trials, levels = levels}
  out.text = last.share == 1 and "all trials have the same margin: no smaller one was found"
    or ("no failure in %d levels: probability of failure below %.3g"):format(#levels, high)
  return out
end

--- probability with low, high (95 %, estimated from the chains) and deviation; levels = {{margin, share}, ...}:
--- the margin of each level in parts of the bound, and the share of trials below; count: all trials.
function design.run(evaluate, problem, opts)
  local run = {evaluate = evaluate, problem = problem, opts = opts, limits = problem:limits(),
    source = random.new(opts.seed), spread = 0.6, trials = 0, missing = 0}
  local places = {}
  for i = 1, opts.count do
    local y = {}
    for k = 1, #problem.variables do y[k] = run.source:normal() end
    places[i] = y
  end
  local chains = {}
  for i, sample in ipairs(samples_at(run, places)) do chains[i] = {sample} end
  local p, variance, levels, wanted = 1.0, 0.0, {}, seeds_of(opts)
  while true do
    local list = of_chains(chains)
    local level = math.max(0, list[wanted].margin)
    if #levels + 1 == opts.levels and list[1].margin < 0 then level = 0 end
    local below = 0
    for _, sample in ipairs(list) do
      if level > 0 and sample.margin <= level or level == 0 and sample.margin < 0 then below = below + 1 end
    end
    local share = below / #list
    levels[#levels + 1] = {margin = level, share = share}
    if level == 0 and share == 0 or level > 0 and (#levels == opts.levels or share == 1) then
      return unseen(run, p, variance, levels, #list)
    end
    p = p * share
    variance = variance + (1 - share) / (share * #list) * excess(chains, level > 0 and level or -0x1p-1074, share)
    if level == 0 then
      local out, lines = summary_of(run, p, variance, levels)
      out.text = table.concat(lines, "\n")
      return out
    end
    local seeds = {}
    for i = 1, below do seeds[i] = list[i] end
    chains = chains_below(run, seeds, level)
  end
end

return subset
