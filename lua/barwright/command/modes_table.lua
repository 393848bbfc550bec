-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The modes of a page: their shapes as motions of the view, and their table with the error of the mesh.
local core = require "barwright.core"
local html = require "barwright.html"
local shown = require "barwright.shown"

local modes_table = {}

local MOST_VALUES <const> = 1.5e6 -- of the modes of a page, nodes times modes: more make it heavy
local FEWEST_SHOWN <const> = 3

--- How many modes a page has shapes of.
function modes_table.shown(modes)
  return math.min(modes.count, math.max(FEWEST_SHOWN, math.floor(MOST_VALUES / modes.mesh.node_count)))
end

--- How much the mesh makes a frequency too high, from cents: "about 2.1 % too high".
function modes_table.error(cents)
  return ("about %s too high"):format(shown.error(2 ^ (cents / 1200) - 1))
end

--- Adds the modes to the motions of the page; their table as HTML. extra: {head =, cells = function(i)} of columns
--- more, or nil; field: of a mode, the field (from 0) that is shown with it, or nil.
function modes_table.add(modes, motions, extra, field)
  local rows, errors = {}, modes:error_estimate()
  local count = modes_table.shown(modes)
  for i, frequency in ipairs(modes.frequencies:totable()) do
    local text = core.quantity(frequency, "Hz")
    rows[i] = {i, text, errors and modes_table.error(errors[i]) or "unknown"}
    for k, cell in ipairs(extra and extra.cells(i) or {}) do rows[i][3 + k] = cell end
    if i <= count then
      rows[i]["data-motion"] = #motions
      motions[#motions + 1] = {name = ("mode %d: %s"):format(i, text), kind = "mode", values = modes:shape(i),
        field = field and field(i)}
    end
  end
  local head = {"mode", "natural frequency", "error of the mesh"}
  for k, name in ipairs(extra and extra.head or {}) do head[3 + k] = name end
  return ("<h2>Modes</h2>\n%s<p class=\"hint\">%s%s. The error of the mesh is estimated.</p>\n"):format(
    html.table(head, rows), modes.counted and "Counted: none is missing" or "Not counted",
    count < #rows and (". The view has the first %d"):format(count) or "")
end

return modes_table
