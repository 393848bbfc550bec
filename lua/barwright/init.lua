-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright: what `require "barwright"` returns. Surfaces, meshes, materials, models and arrays come
-- from the C module; the analyses that are loops over engine calls are Lua files beside this one.
local core = require "barwright.core"
core.library() -- errors of misuse name the first line outside of this file's folder
require "barwright.original_surface"

local raise = core.raise

local bw = {
  array = core.array,
  surface = core.surface,
  mesh = core.mesh,
  material = core.material,
  solver = core.solver,
  model = core.model,
  heat = core.heat,
  eigensolver = core.eigensolver,
  element_stress = core.element_stress,
  nodal_stress = core.nodal_stress,
  surface_stress = core.surface_stress,
  surface_mean = core.surface_mean,
  von_mises = core.von_mises,
  principal = core.principal,
  max_principal = core.max_principal,
  weak_regions = core.weak_regions,
  single_regions = core.single_regions,
  pressure_basis = core.pressure_basis,
  worst_loads = core.worst_loads,
  lp = core.lp,
  rigid = core.rigid,
  operator = core.operator,
  sparse_matrix = core.sparse_matrix,
  rank_correlation = core.rank_correlation,
  rainflow = core.rainflow,
  fatigue = require "barwright.fatigue",
  picture = core.picture,
  animation = core.animation,
  canvas = core.canvas,
  plot = require "barwright.plot",
  progress = core.progress,
  threads = core.threads,
  warnings = core.warnings,
  interrupted = core.interrupted,
  sandbox = core.sandbox,
  seconds = core.seconds,
  json = require "barwright.json",
  results = require "barwright.results",
  scenario = require "barwright.scenario",
  shapes = require "barwright.shapes",
  worst_case = require "barwright.worst_case",
  worst_buckling = require "barwright.worst_buckling",
  check_certificate = require("barwright.certificate_check").check_certificate,
  brute_force = require "barwright.brute_force",
  breaking_force = require "barwright.breaking_force",
  strengthen = require "barwright.strengthen",
  drop_test = require "barwright.drop_test",
  random_drops = require "barwright.random_drops",
  skeleton = require "barwright.skeleton",
  skinning_weights = core.skinning_weights,
  subdomains = core.subdomains,
  outline = require "barwright.outline",
  responsive = require "barwright.responsive",
  plane = core.plane,
  grid = core.grid,
  hyperelastic = core.hyperelastic,
  solid = require("barwright.solids").create,
  metamaterial = {build = core.metamaterial.build, grow = core.metamaterial.grow,
    read = core.metamaterial.read},
  edit = require "barwright.edit",
  live = require("barwright.live").run,
  study = require("barwright.study").module,
  von_mises_gradient = core.von_mises_gradient,
  von_mises_slopes = core.von_mises_slopes,
  quadratic_program = core.quadratic_program,
}
require "barwright.modeller"
require "barwright.outline_fillet"
require "barwright.fields"
require "barwright.adaptive"
require "barwright.buckling"
require "barwright.nonlinear"
require "barwright.deposition"
require "barwright.harmonic"
require "barwright.random_vibration"
require "barwright.response_spectrum"
require "barwright.contact"
require "barwright.drop"
require "barwright.interface_traction"
require "barwright.joint_traction"
require "barwright.heat"
require "barwright.transient"
require "barwright.singular"
require "barwright.critical_distance"

-- The workbench uses the commands' files, which use this one.
bw.workbench = {}
function bw.workbench.open(path, options)
  return require("barwright.workbench").open(path, options)
end

-- What the prompt completes after "bw.material." beside the functions.
local library = {}
for _, name in ipairs(core.material.names()) do library[name] = true end
getmetatable(core.material).__properties = library

--- "0.1.0", and the commit it was built from ("" when it was not known).
function bw.version()
  return core.version, core.commit
end

-- __index of a table of functions: a name that it lacks raises, with what it may have been meant for.
local function named(what, functions)
  return function(_, name)
    if type(name) ~= "string" then return nil end
    local names = {}
    for known in pairs(functions) do names[#names + 1] = known end
    raise(("%s has no '%s': %s"):format(what, name, core.suggestion(name, names)))
  end
end

-- Modules that are tables of functions; those with a metatable, and classes, see to it by themselves.
for name, module in pairs(bw) do
  if type(module) == "table" and not getmetatable(module) and not rawget(module, "__index") then
    setmetatable(module, {__index = named("bw." .. name, module)})
  end
end

return setmetatable(bw, {
  __tostring = function() return "barwright " .. core.version end,
  __index = named("barwright", bw),
})
