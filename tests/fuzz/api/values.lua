-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Plausible arguments from the stubs' types and from the good ones in good.lua, and what spoils them.
local files = require "files"
local good = require "good"
local hostile = require "hostile"
local types = require "types"

local values = {}

local classes -- of the stubs, by name

function values.begin(by_name)
  classes = by_name
end

local integers = {1, 1, 1, 2, 2, 3, 4, 5, 8, 0, -1}
local numbers = {0.1, 0.5, 1, 1, 2, 0.01, 0.25, 3, 10, 1e-3, 0, -1, 1e6}
local paths = {"a.vtu", "a.stl", "a.obj", "a.ply", "a.off", "a.msh", "a.mesh", "a.node", "a.inp", "a.png",
  "a.svg",
  "a.dxf", "a.tgf", "a.bwm", "a.html", "a.csv", "a.lua", "a.json", "a.wav", "a.study", "a", "folder/a.vtu",
  "good.stl", "good.vtu", "good.svg", "good.tgf", "good.bwm", "good.png", "good.study", "good.lua", "good.msh"}
local texts = {"a", "x", "y", "upper", "lower", "boundary", "fixed", "pull", "mass", "steel", "C5", "x + y",
  "x^2 - 1",
  "m", "mm", "auto", "max x", "von_mises", "done", "history", "#ff0000", "line", "stress", "nobody"}

local path_names = {path = true, into = true, folder = true, file = true}

local of_type

local function number_list(random, count)
  local list = {}
  for i = 1, count do list[i] = random:one_of(numbers) end
  return list
end

local basic = {
  integer = function(random) return random:one_of(integers) end,
  number = function(random) return random:one_of(numbers) end,
  string = function(random, _, name)
    if path_names[name] then return files.path(random:one_of(paths)) end
    return random:one_of(texts)
  end,
  ["true"] = function() return true end,
  ["false"] = function() return false end,
  boolean = function(random) return random:chance(0.5) end,
  table = function(random, pool)
    return random:one_of {{}, number_list(random, 3), {{0, 0}, {1, 0}, {1, 1}}, {{0, 0, 0}, {1, 0, 0}, {0, 1,
      0}},
      {vertex = 1}, {loop = 1}, {edges = {1}}, {min = {0, 0, 0}}, {pool:get "bw.Array"}}
  end,
  any = function(random, pool, _, about)
    return random:one_of {1, "a", {}, {a = 1, {2}}, true, pool:any(random), random:one_of(numbers),
      hostile.value(random, pool, about) or 0}
  end,
  ["bw.Vector"] = function(random, pool)
    if random:chance(0.1) then return pool:get "bw.Array" end
    return random:one_of {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {0.5, 0.05, 0.05},
      number_list(random, 3),
      {0, 0}, {0.5, 0.5}}
  end,
  ["bw.Box"] = function() return {min = {0, 0, 0}, max = {1, 1, 1}} end,
}

local function record(random, pool, fields, about)
  local out = {}
  local p = random:one_of {0.15, 0.3, 0.6}
  for _, field in ipairs(fields) do
    if not field.optional or random:chance(p) then
      out[field.name] = of_type(random, pool, field.type, field.name, about)
    end
  end
  return out
end

local function class_fields(class)
  if not class.parsed then
    class.parsed = {}
    for i, field in ipairs(class.fields) do
      class.parsed[i] = {name = field.name, optional = field.optional, type = types.parse(field.type)}
    end
    local more = class.parent and class_fields(classes[class.parent]) or {}
    table.move(more, 1, #more, #class.parsed + 1, class.parsed)
  end
  return class.parsed
end

local makers = {
  none = function() return nil end,
  word = function(_, _, one) return one.word end,
  number = function(_, _, one) return one.number end,
  callback = function(random, _, _, _, about) return hostile.callback(random, about) end,
  record = function(random, pool, one, _, about) return record(random, pool, one.fields, about) end,
  list = function(random, pool, one, name, about)
    local list = {}
    for i = 1, random:one_of {0, 1, 1, 2, 2, 3, 4} do list[i] = of_type(random, pool, one.of, name, about) end
    return list
  end,
  map = function(random, pool, one, name, about)
    local map = {}
    for _ = 1, random:one_of {0, 1, 2} do
      local key = of_type(random, pool, one.key, name, about)
      if key ~= nil and key == key then map[key] = of_type(random, pool, one.value, name, about) end
    end
    return map
  end,
  name = function(random, pool, one, name, about)
    if basic[one.name] then return basic[one.name](random, pool, name, about) end
    if pool:has(one.name) then return pool:get(one.name, random) end
    if classes[one.name] then return record(random, pool, class_fields(classes[one.name]), about) end
    return basic.any(random, pool, name, about) -- a name that the stubs do not explain
  end,
}

function of_type(random, pool, union, name, about)
  local one = random:one_of(union)
  return makers[one.kind](random, pool, one, name, about)
end

-- ---- spoiling -----------------------------------------------------------------------------------

local function keys_of(t)
  local keys = {}
  for key in next, t do keys[#keys + 1] = key end
  table.sort(keys, function(a, b)
    if type(a) == type(b) and (type(a) == "number" or type(a) == "string") then return a < b end
    return type(a) .. tostring(a) < type(b) .. tostring(b)
  end)
  return keys
end

local function spoiled_text(random, text)
  local at = random:integer(#text + 1)
  return random:one_of {text .. "x", text:sub(1, at - 1), text .. "\0", text:upper(), (text:gsub("[/.]", "_")),
    random:one_of(hostile.texts)}
end

-- The value, or one like it with one thing changed.
local function spoiled(random, pool, value, about)
  local kind = type(value)
  if kind == "table" and not getmetatable(value) and random:chance(0.8) then
    local keys = keys_of(value)
    local what = random:integer(10)
    if #keys == 0 or what == 1 then
      value[random:one_of {"unknown", 1, #value + 1, "name", "tolerance", 0}] = hostile.value(random, pool,
        about)
    elseif what == 2 then
      value[random:one_of(keys)] = nil
    elseif what == 3 and #value > 0 then
      value[#value + 1] = value[#value]
    else
      local key = random:one_of(keys)
      value[key] = spoiled(random, pool, value[key], about)
    end
    return value
  end
  if kind == "number" and random:chance(0.7) then
    if random:chance(0.3) then return value * random:one_of {-1, 2, 0.5, 1000, 1e-6, 0} end
    return random:one_of(hostile.numbers)
  end
  if kind == "string" and random:chance(0.6) then return spoiled_text(random, value) end
  if kind == "userdata" and random:chance(0.5) then return pool:like(value, random) end
  return hostile.value(random, pool, about)
end

-- ---- arguments ----------------------------------------------------------------------------------

-- A copy of a good argument, to be spoiled, whose paths lead into the batch's folder.
local function in_folder(value)
  if type(value) == "string" and (value:find "^good%." or value:find "^out%.") then return files.path(value) end
  if type(value) == "table" and not getmetatable(value) then
    local copy = {}
    for key, inner in next, value do copy[key] = in_folder(inner) end
    return copy
  end
  return value
end

local function plausible(random, pool, entry, about)
  local example = good[entry.name]
  if example and random:chance(0.8) then
    local list = table.pack(pcall(example, pool, random))
    if not list[1] then -- a call closed what it asks of
      pool:forget()
      list = table.pack(true, example(pool, random))
    end
    local packed = {n = list.n - 1}
    for i = 1, packed.n do packed[i] = in_folder(list[i + 1]) end
    return packed
  end
  local list = {n = #entry.params}
  for i, param in ipairs(entry.params) do
    if not param.optional or random:chance(0.6) then
      list[i] = of_type(random, pool, param.type, param.name, about)
    end
  end
  return list
end

--- A packed list of arguments for an entry.
function values.arguments(random, pool, entry, about)
  local way = random:uniform()
  if way < 0.08 then
    local list = {n = random:integer(5) - 1}
    for i = 1, list.n do list[i] = hostile.value(random, pool, about) end
    return list
  end
  local list = plausible(random, pool, entry, about)
  if way < 0.3 or list.n == 0 then return list end
  for _ = 1, way < 0.85 and 1 or 3 do
    local i = random:integer(list.n)
    list[i] = spoiled(random, pool, list[i], about)
  end
  if way > 0.97 then list.n = random:integer(list.n + 2) - 1 end
  return list
end

--- Text of a value for the log.
function values.describe(value, depth)
  depth = depth or 3
  local kind = type(value)
  local name = value ~= nil and (kind ~= "number" and kind ~= "string") and hostile.name(value)
  if name then return name end
  if kind == "string" then
    if #value > 60 then return ("%q..(%d)"):format(value:sub(1, 30), #value) end
    return (("%q"):format(value):gsub("\n", "n"))
  end
  if kind == "number" then return math.type(value) == "integer" and ("%d"):format(value)
    or ("%.17g"):format(value) end
  if kind == "table" and not getmetatable(value) then
    if depth == 0 then return "{...}" end
    local parts = {}
    for i, key in ipairs(keys_of(value)) do
      if i > 12 then
        parts[#parts + 1] = "..."
        break
      end
      local text = values.describe(rawget(value, key), depth - 1)
      parts[#parts + 1] = math.type(key) == "integer" and key == i and text
        or ("[%s]=%s"):format(values.describe(key, 0), text)
    end
    return "{" .. table.concat(parts, ", ") .. "}"
  end
  return kind
end

return values
