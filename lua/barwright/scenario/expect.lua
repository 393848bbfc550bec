-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Expectations: a figure, what it must be, and a record of both. A failed one does not end the scenario.
local arguments = require "barwright.arguments"
local baseline = require "barwright.scenario.baseline"
local core = require "barwright.core"
local modes = require "barwright.scenario.modes"
local numbers = require "barwright.scenario.numbers"
local options = require "barwright.options"
local record = require "barwright.scenario.record"

local raise, show, plain = core.raise, numbers.show, numbers.plain

local expect = {}
local methods = {}
expect.methods = methods
local fields = {value = true, what = true, unit = true, failure = true}
local Expectation = {__name = "barwright.expectation"}

function Expectation.__index(_, name)
  if fields[name] then return nil end
  return methods[name] or raise(("expect has no '%s': %s"):format(tostring(name),
    core.suggestion(tostring(name), {"below", "above", "between", "near", "equals", "is_true", "fails_with",
      "same_modes", "matches_baseline"})))
end

--- expect(figure, what, unit); or what a call returned: nil, its message, its details.
function expect.of(...)
  record.running "expect"
  if select("#", ...) == 0 then raise "expect: a figure expected, got no value" end
  local value, what, unit = ...
  local self = setmetatable({value = value, what = what, unit = unit}, Expectation)
  if value == nil then
    self.failure = {message = what, details = type(unit) == "table" and unit or {}}
    self.what, self.unit = nil, nil
  end
  -- A call that gave an object may give more behind it.
  if type(self.what) ~= "string" then self.what = nil end
  if type(self.unit) ~= "string" then self.unit = nil end
  return self
end

local about = {source = {type = "string"}, how = {type = "string"}}

local function read(form, given, rules)
  local all = {source = about.source, how = about.how}
  for key, rule in pairs(rules or {}) do all[key] = rule end
  return options.read(form, given, all)
end

-- Keeps what was found. `message` (only where it is not good) says what was expected.
local function judged(self, form, entry, good, message)
  entry.form, entry.good = form, good and true or false
  entry.quantity, entry.unit = self.what, self.unit
  if not good then
    entry.message = (self.what and self.what .. ": " or "") .. message
    record.running("expect").said = entry.message
  end
  return record.expectation(entry)
end

local function with_unit(self, text)
  return self.unit and self.unit ~= "" and text .. " " .. self.unit or text
end

-- Where the call that should have given the figure failed: its own words.
local function missing(self, form, opts)
  local message = self.failure and self.failure.message
  return judged(self, form, {source = opts.source, how = opts.how}, false, message and
    ("nothing to check: %s"):format(tostring(message)) or "nothing to check: the value is nil")
end

local function number_of(self, form)
  if type(self.value) == "number" then return self.value end
  local kind = core.class_name(self.value) or type(self.value)
  local meta = getmetatable(self.value)
  if type(meta) == "table" and meta.__name then kind = meta.__name:match "[^.]+$" end
  raise(("%s: a number expected, got %s%s"):format(form, kind, kind == "array"
    and ": take its max(), min(), norm() or one value" or ""))
end

local function checked_bound(form, bound)
  if type(bound) ~= "number" or bound ~= bound then
    raise(("%s: a number as the bound expected, got %s"):format(form, core.got(bound)))
  end
  return bound
end

local function fraction(value, bound)
  if bound == 0 or bound ~= bound or math.abs(bound) == math.huge then return "" end
  local off = math.abs(value - bound) / math.abs(bound)
  return off < math.huge and (" (by %s %%)"):format(show(100 * off, 3)) or ""
end

--- At most the bound.
function methods:below(bound, given)
  local opts = read("below", given)
  checked_bound("below", bound)
  if self.value == nil then return missing(self, "below", opts) end
  local value = number_of(self, "below")
  local a, b = numbers.apart(value, bound)
  return judged(self, "below", {figure = plain(value), max = plain(bound), source = opts.source, how = opts.how,
    allowed = "at most " .. show(bound)}, value <= bound,
    ("%s, at most %s expected%s"):format(with_unit(self, a), with_unit(self, b), fraction(value, bound)))
end

--- At least the bound.
function methods:above(bound, given)
  local opts = read("above", given)
  checked_bound("above", bound)
  if self.value == nil then return missing(self, "above", opts) end
  local value = number_of(self, "above")
  local a, b = numbers.apart(value, bound)
  return judged(self, "above", {figure = plain(value), min = plain(bound), source = opts.source, how = opts.how,
    allowed = "at least " .. show(bound)}, value >= bound,
    ("%s, at least %s expected%s"):format(with_unit(self, a), with_unit(self, b), fraction(value, bound)))
end

--- From `min` to `max`.
function methods:between(min, max, given)
  local opts = read("between", given)
  checked_bound("between", min)
  checked_bound("between", max)
  if min > max then
    raise(("between: min at most max expected, got %s and %s"):format(core.got(min), core.got(max)))
  end
  if self.value == nil then return missing(self, "between", opts) end
  local value = number_of(self, "between")
  local a, b = numbers.apart(value, value < min and min or max)
  return judged(self, "between", {figure = plain(value), min = plain(min), max = plain(max),
    source = opts.source, how = opts.how, allowed = ("%s to %s"):format(show(min), show(max))},
    value >= min and value <= max, ("%s, from %s to %s expected (%s is passed)"):format(with_unit(self, a),
      show(min), with_unit(self, show(max)), b))
end

local function tolerance_text(opts, unit)
  local parts = {}
  if opts.relative then parts[#parts + 1] = show(100 * opts.relative) .. " %" end
  if opts.absolute then parts[#parts + 1] = show(opts.absolute) .. (unit and unit ~= "" and " " .. unit or "") end
  return "within " .. table.concat(parts, " or ")
end

-- The figure is the largest difference; with `relative` over the largest value of the reference, without a unit.
local function near_list(self, reference, opts)
  local b, shape = numbers.flat(reference)
  local a, own = numbers.flat(self.value)
  if not a then
    raise("near: a number, an array or a list of numbers expected, got " .. core.got(self.value))
  end
  local entry = {source = opts.source, how = opts.how, absolute = opts.absolute, relative = opts.relative,
    allowed = tolerance_text(opts, self.unit)}
  if #a ~= #b or own ~= shape then
    return judged(self, "near", entry, false, ("%s, %s expected"):format(own, shape))
  end
  local max, size, at = numbers.largest(a, b)
  local over = opts.relative and size > 0
  local figure = over and max / size or max
  entry.figure, entry.values, entry.at = plain(figure), #a, at
  local good = max <= math.max(opts.absolute or 0, (opts.relative or 0) * size)
  local x, y = numbers.apart(a[at] or 0, b[at] or 0)
  local apart = over and ("%s of the largest (%s)"):format(show(figure, 3), with_unit(self, show(size)))
    or with_unit(self, show(max, 3))
  return judged({what = (self.what and self.what .. ", " or "") .. "largest difference"
    .. (over and " over the largest value" or ""), unit = not over and self.unit or nil}, "near", entry, good,
    ("value %d of %s is %s, %s expected: apart by %s; %s expected"):format(at, own, with_unit(self, x),
      with_unit(self, y), apart, entry.allowed))
end

--- Near the reference: |figure - reference| at most `absolute`, or `relative` |reference|, whichever is
--- more. Of arrays and lists every value, beside the largest one of the reference.
function methods:near(reference, given)
  local opts = read("near", given, {relative = {type = "number", min = 0},
    absolute = {type = "number", min = 0}})
  if not opts.relative and not opts.absolute then
    raise "near: {relative = ...} or {absolute = ...} expected, got neither"
  end
  if self.value == nil then return missing(self, "near", opts) end
  if type(reference) ~= "number" then
    if not numbers.flat(reference) then
      raise(("near: a number, an array or a list of numbers as the reference expected, got %s"):format(
        core.got(reference)))
    end
    return near_list(self, reference, opts)
  end
  if reference - reference ~= 0 then
    raise("near: a finite number as the reference expected, got " .. core.got(reference))
  end
  if reference == 0 and not opts.absolute then
    raise "near: {absolute = ...} expected with the reference 0, got {relative = ...} alone"
  end
  local value = number_of(self, "near")
  local off = math.abs(value - reference)
  local a, b = numbers.apart(value, reference)
  return judged(self, "near", {figure = plain(value), reference = reference, absolute = opts.absolute,
    relative = opts.relative, source = opts.source, how = opts.how,
    difference = reference ~= 0 and plain((value - reference) / math.abs(reference)) or nil,
    allowed = tolerance_text(opts, self.unit)},
    off <= math.max(opts.absolute or 0, (opts.relative or 0) * math.abs(reference)),
    ("%s, %s expected %s%s"):format(with_unit(self, a), with_unit(self, b), tolerance_text(opts, self.unit),
      fraction(value, reference):gsub("by", "apart by")))
end

local function short(value)
  local text = type(value) == "string" and ("%q"):format(value):gsub("\\\n", "\\n")
    or type(value) == "number" and show(value, 17) or tostring(value)
  return #text > 200 and text:sub(1, 197) .. "..." or text
end

-- The first place where two values differ: a path and the two, or nil.
local function differs(a, b, path, depth)
  if a == b then return nil end
  if depth < 100 and type(a) == "table" and type(b) == "table" and not getmetatable(a) and not getmetatable(b) then
    local keys = {}
    for key in pairs(a) do keys[#keys + 1] = key end
    for key in pairs(b) do if a[key] == nil then keys[#keys + 1] = key end end
    table.sort(keys, function(x, y)
      if type(x) == type(y) and (type(x) == "number" or type(x) == "string") then return x < y end
      return tostring(x) < tostring(y)
    end)
    for _, key in ipairs(keys) do
      local at, x, y = differs(a[key], b[key], path .. (type(key) == "number" and ("[%d]"):format(key)
        or path == "" and tostring(key) or "." .. tostring(key)), depth + 1)
      if at then return at, x, y end
    end
    return nil
  end
  return path, a, b
end

--- Exactly this: numbers to the last bit, texts, truth values, tables of these.
function methods:equals(other, given)
  local opts = read("equals", given)
  if self.value == nil and other ~= nil and self.failure.message then return missing(self, "equals", opts) end
  local at, a, b = differs(self.value, other, "", 1)
  return judged(self, "equals", {figure = type(self.value) == "number" and plain(self.value) or short(self.value),
    reference = type(other) == "number" and plain(other) or short(other), source = opts.source, how = opts.how,
    allowed = "equal"}, not at, at and ("%s%s, %s expected"):format(at ~= "" and at .. " is " or "", short(a),
      short(b)))
end

--- Neither nil nor false.
function methods:is_true(given)
  local opts = read("is_true", given)
  if self.value == nil then return missing(self, "is_true", opts) end
  return judged(self, "is_true", {figure = self.value and "yes" or "no", source = opts.source, how = opts.how,
    allowed = "yes"}, self.value, "not true")
end

-- What a call that must fail did: {returned = value} | {message, status} | {raised = message}.
local function outcome(self)
  if self.failure then return {message = self.failure.message, status = self.failure.details.status} end
  if type(self.value) ~= "function" then return {returned = self.value} end
  local found = table.pack(pcall(self.value))
  if not found[1] then return {raised = tostring(found[2])} end
  if found[2] ~= nil and found[2] ~= false then return {returned = found[2]} end
  return {message = found[3], status = type(found[4]) == "table" and found[4].status or nil}
end

--- A function, or what a call returned, that must fail: with a status word, with a text in its message, or
--- by raising an error with a text: {status = "io", message = "...", raises = "..."}.
function methods:fails_with(status, message, given)
  local wanted = type(status) == "table" and status or {status = status, message = message}
  local opts = read("fails_with", type(status) == "table" and status or given, {status = {type = "string"},
    message = {type = "string"}, raises = {type = "string"}})
  for _, key in ipairs {"status", "message"} do
    if wanted[key] ~= nil and type(wanted[key]) ~= "string" then
      raise(("fails_with: the %s: a text expected, got %s"):format(key, core.got(wanted[key])))
    end
  end
  local got, fault = outcome(self), nil
  if got.returned ~= nil then
    fault = ("it did not fail: %s"):format(short(got.returned))
  elseif wanted.raises then
    if not got.raised then fault = ("it raised nothing; it returned nil, %s"):format(short(got.message))
    elseif not got.raised:find(wanted.raises, 1, true) then
      fault = ("it raised %s, an error with %s expected"):format(short(got.raised), short(wanted.raises))
    end
  elseif got.raised then
    fault = ("it raised an error: %s"):format(got.raised)
  elseif wanted.status and got.status ~= wanted.status then
    fault = ("status %s, %s expected: %s"):format(tostring(got.status), wanted.status, tostring(got.message))
  elseif wanted.message and not tostring(got.message):find(wanted.message, 1, true) then
    fault = ("its message is %s, one with %s expected"):format(short(got.message), short(wanted.message))
  end
  local allowed = wanted.raises and "raises " .. short(wanted.raises)
    or "fails" .. (wanted.status and " with " .. wanted.status or "")
      .. (wanted.message and ": " .. short(wanted.message) or "")
  return judged(self, "fails_with", {figure = tostring(got.raised or got.message or short(got.returned)),
    source = opts.source, how = opts.how, allowed = allowed}, not fault, fault)
end

local function checked_modes(self, found, opts)
  local entry = {relative = opts.relative, source = opts.source, how = opts.how,
    allowed = ("frequencies within %s, shapes within %s"):format(show(opts.relative), opts.shapes == false and
      "anything" or show(opts.shapes))}
  if found.message then return judged(self, "same_modes", entry, false, found.message) end
  entry.figure, entry.lean = plain(found.frequency), plain(found.shape)
  local faults = {}
  if numbers.over(found.frequency, opts.relative) then
    faults[1] = ("the frequency of mode %d is apart by %s, at most %s expected"):format(found.at,
      show(found.frequency, 3), show(opts.relative))
  end
  if opts.shapes ~= false and numbers.over(found.shape, opts.shapes) then
    local first, last = found.group[1], found.group[2]
    faults[#faults + 1] = ("%s: apart by an angle whose sine is %s, at most %s expected%s"):format(first == last
      and ("the shape of mode %d"):format(first) or ("the shapes of modes %d to %d together"):format(first, last),
      show(found.shape, 3), show(opts.shapes), found.is_last and " (the last group may be cut by the number of "
      .. "modes: ask for one more, or {last = false})" or "")
  end
  return judged(self, "same_modes", entry, #faults == 0, table.concat(faults, "; "))
end

--- The same modes as others, whatever the signs, and whatever the order and the mix of those whose
--- frequencies are nearer than `degenerate`: frequencies within `relative`, and of each group the space
--- that it spans, by the sine of the angle between, within `shapes` (false: not compared).
function methods:same_modes(other, given)
  local opts = read("same_modes", given, {relative = {type = "number", min = 0, default = 1e-6},
    degenerate = {type = "number", min = 0, default = 1e-4}, shapes = {type = "any", default = 1e-3},
    last = {type = "boolean", default = true}})
  if opts.shapes ~= false and type(opts.shapes) ~= "number" then
    raise("same_modes: option 'shapes': a number or false expected, got " .. core.got(opts.shapes))
  end
  if self.value == nil then return missing(self, "same_modes", opts) end
  for _, object in ipairs {self.value, other} do
    if core.class_name(object) ~= "modes" then
      raise("same_modes: modes, as part:modes() returns them, expected, got " .. core.got(object))
    end
  end
  if other == nil then raise "same_modes: modes to compare with expected, got nil" end
  local found = modes.compare(self.value, other, opts)
  return checked_modes(self, found, opts)
end

--- What was measured before: a number, text, array, table of these, a static result or modes, kept in
--- the folder baselines beside the file and written by `barwright test --update`.
function methods:matches_baseline(name, given)
  local opts = read("matches_baseline", given, {relative = {type = "number", min = 0},
    absolute = {type = "number", min = 0}, degenerate = {type = "number", min = 0, default = 1e-4},
    shapes = {type = "number", min = 0, default = 1e-3}, last = {type = "boolean", default = true}})
  if type(name) ~= "string" or not name:match "^[%w_][%w_. -]*$" then
    raise("matches_baseline: a name of letters, digits, '_', '-', '.' and spaces expected, got " .. core.got(name))
  end
  if not opts.relative and not opts.absolute then opts.relative = 1e-9 end
  if self.value == nil then return missing(self, "matches_baseline", opts) end
  local running = record.running "expect"
  running.baselines = running.baselines or {}
  if running.baselines[name] then
    raise(("matches_baseline: '%s' was compared before in this scenario"):format(name))
  end
  running.baselines[name] = true
  local entry = {source = opts.source, how = opts.how, relative = opts.relative, absolute = opts.absolute,
    allowed = tolerance_text(opts), baseline = name}
  local path = baseline.path(running.scenario_file, name)
  local fault, written, figure = baseline.compare(path, self.value, opts, running.options.update)
  entry.figure, entry.written = plain(figure), written
  self.what = self.what or ("baseline %s"):format(name)
  return judged(self, "matches_baseline", entry, not fault, fault)
end

arguments.methods("expectation", methods, Expectation, {below = "bound: any, options?: options",
  above = "bound: any, options?: options", between = "min: any, max: any, options?: options",
  near = "reference: any, options?: options", equals = "other: any, options?: options",
  is_true = "options?: options",
  fails_with = "status: any, message?: any, options?: options", same_modes = "other: any, options?: options",
  matches_baseline = "name: string, options?: options"})

return expect
