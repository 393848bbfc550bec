-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Random sequences of operations on all objects that change: edits, drags, what is refused, cancelled, runs out
-- of memory or raises in the midst of it, undo, forks, closing. After each operation the object's own check is
-- called, and after one that failed all that can be seen must be what it was.
--   build/barwright tests/fuzz/sequences.lua [options]
--     --operations N   how many operations (2000), over all kinds or those of --kind
--     --seed S         of their choice (1)
--     --kind NAME      sheet, cantilever, vibration, flow, thermal, plate, bridge, mesh_motion, session, solid,
--                      transient or controller
--     --sequence N     this sequence alone, told operation by operation
--     --length N       operations of a sequence (40)
--     --parallel N     processes (as many as there are processors)
--     --program PATH   the barwright that is run, such as a build with sanitizers
-- Sequences run in child processes. A finding is a signal, a report of a sanitizer, a check that fails, a state
-- that a failed operation changed, or an error of Lua within the library. Ends with status 1 when there is one,
-- and prints what makes it again.
local here = arg[0]:match "^(.*)/[^/]*$" or "."

local opts = {operations = 2000, seed = 1, length = 40}
do
  local numbers = {operations = true, seed = true, sequence = true, length = true, parallel = true}
  local texts = {kind = true, program = true}
  local i = 1
  while arg[i] do
    local name = arg[i]:match "^%-%-(%l+)$"
    local value = arg[i + 1]
    if not (numbers[name] or texts[name]) or numbers[name] and not math.tointeger(tonumber(value)) then
      error(("sequences: '%s': see the head of tests/fuzz/sequences.lua"):format(arg[i]), 0)
    end
    opts[name] = numbers[name] and math.tointeger(tonumber(value)) or value
    i = i + 2
  end
end

if opts.program then
  local words = {}
  for i = 1, #arg do
    if arg[i] ~= "--program" and arg[i - 1] ~= "--program" then
      words[#words + 1] = "'" .. arg[i]:gsub("'", "'\\''") .. "'"
    end
  end
  -- One thread of BLAS: its own would be lost in children.
  local _, _, status = os.execute(("OPENBLAS_NUM_THREADS=1 UBSAN_OPTIONS=print_stacktrace=1 "
    .. "ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1:$ASAN_OPTIONS %s %s %s"):format(opts.program,
    arg[0], table.concat(words, " ")))
  os.exit(status)
end

local root = here .. "/../.."
package.path = ("%s/sequences/?.lua;%s/tests/lua/?.lua;%s"):format(here, root, package.path)
os.exit(require "run"(opts), true)
