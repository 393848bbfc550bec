-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The displacement of a coarse grid that is nearest to a fine one: by the mean distance of nodes, supports
-- fixed. A convex problem: least squares, with weights of one over the distance of the round before.
local core = require "barwright.core"
local bw = require "barwright"

local best = {}

local ROUNDS, ITERATIONS, TOLERANCE = 15, 200, 1e-8
local MIN = 1e-3 -- a weight is bounded by this part of the mean distance

-- Rows of a coarse solid's nodes: 1 where a component is free, and the displacement of those fixed.
local function supports(coarse)
  local free, fixed = {}, {}
  for n = 1, coarse.node_count do free[n], fixed[n] = {1, 1, 1}, {0, 0, 0} end
  for _, act in ipairs(rawget(coarse, "acts")) do
    if act.kind == "fix" then
      for _, n in ipairs(assert(coarse.grid:nodes(act.where)):totable()) do
        for c = 1, 3 do
          if act.by[c] then free[n][c], fixed[n][c] = 0, act.by[c] end
        end
      end
    elseif act.kind == "move" or act.kind == "rotate" then
      core.raise(("best: supports that %s are not known here"):format(act.kind))
    end
  end
  return bw.array.new(free), bw.array.new(fixed)
end

local function distances(a, b)
  return (a - b):map "sqrt(a.x*a.x + a.y*a.y + a.z*a.z)"
end

-- Conjugate gradients on the normal equations, from x, with a weight for each fine node.
local function least_squares(embedding, free, u, weight, x)
  local function back(v)
    return embedding:forces(bw.array.map("w*v", {w = weight, v = v})) * free
  end
  local ones = bw.array.zeros(#u, 3) + 1
  local inverse = embedding:forces(bw.array.map("w*v", {w = weight, v = ones})):map "1/max(a, 1e-300)"
  local residual = back(u - embedding:values(x))
  local z = residual * inverse
  local p, rho = z, residual:dot(z)
  local enough = rho * TOLERANCE ^ 2
  for _ = 1, ITERATIONS do
    if rho <= enough then break end
    local q = back(embedding:values(p))
    local step = rho / p:dot(q)
    x, residual = x + p * step, residual - q * step
    z = residual * inverse
    local next_rho = residual:dot(z)
    p, rho = z + p * (next_rho / rho), next_rho
  end
  return x
end

--- The field at the nodes of `fine` that a displacement of `coarse`, fixed as that solid is, can bring
--- nearest to u.
function best.of(fine, coarse, u)
  local embedding = assert(coarse.grid:embed(fine.points))
  local free, x = supports(coarse)
  local weight = bw.array.zeros(#u, 1) + 1
  local field, min
  for _ = 1, ROUNDS do
    x = least_squares(embedding, free, u, weight, x)
    local now = embedding:values(x)
    local d = distances(now, u)
    local mean = d:sum() / #u
    if min and mean > min * (1 - 1e-3) then
      if mean < min then field = now end
      break
    end
    field, min = now, mean
    weight = d:map("1/max(a, bound)", {bound = math.max(MIN * mean, 1e-300)}) * mean
  end
  return field
end

--- The factor with which v comes nearest to u, by least squares.
function best.factor(v, u)
  local square = v:dot(v)
  return square > 0 and v:dot(u) / square or 1
end

--- One for each axis.
function best.factors(v, u)
  local of = {}
  for c = 1, 3 do of[c] = best.factor(v:column(c), u:column(c)) end
  return of
end

--- v with each axis times its factor.
function best.times(v, factors)
  return v * bw.array.new({factors}):gather(bw.array.zeros(#v, 1, "i32") + 1)
end

return best
