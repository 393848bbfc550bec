-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Files of scenarios: which there are under a path, what one states when it is loaded, and folders.
local core = require "barwright.core"
local script_file = require "barwright.script_file"
local files = {}

local MISSING <const> = 2 -- ENOENT

local function quoted(path)
  return "'" .. path:gsub("'", "'\\''") .. "'"
end
files.quoted = quoted

--- "file", "folder" or nil.
function files.kind(path)
  local file = io.open(path, "rb")
  if not file then return nil end
  local _, _, code = file:read(0)
  file:close()
  return code == 21 and "folder" or "file"
end

--- Makes a folder and those above it.
function files.make_folder(path)
  if files.kind(path) == "folder" then return true end
  os.execute("mkdir -p -- " .. quoted(path) .. " 2>/dev/null")
  if files.kind(path) == "folder" then return true end
  return nil, path .. ": cannot be made as a folder", {status = "io", file = path}
end

-- Folders for passing files, by their paths.
local open_folders = {}

--- A new folder for passing files; one that a killed process left is removed by the next run.
function files.scratch()
  local folder, message = core.temporary_folder()
  if not folder then core.raise(message) end
  open_folders[folder.path] = folder
  return folder.path
end

function files.remove_scratch(path)
  open_folders[path]:close()
  open_folders[path] = nil
end

--- The folder of a path ("." where it has none), and its name without ".lua".
function files.split(path)
  local folder, name = path:match "^(.*)/([^/]*)$"
  return folder and (folder == "" and "/" or folder) or ".", ((name or path):gsub("%.lua$", ""))
end

-- Helpers lie in folders named lib, what was measured before in folders named baselines.
local function is_scenario(path)
  return path:match "%.lua$" and not path:find "/lib/" and not path:find "/baselines/"
end

--- The scenario files that paths name (files, folders searched downwards), in the order of the paths and
--- within one by name; each once. nil, a message where a path is not there or a folder has none.
function files.find(paths)
  local list, seen = {}, {}
  local function add(path)
    if not seen[path] then
      seen[path] = true
      list[#list + 1] = path
    end
  end
  for _, path in ipairs(paths) do
    local kind = files.kind(path)
    if not kind then
      local _, why, number = io.open(path, "rb")
      return nil, number == MISSING and path .. ": there is no such file or folder" or why, {status = "io"}
    end
    if kind == "file" then
      local refusal = script_file.refusal(path)
      if refusal then return nil, refusal end
      add(path)
    else
      local top, found = path:gsub("(.)/+$", "%1"), {}
      local pipe = assert(io.popen("find " .. quoted((top:gsub("^%-", "./-"))) .. " -name '*.lua' -type f -print0 "
        .. "2>/dev/null"))
      for name in pipe:read "a":gmatch "[^%z]+" do
        if is_scenario(name:sub(#top + 1)) then found[#found + 1] = name end
      end
      pipe:close()
      if #found == 0 then return nil, path .. ": no scenario files (NAME.lua) in this folder" end
      table.sort(found)
      for _, name in ipairs(found) do add(name) end
    end
  end
  return list
end

-- Runs a scenario file with its own folder, and lib in it, where `require` looks first.
local function load(path, collection)
  local folder = files.split(path)
  package.path = ("%s/?.lua;%s/lib/?.lua;%s"):format(folder, folder, package.path)
  local chunk, why = loadfile(path, "t")
  if not chunk then return collection, (why:gsub("^cannot open ", "")) end
  local function located(message)
    if type(message) == "string" then return message end
    local meta = getmetatable(message)
    return type(meta) == "table" and meta.__tostring and tostring(message)
      or ("%s: raised a %s"):format(path, type(message))
  end
  local ok, message = xpcall(chunk, located)
  if not ok then
    -- an error of C code or of a helper does not name the file
    if not message:find(path, 1, true) then message = path .. ": " .. message end
    return collection, message
  end
  if #collection.list == 0 then
    return collection, path .. ": states no scenario (helpers belong into a folder named lib)"
  end
  return collection
end

--- What a file states: {file, title, text, list = {scenarios}}, and where something was wrong with it a
--- message with file and line.
function files.load(path)
  files.loading = {file = path, list = {}, titles = {}} -- where the file's calls put what they state
  local collection, message = load(path, files.loading)
  files.loading = nil
  return collection, message
end

return files
