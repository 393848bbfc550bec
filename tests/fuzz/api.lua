-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Calls all that the stubs name with generated arguments, in child processes.
--   build/barwright tests/fuzz/api.lua [options]
--     --calls N        how many calls (5000)
--     --seed S         of their choice (1)
--     --call N         only the call of this number, with all that it gives
--     --from M         with --call: those from M on before it, in the same process
--     --only NAME      only entries whose name has this text
--     --seconds LIMIT  of processor time, after which a call is asked to end (0.25)
--     --parallel N     processes (as many as there are processors)
--     --program PATH   the barwright that is fuzzed, such as a build with sanitizers
--     --keep           the folder with the logs stays
--     --leaks          looks after each call, not only after each batch, for memory that is kept: slow
-- A finding is a signal, a sanitizer's report, an error of Lua within the library, an error that names a line
-- of the library, an engine that stays busy, memory that is kept when nothing is in use, or a call that neither
-- ends nor can be ended. Ends with status 1 when there is one, and prints what makes it again.
local here = arg[0]:match "^(.*)/[^/]*$" or "."

local usage = "api: unknown option '%s': see the head of tests/fuzz/api.lua"
local opts = {calls = 5000, seed = 1, seconds = 0.25}
do
  local numbers = {calls = true, seed = true, call = true, from = true, seconds = true, parallel = true}
  local texts = {program = true, only = true, folder = true}
  local i = 1
  while arg[i] do
    local name = arg[i]:match "^%-%-(%l+)$"
    if name == "keep" or name == "leaks" then
      opts[name] = true
    elseif numbers[name] or texts[name] then
      i = i + 1
      opts[name] = numbers[name] and tonumber(arg[i]) or texts[name] and arg[i]
        or error(usage:format(arg[i - 1]), 0)
    else
      error(usage:format(arg[i]), 0)
    end
    i = i + 1
  end
end

local function quoted(text)
  return "'" .. text:gsub("'", "'\\''") .. "'"
end

-- The folder that all generated paths lead into becomes the working folder: the program once more, in it.
if not opts.folder then
  local function absolute(path)
    local pipe = assert(io.popen("realpath " .. quoted(path)))
    local text = pipe:read "l"
    pipe:close()
    return assert(text, path)
  end
  local function shell(command)
    local pipe = assert(io.popen(command))
    local text = pipe:read "l"
    pipe:close()
    return assert(text, command)
  end
  local program = absolute(opts.program or arg[-1] or "build/barwright")
  local folder = shell "mktemp -d"
  local words = {}
  for i = 1, #arg do words[i] = quoted(arg[i]) end
  -- Two folders deep, so that ".." stays inside. One thread of BLAS: its own would be lost in children.
  local command = [[mkdir -p FOLDER/in/here FOLDER/tmp && cd FOLDER/in/here && BARWRIGHT_QUIET=1 \
    TMPDIR=FOLDER/tmp \
    HOME=FOLDER/tmp XDG_CACHE_HOME=FOLDER/tmp OPENBLAS_NUM_THREADS=1 UBSAN_OPTIONS=print_stacktrace=1 \
    ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1:max_allocation_size_mb=1000:$ASAN_OPTIONS \
    PROGRAM SCRIPT WORDS --folder FOLDER]]
  command = command:gsub("%u%u%u%u%u+", {FOLDER = folder, PROGRAM = quoted(program),
    SCRIPT = quoted(absolute(arg[0])),
    WORDS = table.concat(words, " ")})
  local _, _, status = os.execute(command)
  if not opts.keep then os.execute("rm -rf " .. quoted(folder)) end
  os.exit(status)
end

local root = here .. "/../.."
package.path = ("%s/api/?.lua;%s/scripts/docs/?.lua;%s/tests/lua/?.lua;%s"):format(here, root, root, package.path)
local run = require "run"
os.exit(run(opts, root .. "/lua/stubs"), true)
