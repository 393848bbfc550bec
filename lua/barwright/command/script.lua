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

local script = {}

--- The exit status of a refused input.
script.REFUSED = 2

--- Options that several scripts have.
script.option = {
  out = {name = "out", value = "DIR", type = "folder",
    what = "where result.json and manifest.json go (default: printed only)"},
  needed_out = {name = "out", value = "DIR", type = "folder", needed = true, what = "where the results go"},
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

--- The options of `arg`, by their names with "_" for "-".
function script.read(about)
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
