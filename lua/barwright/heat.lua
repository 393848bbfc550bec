-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Heat: files and pictures of temperatures, and steps in time with histories and a chosen error.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local fine_boundary = require "barwright.fine_boundary"
local history = require "barwright.history"
local options = require "barwright.options"

local solution = core.classes.heat_solution.methods

--- Temperature, flux and reaction, as .vtu (or what the ending says).
function solution:write(path)
  return self.mesh:write(path, {fields = {
    temperature = {self.temperature, on = "nodes"}, heat_flux = {self.flux, on = "nodes"},
    reaction = {self.reaction, on = "nodes"}, element_heat_flux = {self.element_flux, on = "elements"}}})
end

--- The body coloured by its temperature; options of bw.picture.
function solution:picture(path, given)
  local opts = options.copied(given)
  local surface, nodes, details = fine_boundary(self.mesh)
  if not surface then return nil, nodes, details end
  opts.values = self.temperature:gather(nodes)
  opts.unit = opts.unit or "temperature, K"
  return core.picture(surface, path, opts)
end

-- The values of conditions as functions of time.
local function read_histories(given)
  local histories = {}
  for index, each in pairs(given) do
    local f, message, details = history.read(("run: the history of condition %s"):format(tostring(index)), each)
    if not f then return nil, message, details end
    histories[index] = f
  end
  return histories
end

local function set_values(heat, histories, time)
  for index, f in pairs(histories) do
    local value = history.value(("run: the history of condition %s"):format(tostring(index)), f, time)
    local ok, message, details = heat:set(index, value)
    if not ok then return nil, message, details end
  end
  return true
end

local transient = core.classes.heat_transient.methods

--- Steps to a time; see lua/stubs/heat.lua.
function transient:run(given)
  local opts = options.read("run", given, {
    time = {type = "number", needed = true, above = 0},
    step = {type = "number", needed = true, above = 0},
    tolerance = {type = "number", above = 0},
    histories = {type = "table", default = {}},
    each = {type = "function"},
  })
  local histories, why, about = read_histories(opts.histories)
  if not histories then return nil, why, about end
  local heat, first = self.heat, self.time
  local step, limit = opts.step, opts.tolerance
  while self.time < opts.time * (1 - 1e-12) do
    local left = opts.time - self.time
    local h = left < step * (1 + 1e-9) and left or step
    if limit and left > h and left < 2 * h then h = left / 2 end
    local ok, message, details = core.report_progress("time steps", (self.time - first) / (opts.time - first))
    if ok then ok, message, details = set_values(heat, histories, self.time + h) end
    if not ok then return nil, message, details end
    local taken, because, more = self:step(h, limit)
    if taken == nil then return nil, because, more end
    if taken and opts.each then opts.each(self.now) end
    if limit then -- the error of a step grows with a power of it: aim at a half of what is allowed
      local ratio = self.error > 0 and math.sqrt(0.5 * limit / self.error) or 1
      if not taken then
        step = h * math.max(0.1, math.min(0.5, ratio))
      elseif ratio > 1.5 then
        step = h * math.min(2, ratio)
      end
      if not taken and step < 1e-9 * opts.time then
        return nil, ("the step fell to %g s without reaching the tolerance of %g K: give a larger one, or a "
          .. "history without jumps"):format(step, limit), {status = "convergence", step = step}
      end
    end
  end
  return self.now
end

arguments.methods("heat_solution", solution, nil, {write = "path: string",
  picture = "path: string, options?: options"})
arguments.methods("heat_transient", transient, nil, {run = "options: options"})
