-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The loop of adaptive refinement: analyse, estimate, bisect where the error comes from, until the estimated error
-- is small enough or a limit is reached. docs/theory/error_control.md.
local core = require "barwright.core"
local shown = require "barwright.shown"

local refinement = {}

local accuracy = {}
accuracy.__index = accuracy
accuracy.__name = "barwright.accuracy"

--- Options that every analysis with an error has.
refinement.rules = {
  error = {type = "number", above = 0, max = 1, needed = true},
  max_elements = {type = "integer", default = 200000, min = 1, max = 100000000},
  time_limit = {type = "number", above = 0},
  surface = {type = "surface"},
}

-- A step makes at most this many times as many elements; conforming bisection adds about 1.5 to each asked for.
local GROWTH, CONFORMING = 3.5, 2.5
-- Fewer elements than this many times the former are no step.
local MIN_GROWTH = 1.2
-- An element is bisected at most six times in a step, which quarters its edges.
local MAX_LEVELS = 6
-- Bisecting an element divides its part of the error by 2^(7/3): with p = 2 it goes like h^(2p) times the volume.
local GAIN = 7 / 3 * math.log(2)
-- The rest of an error is at most this many times the last change.
local MAX_REST = 1.5
-- The value does not converge where each of so many steps changes it by at least this fraction of the change
-- before, and the last one by more than this fraction of the value.
local STEPS, STEADY, LARGE = 3, 0.9, 0.05
-- On curved edges the angle between facets falls at least like this from mesh to mesh.
local KEPT = 0.8

-- ---- which elements --------------------------------------------------------------------------------

-- Levels of bisection for every element so that the parts of the error become alike, at about `growth` times as
-- many elements.
local function levels_of(parts, growth)
  local total = 0
  for _, x in ipairs(parts) do total = total + math.abs(x) end
  local levels, top = {}, math.log(total + 1e-300)
  local function assign(threshold)
    local count = 0
    for e, x in ipairs(parts) do
      local k = math.ceil((math.log(math.abs(x) + 1e-300) - threshold) / GAIN)
      k = k < 0 and 0 or k > MAX_LEVELS and MAX_LEVELS or k
      levels[e] = k
      count = count + (1 << k)
    end
    return count
  end
  local low, high = top - 60, top
  for _ = 1, 40 do
    local midpoint = (low + high) / 2
    if assign(midpoint) > growth * #parts then low = midpoint else high = midpoint end
  end
  assign(high)
  return levels
end

-- How many times as many elements the tolerance calls for, with an error like 1 / elements.
local function growth_of(self, elements)
  local opts, last = self.options, self.history[#self.history]
  local growth = GROWTH
  if #self.history > 1 then growth = math.min(growth, 1.3 * last.estimated_error / opts.error) end
  return math.max(MIN_GROWTH, math.min(growth, opts.max_elements / elements))
end

local function refine(self, step, selections)
  local opts, mesh = self.options, self.part.mesh
  local levels = levels_of(step.parts, 1 + (growth_of(self, mesh.element_count) - 1) / CONFORMING)
  for _, e in ipairs(step.rivals or {}) do levels[e] = math.max(levels[e], 1) end
  return self.part:refined(core.array.new(levels), {surface = self.surface, also = selections,
    max_elements = math.max(opts.max_elements, mesh.element_count)})
end

-- ---- what refinement still changes ------------------------------------------------------------------

--- The error that is left by what refinement has changed. With an error like 1 / elements it is the last change
--- over (ratio - 1), and more where changes of one sign do not fall as fast. value_of gives the value of a row.
function refinement.rest(history, value_of, value, elements)
  local last, former = history[#history], history[#history - 1]
  if not last then return 0 end
  local ratio = elements / last.elements
  local change, factor = value - value_of(last), 1 / math.max(ratio - 1, 1 / MAX_REST)
  local before = former and value_of(last) - value_of(former) or 0
  if change * before > 0 then
    local rate = change / before
    factor = math.max(factor, rate < 1 and math.min(rate / (1 - rate), MAX_REST) or MAX_REST)
  end
  return factor * math.abs(change)
end

local function does_not_converge(history)
  if #history <= STEPS then return false end
  for i = #history - STEPS + 2, #history do
    local now, before = history[i].value - history[i - 1].value, history[i - 1].value - history[i - 2].value
    if now * before <= 0 or math.abs(now) < STEADY * math.abs(before) then return false end
  end
  local last, former = history[#history].value, history[#history - 1].value
  return math.abs(last - former) > LARGE * math.abs(last)
end

-- Facets that stand for a round face, by themselves, are more than the error asked for, and refinement keeps them.
local function is_faceted(history, error)
  local last, former = history[#history], history[#history - 1]
  if not (former and last.facet_error) then return false end
  return last.facet_error > error and last.facet_error > KEPT * former.facet_error
end

-- Why the last mesh is the last; nil where there is another one to come.
local function verdict(self)
  local opts, last = self.options, self.history[#self.history]
  if #self.history > 1 and last.estimated_error <= opts.error then return "tolerance" end
  if is_faceted(self.history, opts.error) then return "facets" end
  if does_not_converge(self.history) then return "divergence" end
  if last.elements * MIN_GROWTH > opts.max_elements then return "elements" end
  if opts.time_limit then
    local before = #self.history > 1 and self.history[#self.history - 1].seconds or 0
    if last.seconds + GROWTH * (last.seconds - before) > opts.time_limit then return "time" end
  end
end

-- ---- the loop --------------------------------------------------------------------------------------

local function keep(self, part, step, started)
  local mesh = part.mesh
  self.history[#self.history + 1] = {elements = mesh.element_count, unknowns = 3 * mesh.node_count,
    value = step.value, frequencies = step.frequencies, at = step.at, estimated_error = step.error,
    facet_error = step.facet_error, edge = step.edge,
    seconds = core.seconds() - started}
  self.part, self.value, self.at, self.estimated_error = part, step.value, step.at, step.error
end

-- The estimate of every mesh beside the difference to the last value.
local function check_history(self)
  for i = 1, #self.history - 1 do
    local row = self.history[i]
    local difference = math.abs(row.value - self.value)
    row.effectivity = difference > 0 and row.estimated_error * math.abs(row.value) / difference or nil
  end
end

local function finish(self, result, reason)
  local last = self.history[#self.history]
  self.reason, self.converged = reason, reason == "tolerance"
  self.elements, self.seconds = last.elements, last.seconds
  check_history(self)
  return result, self
end

--- Runs an analysis {name, unit, selections, step}: step(history, part, selections) gives {result, value, at,
--- error (relative), parts (of every element in the error), rivals (elements to be bisected once)}. Returns its
--- last result and the accuracy; or nil, message, details.
function refinement.run(part, opts, analysis)
  local mesh, started = part.mesh, core.seconds()
  local self = setmetatable({options = opts, history = {}, quantity = analysis.name, unit = analysis.unit,
    surface = opts.surface}, accuracy)
  local message, details, selections
  part, selections, details = part:refined(core.array.zeros(mesh.element_count), {surface = self.surface,
    order = 2, also = analysis.selections})
  if not part then return nil, selections, details end
  local result
  while true do
    local step
    step, message, details = analysis.step(self.history, part, selections)
    if not step then
      if result and details.status == "memory" then return finish(self, result, "memory") end
      return nil, message, details
    end
    keep(self, part, step, started)
    result = step.result
    local reason = verdict(self)
    if reason then return finish(self, result, reason) end
    part, selections, details = refine(self, step, selections)
    if not part then
      if details.status == "limit" then return finish(self, result, "elements") end
      return nil, selections, details
    end
  end
end

-- ---- printing ------------------------------------------------------------------------------------------

local reasons = {
  tolerance = "the estimated error is small enough",
  elements = "a finer mesh would have too many elements",
  time = "a finer mesh would take too long",
  memory = "a finer mesh takes more memory than there is",
  facets = "facets stand for a round face there: give the surface (option 'surface'), or curved edges",
  divergence = "the value changes as much from mesh to mesh: it may have no limit",
}

function accuracy:__tostring()
  local function text(value) return core.quantity(value, self.unit) end
  local lines = {("%s: %s, estimated error %s, %s: %s"):format(self.quantity, text(self.value),
    shown.error(self.estimated_error), self.converged and "converged" or "not converged", reasons[self.reason])}
  for _, row in ipairs(self.history) do
    lines[#lines + 1] = ("  %8d elements  %8d unknowns  %12s  %7s"):format(row.elements, row.unknowns,
      text(row.value), shown.error(row.estimated_error))
  end
  if self.singular then lines[#lines + 1] = tostring(self.singular) end
  return table.concat(lines, "\n")
end

return refinement
