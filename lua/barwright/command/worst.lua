-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright worst MODEL: where it breaks, whatever happens to it.
local bw = require "barwright"
local model = require "barwright.command.model"

-- The share of what full pressure could push that the total force may be: with less room the programme has
-- few loads to choose from, or none.
local MOST_OF_PRESSURE = 0.05

local function newtons(force)
  return ("%.4g N"):format(force)
end

local function megapascals(stress)
  return ("%.4g MPa"):format(stress / 1e6)
end

local function the_force(wish, area, out)
  local room = MOST_OF_PRESSURE * wish.pressure * area
  local lowered = wish.force > room
  if lowered then
    out:say("  %s would take up too much of what a pressure of %s can push on %.4g cm2: the force is lowered to "
      .. "%s.", newtons(wish.force), megapascals(wish.pressure), area * 1e4, newtons(room))
  end
  local force = lowered and room or wish.force
  out:json {force_n = force, force_asked_n = wish.force, force_lowered = lowered, pressure_pa = wish.pressure}
  return force
end

local function keep(worst, force, wish, out)
  local used, holds = worst.utilisation, nil -- nothing is said of a force that was lowered
  if used and (used >= 1 or force >= wish.force) then holds = used < 1 end
  out:json {
    max_principal_pa = worst.max_principal, max_principal_at_m = worst.at, strength_pa = worst.strength,
    utilisation = worst.utilisation, max_displacement_m = worst.max_displacement, worst_region = worst.region,
    material = wish.material, frequencies_hz = worst.modes.frequencies and worst.modes.frequencies:totable(),
    holds = holds,
  }
  local regions = bw.json.list {}
  for i, region in ipairs(worst.regions) do
    regions[i] = {mode = region.mode, rank = region.rank, max_principal_pa = region.max_principal,
      max_principal_at_m = region.at, utilisation = region.utilisation, max_displacement_m = region.displacement,
      elements = region.elements, volume_fraction = region.volume_fraction}
  end
  out:json {regions = regions}
end

-- The answer, in sentences.
local function tell(worst, force, wish, out)
  out:say("")
  out:say("Pushed by %s in the worst way that pressures up to %s allow, %s is stressed most at %s: %s. It gives "
    .. "by %s mm.", newtons(force), megapascals(wish.pressure), model.name(wish.model), model.place(worst.at),
    megapascals(worst.max_principal), model.mm(worst.max_displacement))
  local used = worst.utilisation
  if not used then
    out:say("The strength of %s is not known.", wish.material)
  elseif used >= 1 then
    out:say("That is %.3g times the strength of %s: it breaks there. %.3g %% of this force and pressure it would "
      .. "bear.", used, wish.material, 100 / used)
  else
    out:say("That is %.3g %% of the strength of %s: it holds; %.3g times this force and pressure would break it.",
      100 * used, wish.material, 1 / used)
  end
  if force < wish.force and not (used and used >= 1) then
    out:say("This says nothing of the %s asked for: give a higher --pressure to try them.", newtons(wish.force))
  end
end

-- Files that were asked for: name of the option, and how it is written. With --out all of them.
local function write_files(worst, wish, folder, out)
  local written = {}
  local function leave(path, value, message, details)
    if not value then return nil, message, details end
    written[#written + 1] = path
    return true
  end
  local function file(name, own)
    return own or folder and folder:path(name)
  end
  local picture, vtu, report = file("weakness.png", wish.picture), file("worst.vtu", wish.vtu),
    file("report.html", wish.report)
  local fine, message, details = true, nil, nil
  if picture then fine, message, details = leave(picture, worst:picture(picture)) end
  if fine and vtu then fine, message, details = leave(vtu, worst:write(vtu)) end
  if fine and folder then
    local path = folder:path "worst_load.png"
    fine, message, details = leave(path, worst:picture(path, {region = worst.region}))
  end
  if fine and report then
    fine, message, details = leave(report, worst:report(report, {manifest = folder and folder.manifest,
      title = "Worst case of " .. model.name(wish.model)}))
  end
  if not fine then return nil, message, details end
  out:json {files = bw.json.list(written)}
  if #written > 0 then out:say("Written: %s.", table.concat(written, ", ")) end
  return true
end

local function analyse(wish, out)
  local start = bw.seconds()
  if wish.threads then bw.threads(wish.threads) end
  local folder
  if wish.out then
    local options = model.pick({"force", "pressure", "modes", "regions", "elements", "order", "material",
      "unit"}, wish)
    local message, details
    folder, message, details = bw.results.open(wish.out, {script = "barwright worst", inputs = {wish.model},
      options = options, seed = 1})
    if not folder then return nil, message, details end
  end
  local mesh, material, details = model.body(wish, out)
  if not mesh then return nil, material, details end
  local force = the_force(wish, mesh.boundary.area, out)
  local worst, message
  worst, message, details = model.try(bw.worst_case, bw.model {mesh = mesh, material = material}, {force = force,
    pressure = wish.pressure, modes = wish.modes, regions = wish.regions})
  out:remarks()
  if not worst then return nil, message, details end
  keep(worst, force, wish, out)
  tell(worst, force, wish, out)
  local fine
  fine, message, details = write_files(worst, wish, folder, out)
  if not fine then return nil, message, details end
  out:json {seconds = bw.seconds() - start}
  if folder then
    fine, message, details = folder:write(out.object)
    if not fine then return nil, message, details end
  end
  return worst
end

return {
  summary = "where a part breaks, whatever happens to it",
  about = "Finds the places where a part can be stressed most by any pressures that a hand, a fall or a tool may "
    .. "exert on it: no loads need to be known (Zhou, Panetta, Zorin 2013). A surface is repaired where it must "
    .. "be and filled with tetrahedra; a mesh of tetrahedra is taken as it is.\n\n"
    .. "Exit status: 0 it holds (or its strength is not known); 1 it breaks, or nothing could be computed.",
  arguments = {model.body_argument},
  options = {
    model.material_option,
    {name = "force", value = "FORCE", type = "number", unit = "N", default = 20, above = 0,
      what = "what pushes altogether; a hand's by default"},
    {name = "pressure", value = "PRESSURE", type = "number", unit = "Pa", default = 2e5, above = 0,
      what = "the most that presses anywhere; a finger's by default"},
    model.unit_option,
    model.elements_option,
    model.order_option,
    {name = "modes", value = "N", type = "integer", default = 15, least = 1, most = 500,
      what = "modes of vibration in which weak regions are looked for"},
    {name = "regions", value = "N", type = "integer", default = 5, least = 1, most = 1000,
      what = "weak regions of each mode"},
    {name = "report", value = "FILE.html", type = "file", endings = {"html", "htm"},
      what = "write a page with a 3D view that turns"},
    {name = "picture", value = "FILE.png", type = "file", endings = {"png"},
      what = "write a picture of the weak places"},
    {name = "vtu", value = "FILE.vtu", type = "file", endings = model.field_endings,
      what = "write all fields, for ParaView"},
    {name = "out", value = "FOLDER", type = "folder", what = "write all of these and result.json, manifest.json "
      .. "into a folder"},
    model.threads_option,
  },
  examples = {{"barwright worst hook.stl --material pla --report hook.html",
      "opens in a browser, without network"},
    {"barwright worst hook.stl --force 50N --json | jq .utilisation", "as one number"}},
  run = function(wish, out)
    local worst, message, details = analyse(wish, out)
    if not worst then return out:fail(message, details) end
    return (worst.utilisation or 0) < 1 and 0 or 1
  end,
}
