-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Hyperelastic solids on grids. A solid is a grid, a material table, and what acts on it; supports and loads
-- are kept as they were given, by place, so that they are found again on an edited grid and on coarse
-- ones.
local core = require "barwright.core"
local estimate = require "barwright.solid_estimate"
local members = require "barwright.members"
local options = require "barwright.options"
local solid_results = require "barwright.solid_results"

local raise = core.raise

local solids = {}

local solid = {}
local properties = {
  element_count = function(self) return rawget(self, "grid").element_count end,
  node_count = function(self) return rawget(self, "grid").node_count end,
  mass = function(self) return rawget(self, "body").mass end,
  locking = function(self) return rawget(self, "body").locking end,
  levels = function(self) return rawget(self, "coarse") and rawget(self, "coarse").levels or 0 end,
}
solid.__index = members("solid", solid, properties)
solid.__name = "barwright.solid"

local function check_self(where, self)
  if getmetatable(self) ~= solid then
    raise(("%s: a solid expected, got %s: call it as solid:%s(...)"):format(where, core.got(self), where))
  end
end

local function make(grid, materials, acts, previous, coarse, fine_materials, by_library)
  local body, message, details = core.solid.create(grid, materials, previous)
  if not body then return nil, message, details end
  local newton
  newton, message, details = core.solid.newton()
  if not newton then return nil, message, details end
  return setmetatable({grid = grid, materials = body.materials, body = body, acts = acts, coarse = coarse or false,
    fine_materials = fine_materials or false, by_library = by_library or false, newton = newton}, solid)
end

--- A solid: {grid =, material table = {material 1, material 2, ...}}.
function solids.create(given)
  local opts = options.read("solid", given, {
    grid = {type = "grid", needed = true},
    materials = {type = "any", needed = true},
  })
  return make(opts.grid, opts.materials, {})
end

-- ---- what acts -----------------------------------------------------------------------------------

local function is_array(value)
  return core.class_name(value) == "array"
end

-- Numbers of nodes from 1 to `count`.
local function check_numbers(function_name, list, count)
  for i, number in ipairs(is_array(list) and list:totable() or list) do
    local whole = math.tointeger(number)
    if type(number) ~= "number" or not whole or whole < 1 or whole > count then
      raise(("%s: entry %d of the list: a node from 1 to %d expected, got %s"):format(function_name, i, count,
        core.got(number)))
    end
  end
end

-- Nodes of a grid by place; numbers belong to the grid that they were given for.
local function nodes_of(grid, act)
  local where = act.where
  if is_array(where) or type(where) == "table" and #where > 0 then
    if grid ~= act.grid then
      raise("nodes given by their numbers belong to one grid: give them by place, {side = \"min z\"} "
        .. "or a function of x, y, z, where the solid is coarsened or its grid edited")
    end
    return where
  end
  return grid:nodes(where)
end

-- Errors are reported where they are made: `where` is tried at once.
local function add(self, act, where)
  act.grid, act.where = self.grid, where
  if where ~= nil then
    local name = ({move = "fix", surface_pressure = "pressure"})[act.kind] or act.kind
    local numbers = is_array(where) or type(where) == "table" and #where > 0
    if numbers then
      check_numbers(name, where, self.node_count)
    elseif type(where) == "table" and next(where) == nil then
      raise(("%s: a place, {side = \"min z\"}, or a list of nodes expected, got an empty table"):format(name))
    end
    local nodes, message, details = nodes_of(self.grid, act)
    if not nodes then return nil, message, details end
  end
  self.acts[#self.acts + 1] = act
  rawset(self, "ready", nil)
  return self
end

local function finite(value)
  return type(value) == "number" and value == value and math.abs(value) ~= math.huge
end

local function vector(where, key, value)
  local list = is_array(value) and value:totable() or value
  if type(list) ~= "table" or #list ~= 3 then
    raise(("%s: %s: three numbers {x, y, z} expected, got %s"):format(where, key, core.got(value)))
  end
  for i = 1, 3 do
    if not finite(list[i]) then
      raise(("%s: %s: three finite numbers {x, y, z} expected, got %s at %d"):format(where, key,
        core.got(list[i]), i))
    end
  end
  return list
end

local function check_where(function_name, where)
  if type(where) == "table" and not options.countable(where) then
    raise(("%s: a place expected first, got a table without a length"):format(function_name))
  end
  if where == nil then
    raise(("%s: a place expected first, got nil: {side = \"min z\"}, a function of x, y, z, or numbers of "
      .. "nodes"):format(function_name))
  end
end

--- Nodes are fixed: all components, or moved by {x, y, z} (m at full load), where false leaves a
--- component free; or by a function of x, y, z that returns three numbers.
function solid:fix(where, by)
  check_self("fix", self)
  check_where("fix", where)
  if by == nil then by = {0, 0, 0} end
  if type(by) == "table" then
    for i = 1, 3 do
      if not finite(by[i]) and by[i] ~= false then
        raise(("fix: {x, y, z} expected, each a number in m or false, got %s at %d"):format(core.got(by[i]), i))
      end
    end
    if not (by[1] or by[2] or by[3]) then
      raise "fix: a displacement of one component or more expected, got {false, false, false}"
    end
  elseif type(by) ~= "function" then
    raise(("fix: {x, y, z} or a function of x, y, z expected, got %s"):format(core.got(by)))
  end
  return add(self, {kind = type(by) == "table" and "fix" or "move", by = by}, where)
end

--- Nodes are fixed and rotated about an axis: {axis =, point =, angle = (degrees), move = {x, y, z}}.
function solid:rotate(where, given)
  check_self("rotate", self)
  check_where("rotate", where)
  local opts = options.read("rotate", given, {
    axis = {type = "any", needed = true},
    point = {type = "any", default = {0, 0, 0}},
    angle = {type = "number", needed = true},
    move = {type = "any", default = {0, 0, 0}},
  })
  local axis = vector("rotate", "axis", opts.axis)
  local length = math.sqrt(axis[1] ^ 2 + axis[2] ^ 2 + axis[3] ^ 2)
  if length == 0 then raise "rotate: axis: a direction expected, got {0, 0, 0}" end
  return add(self, {kind = "rotate", angle = math.rad(opts.angle),
    axis = {axis[1] / length, axis[2] / length, axis[3] / length},
    point = vector("rotate", "point", opts.point), move = vector("rotate", "move", opts.move)},
    where)
end

--- A total force on the boundary faces of nodes, by area.
function solid:force(where, total)
  check_self("force", self)
  check_where("force", where)
  return add(self, {kind = "force", total = vector("force", "total", total)}, where)
end

function solid:gravity(acceleration)
  check_self("gravity", self)
  return add(self, {kind = "gravity", acceleration = vector("gravity", "acceleration", acceleration)})
end

--- Pressure (Pa, positive pushes inwards) on the free faces of cells between nodes by place, or on a
--- surface that goes with the solid: {pressure = a number, a function of the centroid's x, y, z, or for a
--- surface a list with one for each triangle; follower = along the normals of the deformed shape}.
function solid:pressure(on, given)
  check_self("pressure", self)
  check_where("pressure", on)
  local surface = core.class_name(on) == "surface"
  if surface and on.triangle_count < 1 then
    raise "pressure: a surface with one triangle or more expected, got an empty one"
  end
  local opts = options.read("pressure", given, {
    pressure = {type = "any", needed = true},
    follower = {type = "boolean", default = false},
  })
  local kind = type(opts.pressure)
  if kind ~= "number" and kind ~= "function" and kind ~= "table" and not is_array(opts.pressure) then
    raise(("pressure: a number, a list or a function of x, y, z expected, got %s"):format(
      core.got(opts.pressure)))
  end
  if kind == "number" and not finite(opts.pressure) then
    raise(("pressure: a finite number expected, got %s"):format(core.got(opts.pressure)))
  end
  if not surface then
    if kind ~= "number" and kind ~= "function" then
      raise(("pressure: a number or a function of x, y, z expected, got %s: a list goes with a surface"):format(
        core.got(opts.pressure)))
    end
    return add(self, {kind = "surface_pressure", pressure = opts.pressure, follower = opts.follower}, on)
  end
  return add(self, {kind = "pressure", surface = on, pressure = opts.pressure, follower = opts.follower})
end

--- A plane that the solid may touch and not pass, without friction: {point =, normal = into the side
--- where the solid is, move = its displacement at full load, surface = what touches it; without: the
--- nodes}.
function solid:contact_plane(given)
  check_self("contact_plane", self)
  local opts = options.read("contact_plane", given, {
    point = {type = "any", needed = true},
    normal = {type = "any", needed = true},
    move = {type = "any", default = {0, 0, 0}},
    surface = {type = "surface"},
  })
  return add(self, {kind = "contact_plane", point = vector("contact_plane", "point", opts.point),
    normal = vector("contact_plane", "normal", opts.normal), move = vector("contact_plane", "move", opts.move),
    surface = opts.surface})
end

-- ---- cases ---------------------------------------------------------------------------------------

-- Where a point goes when it is rotated by `part` of the angle.
local function rotated(act, x, y, z, part)
  local n, p = act.axis, act.point
  local c, s = math.cos(act.angle * part), math.sin(act.angle * part)
  local rx, ry, rz = x - p[1], y - p[2], z - p[3]
  local along = (n[1] * rx + n[2] * ry + n[3] * rz) * (1 - c)
  return rx * (c - 1) + n[1] * along + (n[2] * rz - n[3] * ry) * s + part * act.move[1],
    ry * (c - 1) + n[2] * along + (n[3] * rx - n[1] * rz) * s + part * act.move[2],
    rz * (c - 1) + n[3] * along + (n[1] * ry - n[2] * rx) * s + part * act.move[3]
end

-- Nodes of a grid are prescribed by what displacement(x, y, z) returns.
local function prescribe(case, act, grid, displacement)
  local nodes, message, details = nodes_of(grid, act)
  if not nodes then return nil, message, details end
  local rows = {}
  for i, at in ipairs(grid.points:gather(nodes):totable()) do
    rows[i] = {displacement(at[1], at[2], at[3])}
  end
  return case:fix_each(nodes, rows)
end

-- A function's values at the centroids of a surface's triangles.
local function middle_values(surface, f)
  local points, values = surface.points:totable(), {}
  for t, corners in ipairs(surface.triangles:totable()) do
    local a, b, c = points[corners[1]], points[corners[2]], points[corners[3]]
    local x, y, z = (a[1] + b[1] + c[1]) / 3, (a[2] + b[2] + c[2]) / 3, (a[3] + b[3] + c[3]) / 3
    values[t] = f(x, y, z)
    if not finite(values[t]) then
      raise(("pressure: a finite number expected of the function, got %s at %s"):format(core.got(values[t]),
        core.point {x, y, z}))
    end
  end
  return values
end

-- Each returns nothing, or nil, message, details.
local apply = {}

function apply.fix(case, act, grid, part)
  local by = {}
  for i = 1, 3 do by[i] = act.by[i] and act.by[i] * part end
  local nodes, message, details = nodes_of(grid, act)
  if not nodes then return nil, message, details end
  return case:fix(nodes, by)
end

function apply.move(case, act, grid, part)
  return prescribe(case, act, grid, function(x, y, z)
    local u, v, w = act.by(x, y, z)
    if not (finite(u) and finite(v) and finite(w)) then
      raise(("fix: three finite numbers expected of the function, got %s, %s, %s at %s"):format(core.got(u),
        core.got(v), core.got(w), core.point {x, y, z}))
    end
    return u * part, v * part, w * part
  end)
end

function apply.rotate(case, act, grid, part)
  return prescribe(case, act, grid, function(x, y, z) return rotated(act, x, y, z, part) end)
end

function apply.force(case, act, grid, part)
  local nodes, message, details = nodes_of(grid, act)
  if not nodes then return nil, message, details end
  local t = act.total
  return case:force(nodes, {t[1] * part, t[2] * part, t[3] * part})
end

function apply.gravity(case, act, _, part)
  local a = act.acceleration
  return case:gravity {a[1] * part, a[2] * part, a[3] * part}
end

function apply.surface_pressure(case, act, grid, part)
  local nodes, message, details = nodes_of(grid, act)
  if not nodes then return nil, message, details end
  return case:surface_pressure(nodes, act.pressure, part, act.follower)
end

function apply.pressure(case, act, grid, part)
  local surface, pressure = act.surface, act.pressure
  local values = pressure
  if type(pressure) == "number" then
    values = {}
    for t = 1, surface.triangle_count do values[t] = pressure end
  elseif type(pressure) == "function" then
    values = middle_values(surface, pressure)
  elseif type(pressure) == "userdata" then
    values = pressure:totable()
  end
  local scaled = {}
  for t, value in ipairs(values) do
    if not finite(value) then
      raise(("pressure: entry %d: a finite number expected, got %s"):format(t, core.got(value)))
    end
    scaled[t] = value * part
  end
  local embedding, message, details = grid:embed(surface)
  if not embedding then return nil, message, details end
  return case:pressure(embedding, surface.triangles, scaled, act.follower)
end

function apply.contact_plane(case, act, grid, part)
  local move = {act.move[1] * part, act.move[2] * part, act.move[3] * part}
  if not act.surface then return case:contact_plane(act.point, act.normal, move) end
  local embedding, message, details = grid:embed(act.surface)
  if not embedding then return nil, message, details end
  return case:contact_plane(act.point, act.normal, move, embedding, act.surface.points)
end

-- The case at a part of the path: turns go along their arcs, everything else in proportion.
local function case_of(self, part)
  local case, message, details = core.solid.case(self.grid)
  if not case then return nil, message, details end
  for _, act in ipairs(self.acts) do
    local _
    _, message, details = apply[act.kind](case, act, self.grid, part)
    if message then return nil, message, details end
  end
  return case
end

-- ---- solving -------------------------------------------------------------------------------------

local MAX_PARTS = 1000
local solve_rules = {
  path = {type = "integer", min = 1, max = MAX_PARTS},
  start = {type = "any"},
  choose = {type = "boolean", default = true},
}
for key, kind in pairs {tolerance = "number", iterations = "integer", steps = "integer",
  max_iterations = "integer", min_step = "number", allow_inverted = "boolean", solver = "any",
  coarse = "any"} do
  solve_rules[key] = {type = kind}
end

-- A rotation goes along its arc in parts of at most 30 degrees.
local function parts_of(self)
  local parts = 1
  for _, act in ipairs(self.acts) do
    if act.kind == "rotate" then
      parts = math.max(parts, math.ceil(math.abs(act.angle) / (math.pi / 6) - 1e-9))
    end
  end
  if parts > MAX_PARTS then
    raise(("solve: rotations of at most %d degrees expected, %d parts of 30 degrees, got %.0f parts"):format(
      30 * MAX_PARTS, MAX_PARTS, parts))
  end
  return parts
end

-- The pair that preconditions on a coarse solid of one level.
local function coarse_of(given)
  if getmetatable(given) ~= solid or not given.coarse or given.levels ~= 1 then
    raise("solve: option 'coarse': a solid expected that was made coarse once from this one, got "
      .. core.got(given))
  end
  return {{given.coarse:coarsening(1), given.body}}
end

-- Up to so many nodes a factor is sure to be cheap. Beyond, the engine counts what it costs and what conjugate
-- gradients over coarse solids do, which need the fewer iterations the better these are: a fine solid may be
-- of sheets and rods a cell thick, of which nothing is left in a coarse one (docs/theory/data_driven.md,
-- "Equilibrium"). The last coarse solid's tangent is factored; it gets few enough nodes for it.
local FEW_NODES = 1500
local MAX_FACTORED = 5000
local MAX_LEVELS = 2

-- Pairs of a coarsening and a solid on its coarse grid to precondition with where none are given, kept;
-- nil where a factor does. The naive materials below a looked-up one are too stiff, which costs few
-- iterations more; those of blocks' representatives may be too soft, which costs many.
local function own_coarse(self, wanted)
  local level = self.levels
  if level == MAX_LEVELS then
    if wanted then raise "solve: bw.solver.two_level is not available: this solid was made coarse twice" end
    return nil
  end
  if not (wanted or self.node_count > FEW_NODES) then return nil end
  if self.body.formulation == "b_bar" then -- coarse cells would lock where the fine ones are made not to
    if wanted then raise "solve: bw.solver.two_level is not available: a material is B-bar" end
    return nil
  end
  if rawget(self, "under") == nil then
    local grid, materials, list = self.grid, self.materials, {}
    if self.coarse then grid, materials = self.coarse.fine, self.fine_materials end
    repeat
      level = level + 1
      local coarse, message, details = core.metamaterial.coarsen(grid, materials, "naive", level)
      local body
      if coarse then body, message, details = core.solid.create(coarse.grid, coarse.materials) end
      -- no coarser one is to be had; what ran out or was cancelled says nothing of the next time
      if not body and (details.status == "memory" or details.status == "cancelled") then
        return nil, message, details
      end
      if not body then break end
      list[#list + 1] = {coarse:coarsening(level), body}
    until level == MAX_LEVELS or coarse.grid.node_count <= MAX_FACTORED
    rawset(self, "under", #list > 0 and list or false)
  end
  return rawget(self, "under") or nil
end

-- Whether a solver preconditions with coarse solids.
local function has_two_levels(solver)
  if core.class_name(solver) ~= "solver" or solver.kind ~= "pcg" then return false end
  return not solver.preconditioner or solver.preconditioner.kind == "two_level"
end

-- Equilibrium of the solid as it is.
local function solve_itself(self, opts)
  local parts = opts.path or parts_of(self)
  local newton = {}
  for key, value in pairs(opts) do
    if key ~= "path" and key ~= "start" and key ~= "choose" then newton[key] = value end
  end
  local under = opts.coarse and coarse_of(opts.coarse)
  local given = opts.solver ~= "auto" and opts.solver or nil
  local two_level = has_two_levels(given)
  if under == nil and (given == nil or two_level) then
    local message, details
    under, message, details = own_coarse(self, two_level)
    if message then return nil, message, details end
  end
  newton.coarse = under
  if given == nil then
    newton.solver = opts.coarse and core.solver.pcg() or nil
  end
  local start, all = opts.start, {}
  for part = 1, parts do
    local case, message, details = case_of(self, part / parts)
    if not case then return nil, message, details end
    local result
    result, message, details = self.body:solve(case, self.newton, newton, start)
    if not result then
      if details and details.reached then
        details.reached = solid_results.create(self, details.reached, all)
      end
      return nil, message, details
    end
    all[part], start = result, result.displacement
  end
  return solid_results.create(self, all[parts], all)
end

--- Equilibrium: {tolerance =, iterations = in a load step, max_iterations = in all of them, steps =
--- load steps to begin with, min_step = where to give up, path = parts of the path
--- (each solved, from the last), solver = cholesky, pcg with jacobi or pcg with two_level of
--- bw.solver (the first or the last, whichever costs less by count), coarse = a coarse solid,
--- start = displacements, allow_inverted =, choose = whether the naive coarse solid replaces one of a
--- library where that is estimated to be nearer to the fine one (true)}. Returns the result; or nil,
--- message, details, where details.reached is the last equilibrium on the way.
function solid:solve(given)
  check_self("solve", self)
  local opts = options.read("solve", given, solve_rules)
  if opts.choose and rawget(self, "by_library") then return estimate.better(self, opts) end
  return solve_itself(self, opts)
end

--- The solid in motion: {scheme = "implicit_euler" | "newmark", step = s, mass_damping =,
--- stiffness_damping =, beta =, gamma =, tolerance =, iterations =, displacement =, velocity =}. Loads
--- are at full, what is fixed stays where it is at full load.
function solid:transient(given)
  check_self("transient", self)
  if given ~= nil and type(given) ~= "table" then
    raise(("transient: a table of options expected, got %s"):format(core.got(given)))
  end
  local opts = {}
  for key, value in pairs(given or {}) do opts[key] = value end
  local displacement, velocity = opts.displacement, opts.velocity
  opts.displacement, opts.velocity = nil, nil
  local case, message, details = case_of(self, 1)
  if not case then return nil, message, details end
  return self.body:transient(case, opts, displacement, velocity)
end

-- ---- other grids ---------------------------------------------------------------------------------

--- The same solid on an edited grid; a coarse one follows its fine grid.
function solid:with(grid)
  check_self("with", self)
  options.object("with", "grid", grid, "grid")
  if not self.coarse then return make(grid, self.materials, self.acts, self.body) end
  local coarse, message, details = self.coarse:follow(grid)
  if not coarse then return nil, message, details end
  return make(coarse.grid, coarse.materials, self.acts, self.body, coarse, self.fine_materials,
    rawget(self, "by_library"))
end

--- The solid on a grid made coarse: by a library, or "naive" or "average"; `levels` times (1).
function solid:coarsen(by, levels)
  check_self("coarsen", self)
  if self.coarse then raise "coarsen: this solid is coarse already: coarsen the fine one by more levels" end
  local coarse, message, details = core.metamaterial.coarsen(self.grid, self.materials, by, levels or 1)
  if not coarse then return nil, message, details end
  return make(coarse.grid, coarse.materials, self.acts, nil, coarse, self.materials, type(by) ~= "string")
end

--- The fine solid of a coarse one; itself of a fine one.
local function fine_of(self)
  if not self.coarse then return self end
  if not rawget(self, "fine_solid") then
    local made, message, details = make(self.coarse.fine, self.fine_materials, self.acts)
    if not made then return nil, message, details end
    rawset(self, "fine_solid", made)
  end
  return rawget(self, "fine_solid")
end

-- The naive coarse solid beside one of a library, kept.
local function naive_of(self)
  if not rawget(self, "naive") then
    local fine, message, details = fine_of(self)
    if not fine then return nil, message, details end
    local made
    made, message, details = fine:coarsen("naive", self.levels)
    if not made then return nil, message, details end
    rawset(self, "naive", made)
  end
  return rawget(self, "naive")
end

--- The solid made coarse by a library and solved: {by = library, levels = 1, other options as of `solve`}. The
--- result, and how it was chosen; nil, message, details.
function solid:solve_coarse(given)
  check_self("solve_coarse", self)
  if type(given) ~= "table" then
    raise(("solve_coarse: a table of options expected, got %s"):format(core.got(given)))
  end
  local opts = {}
  for key, value in pairs(given) do opts[key] = value end
  local own = options.read("solve_coarse", {by = opts.by, levels = opts.levels}, {
    by = {type = "library", needed = true}, levels = {type = "integer", default = 1, min = 1, max = 2}})
  opts.by, opts.levels = nil, nil
  local coarse, message, details = self:coarsen(own.by, own.levels)
  if not coarse then return nil, message, details end
  local result
  result, message, details = coarse:solve(opts)
  if not result then return nil, message, details end
  return result, result.choice
end

function solid:__tostring()
  return ("solid: %d elements, %d nodes, %d materials%s; %d supports and loads"):format(
    self.grid.element_count, self.grid.node_count, self.materials.count,
    self.coarse and (" (coarse, level %d)"):format(self.coarse.levels) or "", #self.acts)
end

solids.class, solids.properties = solid, properties

estimate.begin {case_of = case_of, own_coarse = own_coarse, fine_of = fine_of, naive_of = naive_of,
  solve_itself = solve_itself}

return solids
