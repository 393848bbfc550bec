-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What trials share and is expensive to make (a mesh, a library), kept in files. An entry is named by the
-- SHA-256 of what it is; who finds it reads it, who does not makes it while others wait for the same.
--
-- An entry is one file: a mark, the SHA-256 of the rest, the rest (pack.lua). It is written beside its
-- name and renamed, so that a half-written one is never seen, and one that is damaged is made again.
-- When the entries pass the limit, those that were used longest ago go.
local core = require "barwright.core"
local input_files = require "barwright.input_files"
local key = require "barwright.study.key"
local options = require "barwright.options"
local pack = require "barwright.study.pack"
local read_file = require "barwright.read_file"

local raise = core.raise

local cache = {}

local MARK = "barwright cache 1\n"
local WAIT = 7 * 86400 -- for whoever makes the same entry; it ends with that process
local ABANDONED = 86400 -- seconds after which what older versions left is removed

local rules = {
  folder = {type = "string"},
  bytes = {type = "number", default = 4e9, above = 0},
}

--- The options of a cache, completed. Without a folder of the user's own there is none, and everything is
--- made each time: what lies in a folder that all users share may be anybody's.
function cache.check(where, given)
  local opts = options.read(where .. ": cache", given, rules)
  if not opts.folder then
    local base = os.getenv "XDG_CACHE_HOME"
    local home = os.getenv "HOME"
    if not base or base:sub(1, 1) ~= "/" then base = home and home:sub(1, 1) == "/" and home .. "/.cache" end
    opts.folder = base and base .. "/barwright" or nil
  end
  return opts
end

local function read_entry(path)
  local text = read_file(path)
  if not text or text:sub(1, #MARK) ~= MARK then return false end
  local body = text:sub(#MARK + 65)
  if core.sha256_of(body) ~= text:sub(#MARK + 1, #MARK + 64) then return false end
  local value, message = pack.decode(body, path)
  if value == nil and message then return false end
  core.touch(path) -- used now
  return true, value
end

-- Entries and what was left behind, the one used longest ago first.
local function list_entries(folder)
  local now = os.time()
  local list, sum = {}, 0
  for _, part in ipairs(core.list_folder(folder) or {}) do
    if part.folder and #part.name == 2 then
      for _, entry in ipairs(core.list_folder(folder .. "/" .. part.name) or {}) do
        local path = folder .. "/" .. part.name .. "/" .. entry.name
        if #entry.name == 64 then
          list[#list + 1] = {path = path, bytes = entry.bytes, changed = entry.changed}
          sum = sum + entry.bytes
        elseif entry.name:find "%.lock$" then
          local lock = core.lock(path, 0) -- who gets it removes it
          if lock then lock:close() end
        elseif now - entry.changed > ABANDONED then
          os.remove(path)
        end
      end
    end
  end
  table.sort(list, function(a, b)
    if a.changed ~= b.changed then return a.changed < b.changed end
    return a.path < b.path
  end)
  return list, sum
end

-- Makes room, but not by what was just written.
local function trim(opts, newest)
  local list, sum = list_entries(opts.folder)
  for _, entry in ipairs(list) do
    if sum <= opts.bytes then return end
    if entry.path ~= newest and os.remove(entry.path) then sum = sum - entry.bytes end
  end
end

local function write_entry(opts, path, value)
  local body, why = pack.encode(value, path)
  if not body then
    raise(("cached: numbers, strings, tables of them, arrays, meshes, surfaces and libraries expected of the "
      .. "function, got %s"):format(why))
  end
  if #body > opts.bytes then return end
  if core.write_file(path, MARK .. core.sha256_of(body) .. body) then trim(opts, path) end
end

-- The name of an entry: what it is, the contents of files it is made of, and the program, since another
-- version may make it otherwise.
local function name_of(what, opts)
  local text, why = key.text(what)
  if not text or what == nil then
    raise(("cached: argument 1: a key of strings, numbers and tables of them expected, got a %s")
      :format(why or "nil"))
  end
  local parts = {MARK, core.version, core.commit, text}
  local files, message, details = input_files.digests(opts.files or {})
  if not files then return nil, message, details end
  for _, file in ipairs(files) do parts[#parts + 1] = file.sha256 end
  return core.sha256_of(table.concat(parts, "\0"))
end

-- Entries by path, while this process makes them: who waited for its own lock would wait for ever.
local making = {}

local get_rules = {files = {type = "table"}}

--- What `make` returns, made once for all processes. given.files: files whose content matters. Where the
--- folder cannot be used it is made every time.
function cache.get(opts, what, make, given)
  local own = options.read("cached", given, get_rules)
  if type(make) ~= "function" then raise("cached: argument 2: a function expected, got " .. core.got(make)) end
  local name, why, more = name_of(what, own)
  if not name then return nil, why, more end
  if not opts.folder then return make() end
  local folder = opts.folder .. "/" .. name:sub(1, 2)
  local path = folder .. "/" .. name
  local there, value = read_entry(path)
  if there then return value end
  if making[path] then
    raise "cached: the function asks for the entry that it computes: give the inner call another first argument"
  end
  local usable = core.make_folder(folder)
  local lock <close> = usable and core.lock(path .. ".lock", WAIT) or nil
  if lock then
    there, value = read_entry(path) -- somebody made it meanwhile
    if there then return value end
  elseif core.interrupted() then
    return nil, "cancelled", {status = "cancelled"}
  end
  making[path] = true
  local ended <close> = setmetatable({}, {__close = function() making[path] = nil end})
  local made, message, details = make()
  assert(ended)
  if made == nil and message ~= nil then return nil, message, details end
  if lock then write_entry(opts, path, made) end
  return made
end

return cache
