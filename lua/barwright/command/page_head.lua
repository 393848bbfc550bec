-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the heads of the commands' pages have in common (barwright.report_verdict): facts about the part.
local core = require "barwright.core"
local made_of = require "barwright.command.made_of"

local page_head = {}

--- Two facts: the material and the mass. made: made_of.lua; out: what the command keeps.
function page_head.part(made, opts, out)
  local mass = out.object.mass_kg
  return {"Material", #made.named == 0 and made_of.text(made, opts) or out.object.material},
    {"Mass", mass and core.quantity(mass, "kg")}
end

--- The fact of where it is constrained. fix: places; area: m2.
function page_head.constrained(fix, area)
  if #fix == 0 then return {"Constrained at"} end
  return {"Constrained at", ("%s (%s)"):format(table.concat(fix, ", "), core.quantity(area, "m2"))}
end

return page_head
