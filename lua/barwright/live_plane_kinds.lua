-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The analyses that the plane's live view shows, a table each by the name of its class: what can be
-- coloured, how the deformed shape is drawn, whether time goes on by itself, which numbers are shown.
--
-- A field has `key`, `name`, `unit` with the `scale` that leads to it from SI, `signed` (the colours
-- are symmetric about zero), `full_range` (they go from the lowest to the highest), and `values` of an
-- object: an array of a number a node, or nil while there are none. `arrows`: rows x, y.
-- `deform`: displacements (rows x, y) or deflections out of the plane (a number each). `limit` of
-- stress, where none is asked for; `hole_tag` of new holes; `mirror`: what is shown is the right half.
local pitch = require "barwright.pitch"
local core = require "barwright.core"
local shown = require "barwright.shown"

local kinds = {}

local function property(name)
  return function(object) return object[name] end
end

local function length_of(name)
  return function(object)
    local rows = object[name]
    return rows and rows:map "sqrt(a[1]^2 + a[2]^2)"
  end
end

local function stress(column)
  return function(object) return object.stress:column(column) end
end

local von_mises = {key = "von_mises", name = "von Mises stress", unit = "MPa", scale = 1e-6,
  values = property "von_mises"}
local displacement = {key = "displacement", name = "displacement", unit = "mm", scale = 1e3,
  values = length_of "displacement"}
local stresses = {
  {key = "stress_xx", name = "stress xx", unit = "MPa", scale = 1e-6, signed = true, values = stress(1)},
  {key = "stress_yy", name = "stress yy", unit = "MPa", scale = 1e-6, signed = true, values = stress(2)},
  {key = "stress_xy", name = "stress xy", unit = "MPa", scale = 1e-6, signed = true, values = stress(3)},
}

local function largest(array)
  return array and array:max() or 0
end

local function moved(object)
  return {"largest displacement", core.quantity(largest(length_of "displacement"(object)), "m")}
end

kinds["steady sheet"] = {
  title = "Sheet under load",
  fields = {von_mises, displacement, table.unpack(stresses)},
  deform = property "displacement",
  stress = true,
  readouts = function(object) return {moved(object)} end,
}

kinds["bridge"] = {
  title = "Bridge",
  fields = {von_mises, displacement, table.unpack(stresses)},
  deform = property "displacement",
  stress = true,
  limit = property "stress_limit",
  hole_tag = "free",
  mirror = true,
  readouts = function(object)
    return {{"area of both halves", core.quantity(object.area, "m2")},
      {"largest stress", ("%s of %s: %s"):format(shown.percent(object.utilisation),
        core.quantity(object.stress_limit, "Pa"), object.passes and "passes" or "fails")}, moved(object)}
  end,
}

kinds["large-deflection sheet"] = {
  title = "Large-deflection sheet",
  fields = {von_mises, displacement, table.unpack(stresses)},
  deform = property "displacement",
  true_size = true, -- drawn with its true displacements
  stress = true,
  readouts = function(object)
    return {moved(object), {"Newton iterations", tostring(object.reused.newton_iterations or 0)}}
  end,
}

kinds["transient sheet"] = {
  title = "Transient sheet",
  fields = {von_mises, displacement, {key = "velocity", name = "velocity", unit = "m/s", scale = 1,
    values = length_of "velocity"}, table.unpack(stresses)},
  deform = property "displacement",
  stress = true,
  steps = true,
  readouts = function(object) return {moved(object)} end,
}

-- How a stroke sounds where the lowest mode deflects most: as in the bar's :tone.
local loss = 0.002
local function tone(object)
  return {frequencies = object.frequencies:totable(),
    gains = object:gains({loss = loss}):map("abs(a)"):totable(), loss = loss}
end

kinds["metallophone bar"] = {
  title = "Metallophone bar",
  fields = {{key = "mode", name = "lowest mode", unit = "", scale = 1, signed = true,
    values = function(object) return object:mode(1):column(1) end}},
  deform = function(object) return object:mode(1):column(1) end,
  tune = true,
  lines = property "nodal_lines",
  header = function(object, header)
    header.frequency = object.frequency
    header.note, header.cents = pitch.note(object.frequency)
    header.tone = tone(object)
    local holes = object:holes()
    header.holes = holes or nil
  end,
  readouts = function(object)
    local list = {}
    local frequencies = object.frequencies:totable()
    for k = 2, math.min(6, #frequencies) do
      list[#list + 1] = {("mode %d"):format(k), ("%s, %.3f times"):format(core.quantity(frequencies[k], "Hz"),
        frequencies[k] / frequencies[1])}
    end
    return list
  end,
}

local speed = {key = "speed", name = "speed", unit = "m/s", scale = 1, values = length_of "velocity"}
local pressure = {key = "pressure", name = "pressure", unit = "Pa", scale = 1, full_range = true,
  values = property "pressure"}
local vorticity = {key = "vorticity", name = "vorticity", unit = "1/s", scale = 1, signed = true,
  values = property "vorticity"}

-- Whether a flow goes on in time: one without a step is steady.
local function flow_steps(object) return object.opts.step ~= nil end

-- Names of tags whose condition is so.
local function tags_where(object, is_so)
  local list = {}
  for _, tag in ipairs(object.outline.tags) do
    local condition = object.opts.conditions[tag]
    if condition ~= nil and is_so(condition) then list[#list + 1] = tag end
  end
  table.sort(list)
  return list
end

-- Forces on bodies: on walls, drag first.
local function forces(object)
  local list = {}
  if not (object.time > 0 or object.opts.steady) then return list end
  for _, tag in ipairs(tags_where(object, function(c) return c == "wall" end)) do
    local x, y = object:force(tag)
    list[#list + 1] = {"force on " .. tag, shown.vector({x, y}, "N/m")}
  end
  return list
end

-- Heat through what has a condition of it, over density times heat capacity.
local function heats(object)
  local list = {}
  if not (object.time > 0 or object.opts.steady) then return list end
  for _, tag in ipairs(tags_where(object, function(c)
    return type(c) == "table" and (c.temperature or c.heat_flux or c.convection)
  end)) do
    list[#list + 1] = {"heat in at " .. tag, core.quantity(object:heat(tag), "K m2/s")}
  end
  return list
end

kinds["flow"] = {
  title = "Flow",
  fields = {pressure, speed, vorticity},
  arrows = property "velocity",
  steps = flow_steps,
  readouts = forces,
}

kinds["thermal flow"] = {
  title = "Flow with heat",
  fields = {{key = "temperature", name = "temperature", unit = "K", scale = 1, full_range = true,
    values = property "temperature"}, speed, pressure, vorticity},
  arrows = property "velocity",
  steps = flow_steps,
  readouts = heats,
}

--- What is known of an object's class, or nil.
local function of(object)
  local meta = getmetatable(object)
  local name = type(meta) == "table" and type(meta.__name) == "string" and type(object) == "table"
    and meta.__name:match "^barwright%.(.*)$"
  return name and kinds[name] or nil
end

--- The fields of an object's kind that it has.
local function fields(kind)
  local out = {}
  for i, field in ipairs(kind.fields) do
    out[i] = {key = field.key, name = field.name, unit = field.unit, scale = field.scale,
      signed = field.signed or false, full_range = field.full_range or false}
  end
  return out
end

return {of = of, fields = fields, kinds = kinds}
