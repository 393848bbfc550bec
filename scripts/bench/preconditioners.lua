-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Conjugate gradients on one mesh with the engine's preconditioners and with those of PETSc and hypre: processor
-- time, iterations, memory. Each row is a process of its own on one processor. Or two-level PCG on hard bodies.
local bw = require "barwright"
local script = require "barwright.command.script"
package.path = (arg[0]:match "^(.*)/" or ".") .. "/?.lua;" .. package.path
local bodies = require "bodies"
local options = require "options"

local engine, petsc = {}, {backend = "petsc"}
local kinds = { -- name, preconditioner, options of PETSc; for quadratic elements alone
  {"engine, two-level", function() return bw.solver.two_level {} end, quadratic = true},
  {"engine, multigrid", function() return bw.solver.amg(engine) end},
  {"PETSc, linear elements and GAMG", function() return bw.solver.amg(petsc) end, "", quadratic = true},
  {"PETSc, GAMG", function() return bw.solver.amg(petsc) end, "-barwright_pc_type gamg"},
  {"hypre, BoomerAMG", function() return bw.solver.amg(petsc) end, "-barwright_pc_type hypre "
    .. "-barwright_pc_hypre_boomeramg_strong_threshold 0.5 -barwright_pc_hypre_boomeramg_agg_nl 1"},
}

local opts = script.read {
  summary = "preconditioners of the engine, of PETSc and of hypre on the same mesh",
  about = "A cube of steel, fixed below, pulled above, to a residual of 1e-8. Linear elements have the nodes of "
    .. "the quadratic ones. Processor seconds contain assembly, setup, iterations and the check of the residual. "
    .. "Prints a Markdown table.",
  arguments = {{name = "cells", type = "integer", min = 2, many = true, optional = true,
    what = "cells of quadratic elements along an edge of the cube (default 12)"}},
  options = {
    {name = "here", value = "N", type = "integer", min = 1, max = #kinds,
      what = "solve with this preconditioner in this process, and print its row alone"},
    {name = "hard", type = "flag", what = "two-level PCG on boxes that it finds hard, and no comparison"},
    {name = "models", value = "DIR", type = "folder",
      what = "the same on the surfaces of this folder that scripts/bench/bodies.lua names"},
    options.containing, options.elements(8000),
    {name = "order", value = "N", type = "integer", default = 2, min = 1, max = 2,
      what = "order of elements, of --here"},
  },
}

local function measure(kind, cells, order)
  local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {cells, cells, cells},
    order = order})
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  part:fix(mesh.boundary:below(3, 0)):load {on = mesh.boundary:above(3, 1), force = {1e3, 0, -1e3}}
  local name, preconditioner = kind[1], kind[2]
  local head = ("| %d, tet%d | %s |"):format(mesh.node_count * 3, order == 1 and 4 or 10, name)
  local made, message = preconditioner()
  local processor, static = os.clock(), nil
  if made then
    static, message = part:solve {solver = bw.solver.pcg {tolerance = 1e-8, preconditioner = made}}
  end
  processor = os.clock() - processor
  if not static then
    print(head .. " – | – | – | " .. message .. " |")
    return
  end
  local peak = tonumber(io.open "/proc/self/status":read "a":match "VmHWM:%s+(%d+)") / 2 ^ 20
  print(("%s %.1f | %d | %.2f | %.1e |"):format(head, processor, static.report.iterations, peak, static.residual))
end

local function isotropic(poisson) return bw.material.isotropic {young = 1e9, poisson = poisson} end

local function fibres(contrast, axes)
  local small = 0.3 / contrast
  return bw.material.orthotropic {young = {contrast * 1e7, 1e7, 1e7}, shear = {4e6, 4e6, 4e6},
    poisson = {0.3, small, small}, axes = axes}
end

local c, s = math.cos(0.6), math.sin(0.6)
local oblique = {{c, 0.8 * s, 0.6 * s}, {-s, 0.8 * c, 0.6 * c}, {0, -0.6, 0.8}}

-- Name, cells, size (m), material, the axis along which it is fixed and loaded, formulation of the elements.
local function hard_bodies()
  local list, cube, unit = {}, {8, 8, 8}, {1, 1, 1}
  for _, wide in ipairs {2, 5, 10} do
    for layers = 1, 2 do
      list[#list + 1] = {("plate, cells %d times as wide as thick, %d layers"):format(wide, layers),
        {20, 20, layers}, {20 * wide, 20 * wide, layers}, isotropic(0.3), 1}
    end
  end
  for _, poisson in ipairs {0.3, 0.45, 0.49, 0.499} do
    list[#list + 1] = {("cube, Poisson's ratio %g"):format(poisson), cube, unit, isotropic(poisson), 3}
  end
  for _, poisson in ipairs {0.45, 0.49, 0.499, 0.4999} do
    list[#list + 1] = {("cube, B-bar, Poisson's ratio %g"):format(poisson), cube, unit, isotropic(poisson), 3,
      "b_bar"}
  end
  for _, contrast in ipairs {10, 100, 1000} do
    list[#list + 1] = {("cube, %d times as stiff along x"):format(contrast), cube, unit, fibres(contrast), 3}
    list[#list + 1] = {("cube, %d times as stiff along an oblique direction"):format(contrast), cube, unit,
      fibres(contrast, oblique), 3}
  end
  return list
end

-- Two-level PCG on a mesh that is fixed where it is lowest along an axis, and loaded where it is highest, within
-- these fractions of its size.
local function print_hard(name, mesh, material, axis, fixed, loaded, formulation)
  local part = bw.model {mesh = mesh, material = material, formulation = formulation}
  local low, high = mesh.box.min[axis], mesh.box.max[axis]
  local size = high - low
  part:fix(mesh.boundary:below(axis, low + fixed * size))
  part:load {on = mesh.boundary:above(axis, high - loaded * size), force = {1, 0.3, -1}}
  local head, processor = ("| %s | %d | %d |"):format(name, mesh.element_count, mesh.node_count * 3), os.clock()
  local static, message, details = part:solve {solver = bw.solver.pcg {}}
  processor = os.clock() - processor
  if not static and details.status == "convergence" then
    print(("%s – | %.2f | | %s |"):format(head, processor, message))
    return
  end
  local report = assert(static, message).report
  print(("%s %d | %.2f | %.0f | %s |"):format(head, report.iterations, processor, report.bytes / 1e6,
    report.reason:find "vertex stars" and "yes, stars" or report.reason:find "corners rotate" and "yes" or "no"))
end

if opts.hard or opts.models then
  print "| body | elements | unknowns | iterations | processor seconds | MB | corners rotate |"
  print "|---|---|---|---|---|---|---|"
  for _, body in ipairs(opts.hard and hard_bodies() or {}) do
    local name, cells, size, material, axis, formulation = table.unpack(body)
    local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = size, cells = cells, order = 2})
    print_hard(name, mesh, material, axis, 0, 0, formulation)
  end
  local materials = {{"ν = 0.35", isotropic(0.35)}, {"ν = 0.45", isotropic(0.45)},
    {"15 times as stiff obliquely", fibres(15, oblique)}, {"100 times as stiff obliquely", fibres(100, oblique)},
    {"1000 times as stiff obliquely", fibres(1000, oblique)}, {"ν = 0.45, B-bar", isotropic(0.45), "b_bar"},
    {"ν = 0.49, B-bar", isotropic(0.49), "b_bar"}, {"ν = 0.499, B-bar", isotropic(0.499), "b_bar"},
    {"ν = 0.4999, B-bar", isotropic(0.4999), "b_bar"}}
  for _, body in ipairs(opts.models and bodies(opts) or {}) do
    local mesh = assert(bw.mesh.fill(body.surface(), {elements = opts.elements, order = 2}))
    for _, kind in ipairs(materials) do
      print_hard(("%s, %s"):format(body.name, kind[1]), mesh, kind[2], 3, 0.02, 0.05, kind[3])
    end
  end
  return
end

if opts.here then
  if not opts.cells[1] then script.refuse "--here needs CELLS" end
  measure(kinds[opts.here], opts.cells[1], opts.order)
  return
end

local program = io.popen "readlink /proc/$PPID/exe":read "l"
print "| unknowns | preconditioner | processor seconds | iterations | GiB | residual |"
print "|---|---|---|---|---|---|"
for _, cells in ipairs(#opts.cells > 0 and opts.cells or {12}) do
  for order = 2, 1, -1 do
    for n, kind in ipairs(kinds) do
      local mpi = "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 PETSC_OPTIONS='%s' "
      local command = ("BARWRIGHT_QUIET=1 BARWRIGHT_THREADS=1 %s%s %s --here %d --order %d %d"):format(
        kind[3] and mpi:format(kind[3]) or "", program, arg[0], n, order, order == 2 and cells or 2 * cells)
      if order == 2 or not kind.quadratic then os.execute(command) end
    end
  end
end
