-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Values as bytes and back, the same bits: nil, booleans, numbers, strings, tables of such, arrays,
-- meshes, surfaces, libraries of metamaterials. Objects of the engine travel in their own formats (VTU,
-- PLY, BWM), all of which return the bits that were written.
local core = require "barwright.core"
local read_file = require "barwright.read_file"

local pack = {}

local write, read

local function class_of(value)
  return core.class_name(value) or type(value)
end

local objects = {
  mesh = {ending = ".vtu", read = function(path) return core.mesh.read(path) end},
  surface = {ending = ".ply", read = function(path) return core.surface.read(path, {unit = "m"}) end,
    opts = {unit = "m"}},
  library = {ending = ".bwm", read = function(path) return core.metamaterial.read(path) end},
}

-- What is written through a file beside the cache's own.
local function object_text(value, class, scratch)
  local temporary <close>, why = core.temporary(scratch)
  if not temporary then error(why, 0) end
  local path = temporary.path .. objects[class].ending
  local ok, message = value:write(path, objects[class].opts)
  local text
  if ok then text, message = read_file(path) end
  if not text then error(message, 0) end
  return text
end

local function object_of(text, class, scratch)
  local temporary <close>, why = core.temporary(scratch)
  if not temporary then error(why, 0) end
  local path = temporary.path .. objects[class].ending
  local ok, message = core.write_file(path, text)
  local object
  if ok then object, message = objects[class].read(path) end
  if not object then error(message, 0) end
  return object
end

local function write_table(value, out, scratch, seen)
  if seen[value] then error("a table that contains itself", 0) end
  if getmetatable(value) then error("a table with a metatable", 0) end
  seen[value] = true
  local list = #value
  out[#out + 1] = string.pack("<c1i8", "t", list)
  for i = 1, list do write(value[i], out, scratch, seen) end
  for key, inner in pairs(value) do
    local in_list = math.type(key) == "integer" and key >= 1 and key <= list
    if not in_list then
      write(key, out, scratch, seen)
      write(inner, out, scratch, seen)
    end
  end
  out[#out + 1] = "e"
  seen[value] = nil
end

function write(value, out, scratch, seen)
  local class = class_of(value)
  if value == nil then out[#out + 1] = "n"
  elseif class == "boolean" then out[#out + 1] = value and "T" or "F"
  elseif class == "string" then out[#out + 1] = string.pack("<c1s8", "s", value)
  elseif math.type(value) == "integer" then out[#out + 1] = string.pack("<c1i8", "i", value)
  elseif class == "number" then out[#out + 1] = string.pack("<c1d", "d", value)
  elseif class == "table" then write_table(value, out, scratch, seen)
  elseif class == "array" then
    local format = ({f64 = "<f8", i32 = "<i4", i64 = "<i8", u8 = "<u1"})[value.type]
    out[#out + 1] = string.pack("<c1s1i8i8s8", "a", format, value.row_count, value.column_count,
      value:tostring(format))
  elseif objects[class] then
    out[#out + 1] = string.pack("<c1s1s8", "o", class, object_text(value, class, scratch))
  else
    error(("a %s"):format(class), 0)
  end
end

--- The bytes of a value. scratch: a path; objects on their way lie beside it. nil and what is in
--- the way where there is something that cannot be kept.
function pack.encode(value, scratch)
  local out = {}
  local ok, why = pcall(write, value, out, scratch, {})
  if ok then return table.concat(out) end
  return nil, tostring(why)
end

local function read_table(text, at, scratch)
  local list
  list, at = string.unpack("<i8", text, at)
  local out = {}
  for i = 1, list do out[i], at = read(text, at, scratch) end
  while text:sub(at, at) ~= "e" do
    local key
    key, at = read(text, at, scratch)
    out[key], at = read(text, at, scratch)
  end
  return out, at + 1
end

function read(text, at, scratch)
  local kind = text:sub(at, at)
  at = at + 1
  if kind == "n" then return nil, at end
  if kind == "T" then return true, at end
  if kind == "F" then return false, at end
  if kind == "s" then return string.unpack("<s8", text, at) end
  if kind == "i" then return string.unpack("<i8", text, at) end
  if kind == "d" then return string.unpack("<d", text, at) end
  if kind == "t" then return read_table(text, at, scratch) end
  if kind == "a" then
    local format, rows, columns, bytes, after = string.unpack("<s1i8i8s8", text, at)
    if rows == 0 then
      local type_of = ({["<f8"] = "f64", ["<i4"] = "i32", ["<i8"] = "i64", ["<u1"] = "u8"})[format]
      return core.array.zeros(0, columns, type_of), after
    end
    return core.array.from_string(format, bytes, columns), after
  end
  if kind == "o" then
    local class, bytes, after = string.unpack("<s1s8", text, at)
    return object_of(bytes, class, scratch), after
  end
  error("unknown bytes", 0)
end

--- The value of the bytes; nil and a message where they are none.
function pack.decode(text, scratch)
  local ok, value = pcall(read, text, 1, scratch)
  if ok then return value end
  return nil, tostring(value)
end

return pack
