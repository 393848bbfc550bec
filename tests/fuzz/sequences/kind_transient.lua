-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Transient dynamics of a solid.
local bw = require "barwright"
local followed_kinds = require "followed_kinds"

local kind = {}
local jacobi = bw.solver.pcg {preconditioner = bw.solver.jacobi()}
local text_of, uniform = followed_kinds.text_of, followed_kinds.uniform

function kind.make()
  local grid = assert(bw.grid.box {size = {0.1, 0.1, 0.2}, cells = {2, 2, 4}})
  local solid = assert(bw.solid {grid = grid, materials = {bw.hyperelastic {young = 1e5, poisson = 0.3,
    density = 1000}}})
  assert(solid:fix {side = "min z"})
  assert(solid:force({side = "max z"}, {uniform(-50, 50), uniform(-50, 50), uniform(-50, 50)}))
  if math.random() < 0.4 then
    assert(solid:contact_plane {point = {0, 0, 0.205}, normal = {0, 0, -1}})
  end
  local newmark = math.random() < 0.5
  return {transient = assert(solid:transient {scheme = newmark and "newmark" or "implicit_euler",
    step = 10 ^ uniform(-4, -1), stiffness_damping = math.random() < 0.5 and 1e-4 or 0, mass_damping = 0.1,
    solver = math.random() < 0.5 and jacobi or nil, iterations = math.random(3, 12)})}
end

function kind.seen(subject)
  local transient = subject.transient
  local parts = {}
  for _, name in ipairs {"displacement", "velocity", "acceleration", "time", "steps", "kinetic", "strain",
    "potential", "dissipated"} do
    parts[#parts + 1] = text_of(transient[name])
  end
  parts[#parts + 1] = text_of(transient.newton.residual)
  return table.concat(parts, "|")
end

function kind.check(subject) subject.transient:check() end

function kind.close(subject)
  subject.transient:close()
  subject.transient:close()
  if pcall(function() return subject.transient.time end) then error "a closed transient answers" end
end

kind.operations = {
  step = {5, function(subject) return subject.transient:step(math.random(6)) end},
  ["no step"] = {0.2, function(subject) return subject.transient:step(0) end},
  misuse = {0.2, function(subject) return subject.transient:step(-1) end},
}

return kind
