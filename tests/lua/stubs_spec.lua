-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Every bound name is in the stubs and in the reference, and the stubs name nothing that is not there.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"
package.path = check.root .. "/scripts/docs/?.lua;" .. package.path
local stubs = require "stubs"

local all = stubs.read(check.root .. "/lua/stubs")
local documented = stubs.names(all)
local pages = {}
for _, file in ipairs(all.files) do
  pages[file.name] = check.read(("%s/docs/reference/%s.md"):format(check.root, file.name))
end

local class_of = {array = "bw.Array", surface = "bw.Surface", mesh = "bw.Mesh",
  selection = "bw.Selection", material = "bw.Material", model = "bw.Model", static = "bw.Static",
  modes = "bw.Modes", buckling = "bw.Buckling", nonlinear = "bw.Nonlinear", harmonic = "bw.Harmonic",
  response_spectrum = "bw.ResponseSpectrum", eigensolver = "bw.Eigensolver",
  heat = "bw.Heat", heat_solution = "bw.HeatSolution", heat_transient = "bw.HeatTransient",
  linear_transient = "bw.LinearTransient", contact = "bw.Contact", contact_system = "bw.ContactSystem",
  deposition = "bw.Deposition",
  rigid_surface = "bw.RigidSurface", drop = "bw.Drop",
  system = "bw.System",
  weak_regions = "bw.WeakRegions",
  pressure_basis = "bw.PressureBasis", linear_program_solver = "bw.LpSolver", sparse_matrix = "bw.SparseMatrix",
  skeleton = "bw.Skeleton",
  subdomains = "bw.Subdomains", incremental_system = "bw.IncrementalSystem",
  joined_incremental_system = "bw.JoinedIncrementalSystem",
  live_server = "bw.LiveServer", outline = "bw.Outline",
  sheet = "bw.Sheet", plate = "bw.Plate",
  grid = "bw.Grid", canvas = "bw.Canvas", embedding = "bw.Embedding", hyperelastic = "bw.Hyperelastic",
  ["material table"] = "bw.MaterialTable", solid_transient = "bw.SolidTransient", library = "bw.Library",
  solver = "bw.Solver", plane_mesh = "bw.PlaneMesh", ["mesh motion"] = "bw.MeshMotion", flow = "bw.FlowBody",
  state = "bw.BodyState", operator = "bw.Operator", eigenpairs = "bw.Eigenpairs"}

-- Seen from scripts only through objects written in Lua.
local inner_class = {locator = true, elastic_solid = true, load_case = true, large_static = true,
  coarse_grid = true, coarsening = true, newton = true, job = true, database = true, lock = true,
  ["temporary file"] = true}

local function keys(...)
  local out = {}
  for _, t in ipairs {...} do
    for name in pairs(t) do
      if type(name) == "string" and not name:match "^__" then out[name] = true end
    end
  end
  return out
end

-- Both ways, with the names that differ in the message.
local function same(bound, class, also)
  local stub = assert(documented[class], class .. " is not in the stubs")
  local missing, unbound, page = {}, {}, all.by_name[class].file
  for name in pairs(bound) do
    if not stub[name] then missing[#missing + 1] = name end
    assert.truthy(class == "bw" or pages[page]:find(name, 1, true),
      ("%s is not in docs/reference/%s.md"):format(name, page))
  end
  for name in pairs(stub) do
    if not bound[name] and not (also and also[name]) then unbound[#unbound + 1] = name end
  end
  table.sort(missing)
  table.sort(unbound)
  assert.equal("", table.concat(missing, " "), "not in the stubs: " .. class)
  assert.equal("", table.concat(unbound, " "), "in the stubs but not bound: " .. class)
end

describe("the stubs", function()
  it("are Lua", function()
    for _, file in ipairs(all.files) do
      assert(load(check.read(("%s/lua/stubs/%s.lua"):format(check.root, file.name)), file.name))
    end
  end)

  it("hold the module", function()
    same(keys(bw), "bw")
    same(keys(bw.array), "bw.ArrayModule")
    same(keys(bw.surface), "bw.SurfaceModule")
    same(keys(bw.mesh), "bw.MeshModule")
    same(keys(bw.eigensolver), "bw.EigensolverModule")
    same(keys(bw.json), "bw.JsonModule")
    same(keys(bw.shapes), "bw.ShapesModule")
    same(keys(bw.skeleton), "bw.SkeletonModule")
    same(keys(bw.outline), "bw.OutlineModule")
    same(keys(bw.responsive), "bw.ResponsiveModule")
    same(keys(bw.plane), "bw.PlaneModule")
    same(keys(bw.grid), "bw.GridModule")
    same(keys(bw.lp), "bw.LpModule")
    same(keys(bw.sparse_matrix), "bw.SparseMatrixModule")
    same(keys(bw.edit), "bw.EditModule")
    same(keys(bw.metamaterial), "bw.MetamaterialModule")
    same(keys(bw.plot), "bw.PlotModule")
    same(keys(bw.study), "bw.StudyModule")
    same({open = true, peak_memory = true, surroundings = true}, "bw.ResultsModule")
    same(keys(bw.scenario), "bw.ScenarioModule")
    same(keys(require("barwright.scenario.expect").methods), "bw.Expectation")
    same(keys(require("barwright.scenario.record").methods, {folder = true}), "bw.Test")
    local library = {}
    for _, name in ipairs(bw.material.names()) do library[name] = true end
    same(keys(bw.material, library), "bw.MaterialModule")
  end)

  it("hold every class of the C module", function()
    for name, class in pairs(core.classes) do
      if not inner_class[name] then
        same(keys(class.methods, class.properties), assert(class_of[name], name))
      end
    end
  end)

  it("hold the classes written in Lua, with the fields of a result", function()
    local part = bw.model {mesh = check.beam({6, 1, 1}), material = bw.material.pla}
    local loads = {force = 1, pressure = 1e6}
    local worst = assert(bw.worst_case(part, {force = 1, pressure = 1e6, modes = 2, regions = 1}))
    local brute = assert(bw.brute_force(part, {force = 1, pressure = 1e6, elements = 2}))
    local drops = assert(bw.drop_test(part, {drops = 2}))
    local function inner(object)
      local out = keys(object, getmetatable(object))
      out.analyse, out.solved = nil, nil
      return out
    end
    local sometimes = {mode = true, rank = true, upper_bound = true, gap = true, bounded = true, places = true,
      contact = true, touching = true, settled = true}
    same(inner(worst), "bw.WorstCase", sometimes)
    same(inner(brute), "bw.BruteForce")
    local breaking = assert(bw.breaking_force(bw.surface.box {min = {0, 0, 0}, max = {0.04, 0.01, 0.01}},
      {material = bw.material.pla, elements = 300, modes = 2, regions = 1}))
    same(inner(breaking), "bw.BreakingForce", {given_mesh = true, fixed_area = true, forbidden_area = true,
      singular = true})
    same(inner(drops), "bw.DropTest")
    same(keys(getmetatable(part.mesh:surface():singular_edges())), "bw.SingularPlaces")
    assert(loads)
    same(keys(bw.edit.class, bw.edit.properties), "bw.Session")
    local bone = require "barwright.edit_bone"
    same(keys(bone.class, bone.properties, {name = true, index = true, session = true}), "bw.Bone")
    local solids = require "barwright.solids"
    same(keys(solids.class, solids.properties, {grid = true, materials = true}), "bw.Solid")
    local solid_results = require "barwright.solid_results"
    same(keys(solid_results.class, solid_results.properties, {solid = true}), "bw.SolidResult")
    local bridge = require "barwright.bridge"
    same(keys(bridge.class, bridge.properties), "bw.Bridge")
    same(keys(require("barwright.plot.figure").class, {kind = true, name = true, width = true,
      height = true}), "bw.Figure")
    local one = bw.study {name = "x", variables = {{name = "a", min = 0, max = 1}}, what = "x",
      measures = {"m"}, design = {"random", count = 1}, run = function() end}
    same(keys(require("barwright.study").class, one), "bw.Study")
    same(keys(require("barwright.study.trial").class, {number = 1, key = 1, seed = 1, point = 1, study = 1,
      folder = 1}), "bw.Trial")
    same(keys(require("barwright.study.trials").class, {problem = 1, study = 1, summary = 1, stopped = 1}),
      "bw.Trials")
    same(keys(require("barwright.study.surrogate").class, {measure = 1, unit = 1, count = 1, error = 1,
      lengths = 1}), "bw.Surrogate")
    local results = assert(bw.results.open(check.folder()))
    local bound = keys(results, getmetatable(results))
    bound.open, bound.peak_memory, bound.surroundings = nil, nil, nil
    same(bound, "bw.Results")
  end)

  it("document the call of each module and object that can be called", function()
    for _, class in ipairs(all.classes) do
      local called = false
      for _, f in ipairs(class.functions) do called = called or f.name == "__call" end
      assert.equal(#class.overloads > 0, called, class.name .. ": ---@overload and :__call belong together")
    end
  end)

  it("have types that end behind quoted words with blanks", function()
    local kind, remark = stubs.split '"plane"|"free form" of a face'
    assert.equal('"plane"|"free form"', kind)
    assert.equal("of a face", remark)
  end)

  it("make the reference, which is up to date", function()
    local folder = check.folder()
    local status, _, message = check.run("'" .. check.root .. "/scripts/docs/reference.lua' " .. folder)
    assert.equal(0, status, message)
    for name, page in pairs(pages) do assert.equal(check.read(("%s/%s.md"):format(folder, name)), page) end
    assert.equal(check.read(folder .. "/index.md"), check.read(check.root .. "/docs/reference/index.md"))
    local names = assert(io.popen(("ls '%s/docs/reference' | wc -l"):format(check.root)))
    assert.equal(#all.files + 1, names:read "n", "pages without a file of lua/stubs")
    names:close()
  end)
end)
