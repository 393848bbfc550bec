-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright materials: the library, with where its numbers come from.
local bw = require "barwright"
local core = require "barwright.core"
local shown = require "barwright.shown"

-- Of the constants that have a source.
local units = {young = "Pa", strength = "Pa", density = "kg/m3", toughness = "Pa m^0.5", critical_distance = "m"}

-- "3.6" or "1.22 0.68 0.234": one number, or one for each axis.
local function numbers(value, scale)
  if not value then return "-" end
  if type(value) == "number" then return shown.number(value * scale) end
  local texts = {}
  for i, x in ipairs(value) do texts[i] = shown.number(x * scale) end
  return table.concat(texts, " ")
end

local function about(name)
  local material = bw.material.named(name)
  local sources = {}
  for key, from in pairs(material.sources or {}) do
    sources[key] = {value = from.mean, scatter = from.scatter, source = from.source}
  end
  local function scatter(key) return sources[key] and sources[key].scatter end
  return {name = name, isotropic = material.isotropic, young_pa = material.young, poisson = material.poisson,
    density_kg_m3 = material.density, strength_pa = material.strength, toughness_pa_sqrt_m = material.toughness,
    toughness_scatter_pa_sqrt_m = scatter "toughness", critical_distance_m = material.critical_distance,
    critical_distance_scatter_m = scatter "critical_distance", sources = sources}
end

-- "3 +- 0.4", "-" where the value is not known.
local function scattered(value, scatter, scale)
  if not value then return "-" end
  return shown.number(value * scale) .. (scatter and " +- " .. shown.scatter(scatter * scale) or "")
end

local function report_one(entry, out)
  out:say("%s", entry.name)
  local keys, said = {}, {}
  for key in pairs(entry.sources) do keys[#keys + 1] = key end
  table.sort(keys)
  for _, key in ipairs(keys) do
    local from = entry.sources[key]
    local name = entry.isotropic and key:gsub("_%d+$", "") or key
    if not said[name] then
      said[name] = true
      local unit = units[key:gsub("_%d+$", "")] or ""
      local word, scale = core.shown_unit(from.value, unit)
      out:say("  %-17s %s%s  %s", name, core.quantity(from.value, unit),
        from.scatter and (" +- %s %s"):format(shown.scatter(from.scatter / scale), word) or "", from.source or "")
    end
  end
end

return {
  summary = "the materials that are known, with where their numbers come from",
  about = "Without a name: a table; where a material has axes, three numbers stand for the three. With a name: "
    .. "every number with its unit and source.",
  arguments = {{name = "material", optional = true, one_of = bw.material.names(), what = "one of them"}},
  examples = {"barwright materials", "barwright materials zp150"},
  run = function(opts, out)
    if opts.material then
      local entry = about(opts.material)
      report_one(entry, out)
      out:json {materials = bw.json.list {entry}}
      return 0
    end
    local list = bw.json.list {}
    local row = "%-28s %-20s %-20s %-6s %-14s %-17s %s"
    out:say(row, "name", "Young's modulus, GPa", "Poisson's ratio", "kg/m3", "strength, MPa", "K_Ic, MPa m^0.5",
      "critical distance, mm")
    for i, name in ipairs(bw.material.names()) do
      local entry = about(name)
      list[i] = entry
      out:say(row, name, numbers(entry.young_pa, 1e-9), numbers(entry.poisson, 1), numbers(entry.density_kg_m3, 1),
        numbers(entry.strength_pa, 1e-6),
        scattered(entry.toughness_pa_sqrt_m, entry.toughness_scatter_pa_sqrt_m, 1e-6),
        scattered(entry.critical_distance_m, entry.critical_distance_scatter_m, 1e3))
    end
    out:json {materials = list}
  end,
}
