-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What a part is made of: one material, or one for each region of its mesh. Commands pass on
-- {default = material or nil, named = list of {region, material}, by_region = whether it takes REGION=NAME}.
local bw = require "barwright"
local core = require "barwright.core"
local has_strength = require "barwright.has_strength"
local quantity = require "barwright.command.quantity"
local shown = require "barwright.shown"

local made_of = {}

-- ---- constants on the command line ------------------------------------------------------------------

-- What an inline material may have: unit, and the range as of the options.
local constants = {young = {unit = "Pa", above = 0}, poisson = {min = 0, max = 0.499},
  strength = {unit = "Pa", above = 0}, density = {unit = "kg/m3", above = 0}, toughness = {above = 0}}

-- "REGION" and {young =, ...} of "REGION=young=2GPa,poisson=0.35", without a region "" and the constants; nil
-- where a text is no such list; or false and a sentence.
local function read_inline(text)
  local from = nil
  for name in pairs(constants) do
    local at = text:find("^" .. name .. "=[%d.+-]") or text:find("=" .. name .. "=[%d.+-]")
    if at and at > 1 then at = at + 1 end -- behind the sign
    if at and (not from or at < from) then from = at end
  end
  if not from then return nil end
  local found = {}
  for word in (text:sub(from) .. ","):gmatch "([^,]*)," do
    local name, value = word:match "^([^=]*)=(.*)$"
    local rule = constants[name]
    if not rule then
      return false, ("constants such as young=2GPa,poisson=0.35,strength=40MPa,density=1200 expected, got '%s'")
        :format(word)
    end
    if found[name] then return false, ("%s is given twice in '%s'"):format(name, text) end
    local number, expected = quantity.read(value, rule.unit)
    if not number then return false, ("%s: %s expected, got '%s'"):format(name, expected, value) end
    if rule.above and number <= rule.above or rule.min and (number < rule.min or number > rule.max) then
      return false, rule.above and ("%s: a value above 0 expected, got '%s'"):format(name, value)
        or ("%s: a number from %g up to %g expected, got '%s'"):format(name, rule.min, rule.max, value)
    end
    found[name] = number
  end
  if not (found.young and found.poisson) then
    return false, ("young= and poisson= are needed, got '%s'"):format(text)
  end
  return text:sub(1, math.max(0, from - 2)), found
end

-- For arguments.lua.
local function is_inline(text)
  local region, message = read_inline(text)
  if region == nil or region == false then return region, message end
  return true
end

-- The region (nil: none) and the material of a text of --material.
local function region_and_material(text, known)
  local region, found = read_inline(text)
  if region then
    found.name = "the given material"
    return region ~= "" and region or nil, bw.material.isotropic(found)
  end
  local name
  region, name = text:match "^(.*)=([^=]*)$"
  name = name or text
  known[name] = known[name] or bw.material.named(name)
  return region, known[name]
end

--- Materials by name.
made_of.option = {name = "material", value = "NAME|REGION=NAME", default = {"pla"}, many = true, keyed = true,
  inline = is_inline,
  one_of = bw.material.names(), what = "what it is made of; `barwright materials` lists them, and constants such "
    .. "as young=2GPa,poisson=0.35,strength=40MPa,density=1200 stand for a name; with REGION= what a "
    .. "region of a mesh file is made of, and NAME alone is for all others"}

--- The same of commands that take one material for all of a part: they refuse REGION=NAME by made_of.several.
made_of.one_option = {name = "material", value = "NAME", default = "pla", keyed = true, inline = is_inline,
  one_of = bw.material.names(), what = "what it is made of; `barwright materials` lists them, and constants such "
    .. "as young=2GPa,poisson=0.35,strength=40MPa,density=1200 stand for a name"}

--- Values that replace those of the named material.
made_of.value_options = {
  {name = "young", value = "MODULUS", type = "number", unit = "Pa", above = 0,
    what = "Young's modulus, instead of the material's"},
  {name = "poisson", value = "RATIO", type = "number", min = 0, max = 0.499,
    what = "Poisson's ratio, instead of the material's"},
  {name = "strength", value = "STRESS", type = "number", unit = "Pa", above = 0,
    what = "the stress at which it fails, instead of the material's"},
  {name = "density", value = "DENSITY", type = "number", unit = "kg/m3", above = 0,
    what = "the density, instead of the material's"},
  {name = "toughness", value = "K_IC", type = "number", above = 0,
    what = "the fracture toughness in Pa m^0.5, instead of the material's: 2e6 for instance"},
}

local value_names = {young = "Young's modulus", poisson = "Poisson's ratio", strength = "strength",
  density = "density", toughness = "fracture toughness"}

-- A material with what was given by value: {young, poisson, strength, density, toughness}.
local function with_values(named, opts)
  if not (opts.young or opts.poisson or opts.strength or opts.density or opts.toughness) then return named end
  local young, poisson, strength = opts.young or named.young, opts.poisson or named.poisson,
    opts.strength or named.strength
  if type(young) ~= "number" or type(poisson) ~= "number" or strength and type(strength) ~= "number" then
    return nil, ("%s differs with the direction: give --young, --poisson and --strength, or another --material")
      :format(named.name)
  end
  return bw.material.isotropic {name = named.name, young = young, poisson = poisson, strength = strength,
    density = opts.density or named.density, toughness = opts.toughness or named.toughness}
end

-- With --length critical the material needs a toughness: a sentence where it has none.
local function missing_toughness(material)
  if material.critical_distance then return nil end
  local known = {}
  for _, name in ipairs(bw.material.names()) do
    if bw.material.named(name).critical_distance then known[#known + 1] = name end
  end
  return ("option --length critical: the fracture toughness of %s is not known: give it by --toughness, or take a "
    .. "material that has one (%s), or give a length such as --length 1mm"):format(material.name,
    table.concat(known, ", "))
end

-- What is for one material alone, where regions have their own; a sentence, or nil.
local function for_one(opts)
  if opts.length == "critical" then
    return "option --length critical is of one material, and regions have their own: give a length such as "
      .. "--length 1mm"
  end
  for _, name in ipairs {"young", "poisson", "strength", "density", "toughness", "conductivity"} do
    if opts[name] then
      return ("option --%s replaces a value of one material, and regions have their own: leave it out")
        :format(name)
    end
  end
end

--- The materials that the options name, or nil and a sentence.
function made_of.read(opts)
  local by_region = type(opts.material) == "table"
  local made, known = {named = {}, by_region = by_region}, {}
  for _, text in ipairs(by_region and opts.material or {opts.material}) do
    local region, material = region_and_material(text, known)
    if region then
      made.named[#made.named + 1] = {region, material}
    elseif made.default then
      return nil, "option --material is given twice for all of the part: REGION=NAME is for a region of its mesh"
    else
      made.default = material
    end
  end
  local message
  if #made.named > 0 then
    message = for_one(opts)
  else
    made.default, message = with_values(made.default, opts)
    if made.default and opts.length == "critical" then message = missing_toughness(made.default) end
  end
  if message then return nil, message end
  return made
end

-- So many regions are named in sentences.
local REGIONS_NAMED = 20

local function region_list(mesh)
  local names, count = {}, #mesh.regions
  for i = 1, math.min(count, REGIONS_NAMED) do names[i] = mesh.regions[i].name end
  return ("the regions are %s%s"):format(table.concat(names, ", "),
    count > REGIONS_NAMED and (" and %d more"):format(count - REGIONS_NAMED) or "")
end

--- The material of a region.
function made_of.material_of(made, name)
  for _, pair in ipairs(made.named) do
    if pair[1] == name then return pair[2] end
  end
  return made.default
end

--- What is wrong with materials by region for what was read, or nil.
function made_of.fault(made, read)
  if #made.named == 0 then return nil end
  local mesh, is_region, seen = read.mesh, {}, {}
  if not mesh or #mesh.regions == 0 then
    return ("option --material %s=%s: %s has no regions, which meshes of tetrahedra can have (MSH VTU MEDIT "
      .. "INP): give --material NAME"):format(made.named[1][1], made.named[1][2].name, read.path)
  end
  for _, region in ipairs(mesh.regions) do is_region[region.name] = true end
  for _, pair in ipairs(made.named) do
    local name = pair[1]
    if not is_region[name] then
      return ("option --material: there is no region '%s'; %s"):format(name, region_list(mesh))
    end
    if seen[name] then
      return ("option --material: region '%s' is given twice; %s"):format(name, region_list(mesh))
    end
    seen[name] = true
  end
  for _, region in ipairs(mesh.regions) do
    if not made_of.material_of(made, region.name) then
      return ("option --material: region '%s' has no material: give %s=NAME, or NAME for all others; %s"):format(
        region.name, region.name, region_list(mesh))
    end
  end
end

--- The materials, each once.
function made_of.materials(made)
  local list, seen = {}, {}
  for _, pair in ipairs(made.named) do
    if not seen[pair[2]] then list[#list + 1] = pair[2] end
    seen[pair[2]] = true
  end
  if made.default and not seen[made.default] then list[#list + 1] = made.default end
  return list
end

--- The first material whose strength is not known, or nil.
function made_of.without_strength(made)
  for _, material in ipairs(made_of.materials(made)) do
    if not material.strength then return material end
  end
end

--- What is wrong with materials by region for a command that takes one material, or nil.
function made_of.several(made, command)
  if #made.named == 0 then return nil end
  return ("option --material %s=%s: `barwright %s` takes one material for all of a part: give --material "
    .. "NAME"):format(made.named[1][1], made.named[1][2].name, command)
end

--- A model (`make`: bw.model, bw.heat) of a mesh, with what else it takes. Raises as it does.
function made_of.make(made, make, mesh, given)
  given = given or {}
  given.mesh = mesh
  if #made.named == 0 then
    given.material = made.default
  else
    given.materials = {}
    for _, region in ipairs(mesh.regions) do
      given.materials[region.name] = made_of.material_of(made, region.name)
    end
  end
  return make(given)
end

--- The mass of a mesh (kg), nil where a density is not known.
function made_of.mass(made, mesh)
  if #made.named == 0 then return made.default.density and made.default.density * mesh.volume end
  local sum = 0
  for _, region in ipairs(mesh.regions) do
    local density = made_of.material_of(made, region.name).density
    if not density then return nil end
    sum = sum + density * region.volume
  end
  return sum
end

-- "pla", or of several regions "pla + steel".
local function name_of(made, mesh)
  if #made.named == 0 then return made.default.name end
  local names, seen = {}, {}
  for _, region in ipairs(mesh.regions) do
    local name = made_of.material_of(made, region.name).name
    if not seen[name] then names[#names + 1] = name end
    seen[name] = true
  end
  return table.concat(names, " + ")
end

--- Says and keeps the regions of a mesh, and what they are made of.
function made_of.report(made, mesh, out)
  local names, list = bw.json.list {}, bw.json.list {}
  for i, region in ipairs(mesh.regions) do names[i] = region.name end
  out:json {regions = names, material = name_of(made, mesh)}
  if #made.named == 0 then
    if #names > 1 then
      out:say("All of it is %s: %s%s.", made.default.name, region_list(mesh),
        made.by_region and ", and --material REGION=NAME gives each its own" or "")
    end
    return
  end
  for i, region in ipairs(mesh.regions) do
    local material = made_of.material_of(made, region.name)
    local mass = material.density and material.density * region.volume
    list[i] = {region = region.name, material = material.name, volume_m3 = region.volume, mass_kg = mass,
      strength_pa = material.strength}
    if i <= REGIONS_NAMED then
      out:say("  Region %s: %s, %s%s.", region.name, material.name, core.quantity(region.volume, "m3"),
        mass and ", " .. core.quantity(mass, "kg") or "")
    end
  end
  if #list > REGIONS_NAMED then out:say("  And %d more regions.", #list - REGIONS_NAMED) end
  out:json {materials = list}
end

--- What a part is made of, in words: "pla", "pla with the given strength".
function made_of.text(made, opts)
  local given = {}
  for _, option in ipairs(made_of.value_options) do
    if opts[option.name] then given[#given + 1] = value_names[option.name] end
  end
  if #given == 0 then return made.default.name end
  local last = table.remove(given)
  return ("%s with the given %s"):format(made.default.name, #given > 0
    and table.concat(given, ", ") .. " and " .. last or last)
end

-- ---- which region governs --------------------------------------------------------------------------

local map = bw.array.map

-- A number of each element's region, by the place of the region.
local function by_element(mesh, value)
  local list = {}
  for i, region in ipairs(mesh.regions) do list[i] = value(region) end
  return bw.array(list):gather(mesh.element_regions)
end

-- The least of the values of the elements at each node.
local function least(mesh, values) return mesh:to_nodes(values * -1, "max") * -1 end

--- The region of an element, nil where the part is of one material.
function made_of.region_of(part, element)
  local mesh = part.mesh
  return part.material.parts and mesh.regions[mesh.element_regions[element]].name
end

--- Of elements: where stress over strength is largest, {element =, used =, material =, region = name or nil,
--- by_region = list of {region, material, utilisation}}; nil where a strength is not known. `utilisation`: of
--- elements.
function made_of.governing(made, part, utilisation)
  local mesh = part.mesh
  if not has_strength(part.material) then return nil end
  local element = utilisation:argmax()
  local found = {element = element, used = utilisation[element], material = part.material}
  found.region = made_of.region_of(part, element)
  if not found.region then return found end
  found.material = made_of.material_of(made, found.region)
  found.by_region = bw.json.list {}
  for i, region in ipairs(mesh.regions) do
    found.by_region[i] = {region = region.name, material = made_of.material_of(made, region.name).name,
      utilisation = utilisation:gather(region.elements):max()}
  end
  return found
end

--- Of nodes with a von Mises stress: the same, {node =, used =, material =, region = name or nil, least = whether
--- materials meet there, of which the least strength counts}. nil where a strength is no number.
function made_of.governing_node(made, part, von_mises)
  local mesh, material = part.mesh, part.material
  if not material.parts then
    if type(material.strength) ~= "number" then return nil end
    local node = von_mises:argmax()
    return {node = node, used = von_mises[node] / material.strength, material = material}
  end
  for _, one in ipairs(material.parts) do
    if type(one.strength) ~= "number" then return nil end
  end
  local strengths = by_element(mesh, function(region) return made_of.material_of(made, region.name).strength end)
  local lesser = least(mesh, strengths)
  local used = map("s / r", {s = von_mises, r = lesser})
  local node = used:argmax()
  for _, region in ipairs(mesh.regions) do
    local own = made_of.material_of(made, region.name)
    if own.strength == lesser[node] then
      local there = by_element(mesh, function(other) return other.name == region.name and 1 or 0 end)
      if mesh:to_nodes(there, "max")[node] > 0 then
        return {node = node, used = used[node], material = own, region = region.name,
          least = mesh:to_nodes(strengths, "max")[node] > lesser[node]}
      end
    end
  end
end

--- "steel", "steel in region grip", or "steel in region grip, the least where materials meet"
function made_of.governing_text(found)
  return found.region and ("%s in region %s%s"):format(found.material.name, found.region,
    found.least and ", the least where materials meet" or "") or found.material.name
end

--- Says the largest stress over strength of each region.
function made_of.say_by_region(found, say)
  if not found.by_region then return end
  local texts = {}
  for i, one in ipairs(found.by_region) do
    if i > REGIONS_NAMED then break end
    texts[i] = ("%s %s"):format(one.region, shown.percent(one.utilisation))
  end
  local more = #found.by_region - #texts
  say("Elements of each region reach this part of their strength: %s%s.", table.concat(texts, ", "),
    more > 0 and (" and %d more regions"):format(more) or "")
end

--- The nodes of the surface at which regions of different materials meet, as {node, ...}; empty where there is one
--- material.
function made_of.meeting_nodes(made, part)
  local mesh, numbers, count, list = part.mesh, {}, 0, {}
  if not part.material.parts then return list end
  local of_region = by_element(mesh, function(region)
    local material = made_of.material_of(made, region.name)
    if not numbers[material] then
      count = count + 1
      numbers[material] = count
    end
    return numbers[material] + 0.0
  end)
  local nodes = mesh.boundary.nodes
  local differ = map("a > b", {a = mesh:to_nodes(of_region, "max"), b = least(mesh, of_region)}):gather(nodes)
  for i, node in ipairs(nodes:totable()) do
    if differ[i] ~= 0 then list[#list + 1] = node end
  end
  return list
end

return made_of
