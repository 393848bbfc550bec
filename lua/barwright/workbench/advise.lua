-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Advice of a workbench: places to thicken by bumps, and what each gains. Under known loads the gain is that of
-- an analysis of the thickened part on a coarse mesh; without loads places are those of the advice about the
-- breaking force.
local body = require "barwright.workbench.body"
local bumps = require "barwright.bumps"
local core = require "barwright.core"
local distance = require("barwright.points").distance
local judge = require "barwright.workbench.judge"
local mirror = require "barwright.workbench.mirror"
local model = require "barwright.command.model"
local on_triangles = require "barwright.on_triangles"
local shown = require "barwright.shown"
local strengthen = require "barwright.strengthen"

local advise = {}

-- Places that are tried under known loads, the radii of bumps there over the diagonal, and their offset over the
-- radius. A narrow bump adds less mass, and a wide one concentrates less stress at its foot.
local PLACES, RADII, OFFSET = 2, {0.06, 0.16}, 0.25
-- A point of a locked face is one so near to its primitive, or to its triangles, over the diagonal.
local ON_FACE = 1e-6
-- A thickening that gains less is no advice.
local MIN_GAIN = 0.01

-- Whether a point lies on the triangles of a face, within a length: a function.
local function on_face(self, number, near)
  local labels, list = self.labels:totable(), {}
  for t, corners in ipairs(self.surface.triangles:totable()) do
    if labels[t] == number then list[#list + 1] = corners end
  end
  return on_triangles(self.surface.points:totable(), list, near)
end

-- Whether a point lies on a face that no edit moves: locked ones and those with supports; nil where there is none.
local function kept(entry)
  local faces, near, some = {}, ON_FACE * model.diagonal(entry.body.surface.box), false
  for face in pairs(entry.locked) do faces[face] = true end
  for _, condition in ipairs(entry.conditions) do
    if condition.kind == "all" or condition.kind == "normal" then
      for _, face in ipairs(condition.faces) do faces[face] = true end
    end
  end
  local list = {}
  for face in pairs(faces) do list[#list + 1] = face end
  table.sort(list)
  local on = {}
  for i, number in ipairs(list) do
    local face = entry.body.faces[number]
    list[i], some = face, true
    -- The facets of a cylinder lie within it, by more than its residual, and other faces have no primitive.
    if face.kind ~= "plane" then on[face] = on_face(entry.body, number, near) end
  end
  if not some then return nil end
  return function(x, y, z)
    for _, face in ipairs(list) do
      if on[face] and on[face](x, y, z) then return true end
      local p, n = face.point or face.centre, face.axis or face.normal
      local d = {x - p[1], y - p[2], z - p[3]}
      local along = d[1] * n[1] + d[2] * n[2] + d[3] * n[3]
      if face.kind == "plane" then
        if math.abs(along) <= near then return true end
      elseif face.kind == "cylinder" then
        local square = d[1] ^ 2 + d[2] ^ 2 + d[3] ^ 2 - along ^ 2
        local away = math.abs(math.sqrt(math.max(square, 0)) - face.radius)
        if away <= near + (face.residual or 0) then return true end
      end
    end
    return false
  end
end

--- The body of an entry with a bump {at, radius, offset}, and its mirror image where edits are symmetric; nil and
--- a sentence where it would not stay sound.
function advise.thickened(entry, place)
  local places = {place}
  if entry.symmetry then
    local image = mirror.point(entry.body, entry.symmetry, place.at)
    if distance(image, place.at) > 0.5 * place.radius then
      places[2] = {at = image, radius = place.radius, offset = place.offset}
    else -- one bump, in the plane
      local middle = {}
      for k = 1, 3 do middle[k] = (image[k] + place.at[k]) / 2 end
      places[1] = {at = middle, radius = place.radius, offset = place.offset}
    end
  end
  local shape, message = bumps.subdivide(bumps.of_surface(entry.body.surface), places)
  if not shape then return nil, message, {status = "limit"} end
  local units = bumps.units(shape, places, kept(entry))
  local surface, why, details = bumps.to_surface(bumps.displaced(shape, places, units))
  if not surface then return nil, why, details end
  local report
  report, why, details = surface:check {limit = 1}
  if not report then return nil, why, details end
  if not report.sound then
    return nil, ("Around %s the part cannot be thickened by %s: the surface would cross itself."):format(
      core.point(place.at), core.quantity(place.offset, "m")), {status = "geometry"}
  end
  return body.replaced(entry.body, surface)
end

-- ---- known loads -----------------------------------------------------------------------------------

-- The most stressed places of the surface, of which no two lie in one bump.
local function stressed(entry, static)
  local size, keep = model.diagonal(entry.body.surface.box), kept(entry)
  local mesh, list = static.mesh, {}
  local nodes, stress = mesh.nodes, static.von_mises
  for i, node in ipairs(mesh.boundary.nodes:totable()) do list[i] = {node = node, stress = stress[node]} end
  table.sort(list, function(a, b)
    if a.stress ~= b.stress then return a.stress > b.stress end
    return a.node < b.node
  end)
  local places = {}
  for _, one in ipairs(list) do
    if #places == PLACES * #RADII then break end
    local at = {nodes(one.node, 1), nodes(one.node, 2), nodes(one.node, 3)}
    local free = not (keep and keep(at[1], at[2], at[3]))
    for _, other in ipairs(places) do free = free and distance(other.at, at) > 1.5 * RADII[1] * size end
    for _, share in ipairs(free and RADII or {}) do
      places[#places + 1] = {at = at, radius = share * size, offset = OFFSET * share * size}
    end
  end
  return places
end

local function text_of(place)
  return ("Thicken by %s within %s of %s%s."):format(shown.estimate(place.offset, "m"),
    shown.estimate(place.radius, "m"), core.point(place.at),
    place.gain and (": the part carries %s more"):format(shown.percent(place.gain)) or "")
end

-- Places under known loads with their gains, best first, and the bodies that they make.
-- `factor`: nothing is looked for where the part carries so much of its loads.
local function under_loads(entry, factor)
  local before, static, more = judge.statics(entry.body, entry.material, entry.conditions, judge.elements.coarse)
  if not before then return nil, static, more end
  if not before.utilisation then
    return nil, "The strength of the material is not known: give it with the material.", {status = "unsupported"}
  end
  local list = {}
  if factor and before.high * factor <= 1 then return list, before end
  for _, place in ipairs(stressed(entry, static)) do
    if core.interrupted() then return nil, "interrupted", {status = "cancelled"} end
    local made = advise.thickened(entry, place)
    local after, _, why = nil, nil, nil
    if made then after, _, why = judge.statics(made, entry.material, entry.conditions, judge.elements.coarse) end
    if type(why) == "table" and why.status == "cancelled" then return nil, "cancelled", why end
    if after then
      place.gain, place.body, place.used = before.utilisation / after.utilisation - 1, made, after.utilisation
      place.text = text_of(place)
      if place.gain > MIN_GAIN then list[#list + 1] = place end
    end
  end
  table.sort(list, function(a, b) return a.gain > b.gain end)
  return list, before
end

-- ---- the worst load --------------------------------------------------------------------------------

local function without_loads(entry, opts)
  local found = entry.solved and entry.solved.breaking
  if not found then
    return nil, "Ask for the answer first: advice is about the place that breaks.", {status = "unsupported"}
  end
  local force = opts.force or 1.25 * found.high
  local advice, message, details = model.try(found.advice, found, {force = force, keep = kept(entry)})
  if not advice then return nil, message, details end
  local list = {}
  for i, place in ipairs(advice.places) do
    list[i] = {at = place.at, radius = place.radius, offset = place.offset}
    list[i].text = text_of(list[i])
  end
  if list[1] then list[1].gain = advice.force / found.force - 1 end
  return list
end

--- Places to thicken: {text, at, radius, offset, gain}. Of the worst load the gain is that of all places together.
function advise.places(entry, opts, has_loads)
  if has_loads then return under_loads(entry) end
  return without_loads(entry, opts)
end

-- ---- optimising ------------------------------------------------------------------------------------

-- Steps with the best place each, until stress over strength is at most 1 / factor.
local function optimise_loads(entry, opts)
  local best, used = entry, nil
  local first
  for _ = 1, opts.steps do
    local list, before, details = under_loads(best, opts.factor)
    if not list then
      if best == entry then return nil, before, details end
      break
    end
    first, used = first or before.utilisation, used or before.utilisation
    if not list[1] then break end
    best = setmetatable({body = list[1].body}, {__index = entry})
    used = list[1].used
  end
  if best == entry then
    return nil, used * opts.factor <= 1 and "The part carries its loads already: nothing to thicken."
      or "No thickening was found that helps.", {status = "infeasible"}
  end
  return best.body, ("Stress over strength fell from %s to %s%s."):format(shown.percent(first),
    shown.percent(used), used * opts.factor > 1
    and "; what was asked for is not reached: this is the best that was found" or "")
end

local function optimise_worst(entry, opts)
  if not opts.force then
    return nil, "Give the force that the part must carry, or add loads.", {status = "unsupported"}
  end
  if entry.symmetry then
    return nil, "Without loads both sides are not thickened alike: switch the symmetry off first.",
      {status = "unsupported"}
  end
  local found, message, details = model.try(strengthen, entry.body.surface, {force = opts.force,
    material = entry.material, elements = judge.elements[opts.accuracy], steps = opts.steps, keep = kept(entry)})
  if not found then return nil, message, details end
  local made, why, about = body.replaced(entry.body, found.surface)
  if not made then return nil, why, about end
  return made, tostring(found)
end

--- The body that carries what is asked for, or the best that was found, and a sentence.
function advise.optimise(entry, opts, has_loads)
  local made, report, details = (has_loads and optimise_loads or optimise_worst)(entry, opts)
  if not made then return nil, report, details end
  local moved, message, about = entry.body.surface:distance(made.surface.points)
  if not moved then return nil, message, about end
  report = report:gsub("%.$", "")
  return made, ("%s; the surface was moved by up to %s."):format(report, core.quantity(moved:max(), "m"))
end

return advise
