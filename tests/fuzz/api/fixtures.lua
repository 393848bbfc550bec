-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Small objects of every class, some variants of each, made when they are first asked for. The first of a class
-- are the same for each call; where a call closed or changed some they are made again.
local bw = require "barwright"
local core = require "barwright.core"
local files = require "files"
local good = require "good"
local hostile = require "hostile"
local new_random = require "random"

local function rectangle(more)
  local opts = {min = {0, 0}, max = {1, 0.5}, tags = {bottom = 1, right = 2, top = 3, left = 4}}
  for key, value in pairs(more or {}) do opts[key] = value end
  return assert(bw.outline.rectangle(opts))
end

local function beam(cells, order)
  return assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}, cells = cells, order = order})
end

local function part(mesh, material)
  local model = bw.model {mesh = mesh, material = material}
  return model:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = {0, 0, -10}}
end

local sheet = {left = "fixed", right = {traction = {0, -1e5}}}

local function sheet_options(more)
  local opts = {outline = rectangle(), material = bw.material.steel, thickness = 0.01, elements = 16,
    conditions = sheet}
  for key, value in pairs(more or {}) do opts[key] = value end
  return opts
end

local function flow_options(more)
  local opts = {outline = rectangle(), viscosity = 0.1, elements = 24, step = 0.02,
    conditions = {left = {x = 1, y = 0}, top = "wall", bottom = "wall"}}
  for key, value in pairs(more or {}) do opts[key] = value end
  return opts
end

local function materials()
  return {bw.hyperelastic {young = 1e5, poisson = 0.3, density = 1000, name = "soft"},
    bw.hyperelastic {young = 1e6, poisson = 0.3, density = 1000, name = "hard"}}
end

local function solid(grid)
  local made = assert(bw.solid {grid = grid, materials = materials()})
  made:fix({side = "min x"}):force({side = "max x"}, {0, 0, -1})
  return made
end

local makers = {}

makers.Array = {
  function() return bw.array.new {1, 2, 3} end,
  function() return bw.array.new {{1, 2, 3}, {4, 5, 6}, {7, 8, 10}} end,
  function() return bw.array.zeros(0) end,
  function() return bw.array.zeros(4, 2, "i32") end,
  function() return bw.array.new({0, 1, 1, 0}, "u8") end,
  function() return bw.array.new {0 / 0, math.huge, -1} end,
  function(p) return p.Mesh.nodes:column(2) end,
  function(p) return p.Mesh.nodes end,
  function(p) return p.Mesh.volumes end,
  function(p) return p.Static.displacement end,
  function() return bw.array.new({1, 1 << 53, math.maxinteger}, "i64") end,
  function() return bw.array.zeros(200, 6) end,
  function(p) return p.Outline.points end,
  function(p) return p.Grid.points end,
  function(p) return p.Skeleton:rest_pose() end,
  function(p) return (p.Skeleton:pose_maps(p.Skeleton:rest_pose())) end,
}
makers.Surface = {
  function() return bw.surface.box {min = {0, 0, 0}, max = {1, 1, 1}} end,
  function() return bw.surface.sphere {radius = 1, subdivisions = 1} end,
  function(p) return (p.Mesh:surface()) end,
  function() return bw.surface.new {points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    triangles = {{1, 2, 3}, {1, 2, 4}}} end,
}
makers.Mesh = {
  function() return beam({4, 1, 1}) end,
  function() return beam({2, 1, 1}, 2) end,
  function() return beam({4, 1, 1}):scale(2) end,
  function() return assert(bw.mesh.new {nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, elements = {{1, 2,
    3, 4}}}) end,
}
makers.Selection = {
  function(p) return p.Mesh.boundary:below(1, 0) end,
  function(p) return p.Mesh.boundary:above(1, 1) end,
  function(p) return p.Mesh.boundary end,
  function(p) return p:variant("bw.Mesh", 2).boundary:facing {0, 0, 1} end,
}
makers.Material = {
  function() return bw.material.steel end,
  function() return bw.material.zp150 end,
  function() return bw.material.isotropic {young = 1e9, poisson = 0.3} end,
}
makers.Model = {
  function(p) return part(p.Mesh, bw.material.steel) end,
  function(p) return part(p:variant("bw.Mesh", 2), bw.material.zp150) end,
  function(p) return bw.model {mesh = p.Mesh, material = bw.material.pla} end,
}
makers.Static = {
  function(p) return assert(p.Model:solve()) end,
  function(p) return assert(part(p:variant("bw.Mesh", 2), bw.material.zp150):solve()) end,
}
makers.Nonlinear = {function(p) return assert(p.Model:nonlinear {steps = 2}) end}
makers.Heat = {function(p)
  return bw.heat {mesh = p.Mesh, material = bw.material.steel}:prescribe(p.Mesh.boundary:below(1, 0), 300)
    :load {on = p.Mesh.boundary:above(1, 1), power = 10}
end}
makers.RigidSurface = {
  function() return bw.rigid.plane {normal = {0, 0, 1}} end,
  function() return bw.rigid.cylinder {axis = {0, 1, 0}, radius = 0.1, inside = true} end,
}
makers.Drop = {function()
  local mesh = bw.mesh.box {max = {0.02, 0.02, 0.02}, cells = {1, 1, 1}}
  return assert(bw.model({mesh = mesh, material = bw.material.pla}):drop {down = {-1, -2, -3}, samples = 2})
end}
makers.Contact = {function(p)
  return assert(p.Model:contact {{on = p.Mesh.boundary:below(3, 0), with = bw.rigid.plane {normal = {0, 0, 1}}}})
end, function(p)
  return assert(p.Model:contact {{on = p.Mesh.boundary:above(3, 0.02), friction = 0.2,
    with = bw.rigid.plane {point = {0, 0, 1}, normal = {0, 0, -1}}}})
end}
makers.ContactSystem = {function()
  local mesh = bw.mesh.box {max = {0.1, 0.02, 0.01}, cells = {4, 1, 1}}
  local body = bw.model {mesh = mesh, material = bw.material.pla}:fix(mesh.boundary:below(1, 0))
  return assert(body:contact_system {{on = mesh.boundary:below(3, 0), with = bw.rigid.plane {normal = {0, 0, 1}}}})
end}
makers.Deposition = {function()
  local mesh = bw.mesh.box {cells = {2, 2, 2}}
  local laid = bw.model {mesh = mesh, material = bw.material.isotropic {young = 2e9, expansion = 1e-5}}
  return assert(laid:fix(mesh.boundary:below(3, 0)):deposit {layers = 2, change = -100})
end}
makers.HeatSolution = {function(p) return assert(p.Heat:solve()) end}
makers.HeatTransient = {function(p) return assert(p.Heat:transient {initial = 300}) end}
makers.LinearTransient = {function(p) return assert(p.Model:transient {step = 1e-4}) end}
makers.Recording = {function(p)
  return assert(p.LinearTransient:run {time = 3e-4, probes = {a = {0, 0, 0}}, frames = 3})
end}
makers.Eigensolver = { -- none of several processes
  function() return bw.eigensolver.lanczos {} end,
  function() return bw.eigensolver.arpack {} end,
  function() return bw.eigensolver.lobpcg {} end,
}
makers.Modes = {
  function(p) return assert(p.Model:modes {count = 2}) end,
  function(p) return assert(p:variant("bw.Model", 3):modes {count = 1, laplacian = true}) end,
}
makers.Harmonic = {function(p)
  return assert(p.Model:harmonic {range = {0, 50}, modes = 2, damping = {ratio = 0.1}})
end}
makers.HarmonicCurve = {function(p) return assert(p.Harmonic:curve {at = {1, 0, 0}, frequencies = {1, 2}}) end}
local function shaken(model, direction)
  return assert(model:response_spectrum {points = {{1e-6, 1}, {1e-5, 2}}, direction = direction})
end
makers.CombinedSpectrum = {function(p)
  return shaken(p.Model, {0, 0, 1}):combine {shaken(p.Model, {1, 0, 0})}
end}
makers.ResponseSpectrum = {function(p) return shaken(p.Model, {0, 0, 1}) end}
makers.HarmonicEnvelope = {function(p) return assert(p.Harmonic:envelope {frequencies = {1, 2}}) end}
makers.Fatigue = {function(p)
  return assert(bw.fatigue {loads = {{static = p.Static, history = {0, 1, 0}}}, curve = {amplitude = 1e8}})
end}
makers.RandomResponse = {function(p) return assert(p.Harmonic:random {psd = {{1, 1}, {50, 1}}}) end}
makers.RandomMargins = {function(p) return assert(p.RandomResponse:margins {duration = 1, strength = 1e6}) end}
makers.RandomFatigue = {function(p)
  return assert(p.RandomResponse:fatigue {duration = 1, curve = {amplitude = 1e6}})
end}
makers.System = {
  function(p) return assert(p.Model:system()) end,
  function(p) return assert(p:variant("bw.Model", 3):system()) end,
}
makers.WorstCase = {function(p)
  return assert(bw.worst_case(p:variant("bw.Model", 3), {force = 1, pressure = 1e6, modes = 1, regions = 1}))
end}
makers.WorstBuckling = {function(p)
  return assert(bw.worst_buckling(p.Model, {force = 1, pressure = 1e6, modes = 2, restarts = 2, ascents = 1,
    shapes = 1}))
end}
makers.WeakRegions = {function(p)
  return assert(bw.weak_regions(p.Mesh, bw.material.pla, (assert(p:variant("bw.Model", 3):modes {count = 1}))))
end, function(p) return bw.single_regions(p.Mesh, {1, 2}) end}
makers.SparseMatrix = {function() return bw.sparse_matrix.new(2, 2, {1, 2}, {1, 2}, {1, 2}) end}
makers.Operator = {
  function() return bw.operator {size = 3, apply = function(x) return 2 * x end} end,
  function(p) return assert(p.SparseMatrix:inverse()) end,
  function() return bw.operator {size = 2, apply = function() error "not today" end} end,
}
makers.Eigenpairs = {function(p) return assert(p.SparseMatrix:eigenpairs {count = 1}) end}
makers.LpSolver = {function() return bw.lp.glpk {} end}
makers.Solver = { -- none of several processes
  function() return assert(bw.solver.cholesky {}) end,
  function() return assert(bw.solver.pcg {preconditioner = bw.solver.amg {}}) end,
  function() return assert(bw.solver.cholesky {backend = "cholmod"}) end,
}
makers.PressureBasis = {function(p) return bw.pressure_basis(p.Mesh) end}
makers.BruteForce = {function(p)
  return assert(bw.brute_force(p:variant("bw.Model", 3), {force = 1, pressure = 1e6, elements = 2}))
end}
makers.BreakingForce = {function(p)
  return assert(bw.breaking_force(p.Mesh, {material = bw.material.pla, modes = 1, regions = 1}))
end}
makers.SingularPlaces = {function(p) return assert(p.Mesh:surface():singular_edges()) end}
makers.RandomDrops = {function()
  local mesh = bw.mesh.box {max = {0.02, 0.02, 0.02}, cells = {1, 1, 1}}
  return assert(bw.random_drops(bw.model {mesh = mesh, material = bw.material.pla}, {drops = 2, samples = 2}))
end}
makers.DropTest = {function(p) return assert(bw.drop_test(p:variant("bw.Model", 3), {drops = 2})) end}
makers.Outline = {
  function() return rectangle() end,
  function() return assert(bw.outline.circle {radius = 0.3, centre = {0.5, 0.25}}) end,
  function() return assert(bw.outline {points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}},
    tags = {right = {2}, left = {4}}, holes = {bw.outline.circle {centre = {0.5, 0.5}, radius = 0.1,
      name = "hole"}}}) end,
  function() return assert(rectangle():shifted {0.01, 0}) end,
  function() return assert(bw.outline {{0, 0}, {1, 0}, {{1, 0.3}, {0.6, 0.6}, {0, 0.5}}}) end,
}
makers.Skeleton = {
  function() return bw.skeleton.create {joints = {a = {0, 0.05, 0.05}, b = {0.5, 0.05, 0.05}, c = {1, 0.05,
    0.05}},
    bones = {{"a", "b", name = "upper"}, {"b", "c", name = "lower"}}, root = "a"} end,
  function() return bw.skeleton.create {joints = {{0, 0, 0}, {1, 0, 0}}, bones = {{1, 2}}} end,
}
makers.Subdomains = {function(p) return p.Session.subdomains end, function(p)
  return assert(bw.subdomains(p.Mesh, p.Skeleton, assert(bw.skinning_weights(p.Mesh, p.Skeleton))))
end}
makers.Session = {
  function(p) return assert(bw.edit(p.Model, {skeleton = p.Skeleton})) end,
  function(p) return assert(bw.edit(p:variant("bw.Model", 2), {skeleton = p.Skeleton})) end,
}
makers.Bone = {
  function(p) return p.Session:bone "lower" end,
  function(p) return p.Session:bone "upper" end,
}
makers.IncrementalSystem = {function(p) return (assert(p.Session:synchronise())) end}
makers.JoinedIncrementalSystem = {function(p)
  local joined = part(p.Mesh, bw.material.pla):attach {on = p.Mesh.boundary:above(3, 0.1), mass = 0.1}
  return (assert(assert(bw.edit(joined, {skeleton = p.Skeleton})):synchronise()))
end}
makers.Optimisation = {function(p)
  local session = assert(bw.edit(p.Model, {skeleton = p.Skeleton}))
  return assert(session:optimise {von_mises = 1e12, move_supports = true})
end}
makers.Workbench = {function()
  local path = files.path "workbench.stl"
  assert(bw.surface.box {max = {0.1, 0.02, 0.01}}:write(path))
  return assert(bw.workbench.open(path))
end}
makers.LiveServer = {function() return assert(core.live_server {}) end}
makers.Results = {function() return assert(bw.results.open(files.path "results", {script = "good.lua"})) end}
makers.SteadySheet = {function() return assert(bw.responsive.steady(sheet_options())) end,
  function() return assert(bw.responsive.steady(sheet_options {order = 2, elements = 8})) end}
makers.LargeDeflectionSheet = {function() return assert(bw.responsive.cantilever(sheet_options())) end}
makers.TransientSheet = {function()
  return assert(bw.responsive.vibration(sheet_options {ground = "left", ground_motion = {x = "0.01*sin(9*t)"},
    conditions = {}}))
end}
makers.Sheet = {function(p) return rawget(p.SteadySheet, "body") end,
  function(p) return rawget(p.LargeDeflectionSheet, "body") end}
makers.Metallophone = {function()
  return assert(bw.responsive.metallophone {outline = rectangle {max = {0.2, 0.03}}, thickness = 0.004,
    material = bw.material.aluminium, elements = 12})
end}
makers.Plate = {function(p) return rawget(p.Metallophone, "body") end}
makers.ReuseStatistics = {function(p) return p.SteadySheet.reused end, function(p) return p.Flow.reused end}
makers.Bridge = {function()
  return assert(bw.responsive.bridge {span = 0.2, load = 100, stress_limit = 30e6, material = bw.material.pla,
    thickness = 0.004, size = 0.02, wall = 0.01})
end}
makers.Flow = {function() return assert(bw.responsive.flow(flow_options())) end}
makers.ThermalFlow = {function()
  return assert(bw.responsive.thermal(flow_options {diffusivity = 0.1, conditions = {left = {x = 1, y = 0,
    temperature = 1}, top = "wall", bottom = {x = 0, y = 0, heat_flux = 1}}}))
end}
makers.FlowBody = {function(p) return rawget(p.Flow, "body") end, function(p) return rawget(p.ThermalFlow,
  "body") end}
makers.PlaneMesh = {
  function() return assert(bw.plane.rectangle {cells = {2, 2}}) end,
  function(p) return assert(bw.plane.fill(p.Outline, {elements = 12})) end,
  function(p) return assert(bw.plane.fill(p.Outline, {elements = 8, order = 2})) end,
}
makers.MeshMotion = {function(p) return assert(bw.plane.mesh_motion(p:variant("bw.PlaneMesh", 2))) end,
  function(p) return assert(bw.plane.mesh_motion(p:variant("bw.PlaneMesh", 3), {relocation = "springs"})) end}
makers.Grid = {
  function() return assert(bw.grid.box {size = {1, 0.5, 0.5}, cells = {4, 2, 2}}) end,
  function() return assert(bw.grid.box {size = {1, 1, 1}, cells = {2, 2, 2},
    material = "where(x > 0.5, 2, 1)"}) end,
  function() return assert(bw.grid.voxels(bw.surface.sphere {radius = 1, subdivisions = 1}, {cells = 3})) end,
}
makers.Embedding = {
  function(p) return assert(p.Grid:embed({{0.1, 0.1, 0.1}, {0.9, 0.4, 0.4}})) end,
  function(p) return assert(p.Grid:embed(bw.surface.sphere {radius = 0.2, centre = {0.5, 0.25, 0.25},
    subdivisions = 1})) end,
}
makers.Hyperelastic = {function() return materials()[1] end,
  function() return bw.hyperelastic {law = "corotated", young = 1e6, poisson = 0.2} end}
makers.MaterialTable = {function(p) return p.Solid.materials end}
makers.Solid = {function(p) return solid(p.Grid) end, function(p) return solid(p:variant("bw.Grid", 2)) end}
makers.SolidResult = {function(p) return assert(p.Solid:solve()) end}
makers.SolidTransient = {function(p) return assert(p.Solid:transient {step = 0.01}) end}
makers.Library = {function() return assert(bw.metamaterial.read "good/good.bwm") end}
makers.Canvas = {function() return assert(bw.canvas(100, 80)) end}
makers.Figure = {
  function() return bw.plot.lines {series = {{name = "a", y = {1, 2, 4}}}} end,
  function() return bw.plot.bars {names = {"a", "b"}, series = {{name = "s", values = {1, 2}}}} end,
}
makers.Study = {function() return files.study "good.study" end, function()
  return files.study "another.study" end}
makers.Surrogate = {function(p) return assert(p.Trials:surrogate(p.Trials.problem.measures[1].name)) end}
makers.Trials = {function(p) return assert(p.Study:trials()) end, function()
  local list = require "study_trials" ({{name = "mass", goal = "min"}, {name = "stiffness", goal = "max"}},
    20, "trials")
  local of = bw.study {name = "hook", file = files.path "hook.study", variables = list.problem.variables,
    measures = list.problem.measures,
    objectives = list.problem.objectives, constraints = list.problem.constraints, design = {"random",
      count = 20}, run = print}
  return require("barwright.study.trials").new(of, {table.unpack(list)})
end}
makers.Trial = {function(p)
  local trial = require "barwright.study.trial"
  return trial.new(p.Study, {number = 1, key = ("ab"):rep(32), seed = 5, point = {height = 0.05, holes = 1,
    stiff = "a"}})
end}
makers.Expectation = {function(p) return p.expect(5, "a force", "N") end, function(p) return p.expect(nil,
  "failed", {status = "io"}) end,
  function(p) return p.expect(p.Modes) end, function(p) return p.expect(p.Array) end}
makers.Test = {function(p) return p.test end}

-- Changed by their methods: made again after so many uses.
local lives = {Model = 60, Session = 40, Bone = 40, IncrementalSystem = 40, JoinedIncrementalSystem = 40,
  LiveServer = 40, SteadySheet = 40, LargeDeflectionSheet = 40, TransientSheet = 40, Sheet = 40,
  Metallophone = 40, Plate = 40, Bridge = 60,
  Flow = 40, ThermalFlow = 40, FlowBody = 40, BodyState = 40, Heat = 40,
  HeatTransient = 40, MeshMotion = 40, Solid = 60, SolidTransient = 40,
  Canvas = 40, Study = 60, Trials = 100, Trial = 40, ReuseStatistics = 40, Results = 60}

-- ---- the pool -----------------------------------------------------------------------------------

local Pool = {}

local function short(class)
  return (class:gsub("^bw%.", ""))
end

function Pool.has(_, class)
  return makers[short(class)] ~= nil
end

--- The n-th object of a class.
function Pool:variant(class, n)
  local name = short(class)
  local made = self.made[name] or {}
  self.made[name] = made
  if made[n] == nil then
    local ok, object = pcall(makers[name][n], self)
    if not ok or object == nil then -- a call closed what it is made of
      self:forget()
      made = {}
      self.made[name] = made
      object = assert(makers[name][n](self))
    end
    made[n] = object
    hostile.named(("%s-%d"):format(name, n), made[n])
    self.home[made[n]] = {name, n, uses = 0}
  end
  self.used[#self.used + 1] = made[n]
  return made[n]
end

--- An object of a class: of a random variant, or of results of earlier calls, or the first one.
function Pool:get(class, random)
  local name = short(class)
  if not random or random:chance(0.5) then return self:variant(class, 1) end
  local results = self.results[name]
  if results and random:chance(0.3) then
    local object = random:one_of(results)
    self.used[#self.used + 1] = object
    return object
  end
  return self:variant(class, random:integer(#makers[name]))
end

local class_names = {}
for name in pairs(makers) do class_names[#class_names + 1] = name end
table.sort(class_names)

function Pool:any(random)
  return self:get(random:one_of(class_names), random)
end

-- A list that this process alone has may be long; objects that were closed for good.
local closable = {"Array", "Surface", "Mesh", "Selection", "Model", "Outline", "Skeleton", "PlaneMesh",
  "Grid", "Hyperelastic", "Canvas", "Embedding", "MeshMotion", "Subdomains", "System", "Session", "MaterialTable",
  "BodyState"}

function Pool:closed(random)
  local name = random:one_of(closable)
  return self:closed_one(name)
end

function Pool:closed_one(name)
  if not self.dead[name] then
    local ok, object = pcall(makers[name][1], self)
    if not ok then
      self:forget()
      object = makers[name][1](self)
    end
    if name == "MaterialTable" or name == "Subdomains" then -- the pool's own stay open
      object = name == "MaterialTable" and solid(self.Grid).materials or makers.Subdomains[2](self)
    end
    object:close()
    self.dead[name] = hostile.named(name .. " (closed)", object)
  end
  return self.dead[name]
end

--- Lets go of everything.
function Pool:drop()
  self.made, self.results, self.dead, self.used = {}, {}, {}, {}
end

--- Another object of the value's class, or a closed one, or one of another class.
function Pool:like(value, random)
  local home = self.home[value]
  local what = random:integer(4)
  if home and what <= 2 then return self:get(home[1], random) end
  if home and what == 3 then
    for _, name in ipairs(closable) do
      if name == home[1] then return self:closed_one(name) end
    end
  end
  return self:any(random)
end

-- Solvers of several processes start MPI for good, in a forked child too: tests/lua/distributed.
local function starts_mpi(name, object)
  if name ~= "Solver" and name ~= "Eigensolver" then return false end
  local text = tostring(object)
  return text:find "petsc" or text:find "slepc"
end

--- Keeps what a call gave, as an object of its class.
function Pool:keep(class, object, number)
  local name = short(class)
  if not makers[name] or (type(object) ~= "userdata" and type(object) ~= "table") then return end
  if starts_mpi(name, object) then return end
  local list = self.results[name] or {}
  self.results[name] = list
  list[number % 3 + 1 > #list and #list + 1 or number % 3 + 1] = object
  hostile.named(name .. " (result)", object)
end

--- All objects and files are made again when they are asked for.
function Pool:forget()
  self.made, self.results = {}, {}
  files.begin()
end

--- After a call: what was closed, or was changed often, is made again when it is asked for. `closed`: some of the
--- objects used may be closed now.
function Pool:settle(closed)
  for _, object in ipairs(self.used) do
    local home = self.home[object]
    if home then
      home.uses = home.uses + 1
      if closed or home.uses > (lives[home[1]] or math.huge) then
        self.home[object] = nil
        if self.made[home[1]] then self.made[home[1]][home[2]] = nil end
      end
    end
  end
  if closed then self.results = {} end
  self.used = {}
end

-- A class that is not above is made by the first entry that returns one.
local function maker_of(class, list)
  return function(pool)
    for _, entry in ipairs(list) do
      if entry.returns == class and entry.kind == "method" and makers[short(entry.class)] then
        local given = good[entry.name] and table.pack(good[entry.name](pool, new_random(1, 1))) or {n = 0}
        local self = pool:variant(entry.class, 1)
        local ok, object = pcall(self[entry.member], self, table.unpack(given, 1, given.n))
        if ok and object then return object end
      end
    end
    error("the fuzzer has no object of " .. class .. ": tests/fuzz/api/fixtures.lua needs a line for it", 0)
  end
end

--- A pool without objects yet, for the entries of the list; and the names of the classes.
return function(list)
  for _, entry in ipairs(list) do
    local name = entry.class and short(entry.class)
    if name and not makers[name] then
      makers[name] = {maker_of(entry.class, list)}
      class_names[#class_names + 1] = name
    end
  end
  local pool = {made = {}, home = setmetatable({}, {__mode = "k"}), used = {}, results = {}, dead = {}}
  return setmetatable(pool, {__index = function(self, key)
    return Pool[key] or makers[key] and self:variant(key, 1) or nil
  end}), class_names
end
