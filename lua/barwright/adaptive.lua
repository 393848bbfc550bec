-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- part:solve {error = , of = } and part:modes {error = }: static solutions and modes on meshes that are refined
-- until the estimated error of what is asked for is small enough. docs/theory/error_control.md.
local core = require "barwright.core"
local facet_error = require "barwright.facet_error"
local goal = require "barwright.goal"
local options = require "barwright.options"
local growth = require "barwright.singular_growth"
local refinement = require "barwright.refinement"
local shown = require "barwright.shown"

local methods = core.classes.model.methods
local solve, modes_of = methods.solve, methods.modes -- on the mesh as it is

local function with_common(rules)
  for key, rule in pairs(refinement.rules) do rules[key] = rule end
  return rules
end

-- The options of the analysis on one mesh among those given.
local function some_of(opts, keys)
  local out = {}
  for _, key in ipairs(keys) do out[key] = opts[key] end
  return out
end

-- ---- statics ---------------------------------------------------------------------------------------

local static_rules = with_common {
  of = {type = "any"},
  memory_limit = {type = "number", above = 0},
  inertia_relief = {type = "boolean"},
  balance_tolerance = {type = "number", above = 0},
  solver = {type = "any"},
}

-- The parts of the elements in the error, and the error that is their sum. Without a dual problem these are the
-- parts in the energy, and the value is taken to be off as the energy is.
local function parts_of(part, static, found)
  local u, dual, message, details = static.displacement
  if found.dual then
    dual, message, details = found.dual()
    if not dual then return nil, message, details end
  end
  local parts
  parts, message, details = core.error_product(part.mesh, part.material, u, dual or u)
  if not parts then return nil, message, details end
  local sum = parts:sum()
  return parts:totable(), dual and sum or static.energy > 0 and found.value * sum / (2 * static.energy) or 0
end

-- Elements at nodes whose value may exceed the largest one within what the recovery is unsure of.
local function rivals_of(mesh, found)
  if not found.better then return {} end
  local marked = core.array.map("max(a, b) + abs(a - b) > c", {a = found.field, b = found.better,
    c = found.value}):totable()
  local list = {}
  for e, nodes in ipairs(mesh.elements:totable()) do
    for _, node in ipairs(nodes) do
      if marked[node] ~= 0 and marked[node] ~= false then
        list[#list + 1] = e
        break
      end
    end
  end
  return list
end

local function relative(error, value)
  if error == 0 then return 0 end
  return value == 0 and math.huge or error / math.abs(value)
end

local function static_analysis(opts, mesh)
  local wanted = goal.read(opts.of, mesh)
  local how = some_of(opts, {"solver", "memory_limit", "inertia_relief", "balance_tolerance"})
  local function step(history, part, selections)
    local static, message, details = solve(part, how)
    if not static then return nil, message, details end
    local found
    found, message, details = wanted.measure(part, static, selections)
    if not found then return nil, message, details end
    local parts, signed, more = parts_of(part, static, found)
    if not parts then return nil, signed, more end
    local edge, facets = found.node and growth.edge_length(part.mesh, found.at), 0
    if edge then
      facets, message, details = facet_error(part.mesh, found.at, growth.radius(edge))
      if not facets then return nil, message, details end
    end
    local rest = refinement.rest(history, function(row) return row.value end, found.value,
      part.mesh.element_count)
    local error = math.sqrt((found.recovery_error + math.abs(signed)) ^ 2 + rest ^ 2
      + (facets * found.value) ^ 2)
    return {result = static, value = found.value, at = found.at, error = relative(error, found.value),
      facet_error = facets, edge = edge, parts = parts,
      rivals = rivals_of(part.mesh, found)}
  end
  return {name = wanted.name, unit = wanted.unit, selections = wanted.selections, step = step}
end

-- Whether the largest stress is at a place where it has no finite value. The first mesh has all edges.
local function find_singular(part, accuracy)
  local last = accuracy.history[#accuracy.history]
  if not last.edge then return nil end
  local former
  for i = #accuracy.history - 1, 1, -1 do
    former = former or accuracy.history[i].edge > last.edge and accuracy.history[i]
  end
  local places = part:singular_places {surface = accuracy.surface}
  return growth.check(places, last.at, growth.radius(last.edge), growth.exponent(former, last),
    accuracy.reason == "divergence")
end

-- ---- modes -----------------------------------------------------------------------------------------

local mode_rules = with_common {
  count = {type = "integer", default = 15, min = 1, max = 500},
  tolerance = {type = "number", above = 0},
  sturm = {type = "boolean"},
  seed = {type = "integer"},
  solver = {type = "eigensolver", auto = true},
}

-- The largest error of a frequency: by its shape's recovered stress, or by what refinement still changes.
local function error_of_modes(history, modes, elements)
  local cents, message, details = modes:error_estimate()
  if not cents then return nil, message, details end
  local error = 2 ^ (cents:max() / 1200) - 1
  for k, f in ipairs(modes.frequencies:totable()) do
    local rest = refinement.rest(history, function(row) return row.frequencies[k] or f end, f, elements)
    error = math.max(error, rest / f)
  end
  return error
end

-- The parts of the elements in the errors of all modes, each relative to its eigenvalue.
local function parts_of_modes(part, modes)
  local sum
  for k = 1, modes.count do
    local shape = modes:shape(k)
    local parts, message, details = core.error_product(part.mesh, part.material, shape, shape)
    if not parts then return nil, message, details end
    parts = parts * (1 / modes.eigenvalues(k, 1))
    sum = sum and sum + parts or parts
  end
  return sum:totable()
end

local function mode_analysis(opts)
  local how = some_of(opts, {"count", "tolerance", "sturm", "seed", "solver"})
  local function step(history, part)
    local modes, message, details = modes_of(part, how)
    if not modes then return nil, message, details end
    if modes.count == 0 or not modes.frequencies then
      return nil, "an error of frequencies needs modes of a material whose density is known", {status = "invalid"}
    end
    local parts
    parts, message, details = parts_of_modes(part, modes)
    if not parts then return nil, message, details end
    local error
    error, message, details = error_of_modes(history, modes, part.mesh.element_count)
    if not error then return nil, message, details end
    return {result = modes, value = modes.frequencies(1, 1), frequencies = modes.frequencies:totable(),
      error = error, parts = parts}
  end
  return {name = ("frequencies of %d modes, the first"):format(opts.count), unit = "Hz", selections = {},
    step = step}
end

-- ---- methods ---------------------------------------------------------------------------------------

local function asks(part, given, key)
  return type(given) == "table" and rawget(given, key) ~= nil and core.class_name(part) == "model"
end

function methods.solve(part, given)
  if asks(part, given, "error") or asks(part, given, "of") then
    local opts = options.read("solve", given, static_rules)
    local static, accuracy, details = refinement.run(part, opts, static_analysis(opts, part.mesh))
    if static then
      accuracy.singular = find_singular(part, accuracy)
      core.note_error(static, ("estimated error %s of the %s"):format(shown.error(accuracy.estimated_error),
        accuracy.quantity))
    end
    return static, accuracy, details
  end
  return solve(part, given)
end

function methods.modes(part, given)
  if asks(part, given, "error") then
    local opts = options.read("modes", given, mode_rules)
    if part.cyclic_symmetry then
      return nil, "the error of a sector's modes is not estimated: take the modes of the whole, part:whole()",
        {status = "unsupported"}
    end
    return refinement.run(part, opts, mode_analysis(opts))
  end
  return modes_of(part, given)
end
