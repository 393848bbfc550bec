-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Conditions of bodies that follow an outline, by the names of its tags.
local core = require "barwright.core"

local raise = core.raise

local conditions = {}

local function add_pair(list, tag, kind, pair, where)
  if type(pair) ~= "table" or #pair ~= 2 then
    raise(("%s: %s of '%s': two values {x, y} expected, got %s"):format(where, kind, tag, core.got(pair)))
  end
  for component = 1, 2 do
    if pair[component] ~= 0 or kind == "prescribed" then
      list[#list + 1] = {tag = tag, kind = kind, component = component, value = pair[component]}
    end
  end
end

-- Heat through the edges of a tag: a flux into the fluid, or convection {coefficient, temperature}.
local function add_heat(list, tag, one, component, where)
  if one.heat_flux ~= nil then
    list[#list + 1] = {tag = tag, kind = "traction", component = component, value = one.heat_flux}
  end
  local c = one.convection
  if c == nil then return end
  for key in pairs(type(c) == "table" and c or {}) do
    if key ~= "coefficient" and key ~= "temperature" then
      raise(("%s: convection of '%s': unknown key '%s': %s"):format(where, tag,
        tostring(key), core.suggestion(tostring(key), {"coefficient", "temperature"})))
    end
  end
  local coefficient = type(c) == "table" and c.coefficient
  if type(coefficient) ~= "number" or coefficient ~= coefficient or coefficient < 0
    or coefficient == math.huge or c.temperature == nil then
    raise(("%s: convection of '%s': {coefficient = m/s, at least 0, temperature = of what is around} expected, "
      .. "got %s"):format(where, tag, type(c) == "table" and "coefficient = " .. core.got(c.coefficient)
      .. ", temperature = " .. core.got(c.temperature) or core.got(c)))
  end
  if one.temperature ~= nil then
    raise(("%s: condition of '%s': a prescribed temperature excludes convection: "
      .. "give one of them"):format(where, tag))
  end
  list[#list + 1] = {tag = tag, kind = "convection", component = component, value = c.temperature,
    coefficient = coefficient}
end

-- The conditions as a list of {tag =, one =, order =}, and by tag. Those of one table have no order, and
-- the names give none; in a list of tables later ones decide over earlier ones.
local function by_tag(where, given, word)
  local listed = rawlen(given) > 0
  local rows, conditions_by_tag, tables = {}, {}, listed and given or {given}
  for key in pairs(listed and given or {}) do
    if math.type(key) ~= "integer" then
      raise(("%s: conditions are {tag = ...} or a list {{tag = ...}, {tag = ...}}, not both: '%s' is beside "
        .. "the list"):format(where, tostring(key)))
    end
  end
  for order = 1, rawlen(tables) do
    local group = tables[order]
    if type(group) ~= "table" then
      raise(("%s: entry %d of the list of conditions: {tag = ...} expected, got %s"):format(where, order,
        core.got(group)))
    end
    for tag, one in pairs(group) do
      if type(tag) ~= "string" then
        raise(("%s: conditions are named by tags of the outline: {tag = ...}"):format(where))
      end
      if one ~= word and type(one) ~= "table" then
        raise(("%s: condition of '%s': \"%s\" or a table expected, got %s"):format(where, tag, word,
          core.got(one)))
      end
      if conditions_by_tag[tag] then
        raise(("%s: the list of conditions names '%s' twice: give its conditions in one entry"):format(where, tag))
      end
      conditions_by_tag[tag] = one
      rows[#rows + 1] = {tag = tag, one = one, order = order}
    end
  end
  table.sort(rows, function(a, b) return a.tag < b.tag end) -- the same list in every run
  return rows, conditions_by_tag
end

--- {tag = "fixed" | {x = , y = , traction = {x, y}, pressure = }} as the list of the engine, prescribed
--- values last; or a list of such tables, whose later entries decide over earlier ones where tags meet.
--- Where a temperature is known also heat_flux and
--- convection = {coefficient = , temperature = }, over density times heat capacity.
--- `components`: names of what may be prescribed, in the engine's order ("" for none at that place).
--- `word`: what stands for x and y being 0 ("fixed").
--- Also returns the conditions by tag.
function conditions.read(where, given, components, word)
  local loads, fixed, keys = {}, {}, {"traction", "pressure"}
  word = word or "fixed"
  local heat
  for component, name in ipairs(components) do
    if name ~= "" then keys[#keys + 1] = name end
    if name == "temperature" then heat = component end
  end
  if heat then keys[#keys + 1], keys[#keys + 2] = "heat_flux", "convection" end
  local rows, conditions_by_tag = by_tag(where, given, word)
  for _, row in ipairs(rows) do
    local tag, one = row.tag, row.one
    if one == word then one = {[components[1]] = 0, [components[2]] = 0} end
    for key in pairs(one) do
      local known = false
      for _, name in ipairs(keys) do known = known or key == name end
      if not known then
        raise(("%s: condition of '%s': unknown key '%s': %s"):format(where, tag,
          tostring(key), core.suggestion(tostring(key), keys)))
      end
    end
    if one.traction then add_pair(loads, tag, "traction", one.traction, where) end
    if one.pressure then loads[#loads + 1] = {tag = tag, kind = "pressure", value = one.pressure} end
    if heat then add_heat(loads, tag, one, heat, where) end
    for component, key in ipairs(components) do
      if one[key] ~= nil then
        fixed[#fixed + 1] = {tag = tag, kind = "prescribed", component = component, value = one[key],
          order = row.order}
      end
    end
  end
  return table.move(fixed, 1, #fixed, #loads + 1, loads), conditions_by_tag
end

return conditions
