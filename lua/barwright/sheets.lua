-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Elastic sheets that keep up with an outline while it is dragged: steady, vibration, cantilever.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local conditions = require "barwright.conditions"
local followed = require "barwright.followed"
local options = require "barwright.options"

local raise = core.raise

local sheets = {}

local fields = {"time", "displacement", "velocity", "acceleration", "stress", "von_mises",
  "error_estimate", "mesh"}

local function with(more)
  local all = followed.with(followed.solved {
    material = {type = "any", needed = true},
    thickness = {type = "any", default = 1},
    plane = {type = "string", default = "stress", one_of = {"stress", "strain"}},
    conditions = {type = "table", default = {}},
    gravity = {type = "table", default = {0, 0}},
    order = {type = "integer", default = 1, min = 1, max = 2},
  })
  for key, rule in pairs(more) do all[key] = rule end
  return all
end

local function is_list(value)
  return type(value) == "table" and rawlen(value) > 0
end

-- One section, or one for each region.
local function read_sections(where, opts)
  local count = math.max(is_list(opts.material) and #opts.material or 1,
    is_list(opts.thickness) and #opts.thickness or 1)
  local sections = {}
  for i = 1, count do
    local material = is_list(opts.material) and opts.material[i] or opts.material
    local thickness = is_list(opts.thickness) and opts.thickness[i] or opts.thickness
    options.object(where, "material", material, "material")
    if type(thickness) ~= "number" then
      raise(("%s: option 'thickness': a number above 0 (m), or a list of one for each region, expected, got %s")
        :format(where, core.got(thickness)))
    end
    sections[i] = {material = material, thickness = thickness, strain = opts.plane == "strain"}
  end
  return sections
end

-- Two finite numbers, `min` or more.
local function check_pair(where, key, pair, min)
  for i = 1, 2 do
    local value = pair[i]
    if #pair ~= 2 or type(value) ~= "number" or value ~= value or math.abs(value) == math.huge
      or value < min then
      raise(("%s: option '%s': two numbers%s expected, entry %d is %s"):format(where, key,
        min == 0 and " of 0 or more" or " {x, y}", i, core.got(value)))
    end
  end
end

local function create(where, class, given, own_rules, add_conditions)
  local opts = options.read(where, given, own_rules)
  check_pair(where, "gravity", opts.gravity, -math.huge)
  local list
  list, opts.conditions = conditions.read(where, opts.conditions, {"x", "y"})
  if opts.damping then check_pair(where, "damping", opts.damping, 0) end
  if add_conditions then add_conditions(where, opts, list) end
  return followed.object(class, opts, core.sheet.create(opts.outline,
    followed.mesh(where, opts, list), opts.follow,
    read_sections(where, opts), list, opts.gravity))
end

-- ---- steady --------------------------------------------------------------------------------------

local steady = followed.class("steady sheet", fields)
steady.drag, steady.become = followed.drag, followed.become

function steady.finish(self, report)
  return self.body:static(report, followed.linear(self))
end

steady.solve, steady.start = followed.solve, followed.solve

--- The p-norm of von Mises stresses (their power mean over the area), its gradient by the outline's
--- points, and by the mesh's nodes.
function steady:stress_norm(p)
  return self.body:stress_norm(p)
end

--- Linear statics of a sheet, solved again in every drag.
function sheets.steady(given)
  return create("steady", steady, given, with {})
end

-- ---- cantilever: large deflection ----------------------------------------------------------------

local cantilever = followed.class("large-deflection sheet", fields)
cantilever.drag, cantilever.become = followed.drag, followed.become

function cantilever.finish(self, report)
  return self.body:large_deflection(report, followed.linear(self), self.opts.newton)
end

cantilever.solve, cantilever.start = followed.solve, followed.solve

--- Equilibrium of a sheet that bends largely (St. Venant-Kirchhoff), recomputed in every drag.
function sheets.cantilever(given)
  return create("cantilever", cantilever, given, with {newton = {type = "table", default = {}}})
end

-- ---- vibration -----------------------------------------------------------------------------------

local vibration = followed.class("transient sheet", fields)
vibration.drag, vibration.become = followed.drag, followed.become

function vibration.marches() return true end

-- {x = , y = } of the tags that stand on the ground
local function stand_on_ground(where, opts, list)
  local ground = type(opts.ground) == "string" and {opts.ground} or opts.ground or {}
  if type(ground) ~= "table" then
    raise(("%s: option 'ground': a tag or a list of tags expected, got %s"):format(where, core.got(ground)))
  end
  for key in pairs(opts.ground_motion) do
    if key ~= "x" and key ~= "y" then
      raise(("%s: option 'ground_motion': {x = , y = } expected, got the key '%s'"):format(where, tostring(key)))
    end
  end
  for _, tag in ipairs(ground) do
    for component, key in ipairs {"x", "y"} do -- after all conditions: the ground decides
      list[#list + 1] = {tag = tag, component = component, value = opts.ground_motion[key] or 0,
        order = math.maxinteger >> 33}
    end
  end
end

--- Advances by `count` time steps (default 1).
function vibration:step(count)
  if count ~= nil and (math.type(count) ~= "integer" or count < 1) then
    raise(("step: a whole number of steps above 0 expected, got %s"):format(core.got(count)))
  end
  local opts = self.opts
  return followed.step(self, function(report)
    return self.body:transient(report, followed.linear(self), {step = opts.step, beta = opts.beta,
      gamma = opts.gamma, damping_mass = opts.damping[1], damping_stiffness = opts.damping[2]}, count)
  end)
end

--- A sheet on moving ground: `ground_motion = {x = , y = }`, displacements by number, formula in x, y, t,
--- or function, at the tags of `ground`. drag moves the outline, step the time.
function sheets.vibration(given)
  return create("vibration", vibration, given, with {
    ground = {type = "any"},
    ground_motion = {type = "table", default = {}},
    step = {type = "number", default = 1e-3, above = 0},
    beta = {type = "number", default = 0.25, min = 0},
    gamma = {type = "number", default = 0.5, min = 0},
    damping = {type = "table", default = {0, 0}},
  }, stand_on_ground)
end

local shared = {drag = "handle: any, by: any", become = "outline: any"}
local classes = {
  ["steady sheet"] = steady, ["large-deflection sheet"] = cantilever, ["transient sheet"] = vibration,
}
for name, class in pairs(classes) do
  arguments.methods(name, class, class, shared)
end
arguments.methods("steady sheet", steady, steady, {solve = "", stress_norm = "p: number"})
arguments.methods("large-deflection sheet", cantilever, cantilever, {solve = ""})
arguments.methods("transient sheet", vibration, vibration, {step = "count?: any"})

return sheets
