-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Colours, dashes, markers. The colours of series tell apart with any kind of colour vision and in
-- grey: hues of Okabe and Ito's set, in an order in which neighbours also differ in lightness; where
-- they repeat, dashes and markers differ.
local core = require "barwright.core"

local palette = {
  ink = "#20262d", soft = "#5b6875", line = "#8a949e", grid = "#e4e8ec", pale = "#b9c2cb",
  good = "#0072b2", bad = "#c2410c",
}

local colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#9a6b00", "#4b4b4b"}
local markers = {"disc", "square", "diamond", "triangle", "triangle_down", "plus", "cross"}
local dashes = {false, {7, 3}, {2, 3}, {8, 3, 2, 3}}

--- The n-th series: colour, marker, dash (or nil).
function palette.series(n)
  local round = (n - 1) // #colours
  return colours[(n - 1) % #colours + 1], markers[(n - 1 + round) % #markers + 1],
    dashes[round % #dashes + 1] or nil
end

--- Of a value from 0 to 1, the map of the pictures of bodies; nan is grey.
function palette.value(t)
  if t ~= t then return "#a8a8a8" end
  return ("#%02x%02x%02x"):format(core.colour(t))
end

function palette.is_colour(text)
  return type(text) == "string" and (text:match "^#%x%x%x%x%x%x$" or text:match "^#%x%x%x%x%x%x%x%x$")
    and true or false
end

return palette
