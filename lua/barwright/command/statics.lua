-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright statics MODEL: held here, loaded there, does it bear it?
local bw = require "barwright"
local model = require "barwright.command.model"

-- "PLACE=VALUE": what stands before and behind the last "=".
local function split(text)
  local place, value = text:match "^(.*)=([^=]*)$"
  if not place then return nil, ("PLACE=VALUE expected, got '%s'"):format(text) end
  local fine, message = model.check_place(place)
  if not fine then return nil, message end
  return place, value
end

local quantity = require "barwright.command.quantity"

-- Loads, before anything is read: {place =, force = | pressure =}.
local function read_loads(wish)
  local loads = {}
  for _, text in ipairs(wish.force) do
    local place, value = split(text)
    if not place then return nil, "option --force: " .. value end
    local force, message = model.vector(value, "N")
    if not force then return nil, "option --force: " .. message end
    loads[#loads + 1] = {place = place, force = force}
  end
  for _, text in ipairs(wish.pressure) do
    local place, value = split(text)
    if not place then return nil, "option --pressure: " .. value end
    local pressure, expected = quantity.read(value, "Pa")
    if not pressure then return nil, ("option --pressure: %s expected, got '%s'"):format(expected, value) end
    loads[#loads + 1] = {place = place, pressure = pressure}
  end
  if wish.gravity then
    local gravity, message = model.vector(wish.gravity, "m/s2")
    if not gravity then return nil, "option --gravity: " .. message end
    loads.gravity = gravity
  end
  for _, place in ipairs(wish.hold) do
    local fine, message = model.check_place(place)
    if not fine then return nil, "option --hold: " .. message end
  end
  if #wish.hold == 0 then return nil, "option --hold PLACE is missing: a part that nothing holds flies off" end
  if #loads == 0 and not loads.gravity then
    return nil, "nothing loads it: --force, --pressure or --gravity is missing"
  end
  return loads
end

local function set_up(part, wish, loads, out)
  local mesh = part.mesh
  for _, place in ipairs(wish.hold) do
    local selection, message, details = model.select(mesh, place)
    if not selection then return nil, message, details end
    part:fix(selection)
    out:say("Held at %s (%.4g cm2).", place, selection.area * 1e4)
  end
  for _, load in ipairs(loads) do
    local selection, message, details = model.select(mesh, load.place)
    if not selection then return nil, message, details end
    local fine
    fine, message = model.try(part.load, part, {on = selection, force = load.force, pressure = load.pressure})
    if not fine then return nil, load.place .. ": " .. message, {status = "invalid"} end
    if load.force then
      out:say("Pushed at %s (%.4g cm2) by (%.4g, %.4g, %.4g) N.", load.place, selection.area * 1e4,
        table.unpack(load.force))
    else
      out:say("Pressed at %s (%.4g cm2) by %.4g MPa.", load.place, selection.area * 1e4, load.pressure / 1e6)
    end
  end
  if loads.gravity then
    if not part.material.density then
      return nil, "the density of the material is not known", {status = "invalid"}
    end
    part:gravity(loads.gravity)
    out:say("Its weight pulls by (%.4g, %.4g, %.4g) m/s2.", table.unpack(loads.gravity))
  end
  return part
end

local function tell(static, part, wish, out)
  local mesh = part.mesh
  local stress, node = static.von_mises:max(), static.von_mises:argmax()
  local moved = static.displacement:map "norm(a)"
  local most = moved:max()
  local at = {mesh.nodes(node, 1), mesh.nodes(node, 2), mesh.nodes(node, 3)}
  local relative = static:error_estimate()
  local material = part.material
  local used = material.strength and static.utilisation:max() or nil
  out:say("")
  out:say("It gives by %s mm at most. The von Mises stress is highest at %s: %.4g MPa.", model.mm(most),
    model.place(at), stress / 1e6)
  if not used then
    out:say("The strength of %s is not known.", wish.material)
  elseif used >= 1 then
    out:say("The largest principal stress is %.3g times the strength of %s: it breaks.", used, wish.material)
  else
    out:say("The largest principal stress is %.3g %% of the strength of %s: it holds.", 100 * used, wish.material)
  end
  if relative then
    out:say("Estimated error of the stresses: %.2g %% in the mean%s.", 100 * relative,
      relative <= 0.15 and "" or mesh.order == 1 and "; --order 2 or more --elements would make it less"
        or "; more --elements would make it less")
  end
  local solver = static.solver
  if solver.with == "levels" then
    out:say("Solved over two levels of elements in %d iterations; a factor would have taken about %.2g GB.",
      solver.iterations, solver.factor_bytes / 1e9)
  end
  out:json {max_von_mises_pa = stress, max_von_mises_at_m = at, max_displacement_m = most, utilisation = used,
    holds = used and used < 1, strength_pa = material.strength, error_estimate = relative,
    material = wish.material, energy_j = static.energy,
    solver = {with = solver.with, iterations = solver.iterations, residual = static.residual}}
  return not used or used < 1
end

local function analyse(wish, loads, out)
  if wish.threads then bw.threads(wish.threads) end
  local mesh, material, details = model.body(wish, out)
  if not mesh then return nil, material, details end
  local message
  local part
  part, message, details = set_up(bw.model {mesh = mesh, material = material}, wish, loads, out)
  if not part then return nil, message, details end
  local static
  static, message, details = model.try(part.solve, part, {with = wish.with})
  out:remarks()
  if not static then return nil, message, details end
  return static, part
end

return {
  summary = "whether a part bears a load that is known",
  about = "Holds a part in places, loads it in others, and tells how far it gives and whether it breaks. A "
    .. "surface is repaired where it must be and filled with tetrahedra.\n\n" .. model.place_help
    .. "\n\nExit status: 0 it holds (or its strength is not known); 1 it breaks, or nothing could be computed.",
  arguments = {model.body_argument},
  options = {
    model.material_option,
    {name = "hold", value = "PLACE", many = true, what = "hold it there"},
    {name = "force", value = "PLACE=FX,FY,FZ", many = true, what = "a total force, in N, spread over a place"},
    {name = "pressure", value = "PLACE=PRESSURE", many = true, what = "a pressure, in Pa, on a place"},
    {name = "gravity", value = "GX,GY,GZ",
      what = "its own weight: an acceleration in m/s2, 0,0,-9.81 for instance"},
    model.unit_option,
    model.elements_option,
    {name = "order", value = "1|2", type = "integer", default = 2, one_of = {1, 2},
      what = "linear or quadratic elements; linear ones are too stiff"},
    {name = "with", value = "auto|factor|levels", type = "string", default = "auto",
      one_of = {"auto", "factor", "levels"},
      what = "by a factor; over two levels of elements, which takes a tenth of its memory; or as is cheaper"},
    {name = "picture", value = "FILE.png", type = "file", endings = {"png"},
      what = "a picture of the deformed part and its stresses"},
    {name = "vtu", value = "FILE.vtu", type = "file", endings = model.field_endings,
      what = "write all fields, for ParaView"},
    model.threads_option,
  },
  examples = {"barwright statics hook.stl --hold low:z --force high:z=0,0,-50",
    {"barwright statics shelf.stl --hold low:x --pressure high:z=2kPa --gravity 0,0,-9.81", "books on a shelf"}},
  run = function(wish, out)
    local loads, message = read_loads(wish)
    if not loads then return out:misuse(message) end
    local static, part, details = analyse(wish, loads, out)
    if not static then return out:fail(part, details) end
    local good = tell(static, part, wish, out)
    local written = bw.json.list {}
    for _, how in ipairs {{wish.vtu, function() return static:write(wish.vtu) end},
      {wish.picture, function() return static:picture(wish.picture) end}} do
      if how[1] then
        local fine, why, more = how[2]()
        if not fine then return out:fail(why, more) end
        written[#written + 1] = how[1]
      end
    end
    if #written > 0 then out:say("Written: %s.", table.concat(written, ", ")) end
    out:json {files = written}
    return good and 0 or 1
  end,
}
