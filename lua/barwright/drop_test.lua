-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The drop test of the worst-case paper (section 5): random orientations onto a peg, thousands of
-- impacts from one factor, and how often each place exceeds its strength.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local shown = require "barwright.shown"

local drop_test = {}
drop_test.__index = drop_test
drop_test.__name = "barwright.drop_test"

local rules = {
  drops = {type = "integer", default = 2000, min = 1},
  height = {type = "number", default = 1, above = 0},
  peg_radius = {type = "number", default = 0, min = 0},
  duration = {type = "number", default = 1e-3, above = 0},
  seed = {type = "integer", default = 1},
  solver = {type = "solver", auto = true},
}

--- Drops a part that has no supports and a known density.
function drop_test.analyse(part, given)
  options.object("drop_test", "part", part, "model")
  local opts = options.read("drop_test", given, rules)
  local self = setmetatable({options = opts, mesh = part.mesh}, drop_test)
  local start = core.seconds()
  local system, message, details = part:system {solver = opts.solver}
  if not system then return nil, message, details end
  local how = {}
  for key, value in pairs(opts) do how[key] = value end
  how.solver = nil
  local found
  found, message, details = core.drops(system, how)
  if not found then return nil, message, details end
  self.reports = {solver = system.report}
  for key, value in pairs(found) do self[key] = value end
  self.seconds = core.seconds() - start
  return self
end

--- Spearman's rank correlation, weighted by volume, of where drops overload the part with a
--- weakness map (a worst case, a brute force, or an array over elements).
function drop_test:correlation(other)
  local map = type(other) == "table" and other.weakness or other
  return core.rank_correlation(self.mean_peak, map, self.mesh.volumes)
end

--- The fraction of drops in which some place was overloaded.
function drop_test:failures()
  return self.exceedance:max()
end

--- Everything as a .vtu.
function drop_test:write(path)
  return self.mesh:write(path, {fields = {
    exceedance = {self.exceedance, on = "elements"},
    mean_peak = {self.mean_peak, on = "elements"},
  }})
end

--- A picture of how often each place was overloaded. Options: those of bw.picture.
function drop_test:picture(path, given)
  local opts = {}
  for key, value in pairs(given or {}) do opts[key] = value end
  local surface, nodes, details = self.mesh:surface()
  if not surface then return nil, nodes, details end
  opts.values = self.mesh:to_nodes(self.exceedance, "max"):gather(nodes)
  opts.unit = opts.unit or "drops that overload, %"
  opts.scale = opts.scale or 100
  return core.picture(surface, path, opts)
end

function drop_test:__tostring()
  return ("%d drops: the weakest place is overloaded in %s of them; %s"):format(self.drops,
    shown.percent(self:failures()), core.error_unknown)
end

arguments.methods("drop test", drop_test, drop_test, {correlation = "other: worst_case|brute_force|array",
  failures = "", write = "path: string", picture = "path: string, options?: options"})

return setmetatable({class = drop_test}, {
  __call = function(_, part, given) return drop_test.analyse(part, given) end,
})
