-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright buckle MODEL --worst FORCE: the load within limits that buckles the part first.
local bw = require "barwright"
local core = require "barwright.core"
local loads_of = require "barwright.command.loads"
local model = require "barwright.command.model"
local places = require "barwright.command.places"
local shown = require "barwright.shown"

local buckle_worst = {}

-- Options that only this search takes.
buckle_worst.options = {
  {name = "worst", value = "FORCE", type = "number", unit = "N", above = 0,
    what = "no known load: find the pressures of this total force that buckle the part first; without --fix the "
      .. "load on one side, which another one balances"},
  model.contact_option,
  {name = "forbid", value = "PLACE", many = true, what = "with --worst: no load acts there"},
  {name = "friction", value = "MU", type = "number", default = 0, min = 0, max = 100,
    what = "with --worst: Coulomb's coefficient of friction of the loads"},
}

--- What is wrong with the options, or nil.
function buckle_worst.misuse(opts)
  if not opts.worst then
    for _, name in ipairs {"forbid", "friction", "contact"} do
      if opts.given[("--" .. name)] then
        return ("option --%s is for the search of --worst FORCE"):format(name)
      end
    end
    return nil
  end
  if #opts.force + #opts.pressure > 0 or opts.gravity then
    return "option --worst finds the load: leave out --force, --pressure and --gravity"
  end
  for _, name in ipairs {"fix", "forbid"} do
    for _, place in ipairs(opts[name]) do
      local ok, message = places.check(place)
      if not ok then return ("option --%s: %s"):format(name, message) end
    end
  end
end

--- The worst load of a part and what that is made of, or nil, message, details.
function buckle_worst.analyse(opts, out)
  if opts.threads then bw.threads(opts.threads) end
  local mesh, read, why = model.body(opts, out)
  if not mesh then return nil, read, why end
  local part, message, details = model.part(read, mesh, opts)
  if part then part, message, details = loads_of.set_up(part, opts, {}, out) end
  if not part then return nil, message, details end
  out:json {supported_area_m2 = message}
  local forbidden
  for _, place in ipairs(opts.forbid) do
    local selection
    selection, message, details = places.select(mesh, place)
    if not selection then return nil, message, details end
    forbidden = forbidden and forbidden:union(selection) or selection
    out:say("No load at %s (%s).", place, core.quantity(selection.area, "m2"))
  end
  local sides = #opts.fix == 0 and 2 or 1
  local worst
  worst, message, details = model.try(bw.worst_buckling, part, {force = sides * opts.worst,
    contact = sides * opts.contact, forbidden = forbidden, friction = opts.friction, sign = opts.sign,
    shapes = opts.count})
  out:warnings()
  if not worst then
    if details and details.largest_force then
      message = ("a force of %s on at least %s has no room on the part: pressures of at most %s reach %s%s; give "
        .. "a smaller --contact, or forbid less"):format(core.quantity(opts.worst, "N"),
        core.quantity(opts.contact, "m2"), core.quantity(opts.worst / opts.contact, "Pa"),
        core.quantity(details.largest_force / sides, "N"), sides == 2 and " on each side" or "")
    end
    return nil, message, details
  end
  return worst, read.made
end

-- The force at which a load with a factor buckles the part, as --worst counts it.
local function force_words(factor, opts)
  return ("%s%s%s"):format(factor < 0 and "a pull of " or "", core.quantity(math.abs(factor) * opts.worst, "N"),
    #opts.fix == 0 and " on each side" or "")
end

--- A picture of the answer, with the force as the option gives it.
function buckle_worst.picture(worst, opts, path)
  return worst:picture(path, {title = ("Buckles at %s, %s times this load; another may need less")
    :format(force_words(worst.factor, opts), shown.number(math.abs(worst.factor)))})
end

local BUCKLES, ERROR, NONE = "the part buckles under %s", "the error leaves open whether it buckles under %s",
  "no load of %s that was found buckles it, which is not certain of all loads"

--- Says what was found; the verdict, "buckles" or "unsure", its words and the sentences. `min_error`: what one
--- mesh leaves open at least.
function buckle_worst.report(worst, opts, min_error, out)
  local factor, verdict, words, asked = worst.factor, "unsure", ERROR, core.quantity(opts.worst, "N")
  local error = math.max(worst.mesh_error or 0, min_error)
  if factor and math.abs(factor) < 1 then
    verdict, words = "buckles", BUCKLES
  elseif factor and math.abs(factor) * (1 - error) > 1 then
    words = NONE
  end
  local says = words:format(asked)
  out:say("")
  local say, sentences = out:recorded()
  if factor then
    say("Of the loads found, this one buckles the part first: %s on at least %s, a load factor of %s.",
      force_words(factor, opts), core.quantity(opts.contact, "m2"), shown.number(factor))
    say("At a force of %s its pressures add up to the following%s:", asked,
      factor < 0 and ", and a pull reverses them" or "")
    for _, arrow in ipairs(worst:arrows()) do
      say("  %s at %s, on %s", shown.vector(arrow.force, "N"), core.point(arrow.at),
        core.quantity(arrow.area, "m2"))
    end
    say("The mesh makes force and factor about %s too large in size.", shown.error(worst.mesh_error))
    say("With this error, or %s where that is more, %s.", shown.error(min_error), says)
    say(worst.counted and "A count of the load factors confirms that this load has no smaller one."
      or "The load factors of this load are not counted: a smaller one may be missing.")
  else
    say "No load was found that buckles the part; one may exist."
  end
  say "The search is heuristic: another load may buckle the part sooner."
  say "Whether the material fails at a smaller force is not computed: `barwright worst` answers that."
  say "Linear theory: loads keep their directions, and shape and supports are perfect."
  local factors = {}
  for i, load in ipairs(worst.loads) do factors[i] = load.factor end
  out:json {verdict = verdict, load_factors = bw.json.list(factors), load_factor = factor,
    errors = bw.json.list {worst.mesh_error}, counted = worst.counted, force_n = opts.worst,
    buckling_force_n = factor and math.abs(factor) * opts.worst, contact_m2 = opts.contact,
    friction = opts.friction, forbid = bw.json.list(opts.forbid), fix = bw.json.list(opts.fix),
    analyses = worst.analyses}
  return verdict, says, sentences
end

return buckle_worst
