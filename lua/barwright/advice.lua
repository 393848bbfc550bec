-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Advice: which places of a body to thicken, and by how much, so that it bears a force. The judged stresses of
-- the weak places, under their worst loads, are linearised by shape gradients (one adjoint solution for each),
-- and a small quadratic programme finds the least offsets. docs/theory/strengthen.md has the mathematics.
local bumps = require "barwright.bumps"
local core = require "barwright.core"
local options = require "barwright.options"
local distance = require("barwright.points").distance

local advice = {}
advice.__index = advice
advice.__name = "barwright.advice"

local rules = {
  force = {type = "number", above = 0, needed = true},
  estimate = {type = "number", above = 0},
  keep = {type = "function"},
  most_offset = {type = "number", default = 0.25, above = 0, most = 1},
}

-- Places at most.
local MOST = 20
-- The radius of a bump: so many times the judged patch's radius, or the thickness there times the second; at most
-- this share of the diagonal.
local OF_PATCH, OF_THICKNESS, OF_DIAGONAL = 3, 1.25, 0.2
-- An offset is at most this share of the thickness: the linearised stresses do not reach further.
local MOST_OF_THICKNESS = 0.5
-- Places are this share of the radius apart at least.
local APART = 0.6
-- Rays by which thicknesses are measured.
local RAYS = 4000
-- The prediction is taken to be off by this share of the logarithm of what it promises.
local OFF = 0.5
-- The step of the central difference of the utilisation by the stress, over the stress's size.
local STEP = 1e-5
-- What is aimed at beyond the force, as the linearised stresses fall short of it.
local MARGIN = 1.02

local function diagonal(box)
  return distance(box.low, box.high)
end

-- The derivative of the utilisation by the six components of a stress, from central differences.
local function slope_of(breaking, judge, stress)
  local size, rows = 0, {}
  for k = 1, 6 do size = math.max(size, math.abs(stress[k])) end
  for k = 1, 6 do
    for _, sign in ipairs {1, -1} do
      local row = table.move(stress, 1, 6, 1, {})
      row[k] = row[k] + sign * STEP * size
      rows[#rows + 1] = row
    end
  end
  local used, slope = judge(breaking, core.array.new(rows)), {}
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
  return core.surface_mean(breaking.mesh, stress, breaking.length)
end

-- Over all judged loads, the largest utilisation at every node (a table), the load that causes it, and the mean
-- stresses under each load.
local function worst_map(breaking, judge)
  local used, by, means = {}, {}, {}
  for _, place in ipairs(breaking.history[#breaking.history].places) do
    if not means[place.region] then
      local mean, message, details = mean_stress(breaking, place.region)
      if not mean then return nil, message, details end
      means[place.region] = mean
      for i, value in ipairs(judge(breaking, mean):totable()) do
        value = type(value) == "table" and value[1] or value
        if value > (used[i] or -1) then used[i], by[i] = value, place.region end
      end
    end
  end
  return used, by, means
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

-- The nodes above a utilisation, no two within one bump, weakest first: {at, node, region, used, radius}.
local function choose(breaking, used, by, limit, keep)
  local thickness, message, details = thickness_meter(breaking.mesh)
  if not thickness then return nil, message, details end
  local nodes, list, chosen = breaking.mesh.nodes, {}, {}
  for node, value in pairs(used) do
    if value > limit then list[#list + 1] = node end
  end
  table.sort(list, function(a, b)
    if used[a] ~= used[b] then return used[a] > used[b] end
    return a < b
  end)
  local scale = diagonal(breaking.box)
  for _, node in ipairs(list) do
    local at = {nodes(node, 1), nodes(node, 2), nodes(node, 3)}
    local free = #chosen < MOST and not (keep and keep(at[1], at[2], at[3]))
    for _, other in ipairs(chosen) do free = free and distance(other.at, at) > APART * other.radius end
    if free then
      local wall = thickness(at)
      local radius = math.max(OF_PATCH * breaking.length, wall < math.huge and OF_THICKNESS * wall or 0)
      chosen[#chosen + 1] = {at = at, node = node, region = by[node], used = used[node], thickness = wall,
        radius = math.min(radius, OF_DIAGONAL * scale)}
    end
  end
  return chosen
end

-- The shape gradient of the judged utilisation at a place {node, region}, and its value, under the worst load of
-- the judged component: a row for every node, by its position, inner nodes following the boundary. `mean`: mean
-- stresses under the place's load. nil, message, details where it cannot be computed.
local function gradient_of(breaking, judge, place, mean)
  local worst, mesh, material = breaking.worst, breaking.mesh, breaking.material
  if (worst.limits.hands or 0) > 0 or worst.basis.directions > 1 then
    return nil, "the shape gradient is not implemented for loads with friction or of several hands",
      {status = "unsupported"}
  end
  local slope = core.array.new {slope_of(breaking, judge, mean:rows(place.node, place.node):totable()[1])}
  local force, by_force, details = core.patch_functional(mesh, material, breaking.length, place.node, slope)
  if not force then return nil, by_force, details end
  local adjoint, message
  adjoint, message, details = worst.system:solve(force)
  if not adjoint then return nil, message, details end
  local limits = worst.limits
  local pressure, value, motion, price = core.priced_load(worst.system, worst.basis,
    worst.basis:gradient(adjoint + by_force), {pressure = limits.pressure, force = limits.force,
    at_most = limits.at_most})
  if not pressure then return nil, value, motion end
  local u
  u, message, details = worst.system:solve(worst.basis:force(pressure))
  if not u then return nil, message, details end
  local gradient
  gradient, message, details = core.patch_gradient(worst.basis, material, {radius = breaking.length,
    node = place.node, slope = slope, displacement = u, adjoint = adjoint - motion, pressure = pressure,
    price = price})
  if not gradient then return nil, message, details end
  gradient, message, details = core.boundary_gather(mesh, gradient)
  if not gradient then return nil, message, details end
  return gradient, value
end

-- The change of every place's utilisation by every place's bump of 1 m, over the utilisation.
local function sensitivities(breaking, judge, places, means, keep)
  local shape, matrix = bumps.of_mesh(breaking.mesh), {}
  bumps.prepare(shape, places)
  for _, place in ipairs(places) do place.bump = bumps.unit(shape, place, keep) end
  for i, place in ipairs(places) do
    local gradient, value, details = gradient_of(breaking, judge, place, means[place.region])
    if not gradient then return nil, value, details end
    place.used = math.max(place.used, value)
    matrix[i] = {}
    for j, other in ipairs(places) do
      local sum = 0
      for k, d in pairs(other.bump) do
        local node = shape.nodes[k]
        sum = sum + gradient(node, 1) * d[1] + gradient(node, 2) * d[2] + gradient(node, 3) * d[3]
      end
      matrix[i][j] = sum / value
    end
  end
  for _, place in ipairs(places) do place.bump = nil end
  return matrix
end

-- The least offsets with which every place's logarithm falls to that of the limit, where that can be, each at most
-- a share of its radius and of the thickness. In radii, so that the numbers are of order one.
local function offsets(places, matrix, limit, most)
  local n, H, A, b, low, high, g = #places, {}, {}, {}, {}, {}, {}
  for i, place in ipairs(places) do
    H[i], A[i] = {}, {}
    for j, other in ipairs(places) do
      H[i][j] = i == j and 1 or 0
      A[i][j] = matrix[i][j] * other.radius
    end
    b[i], low[i], g[i] = math.log(limit / place.used), 0, 0
    high[i] = math.min(most, MOST_OF_THICKNESS * place.thickness / place.radius)
  end
  local x, violation, details = core.quadratic_programme {H = core.array.new(H), g = core.array.new(g),
    A = core.array.new(A), b = core.array.new(b), low = core.array.new(low), high = core.array.new(high)}
  if not x then return nil, violation, details end
  local largest = -math.huge
  for i, place in ipairs(places) do
    local sum = math.log(place.used)
    for j = 1, n do sum = sum + A[i][j] * x[j] end
    largest = math.max(largest, sum)
    place.offset = math.max(0, x[i]) * place.radius
  end
  return math.exp(largest)
end

--- Advice for a breaking force (see bw.breaking_force). `judge(breaking, stress)` is the utilisation of rows of
--- stresses.
function advice.of(breaking, judge, given)
  local wish = options.read("advice", given, rules)
  if not breaking.worst then core.raise "advice: this breaking force is closed" end
  local self = setmetatable({required = wish.force, places = {}, force = breaking.force, low = breaking.low,
    high = breaking.high}, advice)
  local goal = wish.estimate or wish.force * breaking.force / breaking.low
  if breaking.force >= goal then return self end
  local used, by, means = worst_map(breaking, judge)
  if not used then return nil, by, means end
  local limit = breaking.reference / (MARGIN * goal) -- utilisations are those of the reference force
  local places, message, details = choose(breaking, used, by, limit, wish.keep)
  if not places then return nil, message, details end
  if #places == 0 then
    return nil, "all weak places are on faces that must not move", {status = "infeasible"}
  end
  local matrix
  matrix, message, details = sensitivities(breaking, judge, places, means, wish.keep)
  if not matrix then return nil, message, details end
  local largest
  largest, message, details = offsets(places, matrix, limit, wish.most_offset)
  if not largest then return nil, message, details end
  for _, place in ipairs(places) do
    if place.offset > 1e-3 * place.radius then
      table.insert(self.places, {at = place.at, radius = place.radius, offset = place.offset})
    end
  end
  self.force = math.max(breaking.reference / largest, 0)
  local off = OFF * math.abs(math.log(self.force / breaking.force))
  self.low = self.force * breaking.low / breaking.force * math.exp(-off)
  self.high = self.force * breaking.high / breaking.force * math.exp(off)
  return self
end

--- One line for each place, and what is predicted.
function advice:lines()
  if #self.places == 0 then
    return {self.low >= self.required and ("It holds %.3g N: nothing to thicken."):format(self.required)
      or ("No thickening was found that helps against %.3g N."):format(self.required)}
  end
  local list = {}
  for i, place in ipairs(self.places) do
    list[i] = ("Thicken by %.2g mm within %.3g mm of (%.4g, %.4g, %.4g) mm."):format(place.offset * 1e3,
      place.radius * 1e3, place.at[1] * 1e3, place.at[2] * 1e3, place.at[3] * 1e3)
  end
  list[#list + 1] = ("Predicted: breaks at %.3g N (%.3g to %.3g N)%s."):format(self.force, self.low, self.high,
    self.force < self.required and (", still less than %.3g N: repeat"):format(self.required) or "")
  return list
end

function advice:__tostring()
  return table.concat(self:lines(), "\n")
end

return advice
