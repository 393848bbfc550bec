-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Numbers in sentences: four significant digits in the units of core.quantity. Percentages and what a search or an
-- estimate gives have three, estimated errors and scatters two.
local core = require "barwright.core"

local shown = {}

--- "3556", "0.001234"
function shown.number(value)
  return core.quantity(value, "")
end

local function rounded(value) return tonumber(("%.3g"):format(value)) end

--- A value that a search or an estimate gives: "25.8 N"
function shown.estimate(value, unit)
  return core.quantity(rounded(value), unit)
end

--- A fraction: "37.1 %"
function shown.percent(fraction)
  return shown.estimate(100 * fraction, "%")
end

--- An estimated error, a fraction: "2.1 %", whole percents from 10 on.
function shown.error(fraction)
  return (fraction < 0.1 and "%.2g %%" or "%.0f %%"):format(100 * fraction)
end

--- An estimated error of a frequency: "3.1 cents", whole ones from 10 on.
function shown.cents(cents)
  return (cents < 10 and "%.2g cents" or "%.0f cents"):format(cents)
end

--- A scatter, two digits: "0.27", "130"
function shown.scatter(value)
  return shown.number(tonumber(("%.2g"):format(value)))
end

--- "(0, 0, -10) N"
function shown.vector(vector, unit)
  local texts = {}
  for i, x in ipairs(vector) do texts[i] = shown.number(x) end
  return "(" .. table.concat(texts, ", ") .. ") " .. unit
end

--- Lengths along the axes: "45 x 64.94 x 13 mm"
function shown.size(size)
  local texts = {}
  for i, x in ipairs(size) do texts[i] = shown.number(1e3 * x) end
  return table.concat(texts, " x ") .. " mm"
end

--- A value with its interval, in one unit: "25.8 N (21.3 to 30.9 N)". Without an upper bound, which is nil or
--- infinite: "25.8 N (at least 21.3 N)"; without any: "25.8 N (error unknown)".
function shown.interval(value, low, high, unit)
  local name, scale = core.shown_unit(rounded(value), unit)
  local function number(x) return shown.number(rounded(x) / scale) end
  local bounds = ("at least %s %s"):format(number(low), name)
  if high and high < math.huge then bounds = ("%s to %s %s"):format(number(low), number(high), name)
  elseif low <= 0 then bounds = "error unknown" end
  return ("%s %s (%s)"):format(number(value), name, bounds)
end

return shown
