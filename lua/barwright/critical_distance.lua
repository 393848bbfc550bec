-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Stress measures that converge at singular edges: the theory of critical distances, notch stress intensity
-- factors, and the stress that a fillet would have. docs/theory/singular.md.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local distance = require("barwright.points").distance
local edge_length = require("barwright.singular_growth").edge_length
local singular = require "barwright.singular"

-- An edge is sampled at so many places at most.
local MAX_STATIONS = 40
-- Nearer to the edge than so many edge lengths of elements, stresses follow Williams' exponent.
local INNER = 2
-- Points of the rest of a line (Simpson's rule: an even number of intervals).
local INTERVALS = 24
-- Stress intensities are fitted between so many edge lengths of elements.
local NEAREST, FARTHEST, SAMPLES = 2, 6, 9
-- A point counts as outside of the body beyond this fraction of the line's length.
local OUTSIDE = 0.02

local function along(point, direction, r)
  return {point[1] + r * direction[1], point[2] + r * direction[2], point[3] + r * direction[3]}
end

local function unit(v)
  local size = distance(v, {0, 0, 0})
  return size > 0 and {v[1] / size, v[2] / size, v[3] / size} or v
end

local function cross(a, b)
  return {a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1]}
end

-- ---- stations along an edge --------------------------------------------------------------------------

-- Places at equal distances along a polyline: {at, inward, tangent}.
local function stations(place, spacing)
  if place.length == 0 then return {} end
  local count = math.max(1, math.min(MAX_STATIONS, math.ceil(place.length / spacing)))
  local list, passed, next = {}, 0, 1
  for i = 1, #place.points - 1 do
    local a, b = place.points[i], place.points[i + 1]
    local length = distance(a, b)
    while next <= count and (next - 0.5) / count * place.length <= passed + length do
      local fraction = length > 0 and ((next - 0.5) / count * place.length - passed) / length or 0
      local at, inward, tangent = {}, {}, {}
      for k = 1, 3 do
        at[k] = (1 - fraction) * a[k] + fraction * b[k]
        inward[k] = (1 - fraction) * place.inward[i][k] + fraction * place.inward[i + 1][k]
        tangent[k] = b[k] - a[k]
      end
      list[next] = {at = at, inward = unit(inward), tangent = unit(tangent)}
      next = next + 1
    end
    passed = passed + length
  end
  return list
end

-- Stress tensors at distances from a station; nil where the line leaves the body.
local function line(static, station, radii)
  local points = {}
  for i, r in ipairs(radii) do points[i] = along(station.at, station.inward, r) end
  local values, outside = static.mesh:sample(static.stress, core.array.new(points))
  if not values then return nil, outside end
  if outside:max() > OUTSIDE * radii[#radii] then
    return nil, ("the line of %s from the edge leaves the body: the wall is too thin for this length"):format(
      core.quantity(radii[#radii], "m"))
  end
  return values:totable()
end

-- ---- the theory of critical distances -------------------------------------------------------------

-- The mean over a line of the length `reach`. Within `inner` the stress follows Williams' exponent.
local function line_mean(static, station, exponent, reach, inner)
  local radii, mean = {}, {}
  for i = 0, INTERVALS do radii[i + 1] = inner + (reach - inner) * i / INTERVALS end
  local rows, message = line(static, station, radii)
  if not rows then return nil, message end
  for k = 1, 6 do
    local sum = rows[1][k] * inner / exponent
    for i = 0, INTERVALS do
      local weight = (i == 0 or i == INTERVALS) and 1 or i % 2 == 1 and 4 or 2
      sum = sum + weight * rows[i + 1][k] * (reach - inner) / INTERVALS / 3
    end
    mean[k] = sum / reach
  end
  return mean
end

-- The stress at one distance; nearer than `inner` by Williams' exponent.
local function point_stress(static, station, exponent, reach, inner)
  local r = math.max(reach, inner)
  local rows, message = line(static, station, {r})
  if not rows then return nil, message end
  for k = 1, 6 do rows[1][k] = rows[1][k] * (reach / r) ^ (exponent - 1) end
  return rows[1]
end

local function largest(tensor)
  return core.principal(core.array.new {tensor})(1, 1)
end

-- What elements of this fraction of the line leave open: a rule of thumb.
local function unresolved(fraction)
  return 0.1 * (fraction + fraction ^ 2)
end

-- Of one station: the judged tensor with what two inner lengths differ by.
local function effective_at(static, place, station, opts)
  local measure = opts.method == "point" and point_stress or line_mean
  local reach = opts.method == "point" and opts.length / 2 or 2 * opts.length
  local edge = edge_length(static.mesh, along(station.at, station.inward, opts.length / 2), station.tangent)
  local inner = math.min(INNER * edge, reach / 2)
  local tensor, message = measure(static, station, place.exponent, reach, inner)
  if not tensor then return nil, message end
  local other = measure(static, station, place.exponent, reach, inner / 2)
  local value = largest(tensor)
  local change = value ~= 0 and math.abs(largest(other) / value - 1) or 0
  return {place = place, at = station.at, stress = tensor, value = value, edge_length = edge,
    estimated_error = math.max(change, unresolved(edge / reach))}
end

local effective_rules = {
  places = {type = "any"},
  length = {type = "number", above = 0},
  method = {type = "string", default = "line", one_of = {"line", "point"}},
}

local function read_places(where, static, given)
  if given == nil then
    local surface, message, details = static.mesh:surface()
    if not surface then return nil, message, details end
    return surface:singular_edges()
  end
  if type(given) ~= "table" or getmetatable(given) ~= singular then
    core.raise(("%s: option 'places': singular places, as part:singular_places() returns them, expected, got %s")
      :format(where, core.got(given)))
  end
  return given
end

local function by_value(a, b)
  if a.value ~= b.value then return a.value > b.value end
  return a.number < b.number
end

-- Of every place with a length the station of the largest value; numbered, by descending value.
local function over_places(places, spacing, evaluate)
  local list, message = {}, nil
  for number, place in ipairs(places) do
    local best
    for _, station in ipairs(stations(place, spacing)) do
      local found, why = evaluate(place, station)
      message = message or why
      if found and (not best or found.value > best.value) then best = found end
    end
    if best then
      best.number = number
      list[#list + 1] = best
    end
  end
  table.sort(list, by_value)
  return list, message
end

local static = core.classes.static.methods

--- The effective stress of the theory of critical distances at every singular edge, the largest first.
function static:effective_stress(given)
  local opts = options.read("effective_stress", given or {}, effective_rules)
  opts.length = opts.length or self.material.critical_distance
  if not opts.length then
    return nil, "the critical distance is not known: give a length, or a material with strength and fracture "
      .. "toughness", {status = "unsupported"}
  end
  local places, message, details = read_places("effective_stress", self, opts.places)
  if not places then return nil, message, details end
  local list, why = over_places(places, opts.length, function(place, station)
    if place.exponent <= 0 then return nil end
    return effective_at(self, place, station, opts)
  end)
  if #list == 0 and why then return nil, why, {status = "unsupported"} end
  local known = self.material.strength
  for _, one in ipairs(list) do
    one.utilisation = known and self.material:utilisation(core.array.new {one.stress})(1, 1) or nil
    one.length, one.method = opts.length, opts.method
  end
  return list
end

-- ---- notch stress intensity factors ------------------------------------------------------------------

-- Williams' exponent of the antisymmetric field: sin(lambda omega) = lambda sin(omega); 1 below 257 degrees.
local function shear_exponent(angle)
  local low, high = 0.499, 0.9999
  local function value(l) return math.sin(l * angle) - l * math.sin(angle) end
  if value(low) * value(high) > 0 then return 1 end
  for _ = 1, 60 do
    local midpoint = (low + high) / 2
    if value(low) * value(midpoint) > 0 then low = midpoint else high = midpoint end
  end
  return low
end

-- n . s m of a tensor xx yy zz yz zx xy.
local function component(s, n, m)
  return n[1] * m[1] * s[1] + n[2] * m[2] * s[2] + n[3] * m[3] * s[3] + (n[2] * m[3] + n[3] * m[2]) * s[4]
    + (n[3] * m[1] + n[1] * m[3]) * s[5] + (n[1] * m[2] + n[2] * m[1]) * s[6]
end

-- K of sigma(r) = K / sqrt(2 pi) r^(lambda - 1), of the normal stress across the bisector: a straight line
-- through the values of K between NEAREST and FARTHEST edge lengths, at r = 0.
local function intensity_at(self, place, station)
  local edge = edge_length(self.mesh, along(station.at, station.inward, 1e-6 * place.length),
    station.tangent)
  local radii = {}
  for i = 1, SAMPLES do radii[i] = edge * (NEAREST + (FARTHEST - NEAREST) * (i - 1) / (SAMPLES - 1)) end
  local rows, message = line(self, station, radii)
  if not rows then return nil, message end
  local n = unit(cross(station.tangent, station.inward))
  local mean_r, mean_k, top, bottom, values = 0, 0, 0, 0, {}
  local second, shear, radial, sum = shear_exponent(place.angle), 0, 0, 0
  for i, r in ipairs(radii) do
    local s = rows[i]
    local across = component(s, n, n)
    shear = shear + math.sqrt(2 * math.pi) * r ^ (1 - second) * component(s, n, station.inward) / SAMPLES
    radial, sum = radial + component(s, station.inward, station.inward), sum + across
    values[i] = math.sqrt(2 * math.pi) * r ^ (1 - place.exponent) * across
    mean_r, mean_k = mean_r + r / SAMPLES, mean_k + values[i] / SAMPLES
  end
  for i, r in ipairs(radii) do
    top, bottom = top + (r - mean_r) * (values[i] - mean_k), bottom + (r - mean_r) ^ 2
  end
  local value, spread = mean_k - top / bottom * mean_r, 0
  for i, r in ipairs(radii) do
    spread = math.max(spread, math.abs(values[i] - value - top / bottom * r))
  end
  return {place = place, at = station.at, value = value, exponent = place.exponent, edge_length = edge,
    shear = shear, shear_exponent = second, radial = sum ~= 0 and radial / sum or 0,
    estimated_error = value ~= 0 and (spread + 0.25 * math.abs(mean_k - value)) / math.abs(value) or math.huge}
end

local intensity_rules = {places = {type = "any"}}

local function intensities(where, self, given, rules)
  local opts = options.read(where, given or {}, rules)
  local places, message, details = read_places(where, self, opts.places)
  if not places then return nil, message, details end
  local low, high = self.mesh.box.min, self.mesh.box.max
  local list, why = over_places(places, distance(low, high) / MAX_STATIONS, function(place, station)
    if place.exponent <= 0 then return nil end
    return intensity_at(self, place, station)
  end)
  if #list == 0 and why then return nil, why, {status = "unsupported"} end
  return list, opts
end

--- The notch stress intensity factor of every singular edge, the largest first.
function static:notch_stress_intensity(given)
  local list, message, details = intensities("notch_stress_intensity", self, given, intensity_rules)
  if not list then return nil, message, details end
  return list
end

-- ---- the stress of a fillet ---------------------------------------------------------------------------

-- What the formula of a fillet's stress may be off by (docs/theory/singular.md).
local FORMULA = 0.1

-- omega~ over the angle inside the material, degrees: Lazzarin and Filippi, Int. J. Solids Struct. 43 (2006).
local fillets = {{180, 0}, {210, 0.2882}, {225, 0.4320}, {240, 0.5700}, {270, 0.8101}, {300, 0.9701},
  {315, 1.0137}, {330, 1.0345}, {360, 1}}

local function fillet_factor(angle)
  local degrees = math.max(180, math.min(360, 180 / math.pi * angle))
  for i = 2, #fillets do
    local a, b = fillets[i - 1], fillets[i]
    if degrees <= b[1] then return a[2] + (b[2] - a[2]) * (degrees - a[1]) / (b[1] - a[1]) end
  end
end

-- The largest stress of a notch of radius rho whose sharp counterpart has these stress intensities. Shear on the
-- bisector turns the principal stress, which grows by the same factor at r0 in the sharp notch.
local function rounded(one, angle, rho)
  local q = angle / math.pi
  local r0 = rho * (q - 1) / q
  local across = one.value * r0 ^ (one.exponent - 1) / math.sqrt(2 * math.pi)
  local radial, shear = one.radial * across, one.shear * r0 ^ (one.shear_exponent - 1) / math.sqrt(2 * math.pi)
  local principal = (across + radial) / 2 + math.sqrt(((across - radial) / 2) ^ 2 + shear ^ 2)
  return (1 + fillet_factor(angle)) * principal
end

local fillet_rules = {places = {type = "any"}, radius = {type = "number", above = 0, needed = true}}

--- The largest stress that every re-entrant edge would have with a fillet of this radius, the largest first.
function static:fillet_stress(given)
  local list, opts, details = intensities("fillet_stress", self, given, fillet_rules)
  if not list then return nil, opts, details end
  local out = {}
  for _, one in ipairs(list) do
    if one.place.kind == "re-entrant edge" then
      out[#out + 1] = {place = one.place, at = one.at, intensity = one.value, radius = opts.radius,
        value = rounded(one, one.place.angle, opts.radius),
        estimated_error = one.estimated_error + FORMULA, number = one.number}
    end
  end
  table.sort(out, by_value)
  return out
end

arguments.methods("static", static, nil, {effective_stress = "options?: options",
  notch_stress_intensity = "options?: options", fillet_stress = "options: options"})
