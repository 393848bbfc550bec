-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Brute force: every element, or a sample of them, is a region of its own. Slow, and the measure of
-- what the weak regions find (the worst-case paper, section 5, figure 7).
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local sample = require "barwright.sample"

local brute_force = {}
brute_force.__index = brute_force
brute_force.__name = "barwright.brute_force"

local rules = {
  force = {type = "number", default = 20, above = 0},
  pressure = {type = "number", default = 2e5, above = 0},
  at_most = {type = "boolean", default = false},
  elements = {type = "integer", least = 1},
  seed = {type = "integer", default = 1},
  one_sign = {type = "boolean", default = false},
  batch = {type = "integer", default = 0, least = 0},
}

--- The largest stress that any allowed load can cause in each of the elements tried.
function brute_force.analyse(part, given)
  options.object("brute_force", "part", part, "model")
  local wish = options.read("brute_force", given, rules)
  local mesh = part.mesh
  local self = setmetatable({options = wish, mesh = mesh}, brute_force)
  local start = core.seconds()
  local system, message, details = part:system()
  if not system then return nil, message, details end
  local chosen
  if wish.elements and wish.elements < mesh.element_count then
    chosen = sample.numbers(mesh.element_count, wish.elements, wish.seed)
  end
  local regions, basis, loads
  regions, message, details = core.single_regions(mesh, chosen)
  if not regions then return nil, message, details end
  basis, message, details = core.pressure_basis(mesh)
  if not basis then return nil, message, details end
  loads, message, details = core.worst_loads(system, basis, regions, {pressure = wish.pressure,
    force = wish.force, at_most = wish.at_most, one_sign = wish.one_sign, batch = wish.batch,
    keep_pressures = false})
  if not loads then return nil, message, details end
  self.elements = regions.count
  self.weakness = loads.weakness
  self.peaks = loads.peaks
  self.max_principal = loads.peaks:max()
  self.element = loads.peak_elements[(loads.peaks:argmax())]
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
  return ("brute force over %d elements: %.4g MPa, %.1f s"):format(self.elements,
    self.max_principal / 1e6, self.seconds)
end

arguments.methods("brute force", brute_force, brute_force, {percentile = "p?: number",
  compare = "worst: worst_case, p?: number"})

return setmetatable({class = brute_force}, {
  __call = function(_, part, given) return brute_force.analyse(part, given) end,
})
