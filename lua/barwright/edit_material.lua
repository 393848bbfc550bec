-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Other materials in an edit session. A state has a list of {region =, material =}, where region nil is the
-- whole part; each row counts over those before it. Models get them on the mesh of the state, before
-- their axes turn with the bones.
local core = require "barwright.core"
local edit_script = require "barwright.edit_script"

local edit_material = {}

--- The list with another material in a region; what it covers is dropped.
function edit_material.changed(list, region, material)
  local out = {}
  for _, row in ipairs(region and list or {}) do
    if row.region ~= region then out[#out + 1] = row end
  end
  out[#out + 1] = {region = region, material = material}
  return out
end

--- Whether a value is such a list.
function edit_material.is_list(value)
  if type(value) ~= "table" then return false end
  for i = 1, rawlen(value) do
    local row = rawget(value, i)
    if type(row) ~= "table" or core.class_name(row.material) ~= "material" then return false end
    if row.region ~= nil and type(row.region) ~= "string" then return false end
  end
  return true
end

--- A model with the materials of a list, or nil, message, details.
function edit_material.apply(model, list)
  for _, row in ipairs(list) do
    local ok, message, details = core.set_material(model, row.material, row.region)
    if not ok then return nil, message, details end
  end
  return model
end

-- Constants that solving uses, in the words of bw.material.
local constants = {"name", "young", "poisson", "shear", "strength", "density", "toughness", "expansion"}

--- A material as Lua text: by its name in the library, or by its constants.
function edit_material.script(material)
  local module = 'require("barwright").material.'
  for _, name in ipairs(core.material.names()) do
    if tostring(core.material.named(name)) == tostring(material) then return module .. name end
  end
  local given = {}
  for _, key in ipairs(constants) do given[key] = material[key] end
  if material.isotropic then
    given.shear = nil
    return module .. "isotropic " .. edit_script.value(given)
  end
  given.axes = material.axes
  return module .. "orthotropic " .. edit_script.value(given)
end

return edit_material
