-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The supports and loads that `statics`, `buckle` and `respond` take on the command line.
local core = require "barwright.core"
local model = require "barwright.command.model"
local places = require "barwright.command.places"
local quantity = require "barwright.command.quantity"
local shown = require "barwright.shown"

local loads = {}

loads.options = {
  force = {name = "force", value = "PLACE=FX,FY,FZ", many = true,
    what = "a total force, in N, spread over a place"},
  pressure = {name = "pressure", value = "PLACE=PRESSURE", many = true, what = "a pressure, in Pa, on a place"},
  gravity = {name = "gravity", value = "GX,GY,GZ",
    what = "gravity: an acceleration in m/s2, 0,0,-9.81 for instance"},
}

--- Loads, before anything is read: {place =, force = | pressure =}, with `gravity` or `base`, accelerations.
--- `own`: which of the two the command takes.
function loads.read(opts, own)
  local list = {}
  for _, text in ipairs(opts.force) do
    local place, value = places.split(text)
    if not place then return nil, "option --force: " .. value end
    local force, message = places.vector(value, "N")
    if not force then return nil, "option --force: " .. message end
    list[#list + 1] = {place = place, force = force}
  end
  for _, text in ipairs(opts.pressure) do
    local place, value = places.split(text)
    if not place then return nil, "option --pressure: " .. value end
    local pressure, expected = quantity.read(value, "Pa")
    if not pressure then return nil, ("option --pressure: %s expected, got '%s'"):format(expected, value) end
    list[#list + 1] = {place = place, pressure = pressure}
  end
  for _, name in ipairs {"gravity", "base"} do
    if opts[name] then
      local acceleration, message = places.vector(opts[name], "m/s2")
      if not acceleration then return nil, ("option --%s: %s"):format(name, message) end
      list[name] = acceleration
    end
  end
  for _, place in ipairs(opts.fix) do
    local ok, message = places.check(place)
    if not ok then return nil, "option --fix: " .. message end
  end
  if #opts.fix == 0 then return nil, "option --fix PLACE is missing: a part without supports moves freely" end
  if #list == 0 and not (list.gravity or list.base or opts.spectrum) then
    return nil, ("no load is given: --force, --pressure or --%s is missing"):format(own)
  end
  return list
end

--- What the loads are, in words: "max:z: (0, 0, -10) N; gravity (0, 0, -9.81) m/s2".
function loads.text(given)
  local list = {}
  for i, load in ipairs(given) do
    list[i] = load.place .. ": " .. (load.force and shown.vector(load.force, "N")
      or core.quantity(load.pressure, "Pa"))
  end
  if given.gravity then list[#list + 1] = "gravity " .. shown.vector(given.gravity, "m/s2") end
  return table.concat(list, "; ")
end

--- A sentence where the loads of statics are all zero: nothing is tried then; nil elsewhere.
function loads.nothing(given)
  for _, load in ipairs(given) do
    if load.pressure and load.pressure ~= 0 then return nil end
    for _, x in ipairs(load.force or {}) do
      if x ~= 0 then return nil end
    end
  end
  for _, x in ipairs(given.gravity or {}) do
    if x ~= 0 then return nil end
  end
  return "every load is 0, so that nothing is tried: give a --force, a --pressure or --gravity that is not 0"
end

-- Whether all nodes of a selection are in a set.
local function lies_in(selection, set)
  for _, node in ipairs(selection.nodes:totable()) do
    if not set[node] then return false end
  end
  return true
end

--- Supports and loads of a part; the part and the supported area (m2), or nil, message, details.
function loads.set_up(part, opts, given, out)
  local mesh, area, fixed = part.mesh, 0, {}
  for _, place in ipairs(opts.fix) do
    local selection, message, details = places.select(mesh, place)
    if not selection then return nil, message, details end
    local ok
    ok, message = model.try(part.fix, part, selection)
    if not ok then return nil, place .. ": " .. message, {status = "invalid"} end
    area = area + selection.area
    for _, node in ipairs(selection.nodes:totable()) do fixed[node] = true end
    out:say("Constrained at %s (%s).", place, core.quantity(selection.area, "m2"))
  end
  if lies_in(mesh.boundary, fixed) then
    return nil, ("the whole surface is constrained at %s: no load reaches the body; constrain a smaller place")
      :format(table.concat(opts.fix, ", ")), {status = "invalid"}
  end
  for _, load in ipairs(given) do
    local selection, message, details = places.select(mesh, load.place)
    if not selection then return nil, message, details end
    if lies_in(selection, fixed) then
      return nil, ("the load at %s lies on a support, which takes all of it: move the load, or constrain a "
        .. "smaller place"):format(load.place), {status = "invalid"}
    end
    local ok
    ok, message = model.try(part.load, part, {on = selection, force = load.force, pressure = load.pressure})
    if not ok then return nil, load.place .. ": " .. message, {status = "invalid"} end
    if load.force then
      out:say("Load applied at %s (%s): force %s.", load.place, core.quantity(selection.area, "m2"),
        shown.vector(load.force, "N"))
    else
      out:say("Load applied at %s (%s): pressure %s.", load.place, core.quantity(selection.area, "m2"),
        core.quantity(load.pressure, "Pa"))
    end
  end
  if given.gravity then
    if not part.material.density then
      return nil, ("the density of %s is not known"):format(part.material.name), {status = "invalid"}
    end
    part:gravity(given.gravity)
    out:say("Load applied to the whole part: gravity %s.", shown.vector(given.gravity, "m/s2"))
  end
  return part, area
end

return loads
