-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Designs by name. A design is a table {"name", option = value, ...}, checked before the first trial, or
-- a function run(evaluate, problem, options) -> summary. What stands behind a name has
--   summary, rules                         one line, and the options as barwright.options checks them
--   points(problem, opts)                  all points, known beforehand
--   summarise(problem, opts, points, results) -> summary     (optional; a result is false where a trial
--                                          has none)
--   scatter                                true, or "independent": takes variables with distributions, also
--                                          correlated ones, or only independent ones
-- or, where the next points depend on results,
--   run(evaluate, problem, opts) -> summary
--   total(problem, opts)                   how many trials it may take, for the time to go
--   check(problem, opts)                   raises where the problem is not its kind
local core = require "barwright.core"
local options = require "barwright.options"

local designs = {}

local home = {
  grid = "grid", points = "grid", one_at_a_time = "grid",
  random = "sampling", latin_hypercube = "sampling", sobol = "sampling",
  morris = "morris", sobol_indices = "sobol_indices",
  minimise = "minimise", pareto = "pareto",
  bayesian = "bayesian", form = "form", importance = "importance", subset = "subset",
}

--- All names, in alphabetical order.
function designs.names()
  local names = {}
  for name in pairs(home) do names[#names + 1] = name end
  table.sort(names)
  return names
end

local function known(name, where)
  if home[name] then return require("barwright.study." .. home[name])[name] end
  core.raise(("%s: unknown design '%s': one of %s expected"):format(where, tostring(name),
    table.concat(designs.names(), ", ")))
end

-- A design whose points are known: asked for at once, summed up when all are there.
local function run_points(kind)
  return function(evaluate, problem, opts)
    local points = opts.known_points or kind.points(problem, opts)
    local results = evaluate(points)
    return kind.summarise and kind.summarise(problem, opts, points, results) or {}
  end
end

-- Designs between bounds take no variable that has none.
local function check_scatter(where, name, kind, problem)
  for _, v in ipairs(problem.variables) do
    if v.distribution and not kind.scatter then
      core.raise(("%s: design %s works between min and max; '%s' has a distribution: use random, latin_hypercube, "
        .. "sobol, sobol_indices, form, importance or subset"):format(where, name, v.name))
    end
  end
  if problem.correlations and kind.scatter == "independent" then
    core.raise(("%s: design %s: independent variables expected, got correlations"):format(where, name))
  end
end

--- The design of a study, checked: {name, run, total, points = the list where it is known, text}.
function designs.read(where, given, problem, seed)
  if type(given) == "function" then return {name = "function", run = given, opts = {}, text = "a function"} end
  if type(given) ~= "table" or type(given[1]) ~= "string" then
    core.raise(("%s: option 'design': a function, or a table such as {\"latin_hypercube\", count = 100}, "
      .. "expected, got %s"):format(where, core.got(given)))
  end
  local kind = known(given[1], where)
  local opts = {}
  for key, value in pairs(given) do
    if key ~= 1 then opts[key] = value end
  end
  opts = options.read(("%s: design %s"):format(where, given[1]), opts, kind.rules)
  if kind.rules.seed and opts.seed == nil then opts.seed = seed end
  check_scatter(where, given[1], kind, problem)
  if kind.check then kind.check(problem, opts) end
  local design = {name = given[1], opts = opts, kind = kind, run = kind.run or run_points(kind),
    total = kind.total and kind.total(problem, opts) or nil}
  return design
end

--- The points of a design that knows them beforehand; nil for one that grows.
function designs.points(design, problem)
  if not design.kind or not design.kind.points then return nil end
  if not design.opts.known_points then design.opts.known_points = design.kind.points(problem, design.opts) end
  return design.opts.known_points
end

return designs
