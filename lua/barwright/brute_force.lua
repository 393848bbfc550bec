-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Brute force: every element, or a sample of them, is a region of its own. Slow, and the measure of
-- what the weak regions find (the worst-case paper, section 5, figure 7).
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local load_limits = require "barwright.load_limits"
local options = require "barwright.options"
local sample = require "barwright.sample"
local solver_reports = require "barwright.solver_reports"

local brute_force = {}
brute_force.__index = brute_force
brute_force.__name = "barwright.brute_force"

local rules = load_limits.rules {
  elements = {type = "integer", min = 1},
  seed = {type = "integer", default = 1},
  one_sign = {type = "boolean", default = false},
  batch = {type = "integer", default = 0, min = 0},
  objective = {type = "string", default = "trace", one_of = {"trace", "principal"}},
}

-- Steps of the ascent at most, and the fraction by which some element must gain for another one.
local ASCENT_STEPS, GAIN = 6, 1e-3

--- Ascent of the principal stress in every element tried: its linear program with the principal direction of
--- the stress under its load as the objective, until none gains. Results as those of the first run.
local function ascend(mesh, system, basis, elements, loads, limits, reports)
  local count, stresses = loads.peaks.row_count, loads.first_stresses
  local peaks, own = loads.peaks, core.max_principal(stresses)
  for _ = 1, ASCENT_STEPS do
    local stressed = own:above(0):where()
    if stressed.row_count < count then break end -- an element without stress has no direction
    local regions, message, details = core.directed_regions(mesh, elements, stresses)
    if not regions then return nil, message, details end
    local more
    more, message, details = core.worst_loads(system, basis, regions, limits)
    if not more then return nil, message, details end
    solver_reports.add(reports, "lp", more.report)
    local weakness = core.array.map("max(a, b)", {a = loads.weakness, b = more.weakness})
    peaks = core.array.map("max(a, b)", {a = peaks, b = more.peaks})
    local reached = core.max_principal(more.first_stresses)
    local gain = core.array.map("a / b", {a = reached, b = own}):max()
    stresses, own = more.first_stresses, reached
    loads = {weakness = weakness, peaks = peaks, element = (weakness:argmax())}
    if gain < 1 + GAIN then break end
  end
  return loads
end

--- The largest stress that any allowed load can cause in each of the elements tried.
function brute_force.analyse(part, given)
  options.object("brute_force", "part", part, "model")
  local opts = options.read("brute_force", given, rules)
  local mesh = part.mesh
  local self = setmetatable({options = opts, mesh = mesh, reports = {}}, brute_force)
  local basis, message, details = load_limits.basis("brute_force", part, opts)
  if not basis then return nil, message, details end
  local start = core.seconds()
  local system
  system, message, details = load_limits.system(part)
  if not system then return nil, message, details end
  local chosen
  if opts.elements and opts.elements < mesh.element_count then
    chosen = sample.numbers(mesh.element_count, opts.elements, opts.seed)
  end
  local regions, loads
  regions, message, details = core.single_regions(mesh, chosen)
  if not regions then return nil, message, details end
  local limits = load_limits.linear_program(opts)
  limits.one_sign, limits.batch, limits.keep_pressures = opts.one_sign, opts.batch, false
  loads, message, details = core.worst_loads(system, basis, regions, limits)
  if not loads then return nil, message, details end
  solver_reports.add(self.reports, "lp", loads.report)
  if opts.objective == "principal" then
    limits.one_sign = true
    chosen = chosen or core.array.range(1, mesh.element_count, 1)
    loads, message, details = ascend(mesh, system, basis, chosen, loads, limits, self.reports)
    if not loads then return nil, message, details end
  end
  self.elements = regions.count
  self.weakness = loads.weakness
  self.peaks = loads.peaks
  self.max_principal = loads.peaks:max()
  self.element = loads.element or loads.peak_elements[(loads.peaks:argmax())]
  self.seconds = core.seconds() - start
  return self
end

--- A percentile of the weakness map, weighted by volume (99.75 in the paper's figure 7).
function brute_force:percentile(p)
  return self.weakness:quantile((p or 99.75) / 100, self.mesh.volumes)
end

--- Beside a worst case of the same part: {worst_case, brute_force, ratio} of that percentile.
function brute_force:compare(worst, p)
  local theirs = worst.weakness:quantile((p or 99.75) / 100, self.mesh.volumes)
  local ours = self:percentile(p)
  return {worst_case = theirs, brute_force = ours, ratio = theirs / ours}
end

function brute_force:__tostring()
  return ("brute force over %d elements: %s in %s; %s"):format(self.elements,
    core.quantity(self.max_principal, "Pa"), core.quantity(self.seconds, "s"), core.error_unknown)
end

arguments.methods("brute force", brute_force, brute_force, {percentile = "p?: number",
  compare = "worst: worst_case, p?: number"})

return setmetatable({class = brute_force}, {
  __call = function(_, part, given) return brute_force.analyse(part, given) end,
})
