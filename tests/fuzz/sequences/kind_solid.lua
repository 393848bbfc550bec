-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A hyperelastic solid: what acts on it, edits of its grid, coarse solids, equilibria.
local bw = require "barwright"
local followed_kinds = require "followed_kinds"
local fuse = require "fuse"

local kind = {}
local text_of, uniform = followed_kinds.text_of, followed_kinds.uniform
local materials
local solvers = {bw.solver.cholesky(), bw.solver.pcg {preconditioner = bw.solver.jacobi()}, bw.solver.pcg()}

local function rubber(young) return bw.hyperelastic {young = young, poisson = 0.3, density = 1000} end

function kind.make()
  materials = materials or {rubber(1e6), rubber(5e6)}
  local grid = assert(bw.grid.box {size = {0.1, 0.1, 0.2}, cells = {2, 2, 4}})
  local solid = assert(bw.solid {grid = grid, materials = materials})
  assert(solid:fix {side = "min z"})
  return {solid = solid, result = false}
end

function kind.seen(subject)
  local solid, result = subject.solid, subject.result
  local parts = {text_of(solid.grid.points), tostring(solid), #solid.acts, solid.mass:sum()}
  if result then parts[#parts + 1] = text_of(result.displacement) end
  return table.concat(parts, "|")
end

function kind.check(subject)
  local solid = subject.solid
  if solid.node_count ~= solid.grid.node_count or solid.grid.element_count < 1 or solid.mass:sum() <= 0 then
    error "check: the solid is not of its grid"
  end
  local result = subject.result
  for _, row in ipairs(result and result.displacement:totable() or {}) do
    for c = 1, 3 do
      if row[c] ~= row[c] or math.abs(row[c]) == math.huge then error "check: a displacement is no number" end
    end
  end
end

function kind.close(subject)
  subject.solid.body:close()
  if pcall(function() return subject.solid:solve() end) then error "a closed solid answers" end
end

local sides = {"min x", "max x", "max y", "max z"}
local function place()
  local at = math.random()
  if at < 0.7 then return {side = sides[math.random(4)]} end
  if at < 0.85 then return fuse.around(function(_, _, z) return z > 0.15 end) end
  return at < 0.95 and {side = "hgih z"} or {100000}
end

local function vector(size) return {uniform(-size, size), uniform(-size, size), uniform(-size, size)} end

local function size() return 10 ^ uniform(-2, 2.5) end

kind.operations = {
  fix = {0.7, function(subject)
    return subject.solid:fix(place(), math.random() < 0.5 and {false, 0, 1e-3} or nil)
  end},
  rotate = {0.3, function(subject)
    return subject.solid:rotate({side = "max z"}, {axis = vector(1), angle = uniform(-60, 60)})
  end},
  force = {2, function(subject) return subject.solid:force(place(), vector(size())) end},
  gravity = {1, function(subject) return subject.solid:gravity(vector(100)) end},
  pressure = {1, function(subject)
    return subject.solid:pressure(place(), {follower = math.random() < 0.5,
      pressure = fuse.around(function() return 1e3 end)})
  end},
  ["contact plane"] = {0.5, function(subject)
    return subject.solid:contact_plane {point = {0, 0, uniform(0.19, 0.25)}, normal = {0, 0, -1}}
  end},
  ["forget what acts"] = {1, function(subject)
    for i = #subject.solid.acts, 2, -1 do subject.solid.acts[i] = nil end
    return true
  end},
  solve = {4, function(subject)
    local result, message, details = subject.solid:solve {solver = solvers[math.random(4)],
      path = math.random(4) < 2 and math.random(3) or nil, max_iterations = 60, iterations = math.random(2, 20)}
    if not result then return nil, message, details end
    subject.result = result
    return result
  end},
  ["edit the grid"] = {2, function(subject)
    local grid, message, details = subject.solid.grid:set({math.random(subject.solid.element_count)},
      math.random(0, 2))
    if not grid then return nil, message, details end
    local solid
    solid, message, details = subject.solid:with(grid)
    if not solid then return nil, message, details end
    subject.solid, subject.result = solid, false
    return true
  end},
  coarsen = {0.5, function(subject)
    local solid, message, details = subject.solid:coarsen(math.random() < 0.5 and "naive" or "average")
    if not solid then return nil, message, details end
    return solid:solve {max_iterations = 30}
  end},
}

return kind
