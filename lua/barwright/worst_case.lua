-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The worst-case analysis: modes -> weak regions -> worst loads -> stresses (Zhou, Panetta, Zorin 2013),
-- then the search beside the modes (worst_search.lua), from one factorisation. With a length, patch_search.lua
-- searches the largest mean over surface patches instead.
-- docs/theory/worst_case.md explains why.
local arguments = require "barwright.arguments"
local certificate = require "barwright.certificate"
local core = require "barwright.core"
local has_strength = require "barwright.has_strength"
local judged_stress = require "barwright.judged_stress"
local load_limits = require "barwright.load_limits"
local options = require "barwright.options"
local patch_search = require "barwright.patch_search"
local solver_reports = require "barwright.solver_reports"
local worst_contact = require "barwright.worst_contact"
local worst_search = require "barwright.worst_search"
local writable = require "barwright.writable"
local shown = require "barwright.shown"

local raise = core.raise

local worst_case = {}
worst_case.__index = worst_case
worst_case.__name = "barwright.worst_case"

local rules = load_limits.rules {
  method = {type = "string", one_of = {"search", "paper"}},
  certify = {type = "number", min = 0.001, max = 0.5},
  certificate = {type = "string"},
  targets = {type = "integer", default = 48, min = 1, max = 100000},
  modes = {type = "integer", default = 15, min = 1, max = 500},
  regions = {type = "integer", default = 5, min = 1, max = 1000},
  length = {type = "number", above = 0},
  failure = {type = "string", one_of = {"principal", "von_mises"}},
  pairs = {type = "table"},
  places = {type = "table"},
  screening = {type = "boolean", default = true},
  fraction = {type = "number", default = 0.025, above = 0, max = 1},
  measure = {type = "string", default = "stress", one_of = {"stress", "energy"}},
  target = {type = "string", default = "stress", one_of = {"stress", "displacement"}},
  laplacian = {type = "boolean", default = false},
  one_sign = {type = "boolean", default = false},
  tolerance = {type = "number", above = 0},
  sturm = {type = "boolean", default = false},
  seed = {type = "integer", default = 1},
  solver = {type = "solver", auto = true},
  eigensolver = {type = "eigensolver", auto = true},
  batch = {type = "integer", default = 0, min = 0},
}

-- Centres of elements, from copies of the mesh's arrays taken once.
local function centres(mesh)
  local elements, nodes = mesh.elements, mesh.nodes
  return function(element)
    local x, y, z = 0, 0, 0
    for corner = 1, 4 do
      local node = elements(element, corner)
      x, y, z = x + nodes(node, 1), y + nodes(node, 2), z + nodes(node, 3)
    end
    return {x / 4, y / 4, z / 4}
  end
end

local labels = {element = "screening, element %d", ascent = "ascent, element %d",
  bound = "branch and bound, element %d", patch = "patch around node %d"}

-- What a load was found from: a weak region of a mode, an element of the screening, an ascent, the
-- search of the upper bound, or a patch of the boundary.
local function source(self, weak, origins, i)
  local number = weak and (i <= weak.count and i or origins[i].weak)
  if number then
    local region = weak[number]
    return {origin = "mode", mode = region.mode, rank = region.rank, elements = region.count,
      volume = region.volume, energy = region.energy,
      label = ("mode %d, region %d"):format(region.mode, region.rank)}
  end
  local found = origins[i]
  return {origin = found.origin, target = found.target, from = found.from, elements = found.elements or 1,
    volume = found.volume or self.mesh.volumes[found.target], label = labels[found.origin]:format(found.target)}
end

local function region_list(self, weak, loads, origins)
  local total, centre = self.mesh.volume, centres(self.mesh)
  local list, judged = {}, has_strength(self.material)
  for i = 1, loads.peaks.row_count do
    local region = source(self, weak, origins, i)
    region.volume_fraction = region.volume / total
    region.max_principal, region.element = loads.peaks[i], loads.peak_elements[i]
    region.at = centre(loads.peak_elements[i])
    if judged then
      region.utilisation = loads.utilisations[i]
      if loads.utilised_elements[i] > 0 then region.utilised_at = centre(loads.utilised_elements[i]) end
    end
    region.displacement, region.objective = loads.displacements[i], loads.objectives[i]
    region.seconds, region.flipped = loads.seconds[i], loads.flipped[i] ~= 0
    list[i] = region
  end
  return list
end

-- The equations, ready for many right-hand sides. An eigensolver on the inverse needs a factor.
local function system_of(part, opts)
  local name = opts.eigensolver and opts.eigensolver.name
  local inverse = name == "lanczos" or name == "arpack"
  local system, message, details = load_limits.system(part,
    opts.solver or inverse and core.solver.cholesky() or nil)
  if not system then return nil, message, details end
  if inverse and system.report.solver == "pcg" then
    raise(("worst_case: eigensolver '%s' needs a factor, which the solver pcg does without"):format(name))
  end
  return system
end

-- What counts as worst: the utilisation where strengths are known, else the stress;
-- for displacement as the target, the displacement.
local function find_worst(self, loads)
  if self.options.target == "displacement" then return (loads.displacements:argmax()) end
  local used = has_strength(self.material) and loads.utilisations:max() or 0
  return (used > 0 and loads.utilisations or loads.peaks):argmax()
end

local function summarise(self, loads, origins)
  self.loads, self.origins = loads, origins
  self.regions = region_list(self, self.weak_regions, loads, origins)
  self.region = find_worst(self, loads)
  local worst = self.regions[self.region]
  self.max_principal, self.at, self.element = worst.max_principal, worst.at, worst.element
  self.origin, self.mode, self.rank = worst.origin, worst.mode, worst.rank
  self.max_displacement = loads.displacements:max()
  self.solve_error = worst.max_principal > 0 and loads.solve_errors[self.region] / worst.max_principal or 0
  self.reports.solver = self.system.report
  if has_strength(self.material) then
    self.strength = self.material.strength
    self.utilisation = loads.utilisations:max()
  end
  self.weakness, self.worst_region = loads.weakness, loads.worst_region
  self.pressures = loads.pressures
  self.friction_error = load_limits.friction_error(self.options)
end

-- From rows of stress tensors to stress over strength; without a strength, to stress.
local function criterion_of(material, failure)
  local scale = type(material.strength) == "number" and 1 / material.strength or 1
  if failure == "von_mises" then return function(stress) return core.von_mises(stress) * scale end end
  if material.strength then return function(stress) return material:utilisation(stress) end end
  return core.max_principal
end

-- The loads of the largest mean stresses over patches, from loads at hand or places that are known.
local function search_patches(self, opts, loads)
  local start = core.seconds()
  local screening_basis, message, details = load_limits.without_friction(self.mesh, opts, self.basis)
  if not screening_basis then return nil, message, details end
  self.limits = load_limits.linear_program(opts)
  self.limits.batch = opts.batch
  local found
  found, message, details = patch_search.run({mesh = self.mesh, material = self.material, system = self.system,
    basis = self.basis, screening_basis = screening_basis, limits = self.limits, radius = opts.length,
    reports = self.reports,
    measure = criterion_of(self.material, opts.failure), loads = loads, known = opts.places,
    screening = opts.screening})
  if not found then return nil, message, details end
  self.seconds.search = core.seconds() - start
  self.search, self.places = found, found.places
  summarise(self, found.loads, found.origins)
  return self
end

-- What a joined part has no answer to; true, or nil, a message and details for a sector.
local function check_joined(part, opts)
  if part.cyclic_symmetry then return core.refuse_joints(part) end
  if not load_limits.is_joined(part) then return true end
  for _, name in ipairs {"certificate", "length", "laplacian"} do
    if opts[name] then
      raise(("worst_case: option '%s' is for parts without bonds, attachments and couplings: leave it out"):format(
        name))
    end
  end
  return true
end

-- What parts in contact have no answer to.
local function check_contact(opts, view)
  if view then raise "worst_case: option 'pairs' is for parts: an edit session has no contact" end
  for _, name in ipairs {"certify", "length"} do
    if opts[name] then
      raise(("worst_case: option '%s' is for parts without contact: leave it out, or the 'pairs'"):format(name))
    end
  end
  if opts.target == "displacement" then
    raise "worst_case: option 'pairs' is for target \"stress\": with contact no displacement is maximised"
  end
end

local function are_places(given)
  if not options.countable(given) or #given == 0 then return false end
  for _, place in ipairs(given) do
    if type(place) ~= "table" or type(place.at) ~= "table" or core.class_name(place.stress) ~= "array" then
      return false
    end
  end
  return true
end

--- Where a part breaks, under the worst loads that are found. Returns nil, message, details when it cannot tell.
--- `view`: its equations, where they are at hand (those that a session follows edits with).
function worst_case.analyse(part, given, view)
  options.object("worst_case", "part", part, "model")
  local opts = options.read("worst_case", given, rules)
  if opts.method == "search" and opts.target == "displacement" then
    raise("worst_case: method \"search\" maximises stress; for target \"displacement\" give method \"paper\"")
  end
  if opts.certify and opts.target == "displacement" then
    raise "worst_case: option 'certify' bounds the stress: it is not for target \"displacement\""
  end
  if opts.certificate and not opts.certify then
    raise "worst_case: option 'certificate' is a file that proves the bound of option 'certify'"
  end
  local ok, message, details
  if opts.certificate then
    ok, message, details = writable(opts.certificate)
    if not ok then return nil, message, details end
  end
  ok, message, details = check_joined(part, opts)
  if not ok then return nil, message, details end
  if opts.pairs then check_contact(opts, view) end
  if opts.length and (opts.method or opts.certify or opts.target == "displacement") then
    raise "worst_case: option 'length' has its own search: leave out 'method', 'certify' and 'target'"
  end
  if opts.failure and not opts.length then
    raise "worst_case: option 'failure' judges the mean stress over patches: give 'length' as well"
  end
  if opts.failure == "von_mises" and part.material.strength and type(part.material.strength) ~= "number" then
    raise "worst_case: failure 'von_mises' needs one strength; the material's differs with the direction"
  end
  if opts.places and not opts.length then raise "worst_case: option 'length' expected with 'places', got nil" end
  if opts.places and not are_places(opts.places) then
    raise("worst_case: option 'places': places of another worst case of the same 'length' expected, got "
      .. core.got(opts.places))
  end
  if not opts.screening and not opts.places then
    raise "worst_case: option 'screening' can be false where 'places' are given"
  end
  opts.method = opts.method or (opts.target == "stress" and "search" or "paper")
  local mesh, material = part.mesh, part.material
  local self = setmetatable({options = opts, mesh = mesh, material = material, reports = {}}, worst_case)
  local clock = core.seconds
  local start = clock()
  if opts.pairs then
    self.contact, message, details = part:contact_system(opts.pairs, {solver = opts.solver})
    if not self.contact then return nil, message, details end
  end
  local basis
  basis, message, details = load_limits.basis("worst_case", part, opts, self.contact and self.contact.cuts)
  if not basis then return nil, message, details end
  if opts.certificate and opts.cuts then
    raise "worst_case: option 'certificate' is for parts without planes of symmetry: a certificate has no cuts"
  end
  self.basis = basis
  local seconds = {}
  self.seconds = seconds

  local system = self.contact and self.contact.system or not opts.solver and view
  if not system then
    system, message, details = system_of(part, opts)
    if not system then return nil, message, details end
  end
  self.system = system
  local times = system.times
  seconds.assemble = times.pattern + times.stiffness
  seconds.factor = times.order + times.factor
  seconds.system = clock() - start

  if opts.places then return search_patches(self, opts) end

  start = clock()
  local modes
  -- Regions need no more. The last two digits of an iteration without a factor cost a fifth of it.
  -- The equations of an edit session always have one, and no report.
  local report = system.report
  local iterative = not opts.laplacian and report and report.solver == "pcg"
  opts.tolerance = opts.tolerance or iterative and 1e-6 or 1e-8
  local ask = {count = opts.modes, tolerance = opts.tolerance, seed = opts.seed, sturm = opts.sturm,
    solver = opts.eigensolver}
  local spread = report and report.backend == "petsc" -- over processes: no other eigensolver has the equations
  if (system == view or spread) and not opts.laplacian then
    modes, message, details = system:modes(ask)
  else
    ask.laplacian = opts.laplacian
    modes, message, details = part:modes(ask)
  end
  if not modes then return nil, message, details end
  self.modes = modes
  seconds.modes = clock() - start

  start = clock()
  local weak
  weak, message, details = core.weak_regions(mesh, material, modes, {measure = opts.measure,
    fraction = opts.fraction, regions = opts.regions, target = opts.target})
  if not weak then return nil, message, details end
  self.weak_regions = weak
  seconds.regions = clock() - start

  start = clock()
  local loads
  local limits = load_limits.linear_program(opts)
  limits.one_sign, limits.batch = opts.one_sign, opts.batch
  if self.contact then
    local origins
    loads, origins, details = worst_contact.search(self, weak, limits)
    if not loads then return nil, origins, details end
    seconds.search, self.limits = clock() - start, limits
    summarise(self, loads, origins)
    return worst_contact.judge(self, limits)
  end
  loads, message, details = core.worst_loads(system, basis, weak, limits)
  if not loads then return nil, message, details end
  solver_reports.add(self.reports, "lp", loads.report)
  seconds.linear_programs = clock() - start
  if opts.length then return search_patches(self, opts, loads) end
  local origins = {}
  if opts.method == "search" then
    start = clock()
    loads, origins, details = worst_search.extend(self, loads, limits)
    if not loads then return nil, origins, details end
    seconds.search = clock() - start
  end
  local leaves
  if opts.certify then
    start = clock()
    local upper
    upper, message, details = worst_search.certify(self, loads, origins, limits, opts.certify)
    if not upper then return nil, message, details end
    loads, leaves = message, details
    self.upper_bound, self.gap = upper, upper / loads.peaks:max() - 1
    self.bounded = load_limits.bounded(opts)
    seconds.bound = clock() - start
  end
  self.limits = limits
  summarise(self, loads, origins)
  if leaves then
    ok, message, details = certificate.write(self, part, leaves, opts.certificate)
    if not ok then return nil, message, details end
  end
  return self
end

-- ---- asking -----------------------------------------------------------------------------------------

local function check_open(self, where)
  if not self.regions then raise(where .. ": this worst case is closed") end
end

local function check_region(self, i, where)
  check_open(self, where)
  i = i or self.region
  if math.type(i) ~= "integer" or i < 1 or i > #self.regions then
    raise(("%s: a region from 1 to %d expected, got %s"):format(where, #self.regions, core.got(i)))
  end
  return i
end

--- Continues a search with `length` to all patches whose mean stress may reach a utilisation. Regions keep their
--- numbers; new ones follow. Returns the worst case, or nil, message, details.
function worst_case:extend(utilisation)
  check_open(self, "extend")
  if not self.search then raise "extend: a worst case with the option 'length' expected, got one without" end
  if type(utilisation) ~= "number" or utilisation <= 0 then
    raise(("extend: utilisation: a number above 0 expected, got %s"):format(core.got(utilisation)))
  end
  local found, message, details = patch_search.extend(self.search, utilisation)
  if not found then return nil, message, details end
  summarise(self, found.loads, found.origins)
  return self
end

--- The worst pressure of a region (the worst one when left out), at every node of the mesh.
function worst_case:pressure(i)
  i = check_region(self, i, "pressure")
  return self.basis:nodal(self.pressures[i])
end

--- The nodal forces of that pressure.
function worst_case:force(i)
  i = check_region(self, i, "force")
  return self.basis:force(self.pressures[i])
end

--- The displacement under it, solved with the factor at hand and kept.
function worst_case:displacement(i)
  i = check_region(self, i, "displacement")
  self.solved = self.solved or {}
  if not self.solved[i] then
    local equations = self.contact or self.system
    local u, message, details = equations:solve(self.basis:force(self.pressures[i]))
    if not u then return nil, message, details end
    self.solved[i] = u
  end
  return self.solved[i]
end

--- The stress of every element under it.
function worst_case:stress(i)
  local u, message, details = self:displacement(i)
  if not u then return nil, message, details end
  return core.element_stress(self.mesh, self.material, u)
end

--- The pressure of a region summed into a few arrows {at, force, area}, largest first.
function worst_case:arrows(i, radius)
  i = check_region(self, i, "arrows")
  return self.basis:arrows(self.pressures[i], radius)
end

--- The weakness of every boundary facet: that of the element behind it.
function worst_case:surface_weakness()
  check_open(self, "surface_weakness")
  return self.weakness:gather(self.mesh.facet_elements)
end

-- ---- showing ------------------------------------------------------------------------------------------

-- The largest stress, its place, what found it and how it compares with the strength.
local function summary(self)
  local head
  if self.options.target == "displacement" then
    head = ("%s of displacement, %s at %s"):format(core.quantity(self.regions[self.region].displacement, "m"),
      core.quantity(self.max_principal, "Pa"), core.point(self.at))
  else
    head = ("%s at %s"):format(core.quantity(self.max_principal, "Pa"), core.point(self.at))
  end
  local tail = self.utilisation and shown.percent(self.utilisation) .. " of the strength"
    or "the strength is not known"
  local used_at = self.material.parts and self.regions[self.region].utilised_at
  if used_at then tail = ("%s of the material at %s"):format(tail, core.point(used_at)) end
  if self.upper_bound then
    tail = ("%s; at most %s on this mesh%s"):format(tail, core.quantity(self.upper_bound, "Pa"),
      self.bounded and " " .. self.bounded or "")
  end
  return ("%s: %s; %s"):format(head, self.regions[self.region].label, tail)
end

--- The answer in one line. It is of one mesh: bw.breaking_force has an error. Where PCG solved, the line states
--- the error of that too.
function worst_case:__tostring()
  if not self.regions then return "worst case (closed)" end
  local solve = self.solve_error > 0
    and ("; the solver is estimated to change the stress by %s"):format(shown.error(self.solve_error)) or ""
  return ("%s%s%s%s; %s"):format(summary(self), load_limits.describe(self.options),
    self.contact and worst_contact.describe(self) or "", solve, core.error_unknown)
end

--- Everything as a .vtu: the weakness map, and pressure, displacement and stress of the worst load.
function worst_case:write(path)
  local u, message, details = self:displacement()
  if not u then return nil, message, details end
  local stress
  stress, message, details = self:stress()
  if not stress then return nil, message, details end
  return self.mesh:write(path, {fields = {
    weakness = {self.weakness, on = "elements"},
    worst_region = {self.worst_region, on = "elements"},
    stress = {stress, on = "elements"},
    max_principal = {core.max_principal(stress), on = "elements"},
    pressure = {self:pressure(), on = "nodes"},
    displacement = {u, on = "nodes"},
  }})
end

--- A picture: the weakness map with the arrows of the worst load, or with {region = i} the judged stress
--- under that region's load on the deformed shape. Further options: those of bw.picture.
function worst_case:picture(path, given)
  local opts = {}
  for key, value in pairs(given or {}) do opts[key] = value end
  local region = opts.region
  opts.region = nil
  local surface, nodes, details = self.mesh:surface()
  if not surface then return nil, nodes, details end
  local values
  if region then
    local stress, message
    stress, message, details = self:stress(region)
    if not stress then return nil, message, details end
    local judged = judged_stress(self.options.failure)
    values = judged.of(stress)
    opts.displacement = self:displacement(region):gather(nodes)
    opts.unit = opts.unit or judged.name .. " under this load, MPa"
    opts.title = opts.title or ("Under the worst load of %s; %s"):format(self.regions[region].label,
      core.error_unknown)
  else
    values = self.weakness
    opts.unit = opts.unit or "weakness (largest principal stress), MPa"
    opts.title = opts.title or ("%s; %s"):format(summary(self), core.error_unknown)
  end
  opts.values = self.mesh:to_nodes(values, "max"):gather(nodes)
  opts.scale = opts.scale or 1e-6
  opts.arrows = opts.arrows or self:arrows(region)
  return core.picture(surface, path, opts)
end

--- One HTML file with a 3D view that turns; opens from disk. See barwright.report.
function worst_case:report(path, given)
  check_open(self, "report")
  return require "barwright.report".write(self, path, given)
end

--- Lets go of the factor, the modes and the arrays at once.
function worst_case:close()
  for _, key in ipairs {"contact", "system", "modes", "weak_regions", "basis", "pressures", "weakness",
    "worst_region"} do
    if self[key] then self[key]:close() end
    self[key] = nil
  end
  for _, u in pairs(self.solved or {}) do u:close() end
  self.solved, self.regions, self.loads, self.search = nil, nil, nil, nil
end
worst_case.__close = worst_case.close

arguments.methods("worst case", worst_case, worst_case, {
  extend = "utilisation: number",
  pressure = "region?: integer", force = "region?: integer", displacement = "region?: integer",
  stress = "region?: integer", arrows = "region?: integer, radius?: number", surface_weakness = "",
  write = "path: string", picture = "path: string, options?: options", report = "path: string, options?: options",
  close = "",
})

return setmetatable({class = worst_case}, {
  __call = function(_, part, given) return worst_case.analyse(part, given) end,
})
