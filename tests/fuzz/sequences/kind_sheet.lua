-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A steady sheet.
local acting = require "acting"
local bw = require "barwright"
local followed_kinds = require "followed_kinds"

local cholesky = bw.solver.cholesky()
local solvers = {"auto", bw.solver.pcg {preconditioner = cholesky}, cholesky, bw.solver.cholesky {full = true}}

return followed_kinds.new {
  make = function()
    acting.load = 1e3
    return bw.responsive.steady {outline = followed_kinds.first(), material = acting.rubber,
      elements = math.random(8, 60), order = math.random(2), solver = solvers[math.random(#solvers)],
      conditions = {left = "fixed", right = {traction = {acting.function_of_load, 0}}}}
  end,
  fields = {"displacement", "stress", "time"},
  moves = {
    load = {0.5, acting.change},
    solve = {2, function(subject) return subject.object:solve() end},
    norm = {2, function(subject)
      local exponents = {1, 2, 8, 500, 1000, 0, -1, 1e9, 0 / 0}
      return subject.object:stress_norm(exponents[math.random(#exponents)])
    end},
    estimate = {0.5, function(subject) return subject.object.error_estimate >= 0 end},
  },
}
