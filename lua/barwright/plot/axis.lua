-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- One axis: the range of what is shown, the way from values to places, marks and label. Places count
-- from 0 at the low end to 1 at the high end. Values are the caller's; `factor` brings them to the
-- unit of the labels.
local core = require "barwright.core"
local data = require "barwright.plot.data"
local numbers = require "barwright.plot.numbers"
local options = require "barwright.options"

local raise = core.raise

local Axis = {}
Axis.__index = Axis

local axis = {}

local rules = {
  label = {type = "string", default = ""},
  unit = {type = "string", default = ""},
  scale = {type = "string", one_of = {"linear", "log"}, default = "linear"},
  min = {type = "number"}, max = {type = "number"},
  prefix = {type = "boolean", default = true}, -- may the unit get one
  whole = {type = "boolean", default = false}, -- marks at whole numbers only
}

-- Room around the data, so that no point lies on the frame; where all is equal, a range around it.
local function widened(low, high, pad)
  if high - low <= 1e-12 * math.max(math.abs(low), math.abs(high)) then
    local half = low == 0 and 1 or 0.05 * math.abs(low)
    return low - half, high + half
  end
  local padding = pad * (high - low)
  return low - padding, high + padding
end

local function linear_range(opts, min, max, how)
  local low, high = widened(min, max, how.pad or 0.04)
  if how.zero then
    if min >= 0 then low = 0 end
    if max <= 0 then high = 0 end
    if min == 0 and max == 0 then low, high = 0, 1 end
  end
  low, high = opts.min or low, opts.max or high
  if low >= high then -- one end given, the data beyond it
    if opts.min then high = low + math.max(1e-9, math.abs(low) * 0.1)
    else low = high - math.max(1e-9, math.abs(high) * 0.1) end
  end
  return low, high
end

local function log_range(opts, min, max, how)
  local a, b = math.log(min, 10), math.log(max, 10)
  if a == b then a, b = a - 0.3, b + 0.3
  else
    local padding = (how.pad or 0.04) * (b - a)
    a, b = a - padding, b + padding
  end
  local low, high = opts.min or 10.0 ^ a, opts.max or 10.0 ^ b
  if low >= high then
    if opts.min then high = 10 * low else low = high / 10 end
  end
  return low, high
end

-- {label, unit, ...} or the label alone.
local function read(where, given)
  if type(given) == "string" then given = {label = given} end
  local opts = options.read(where, given, rules)
  if opts.min and opts.max and opts.min >= opts.max then
    raise(("%s: min below max expected, got min = %s and max = %s"):format(where, core.got(opts.min),
      core.got(opts.max)))
  end
  if opts.scale == "log" and (opts.min and opts.min <= 0 or opts.max and opts.max <= 0) then
    raise(("%s: min and max above 0 expected for scale 'log', got %s and %s"):format(where,
      core.got(opts.min), core.got(opts.max)))
  end
  return opts
end

--- An axis for lists of numbers. how = {pad, zero: 0 is part of it}.
function axis.new(where, given, lists, how)
  how = how or {}
  local opts = read(where, given)
  local log = opts.scale == "log"
  local min, max = data.range(lists, log)
  local any = data.range(lists)
  if log and any and not min and not (opts.min and opts.max) then
    raise(("%s: numbers above 0 expected for scale 'log', got %s to %s"):format(where,
      numbers.short(any), numbers.short(select(2, data.range(lists)))))
  end
  local self = setmetatable({log = log, whole = opts.whole, empty = min == nil}, Axis)
  if self.empty then min, max = log and 1 or 0, log and 10 or 1 end
  if log then self.low, self.high = log_range(opts, min, max, how)
  else self.low, self.high = linear_range(opts, min, max, how) end
  self.factor, self.unit = 1, opts.unit
  if opts.prefix and not (self.empty and opts.unit == "") then
    local size = math.max(math.abs(min), math.abs(max))
    if log and opts.unit == "" then size = 1 end -- powers of ten are on the axis
    if opts.min and opts.max then size = math.max(math.abs(opts.min), math.abs(opts.max)) end
    self.factor, self.unit = numbers.unit(opts.unit, size, opts.whole)
  end
  self.label = opts.label .. (self.unit ~= "" and (opts.label ~= "" and ", " or "") .. self.unit or "")
  self.name = opts.label
  return self
end

--- An axis of names, each in the middle of an interval of length 1.
function axis.names(label, names)
  return setmetatable({names = names, low = 0.5, high = #names + 0.5, factor = 1, label = label or "",
    name = label or ""}, Axis)
end

--- The label within a width: the name is shortened, its unit is not.
function Axis:fitted(s, size, width, bold)
  if s:text_width(self.label, size, bold) <= width then return self.label end
  local behind = self.label:sub(#self.name + 1)
  local padding = width - s:text_width(behind, size, bold)
  if padding < 3 * size then return s:shortened(self.label, size, width, bold, true) end
  return s:shortened(self.name, size, padding, bold, true) .. behind
end

--- The label in lines: in two, or the name in two and its unit below.
function Axis:wrapped(s, size, width, bold)
  local lines = s:wrapped(self.label, size, width, 2, bold)
  if not lines[#lines] or not lines[#lines]:find("…$") then return lines end
  lines = s:wrapped(self.name, size, width, 2, bold)
  local unit = self.label:sub(#self.name + 1):gsub("^,? *", "")
  if unit ~= "" then lines[#lines + 1] = unit end
  return lines
end

--- The place of a value, from 0 to 1 within the range; nil where it has none.
function Axis:at(value)
  if value ~= value then return nil end
  if self.log then
    if value <= 0 then return nil end
    return math.log(value / self.low) / math.log(self.high / self.low)
  end
  return (value - self.low) / (self.high - self.low)
end

--- At most about `most` marks: {{at, text (or nil: a small one)}}.
function Axis:marks(max)
  local out = {}
  if self.names then
    for i, name in ipairs(self.names) do out[i] = {at = self:at(i), text = name} end
    return out
  end
  local low, high = self.low * self.factor, self.high * self.factor
  local marks
  if self.log then marks = numbers.log(low, high, max)
  else marks = numbers.linear(low, high, max, self.whole) end
  for i, mark in ipairs(marks) do out[i] = {at = self:at(mark.value / self.factor), text = mark.text} end
  return out
end

--- A value as a label has it, without its unit.
function Axis:text(value)
  return numbers.short(value * self.factor)
end

return axis
