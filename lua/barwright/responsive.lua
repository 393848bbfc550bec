-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- bw.responsive: analyses that keep up with an outline while it is dragged. Here those of elastic
-- sheets: steady, vibration, cantilever.
--
-- An object holds its last good state: a drag that the outline, the mesh or the solution refuses
-- returns nil, message, details, and everything is as it was before.
local core = require "barwright.core"
local options = require "barwright.options"
local members = require "barwright.members"

local raise = core.raise

local responsive = {}

-- ---- conditions ----------------------------------------------------------------------------------

local condition_keys = {"x", "y", "traction", "pressure"}

local function add_pair(list, tag, kind, pair, where)
  if type(pair) ~= "table" or #pair ~= 2 then
    raise(("%s: %s of '%s': two values {x, y} expected"):format(where, kind, tag))
  end
  for component = 1, 2 do
    if pair[component] ~= 0 or kind == "prescribed" then
      list[#list + 1] = {tag = tag, kind = kind, component = component, value = pair[component]}
    end
  end
end

-- {tag = "fixed" | {x = , y = , traction = {x, y}, pressure = }} as the list of the engine, in the
-- order of the tags' names, prescribed values last
local function read_conditions(where, given)
  local tags, loads, held = {}, {}, {}
  for tag, one in pairs(given) do
    if type(tag) ~= "string" then
      raise(("%s: conditions are named by tags of the outline: {tag = ...}"):format(where))
    end
    if one ~= "fixed" and type(one) ~= "table" then
      raise(("%s: condition of '%s': \"fixed\" or a table expected, got %s"):format(where, tag,
        type(one)))
    end
    tags[#tags + 1] = tag
  end
  table.sort(tags)
  for _, tag in ipairs(tags) do
    local one = given[tag]
    if one == "fixed" then one = {x = 0, y = 0} end
    for key in pairs(one) do
      local known = false
      for _, name in ipairs(condition_keys) do known = known or key == name end
      if not known then
        raise(("%s: condition of '%s': unknown key '%s': did you mean '%s'?"):format(where, tag,
          tostring(key), core.nearest(tostring(key), condition_keys)))
      end
    end
    if one.traction then add_pair(loads, tag, "traction", one.traction, where) end
    if one.pressure then loads[#loads + 1] = {tag = tag, kind = "pressure", value = one.pressure} end
    for component, key in ipairs {"x", "y"} do
      if one[key] ~= nil then
        held[#held + 1] = {tag = tag, kind = "prescribed", component = component, value = one[key]}
      end
    end
  end
  return table.move(held, 1, #held, #loads + 1, loads)
end

-- ---- what was reused, in a line ------------------------------------------------------------------

local kept_meta = {}

--- One line: level, what was kept, iterations.
function kept_meta:__tostring()
  local kept = {}
  if self.level == "none" then
    kept[1] = "mesh"
  elseif self.level ~= "reconstruction" then
    kept[1] = "nodes"
  end
  if self.pattern then kept[#kept + 1] = "pattern" end
  if self.factor and self.factorisations == 0 then kept[#kept + 1] = "factor" end
  if self.solution then kept[#kept + 1] = "solution" end
  return ("%s%s; kept %s; %d factorisation%s, %d iteration%s"):format(self.level,
    self.flips > 0 and (" (%d flips)"):format(self.flips) or "",
    #kept > 0 and table.concat(kept, ", ") or "nothing",
    self.factorisations, self.factorisations == 1 and "" or "s",
    self.iterations, self.iterations == 1 and "" or "s")
end

local function frame()
  return setmetatable({level = "none", flips = 0, solves = 0, factorisations = 0, iterations = 0},
    kept_meta)
end

-- ---- what the applications share -----------------------------------------------------------------

local rules = {
  outline = {type = "outline", needed = true},
  material = {type = "any", needed = true},
  thickness = {type = "any", default = 1},
  plane = {type = "string", default = "stress", one_of = {"stress", "strain"}},
  conditions = {type = "table", default = {}},
  gravity = {type = "table", default = {0, 0}},
  elements = {type = "integer", least = 1},
  size = {type = "number", above = 0},
  order = {type = "integer", default = 1, least = 1, most = 2},
  follow = {type = "table", default = {}},
  solver = {type = "table", default = {}},
}

local function with(more)
  local all = {}
  for key, rule in pairs(rules) do all[key] = rule end
  for key, rule in pairs(more) do all[key] = rule end
  return all
end

local function is_list(value)
  return type(value) == "table" and #value > 0
end

-- One section, or one for each region.
local function read_sections(where, wish)
  local count = math.max(is_list(wish.material) and #wish.material or 1,
    is_list(wish.thickness) and #wish.thickness or 1)
  local sections = {}
  for i = 1, count do
    local material = is_list(wish.material) and wish.material[i] or wish.material
    local thickness = is_list(wish.thickness) and wish.thickness[i] or wish.thickness
    options.object(where, "material", material, "material")
    if type(thickness) ~= "number" then
      raise(("%s: option 'thickness': a number, or one for each region, expected"):format(where))
    end
    sections[i] = {material = material, thickness = thickness, strain = wish.plane == "strain"}
  end
  return sections
end

local function create(where, class, given, own_rules, add_conditions)
  local wish = options.read(where, given, own_rules)
  if #wish.gravity ~= 2 then raise(("%s: option 'gravity': {x, y} expected"):format(where)) end
  local conditions = read_conditions(where, wish.conditions)
  if add_conditions then add_conditions(where, wish, conditions) end
  local sheet, message, details = core.sheet.create(wish.outline,
    {order = wish.order, size = wish.size, elements = wish.elements}, wish.follow,
    read_sections(where, wish), conditions, wish.gravity)
  if not sheet then return nil, message, details end
  local self = setmetatable({sheet = sheet, wish = wish, last = frame()}, class)
  if class.start then
    local fine
    fine, message, details = class.start(self)
    if not fine then return nil, message, details end
  end
  return self
end

local properties = {
  outline = function(self) return rawget(self, "sheet").outline end,
  reused = function(self) return rawget(self, "last") end,
  time = function(self) return rawget(self, "sheet").time end,
  element_count = function(self) return (rawget(self, "sheet"):counts()) end,
  node_count = function(self) return (select(2, rawget(self, "sheet"):counts())) end,
}
for _, name in ipairs {"displacement", "velocity", "acceleration", "stress", "von_mises",
  "error_estimate", "points", "elements"} do
  properties[name] = function(self) return rawget(self, "sheet")[name] end
end

local function class_of(what)
  local class = {}
  class.__index = members(what, class, properties)
  class.__name = "barwright." .. what
  function class:__tostring()
    local elements, nodes = self.sheet:counts()
    return ("%s: %d triangles, %d nodes; %s"):format(what, elements, nodes, tostring(self.last))
  end
  return class
end

local function now_is(self, report, fine, message, details)
  if not fine then return nil, message, details end
  rawset(self, "last", report)
  return self
end

-- A frame: mesh and sheet go over to an outline, the class's `finish` solves. What fails is taken back.
local function become(self, outline)
  options.object("become", "outline", outline, "outline")
  local sheet, finish = self.sheet, getmetatable(self).finish
  local before, report = sheet.outline, frame()
  local fine, message, details = sheet:follow(report, outline)
  if fine and finish then
    fine, message, details = finish(self, report)
    if not fine then
      local back = frame()
      local returned, why = sheet:follow(back, before)
      if returned then returned, why = finish(self, back) end
      if not returned then
        message = ("%s; and the state before could not be restored: %s"):format(message, why)
      end
    end
  end
  return now_is(self, report, fine, message, details)
end

local function drag(self, handle, by)
  local moved, message, details = self.sheet.outline:moved(handle, by)
  if not moved then return nil, message, details end
  return become(self, moved)
end

local function solve(self)
  local report = frame()
  return now_is(self, report, getmetatable(self).finish(self, report))
end

-- ---- steady --------------------------------------------------------------------------------------

local steady = class_of "steady sheet"
steady.drag, steady.become = drag, become

function steady.finish(self, report)
  return self.sheet:static(report, self.wish.solver)
end

steady.solve, steady.start = solve, solve

--- The p-norm of von Mises stresses (their power mean over the area), its gradient by the outline's
--- points, and by the mesh's nodes.
function steady:stress_norm(p)
  return self.sheet:stress_norm(p)
end

--- Linear statics of a sheet, solved anew in every drag.
function responsive.steady(given)
  return create("steady", steady, given, with {})
end

-- ---- cantilever: large deflection ----------------------------------------------------------------

local cantilever = class_of "bent sheet"
cantilever.drag, cantilever.become = drag, become

function cantilever.finish(self, report)
  return self.sheet:bend(report, self.wish.solver, self.wish.newton)
end

cantilever.solve, cantilever.start = solve, solve

--- Equilibrium of a sheet that bends largely (St. Venant-Kirchhoff), found anew in every drag.
function responsive.cantilever(given)
  return create("cantilever", cantilever, given, with {newton = {type = "table", default = {}}})
end

-- ---- vibration -----------------------------------------------------------------------------------

local vibration = class_of "shaken sheet"
vibration.drag, vibration.become = drag, become

-- {x = , y = } of the tags that stand on the ground
local function stand_on_ground(where, wish, list)
  local ground = type(wish.ground) == "string" and {wish.ground} or wish.ground or {}
  if type(ground) ~= "table" then raise(("%s: option 'ground': a tag expected"):format(where)) end
  for key in pairs(wish.shake) do
    if key ~= "x" and key ~= "y" then
      raise(("%s: option 'shake': {x = , y = } expected"):format(where))
    end
  end
  for _, tag in ipairs(ground) do
    for component, key in ipairs {"x", "y"} do
      list[#list + 1] = {tag = tag, component = component, value = wish.shake[key] or 0}
    end
  end
end

--- Advances by `count` time steps (default 1).
function vibration:step(count)
  local wish, report = self.wish, frame()
  local fine, message, details = self.sheet:shake(report, wish.solver, {step = wish.step,
    beta = wish.beta, gamma = wish.gamma, damping_mass = wish.damping[1],
    damping_stiffness = wish.damping[2]}, count)
  -- a drag and the steps after it are one frame
  local last = self.last
  if last.solves == 0 and last.level ~= "none" then
    report.level, report.flips, report.quality = last.level, last.flips, last.quality
    report.seconds_mesh = last.seconds_mesh
  end
  return now_is(self, report, fine, message, details)
end

--- A sheet on ground that shakes: `shake = {x = , y = }`, displacements by number, formula in x, y, t,
--- or function, at the tags of `ground`. drag moves the outline, step the time.
function responsive.vibration(given)
  return create("vibration", vibration, given, with {
    ground = {type = "any"},
    shake = {type = "table", default = {}},
    step = {type = "number", default = 1e-3, above = 0},
    beta = {type = "number", default = 0.25},
    gamma = {type = "number", default = 0.5},
    damping = {type = "table", default = {0, 0}},
  }, stand_on_ground)
end

return responsive
