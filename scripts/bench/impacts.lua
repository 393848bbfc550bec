-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The impacts of random drops beside a breaking force: each is pressed over the contact that the breaking force
-- admits, balanced by inertia and judged alike (docs/theory/worst_case.md, section 12).
local bw = require "barwright"
local distance = require "barwright.points".distance

-- A peg presses on surface that faces its push within 60 degrees.
local FACING = 0.5
-- Impacts that are solved at once.
local BATCH = 20

local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end

local function cross(a, b)
  return {a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1]}
end

-- Of every cell of a basis, by axis: the integral of its push (the force of a unit pressure) times a weight, a
-- function of the point.
local function integrals(basis, points, weight)
  local list = {}
  for axis = 1, 3 do
    local rows = {}
    for j, x in ipairs(points) do
      rows[j] = {0, 0, 0}
      rows[j][axis] = weight(x)
    end
    list[axis] = basis:gradient(bw.array.new(rows))
  end
  return list
end

-- Area, force direction and centroid of every cell.
local function cells_of(basis, mesh)
  local points, areas, cells, moments = mesh.nodes:totable(), basis.areas, {}, {}
  local push = integrals(basis, points, function() return 1 end)
  for k = 1, 3 do moments[k] = integrals(basis, points, function(x) return x[k] end) end
  for i = 1, basis.count do
    local own, at = {push[1][i], push[2][i], push[3][i]}, {}
    for k, moment in ipairs(moments) do
      at[k] = dot({moment[1][i], moment[2][i], moment[3][i]}, own) / dot(own, own)
    end
    cells[i] = {number = i, area = areas[i], push = own, at = at}
  end
  return cells
end

-- The cells that are nearest to a place and face a push, over this area: numbers and shares of them. Nil where
-- fewer face it.
local function contact_at(cells, place, push, area)
  local facing, contact, left = {}, {}, area
  for i, cell in ipairs(cells) do
    if dot(cell.push, push) >= FACING * cell.area then
      facing[#facing + 1] = {number = i, apart = distance(cell.at, place)}
    end
  end
  table.sort(facing, function(a, b)
    if a.apart ~= b.apart then return a.apart < b.apart end
    return a.number < b.number
  end)
  for k, near in ipairs(facing) do
    near.fraction = math.min(1, left / cells[near.number].area)
    left = left - near.fraction * cells[near.number].area
    contact[k] = near
    if left <= 0 then return contact end
  end
end

-- The nodal forces of a unit pressure over a contact.
local function load_of(basis, contact)
  local pressure = {}
  for i = 1, basis.count do pressure[i] = 0 end
  for _, cell in ipairs(contact) do pressure[cell.number] = cell.fraction end
  return basis:force(bw.array.new(pressure))
end

-- The body as points at its nodes: shares of the volume, coordinates about the centre of mass, the centre, and the
-- rows of the inertia tensor over the density.
local function points_of(mesh)
  local body, rows = {volume = mesh.node_volumes, centre = {}}, {}
  for k, name in ipairs {"x", "y", "z"} do
    body.centre[k] = mesh.nodes:column(k):mean(body.volume)
    body[name] = mesh.nodes:column(k) - body.centre[k]
  end
  for i, a in ipairs {"x", "y", "z"} do
    rows[i] = {}
    for k, b in ipairs {"x", "y", "z"} do
      local product = ("v * (%s - %s * %s)"):format(i == k and "x^2 + y^2 + z^2" or "0", a, b)
      rows[i][k] = bw.array.map(product, {v = body.volume, x = body.x, y = body.y, z = body.z}):sum()
    end
  end
  body.inertia = rows
  return body
end

-- The sum of the sizes of the inertia forces that balance a unit pressure over a contact.
local function inertia_of(body, cells, contact)
  local force, moment = {0, 0, 0}, {0, 0, 0}
  for _, cell in ipairs(contact) do
    local push, at, arm = cells[cell.number].push, cells[cell.number].at, {}
    for k = 1, 3 do arm[k] = at[k] - body.centre[k] end
    local torque = cross(arm, push)
    for k = 1, 3 do
      force[k] = force[k] + cell.fraction * push[k]
      moment[k] = moment[k] + cell.fraction * torque[k]
    end
  end
  local i, volume, spin = body.inertia, body.volume:sum(), {}
  local by = {cross(i[2], i[3]), cross(i[3], i[1]), cross(i[1], i[2])} -- Cramer's rule
  for k = 1, 3 do
    spin[k] = (by[1][k] * moment[1] + by[2][k] * moment[2] + by[3][k] * moment[3]) / dot(i[1], by[1])
  end
  return bw.array.map("v * sqrt((a + q * z - r * y)^2 + (b + r * x - p * z)^2 + (c + p * y - q * x)^2)", {
    v = body.volume, x = body.x, y = body.y, z = body.z, p = spin[1], q = spin[2], r = spin[3],
    a = force[1] / volume, b = force[2] / volume, c = force[3] / volume}):sum()
end

-- Completes a list of impacts with loads: the contact force that breaks the body, the place where it does, by
-- the criterion of `found`, and the mean of the contact force and the sum of the inertia forces.
local function complete(found, impacts)
  local system, loads = found.worst.system, {}
  for k, impact in ipairs(impacts) do loads[k] = impact.load end
  for k, u in ipairs(assert(system:solve(loads))) do
    local stress = assert(bw.surface_stress(found.mesh, found.material, u, loads[k]))
    local used = found.material:utilisation(assert(bw.surface_mean(found.mesh, stress, found.length, system)))
    local node, impact = used:argmax(), impacts[k]
    impact.load, impact.force = nil, found.contact / used[node]
    impact.with_inertia = impact.force * (1 + impact.inertia / found.contact) / 2
    impact.at = {found.mesh.nodes(node, 1), found.mesh.nodes(node, 2), found.mesh.nodes(node, 3)}
  end
end

-- The drops whose contact fits on the body, and the median area of the peg's contact.
local function impacts_on(found, options)
  local drops = assert(bw.drop_test(bw.model {mesh = found.mesh, material = found.material}, options))
  local basis, body = found.worst.basis, points_of(found.mesh)
  local cells = cells_of(basis, found.mesh)
  local places, directions = drops.contacts:totable(), drops.directions:totable()
  local list, batch = {}, {}
  for k, place in ipairs(places) do
    local contact = contact_at(cells, place, directions[k], found.contact)
    if contact then
      batch[#batch + 1] = {load = load_of(basis, contact), inertia = inertia_of(body, cells, contact)}
    end
    if #batch == BATCH or k == #places and #batch > 0 then
      complete(found, batch)
      table.move(batch, 1, #batch, #list + 1, list)
      batch = {}
    end
  end
  return list, drops.areas:quantile(0.5)
end

-- Whether a place lies within a radius of the weakest one or of a tie.
local function is_predicted(found, at)
  local min = distance(found.at, at)
  for _, tie in ipairs(found.ties) do min = math.min(min, distance(tie.at, at)) end
  return min <= found.length
end

local function column(impacts, name)
  local values = {}
  for k, impact in ipairs(impacts) do values[k] = impact[name] end
  return bw.array.new(values)
end

-- How many of the first impacts break the body where `found` predicts it, as a fraction.
local function fraction_predicted(found, impacts, count)
  local sum = 0
  for k = 1, count do sum = sum + (is_predicted(found, impacts[k].at) and 1 or 0) end
  return sum / count
end

--- `found`: a breaking force that is not closed; options: those of bw.drop_test. Returns a list of impacts, those
--- of the least contact forces first ({force, with_inertia, at}), with statistics of them: least, median and
--- below (the fraction below the interval) of both forces, predicted (the fraction that breaks within a radius of
--- the weakest place or of a tie; of the first tenth as well), and the median area of the pegs' own contacts.
return function(found, options)
  local impacts, area = impacts_on(found, options)
  table.sort(impacts, function(a, b) return a.force < b.force end)
  impacts.peg_area = area
  for _, name in ipairs {"force", "with_inertia"} do
    local values = column(impacts, name)
    impacts[name] = {min = values:min(), median = values:quantile(0.5),
      below = values:below(found.low):sum() / #impacts}
  end
  impacts.predicted = fraction_predicted(found, impacts, #impacts)
  impacts.predicted_of_tenth = fraction_predicted(found, impacts, math.ceil(#impacts / 10))
  return impacts
end
