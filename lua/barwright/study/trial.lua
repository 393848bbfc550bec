-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- One trial: what the study's function gets beside the point, how it is run, and how what came out
-- travels from the process that ran it. A trial's numbers depend on its point and seed alone.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local random = require "barwright.study.random"

local raise = core.raise

local trial = {}

-- ---- what the function sees ------------------------------------------------------------------------

local methods = {}
local getters = {}
local meta = {__name = "trial"}
trial.class = methods

function meta.__index(self, name)
  local method = methods[name]
  if method then return method end
  local getter = getters[name]
  if getter then return getter(self) end
  local names = {"number", "key", "seed", "point", "study"}
  for known in pairs(methods) do names[#names + 1] = known end
  for known in pairs(getters) do names[#names + 1] = known end
  raise(("a trial has no '%s': %s"):format(tostring(name), core.suggestion(tostring(name), names)))
end

function meta.__tostring(self)
  return ("trial %d of %s (%s)"):format(self.number, self.study.name, self.key:sub(1, 12))
end

local function source(self)
  local own = rawget(self, "source")
  if not own then
    own = random.new(self.seed)
    rawset(self, "source", own)
  end
  return own
end

--- As math.random, from the trial's seed: a number from 0 up to below 1; whole numbers from 1 to a, or
--- from a to b.
function methods:random(a, b)
  if a == nil then return source(self):uniform() end
  local min, max = b and a or 1, b or a
  if math.type(min) ~= "integer" or math.type(max) ~= "integer" or min > max then
    raise(("trial:random: whole numbers, the lesser first, expected, got %s and %s"):format(core.got(min),
      core.got(max)))
  end
  return source(self):integer(min, max)
end

--- A number of the normal distribution.
function methods:normal(mean, deviation)
  return source(self):normal(mean, deviation)
end

--- See study:cached.
function methods:cached(what, make, options)
  return self.study:cached(what, make, options)
end

arguments.methods("trial", methods, meta, {random = "a?: any, b?: any",
  normal = "mean?: number, deviation?: number",
  cached = "what: any, make: any, options?: options"})

--- The folder for this trial's files, made when it is asked for.
function getters:folder()
  local path = trial.folder_of(self.study, self.key)
  local ok, message = core.make_folder(path)
  if not ok then error(message, 0) end
  rawset(self, "folder", path)
  return path
end

--- Where the files of a trial lie: "hook.trials/1f2e3d4c5b6a".
function trial.folder_of(study, key)
  return ("%s/%s"):format(study.trial_folder, key:sub(1, 12))
end

--- What the study's function gets.
function trial.new(study, record)
  return setmetatable({study = study, number = record.number, key = record.key, seed = record.seed,
    point = record.point}, meta)
end

-- ---- results, checked and packed -------------------------------------------------------------------

local function number_fault(value)
  if type(value) ~= "number" then return ("is a %s"):format(type(value)) end
  if value ~= value then return "is not a number (nan)" end
  if value == math.huge or value == -math.huge then return "is infinite" end
end

-- The measures in order, or nil and a sentence.
local function checked(problem, results)
  if type(results) ~= "table" then
    return nil, ("run returned %s: a table of measures expected, or nil and a message"):format(
      results == nil and "nothing" or "a " .. type(results))
  end
  local out = {}
  for name in pairs(results) do
    if not problem.measure[name] then
      local names = {}
      for i, m in ipairs(problem.measures) do names[i] = m.name end
      return nil, ("run returned '%s', which is no measure: %s"):format(tostring(name),
        core.suggestion(tostring(name), names))
    end
  end
  for _, measure in ipairs(problem.measures) do
    local value = results[measure.name]
    if value == nil then
      if not measure.optional then return nil, ("run returned no '%s'"):format(measure.name) end
    else
      local fault = number_fault(value)
      if fault then return nil, ("measure '%s' %s: a finite number expected"):format(measure.name, fault) end
      out[measure.name] = value == 0 and math.abs(value) or value -- of the two zeros the positive one
    end
  end
  return out
end

-- gradients[measure][variable] in units of both, complete for the measures that are there.
local function checked_gradients(problem, gradients)
  if gradients == nil then return nil end
  if type(gradients) ~= "table" then
    return nil, "run's second result: a table of gradients expected, got " .. core.got(gradients)
  end
  local out = {}
  for name, gradient in pairs(gradients) do
    if not problem.measure[name] then
      return nil, ("a gradient of '%s', which is no measure"):format(tostring(name))
    end
    out[name] = {}
    for _, v in ipairs(problem.variables) do
      local value = gradient[v.name]
      if v.kind == "real" or value ~= nil then
        local fault = number_fault(value)
        if fault then return nil, ("gradient of '%s' by '%s' %s"):format(name, v.name, fault) end
        out[name][v.name] = value + 0.0
      end
    end
  end
  return out
end

local function pack_number(value)
  if value == nil then return "n" end
  return math.type(value) == "integer" and string.pack("<c1i8", "i", value) or string.pack("<c1d", "d", value)
end

local function unpack_number(text, at)
  local kind = text:sub(at, at)
  if kind == "n" then return nil, at + 1 end
  return string.unpack(kind == "i" and "<i8" or "<d", text, at + 1)
end

local function pack(problem, results, gradients)
  local parts = {"D"}
  for _, m in ipairs(problem.measures) do parts[#parts + 1] = pack_number(results[m.name]) end
  for _, m in ipairs(problem.measures) do
    local gradient = gradients and gradients[m.name]
    parts[#parts + 1] = gradient and "g" or "-"
    if gradient then
      for _, v in ipairs(problem.variables) do parts[#parts + 1] = pack_number(gradient[v.name]) end
    end
  end
  return table.concat(parts)
end

-- What a failure is called: by its details, or by Lua's own sentence.
local function failure(message, details)
  local status = type(details) == "table" and details.status == "memory" and "memory" or "failed"
  message = tostring(message)
  if message:find "not enough memory" then status = "memory" end
  return string.pack("<c1s1s4", "F", status, message:sub(1, 4000))
end

--- Runs the study's function for a record {number, key, seed, point} here and now. The answer is a
--- string for `trial.read`, also for a trial that failed.
function trial.perform(study, record)
  math.randomseed(record.seed) -- for scripts that use Lua's own
  local point = {}
  for name, value in pairs(record.point) do point[name] = value end
  local ok, results, extra, details = pcall(study.run_function, point, trial.new(study, record))
  if not ok then return failure(results) end
  if results == nil and extra ~= nil then return failure(extra, details) end
  local values, message = checked(study.problem, results)
  if not values then return failure(message) end
  local gradients
  gradients, message = checked_gradients(study.problem, extra)
  if message then return failure(message) end
  return pack(study.problem, values, gradients)
end

--- Puts what `trial.perform` gave into the record: status, and results or message.
function trial.read(study, record, text)
  if text:sub(1, 1) == "F" then
    local _
    _, record.status, record.message = string.unpack("<c1s1s4", text)
    record.results, record.gradients = nil, nil
    return
  end
  local at, problem = 2, study.problem
  local results, gradients = {}, nil
  for _, m in ipairs(problem.measures) do results[m.name], at = unpack_number(text, at) end
  for _, m in ipairs(problem.measures) do
    local there = text:sub(at, at) == "g"
    at = at + 1
    if there then
      gradients = gradients or {}
      gradients[m.name] = {}
      for _, v in ipairs(problem.variables) do gradients[m.name][v.name], at = unpack_number(text, at) end
    end
  end
  record.status, record.message, record.results, record.gradients = "done", nil, results, gradients
end

return trial
