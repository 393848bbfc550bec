-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the heads of the commands' pages have in common (barwright.report_verdict): facts about the part.
local core = require "barwright.core"
local made_of = require "barwright.command.made_of"
local shown = require "barwright.shown"

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

--- The sentence of a stress that is `used` of the strength within a relative error; nil error: not known.
function page_head.used(used, estimated)
  if not used then return "The strength is not known." end
  if not estimated then
    return ("The stress is %s of the strength, with an unknown error."):format(shown.percent(used))
  end
  return ("The judged stress is %s of the strength."):format(shown.interval(100 * used,
    100 * used * math.max(0, 1 - estimated), 100 * used * (1 + estimated), "%"))
end

--- The fact of how much of the strength is left, or missing, at the end of the error that is worse.
function page_head.margin(used, estimated)
  if not (used and estimated) then return {"Margin"} end
  local left = 1 - used * (1 + estimated)
  return {"Margin", left >= 0 and ("%s of the strength is left at least"):format(shown.percent(left))
    or ("%s of the strength may be missing"):format(shown.percent(-left))}
end

return page_head
