-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- bw.plot: plain data in, a figure out, which is written as SVG or PNG. What each kind takes stands in
-- the stubs (lua/stubs/plot.lua) and with its function.
local matrix = require "barwright.plot.matrix"
local progress = require "barwright.plot.progress"
local series = require "barwright.plot.series"

return {
  lines = series.lines,
  scatter = series.scatter,
  bars = require "barwright.plot.bars",
  history = progress.history,
  pareto = progress.pareto,
  scatter_matrix = matrix.scatter_matrix,
  parallel_coordinates = matrix.parallel_coordinates,
  sensitivity = require "barwright.plot.sensitivity",
  convergence = require "barwright.plot.convergence",
  contact_sheet = require "barwright.plot.sheet",
}
