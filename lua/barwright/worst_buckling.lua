-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Which admissible load buckles a part first: linear programs for shapes of vibration, then for the buckling
-- shapes of the loads found, until none gains. docs/theory/stability.md, "Worst-case buckling".
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local load_limits = require "barwright.load_limits"
local options = require "barwright.options"
local shown = require "barwright.shown"
local solver_reports = require "barwright.solver_reports"

local raise = core.raise

local worst_buckling = {}
worst_buckling.__index = worst_buckling
worst_buckling.__name = "barwright.worst_buckling"

local rules = load_limits.rules {
  sign = {type = "string", default = "positive", one_of = {"positive", "negative", "either"}},
  modes = {type = "integer", default = 15, min = 1, max = 30},
  restarts = {type = "integer", default = 48, min = 0, max = 10000},
  ascents = {type = "integer", default = 3, min = 1, max = 1000},
  shapes = {type = "integer", default = 2, min = 1, max = 100},
  tolerance = {type = "number", default = 1e-8, above = 0, max = 0.1},
  seed = {type = "integer", default = 1},
  eigensolver = {type = "eigensolver", auto = true},
}

-- An ascent ends where no shape gains more than this fraction, or after so many steps.
local GAIN, MAX_STEPS = 1e-6, 50
-- Relative residual of shapes during the search.
local ON_THE_WAY = 1e-5
-- Rounds at most; another one where the last one gained more than this fraction.
local MAX_ROUNDS, ROUND_GAIN = 4, 1e-3
-- Pairs of so many shapes at most are solved for.
local MOST_SHAPES = 40
-- Loads that differ by less than this part of the total force are the same.
local SAME = 0.01

local sign_words = {[1] = "positive", [-1] = "negative"}
local signs_of = {positive = {1}, negative = {-1}, either = {1, -1}}

-- Largest value first; of equal ones, as of symmetric bodies, the first found.
local function best_first(list)
  for i, load in ipairs(list) do load.number = i end
  table.sort(list, function(a, b)
    if a.value ~= b.value then return a.value > b.value end
    return a.number < b.number
  end)
  return list
end

-- For each shape the load {pressure, value, sign} that does most work against it. The size of the smallest factor
-- of that load and sign is at most 1 / value.
local function loads_against(self, shapes, sign)
  local gradients, works, found = {}, {}, {}
  for i, shape in ipairs(shapes) do
    local gradient, work, details = core.stress_stiffness_gradient(self.system, shape)
    if not gradient then return nil, work, details end
    gradients[i], works[i] = gradient, work
  end
  local adjoints, message, details = self.system:solve(gradients)
  if not adjoints then return nil, message, details end
  for i, adjoint in ipairs(adjoints) do
    local slope = self.basis:gradient(adjoint)
    local pressure, value, report = self.basis:maximise(self.system, slope * (-sign / works[i]), self.limits)
    if not pressure then return nil, value, report end
    solver_reports.add(self.reports, "lp", report)
    found[i] = {pressure = pressure, value = value, sign = sign}
  end
  return best_first(found)
end

-- The load factors of a load, of its sign. On the way, shapes need not be exact: the error of a factor is the
-- square of that of its shape.
local function factors_of(self, load, sturm)
  local u, message, details = self.system:solve(self.basis:force(load.pressure))
  if not u then return nil, message, details end
  return self.system:buckling(u, {count = self.options.shapes, sign = sign_words[load.sign], sturm = sturm,
    loads_turn = true, tolerance = math.max(self.options.tolerance, sturm and 0 or ON_THE_WAY),
    seed = self.options.seed,
    solver = self.options.eigensolver})
end

-- Whether a list has a load that is nearly the same and not worse.
local function is_among(self, list, load)
  for _, other in ipairs(list) do
    if other.sign == load.sign and other.value >= load.value * (1 - GAIN) then
      local apart = core.array.map("abs(a - b)", {a = load.pressure, b = other.pressure})
      if apart:dot(self.basis.areas) <= 2 * SAME * self.options.force then return true end
    end
  end
  return false
end

-- From a load to others that buckle the part sooner; false where it leads to a known one. The value of each step
-- is at least that of the one before.
local function ascend(self, load, known)
  for step = 0, MAX_STEPS do
    if is_among(self, known, load) then return false end
    local buckling, message, details = factors_of(self, load, false)
    if not buckling then return nil, message, details end
    self.analyses = self.analyses + 1
    if buckling.count == 0 then return false end
    load.value, load.steps = 1 / math.abs(buckling.factors[1]), step
    local shapes = {}
    for i = 1, buckling.count do shapes[i] = buckling:shape(i) end
    load.shape = shapes[1]:copy()
    local found
    found, message, details = loads_against(self, shapes, load.sign)
    if not found then return nil, message, details end
    if step == MAX_STEPS or found[1].value <= load.value * (1 + GAIN) then break end
    load = found[1]
  end
  return load
end

-- Loads that combinations of shapes suggest, of the signs wanted: the most promising first.
local function starts_of(self, shapes)
  local starts = {}
  for _, sign in ipairs(signs_of[self.options.sign]) do
    local ask = options.copied(self.limits)
    ask.reversed, ask.restarts, ask.seed, ask.wanted = sign < 0, self.options.restarts, self.options.seed,
      2 * self.options.ascents
    local found, message, details = core.buckling_starts(self.system, self.basis, shapes, ask)
    if not found then return nil, message, details end
    solver_reports.add(self.reports, "lp", found.report)
    for i = 1, found.values.row_count do
      starts[#starts + 1] = {pressure = found.pressures[i]:copy(), value = found.values[i], sign = sign}
    end
  end
  return best_first(starts)
end

-- Rounds of starts and ascents: the first by modes, the others with the buckling shapes that were found, too.
local function search(self)
  local modes, message, details = self.system:modes {count = self.options.modes, sturm = false,
    tolerance = self.options.tolerance, seed = self.options.seed, solver = self.options.eigensolver}
  if not modes then return nil, message, details end
  local loads, tried, best = {}, {}, 0
  for _ = 1, MAX_ROUNDS do
    local shapes, ascents = {}, 0
    for i = 1, modes.count do shapes[i] = modes:shape(i) end
    for _, load in ipairs(loads) do
      if #shapes < MOST_SHAPES then shapes[#shapes + 1] = load.shape end
    end
    local starts
    starts, message, details = starts_of(self, shapes)
    if not starts then return nil, message, details end
    for _, start in ipairs(starts) do
      if ascents < self.options.ascents and not is_among(self, tried, start) then
        tried[#tried + 1], ascents = start, ascents + 1
        local load
        load, message, details = ascend(self, start, loads)
        if load == nil then return nil, message, details end
        if load then loads[#loads + 1] = load end
      end
    end
    best_first(loads)
    if #loads == 0 or loads[1].value <= best * (1 + ROUND_GAIN) then break end
    best = loads[1].value
  end
  return loads
end

local function summarise(self, loads)
  local list, kept = {}, {}
  for _, load in ipairs(loads) do -- the worst first: of two that are nearly the same, it stays
    if not is_among(self, kept, load) then
      kept[#kept + 1] = load
      list[#list + 1] = {factor = load.sign / load.value, steps = load.steps, pressure = load.pressure,
        sign = load.sign}
    end
  end
  self.loads = list
  if #list == 0 then return self end
  local buckling, message, details = factors_of(self, list[1], true)
  if not buckling then return nil, message, details end
  local errors
  errors, message, details = buckling:error_estimate()
  if not errors then return nil, message, details end
  self.buckling, self.factor, self.error = buckling, buckling.factors[1], buckling.errors[1]
  self.mesh_error, self.counted = errors[1], buckling.counted
  self.force = math.abs(self.factor) * self.options.force
  return self
end

--- The admissible load that buckles a part first, of those that are found. Returns nil, message, details when it
--- cannot tell.
function worst_buckling.analyse(part, given)
  options.object("worst_buckling", "part", part, "model")
  local opts = options.read("worst_buckling", given, rules)
  local self = setmetatable({options = opts, mesh = part.mesh, material = part.material, reports = {},
    analyses = 0}, worst_buckling)
  local message, details
  opts.by_facet = true -- so that a face can be pressed up to its edge, and not beyond it
  self.basis, message, details = load_limits.basis("worst_buckling", part, opts)
  if not self.basis then return nil, message, details end
  self.limits = load_limits.linear_program(opts)
  self.friction_error = load_limits.friction_error(opts)
  self.system, message, details = part:system {solver = core.solver.cholesky()}
  if not self.system then return nil, message, details end
  local loads
  loads, message, details = search(self)
  if not loads then return nil, message, details end
  self.reports.solver = self.system.report
  return summarise(self, loads)
end

-- ---- asking -----------------------------------------------------------------------------------------

local function load_of(self, i, where)
  if not self.loads then raise(where .. ": this worst-case buckling is closed") end
  if #self.loads == 0 then raise(where .. ": no load was found that buckles the part") end
  i = i or 1
  if math.type(i) ~= "integer" or i < 1 or i > #self.loads then
    raise(("%s: a load from 1 to %d expected, got %s"):format(where, #self.loads, core.got(i)))
  end
  return self.loads[i]
end

--- The pressure of a load (the worst one when left out), at every node of the mesh.
function worst_buckling:pressure(i)
  return self.basis:nodal(load_of(self, i, "pressure").pressure)
end

--- The nodal forces of that pressure.
function worst_buckling:nodal_force(i)
  return self.basis:force(load_of(self, i, "nodal_force").pressure)
end

--- The displacement under it, by linear theory.
function worst_buckling:displacement(i)
  return self.system:solve(self.basis:force(load_of(self, i, "displacement").pressure))
end

--- The pressure summed into a few arrows {at, force, area}, largest first.
function worst_buckling:arrows(i, radius)
  return self.basis:arrows(load_of(self, i, "arrows").pressure, radius)
end

--- The load factors and shapes of a load.
function worst_buckling:factors(i)
  local load = load_of(self, i, "factors")
  if load == self.loads[1] then return self.buckling end
  return factors_of(self, load, true)
end

-- ---- showing ----------------------------------------------------------------------------------------

--- The answer in one line.
function worst_buckling:__tostring()
  if not self.loads then return "worst-case buckling (closed)" end
  local set = ("%s at up to %s%s"):format(core.quantity(self.options.force, "N"),
    core.quantity(self.options.pressure, "Pa"), load_limits.describe(self.options))
  if not self.factor then
    return ("no load of %s was found that buckles it; one may exist"):format(set)
  end
  return ("buckles at %s times a load of %s%s; %s; the mesh makes the factor about %s too large; "
    .. "another load may have a smaller one"):format(shown.number(self.factor), set,
    self.factor < 0 and " that pulls" or "",
    self.counted and "counted: this load has no smaller factor" or "not counted", shown.error(self.mesh_error))
end

--- Pressure, displacement and buckling shape of the worst load as a .vtu file.
function worst_buckling:write(path)
  load_of(self, nil, "write")
  local u, message, details = self:displacement()
  if not u then return nil, message, details end
  return self.mesh:write(path, {fields = {pressure = {self:pressure(), on = "nodes"},
    displacement = {u, on = "nodes"}, shape = {self.buckling:shape(1), on = "nodes"}}})
end

--- A picture: the buckling shape with the arrows of the load. {load = i} takes another load than the worst
--- one. Further options: those of bw.picture.
function worst_buckling:picture(path, given)
  local opts = options.copied(given)
  local load = load_of(self, opts.load, "picture")
  local buckling, message, details = self:factors(opts.load)
  if not buckling then return nil, message, details end
  opts.arrows = opts.arrows or self:arrows(opts.load)
  opts.title = opts.title or ("Buckles at %s times this load of %s; another load may have a smaller factor")
    :format(shown.number(load.factor), core.quantity(self.options.force, "N"))
  opts.load = nil
  return buckling:picture(1, path, opts)
end

--- Lets go of the factor and the arrays at once.
function worst_buckling:close()
  for _, key in ipairs {"system", "basis", "buckling"} do
    if self[key] then self[key]:close() end
    self[key] = nil
  end
  self.loads, self.factor = nil, nil
end
worst_buckling.__close = worst_buckling.close

arguments.methods("worst-case buckling", worst_buckling, worst_buckling, {
  pressure = "load?: integer", nodal_force = "load?: integer", displacement = "load?: integer",
  arrows = "load?: integer, radius?: number", factors = "load?: integer", write = "path: string",
  picture = "path: string, options?: options", close = "",
})

return setmetatable({class = worst_buckling}, {
  __call = function(_, part, given) return worst_buckling.analyse(part, given) end,
})
