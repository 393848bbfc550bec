-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- bw.study{...}: variables, what is measured, a function, a design and a file. docs/theory/studies.md
-- says what the words mean; docs/howto_study.md begins at the beginning.
local cache = require "barwright.study.cache"
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local csv = require "barwright.study.csv"
local designs = require "barwright.study.designs"
local front = require "barwright.study.front"
local options = require "barwright.options"
local problem = require "barwright.study.problem"
local rerun = require "barwright.study.rerun"
local results = require "barwright.results"
local run = require "barwright.study.run"
local salvage = require "barwright.study.salvage"
local merge = require "barwright.study.merge"
local read_file = require "barwright.read_file"
local status = require "barwright.study.status"
local store = require "barwright.study.store"
local trials = require "barwright.study.trials"

local raise = core.raise

local study = {}
local methods = {}
local meta = {__name = "study", __index = methods}
study.class = methods

local rules = {
  name = {type = "string", needed = true},
  seed = {type = "integer", default = 1},
  file = {type = "string"},
  variables = {type = "table", needed = true},
  correlations = {type = "table"},
  measures = {type = "table", needed = true},
  objectives = {type = "table"},
  constraints = {type = "table"},
  design = {type = "any", needed = true},
  run = {type = "any", needed = true},
  cache = {type = "table"},
  what = {type = "string"},
}

-- The text that the function stands in: the script, or what was entered at the prompt.
local function script_of(f)
  local source = debug.getinfo(f, "S").source
  local path = source:match "^@(.*)"
  if not path then return {text = source} end
  return {path = path, text = read_file(path) or ""}
end

--- A study of the given options; raises where they are not one.
function study.create(given)
  local where = "study"
  if type(given) == "table" and type(given.name) == "string" then where = "study " .. given.name end
  local opts = options.read(where, given, rules)
  if opts.name == "" or opts.name:find "[%c/]" then
    raise("study: name: a name without slashes and control characters expected, got " .. core.got(opts.name))
  end
  if type(opts.run) ~= "function" then
    raise(where .. ": run: a function (point, trial) expected, got " .. core.got(opts.run))
  end
  local self = {name = opts.name, seed = opts.seed, run_function = opts.run, what = opts.what}
  self.file = opts.file or opts.name:gsub("%s+", "_") .. ".study"
  self.problem = problem.read(where, opts)
  self.design = designs.read(where, opts.design, self.problem, opts.seed)
  self.script = script_of(opts.run)
  self.cache_options = cache.check(where, opts.cache)
  setmetatable(self, meta)
  return self:use_file(self.file)
end

--- Another file for the same study.
function methods:use_file(path)
  self.file = path
  self.trial_folder = path:gsub("%.study$", "") .. ".trials"
  return self
end

--- What made the results, for the file.
function methods:manifest()
  local out = results.surroundings()
  out.threads = nil -- a trial has one, whoever runs it
  out.script = self.script.path
  return out
end

--- Runs what is missing; see run.lua.
function methods:run(opts)
  return run.run(self, opts)
end

--- The trials of the file that have ended, by number.
function methods:trials()
  local file <close>, message, details = store.open(self, self.file, {read_only = true})
  if not file then return nil, message, details end
  local list, why, more = file:load()
  if not list then return nil, why, more end
  local out = {}
  for _, record in ipairs(list) do
    if record.status ~= "asked" then out[#out + 1] = trials.present(record, self.problem, self) end
  end
  return trials.new(self, out)
end

--- How far it is, read from the file (also while it is being run).
function methods:status()
  return status.of(self)
end

--- All trials of the file as a table for other programs.
function methods:csv(path)
  local list, message, details = self:trials()
  if not list then return nil, message, details end
  return csv.write(path, list, self.problem)
end

--- Takes over what other files of the same study have; see merge.lua.
function methods:merge(files, opts)
  return merge.into(self, files, opts)
end

--- Runs one trial again and compares; see rerun.lua.
function methods:trial(which, opts)
  return rerun.trial(self, which, opts)
end

--- What `make` returns, from the cache where it is there; see cache.lua.
function methods:cached(what, make, opts)
  return cache.get(self.cache_options, what, make, opts)
end

--- The points that the design will ask for with their keys; nil where they depend on results.
function methods:planned()
  return run.planned(self)
end

arguments.methods("study", methods, meta, {use_file = "path: string", manifest = "",
  run = "options?: options", trials = "",
  status = "", csv = "path: string", merge = "files: string|table, options?: options",
  trial = "which: any, options?: options", cached = "what: any, make: any, options?: options", planned = ""})

function meta.__tostring(self)
  local p = self.problem
  local names, measures = {}, {}
  for i, v in ipairs(p.variables) do names[i] = tostring(v) end
  for i, m in ipairs(p.measures) do measures[i] = m.name end
  return ("study %s: %s\n  %s\nmeasures %s; file %s"):format(self.name, self.design.name,
    table.concat(names, "\n  "), table.concat(measures, ", "), self.file)
end

--- What bw.study is: called, it makes a study.
study.module = setmetatable({
  salvage = salvage.into,
  designs = designs.names,
  hypervolume = front.hypervolume,
}, {__call = function(_, given) return study.create(given) end,
  __index = function(_, name)
    raise(("bw.study has no '%s': %s"):format(tostring(name),
      core.suggestion(tostring(name), {"salvage", "designs", "hypervolume"})))
  end})

return study
