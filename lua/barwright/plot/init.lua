-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- bw.plot: plain data in, a figure out, which is written as SVG or PNG. What each kind takes stands in
-- the stubs (lua/stubs/barwright.lua) and with its function here.
local series = require "barwright.plot.series"

return {
  lines = series.lines,
  scatter = series.scatter,
  bars = series.bars,
}
