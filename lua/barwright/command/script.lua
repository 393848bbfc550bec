-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The command line of a script, read by the rules of the program's commands:
--
--   local script = require "barwright.command.script"
--   local opts = script.read {summary = "one line", about =, arguments =, options =, examples =}
--
-- The table is that of a command (arguments.lua) without `run`. --help is every script's. What is not understood
-- ends the script before it computes: one sentence on standard error, exit status 2.
local arguments = require "barwright.command.arguments"
local core = require "barwright.core"
local help_text = require "barwright.command.help_text"
local output = require "barwright.command.output"
local results = require "barwright.results"

local script = {}

--- The exit statuses of a refused input and of Ctrl-C.
script.REFUSED, script.INTERRUPTED = output.MISUSED, output.INTERRUPTED

--- Options that several scripts have.
script.option = {
  out = {name = "out", value = "DIR", type = "folder",
    what = "where result.json and manifest.json go (default: printed only)"},
  needed_out = {name = "out", value = "DIR", type = "folder", needed = true, what = "where the results go"},
  json = {name = "json", value = "FILE", type = "file", what = "where the figures go, too"},
  threads = {name = "threads", value = "N", type = "integer", min = 1, max = 64,
    what = "number of threads (default: BARWRIGHT_THREADS, or one for each processor)"},
}

-- "agile" for scripts/agile/run.lua, "drops" for scripts/bench/drops.lua.
local function name()
  local path = arg and arg[0] or "script"
  return path:match "([^/]+)/run%.lua$" or path:match "([^/]+)%.lua$" or path:match "[^/]+$"
end

--- Ends the script with an exit status, after one sentence on standard error.
function script.stop(status, message)
  io.stdout:flush()
  io.stderr:write(name(), ": ", (tostring(message):gsub("%s*\n%s*", " ")), "\n")
  os.exit(status, true)
end

--- Ends it where the input is refused.
function script.refuse(message)
  script.stop(script.REFUSED, message)
end

--- Ends it with a status, or as interrupted where the details of the failure say so.
function script.fail(status, message, details)
  local cancelled = core.interrupted() or type(details) == "table" and details.status == "cancelled"
  script.stop(cancelled and script.INTERRUPTED or status, message)
end

--- The results of f. What f raises is misuse of the options: the script ends as refused, or as interrupted.
function script.checked(f, ...)
  local values = table.pack(pcall(f, ...))
  if not values[1] then script.fail(script.REFUSED, (tostring(values[2]):gsub("^[^:]+:%d+: ", ""))) end
  return table.unpack(values, 2, values.n)
end

--- Runs the script: main returns an exit status, or nothing for 0. Where it raises, the status is `failed`.
function script.run(main, failed)
  io.stdout:setvbuf "line"
  local ok, status = xpcall(main, debug.traceback)
  if core.interrupted() then script.stop(script.INTERRUPTED, "interrupted") end
  if not ok then script.stop(failed, status) end
  os.exit(status or 0, true)
end

-- The table of script.read.
local read

--- A folder for results (results.lua): its manifest has the options of script.read but for the paths, which belong
--- to a machine. nil, message, details where it cannot be made.
function script.results(folder, opts, about)
  about.options = {}
  for key, value in pairs(opts) do about.options[key] = value end
  for _, list in ipairs {read.options or {}, read.arguments or {}} do
    for _, rule in ipairs(list) do
      if rule.type == "file" or rule.type == "folder" then about.options[arguments.key(rule.name)] = nil end
    end
  end
  return results.open(folder, about)
end

--- The options of `arg`, by their names with "_" for "-".
function script.read(about)
  read = about
  about.common = {{name = "help", type = "flag", what = "this text"}}
  local fault = arguments.fault(about)
  if fault then core.raise(("script: the table of options: %s"):format(fault)) end
  local opts, message = arguments.parse(about, arg)
  if not opts then script.refuse(message .. " (see --help)") end
  if opts.help then
    print(help_text.of(arg[0], about))
    os.exit(0, true)
  end
  opts.help, opts.given = nil, nil
  if opts.threads then core.threads(opts.threads) end
  return opts
end

return script
