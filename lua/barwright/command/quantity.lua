-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Numbers with a unit, as people write them on a command line: 20, 20N, 0.2MPa, 30mm, 5min, 2G. A number
-- alone is in the SI unit that the option names. Lengths and areas of a command line need a unit, since whoever
-- draws in millimetres means those.
local core = require "barwright.core"

local quantity = {}

-- For each unit that an option can name: what else may stand there, and how many of it that is.
local units = {
  m = {m = 1, mm = 1e-3, cm = 1e-2, um = 1e-6, km = 1e3, ["in"] = 0.0254, ft = 0.3048},
  m2 = {m2 = 1, cm2 = 1e-4, mm2 = 1e-6},
  N = {N = 1, kN = 1e3, MN = 1e6, mN = 1e-3, kgf = 9.80665, lbf = 4.4482216152605},
  Pa = {Pa = 1, kPa = 1e3, MPa = 1e6, GPa = 1e9, bar = 1e5, psi = 6894.757293168361},
  kg = {kg = 1, g = 1e-3, mg = 1e-6, t = 1e3, lb = 0.45359237},
  s = {s = 1, ms = 1e-3, min = 60, h = 3600, d = 86400},
  Hz = {Hz = 1, kHz = 1e3},
  K = {K = 1},
  W = {W = 1, mW = 1e-3, kW = 1e3},
  bytes = {B = 1, K = 1024, M = 1024 ^ 2, G = 1024 ^ 3, T = 1024 ^ 4, KB = 1e3, MB = 1e6, GB = 1e9, TB = 1e12,
    KiB = 1024, MiB = 1024 ^ 2, GiB = 1024 ^ 3, TiB = 1024 ^ 4},
  ["kg/m3"] = {["kg/m3"] = 1, ["g/cm3"] = 1e3},
  ["m/s2"] = {["m/s2"] = 1, g = 9.80665},
}

--- The names that may stand behind a number where an option names the unit, smallest first.
function quantity.names(unit)
  local list = {}
  for name in pairs(units[unit] or {}) do list[#list + 1] = name end
  table.sort(list, function(a, b)
    local p, q = units[unit][a], units[unit][b]
    return p < q or p == q and a < b
  end)
  return list
end

-- Digits as a person writes them: no hexadecimal, no "nan", no "inf".
local function split(text)
  local mantissa, rest = text:match "^%s*([+-]?%d+%.?%d*)(.*)$"
  if not mantissa then mantissa, rest = text:match "^%s*([+-]?%.%d+)(.*)$" end
  if not mantissa then return end
  local exponent, after = rest:match "^([eE][+-]?%d+)(.*)$"
  if exponent then mantissa, rest = mantissa .. exponent, after end
  return tonumber((mantissa:gsub("^%+", ""))), rest:match "^%s*(.-)%s*$"
end

--- What stands behind the number of a text: "mm" of "30mm", "" of "30"; nil where it begins with no number.
function quantity.name_in(text)
  local _, name = split(text)
  return name
end

-- The units that must be written, and those that a sentence proposes.
local proposed = {m = {"mm", "m"}, m2 = {"mm2", "cm2", "m2"}}

--- Whether numbers of an option that names this unit need one behind them.
function quantity.needed(unit)
  return proposed[unit] ~= nil
end

--- A number in the unit that print shows it in, with all of its digits, since it can be given again: "20 N",
--- "1 cm2", "30 MPa".
function quantity.text(value, unit)
  if not unit then return math.type(value) == "integer" and tostring(value) or ("%.14g"):format(value) end
  local name, scale = core.shown_unit(value, unit)
  return ("%.14g %s"):format(value / scale, name)
end

--- A sentence where a number other than 0 needs a unit and has none; nil elsewhere. text: what to repeat with a
--- unit, where that is more than the number.
function quantity.missing(number, unit, text)
  if not proposed[unit] or quantity.name_in(number) ~= "" or (quantity.read(number) or 0) == 0 then return nil end
  text = text or number
  local words = {}
  for i, name in ipairs(proposed[unit]) do words[i] = text .. name end
  local last = table.remove(words)
  return ("'%s' has no unit: write %s or %s"):format(text, table.concat(words, ", "), last)
end

--- The number of a text in the unit (nil: a bare number), or nil and what was expected.
function quantity.read(text, unit)
  local value, name = split(text)
  if not value or value - value ~= 0 then return nil, "a number" .. (unit and " of " .. unit or "") end
  value = value + 0.0
  if name == "" then return value end
  local known = unit and units[unit]
  if known and known[name] then
    -- Through the decimal text where it is exact: 30mm is 0.03, not 0.030000000000000002.
    local scale = known[name]
    return scale < 1 and 1 / scale % 1 == 0 and value / (1 / scale) or value * scale
  end
  if not unit then return nil, "a number without a unit" end
  if not known then return nil, "a number in " .. unit end
  return nil, ("a number with one of the units %s (alone: %s)"):format(
    table.concat(quantity.names(unit), ", "), unit)
end

return quantity
