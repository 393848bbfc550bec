-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright strengthen MODEL: thicken it around its weak places until it carries a force.
local bw = require "barwright"
local core = require "barwright.core"
local holes = require "barwright.command.holes"
local made_of = require "barwright.command.made_of"
local model = require "barwright.command.model"
local output = require "barwright.command.output"
local places = require "barwright.command.places"
local shown = require "barwright.shown"
local writable = require "barwright.writable"

-- Fields of the object for one of before and after.
local function fields_of(one)
  return {breaking_force_n = one.force, breaking_force_low_n = one.low, breaking_force_high_n = one.high,
    estimated_error = one.estimated_error, at_m = one.at, singular = one.singular ~= nil,
    contact_area_m2 = one.contact, deviation_m = one.deviation,
    volume_m3 = one.volume, mass_kg = one.mass}
end

local function row(name, one, out)
  out:say("  %-8s%-32s%12s   %s", name, shown.interval(one.force, one.low, one.high, "N"),
    one.mass and core.quantity(one.mass, "kg") or core.quantity(one.volume, "m3"), core.point(one.at))
end

local function report(result, moved, opts, out)
  out:say("")
  out:say("  %-8s%-32s%12s   weakest place", "", "breaks at (interval)", result.before.mass and "mass" or "volume")
  row("before", result.before, out)
  row("after", result.after, out)
  local fraction = result.added_volume / result.before.volume
  local density = result.options.material.density
  if #result.steps == 0 then
    out:say "Nothing was added."
  else
    out:say("Added: %s, %s, in %s: in all, the surface was moved out by up to %s.", density
      and core.quantity(density * result.added_volume, "kg") or core.quantity(result.added_volume, "m3"),
      shown.percent(fraction), model.count(#result.steps, "step"), core.quantity(moved:max(), "m"))
  end
  out:say("The surface is that of the file, split only where it was thickened: %d triangles, %d before. "
    .. "The mesh that was analysed lies up to %s from it.", result.surface.triangle_count,
    result.original.triangle_count, core.quantity(result.after.deviation, "m"))
  if result.reached then
    out:say("%s is reached: the whole interval lies above.", core.quantity(opts.force, "N"))
  else
    out:say("%s is not reached: the interval begins below%s.", core.quantity(opts.force, "N"), result.stopped
      and "; " .. result.stopped or ("; --steps allows %d"):format(opts.steps))
  end
  local steps = bw.json.list {}
  for i, step in ipairs(result.steps) do
    steps[i] = {places = step.places, largest_offset_m = step.offset, predicted_breaking_force_n = step.predicted,
      breaking_force_n = step.force, breaking_force_low_n = step.low, breaking_force_high_n = step.high}
  end
  out:json {verdict = result.reached and "reached" or "not reached", force_n = opts.force,
    before = fields_of(result.before), after = fields_of(result.after), steps = steps, stopped = result.stopped,
    added_volume_m3 = result.added_volume, added_mass_kg = density and density * result.added_volume or nil,
    added_fraction = fraction, largest_thickness_m = moved:max(), repaired = result.repaired or false}
end

-- How far the surface moved, on the surface.
local function picture(result, moved, path)
  local before, after = result.before, result.after
  return bw.picture(result.surface, path, {values = moved, scale = 1e3, unit = "thickened by, mm",
    title = ("breaks at %s, before: %s"):format(shown.interval(after.force, after.low, after.high, "N"),
      shown.interval(before.force, before.low, before.high, "N"))})
end

local function write_files(result, moved, read, opts, out)
  local files = bw.json.list {opts.out}
  local ok, message, details = result.surface:write(opts.out, {unit = model.unit_of(read, opts)})
  if ok and opts.picture then
    files[2] = opts.picture
    ok, message, details = picture(result, moved, opts.picture)
  end
  if not ok then return nil, message, details end
  out:json {files = files}
  out:say("Written: %s.", table.concat(files, ", "))
  return true
end

-- Whether a point must not move: a function, false where all may, or nil, message, details.
local function kept(read, opts, out)
  local list, tests = {}, {}
  for _, place in ipairs(opts.keep) do
    if place == "holes" then
      local found, message, details = holes.of(read.surface)
      if not found then return nil, message, details end
      out:say("Kept: %s.", #found > 0 and model.count(#found, "round hole") or "no round hole is there")
      tests[1] = holes.test(found)
    else
      list[#list + 1] = place
    end
  end
  if #list > 0 then
    local test, message = places.test(list, read.surface)
    if not test then return nil, "option --keep: " .. message, {status = "empty"} end
    tests[#tests + 1] = test
  end
  if #tests < 2 then return tests[1] or false end
  return function(...) return tests[1](...) or tests[2](...) end
end

local function strengthen(opts, out)
  local start = bw.seconds()
  if opts.threads then bw.threads(opts.threads) end
  local ok, message, details = writable(opts.out)
  if not ok then return nil, message, details end
  for _, place in ipairs(opts.keep) do
    if place ~= "holes" then ok, message = places.check(place) end
    if not ok then return nil, "option --keep: holes or a place: " .. message, {status = "misuse"} end
  end
  local read
  read, message, details = model.start(opts, out, "strengthen")
  if not read then return nil, message, details end
  if read.kind == "outline" then return model.mesh(read, opts, out) end
  if read.kind ~= "surface" then
    return nil, opts.model .. ": a mesh of tetrahedra: strengthening needs a surface (STL OBJ OFF PLY)",
      {status = "unsupported"}
  end
  local material = read.made.default
  local result, keep
  keep, message, details = kept(read, opts, out)
  if keep == nil then return nil, message, details end
  local steps = 0
  result, message, details = model.try(bw.strengthen, read.surface, {material = material, force = opts.force,
    contact = opts.contact, elements = opts.elements, length = opts.length,
    modes = opts.modes, regions = opts.regions, unit = read.metres_per_unit,
    steps = opts.steps, keep = keep or nil,
    progress = function(step)
      steps = steps + 1
      out:say("  step %d: %s thickened by up to %s in this step; now it breaks at %s", steps,
        model.count(step.places, "place"), shown.estimate(step.offset, "m"),
        shown.interval(step.force, step.low, step.high, "N"))
    end})
  out:warnings()
  if not result then return nil, opts.model .. ": " .. message, details end
  out:json {unit = model.unit_of(read, opts), material = material.name}
  local moved
  moved, message, details = result.original:distance(result.surface.points)
  if not moved then return nil, message, details end
  report(result, moved, opts, out)
  ok, message, details = write_files(result, moved, read, opts, out)
  if not ok then return nil, message, details end
  out:json {seconds = bw.seconds() - start}
  return result
end

local options = {
  {name = "force", value = "FORCE", type = "number", unit = "N", above = 0, needed = true,
    what = "the force that it must carry: the load on one side, which the reactions balance"},
  {name = "out", value = "FILE.stl", type = "file", endings = {"stl", "obj", "off", "ply"}, needed = true,
    what = "where the strengthened surface goes, in the unit of the input"},
  made_of.one_option,
  {name = "keep", value = "PLACE", many = true,
    what = "where the surface must not move; `holes`: on the walls of round holes"},
  model.contact_option,
  model.length_option,
  {name = "steps", value = "N", type = "integer", default = 8, min = 1, max = 100,
    what = "how often it is thickened and computed again at most"},
  model.unit_option,
  model.elements_option,
  model.search_options[1],
  model.search_options[2],
  {name = "picture", value = "FILE.png", type = "file", endings = {"png"},
    what = "write a picture of what was thickened, and by how much"},
  model.threads_option,
}
table.move(made_of.value_options, 1, #made_of.value_options, #options + 1, options)

return {
  summary = "thicken a part around its weak places until it carries a force",
  about = "Computes the least force that breaks a part (as `barwright worst`), thickens its surface where it is "
    .. "too weak for the force asked for, computes again, and repeats this until the force lies below the whole "
    .. "interval. Where and by how much follows from the shape gradients of the judged stresses. The surface is "
    .. "moved outwards by smooth bumps; holes and gaps become narrower where they are not kept.\n\n"
    .. places.help .. "\n\n"
    .. output.codes("the force is reached", "it is not, the best that was found is written"),
  arguments = {{name = "model", type = "file", what = "surface (STL OBJ OFF PLY)"}},
  options = options,
  examples = {"barwright strengthen hook.stl --force 50N --out stronger.stl",
    {"barwright strengthen hook.stl --force 50N --out stronger.stl --keep min:z --picture where.png",
      "the face that it stands on stays"},
    {"barwright strengthen hook.stl --force 50N --out stronger.stl --keep holes", "bolts still fit"}},
  run = function(opts, out)
    local result, message, details = strengthen(opts, out)
    if not result then return out:fail(message, details) end
    return result.reached and 0 or 1
  end,
}
