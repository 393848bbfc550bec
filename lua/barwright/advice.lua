-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Advice: which places of a body to thicken, and by how much, so that it carries a force. The judged stresses of
-- the weak places, under their worst loads, are linearised by shape gradients (one adjoint solution for each),
-- and a small quadratic program finds the least offsets. docs/theory/strengthen.md has the mathematics.
local bumps = require "barwright.bumps"
local core = require "barwright.core"
local options = require "barwright.options"
local distance = require("barwright.points").distance
local shown = require "barwright.shown"

local advice = {}
advice.__index = advice
advice.__name = "barwright.advice"

local rules = {
  force = {type = "number", above = 0, needed = true},
  estimate = {type = "number", above = 0},
  keep = {type = "function"},
  max_offset = {type = "number", default = 0.25, above = 0, max = 1},
}

-- Places at most. Where more are needed to cover all that is too weak, bumps are larger by this factor, and again.
local MAX, WIDER = 20, 1.25
-- The radius of a bump: so many times the judged patch's radius, or the thickness there times the second; at most
-- this fraction of the diagonal.
local OF_PATCH, OF_THICKNESS, OF_DIAGONAL = 3, 1.25, 0.2
-- An offset is at most this fraction of the thickness: the linearised stresses do not reach further.
local MAX_THICKNESS_FRACTION = 0.5
-- Places are this fraction of the radius apart at least.
local APART = 0.6
-- Bumps of a smaller fraction of their radius are left out.
local MIN_OFFSET = 1e-3
-- Rays by which thicknesses are measured.
local RAYS = 4000
-- The prediction is taken to be off by this fraction of the logarithm of what it promises.
local OFF = 0.5
-- The step of the central difference of the utilisation by the stress, over the stress's size.
local STEP = 1e-5
-- What is aimed at beyond the force, as the linearised stresses fall short of it.
local MARGIN = 1.02
-- The estimate over the lower end that is allowed for, at most.
local WIDEST = 2

local function diagonal(box)
  return distance(box.min, box.max)
end

-- The derivative of the utilisation by the six components of a stress, from central differences.
local function slope_of(breaking, utilisation, stress)
  local size, rows = 0, {}
  for k = 1, 6 do size = math.max(size, math.abs(stress[k])) end
  for k = 1, 6 do
    for _, sign in ipairs {1, -1} do
      local row = table.move(stress, 1, 6, 1, {})
      row[k] = row[k] + sign * STEP * size
      rows[#rows + 1] = row
    end
  end
  local used, slope = utilisation(breaking, core.array.new(rows)), {}
  for k = 1, 6 do slope[k] = (used[2 * k - 1] - used[2 * k]) / (2 * STEP * size) end
  return slope
end

-- Under the load of a region.
local function mean_stress(breaking, region)
  local worst = breaking.worst
  local u, message, details = worst:displacement(region)
  if not u then return nil, message, details end
  local stress
  stress, message, details = core.surface_stress(breaking.mesh, breaking.material, u,
    worst.basis:force(worst.loads.pressures[region]))
  if not stress then return nil, message, details end
  return core.surface_mean(breaking.mesh, stress, breaking.length, worst.system)
end

-- The nodes where the utilisation of one of the judged loads is above a limit: {[node] = {used, region, stress}}
-- with the largest utilisation, and the load and mean stress that cause it.
local function nodes_above(breaking, utilisation, limit)
  local above, seen = {}, {}
  for _, place in ipairs(breaking.worst.places) do
    if place.utilisation > limit and not seen[place.region] then
      seen[place.region] = true
      local mean, message, details = mean_stress(breaking, place.region)
      if not mean then return nil, message, details end
      for node, value in ipairs(utilisation(breaking, mean):totable()) do
        value = type(value) == "table" and value[1] or value
        if value > (above[node] and above[node].used or limit) then
          above[node] = {used = value, region = place.region, stress = mean:rows(node, node):totable()[1]}
        end
      end
    end
  end
  return above
end

-- Thickness at a point: the median of the rays that start nearest to it.
local function thickness_meter(mesh)
  local surface, message, details = mesh:surface()
  if not surface then return nil, message, details end
  local values, places
  values, places, details = surface:thickness(RAYS)
  if not values then return nil, places, details end
  values, places = values:totable(), places:totable()
  return function(at)
    local near = {}
    for i, p in ipairs(places) do near[i] = {distance(p, at), values[i]} end
    table.sort(near, function(a, b) return a[1] < b[1] end)
    local list = {}
    for i = 1, math.min(7, #near) do list[i] = near[i][2] end
    table.sort(list)
    return list[(#list + 1) // 2]
  end
end

-- Of a list of nodes those of which no two lie within one bump, MAX at most, and whether there are more. Bumps
-- are as large as the thickness asks for, times `wider`.
local function apart(breaking, list, thickness, wider)
  local chosen, max = {}, OF_DIAGONAL * diagonal(breaking.box)
  for _, one in ipairs(list) do
    local free = true
    for _, other in ipairs(chosen) do free = free and distance(other.at, one.at) > APART * other.radius end
    if free and #chosen == MAX then return chosen, true end
    if free then
      one.thickness = one.thickness or thickness(one.at)
      local radius = math.max(OF_PATCH * breaking.length,
        one.thickness < math.huge and OF_THICKNESS * one.thickness or 0)
      one.radius = math.min(wider * radius, max)
      chosen[#chosen + 1] = one
    end
  end
  return chosen, false
end

-- The places to thicken, weakest first: {at, node, region, used, stress, thickness, radius}. They cover all nodes
-- above the limit unless even the largest bumps do not.
local function choose(breaking, above, keep)
  local thickness, message, details = thickness_meter(breaking.mesh)
  if not thickness then return nil, message, details end
  local nodes, list = breaking.mesh.nodes, {}
  for node, one in pairs(above) do
    one.node, one.at = node, {nodes(node, 1), nodes(node, 2), nodes(node, 3)}
    if not (keep and keep(one.at[1], one.at[2], one.at[3])) then list[#list + 1] = one end
  end
  table.sort(list, function(a, b)
    if a.used ~= b.used then return a.used > b.used end
    return a.node < b.node
  end)
  local max, wider = OF_DIAGONAL * diagonal(breaking.box), 1
  local chosen, more = apart(breaking, list, thickness, wider)
  while more and wider * OF_PATCH * breaking.length < max do
    wider = WIDER * wider
    chosen, more = apart(breaking, list, thickness, wider)
  end
  return chosen
end

-- The shape gradient of the judged utilisation at a place {node, region}, and its value, under the worst load of
-- the judged component: a row for every node, by its position, inner nodes following the boundary. nil, message,
-- details where it cannot be computed.
local function gradient_of(breaking, utilisation, place)
  local worst, mesh = breaking.worst, breaking.mesh
  if (worst.limits.hands or 0) > 0 or worst.basis.directions > 1 then
    return nil, "the shape gradient is not implemented for loads with friction or of several hands",
      {status = "unsupported"}
  end
  local slope = core.array.new {slope_of(breaking, utilisation, place.stress)}
  local force, by_force, details = core.patch_functional(worst.system, breaking.length, place.node, slope)
  if not force then return nil, by_force, details end
  local adjoint, message
  adjoint, message, details = worst.system:solve(force)
  if not adjoint then return nil, message, details end
  local limits = worst.limits
  local pressure, value, motion, price = core.priced_load(worst.system, worst.basis,
    worst.basis:gradient(adjoint + by_force), {pressure = limits.pressure, force = limits.force,
    force_is_max = limits.force_is_max})
  if not pressure then return nil, value, motion end
  local u
  u, message, details = worst.system:solve(worst.basis:force(pressure))
  if not u then return nil, message, details end
  local gradient
  gradient, message, details = core.patch_gradient(worst.basis, worst.system, {radius = breaking.length,
    node = place.node, slope = slope, displacement = u, adjoint = adjoint - motion, pressure = pressure,
    price = price})
  if not gradient then return nil, message, details end
  gradient, message, details = core.boundary_gather(mesh, gradient)
  if not gradient then return nil, message, details end
  return gradient, value
end

-- The gradient of every place's utilisation, over the utilisation, by the positions of all points of the shape.
local function gradients(breaking, utilisation, shape, places)
  local list = {}
  for i, place in ipairs(places) do
    local gradient, value, details = gradient_of(breaking, utilisation, place)
    if not gradient then return nil, value, details end
    place.used = math.max(place.used, value)
    list[i] = {}
    for k, node in ipairs(shape.nodes) do
      list[i][k] = {gradient(node, 1) / value, gradient(node, 2) / value, gradient(node, 3) / value}
    end
  end
  return list
end

-- The change of the logarithm of every place's utilisation by 1 m of each of some bumps.
local function sensitivities(shape, slopes, moved, keep)
  local units, matrix = bumps.units(shape, moved, keep), {}
  for i, slope in ipairs(slopes) do
    matrix[i] = {}
    for j, unit in ipairs(units) do
      local sum = 0
      for k, d in pairs(unit) do sum = sum + slope[k][1] * d[1] + slope[k][2] * d[2] + slope[k][3] * d[3] end
      matrix[i][j] = sum
    end
  end
  return matrix
end

-- The least offsets of some places with which the logarithms of all fall to that of the limit, where that can be,
-- each at most a fraction of its radius and of the thickness. In radii, so that the numbers are of order one.
local function offsets(places, moved, matrix, limit, max)
  local H, A, b, lower, upper, g = {}, {}, {}, {}, {}, {}
  for j, place in ipairs(moved) do
    H[j], lower[j], g[j] = {}, 0, 0
    for k = 1, #moved do H[j][k] = j == k and 1 or 0 end
    upper[j] = math.min(max, MAX_THICKNESS_FRACTION * place.thickness / place.radius)
  end
  for i, place in ipairs(places) do
    A[i], b[i] = {}, math.log(limit / place.used)
    for j, other in ipairs(moved) do A[i][j] = matrix[i][j] * other.radius end
  end
  local x, violation, details = core.quadratic_program {H = core.array.new(H), g = core.array.new(g),
    A = core.array.new(A), b = core.array.new(b), min = core.array.new(lower), max = core.array.new(upper)}
  if not x then return nil, violation, details end
  for j, place in ipairs(moved) do place.offset = math.max(0, x[j]) * place.radius end
  return true
end

-- Places with their offsets, and the matrix of their bumps. Bumps that are not needed are left out, and the
-- offsets of the others are recomputed, so that the prediction is that of the bumps that are applied.
local function solve(breaking, utilisation, places, limit, opts)
  local shape = bumps.of_mesh(breaking.mesh)
  local slopes, message, details = gradients(breaking, utilisation, shape, places)
  if not slopes then return nil, message, details end
  local moved = places
  while #moved > 0 do
    local matrix = sensitivities(shape, slopes, moved, opts.keep)
    local ok
    ok, message, details = offsets(places, moved, matrix, limit, opts.max_offset)
    if not ok then return nil, message, details end
    local needed = {}
    for _, place in ipairs(moved) do
      if place.offset > MIN_OFFSET * place.radius then needed[#needed + 1] = place end
    end
    if #needed == #moved then return moved, matrix end
    moved = needed
  end
  return moved, {}
end

--- The estimate that is needed for the lower end of the interval to reach a force, as far as an analysis tells. An
--- interval that decides nothing begins at 0.
function advice.goal(breaking, force)
  return force * math.min(breaking.force / breaking.low, WIDEST)
end

--- Advice for a breaking force (see bw.breaking_force). `utilisation(breaking, stress)` is the utilisation of rows
--- of stresses.
function advice.of(breaking, utilisation, given)
  local opts = options.read("advice", given, rules)
  if not breaking.worst then core.raise "advice: this breaking force is closed" end
  local self = setmetatable({required = opts.force, places = {}, force = breaking.force, low = breaking.low,
    high = breaking.high}, advice)
  local goal = opts.estimate or advice.goal(breaking, opts.force)
  if breaking.force >= goal then return self end
  local limit = breaking.reference / (MARGIN * goal) -- utilisations are those of the reference force
  local extended, message, details = breaking.worst:extend(limit)
  if not extended then return nil, message, details end
  local above, places
  above, message, details = nodes_above(breaking, utilisation, limit)
  if not above then return nil, message, details end
  places, message, details = choose(breaking, above, opts.keep)
  if not places then return nil, message, details end
  if #places == 0 then
    return nil, "all weak places are on faces that must not move", {status = "infeasible"}
  end
  local moved, matrix
  moved, matrix, details = solve(breaking, utilisation, places, limit, opts)
  if not moved then return nil, matrix, details end
  for j, place in ipairs(moved) do
    self.places[j] = {at = place.at, radius = place.radius, offset = place.offset}
  end
  self.reference, self.linear = breaking.reference, {}
  for i, place in ipairs(places) do
    self.linear[i] = {used = math.log(place.used), slopes = matrix[i] or {}}
  end
  self.force = self:predict()
  local off = OFF * math.abs(math.log(self.force / breaking.force))
  self.low = self.force * breaking.low / breaking.force * math.exp(-off)
  self.high = self.force * breaking.high / breaking.force * math.exp(off)
  return self
end

--- The predicted force (N) if each place is thickened by its offset times its `fraction` (1 where none is given).
function advice:predict()
  local largest = -math.huge
  for _, row in ipairs(self.linear) do
    local sum = row.used
    for j, place in ipairs(self.places) do sum = sum + row.slopes[j] * place.offset * (place.fraction or 1) end
    largest = math.max(largest, sum)
  end
  return self.reference / math.exp(largest)
end

--- One line for each place, and what is predicted.
function advice:lines()
  if #self.places == 0 then
    return {(self.low >= self.required and "It carries %s: nothing to thicken."
      or "No thickening was found that helps against %s."):format(core.quantity(self.required, "N"))}
  end
  local list = {}
  for i, place in ipairs(self.places) do
    list[i] = ("Thicken by %s within %s of %s."):format(shown.estimate(place.offset, "m"),
      shown.estimate(place.radius, "m"), core.point(place.at))
  end
  local rest = self.force < self.required and (", still less than %s: repeat"):format(
    core.quantity(self.required, "N")) or ""
  local force = shown.interval(self.force, self.low, self.high, "N")
  list[#list + 1] = ("Predicted: breaks at %s%s."):format(force, rest)
  return list
end

function advice:__tostring()
  return table.concat(self:lines(), "\n")
end

return advice
