-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Results that can be run again: a folder with result.json (plain numbers, unit in the key) and
-- manifest.json (what made them). Files are written beside their target and renamed.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local input_files = require "barwright.input_files"
local json = require "barwright.json"
local options = require "barwright.options"
local required_files = require "barwright.required_files"
local writable = require "barwright.writable"

local results = {}
results.__index = results
results.__name = "results"

local function first_line(path, pattern)
  local file = io.open(path)
  if not file then return nil end
  for line in file:lines() do
    local value = line:match(pattern)
    if value then
      file:close()
      return value
    end
  end
  file:close()
end

local function machine()
  local processors = 0
  local file = io.open "/proc/cpuinfo"
  if file then
    for line in file:lines() do
      if line:match "^processor%s*:" then processors = processors + 1 end
    end
    file:close()
  end
  local kilobytes = first_line("/proc/meminfo", "^MemTotal:%s*(%d+)")
  return {
    processor = first_line("/proc/cpuinfo", "^model name%s*:%s*(.+)"),
    processors = processors,
    memory_bytes = kilobytes and tonumber(kilobytes) * 1024,
    system = first_line("/etc/os-release", '^PRETTY_NAME="?([^"]+)'),
  }
end

local function library_versions()
  local text = core.library_versions()
  local lines = json.list {}
  for line in (text or ""):gmatch "[^\n]+" do lines[#lines + 1] = line end
  return lines
end

--- Peak memory of the process in bytes, or nil where the system does not tell.
function results.peak_memory()
  local kilobytes = first_line("/proc/self/status", "^VmHWM:%s*(%d+)")
  return kilobytes and tonumber(kilobytes) * 1024
end

--- What a run depends on besides its script and its inputs.
function results.surroundings()
  return {
    program = "barwright",
    version = core.version,
    commit = core.commit ~= "" and core.commit or json.null,
    libraries = library_versions(),
    required = json.list(required_files.list()),
    threads = core.threads(),
    machine = machine(),
  }
end

-- The words behind the program's name that this run was started by: script or command, its arguments.
local function started_by()
  local words = json.list {}
  if type(arg) ~= "table" or type(arg[0]) ~= "string" or arg[-1] == nil then return words end
  for i = 0, #arg do words[i + 1] = tostring(arg[i]) end
  return words
end

local rules = {script = {type = "string"}, inputs = {type = "table", default = {}},
  options = {type = "table", default = {}}, seed = {type = "any"}}

--- A folder for results; made when it is missing.
--- inputs: files to be named with their SHA-256; options: what the script was asked for; seed; script: its
--- name, where it is not the file that runs.
function results.open(folder, about)
  about = options.read("results.open", about, rules)
  if about.seed ~= nil and about.seed ~= json.null and math.type(about.seed) ~= "integer" then
    core.raise("results.open: option 'seed': a whole number, or bw.json.null where there is none, expected, got "
      .. core.got(about.seed))
  end
  local ok, message = core.make_folder(folder)
  if not ok then return nil, message, {status = "io", file = folder} end
  -- A folder that nothing can be written into is found now, not after the work.
  local fits, why, details = writable(folder .. "/result.json")
  if not fits then return nil, why, details end
  local self = setmetatable({folder = folder}, results)
  local files, message_of, details_of = input_files.digests(about.inputs)
  if not files then return nil, message_of, details_of end
  local words = started_by()
  self.manifest = results.surroundings()
  self.manifest.started_by = words -- what `barwright rerun` runs again
  self.manifest.script = about.script or words[1]
  self.manifest.script_sha256 = words[1] and core.sha256(words[1]) or json.null
  self.manifest.folder = folder
  self.manifest.inputs = json.list(files)
  self.manifest.options = about.options
  self.manifest.seed = about.seed or json.null
  return self
end

--- The path of a file in the folder.
function results:path(name)
  return self.folder .. "/" .. name
end

--- Writes result.json and manifest.json.
function results:write(result)
  self.manifest.required = json.list(required_files.list()) -- some are loaded after the folder was opened
  local ok, message, details =
    core.write_file(self:path "result.json", json.encode(result, "  ") .. "\n")
  if not ok then return nil, message, details end
  return core.write_file(self:path "manifest.json", json.encode(self.manifest, "  ") .. "\n")
end

function results:__tostring()
  return "results in " .. self.folder
end

arguments.methods("results", results, results, {path = "name: string", write = "result: table"})
arguments.functions("results.", results, {open = "folder: string, about?: options"})

return results
