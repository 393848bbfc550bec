-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Checks a certificate of the worst case's upper bound: docs/theory/worst_case.md, "The certificate". Nothing of
-- the branch and bound is used. The engine evaluates the dual function from its definition and bounds the error of
-- the linear solves (dual_bounds.c, solve_error.c). Cover, leaves and load are checked here.
local arguments = require "barwright.arguments"
local certificate = require "barwright.certificate"
local core = require "barwright.core"

-- What two computations of the same stress may differ by, as a fraction of the upper bound.
local AGREE = 1e-6
-- Loads keep their limits to this fraction of the force.
local ADMISSIBLE = 1e-8
-- Of the cosine of a triangle's angle.
local ROUNDING = 2.0 ^ -46

-- What is wrong with the certificate.
local function reject(what, ...)
  error({message = what:format(...)}, 0)
end

-- Failures of the check itself, which are no verdict on the file.
local no_verdict = {memory = true, cancelled = true, limit = true, convergence = true, internal = true}

-- A value of the engine, or why it has none: what the certificate states, or a failure of the check.
local function needed(about, value, message, details)
  if value then return value end
  if no_verdict[details and details.status] then error({message = message, details = details}, 0) end
  reject("%s%s", about, message)
end

-- ---- directions --------------------------------------------------------------------------------------

local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end

local function cross(a, b)
  return {a[2] * b[3] - a[3] * b[2], a[3] * b[1] - a[1] * b[3], a[1] * b[2] - a[2] * b[1]}
end

local function unit(v)
  local length = math.sqrt(dot(v, v))
  return {v[1] / length, v[2] / length, v[3] / length}
end

local function sum(...)
  local s = {0, 0, 0}
  for _, v in ipairs {...} do
    for k = 1, 3 do s[k] = s[k] + v[k] end
  end
  return s
end

local GOLDEN = (1 + math.sqrt(5)) / 2
local vertices = {{-1, GOLDEN, 0}, {1, GOLDEN, 0}, {-1, -GOLDEN, 0}, {1, -GOLDEN, 0}, {0, -1, GOLDEN},
  {0, 1, GOLDEN}, {0, -1, -GOLDEN}, {0, 1, -GOLDEN}, {GOLDEN, 0, -1}, {GOLDEN, 0, 1}, {-GOLDEN, 0, -1},
  {-GOLDEN, 0, 1}}
-- One of each pair of opposite faces.
local faces = {{0, 11, 5}, {0, 5, 1}, {0, 1, 7}, {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4}, {11, 10, 2},
  {10, 7, 6}, {7, 1, 8}}

-- The solid angle of a triangle of unit vectors.
local function solid_angle(t)
  return 2 * math.atan(math.abs(dot(t[1], cross(t[2], t[3]))),
    1 + dot(t[1], t[2]) + dot(t[2], t[3]) + dot(t[3], t[1]))
end

local function face(number)
  local t = {}
  for k, v in ipairs(faces[number + 1]) do t[k] = unit(vertices[v + 1]) end
  return t
end

local function parts_of(t)
  local m = {unit(sum(t[1], t[2])), unit(sum(t[2], t[3])), unit(sum(t[3], t[1]))}
  return {{t[1], m[1], m[3]}, {t[2], m[2], m[1]}, {t[3], m[3], m[2]}, m}
end

local triangles = {}

-- The triangle of a cell: corners, centre, cosine of twice the largest angle from it to a corner.
local function triangle(cell)
  local t = triangles[cell]
  if t then return t end
  if #cell == 2 then
    t = face(tonumber(cell:sub(1, 1)))
  else
    t = parts_of(triangle(cell:sub(1, -2)))[tonumber(cell:sub(-1)) + 1]
  end
  t.centre = unit(sum(t[1], t[2], t[3]))
  local min = math.min(dot(t.centre, t[1]), dot(t.centre, t[2]), dot(t.centre, t[3]))
  t.cosine = (2 * min * min - 1) * (1 - ROUNDING)
  triangles[cell] = t
  return t
end

-- Whether the leaves of an element cover all directions: no one lies in another, and together they have the size
-- of ten faces, each part counting a quarter of the triangle that it is a part of.
local function check_cover(element, leaves)
  if #leaves == 1 and leaves[1].cell == "all" then return end
  local seen, size = {}, 0
  for _, leaf in ipairs(leaves) do
    if leaf.cell == "all" or seen[leaf.cell] then
      reject("element %d: cell %s twice, or beside others", element, leaf.cell)
    end
    seen[leaf.cell] = true
    size = size + 0.25 ^ (#leaf.cell - 2)
  end
  for _, leaf in ipairs(leaves) do
    for length = 2, #leaf.cell - 1 do
      if seen[leaf.cell:sub(1, length)] then
        reject("element %d: cell %s lies in cell %s", element, leaf.cell, leaf.cell:sub(1, length))
      end
    end
  end
  if size ~= #faces then
    reject("element %d: its leaves cover %.6g of %d faces of the half sphere", element, size, #faces)
  end
end

-- The ten faces and their opposites are those of the icosahedron: together the whole sphere, once.
local function check_faces()
  local whole = 0
  for k = 0, #faces - 1 do whole = whole + solid_angle(face(k)) end
  assert(math.abs(whole - 2 * math.pi) < 1e-9)
end

-- ---- the model ---------------------------------------------------------------------------------------

local function mask(count, list)
  local chosen = {}
  for i = 1, count do chosen[i] = 0 end
  for _, i in ipairs(list) do
    if i > count then reject("facet or node %d of %d", i, count) end
    chosen[i] = 1
  end
  return core.array.new(chosen, "u8")
end

local function selection(mesh, facets, nodes)
  local chosen = #facets > 0 and mesh.boundary:where(mask(mesh.facet_count, facets))
  local points = #nodes > 0 and mesh.boundary:where(mask(mesh.node_count, nodes))
  return chosen and points and chosen:union(points) or chosen or points
end

local function build(stated)
  local mesh = needed("the mesh: ", core.mesh.new {nodes = stated.nodes, elements = stated.elements,
    order = stated.order})
  if mesh.node_count ~= #stated.nodes or mesh.element_count ~= #stated.elements then
    reject("the mesh has nodes without elements")
  end
  local opts = stated.material
  local material = core.material[opts.kind](opts.constants)
  local part = core.model {mesh = mesh, material = material, formulation = stated.formulation}
  for _, support in ipairs(stated.supports) do
    local on = selection(mesh, support.facets, support.nodes)
    if not on then reject "a support on nothing" end
    if support.kind == "fixed" then
      local fixed = {}
      for k = 1, 3 do fixed[k] = support.vector[k] ~= 0 and 0 end
      part:prescribe(#support.facets > 0 and on or on:node_set(), fixed)
    else
      part:slide(on, support.kind == "along" and support.vector or nil)
    end
  end
  return part
end

-- Work of a unit of each pressure on each rigid-body mode, as columns, and the largest displacement of each.
local function works(stated, part, basis)
  local motions, list, reaches = needed("", part:rigid_modes()), {}, {}
  if #motions ~= #stated.motions then
    reject("%d rigid-body modes stated, the supports leave %d", #stated.motions, #motions)
  end
  local points, components = part.mesh.nodes:totable(), part.mesh.components:totable()
  for i, motion in ipairs(motions) do
    local c, t, r, given = motion.centre, motion.translation, motion.rotation, stated.motions[i]
    local found = {motion.component, c[1], c[2], c[3], t[1], t[2], t[3], r[1], r[2], r[3]}
    for k, value in ipairs(found) do
      if math.abs(value - given[k]) > 1e-9 * (1 + math.abs(value)) then reject("motion %d is no free one", i) end
    end
    local field, reach = {}, 0
    for n, x in ipairs(points) do
      local turn = cross(r, {x[1] - c[1], x[2] - c[2], x[3] - c[3]})
      field[n] = components[n] == motion.component and sum(t, turn) or {0, 0, 0}
      reach = math.max(reach, math.sqrt(dot(field[n], field[n])))
    end
    list[i], reaches[i] = basis:gradient(core.array.new(field)), reach
  end
  return list, reaches
end

-- ---- the load that reaches a stress --------------------------------------------------------------------

-- The largest sum over the pressures of a node's columns.
local function largest_pressure(basis, p)
  if basis.directions == 1 then return p:max() end
  local terms = {}
  for k = 1, basis.directions do terms[k] = ("p[%d]"):format(k) end
  local by_node = core.array.from_string("<f8", p:tostring "<f8", basis.directions)
  return core.array.map(table.concat(terms, " + "), {p = by_node}):max()
end

local function check_load(stated, state)
  local basis, list = state.basis, {}
  for j = 1, basis.count do list[j] = stated.load[j] or 0.0 end
  local p = core.array.new(list)
  if p:min() < 0 then reject("the load pulls: a pressure of %g Pa", p:min()) end
  local max = largest_pressure(basis, p)
  if max > stated.pressure * (1 + ADMISSIBLE) then
    reject("the load has a pressure of %.9g Pa, more than %.9g", max, stated.pressure)
  end
  local total = p:dot(basis.areas)
  local missed = stated.force_is_max and math.max(0, total - stated.force) or math.abs(total - stated.force)
  if missed > ADMISSIBLE * stated.force then
    reject("the load amounts to %.9g N instead of %.9g", total, stated.force)
  end
  for i, work in ipairs(state.works) do
    if math.abs(work:dot(p)) > ADMISSIBLE * total * state.reaches[i] then
      reject("the load is not in balance with motion %d", i)
    end
  end
  local u = needed("", state.system:solve(basis:force(p)))
  local found = core.max_principal(needed("", core.element_stress(state.mesh, state.material, u)))[stated.element]
  if found < stated.reached * (1 - AGREE) then
    reject("the load stresses element %d by %.9g Pa, less than %.9g", stated.element, found, stated.reached)
  end
end

-- ---- leaves ----------------------------------------------------------------------------------------------

local function bytes_of(numbers) return string.pack("<" .. ("d"):rep(#numbers), table.unpack(numbers)) end

-- Elements, directions (0: all of them) and multipliers of the leaves, as core.dual_bounds takes them.
local function claims_of(leaves, motions)
  local elements, directions, multipliers = {}, {}, {}
  for i, leaf in ipairs(leaves) do
    local list = {}
    for _, vector in ipairs(leaf.multipliers) do
      table.move(vector, 1, motions, #list + 1, list)
      list[#list + 1] = vector.total
    end
    list[#list + 1] = leaf.multipliers.total
    for k = #list + 1, 6 * motions + 2 do list[k] = 0.0 end
    elements[i] = leaf.element
    directions[i] = bytes_of(leaf.cell == "all" and {0, 0, 0} or triangle(leaf.cell).centre)
    multipliers[i] = bytes_of(list)
  end
  return core.array.new(elements, "i32"), core.array.from_string("<f8", table.concat(directions), 3),
    core.array.from_string("<f8", table.concat(multipliers), 6 * motions + 2)
end

-- The largest bound of all leaves, each of which must be as stated, and how much of it stands for the residuals of
-- the linear solves.
local function check_leaves(stated, state)
  local leaves, rows = stated.leaves, {}
  for i, work in ipairs(state.works) do rows[i] = work:tostring "<f8" end
  local bounds, errors, details = core.dual_bounds(state.system, state.basis,
    {force = stated.force, pressure = stated.pressure, force_is_max = stated.force_is_max},
    core.array.from_string("<f8", table.concat(rows), state.basis.count), claims_of(leaves, #rows))
  needed("", bounds, errors, details)
  local max, with_errors = 0, 0
  for i, leaf in ipairs(leaves) do
    local cosine = leaf.cell == "all" and 1 or triangle(leaf.cell).cosine
    local bound = bounds[i] / cosine
    if math.abs(bound - leaf.bound) > AGREE * stated.upper_bound or bound ~= bound then
      reject("element %d, cell %s: its multipliers prove %.9g Pa, not %.9g", leaf.element, leaf.cell, bound,
        leaf.bound)
    end
    max, with_errors = math.max(max, bound), math.max(with_errors, (bounds[i] + errors[i]) / cosine)
  end
  return max, with_errors
end

local function prepare(stated)
  local ok, part = pcall(build, stated) -- raises where what is stated is misuse
  if not ok then
    if type(part) ~= "string" or part:find "out of memory" or core.interrupted() then error(part, 0) end
    reject("%s", part)
  end
  local mesh = part.mesh
  local basis = needed("the pressures: ", core.pressure_basis(mesh, {friction = stated.friction,
    friction_facets = stated.friction_facets,
    forbidden = #stated.forbidden > 0 and selection(mesh, stated.forbidden, {}) or nil}))
  if basis.count ~= stated.columns then
    reject("%d pressures stated, the surface has %d", stated.columns, basis.count)
  end
  if not (stated.force > 0 and stated.pressure > 0) then reject "force and pressure must be positive" end
  local system = needed("", part:system())
  local list, reaches = works(stated, part, basis)
  return {mesh = mesh, material = part.material, basis = basis, system = system, works = list, reaches = reaches}
end

local function check(stated)
  check_faces()
  local by_element = {}
  for e = 1, #stated.elements do by_element[e] = {} end
  for _, leaf in ipairs(stated.leaves) do table.insert(by_element[leaf.element], leaf) end
  for element, leaves in ipairs(by_element) do check_cover(element, leaves) end
  local state = prepare(stated)
  check_load(stated, state)
  local proved, with_errors = check_leaves(stated, state)
  if proved > stated.upper_bound * (1 + AGREE) then
    reject("its leaves prove %.9g Pa, the bound stated is %.9g", proved, stated.upper_bound)
  end
  local upper = math.max(with_errors, stated.reached)
  return {upper_bound = upper, reached = stated.reached, gap = upper / stated.reached - 1,
    element = stated.element, elements = #stated.elements, leaves = #stated.leaves,
    solve_error = with_errors - proved, force = stated.force,
    pressure = stated.pressure, force_is_max = stated.force_is_max, friction = stated.friction,
    supports = #stated.supports, forbidden_facets = #stated.forbidden}
end

local module = {}

--- Checks a file: what it proves, or nil, message, details (status "rejected" where the proof fails).
function module.check_certificate(path)
  local stated, message, details = certificate.read(path)
  if not stated then return nil, message, details end
  local ok, result = pcall(check, stated)
  if ok then return result end
  if type(result) ~= "table" or not result.message then error(result, 0) end
  if result.details then return nil, ("%s: %s"):format(path, result.message), result.details end
  return nil, ("%s: rejected: %s"):format(path, result.message), {status = "rejected", file = path}
end

arguments.functions("", module, {check_certificate = "path: string"})

return module
