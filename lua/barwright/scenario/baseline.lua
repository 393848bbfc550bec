-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Baselines: what a scenario measured once, as JSON in baselines/FILE/NAME.json beside the scenario file.
-- A baseline is rewritten only where it is missing or the figures are outside the tolerance, so that
-- updating changes no file without need.
local core = require "barwright.core"
local files = require "barwright.scenario.files"
local json = require "barwright.json"
local modes = require "barwright.scenario.modes"
local numbers = require "barwright.scenario.numbers"
local read_file = require "barwright.read_file"

local baseline = {}

local max_values = 20000 -- of one array; of longer ones as many rows, evenly spaced

function baseline.path(scenario_file, name)
  local folder, stem = files.split(scenario_file)
  return ("%s/baselines/%s/%s.json"):format(folder, stem, name)
end

-- ---- what is kept of a value -------------------------------------------------------------------------------

local function rows_of(array)
  local count, columns = array.row_count, array.column_count
  local wanted = math.max(1, max_values // columns)
  if count <= wanted then return array:totable(), nil end
  local picked, every = {}, count / wanted
  for i = 1, wanted do picked[i] = math.floor((i - 1) * every) + 1 end
  return array:gather(core.array.new(picked)):totable(), wanted
end

local function of_array(array)
  local rows, picked = rows_of(array)
  local out = json.list {}
  for i, row in ipairs(rows) do
    if type(row) == "table" then
      out[i] = json.list {}
      for k, x in ipairs(row) do out[i][k] = numbers.plain(x) end
    else
      out[i] = numbers.plain(row)
    end
  end
  return {["barwright"] = "array", rows = array.row_count, columns = array.column_count, rows_kept = picked,
    values = out, norm = picked and array:norm() or nil}
end

local function of_modes(value)
  local shapes = json.list {}
  for i = 1, value.count do shapes[i] = of_array(value:shape(i)) end
  return {["barwright"] = "modes", frequencies = of_array(value.frequencies), shapes = shapes}
end

local function of_static(value)
  return {["barwright"] = "static", displacement = of_array(value.displacement),
    von_mises = of_array(value.von_mises)}
end

--- The value as JSON can hold it.
function baseline.snapshot(value, where)
  local kind = type(value)
  if kind == "number" then return numbers.plain(value) end
  if kind == "string" or kind == "boolean" then return value end
  local class = core.class_name(value)
  if class == "array" then return of_array(value) end
  if class == "modes" then return of_modes(value) end
  if class == "static" then return of_static(value) end
  local meta = getmetatable(value)
  if kind ~= "table" or meta then
    local name = class or type(meta) == "table" and meta.__name and meta.__name:match "[^.]+$" or kind
    core.raise(("matches_baseline: %sa %s cannot be kept: give the numbers of it that matter, "
      .. "{mass = ..., stress = ...}"):format(where and where .. ": " or "", name))
  end
  local is_list, out = #value > 0, {}
  for key, item in pairs(value) do
    if is_list and math.type(key) ~= "integer" or not is_list and type(key) ~= "string" then
      core.raise(("matches_baseline: %sa table with names, or a list, expected, got the key %s"):format(
        where and where .. ": " or "", core.got(key)))
    end
    out[key] = baseline.snapshot(item, where and ("%s.%s"):format(where, key) or tostring(key))
  end
  return is_list and json.list(out) or out
end

-- ---- comparing ---------------------------------------------------------------------------------------------

local function flat(array)
  local out = {}
  for _, row in ipairs(array.values) do
    if type(row) == "table" then table.move(row, 1, #row, #out + 1, out) else out[#out + 1] = row end
  end
  for i, x in ipairs(out) do
    out[i] = tonumber(x) or x == "inf" and math.huge or x == "-inf" and -math.huge or 0 / 0
  end
  return out
end

local function as_modes(before)
  local function array(a)
    local rows = {}
    for i, row in ipairs(a.values) do rows[i] = row end
    return core.array.new(rows)
  end
  local frequencies = flat(before.frequencies)
  return {count = #frequencies, frequencies = frequencies,
    shape = function(_, i) return array(before.shapes[i]) end}
end

local compare

local function compare_arrays(now, before, opts, at)
  if now.rows ~= before.rows or now.columns ~= before.columns then
    return ("%s%d x %d values, %s x %s expected"):format(at, now.rows, now.columns, tostring(before.rows),
      tostring(before.columns)), math.huge
  end
  local a, b = flat(now), flat(before)
  local max, size, place = numbers.largest(a, b)
  local figure = size > 0 and max / size or max
  if max <= math.max(opts.absolute or 0, (opts.relative or 0) * size) then return nil, figure end
  local x, y = numbers.apart(a[place], b[place])
  return ("%svalue %d is %s, %s expected: apart by %s of the largest"):format(at, place, x, y,
    numbers.show(figure, 3)), figure
end

local function compare_modes(now, before, opts, at)
  local found = modes.compare(as_modes(now), as_modes(before), opts)
  if found.message then return at .. found.message, math.huge end
  if numbers.over(found.frequency, opts.relative or math.huge) then
    return ("%sthe frequency of mode %d is apart by %s"):format(at, found.at, numbers.show(found.frequency, 3)),
      found.frequency
  end
  if numbers.over(found.shape, opts.shapes) then
    return ("%sthe shapes of modes %d to %d are apart by an angle whose sine is %s"):format(at, found.group[1],
      found.group[2], numbers.show(found.shape, 3)), found.frequency
  end
  return nil, found.frequency
end

local function compare_tables(now, before, opts, at)
  local keys, worst = {}, 0
  for key in pairs(now) do keys[#keys + 1] = key end
  for key in pairs(before) do if now[key] == nil then keys[#keys + 1] = key end end
  table.sort(keys, function(a, b)
    if type(a) == type(b) then return a < b end
    return tostring(a) < tostring(b)
  end)
  for _, key in ipairs(keys) do
    local fault, figure = compare(now[key], before[key], opts, at .. tostring(key) .. ": ")
    worst = math.max(worst, figure or 0)
    if fault then return fault, worst end
  end
  return nil, worst
end

-- What is wrong, or nil; and by how much numbers are apart at most, relative.
function compare(now, before, opts, at)
  if now == nil then return at .. "is not there any more", math.huge end
  if before == nil then return at .. "is not in the baseline", math.huge end
  if type(now) == "number" and type(before) == "number" then
    local off = math.abs(now - before)
    local figure = now == before and 0 or off / math.abs(before)
    if now == before or off <= math.max(opts.absolute or 0, (opts.relative or 0) * math.abs(before)) then
      return nil, figure
    end
    local a, b = numbers.apart(now, before)
    return ("%s%s, %s expected: apart by %s"):format(at, a, b, numbers.show(figure, 3)), figure
  end
  if type(now) == "table" and type(before) == "table" then
    if now.barwright ~= before.barwright then return at .. "another kind of value", math.huge end
    if now.barwright == "array" then return compare_arrays(now, before, opts, at) end
    if now.barwright == "modes" then return compare_modes(now, before, opts, at) end
    return compare_tables(now, before, opts, at)
  end
  if now == before then return nil, 0 end
  return ("%s%s, %s expected"):format(at, tostring(now), tostring(before)), math.huge
end

local function write(path, snapshot)
  local ok, message = files.make_folder((path:match "^(.*)/"))
  if not ok then return message end
  ok, message = core.write_file(path, json.encode(snapshot, "  ") .. "\n")
  return not ok and message or nil
end

--- What is wrong, or nil; whether the baseline was written; how far figures are apart at most.
function baseline.compare(path, value, opts, update)
  local snapshot = baseline.snapshot(value)
  local text = read_file(path)
  if not text then
    if update then return write(path, snapshot), true, 0 end
    return ("there is no %s: `barwright test --update` writes it"):format(path), false, nil
  end
  local before, why = json.decode(text)
  if before == nil then
    if update then return write(path, snapshot), true, 0 end
    return ("%s: %s"):format(path, tostring(why)), false, nil
  end
  local fault, figure = compare(snapshot, before, opts, "")
  if fault and update then return write(path, snapshot), true, 0 end
  return fault and ("%s (%s)"):format(fault, path), false, figure
end

return baseline
