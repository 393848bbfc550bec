-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Goals of adaptive refinement: what is asked of a static solution, as a value with a place, and the dual
-- displacement that says which elements its error comes from. docs/theory/error_control.md.
local core = require "barwright.core"
local options = require "barwright.options"

local goal = {}

-- What the fields are called.
local names = {von_mises = "von Mises stress", max_principal = "principal stress"}

-- Columns of a stress (xx yy zz yz zx xy) and of a displacement.
local stress_columns = {xx = 1, yy = 2, zz = 3, yz = 4, zx = 5, xy = 6}
local displacement_columns = {ux = 1, uy = 2, uz = 3}
local axes = {x = 1, y = 2, z = 3}

local function raise(text)
  core.raise("solve: option 'of': " .. text)
end

local function is_point(value)
  if type(value) ~= "table" or #value ~= 3 then return false end
  for i = 1, 3 do
    local x = value[i]
    if type(x) ~= "number" or x ~= x or math.abs(x) == math.huge then return false end
  end
  return true
end

-- ---- stresses and displacements as values with slopes ----------------------------------------------

local function von_mises(s)
  local a, b, c = s[1] - s[2], s[2] - s[3], s[3] - s[1]
  return math.sqrt((a * a + b * b + c * c) / 2 + 3 * (s[4] * s[4] + s[5] * s[5] + s[6] * s[6]))
end

local function von_mises_slope(s)
  local value, mean, slope = von_mises(s), (s[1] + s[2] + s[3]) / 3, {0, 0, 0, 0, 0, 0}
  if value == 0 then return slope end
  for k = 1, 3 do slope[k] = 1.5 * (s[k] - mean) / value end
  for k = 4, 6 do slope[k] = 3 * s[k] / value end
  return slope
end

local function unit(size, column)
  local row = {}
  for k = 1, size do row[k] = k == column and 1 or 0 end
  return row
end

local function row_of(array, node, columns)
  local row = {}
  for k = 1, columns do row[k] = array(node, k) end
  return row
end

-- The stress at nodes by patch recovery, without thermal expansion where the stress is without it.
local function recovered(static)
  local stress, message, details = core.recovered_stress(static.mesh, static.material, static.displacement)
  if not stress then return nil, message, details end
  local raw
  raw, message, details = core.nodal_stress(static.mesh, static.material, static.displacement)
  if not raw then return nil, message, details end
  return stress + (static.stress - raw)
end

-- A dual problem's solution under forces at nodes, with the supports of the model at zero. Inertia balances
-- them on a free body, as it does in the solution by a factor.
local function under_forces(part, static, force)
  local report = static.report
  if static.reused or report.preconditioner ~= "two_level" then
    local system, message, details = part:system()
    if not system then return nil, message, details end
    return system:solve(force)
  end
  local dual = core.model {mesh = part.mesh, material = part.material}
  for _, support in ipairs(part.supports) do
    if support.slide then
      dual:slide(support.on, support.direction)
    else
      local zero = {}
      for k = 1, 3 do zero[k] = support.displacement[k] and 0 end
      dual:prescribe(support.on, zero)
    end
  end
  dual:load {nodal = force}
  local solution, message, details = dual:solve {solver = core.solver.pcg {}, inertia_relief = true}
  if not solution then return nil, message, details end
  return solution.displacement
end

local function dual_of_stress(part, static, nodes, weights)
  local force, message, details = core.stress_functional(part.mesh, part.material, core.array.new(nodes), weights)
  if not force then return nil, message, details end
  return under_forces(part, static, force)
end

local function dual_of_displacement(part, static, nodes, directions)
  local rows, none = {}, {0, 0, 0}
  for i = 1, part.mesh.node_count do rows[i] = none end
  for i, node in ipairs(nodes) do rows[node] = directions[i] end
  return under_forces(part, static, core.array.new(rows))
end

local function node_at(mesh, node)
  return {mesh.nodes(node, 1), mesh.nodes(node, 2), mesh.nodes(node, 3)}
end

-- ---- the largest of a field ------------------------------------------------------------------------

local largest = {}

function largest.von_mises(static)
  local field, node = static.von_mises, static.von_mises:argmax()
  local stress, message, details = recovered(static)
  if not stress then return nil, message, details end
  local better = core.von_mises(stress)
  return {value = field(node, 1), node = node, field = field, better = better,
    slope = von_mises_slope(row_of(static.stress, node, 6))}
end

function largest.max_principal(static)
  local size = static.max_principal:map "abs(a)"
  local node = size:argmax()
  local stress, message, details = recovered(static)
  if not stress then return nil, message, details end
  local values, which = row_of(static.principal, node, 3), 1
  for k = 2, 3 do
    if math.abs(values[k]) > math.abs(values[which]) then which = k end
  end
  local n = {}
  for k = 1, 3 do n[k] = static.principal_directions(node, 3 * (which - 1) + k) end
  local sign = values[which] < 0 and -1 or 1
  return {value = size(node, 1), node = node, field = size, better = core.max_principal(stress):map "abs(a)",
    slope = {sign * n[1] ^ 2, sign * n[2] ^ 2, sign * n[3] ^ 2, 2 * sign * n[2] * n[3], 2 * sign * n[3] * n[1],
      2 * sign * n[1] * n[2]}}
end

local function largest_stress(name)
  return function(part, static)
    local found, message, details = largest[name](static)
    if not found then return nil, message, details end
    found.at = node_at(part.mesh, found.node)
    found.recovery_error = math.abs(found.better(found.node, 1) - found.value)
    found.dual = function() return dual_of_stress(part, static, {found.node}, {found.slope}) end
    return found
  end
end

local function largest_displacement(part, static)
  local size = static.displacement:map "norm(a)"
  local node = size:argmax()
  local value, u = size(node, 1), row_of(static.displacement, node, 3)
  for k = 1, 3 do u[k] = value > 0 and u[k] / value or 0 end
  return {value = value, at = node_at(part.mesh, node), recovery_error = 0,
    dual = function() return dual_of_displacement(part, static, {node}, {u}) end}
end

-- ---- at a point ------------------------------------------------------------------------------------

local ends = {{1, 2}, {2, 3}, {3, 1}, {1, 4}, {2, 4}, {3, 4}}

-- Nodes and weights that interpolate at a point: the node itself where there is one.
local function at_point(mesh, point)
  local node = mesh.boundary:nearest(point, 1).nodes[1]
  local min, max, apart, size = mesh.box.min, mesh.box.max, 0, 0
  for k = 1, 3 do
    apart = apart + (mesh.nodes(node, k) - point[k]) ^ 2
    size = size + (max[k] - min[k]) ^ 2
  end
  if apart <= 1e-12 * size then return {node}, {1} end
  local element, l, inside = mesh:locate(point)
  if not inside and apart > 1e-4 * size then
    core.raise(("solve: the point (%g, %g, %g) of option 'of' does not lie in the body"):format(point[1], point[2],
      point[3]))
  end
  local nodes, weights = {}, {}
  for a = 1, mesh.elements.column_count do
    local edge = ends[a - 4]
    nodes[a] = mesh.elements(element, a)
    weights[a] = edge and 4 * l[edge[1]] * l[edge[2]] or mesh.order == 1 and l[a] or l[a] * (2 * l[a] - 1)
  end
  return nodes, weights
end

local function interpolated(array, nodes, weights, columns)
  local row = {}
  for k = 1, columns do
    row[k] = 0
    for i, node in ipairs(nodes) do row[k] = row[k] + weights[i] * array(node, k) end
  end
  return row
end

local function scaled(weights, row)
  local rows = {}
  for i, weight in ipairs(weights) do
    rows[i] = {}
    for k, x in ipairs(row) do rows[i][k] = weight * x end
  end
  return rows
end

local function at_place(point, field)
  local column, direction = stress_columns[field], displacement_columns[field]
  return function(part, static)
    local nodes, weights = at_point(part.mesh, point)
    local found = {at = point, recovery_error = 0}
    if field == "displacement" or direction then
      local u = interpolated(static.displacement, nodes, weights, 3)
      local size = math.sqrt(u[1] ^ 2 + u[2] ^ 2 + u[3] ^ 2)
      found.value = direction and u[direction] or size
      local along = direction and unit(3, direction) or size > 0 and {u[1] / size, u[2] / size, u[3] / size}
        or {0, 0, 0}
      found.dual = function() return dual_of_displacement(part, static, nodes, scaled(weights, along)) end
      return found
    end
    local better, message, details = recovered(static)
    if not better then return nil, message, details end
    local s, t = interpolated(static.stress, nodes, weights, 6), interpolated(better, nodes, weights, 6)
    found.value = column and s[column] or von_mises(s)
    found.recovery_error = math.abs((column and t[column] or von_mises(t)) - found.value)
    local slope = column and unit(6, column) or von_mises_slope(s)
    found.dual = function() return dual_of_stress(part, static, nodes, scaled(weights, slope)) end
    return found
  end
end

-- ---- reactions -------------------------------------------------------------------------------------

-- w is 1 along the direction at the nodes of the face and 0 elsewhere. The reaction is a(u, w) - F(w), and its
-- dual w plus what takes the forces of w off the free nodes.
local function dual_of_reaction(part, static, selection, direction)
  local rows, none = {}, {0, 0, 0}
  for i = 1, part.mesh.node_count do rows[i] = none end
  for _, node in ipairs(selection.nodes:totable()) do rows[node] = direction end
  local w = core.array.new(rows)
  local force, message, details = core.internal_force(part.mesh, part.material, w)
  if not force then return nil, message, details end
  local rest
  rest, message, details = under_forces(part, static, force * -1)
  if not rest then return nil, message, details end
  return w + rest
end

local function reaction(axis)
  return function(part, static, selections)
    local selection = selections[1]
    local r = static:reaction_on(selection)
    local size = math.sqrt(r[1] ^ 2 + r[2] ^ 2 + r[3] ^ 2)
    local direction = axis and unit(3, axis) or size > 0 and {r[1] / size, r[2] / size, r[3] / size} or {0, 0, 0}
    return {value = axis and r[axis] or size, at = selection.centre, recovery_error = 0,
      dual = function() return dual_of_reaction(part, static, selection, direction) end}
  end
end

-- ---- any function of the solution ------------------------------------------------------------------

local function by_function(f)
  return function(_, static)
    local value = f(static)
    if type(value) ~= "number" or value ~= value or math.abs(value) == math.huge then
      raise(("the function must return a finite number, got %s"):format(core.got(value)))
    end
    return {value = value, recovery_error = 0}
  end
end

-- ---- reading ---------------------------------------------------------------------------------------

local fields = {"von_mises", "displacement", "xx", "yy", "zz", "yz", "zx", "xy", "ux", "uy", "uz"}

-- The unit of a quantity or field.
local function unit_of(field)
  return (field == "displacement" or displacement_columns[field]) and "m" or "Pa"
end

local function known(name, list, what)
  for _, word in ipairs(list) do
    if word == name then return end
  end
  raise(("%s '%s' is not known: %s"):format(what, tostring(name), core.suggestion(tostring(name), list)))
end

local function of_selection(selection, axis, mesh)
  if selection.mesh ~= mesh then raise "a selection on the model's mesh expected, got one on another mesh" end
  if axis ~= nil then known(axis, {"x", "y", "z"}, "axis") end
  return {measure = reaction(axes[axis]), selections = {selection}, unit = "N",
    name = axis and "reaction along " .. axis or "reaction"}
end

local function of_table(of, mesh)
  local opts = options.read("solve: of", of, {at = {type = "table"}, field = {type = "string"},
    reaction = {type = "selection"}, axis = {type = "string"}})
  if opts.reaction and not opts.at and not opts.field then
    return of_selection(opts.reaction, opts.axis, mesh)
  end
  if not is_point(opts.at) or opts.reaction or opts.axis then
    local found = {}
    for _, key in ipairs {"at", "field", "reaction", "axis"} do
      if opts[key] ~= nil then found[#found + 1] = key end
    end
    raise(("{at = {x, y, z}, field = ...} or {reaction = selection, axis = ...} expected, got %s"):format(
      #found > 0 and table.concat(found, " and ") or "neither"))
  end
  local field = opts.field or "von_mises"
  known(field, fields, "field")
  return {measure = at_place(opts.at, field), selections = {}, unit = unit_of(field),
    name = (names[field] or field) .. " at a point"}
end

--- What is asked: {measure = function(part, static, selections), selections, name, unit}. measure gives {value,
--- at, recovery_error, dual = function or nil, field, better}.
function goal.read(of, mesh)
  if of == nil then of = "von_mises" end
  if type(of) == "string" then
    known(of, {"von_mises", "max_principal", "displacement"}, "quantity")
    return {measure = of == "displacement" and largest_displacement or largest_stress(of), selections = {},
      unit = unit_of(of), name = "largest " .. (names[of] or of)}
  end
  if type(of) == "function" then
    return {measure = by_function(of), selections = {}, unit = "", name = "function"}
  end
  if core.class_name(of) == "selection" then return of_selection(of, nil, mesh) end
  if is_point(of) then of = {at = of} end
  if type(of) == "table" then return of_table(of, mesh) end
  raise(("a quantity, a point, a face or a function expected, got %s"):format(core.got(of)))
end

return goal
