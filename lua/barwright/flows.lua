-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Flow and heat that keep up with an outline while it is dragged: time steps or the steady state.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local conditions = require "barwright.conditions"
local followed = require "barwright.followed"
local options = require "barwright.options"

local raise = core.raise

local flows = {}

-- ---- methods ---------------------------------------------------------------------------------------

local methods, heat_methods = {drag = followed.drag, become = followed.become}, {}

local function advance(self, report, step, count)
  local opts = self.opts
  return self.body:step(report, followed.linear(self), {step = step, bdf = opts.bdf, ale = opts.ale,
    iterations = opts.iterations, tolerance = opts.tolerance}, count)
end

local function record(self)
  for name, signal in pairs(self.signals) do
    local value = self.watched[name](self)
    if type(value) ~= "number" then
      raise(("step: the function of the signal '%s' must return a number, it returned %s"):format(name,
        core.got(value)))
    end
    signal[#signal + 1] = value
  end
end

-- A drag of a steady flow finds the steady state again, others only transfer the fields to the new mesh.
local function finish(self, report)
  if not self.opts.steady then return true end
  return advance(self, report, 0)
end

local function marches(self) return not self.opts.steady end

-- The signals as they are now: a step that fails removes what it recorded.
local function keep(self)
  local signals, watched, lengths = {}, {}, {}
  for name, signal in pairs(self.signals) do
    signals[name], watched[name], lengths[name] = signal, self.watched[name], #signal
  end
  return function()
    for name, signal in pairs(signals) do
      for i = #signal, lengths[name] + 1, -1 do signal[i] = nil end
    end
    rawset(self, "recorded", signals)
    rawset(self, "watched", watched)
  end
end

--- Advances by `count` time steps (default 1); signals are recorded after each.
function methods:step(count)
  local step = self.opts.step
  if not step then raise "step: this flow was made without a time step: give the option 'step', in s" end
  count = count or 1
  if math.type(count) ~= "integer" or count < 1 then
    raise(("step: a whole number of steps above 0 expected, got %s"):format(core.got(count)))
  end
  local function steps(report)
    if not next(self.signals) then return advance(self, report, step, count) end
    for i = 1, count do
      local ok, message, details = true
      if count > 1 then ok, message, details = core.report_progress("time steps", (i - 1) / count) end
      if ok then ok, message, details = advance(self, report, step) end
      if not ok then return nil, message, details end
      record(self)
    end
    return true
  end
  return followed.step(self, steps)
end

--- Sets the time step. Recorded signals become empty: their values are a time step apart.
function methods:pace(seconds)
  if type(seconds) ~= "number" or not (seconds > 0 and seconds < math.huge) then
    raise(("pace: a time step in seconds above 0 expected, got %s"):format(core.got(seconds)))
  end
  self.opts.step = seconds
  for name in pairs(self.signals) do self.signals[name] = {} end
  return self
end

--- Finds the steady state. After a failure the flow is as it was.
function methods:settle()
  return followed.step(self, function(report) return advance(self, report, 0) end)
end

--- Records `value(flow)`, a number, after every step; without `value` the recording ends.
function methods:record(name, value)
  if value ~= nil and type(value) ~= "function" then
    raise(("record: a function of the flow that returns a number expected, got %s"):format(core.got(value)))
  end
  self.watched[name], self.signals[name] = value, value and {}
  return self
end

--- Frequency (1/s) of a recorded signal, from its last whole periods; 0 where it does not oscillate.
function methods:frequency(name, periods)
  local signal = self.signals[name]
  if not signal then
    raise(("frequency: no signal '%s' is recorded: call record before the steps"):format(tostring(name)))
  end
  if periods and periods < 1 then
    raise(("frequency: 1 period or more expected, got %s"):format(core.got(periods)))
  end
  return core.flow.frequency(signal, self.opts.step, periods or 5)
end

--- Force x, y of the fluid on the edges with a tag, per depth, N/m.
function methods:force(tag) return self.body:force(tag) end

--- Heat flow into the fluid through the edges with a tag, over density times heat capacity, K m2/s.
function heat_methods:heat(tag) return self.body:heat(tag) end

--- Velocity x, y, pressure, and temperature if there is one.
function methods:at(x, y) return self.body:at(x, y) end

--- Pressure at one place less that at another.
function methods:pressure_drop(from, to)
  local _, _, before = self:at(from[1], from[2])
  local _, _, after = self:at(to[1], to[2])
  return before - after
end

--- Drag and lift coefficients of a tag: forces along and across the stream over density / 2 times
--- velocity squared times length. `stream`: its direction, default {1, 0}.
function methods:coefficients(tag, reference)
  local opts = options.read("coefficients", reference, {
    velocity = {type = "number", needed = true, above = 0},
    length = {type = "number", needed = true, above = 0},
    stream = {type = "table", default = {1, 0}},
  })
  arguments.pair("coefficients: option 'stream'", opts.stream)
  local x, y = self:force(tag)
  local along, across = opts.stream[1], opts.stream[2]
  if along == 0 and across == 0 then raise "coefficients: option 'stream': a direction expected, got {0, 0}" end
  local unit = 0.5 * self.opts.density * opts.velocity ^ 2 * opts.length
    * math.sqrt(along * along + across * across)
  return (x * along + y * across) / unit, (y * along - x * across) / unit
end

--- Heat through the edges with a tag, over what conduction carries at a difference of temperatures
--- through a body as wide as it is thick. For a square heated at one side: the Nusselt number.
function heat_methods:nusselt(tag, difference)
  return self:heat(tag) / (self.opts.diffusivity * difference)
end

local function class(what, names, with_heat)
  local made = followed.class(what, names, {signals = function(self) return rawget(self, "recorded") end})
  for name, method in pairs(methods) do made[name] = method end
  for name, method in pairs(with_heat and heat_methods or {}) do made[name] = method end
  made.finish, made.keep, made.marches = finish, keep, marches
  arguments.methods(what, made, made, {drag = "handle: any, by: any", become = "outline: any",
    step = "count?: any", pace = "seconds: any", settle = "", record = "name: string, value?: function",
    frequency = "name: string, periods?: integer", force = "tag: string", at = "x: number, y: number",
    pressure_drop = "from: pair, to: pair", coefficients = "tag: string, reference: options",
    heat = with_heat and "tag: string" or nil, nusselt = with_heat and "tag: string, difference: number" or nil})
  function made.start(self)
    rawset(self, "recorded", {})
    rawset(self, "watched", {})
    if not self.opts.steady then return self end
    return followed.solve(self)
  end
  return made
end

-- ---- making --------------------------------------------------------------------------------------

local function with(more)
  local all = followed.with(followed.solved {
    density = {type = "number", default = 1, above = 0},
    viscosity = {type = "number", needed = true, above = 0},
    gravity = {type = "table", default = {0, 0}},
    conditions = {type = "table", default = {}},
    step = {type = "number", above = 0},
    steady = {type = "boolean", default = false},
    bdf = {type = "integer", default = 2, min = 1, max = 2},
    iterations = {type = "integer", default = 0, min = 0},
    tolerance = {type = "number", default = 1e-8, above = 0},
    ale = {type = "boolean", default = false},
  })
  for key, rule in pairs(more) do all[key] = rule end
  return all
end

local function create(where, made, given, rules, components)
  local opts = options.read(where, given, rules)
  for i = 1, 2 do
    if #opts.gravity ~= 2 or type(opts.gravity[i]) ~= "number" then
      raise(("%s: option 'gravity': {x, y} expected, got %s"):format(where, core.got(opts.gravity)))
    end
  end
  local list
  list, opts.conditions = conditions.read(where, opts.conditions, components, "wall")
  return followed.object(made, opts, core.flow.create(opts.outline,
    followed.mesh(where, opts, list), opts.follow, {density = opts.density,
      viscosity = opts.viscosity, gravity = opts.gravity, diffusivity = opts.diffusivity,
      expansion = opts.expansion, reference = opts.reference}, list))
end

local fields = {"time", "velocity", "pressure", "vorticity"}
local flow = class("flow", fields)
local thermal = class("thermal flow", {"temperature", table.unpack(fields)}, true)

--- Incompressible flow. drag moves the outline, step advances the time; with `steady` every drag finds the
--- steady state again.
function flows.flow(given)
  return create("flow", flow, given, with {}, {"x", "y"})
end

--- The same with heat, which the flow carries along and which lifts the fluid.
function flows.thermal(given)
  return create("thermal", thermal, given, with {
    diffusivity = {type = "number", needed = true, above = 0},
    expansion = {type = "number", default = 0},
    reference = {type = "number", default = 0},
  }, {"x", "y", "", "temperature"})
end

return flows
