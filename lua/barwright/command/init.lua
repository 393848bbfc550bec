-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The commands of the program, `barwright NAME ...`: which there are, and how one is run. Each is a module
-- barwright.command.NAME that returns data (see arguments.lua); help, completion and the man page are
-- made from it.
local core = require "barwright.core"
local arguments = require "barwright.command.arguments"
local help_text = require "barwright.command.help_text"
local output = require "barwright.command.output"

local commands = {}

-- In the order of help. What is not installed is left out.
local list = {"check", "worst", "strengthen", "modes", "statics", "buckle", "respond", "drop", "heat",
  "convert", "materials", "open", "live", "new", "test", "study", "rerun", "completion", "manual", "help"}

--- What the program itself understands before a command or a script.
commands.program_options = {
  {name = "e", short = true, value = "STATEMENTS", what = "run them (the module is loaded as bw)"},
  {name = "i", short = true, type = "flag", what = "open the prompt after the script or the statements"},
  {name = "gc-stress", type = "flag",
    what = "run the whole collector at every allocation (slow; for tests)"},
  {name = "mpi", type = "flag",
    what = "under mpirun: rank 0 runs the script, the other ranks work for its solves"},
  {name = "sandbox", value = "FOLDER",
    what = "let the script or command use no file outside of the folder, and start nothing"},
  {name = "memory", value = "SIZE", what = "let it have so much memory: 500M, 2G"},
  {name = "seconds", value = "TIME", what = "let it run so long: 60, 5min; then it is stopped (exit status 124)"},
  {name = "version", type = "flag", what = "versions of barwright and of the libraries it stands on"},
  {name = "help", type = "flag", what = "this text; `barwright NAME --help` describes a command"},
}

local function module_of(name)
  return "barwright.command." .. name
end

local present = {}

--- Whether there is a command of the name.
function commands.known(name)
  for _, known in ipairs(list) do
    if known == name then
      if present[name] == nil then
        present[name] = package.loaded[module_of(name)] ~= nil
          or package.searchpath(module_of(name), package.path) ~= nil
      end
      return present[name]
    end
  end
  return false
end

--- The names of the commands that are there.
function commands.names()
  local names = {}
  for _, name in ipairs(list) do
    if commands.known(name) then names[#names + 1] = name end
  end
  return names
end

--- The data of a command.
function commands.load(name)
  return require(module_of(name))
end

--- The rest of a sentence that says that a word is no command.
function commands.suggestion(word)
  return core.suggestion(word, commands.names())
end

--- The text of `barwright --help`.
function commands.help()
  local lines = {"usage: barwright COMMAND ...            a command, see below",
    "       barwright [options] [SCRIPT.lua [arguments]]", "", "commands:"}
  local rows = {}
  for i, name in ipairs(commands.names()) do rows[i] = {name, commands.load(name).summary} end
  help_text.table_of(rows, lines)
  lines[#lines + 1] = ""
  lines[#lines + 1] = "options:"
  rows = {}
  for i, rule in ipairs(commands.program_options) do
    local text = help_text.option(rule)
    rows[i] = {rule.short and text:sub(2) or text, rule.what .. help_text.notes(rule)}
  end
  help_text.table_of(rows, lines)
  for _, line in ipairs {"",
    "Without a script or a command: a prompt. A script sees its arguments in the table arg;",
    "one whose file is named like a command is run as ./NAME.",
    "Environment: BARWRIGHT_THREADS (number of threads), BARWRIGHT_QUIET=1 (no progress), BARWRIGHT_UNIT (the",
    "unit of surfaces that have none, as --unit).",
    "Exit status of a command: 0 yes, it holds, or done; 1 the answer is no, it breaks, or the error",
    "leaves it open; 2 misuse or refused; 3 it could not be computed, or a file could not be read or",
    "written; 130 after Ctrl-C. Of a script: what it gives os.exit, 1 after an error, 3 where it cannot",
    "be read, or what it prints cannot be written."} do
    lines[#lines + 1] = line
  end
  return table.concat(lines, "\n")
end

-- Whether --json stands among the words: also where they cannot be read.
local function wants_json(words)
  for _, word in ipairs(words) do
    if word == "--" then return false end
    if word == "--json" then return true end
  end
  return false
end

-- An error that a command did not expect: its fault, not that of who runs it.
local function trace(problem)
  if type(problem) == "string" or type(problem) == "number" then
    return debug.traceback(tostring(problem), 2)
  end
  return problem
end

-- Commands that start servers or jobs.
local not_in_sandbox = {live = true, open = true, test = true, study = true, rerun = true}

--- Runs a command with the words behind its name; returns the exit code.
function commands.run(name, ...)
  local words = {...}
  local command = commands.load(name)
  local opts, message = arguments.parse(command, words)
  if not opts then
    local out = output.create(name, {json = wants_json(words)})
    return out:finish(out:misuse(message))
  end
  if opts.help then
    print(help_text.of(name, command))
    return output.DONE
  end
  if core.confined() and not_in_sandbox[name] then
    local out = output.create(name, opts)
    return out:finish(out:fail("it starts other processes, and is refused in the sandbox (a script is not)",
      {status = "unsupported"}))
  end
  if opts.quiet then core.progress(function() end) end
  local out = output.create(name, opts)
  if opts.json then
    -- Only the object goes to standard output; what a script prints goes beside it.
    rawset(_G, "print", function(...)
      local texts = table.pack(...)
      for i = 1, texts.n do texts[i] = tostring(texts[i]) end
      io.stderr:write(table.concat(texts, "\t"), "\n")
    end)
  end
  local ok, code = xpcall(command.run, trace, opts, out)
  if not ok then
    if core.interrupted() then
      code = out:fail("interrupted", {status = "cancelled"})
    elseif tostring(code):find("not enough memory", 1, true) then
      code = out:fail("not enough memory", {status = "memory"})
    else
      code = out:fail(tostring(code) .. "\nThis is a fault of barwright: please report it.",
        {status = "internal"})
    end
  elseif code == nil or code == true then
    code = output.DONE
  elseif code == false then
    code = output.NO
  end
  if core.interrupted() then code = output.INTERRUPTED end -- what the program ends with in any case
  return out:finish(code)
end

return commands
