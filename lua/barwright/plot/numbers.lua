-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Numbers on axes: round steps, labels, units. A unit is the one that print shows (core.shown_unit) where its
-- labels are short, otherwise one with an SI prefix.
local core = require "barwright.core"

local numbers = {}

local raised = {["-"] = "⁻", ["0"] = "⁰", ["1"] = "¹", ["2"] = "²", ["3"] = "³", ["4"] = "⁴", ["5"] = "⁵",
  ["6"] = "⁶", ["7"] = "⁷", ["8"] = "⁸", ["9"] = "⁹"}

--- "10⁻⁶"
function numbers.power(exponent)
  return "10" .. ("%d"):format(exponent):gsub(".", raised)
end

--- So many decimals, a point in any locale, a true minus sign, and no "-0".
function numbers.fixed(value, decimals)
  local text = ("%%.%d%s"):format(math.min(decimals, 15), decimals > 15 and "g" or "f"):format(value)
  text = text:gsub(",", ".")
  if tonumber(text) == 0 then text = text:gsub("^%-", "") end
  return (text:gsub("^%-", "−"))
end

--- A number for captions: four significant digits, without zeros at the end; counts with all of them.
function numbers.short(value)
  if value ~= value then return "nan" end
  if value == math.huge or value == -math.huge then return value > 0 and "∞" or "−∞" end
  if value == math.floor(value) and math.abs(value) < 1e6 then return numbers.fixed(value, 0) end
  local text = core.quantity(value, ""):gsub(",", ".")
  local mantissa, exponent = text:match "^(.-)e(.+)$"
  if mantissa then
    text = ("%s·%s"):format(mantissa, numbers.power(math.tointeger(tonumber(exponent))))
  end
  return (text:gsub("^%-", "−"))
end

-- The exponent e with 10^e <= value < 10^(e + 1), exact at powers of ten.
local function magnitude(value)
  local e = math.floor(math.log(value, 10))
  if 10.0 ^ (e + 1) <= value then e = e + 1 end
  if 10.0 ^ e > value then e = e - 1 end
  return e
end
numbers.magnitude = magnitude

--- The smallest of 1, 2, 5 times a power of ten that is at least `rough`, and the decimals it needs.
function numbers.step(rough)
  local e = magnitude(rough)
  for _, m in ipairs {1, 2, 5, 10} do
    local step = m * 10.0 ^ e
    if step >= rough * (1 - 1e-9) then
      return step, math.max(0, -(m == 10 and e + 1 or e))
    end
  end
end

--- Round numbers from low to high, at most `most` of them: {{value, text}}.
function numbers.linear(low, high, max, whole)
  local step, decimals = numbers.step((high - low) / math.max(1, max))
  if whole and step < 1 then step, decimals = 1, 0 end
  local out = {}
  for i = math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6) do
    out[#out + 1] = {value = i * step, text = numbers.fixed(i * step, decimals)}
    if #out > 200 then break end
  end
  -- one mark is no scale: finer, where two were asked for
  if #out < 2 and max >= 2 and max < 16 and not (whole and step == 1) then
    return numbers.linear(low, high, 2 * max, whole)
  end
  return out
end

-- A power of ten with its factor, or plain digits.
local function log_text(factor, e, plain)
  if plain then return numbers.fixed(factor * 10.0 ^ e, math.max(0, -e)) end
  return factor == 1 and numbers.power(e) or ("%d·%s"):format(factor, numbers.power(e))
end

local function inside(value, low, high)
  return value >= low * (1 - 1e-9) and value <= high * (1 + 1e-9)
end

--- Marks of a logarithmic axis: decades (every so many), with 2 and 5 where there is room, the rest
--- between them without text; within part of a decade the round numbers of a linear one.
function numbers.log(low, high, max)
  local first, last = magnitude(low), magnitude(high)
  local decades = math.log(high / low, 10)
  local out = {}
  local factors = decades * 3 <= max and {1, 2, 5} or {1}
  local every = math.max(1, math.ceil(decades / math.max(1, max)))
  local plain = low >= 5e-4 and high <= 5e4 -- short enough, all of them
  for e = first, last do
    for m = 1, 9 do
      local value = m * 10.0 ^ e
      local named = false
      for _, f in ipairs(factors) do named = named or f == m end
      if inside(value, low, high) then
        if named and e % every == 0 then
          out[#out + 1] = {value = value, text = log_text(m, e, plain)}
        elseif decades <= 7 or m == 1 then
          out[#out + 1] = {value = value}
        end
      end
    end
  end
  local named = 0
  for _, mark in ipairs(out) do named = named + (mark.text and 1 or 0) end
  if named >= 2 then return out end
  local marks = numbers.linear(low, high, max)
  return #marks > 1 and marks or out
end

-- ---- units -------------------------------------------------------------------------------------

local prefixes = {{1e-12, "p"}, {1e-9, "n"}, {1e-6, "µ"}, {1e-3, "m"}, {1, ""}, {1e3, "k"}, {1e6, "M"},
  {1e9, "G"}, {1e12, "T"}}
-- The base units that take prefixes, from which to which.
local range = {m = {1e-9, 1e3}, g = {1e-6, 1e3}, s = {1e-9, 1}, N = {1e-6, 1e9}, Pa = {1e-3, 1e12},
  Hz = {1e-3, 1e12}, J = {1e-9, 1e12}, W = {1e-9, 1e12}, V = {1e-6, 1e6}, A = {1e-6, 1e6}}

-- A unit as print knows it, and its text as figures show it.
local function plain(unit) return (unit:gsub("²", "2"):gsub("³", "3"):gsub("%^([23])$", "%1")) end
local function typeset(unit)
  return (unit:gsub("^um", "µm"):gsub("^(%a*m)2$", "%1²"):gsub("^(%a*m)3$", "%1³"))
end

-- base, rest, factor into the base
local function taken_apart(unit)
  if unit == "kg" then return "g", "", 1000 end
  local base, rest = unit:match "^(%a+)(.*)$"
  if not base or not range[base] or rest:find "^[%^23]" then return nil end
  return base, rest, 1
end

local function short_labels(size) return size >= 1e-2 and size < 1e5 end

local function powers_of_ten(size)
  if size == 0 or short_labels(size) then return 1, "" end
  local e = 3 * (magnitude(size) // 3)
  return 10.0 ^ -e, numbers.power(e)
end

--- For values up to `size` in a unit: the factor to what is shown, and the unit to be written, so
--- that labels are short: 5.5e7, "Pa" -> 1e-6, "MPa"; 3e-6, "" -> 1e6, "10⁻⁶".
function numbers.unit(unit, size, whole)
  if unit ~= "" and size > 0 then
    local name, scale = core.shown_unit(size, plain(unit))
    if scale ~= 1 and short_labels(size / scale) then return 1 / scale, typeset(name) end
  end
  local base, rest, factor = taken_apart(plain(unit))
  if base and size > 0 then
    local chosen, name
    for _, p in ipairs(prefixes) do
      local fits = p[1] >= range[base][1] and p[1] <= range[base][2]
      if fits and (not chosen or size * factor >= p[1] * (1 - 1e-9)) then chosen, name = p[1], p[2] end
    end
    if short_labels(size * factor / chosen) then return factor / chosen, name .. base .. rest end
  end
  unit = typeset(plain(unit))
  if whole and size < 1e6 then return 1, unit end
  local times, text = powers_of_ten(size)
  return times, text == "" and unit or unit == "" and text or text .. " " .. unit
end

--- A value with its unit, in the one that print shows it in: "55 MPa", "0.012", "zp150".
function numbers.quantity(value, unit)
  if math.type(value) == nil then return tostring(value) end
  if not unit or unit == "" then return numbers.short(value) end
  local name, scale = core.shown_unit(value, plain(unit))
  return numbers.short(value / scale) .. " " .. typeset(name)
end

return numbers
