-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- bw.responsive: analyses that keep up with an outline while it is dragged.
local bridge = require "barwright.bridge"
local flows = require "barwright.flows"
local sheets = require "barwright.sheets"

return {
  bridge = bridge.create,
  steady = sheets.steady,
  vibration = sheets.vibration,
  cantilever = sheets.cantilever,
  flow = flows.flow,
  thermal = flows.thermal,
  metallophone = require("barwright.metallophone").new,
}
