-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Good arguments (see good.lua) of arrays, surfaces, meshes, models, sessions, grids and solids.
local bw = require "barwright"
local good = require "good_lists"

local add, alike, path, random_mask, vector = good.add, good.alike, good.path, good.random_mask, good.vector

-- ---- arrays -------------------------------------------------------------------------------------

alike("bw.array.new bw.array()", function(_, r) return r:one_of {{1, 2, 3}, {{1, 2}, {3, 4}}}, r:one_of {"f64",
  "i32", "i64", "u8"} end)
add {
  ["bw.array.zeros"] = function(_, r) return r:integer(4), r:integer(3), r:one_of {"f64", "i32", "i64",
    "u8"} end,
  ["bw.array.range"] = function(_, r) return 1, r:integer(9), r:one_of {1, 0.5, 2, -1} end,
  ["bw.array.from_string"] = function(_, r) return r:one_of {"<f8", ">i4", "<u1", "<f4", "<i8", ">u8"},
    ("abcdefgh"):rep(4), r:integer(4) end,
  ["bw.array.map"] = function(p, r) return r:one_of {"x + k", "norm(x)", "where(x > 2, 1, 0)", "x.x", "x[1]^2",
    "hypot(x, 2)",
    "mod(x, 2) and k", "not x"}, {x = p:get("bw.Array", r), k = 3} end,
  ["Array:rows"] = function(_, r) return r:integer(3), r:one_of {2, 3, -1}, r:one_of {1, 2, -1} end,
  ["Array:columns"] = function(_, r) return 1, r:integer(3), 1 end,
  ["Array:column"] = function(_, r) return r:integer(3) end,
  ["Array:mean"] = function(p) return p.Array end,
  ["Array:dot"] = function(p) return p.Array end,
  ["Array:quantile"] = function(p, r) return r:uniform(), r:chance(0.3) and p.Array or nil end,
  ["Array:map"] = function(p, r) return r:one_of {"a + k", "norm(a)", "a > 1", "-a", "a * a"},
    {k = p.Array} end,
  ["Array:above"] = function() return 1 end,
  ["Array:below"] = function(p) return p.Array end,
  ["Array:gather"] = function() return {1, 2, 2} end,
  ["Array:select"] = function(_, r) return random_mask(3, r) end,
  ["Array:scatter"] = function(_, r) return {3, 1, 2}, 3 + r:integer(3) end,
  ["Array:tostring"] = function(_, r) return r:one_of {"<f8", ">f4", "<i4", "<u1", ">u2"}, r:one_of {0, -1,
    1} end,
}

-- ---- surfaces and meshes ------------------------------------------------------------------------

add {
  ["bw.surface.read"] = function(_, r) return "good." .. r:one_of {"stl", "obj", "off", "ply", "vtu", "msh"},
    {unit = "m"} end,
  ["bw.surface.new"] = function() return {points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    triangles = {{1, 3, 2}, {1, 2, 4}, {2, 3, 4}, {1, 4, 3}}, groups = {1, 2, 3, 4}} end,
  ["bw.surface.box"] = function() return {min = {0, 0, 0}, max = {1, 2, 3}} end,
  ["bw.surface.sphere"] = function(_, r) return {centre = vector(r), radius = 1,
    subdivisions = r:integer(2)} end,
  ["bw.surface.cylinder"] = function() return {base = {0, 0, 0}, axis = {0, 0, 1}, radius = 0.5,
    segments = 6} end,
  ["bw.surface.implicit"] = function(_, r) return r:one_of {"x^2 + y^2 + z^2 - 1", function(x, y, z)
    return x * x + y * y + z * z - 1 end,
    bw.shapes.sphere({0, 0, 0}, 0.8)}, {min = {-1.5, -1.5, -1.5}, max = {1.5, 1.5, 1.5},
      cells = 4 + r:integer(4)} end,
  ["Surface:write"] = function(_, r) return path {"stl", "obj", "ply", "off", "vtu", "msh"} (r),
    {unit = r:one_of {"m", "mm", 0.01}, ascii = r:chance(0.5)} end,
  ["Surface:repair"] = function() return {weld = 0, fill_holes = true} end,
  ["Surface:remesh"] = function(_, r) return {triangles = 20 + r:integer(20), iterations = 1} end,
  ["Surface:wrap"] = function() return {alpha = 0.5, offset = 0.1} end,
  ["Surface:weld"] = function() return 1e-9 end,
  ["Surface:scale"] = function() return 2 end,
  ["Surface:transform"] = function() return {{1, 0, 0, 0}, {0, 1, 0, 1}, {0, 0, 2, 0}} end,
  ["Surface:translate"] = function(_, r) return vector(r) end,
  ["Surface:rotate"] = function(_, r) return {0, 0, 1}, r:uniform(), vector(r) end,
  ["Surface:picture"] = function() return "out.png", {width = 64, height = 64} end,
  ["Surface:thickness"] = function() return 5 end,
  ["bw.picture"] = function(p, r) return p.Surface, "out.png", {width = 64, height = 64, edges = r:chance(0.5),
    direction = vector(r)} end,
  ["bw.animation"] = function() return "out.png", {"good.png", "good.png"}, {seconds = 0.1, rounds = 2} end,
  ["bw.mesh.fill"] = function(p) return p.Surface, {elements = 20, repair = false, remesh = false} end,
  ["bw.mesh.read"] = function(_, r) return "good." .. r:one_of {"vtu", "msh", "mesh", "inp"}, {unit = "m"} end,
  ["bw.mesh.new"] = function() return {nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, elements = {{1, 2,
    3, 4}}, regions = {1}} end,
  ["bw.mesh.box"] = function(_, r) return {min = {0, 0, 0}, max = {1, 1, 1}, cells = {r:integer(3), 1, 1},
    order = r:integer(2)} end,
  ["Mesh:write"] = function(p, r) return path {"vtu", "msh", "mesh", "node", "inp"} (r),
    r:chance(0.5) and {fields = {a = p.Mesh.volumes, b = {p.Mesh.volumes, on = "elements"}}} or nil end,
  ["Mesh:with_order"] = function(_, r) return r:integer(2) end,
  ["Mesh:moved"] = function(p) return p.Mesh.nodes end,
  ["Mesh:scale"] = function() return 2 end,
  ["Mesh:subset"] = function(p, r) return random_mask(p.Mesh.element_count, r) end,
  ["Mesh:locate"] = function(_, r) return vector(r) end,
  ["Mesh:sample"] = function(p, r) return p.Mesh.nodes, {vector(r), vector(r)} end,
  ["Mesh:to_nodes"] = function(p, r) return p.Mesh.volumes, r:one_of {"mean", "max"} end,
  ["Mesh:shapes"] = function(p) return p.Mesh.nodes end,
  ["Mesh:shape_check"] = function(p, r) return p.Mesh.nodes, r:uniform() end,
  ["Mesh:relax"] = function(p, r) return p.Mesh.nodes, random_mask(p.Mesh.node_count, r) end,
  ["Mesh:refill"] = function(p, r) return p.Mesh.nodes, random_mask(p.Mesh.element_count, r) end,
  ["Mesh:picture"] = function(p) return "out.png", {width = 64, height = 64, values = p.Mesh.node_volumes} end,
}
alike("Selection:below Selection:above", function(_, r) return r:one_of {1, 2, 3, "x", "y", "z"},
  r:uniform() end)
alike("Selection:near Selection:sphere", function(_, r) return {r:uniform(), 0, 0}, 0.5 end)
alike("Selection:plane Selection:beyond", function() return {0, 0, 0}, {1, 0, 0} end)
alike("Selection:union Selection:intersection Selection:difference Selection#bor Selection#band Selection#sub",
  function(p, r)
  return p:variant("bw.Selection", r:integer(3)) end)
add {
  ["Selection:box"] = function() return {-0.1, -0.1, -0.1}, {0.6, 1, 1} end,
  ["Selection:facing"] = function(_, r) return r:one_of {{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}}, 0.1 end,
  ["Selection:patch"] = function() return {0, 0, 0}, 0.5 end,
  ["Selection:nearest"] = function(_, r) return vector(r), 2 end,
  ["Selection:where"] = function(p, r) return r:one_of {"x < 0.5", function(x) return x < 0.5 end,
    random_mask(p.Mesh.node_count, r)} end,
}

-- ---- materials, models, solutions ---------------------------------------------------------------

local rotation = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}
alike("bw.element_stress bw.nodal_stress", function(p) return p.Mesh, bw.material.steel,
  p.Static.displacement end)
alike("bw.von_mises bw.principal bw.max_principal Material:utilisation", function() return bw.array.zeros(2,
  6) end)
add {
  ["bw.material.isotropic"] = function() return {young = 1e9, poisson = 0.3, density = 1000, strength = 1e6,
    name = "m"} end,
  ["bw.material.orthotropic"] = function() return {young = {1e9, 2e9, 3e9}, poisson = {0.3, 0.2, 0.1},
    axes = rotation} end,
  ["bw.material.named"] = function(_, r) return r:one_of {"steel", "zp150", "stel"} end,
  ["Material:rotated"] = function() return rotation end,
  ["Material:strength_along"] = function(_, r) return vector(r) end,
  ["bw.model"] = function(p) return {mesh = p.Mesh, material = bw.material.steel} end,
  ["Model:fix"] = function(p) return p.Selection end,
  ["Model:slide"] = function(p, r) return p:variant("bw.Selection", 2), r:chance(0.5) and {0, 0, 1} or nil end,
  ["Model:symmetry"] = function(p, r)
    return p:variant("bw.Selection", 2), r:one_of {"symmetric", "antisymmetric"}
  end,
  ["Model:prescribe"] = function(p) return p.Selection, {0.01, false, 0} end,
  ["Model:cyclic"] = function(p, r)
    return {low = p.Selection, high = p:variant("bw.Selection", 2), count = r:one_of {4, 5}}
  end,
  ["Model:bond"] = function(p, r)
    return {a = p.Selection, b = p:variant("bw.Selection", 2), gap = r:one_of {0, 1e-3},
      preload = r:chance(0.3) and 10 or nil}
  end,
  ["Heat:bond"] = function(p, r)
    return {a = p.Selection, b = p:variant("bw.Selection", 2), gap = r:one_of {1e-3, 1}}
  end,
  ["Model:attach"] = function(p, r)
    local on = p:variant("bw.Selection", 2)
    return r:one_of {{on = on, mass = 0.1}, {on = on, spring = {1e3, 0, 1e6}}}
  end,
  ["Model:couple"] = function(p, r)
    local on = p:variant("bw.Selection", 2)
    return r:one_of {{on = on, force = {1, 0, 2}}, {on = on, kind = "rigid", at = {0.1, 0, 0}, mass = 1},
      {on = on, displacement = {0, false, 1e-4}, rotation = {false, 0, 0}},
      {on = on, spring = {1e3, 0, 1e6}, inertia = {1, 1, 2}}}
  end,
  ["Model:gravity"] = function() return {0, 0, -9.81} end,
  ["Model:load"] = function(p, r)
    local on = p:variant("bw.Selection", 2)
    return r:one_of {{on = on, force = {1, 0, 0}}, {on = on, pressure = 5}, {on = on, traction = {0, 1, 0}},
      {on = on, torque = {1, 0, 0}, about = {0, 0, 0}}, {nodal = bw.array.zeros(p.Mesh.node_count, 3)}}
  end,
  ["Model:temperature"] = function(p, r) return r:one_of {20, bw.array.zeros(p.Mesh.node_count)}, 1e-5 end,
  ["Model:solve"] = function(_, r)
    if r:chance(0.2) then
      return {error = 0.2, of = r:one_of {"von_mises", "displacement", {0, 0, 0}}, max_elements = 2000}
    end
    return {solver = r:one_of {"auto", bw.solver.cholesky(), bw.solver.cholesky {backend = "cholmod"},
      bw.solver.pcg(), bw.solver.pcg {preconditioner = bw.solver.jacobi()}}, inertia_relief = r:chance(0.5)}
  end,
  ["Model:refined"] = function(p, r)
    local mesh = p.Model.mesh
    return bw.array.zeros(mesh.element_count) + (r:integer(3) - 1), {order = 2, also = {mesh.boundary}}
  end,
  ["Model:modes"] = function(_, r) return {count = r:integer(3), laplacian = r:chance(0.3),
    sturm = r:chance(0.3), seed = 2} end,
  ["Model:moved"] = function(p) return p:get("bw.Mesh") end,
  ["Model:transferred"] = function(p) return p.Mesh, bw.array.range(1, p.Mesh.node_count) end,
  ["Model:write_inp"] = function(_, r) return "out.inp", {modes = r:integer(3) - 1} end,
  ["Static:effective_stress"] = function(_, r) return {length = 0.1, method = r:one_of {"line", "point"}} end,
  ["Static:fillet_stress"] = function() return {radius = 0.05} end,
  ["Static:reaction_on"] = function(p) return p.Selection end,
  ["Static:write"] = function(p) return "out.vtu", {fields = {mine = p.Mesh.volumes}} end,
  ["Static:picture"] = function(_, r) return "out.png", {width = 64, height = 64, field = r:one_of {"von_mises",
    "displacement", "utilisation"}} end,
  ["Modes:shape"] = function() return 1 end,
  ["Modes:write"] = function() return "out.vtu" end,
  ["Modes:picture"] = function() return 1, "out.png", {width = 64, height = 64} end,
  ["System:matrix"] = function(_, r) return r:one_of {"stiffness", "mass"}, {whole = r:chance(0.5)} end,
  ["System:right_hand_side"] = function(p) return bw.array.zeros(p.Mesh.node_count, 3) end,
  ["bw.sparse_matrix.new"] = function() return 2, 3, {1, 2}, {3, 1}, {0.5, 2} end,
  ["SparseMatrix:apply"] = function() return {1, 2} end,
  ["SparseMatrix:solve"] = function(p, r) return {1, 2}, {guess = r:chance(0.3) and {1, 1} or nil,
    solver = r:one_of {bw.solver.cholesky(), bw.solver.pcg(), bw.solver.cholesky {precision = 32}, "auto"},
    preconditioner = r:chance(0.2) and p:variant("bw.Operator", 2) or nil} end,
  ["SparseMatrix:inverse"] = function(_, r) return r:one_of {bw.solver.cholesky(), bw.solver.jacobi()} end,
  ["SparseMatrix:eigenpairs"] = function(p, r) return {count = r:integer(3), shift = r:one_of {0, -1},
    mass = r:chance(0.3) and p.SparseMatrix or nil, solver = r:one_of {bw.eigensolver.lanczos(),
      bw.eigensolver.arpack(), bw.eigensolver.lobpcg(), "auto"}} end,
  ["bw.operator"] = function(_, r) return {size = 3, name = "mine", apply = function(x)
    return r:chance(0.1) and {1, 2} or 2 * x
  end} end,
  ["Operator:apply"] = function() return {1, 2, 3} end,
  ["Operator:solve"] = function(p, r) return {1, 2, 3}, {solver = r:one_of {bw.solver.pcg(), "auto"},
    preconditioner = r:chance(0.3) and p.Operator or nil} end,
  ["Operator:eigenpairs"] = function(p, r) return {count = r:integer(3), test = r:chance(0.5),
    mass = r:chance(0.3) and p.Operator or nil} end,
  ["Eigenpairs:vector"] = function() return 1 end,
  ["SparseMatrix:write"] = function(_, r) return "made." .. r:one_of {"mtx", "npz"} end,
  ["Array:write"] = function(_, r) return "made." .. r:one_of {"mtx", "npy"} end,
  ["ContactSystem:solve"] = function(p) return bw.array.zeros(p.ContactSystem.mesh.node_count, 3) end,
  ["ContactSystem:in_state"] = function(_, r) return r:one_of {"closed", "open"} end,
  ["System:solve"] = function(p) return bw.array.zeros(p.Mesh.node_count, 3) end,
  ["System:modes"] = function() return {count = 1} end,
  ["bw.weak_regions"] = function(p) return p.Mesh, bw.material.pla, p.Modes, {regions = 2, fraction = 0.1} end,
  ["bw.single_regions"] = function(p) return p.Mesh, {1, 3}, -1 end,
  ["bw.pressure_basis"] = function(p, r) return p.Mesh, {friction = r:one_of {0, 0.3}, friction_facets = 3,
    forbidden = r:chance(0.5) and p.Mesh.boundary:facing {0, 0, 1} or nil} end,
  ["bw.worst_loads"] = function(p, r) return p:variant("bw.System", 2), p.PressureBasis, p.WeakRegions,
    {pressure = 1e6, force = 1, lp = r:one_of {bw.lp.dual_simplex {}, bw.lp.glpk {}, "auto"},
      keep_pressures = true} end,
  ["bw.worst_case"] = function(p, r) return p:variant("bw.Model", 3), {force = 1, contact = r:one_of {1e-6, 1e-3},
    modes = 1, regions = 1, friction = r:one_of {0, 0.3}, friction_facets = 4} end,
  ["bw.check_certificate"] = function()
    local cube = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.01, 0.01, 0.01}, cells = {1, 1, 1}})
    assert(bw.worst_case(bw.model {mesh = cube, material = bw.material.pla}, {force = 1, modes = 1, regions = 1,
      certify = 0.5, certificate = "proof.txt"}))
    return "proof.txt"
  end,
  ["bw.breaking_force"] = function(p) return p.Mesh, {material = bw.material.pla, modes = 1, regions = 1} end,
  ["bw.brute_force"] = function(p) return p:variant("bw.Model", 3), {force = 1, pressure = 1e6,
    elements = 2} end,
  ["bw.drop_test"] = function(p) return p:variant("bw.Model", 3), {drops = 2} end,
  ["bw.rank_correlation"] = function(p) return p.Array, p.Array end,
  ["bw.von_mises_gradient"] = function(p) return p.Model, p.System, p.Static.displacement, {1, 5} end,
  ["bw.von_mises_slopes"] = function(p) return p.Model, p.System, p.Static.displacement, {1, 5},
    {p.Mesh.nodes} end,
  ["bw.quadratic_program"] = function() return {H = {{2, 0}, {0, 1}}, g = {-2, -1}, A = {{1, 1}}, b = {1},
    min = {0, 0}, max = {5, 5}} end,
  ["WorstCase:picture"] = function() return "out.png", {width = 64, height = 64} end,
  ["WorstCase:report"] = function() return "out.html", {loads = 1, modes = 1, title = "t"} end,
  ["WorstCase:write"] = function() return "out.vtu" end,
  ["WorstBuckling:picture"] = function() return "out.png", {width = 64, height = 64} end,
  ["WorstBuckling:write"] = function() return "out.vtu" end,
  ["WorstBuckling:arrows"] = function() return 1, 0.2 end,
  ["WorstCase:arrows"] = function() return 1, 0.2 end,
  ["WeakRegions:objective"] = function() return 1, bw.material.pla end,
  ["PressureBasis:force"] = function(p) return bw.array.zeros(p.PressureBasis.count) end,
  ["PressureBasis:nodal"] = function(p) return bw.array.zeros(p.PressureBasis.count) end,
  ["PressureBasis:gradient"] = function(p) return bw.array.zeros(p.Mesh.node_count, 3) end,
  ["PressureBasis:maximise"] = function(p) return p:variant("bw.System", 2), bw.array.range(1,
    p.PressureBasis.count),
    {pressure = 1e6, force = 1} end,
  ["PressureBasis:arrows"] = function(p) return bw.array.range(1, p.PressureBasis.count), 0.2 end,
  ["BruteForce:compare"] = function(p) return p.WorstCase, 99 end,
  ["BruteForce:percentile"] = function() return 90 end,
  ["DropTest:correlation"] = function(p) return p.WorstCase end,
  ["DropTest:picture"] = function() return "out.png", {width = 64, height = 64} end,
  ["DropTest:write"] = function() return "out.vtu" end,
  ["Model:nonlinear"] = function() return {steps = 2} end,
  ["Nonlinear:path"] = function() return 1 end,
  ["Nonlinear:reaction_on"] = function(p) return p.Mesh.boundary:below(1, 0) end,
  ["Nonlinear:write"] = function() return "out.vtu" end,
  ["Nonlinear:write_history"] = function() return "out.csv" end,
  ["Nonlinear:picture"] = function() return "out.png", {width = 64, height = 64} end,
  ["Model:drop"] = function() return {down = {-1, -2, -3}, samples = 2} end,
  ["bw.random_drops"] = function(p) return p:variant("bw.Model", 3), {drops = 2, samples = 2} end,
  ["RandomDrops:correlation"] = function(p) return p.RandomDrops.mean_peak end,
  ["RandomDrops:picture"] = function() return "out.png", {width = 64, height = 64} end,
  ["RandomDrops:write"] = function() return "out.vtu" end,
}
alike([[WorstBuckling:pressure WorstBuckling:nodal_force WorstBuckling:displacement WorstBuckling:factors]],
  function() return 1 end)
alike([[WeakRegions:elements WeakRegions:weights WorstCase:pressure WorstCase:force WorstCase:displacement
  WorstCase:stress]],  function() return 1 end)

-- ---- skeletons and sessions ---------------------------------------------------------------------

local function maps(p) return (p.Skeleton:pose_maps(p.Skeleton:rest_pose())) end
local function bone(_, r) return r:one_of {"upper", "lower", 1, 2} end
alike("Skeleton:bone Skeleton:remove Session:bone", bone)
alike("Skeleton:joint Skeleton:with_root", function(_, r) return r:one_of {"a", "b", "c", 1, 2} end)
alike("Skeleton:posed_joints Subdomains:posed_nodes", function(p) return maps(p) end)
alike("Subdomains:touched Subdomains:stiffness_subdomains_touched",
  function(p, r) return random_mask(p.Mesh.node_count, r) end)
add {
  ["bw.skeleton.create"] = function() return {joints = {a = {0, 0, 0}, b = {1, 0, 0}}, bones = {{"a", "b",
    name = "x"}}, root = "a"} end,
  ["bw.skeleton.extract"] = function(p) return p.Surface, {bones = 1, minutes = 0.01} end,
  ["bw.skeleton.read"] = function() return "good.tgf", {unit = "mm"} end,
  ["Skeleton:write"] = function() return "out.tgf", {unit = "m"} end,
  ["Skeleton:insert_joint"] = function(p, r) return bone(p, r), r:uniform(), "mid" end,
  ["Skeleton:move_joint"] = function(_, r) return "b", vector(r) end,
  ["Skeleton:merge"] = function() return "upper", "lower" end,
  ["Skeleton:pose_maps"] = function(p) return p.Skeleton:rest_pose() end,
  ["Skeleton:reach"] = function(p, r) return p.Skeleton:rest_pose(), {{bone = r:integer(2), at = vector(r),
    weight = 1}},
    r:chance(0.3) and {{1, -1, 1}, false} or nil, 1e-3 end,
  ["bw.skinning_weights"] = function(p) return p.Mesh, p.Skeleton, {heat = 20} end,
  ["bw.subdomains"] = function(p) return p.Mesh, p.Skeleton, (bw.skinning_weights(p.Mesh, p.Skeleton)),
    {threshold = 0.9, fraction = 0.2} end,
  ["Subdomains:assign"] = function(p, r) return {r:integer(p.Mesh.element_count)}, bone(p, r) end,
  ["Subdomains:refilled"] = function(p, r) return maps(p), random_mask(p.Mesh.element_count, r), p.Mesh,
    bw.array.range(1, p.Mesh.node_count), bw.array.range(1, p.Mesh.element_count) end,
  ["Subdomains:pose_derivative"] = function(p, r) return p.Skeleton:rest_pose(), bone(p, r), r:one_of {1, 2,
    "z"} end,
  ["Subdomains:motion"] = function(p) return p.Skeleton:pose_maps(p.Skeleton:rest_pose()) end,
  ["bw.edit()"] = function(p, r) return p.Model, {skeleton = p.Skeleton, threshold = 0.9,
    relax = r:chance(0.5)} end,
  ["bw.edit.load"] = function(p) return "good.lua", p.Session end,
  ["bw.edit.begin"] = function(p) return "good.lua", p.Session end,
  ["Session:pose"] = function(_, r) return {upper = {scale = {1, 1.1, 0.9}},
    lower = {rotation = {x = 10 * r:uniform()}, translation = {0.01, 0, 0}}} end,
  ["Session:reach"] = function(_, r) return "c", {1, 0.2 * r:uniform(), 0}, {tolerance = 1e-3} end,
  ["Session:limit"] = function(p, r) return bone(p, r), {swing = 30, twist = {-10, 10}} end,
  ["Session:assign"] = function(p, r) return {r:integer(p.Mesh.element_count)}, r:chance(0.7) and bone(p, r)
    or nil end,
  ["Session:adopt"] = function(p) return p.Session:fork() end,
  ["Session:commit"] = function(p) return {script = "x", pose = p.Skeleton:rest_pose()} end,
  ["Session:solve"] = function(_, r) return {solver = r:one_of {"auto", bw.solver.cholesky(),
    bw.solver.cholesky {full = true}, bw.solver.cholesky {backend = "cholmod"}, bw.solver.pcg(),
    bw.solver.pcg {preconditioner = bw.solver.cholesky()}}, precision = r:one_of {32, 64},
    check = r:chance(0.2)} end,
  ["Session:optimise"] = function(_, r) return {von_mises = r:one_of {1e12, 1e4, 1e3}, iterations = 1,
    bones = {"lower"}} end,
  ["Session:moved"] = function(p) return p:variant("bw.Model", 1) end,
  ["Session:write"] = function() return "out.vtu", {fields = {}} end,
  ["Session:picture"] = function() return "out.png", {width = 64, height = 64, field = "von_mises"} end,
  ["Session:report"] = function() return "out.html", {title = "t", manifest = {a = 1}} end,
  ["Session:save"] = function() return "out.lua" end,
  ["Bone:scale"] = function(_, r) return r:one_of {1.1, {1, 1.1, 0.9}} end,
  ["Bone:rotate"] = function(_, r) return r:one_of {{x = 5}, {axis = {0, 0, 1}, degrees = 10}, {axis = {0, 1,
    0}, radians = 0.1}, rotation} end,
  ["Bone:translate"] = function(_, r) return {0.01 * r:uniform(), 0, 0} end,
  ["Bone:set"] = function() return {scale = {1, 1.2, 1}, rotation = {z = 5}, translation = {0, 0, 0.01}} end,
  ["IncrementalSystem:update"] = function(p) return p.Session.part,
    (p.Subdomains:motion(p.Skeleton:pose_maps(p.Skeleton:rest_pose()))) end,
  ["IncrementalSystem:solve"] = function(p) return bw.array.zeros(p.Mesh.node_count, 3), {solver = "auto"} end,
  ["IncrementalSystem:statics"] = function(p) return p.Session.part, {solver = "auto"} end,
  ["IncrementalSystem:refactor"] = function() return {} end,
  ["bw.live"] = function(p, r) return p.Outline, {port = r:integer(70000)} end,
  ["LiveServer:serve"] = function() return "a.html", "text/html", "bytes", "a.html" end,
  ["LiveServer:send"] = function(_, r) return r:integer(3), "bytes", {binary = true, replace = "key"} end,
  ["LiveServer:disconnect"] = function() return 1, 1000, "session over" end,
  ["LiveServer:receive"] = function() return 0 end,
}

-- ---- grids, solids, libraries -------------------------------------------------------------------

local function region(p, r)
  return r:one_of {{side = "min x"}, {min = {0, 0, 0}, max = {0.6, 1, 1}}, {centre = {0.5, 0.2, 0.2},
    radius = 0.4},
    {boundary = true}, {where = "x < 0.5"}, "x > 0.2", function(x) return x < 0.7 end, {plane = {{0, 0, 0}, {1,
      0, 0}}},
    {inside = p.Surface}}
end
local function laws() return {bw.hyperelastic {young = 1e5, poisson = 0.3, density = 1000},
  bw.hyperelastic {young = 1e6, poisson = 0.3, density = 1000}} end
add {
  ["bw.grid.box"] = function(_, r) return {size = {1, 1, 1}, cells = {2, 1, r:integer(3)},
    material = r:one_of {1, "where(x > 0.5, 2, 1)",
    function() return 1 end}} end,
  ["bw.grid.voxels"] = function(p, r) return p:variant("bw.Surface", 2), {cells = 2 + r:integer(3), multiple = 2,
    min_fraction = 0.1, material = 1} end,
  ["bw.grid.picture"] = function(p) return "out.png", {{grid = p.Grid, title = "a"}, {grid = p.Grid}},
    {width = 64, height = 64} end,
  ["Grid:set"] = function(p, r) return r:one_of {1, {1, 2}, region(p, r)}, r:integer(3) - 1,
    {void = r:chance(0.3)} end,
  ["Grid:nodes"] = region,
  ["Grid:cells_in"] = function(p, r) return region(p, r), {void = true} end,
  ["Grid:coarse"] = function() return 1 end,
  ["Grid:embed"] = function(p, r) return r:one_of {p:variant("bw.Surface", 2), {{0.2, 0.2, 0.2}}},
    {reach = 3} end,
  ["Grid:difference"] = function(p) return bw.array.zeros(p.Grid.node_count, 3),
    bw.array.zeros(p.Grid.node_count, 3) end,
  ["Grid:picture"] = function(p) return "out.png", {width = 64, height = 64, values = bw.array.range(1,
    p.Grid.node_count)} end,
  ["Grid:same_elements"] = function(p) return p.Grid end,
  ["Grid:write"] = function(p) return "out.vtu", {fields = {a = bw.array.range(1, p.Grid.node_count)}} end,
  ["Embedding:values"] = function(p) return bw.array.zeros(p.Grid.node_count, 3) end,
  ["Embedding:forces"] = function(p) return bw.array.zeros(p.Embedding.point_count, 3) end,
  ["Embedding:moved"] = function(p) return bw.array.zeros(p.Grid.node_count, 3) end,
  ["bw.hyperelastic"] = function(_, r) return {law = r:one_of {"neo_hookean", "st_venant_kirchhoff",
    "corotated", "fixed_corotated"}, young = 1e6,
    poisson = 0.3, density = 1000} end,
  ["Hyperelastic:energy"] = function() return {{1.1, 0, 0}, {0, 1, 0.1}, {0, 0, 0.9}} end,
  ["MaterialTable:material"] = function() return 1 end,
  ["bw.solid"] = function(p) return {grid = p.Grid, materials = laws()} end,
  ["Solid:fix"] = function(p, r) return region(p, r), r:one_of {{0, 0, 0}, {0.01, false, 0}, function()
    return 0, 0, 0.01 end} end,
  ["Solid:rotate"] = function(p, r) return region(p, r), {axis = {1, 0, 0}, angle = 10, point = {0, 0, 0},
    move = {0.01, 0, 0}} end,
  ["Solid:force"] = function(p, r) return region(p, r), {0, 0, -1} end,
  ["Solid:gravity"] = function() return {0, 0, -9.81} end,
  ["Solid:pressure"] = function(p, r) return r:one_of {{side = "max x"}, p:variant("bw.Surface", 2)},
    {pressure = r:one_of {5, function(x) return x end},
    follower = r:chance(0.5)} end,
  ["Solid:contact_plane"] = function() return {point = {0, 0, -0.01}, normal = {0, 0, 1}, move = {0, 0, 0.02}} end,
  ["Solid:solve"] = function(_, r) return {solver = r:one_of {"auto", bw.solver.cholesky(),
    bw.solver.pcg {preconditioner = bw.solver.jacobi()}, bw.solver.pcg()},
    steps = r:integer(2), path = r:integer(2)} end,
  ["Solid:transient"] = function(_, r) return {scheme = r:one_of {"implicit_euler", "newmark"}, step = 0.01,
    iterations = 2, mass_damping = 0.1} end,
  ["Solid:with"] = function(p) return (p.Grid:set({1}, 2)) end,
  ["Solid:coarsen"] = function(p, r) return r:one_of {"naive", "average", p.Library}, 1 end,
  ["SolidResult:error"] = function(p) return p.SolidResult end,
  ["SolidResult:total_reaction"] = region,
  ["SolidResult:write"] = function() return "out.vtu" end,
  ["SolidResult:picture"] = function() return "out.png", {width = 64, height = 64, values = "von_mises"} end,
  ["SolidResult:panel"] = function(_, r) return "t", r:one_of {"von_mises", "movement"} end,
  ["bw.metamaterial.build"] = function(_, r) return laws(), {directions = 4, magnitudes = 1, stretches = 4,
    voids = r:chance(0.2), seed = 3,
    representatives = 1} end,
  ["bw.metamaterial.grow"] = function(p, r) return r:one_of {laws(), p.Library}, p.Grid, {directions = 4,
    magnitudes = 1, seed = 3, stretches = 4} end,
  ["bw.metamaterial.read"] = function() return "good.bwm" end,
  ["Library:write"] = function() return "out.bwm" end,
  ["Library:material"] = function() return {1, 1, 2, 1, 2, 2, 1, 2} end,
}
