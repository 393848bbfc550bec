-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright drop MODEL: how hard a part hits a floor, edge or peg, and how it is stressed. docs/theory/drop.md
local bw = require "barwright"
local core = require "barwright.core"
local drop_page = require "barwright.command.drop_page"
local growth = require "barwright.singular_growth"
local made_of = require "barwright.command.made_of"
local model = require "barwright.command.model"
local obstacle = require "barwright.obstacle"
local output = require "barwright.command.output"
local page_head = require "barwright.command.page_head"
local places = require "barwright.command.places"
local shown = require "barwright.shown"

-- Options of one drop alone.
local alone = {{"down", "random drops have random directions"}, {"spin", "random drops fall without spin"},
  {"csv", "the history is that of one drop"}, {"along", "the edge of random drops lies in any direction"},
  {"at", "the obstacle of random drops is below the centre of mass"}}

-- The edge or peg, or nothing for the floor; or nil, a message.
local function read_obstacle(opts)
  local at, along, message
  if opts.peg and opts.edge then return nil, "options --peg and --edge: leave out one of them" end
  if opts.at and not (opts.peg or opts.edge) then return nil, "option --at: give --peg or --edge, too" end
  if opts.at then
    at, message = places.point(opts.at)
    if not at then return nil, "option --at: " .. message end
  end
  if opts.along and not opts.edge then return nil, "option --along: give --edge, too" end
  if opts.peg then return bw.rigid.sphere {centre = at, radius = opts.peg} end
  if not opts.edge then return false end
  if opts.drops then return bw.rigid.cylinder {axis = {1, 0, 0}, radius = opts.edge} end
  if not opts.along then return nil, "option --edge: give its direction by --along, such as 0,1,0" end
  along, message = places.vector(opts.along)
  if not along then return nil, "option --along: " .. message end
  if along[1] == 0 and along[2] == 0 and along[3] == 0 then
    return nil, ("option --along: a direction expected, got '%s'"):format(opts.along)
  end
  return bw.rigid.cylinder {point = at, axis = along, radius = opts.edge}
end

-- Whether directions of length one are nearly parallel.
local function falls_along(down, axis)
  return math.abs(down[1] * axis[1] + down[2] * axis[2] + down[3] * axis[3]) > 1 - 1e-6
end

-- What must be right before the work: {down = of length one, spin =, onto = surface or nil}.
local function read_options(opts)
  for _, one in ipairs(alone) do
    local name, why = table.unpack(one)
    if opts.drops and opts[name] then
      return nil, ("option --%s: %s; leave out --drops or --%s"):format(name, why, name)
    end
  end
  if opts.given["--seed"] and not opts.drops then
    return nil, "option --seed: it is that of random drops; give --drops, too"
  end
  local down, message = places.vector(opts.down or "0,0,-1")
  if not down then return nil, "option --down: " .. message end
  local length = math.sqrt(down[1] ^ 2 + down[2] ^ 2 + down[3] ^ 2)
  if not (length > 0 and length < math.huge) then
    return nil, ("option --down: a direction expected, got '%s'"):format(opts.down)
  end
  local given = {down = {down[1] / length, down[2] / length, down[3] / length}}
  if opts.spin then
    given.spin, message = places.vector(opts.spin, "rad/s")
    if not given.spin then return nil, "option --spin: " .. message end
  end
  local onto
  onto, message = read_obstacle(opts)
  if onto == nil then return nil, message end
  given.onto = onto or nil
  if opts.along and falls_along(given.down, onto.direction) then
    return nil, "option --along: the part falls along the edge: give a direction across --down"
  end
  return given
end

local function damping_of(opts)
  return opts.damping and {ratio = opts.damping} or nil
end

-- `count`: of modes; chosen if left out.
local function drop_of(read, mesh, opts, given, count)
  local part, message, details = model.part(read, mesh, opts)
  if not part then return nil, message, details end
  local modes, drop
  if count then
    modes, message, details = model.try(part.modes, part, {count = count})
    if not modes then return nil, message, details end
  end
  drop, message, details = model.try(part.drop, part, {height = opts.height, down = given.down,
    spin = given.spin, onto = given.onto, damping = damping_of(opts), modes = modes})
  if drop and #drop.impacts == 0 then return nil, "the part does not touch", {status = "invalid"} end
  return drop, message, details, part
end

-- How far the centre of each element is from the obstacle at the first touch (m).
local function distances(drop)
  local mesh, sum = drop.mesh, 0
  local height = obstacle.gap(drop.onto, mesh)
  for corner = 1, 4 do sum = sum + height:gather(mesh.elements:column(corner)) end
  return sum / 4
end

local function centre_of(mesh, element)
  local at = {0, 0, 0}
  for corner = 1, 4 do
    for k = 1, 3 do at[k] = at[k] + mesh.nodes(mesh.elements(element, corner), k) / 4 end
  end
  return at
end

-- The stress that governs among the elements that a mask of 0 and 1 has: the largest one, of several materials the
-- one that is nearest to its strength.
local function largest(drop, part, read, mask)
  local stress, governing = drop.max_principal * mask, nil
  local used = drop.utilisation and drop.utilisation * mask
  if used then governing = made_of.governing(read.made, part, used) end
  local element = governing and governing.region and governing.element or stress:argmax()
  return {stress = stress[element], at = centre_of(drop.mesh, element), elements = drop.mesh.element_count,
    used = used and used:max(), governing = governing}
end

-- The largest stress within `reach` of the obstacle, and that of the rest. The reach is an element of this mesh,
-- or that of a finer one which it is compared with.
local function measure(drop, part, read, reach)
  reach = reach or growth.edge_length(drop.mesh, drop.impacts[1].place)
  local near = distances(drop):map("a <= h", {h = reach})
  local impact, energy = drop.impacts[1], drop.motion_energy
  return {touch = largest(drop, part, read, near), rest = largest(drop, part, read, near:map "1 - a"),
    reach = reach, force = impact.force, duration = impact.duration, impulse = impact.impulse,
    motion = energy[#energy] / drop.initial_energy}
end

-- The relative error of a value by those of the drops on a coarser mesh, with all modes and with half of them.
local function error_of(value, coarse, read)
  if not coarse then return model.error_of(value) end
  return math.max(model.error_of(value, read(coarse.same)), model.error_of(value, read(coarse.half)))
end

-- The verdict on the stress of one of the two, its error, and whether it depends on the mesh: known to
-- (`singular`), or by its growth from the coarser mesh with as many modes.
local function judge(name, found, coarse, singular)
  local place, other = found[name], coarse and coarse.same[name]
  place.error = place.stress > 0 and error_of(place.stress, coarse, function(drop) return drop[name].stress end)
    or 0
  local rate = other and growth.exponent({value = other.stress, edge = other.elements ^ (-1 / 3)},
    {value = place.stress, edge = place.elements ^ (-1 / 3)})
  place.grows = singular or rate ~= nil and rate > growth.ALONE
  place.verdict = place.grows and "unsure" or (model.verdict(place.used, place.error))
end

local function assess(found, coarse, part, read)
  local touch, rest = found.touch, found.rest
  local singular = rest.stress > 0 and model.find_singular(part, read, rest.at, rest,
    coarse and coarse.same.rest) or nil
  judge("rest", found, coarse, singular ~= nil)
  judge("touch", found, coarse, not coarse)
  -- Growth from one mesh to the other at no place where it is expected may be that of a mesh which is too coarse.
  found.too_coarse = coarse ~= nil and (rest.error >= 1 or singular ~= nil and singular.by == "growth")
  found.singular = not found.too_coarse and singular or nil
  if rest.verdict == "breaks" or touch.verdict == "breaks" then return "breaks", "it breaks" end
  if rest.verdict == "holds" and touch.verdict == "holds" then return "holds", "it holds" end
  if rest.verdict == "holds" and touch.grows then
    return "unsure", "it holds but for the places that touch, where the stress depends on the mesh"
  end
  if not touch.used then return "unsure", "the strength is not known" end
  if found.too_coarse then return "unsure", "unsure, since the mesh is too coarse for the stress" end
  if rest.grows or touch.grows then return "unsure", "unsure, since the stress depends on the mesh" end
  return "unsure", "too close to decide"
end

local function body(opts, out)
  if opts.threads then bw.threads(opts.threads) end
  return model.body(setmetatable({order = 2}, {__index = opts}), out)
end

local function of_strength(place)
  if not place.used then return "" end
  local governing = place.governing
  return (", %s of the strength%s"):format(shown.percent(place.used), governing and governing.region
    and " of " .. made_of.governing_text(governing) or "")
end

local function state_assumptions(opts, onto, unknown, say)
  local damping = opts.damping and ("%s of the critical damping in every mode"):format(shown.percent(opts.damping))
  say("Linear elasticity, %s, no friction, %s. The error of %s is unknown.", onto and obstacle.name(onto)
    or "rigid plane", damping or "no damping", unknown)
end

-- Ends with a failure; what the engine advises is named as options, against too many nodes that touch `options`.
local function fail(out, message, details, options)
  message = message:gsub("(nodes touch in one impact: ).*", "%1" .. options)
  message = message:gsub("make elements smaller where it hits, or its radius larger",
    "give more --elements, or a larger radius")
  message = message:gsub("take fewer samples, or fewer elements", "give fewer --elements")
    :gsub("use fewer elements", "give fewer --elements")
  return out:fail((message:gsub("leave its place out", "leave out --at")), details)
end

-- What makes a verdict uncertain, and what to do.
local function doubt_of(found)
  if found.touch.grows and not found.too_coarse then
    return "Where it touches, the stress has no value that finer meshes keep: round the edge, or judge the rest."
  elseif found.rest.grows and not found.too_coarse then
    return "Round the re-entrant edge: without a fillet its stress has no finite value."
  end
  return "More --elements make the error smaller."
end

-- The head of the page of one drop. found: as assessed; words: of the verdict.
local function head_of(drop, found, verdict, words, read, opts, given, out)
  local rest, touch, impact = found.rest, found.touch, drop.impacts[1]
  local judged = touch.grows and rest or (touch.used or 0) > (rest.used or 0) and touch or rest
  local material, mass = page_head.part(read.made, opts, out)
  local function stress(place)
    return ("%s at %s%s%s"):format(shown.estimate(place.stress, "Pa"), core.point(place.at), of_strength(place),
      place.grows and ", depends on the mesh" or ", estimated error " .. shown.error(place.error))
  end
  local sentence = page_head.used(judged.used, judged.error)
  if touch.grows then sentence = "But for where it touches: " .. sentence:gsub("^%u", string.lower) end
  return {verdict = verdict,
    headline = ("%s Dropped from %s: %s."):format(sentence, core.quantity(opts.height, "m"), words),
    facts = {page_head.margin(judged.used, judged.error), {"Stress where it touches", stress(touch)},
      {"Stress elsewhere", rest.stress > 0 and stress(rest) or nil},
      {"Largest force", shown.estimate(impact.force, "N")}, {"Impact lasts", shown.estimate(impact.duration, "s")},
      {"Hits at", core.quantity(drop.speed, "m/s")}, material, mass,
      {"Assumption", ("linear elasticity, %s, no friction"):format(given.onto and obstacle.name(given.onto)
        or "rigid plane")}},
    advice = verdict == "breaks" and {"Drop it from less high, or thicken it where the stress is largest."}
      or verdict == "unsure" and judged.used and {doubt_of(found)} or nil}
end

local function run_one(opts, given, out)
  local mesh, read, why = body(opts, out)
  if not mesh then return out:fail(read, why) end
  local drop, message, details, part = drop_of(read, mesh, opts, given)
  out:warnings()
  if not drop then return fail(out, message, details, "give fewer --elements, or tilt the part by --down") end
  local found = measure(drop, part, read)
  local coarse = model.on_coarser(read, opts, 2, function(coarser)
    local count = drop.modes.count
    local same, _, _, other = drop_of(read, coarser, opts, given, count)
    local half = same and drop_of(read, coarser, opts, given, math.max(1, count // 2))
    return half and {same = measure(same, other, read, found.reach),
      half = measure(half, other, read, found.reach)}
  end)
  local verdict, words = assess(found, coarse, part, read)
  local impact, touch, rest = drop.impacts[1], found.touch, found.rest
  local way = coarse and "by a coarser mesh and half the modes" or "error unknown: one mesh"
  local function error_text(error)
    if error and error >= 1 then return "the estimated error is larger than the value, " .. way end
    return error and ("estimated error %s, %s"):format(shown.error(error), way) or way
  end
  local errors, texts = {}, {}
  for _, name in ipairs {"force", "duration", "impulse", "motion"} do
    errors[name] = coarse and error_of(found[name], coarse, function(other) return other[name] end)
    texts[name] = error_text(errors[name])
  end
  out:say("")
  local say, text = out:recorded()
  say("It falls %s along %s and hits at %s, first at %s.", core.quantity(opts.height, "m"),
    shown.vector(given.down, ""):gsub(" $", ""), core.quantity(drop.speed, "m/s"), core.point(impact.place))
  say("The impact lasts %s (%s).", shown.estimate(impact.duration, "s"), texts.duration)
  say("The largest force is %s (%s).", shown.estimate(impact.force, "N"), texts.force)
  say("The impulse is %s (%s).", shown.estimate(impact.impulse, "N s"), texts.impulse)
  say("The %s is %s at %s, within an element of what touches%s: %s.", part.material.parts
    and "principal stress nearest to its strength" or "largest principal stress",
    shown.estimate(touch.stress, "Pa"), core.point(touch.at), of_strength(touch),
    touch.grows and (coarse and "it depends on the mesh" or "it may depend on the mesh")
    or error_text(touch.error))
  if rest.stress > 0 then
    say("Elsewhere it is %s at %s%s (%s).", shown.estimate(rest.stress, "Pa"), core.point(rest.at),
      of_strength(rest), coarse and error_text(rest.error) or ("error unknown, taken as %s: one mesh"):format(
      shown.error(rest.error)))
  end
  if found.too_coarse then
    say("From the coarser mesh to this one that stress changes from %s to %s. No place without a finite stress is "
      .. "known there: the mesh is too coarse. Give more --elements.",
      shown.estimate(coarse.same.rest.stress, "Pa"), shown.estimate(rest.stress, "Pa"))
  end
  if found.singular then say("%s.", (tostring(found.singular):gsub("^%l", string.upper))) end
  say("Verdict: %s.", words)
  say("Of %s at the first touch, %s go on as motion (%s).", core.quantity(drop.initial_energy, "J"),
    shown.percent(found.motion), texts.motion)
  say("The balance of energy is kept to %.1e of the energy at the first touch.", drop.energy_error)
  if impact.turn > 0.1 then
    say("A normal of the contact turns by %s degrees in the part: more than the contact allows for.",
      shown.number(math.deg(impact.turn)))
  end
  if given.onto then
    say("Nodes alone touch: the obstacle goes %s deep between them at the first touch.",
      core.quantity(drop.obstacle_depth, "m"))
  end
  state_assumptions(opts, given.onto, "the stress between samples", say)
  local function place_of(place)
    return {stress_pa = place.stress, at_m = place.at, utilisation = place.used, verdict = place.verdict,
      region = place.governing and place.governing.region,
      estimated_error = coarse and place.error or nil, depends_on_mesh = place.grows}
  end
  out:json {verdict = verdict, value = drop.peak.stress, quantity = "largest principal stress, Pa",
    at_m = drop.peak.place, time_s = drop.peak.time, touch = place_of(touch), elsewhere = place_of(rest),
    duration_s = impact.duration, duration_estimated_error = errors.duration, force_n = impact.force,
    force_estimated_error = errors.force, impulse_n_s = impact.impulse,
    impulse_estimated_error = errors.impulse, first_touch_m = impact.place,
    speed_m_s = drop.speed, height_m = opts.height, down = given.down, spin_rad_s = given.spin,
    peg_m = opts.peg, edge_m = opts.edge, obstacle_depth_m = given.onto and drop.obstacle_depth,
    energy_j = drop.initial_energy, energy_error = drop.energy_error, modes = drop.modes.count,
    damping_ratio = opts.damping, singular = found.singular ~= nil, too_coarse = found.too_coarse}
  local title = ("%s: dropped from %s; %s"):format(model.name(opts.model), core.quantity(opts.height, "m"), words)
  local failed = out:write_files {{opts.csv, function() return drop:write_history(opts.csv) end},
    {opts.vtu, function() return drop:write(opts.vtu) end},
    {opts.picture, function() return drop:picture(opts.picture, {title = title}) end},
    {opts.report, function()
      return drop_page.of_drop(drop, opts.report, {title = title, answer = table.concat(text, "\n"),
        down = given.down, head = head_of(drop, found, verdict, words, read, opts, given, out)})
    end}}
  if failed then return failed end
  return verdict == "holds" and output.DONE or output.NO
end

local function run_many(opts, given, out)
  local mesh, read, why = body(opts, out)
  if not mesh then return out:fail(read, why) end
  local part, message, details = model.part(read, mesh, opts)
  if not part then return out:fail(message, details) end
  local drops
  drops, message, details = model.try(bw.random_drops, part, {drops = opts.drops, seed = opts.seed,
    height = opts.height, onto = given.onto, damping = damping_of(opts)})
  out:warnings()
  if not drops then return fail(out, message, details, "give fewer --elements") end
  local p, low, high = drops:failures()
  local element = drops.exceedance:argmax()
  local at = centre_of(mesh, element)
  out:say("")
  local say, text = out:recorded()
  say("%s from %s in random attitudes: %s overload the part, with 95 %% confidence %s to %s of such drops.",
    model.count(drops.drops, "drop"), core.quantity(opts.height, "m"), shown.percent(p), shown.percent(low),
    shown.percent(high))
  if drops.stopped then say("It was interrupted: %d of %d drops are done.", drops.drops, opts.drops) end
  if drops.misses > 0 then say("Of the drops, %d miss the obstacle and do no harm.", drops.misses) end
  say("That is the error of their number. The error of the mesh is unknown: one mesh.")
  if p > 0 then
    local region = made_of.region_of(part, element)
    say("Most often overloaded: %s%s, in %s of the drops. Within an element of a touching node that depends on "
      .. "the mesh.", core.point(at), region and " in region " .. region or "",
      shown.percent(drops.exceedance[element]))
  end
  -- of those that hit
  local shortest = drops.durations:map("a + m * (a == 0)", {m = drops.durations:max()}):min()
  say("The first impact lasts %s to %s, with a force of at most %s and a principal stress of at most %s.",
    shown.estimate(shortest, "s"), shown.estimate(drops.durations:max(), "s"),
    shown.estimate(drops.forces:max(), "N"), shown.estimate(drops.peaks:max(), "Pa"))
  say "Verdict: unsure, since the stress of places that touch depends on the mesh."
  say("The balance of energy is kept to %.1e of the energy at the first touch.", drops.energy_error)
  state_assumptions(opts, given.onto, "modes that are left out and of the stress between samples", say)
  out:json {verdict = "unsure", value = p, quantity = "fraction of random drops that overload the part",
    low = low, high = high, drops = drops.drops, stopped = drops.stopped, seed = opts.seed, height_m = opts.height,
    at_m = p > 0 and at or nil, largest_exceedance = drops.exceedance[element],
    largest_stress_pa = drops.peaks:max(), largest_force_n = drops.forces:max(),
    shortest_duration_s = shortest, misses = drops.misses, peg_m = opts.peg,
    edge_m = opts.edge, longest_duration_s = drops.durations:max(), energy_error = drops.energy_error,
    modes = drops.modes.count, damping_ratio = opts.damping,
    region = p > 0 and made_of.region_of(part, element) or nil}
  local title = ("%s: overloaded in %s of %s from %s"):format(model.name(opts.model), shown.percent(p),
    model.count(drops.drops, "random drop"), core.quantity(opts.height, "m"))
  local failed = out:write_files {{opts.vtu, function() return drops:write(opts.vtu) end},
    {opts.picture, function() return drops:picture(opts.picture, {title = title}) end},
    {opts.report, function()
      local material, mass = page_head.part(read.made, opts, out)
      return drop_page.of_random(drops, opts.report, {title = title, answer = table.concat(text, "\n"),
        head = {verdict = "unsure",
          headline = ("%s of drops from %s overload it (%s to %s with 95 %% confidence)."):format(shown.percent(p),
            core.quantity(opts.height, "m"), shown.percent(low), shown.percent(high)),
          facts = {{"Drops", ("%d in random attitudes"):format(drops.drops)},
            {"Largest force", shown.estimate(drops.forces:max(), "N")},
            {"Largest principal stress", shown.estimate(drops.peaks:max(), "Pa")}, material, mass,
            {"Assumption", "one mesh; where it touches, the stress depends on it"}},
          advice = {"Drop it in the worst attitude by itself, with --down, to judge it with an error."}}})
    end}}
  return failed or output.NO
end

local options = {
  made_of.option,
  {name = "height", value = "HEIGHT", type = "number", unit = "m", default = 1, above = 0,
    what = "how far it falls until it touches"},
  {name = "down", value = "X,Y,Z", what = "where it falls, in the axes of the file; 0,0,-1 if left out"},
  {name = "spin", value = "WX,WY,WZ", what = "its angular velocity when it touches, in rad/s"},
  {name = "peg", value = "RADIUS", type = "number", unit = "m", above = 0,
    what = "a rigid peg with a hemispherical tip of this radius, in place of the floor"},
  {name = "edge", value = "RADIUS", type = "number", unit = "m", above = 0,
    what = "a rigid straight edge, rounded with this radius, in place of the floor"},
  {name = "along", value = "X,Y,Z", what = "the direction of the edge, in the axes of the file"},
  {name = "at", value = "X,Y,Z", what = "where the peg or edge is; below the centre of mass if left out"},
  {name = "drops", value = "N", type = "integer", min = 1, max = 100000,
    what = "so many drops in random attitudes, and how often they overload the part; one after another, in the "
      .. "memory of one drop, with its equations and modes"},
  {name = "seed", value = "N", type = "integer", default = 1, what = "of the random attitudes"},
  {name = "damping", value = "RATIO", type = "number", above = 0, below = 1,
    what = "of the critical damping, in every mode; none if left out"},
  model.unit_option,
  model.elements_option,
  {name = "csv", value = "FILE.csv", type = "file", endings = {"csv"},
    what = "write the force, the energies and the stress where it peaks over time, of one drop"},
  {name = "vtu", value = "FILE.vtu", type = "file", endings = model.field_endings,
    what = "write the largest stress over time, or how often each place is overloaded, for ParaView"},
  {name = "picture", value = "FILE.png", type = "file", endings = {"png"}, what = "a picture of the same"},
  {name = "report", value = "FILE.html", type = "file", endings = {"html", "htm"},
    what = "write a page with a 3D view of the same, which opens from disk"},
  model.threads_option,
}
table.move(made_of.value_options, 1, #made_of.value_options, #options + 1, options)

return {
  summary = "how hard a part hits a rigid floor, edge or peg, and how it is stressed",
  about = "Drops a part on a rigid floor, edge or peg and follows it in time until it leaves that. It finds the "
    .. "duration of the impact, the force, and the largest principal stress with its place. A surface is repaired "
    .. "where it must be and filled with quadratic tetrahedra. The stress at an edge or corner that touches "
    .. "grows as elements get smaller: it is judged only where a coarser mesh shows that it does not.\n\n"
    .. output.codes("it holds", "it breaks, or the estimated error or the mesh leaves it open; --drops always "
    .. "leaves it open"),
  arguments = {model.body_argument},
  options = options,
  examples = {"barwright drop part.stl --height 1m --material pla --down -1,-2,-3 --picture drop.png",
    {"barwright drop part.stl --height 1m --peg 5mm", "on a peg below its centre of mass"},
    {"barwright drop part.stl --height 1m --drops 100 --report drops.html", "in random attitudes"}},
  run = function(opts, out)
    local given, message = read_options(opts)
    if not given then return out:misuse(message) end
    if opts.drops then return run_many(opts, given, out) end
    return run_one(opts, given, out)
  end,
}
