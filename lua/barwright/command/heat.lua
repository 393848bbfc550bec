-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright heat MODEL: how warm the part gets in the steady state.
local bw = require "barwright"
local core = require "barwright.core"
local heat_page = require "barwright.command.heat_page"
local made_of = require "barwright.command.made_of"
local model = require "barwright.command.model"
local output = require "barwright.command.output"
local page_head = require "barwright.command.page_head"
local places = require "barwright.command.places"
local quantity = require "barwright.command.quantity"
local shown = require "barwright.shown"

local ZERO_CELSIUS = 273.15 -- K

-- A temperature (K) of "353K" or "80C". A bare number could be either.
local function temperature_of(text)
  if quantity.name_in(text) == "" then
    return nil, ("'%s' has no unit: write %sC or %sK"):format(text, text, text)
  end
  local celsius = text:match "^(.*[%d.])%s*C$"
  local value = quantity.read(celsius or text, not celsius and "K" or nil)
  if not value then return nil, ("a temperature such as 293K or 20C expected, got '%s'"):format(text) end
  if celsius then value = value + ZERO_CELSIUS end
  if value < 0 then return nil, ("'%s' is below absolute zero"):format(text) end
  return value
end

local function number_of(unit)
  return function(text)
    local value, expected = quantity.read(text, unit)
    if not value then return nil, ("%s expected, got '%s'"):format(expected, text) end
    return value
  end
end

-- "20,293K": a number from 0 to `most` and a temperature, under these names.
local function film_of(name, most)
  return function(text)
    local first, second = text:match "^([^,]*),([^,]*)$"
    local value = first and quantity.read(first)
    if not value then
      return nil, ("two numbers, %s,TEMPERATURE, expected, got '%s'"):format(name:upper(), text)
    end
    if not (value >= 0 and value <= most) then
      return nil, ("%s is %s: it must be 0 or more%s"):format(name, shown.number(value),
        most < math.huge and (", and at most %g"):format(most) or "")
    end
    local temperature, message = temperature_of(second)
    if not temperature then return nil, message end
    return {[name] = value, temperature = temperature}
  end
end

-- Of each option PLACE=VALUE: how its value is read, and what is said of it.
local conditions = {
  {option = "temperature", read = temperature_of, text = function(t) return core.quantity(t, "K") end},
  {option = "power", read = number_of "W", text = function(p) return core.quantity(p, "W") end},
  {option = "convection", read = film_of("coefficient", math.huge), text = function(c)
    return ("%s to %s"):format(core.quantity(c.coefficient, "W/(m2 K)"), core.quantity(c.temperature, "K"))
  end},
  {option = "radiation", read = film_of("emissivity", 1), text = function(c)
    return ("emissivity %s, to %s"):format(shown.number(c.emissivity), core.quantity(c.temperature, "K"))
  end},
}

-- The conditions, before anything is read: {place =, kind =, value =, text =}.
local function read_conditions(opts)
  local list = {}
  for _, kind in ipairs(conditions) do
    for _, given in ipairs(opts[kind.option]) do
      local place, text = places.split(given)
      if not place then return nil, ("option --%s: %s"):format(kind.option, text) end
      local value, message = kind.read(text)
      if not value then return nil, ("option --%s: %s"):format(kind.option, message) end
      list[#list + 1] = {place = place, kind = kind.option, value = value, text = kind.text(value)}
      list.bound = list.bound or kind.option ~= "power"
    end
  end
  if not list.bound then
    return nil, "no temperature is given: --temperature, --convection or --radiation is missing"
  end
  if opts.limit then
    local message
    list.limit, message = temperature_of(opts.limit)
    if not list.limit then return nil, "option --limit: " .. message end
  end
  return list
end

-- The selections of the conditions on a mesh, in their order.
local function select_places(mesh, given)
  local list = {}
  for i, condition in ipairs(given) do
    local selection, message, details = places.select(mesh, condition.place)
    if not selection then return nil, message, details end
    list[i] = selection
  end
  return list
end

-- The steady state on a mesh with conditions on selections. Of the power in the volume it is the last condition.
local function solve(mesh, made, opts, given, selections)
  local heat, message, details = model.try(made_of.make, made, bw.heat, mesh)
  if not heat then return nil, message, details end
  for i, condition in ipairs(given) do
    local on = selections[i]
    local ok
    if condition.kind == "temperature" then
      ok, message, details = model.try(heat.prescribe, heat, on, condition.value)
    else
      ok, message, details = model.try(heat.load, heat, {on = on, [condition.kind] = condition.value})
    end
    if not ok then return nil, condition.place .. ": " .. message, details end
  end
  if opts.volume_power then heat:load {power = opts.volume_power} end
  return model.try(heat.solve, heat)
end

-- The corners at the ends of each edge of a tetrahedron, whose middles are its nodes 5 to 10.
local EDGES = {{1, 2}, {2, 3}, {3, 1}, {1, 4}, {2, 4}, {3, 4}}

-- How far a solution differs from one with linear elements on the same corners: temperatures at nodes (K), and
-- heat of each condition (W).
local function difference(a, b)
  local temperature, heat = 0, {}
  for k = 1, a.mesh.order == 2 and 10 or 4 do
    local ends = EDGES[k - 4] or {k, k}
    local one = a.temperature:gather(a.mesh.elements:column(k))
    local other = b.temperature:gather(b.mesh.elements:column(ends[1]))
      + b.temperature:gather(b.mesh.elements:column(ends[2]))
    temperature = math.max(temperature, (one - 0.5 * other):map("abs(a)"):max())
  end
  local one, other = a.heat_in:totable(), b.heat_in:totable()
  for i = 1, #one do heat[i] = math.abs(one[i] - other[i]) end
  return temperature, heat
end

-- The errors of the places, added to those by heat: facets do not fill a place, and those that lie in it partly
-- change the solution by so much, in proportion to their share.
local function place_error(coarse, made, opts, given, selections, heat_error)
  local sum = 0
  for i, condition in ipairs(given) do
    local wider, share = places.wider(coarse.mesh, condition.place, selections[i])
    if wider then
      local changed = table.move(selections, 1, #selections, 1, {})
      changed[i] = wider
      local other, message, details = solve(coarse.mesh, made, opts, given, changed)
      if not other then return nil, message, details end
      local temperature, heat = difference(coarse, other)
      sum = sum + share * temperature
      for k = 1, #heat do heat_error[k] = heat_error[k] + share * heat[k] end
    end
  end
  return sum
end

-- The material with another conductivity.
local function with_conductivity(material, conductivity)
  local make = material.isotropic and bw.material.isotropic or bw.material.orthotropic
  return make {name = material.name, young = material.young, poisson = material.poisson,
    shear = not material.isotropic and material.shear or nil, density = material.density,
    conductivity = conductivity}
end

-- What the part is made of, with the conductivity that is given; or nil and a sentence.
local function conducting(made, opts)
  if opts.conductivity then return {default = with_conductivity(made.default, opts.conductivity), named = {}} end
  for _, material in ipairs(made_of.materials(made)) do
    if not material.conductivity then
      return nil, ("the conductivity of %s is not known: give %s"):format(material.name,
        #made.named == 0 and "it by --conductivity" or "another material")
    end
  end
  return made
end

local function analyse(opts, given, out)
  if opts.threads then bw.threads(opts.threads) end
  local mesh, read, details = model.body(setmetatable({order = 2}, {__index = opts}), out)
  if not mesh then return nil, read, details end
  local made, message = conducting(read.made, opts)
  if not made then return nil, message, {status = "invalid"} end
  local selections, solution
  selections, message, details = select_places(mesh, given)
  if not selections then return nil, message, details end
  for i, condition in ipairs(given) do
    out:say("Condition at %s (%s): %s %s.", condition.place, core.quantity(selections[i].area, "m2"),
      condition.kind, condition.text)
  end
  solution, message, details = solve(mesh, made, opts, given, selections)
  out:warnings()
  if not solution then return nil, message, details end
  -- Linear elements of the same mesh have larger errors: the difference is about theirs.
  local linear = mesh:with_order(1)
  local on_linear = select_places(linear, given)
  local coarse
  coarse, message, details = solve(linear, made, opts, given, on_linear)
  if not coarse then return nil, message, details end
  local by_elements, heat_error = difference(solution, coarse)
  local by_places
  by_places, message, details = place_error(coarse, made, opts, given, on_linear, heat_error)
  bw.warnings() -- those of the quadratic elements are shown
  if not by_places then return nil, message, details end
  return {mesh = mesh, made = made, solution = solution, heat_error = heat_error, by_places = by_places,
    estimated = by_elements + by_places}
end

local function judge(highest, estimated, limit)
  if not limit then return "computed" end
  if highest + estimated < limit then return "holds", "it stays below the limit" end
  if highest - estimated > limit then return "exceeds", "it exceeds the limit" end
  return "unsure", "too close to decide"
end

-- The conductivity in words: "50 W/(m K), as given", "0.13 W/(m K), that of pla".
local function conductivity_text(made, opts)
  local texts = {}
  for k, material in ipairs(made_of.materials(made)) do
    local value, list = material.conductivity, {}
    for i, each in ipairs(type(value) == "number" and {value} or {value[1], value[2], value[3]}) do
      list[i] = core.quantity(each, "W/(m K)")
    end
    texts[k] = table.concat(list, ", ") .. (opts.conductivity and ", as given" or ", that of " .. material.name)
  end
  return table.concat(texts, "; ")
end

-- Below this fraction of the temperature its differences are rounding (-).
local UNIFORM = 1e-9

local function report(found, given, opts, out)
  local solution, estimated = found.solution, found.estimated
  local say, sentences = out:recorded()
  local temperature = solution.temperature
  local node, highest, lowest = temperature:argmax(), temperature:max(), temperature:min()
  local verdict, words = judge(highest, estimated, given.limit)
  local nodes = found.mesh.nodes
  local at = {nodes(node, 1), nodes(node, 2), nodes(node, 3)}
  local function both(kelvin)
    return ("%.5g K (%.4g C)"):format(kelvin, kelvin - ZERO_CELSIUS)
  end
  out:say("")
  say("The temperature is highest at %s: %s; the lowest one is %s.", core.point(at), both(highest),
    both(lowest))
  say("The estimated error of both is %.2g K%s.", estimated, found.by_places > 0
    and (", %.2g K of it as facets do not fill the places"):format(found.by_places) or "")
  if words then say("The limit is %s: %s.", both(given.limit), words) end
  local heats, gained = solution.heat_in:totable(), bw.json.list {}
  for i, heat in ipairs(heats) do
    local condition = given[i] or {place = "volume", kind = "volume-power"}
    gained[i] = {place = condition.place, kind = condition.kind, heat_w = heat,
      estimated_error_w = found.heat_error[i]}
    say("Heat into the part by %s at %s: %s (estimated error %.2g W).", condition.kind, condition.place,
      core.quantity(heat, "W"), found.heat_error[i])
  end
  local flux_error = highest - lowest > UNIFORM * math.abs(highest) and solution:error_estimate() or nil
  if flux_error then
    say("Estimated error of the flux, over all of the part: %s.", shown.error(flux_error))
  end
  say("Steady state: the conductivity is %s, and no radiation between surfaces.",
    conductivity_text(found.made, opts))
  out:json {verdict = verdict, value = highest, quantity = "highest temperature, K", estimated_error_k = estimated,
    place_error_k = found.by_places, at_m = at, lowest_k = lowest, limit_k = given.limit, heat_in = gained,
    imbalance_w = solution.imbalance, flux_error = flux_error,
    conductivity = #found.made.named == 0 and found.made.default.conductivity or nil}
  local facts, material, mass = {}, page_head.part(found.made, opts, out)
  for i, condition in ipairs(given) do
    facts[i] = {condition.place, ("%s %s"):format(condition.kind, condition.text)}
  end
  facts[#facts + 1] = material
  facts[#facts + 1] = mass
  local head = heat_page.head {verdict = verdict, highest = highest, lowest = lowest, estimated = estimated,
    limit = given.limit, at = at, facts = facts}
  return head, words, sentences, gained
end

return {
  summary = "how warm a part gets in the steady state",
  about = "Applies conditions of heat at places and finds the steady temperatures. A surface is repaired where it "
    .. "must be and filled with quadratic tetrahedra. A temperature has a unit: 353K "
    .. "or 80C. No heat passes where no condition is given.\n\n" .. places.help .. "\n\n"
    .. output.codes("it stays below the limit, or there is none", "it exceeds the limit, or the estimated error "
      .. "leaves it open"),
  arguments = {model.body_argument},
  options = {
    made_of.option,
    {name = "conductivity", value = "NUMBER", type = "number", above = 0,
      what = "thermal conductivity, in W/(m K), in place of the material's"},
    {name = "temperature", value = "PLACE=TEMPERATURE", many = true, what = "a place has this temperature"},
    {name = "power", value = "PLACE=POWER", many = true, what = "a power, in W, spread over a place"},
    {name = "volume-power", value = "POWER", type = "number",
      what = "a power, in W, spread over the volume of the part"},
    {name = "convection", value = "PLACE=COEFFICIENT,TEMPERATURE", many = true,
      what = "a fluid of a temperature: its coefficient is in W/(m2 K), 5 to 25 in still air"},
    {name = "radiation", value = "PLACE=EMISSIVITY,TEMPERATURE", many = true,
      what = "surroundings of a temperature, seen by a surface of this emissivity, 0 to 1"},
    {name = "limit", value = "TEMPERATURE", what = "the temperature that the part may have"},
    model.unit_option,
    model.elements_option,
    {name = "report", value = "FILE.html", type = "file", endings = {"html", "htm"},
      what = "write a page with a 3D view of the temperature, and the balance of heat"},
    {name = "vtu", value = "FILE.vtu", type = "file", endings = model.field_endings,
      what = "write temperature and flux, for ParaView"},
    {name = "picture", value = "FILE.png", type = "file", endings = {"png"},
      what = "a picture of the temperature"},
    model.threads_option,
  },
  examples = {"barwright heat sink.stl --material aluminium --power min:z=15 --convection all=12,20C --limit 80C",
    {"barwright heat cup.stl --conductivity 1.5 --temperature below:z:5mm=90C --convection above:z:5mm=10,20C",
      "between a hot plate and the air"}},
  run = function(opts, out)
    local given, message = read_conditions(opts)
    if not given then return out:misuse(message) end
    local found, why, details = analyse(opts, given, out)
    if not found then return out:fail(why, details) end
    local head, words, sentences, gained = report(found, given, opts, out)
    local failed = out:write_files {{opts.vtu, function() return found.solution:write(opts.vtu) end},
      {opts.picture, function() return found.solution:picture(opts.picture) end},
      {opts.report, function()
        return heat_page.write(found.solution, opts.report, {name = model.name(opts.model), words = words,
          answer = table.concat(sentences, "\n"), estimated = found.estimated, gained = gained,
          head = head, manifest = {conductivity = conductivity_text(found.made, opts)}})
      end}}
    if failed then return failed end
    return (head.verdict == "computed" or head.verdict == "holds") and 0 or 1
  end,
}
