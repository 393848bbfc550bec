-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Conditions of bodies that follow an outline, by the names of its tags.
local core = require "barwright.core"

local raise = core.raise

local conditions = {}

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

--- {tag = "fixed" | {x = , y = , traction = {x, y}, pressure = }} as the list of the engine, in the
--- order of the tags' names, prescribed values last.
--- `components`: names of what may be prescribed, in the engine's order ("" for none at that place).
--- `word`: what stands for x and y being 0 ("fixed").
function conditions.read(where, given, components, word)
  local tags, loads, held, keys = {}, {}, {}, {"traction", "pressure"}
  word = word or "fixed"
  for _, name in ipairs(components) do
    if name ~= "" then keys[#keys + 1] = name end
  end
  for tag, one in pairs(given) do
    if type(tag) ~= "string" then
      raise(("%s: conditions are named by tags of the outline: {tag = ...}"):format(where))
    end
    if one ~= word and type(one) ~= "table" then
      raise(("%s: condition of '%s': \"%s\" or a table expected, got %s"):format(where, tag, word,
        type(one) == "string" and ("'%s'"):format(one) or type(one)))
    end
    tags[#tags + 1] = tag
  end
  table.sort(tags)
  for _, tag in ipairs(tags) do
    local one = given[tag]
    if one == word then one = {[components[1]] = 0, [components[2]] = 0} end
    for key in pairs(one) do
      local known = false
      for _, name in ipairs(keys) do known = known or key == name end
      if not known then
        raise(("%s: condition of '%s': unknown key '%s': did you mean '%s'?"):format(where, tag,
          tostring(key), core.nearest(tostring(key), keys)))
      end
    end
    if one.traction then add_pair(loads, tag, "traction", one.traction, where) end
    if one.pressure then loads[#loads + 1] = {tag = tag, kind = "pressure", value = one.pressure} end
    for component, key in ipairs(components) do
      if one[key] ~= nil then
        held[#held + 1] = {tag = tag, kind = "prescribed", component = component, value = one[key]}
      end
    end
  end
  return table.move(held, 1, #held, #loads + 1, loads)
end


return conditions
