-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A job script for Slurm: an array of jobs, each of which runs its part of the points into a file of its
-- own, and a last job that takes these over into the study's file. Parts are cut by place in the design
-- (place modulo number of jobs), so that no job needs to know of another.
local core = require "barwright.core"
local run = require "barwright.study.run"

local slurm = {}

-- For the shell, as one word.
local function quoted(text)
  if text:find "^[%w_./+-]+$" then return text end
  return "'" .. text:gsub("'", "'\\''") .. "'"
end

local function absolute(path, folder)
  return path:sub(1, 1) == "/" and path or folder .. "/" .. path
end

local function base_of(path)
  return (path:gsub("%.study$", ""))
end

local function directive(lines, name, value)
  if value == nil then return end
  value = tostring(value)
  if value:find "[%c]" then
    core.raise(("study slurm: %s: text of one line expected, got %s"):format(name, core.got(value)))
  end
  lines[#lines + 1] = ("#SBATCH --%s=%s"):format(name, value:find "%s" and '"' .. value .. '"' or value)
end

--- The text of the script. opts: script (the study's file as given), folder, program, jobs, time, partition,
--- mem, cpus, account, and seconds, memory, retry, continue, output, which go to the trials.
function slurm.script(study, opts)
  local base = base_of(study.file)
  local parts = base .. ".parts"
  local script = absolute(opts.path, opts.folder)
  local lines = {"#!/bin/bash"}
  directive(lines, "job-name", study.name)
  directive(lines, "array", "1-" .. opts.jobs)
  directive(lines, "output", absolute(parts, opts.folder) .. "/%a.log")
  directive(lines, "open-mode", "append")
  directive(lines, "cpus-per-task", opts.cpus or 1)
  directive(lines, "time", opts.time)
  directive(lines, "mem", opts.mem)
  directive(lines, "partition", opts.partition)
  directive(lines, "account", opts.account)
  local options = {}
  for _, name in ipairs {"seconds", "memory"} do
    if opts[name] then options[#options + 1] = (" --%s %.17g"):format(name, opts[name]) end
  end
  for _, name in ipairs {"retry", "continue", "output"} do
    if opts[name] then options[#options + 1] = " --" .. name end
  end
  lines[#lines + 1] = ([[

# %s: its trials in %d jobs. Written by `barwright study slurm`.
#
#   bash SCRIPT submit    the array, and a job behind it that merges the parts; again, when jobs were
#                         ended by a limit: what is done is not done again
#   bash SCRIPT merge     take over what the parts have by now
#   bash SCRIPT run 7     part 7 here
set -euo pipefail
program=%s
study=%s
file=%s
parts=%s
script=%s
jobs=%d
cd %s
mkdir -p "$parts"

run() {
  "$program" study run "$study" --shard "$1/$jobs" --file "$parts/$1.study" \
    --workers "${SLURM_CPUS_PER_TASK:-1}"%s
}

merge() {
  "$program" study merge "$study" "$parts"/*.study --file "$file"
}

case ${1:-} in
submit)
  array=$(sbatch --parsable "$script")
  last=$(sbatch --parsable --array=1-1 --output="$parts/merge.log" \
    --dependency="afterany:${array%%%%;*}" "$script" merge)
  echo "array ${array%%%%;*}, merge ${last%%%%;*}"
  ;;
merge) merge ;;
run) run "$2" ;;
*)
  # Not all results of a part being good is no reason for Slurm to call the job failed.
  run "${SLURM_ARRAY_TASK_ID:?bash $script submit}" || [ $? -eq 1 ]
  ;;
esac
]]):format(study.name, opts.jobs, quoted(opts.program), quoted(script),
    quoted(absolute(study.file, opts.folder)), quoted(absolute(parts, opts.folder)),
    quoted(absolute(opts.out, opts.folder)), opts.jobs, quoted(opts.folder), table.concat(options))
  return (table.concat(lines, "\n"):gsub("SCRIPT", (quoted(opts.out):gsub("%%", "%%%%"))))
end

local function program_path()
  local pipe = io.popen "readlink /proc/$PPID/exe"
  local path = pipe and pipe:read "l"
  if pipe then pipe:close() end
  return path or "barwright"
end

local function folder_path()
  local pipe = io.popen "pwd -P"
  local path = pipe and pipe:read "l"
  if pipe then pipe:close() end
  return path or "."
end

--- barwright study slurm FILE --jobs COUNT
function slurm.command(study, opts, out)
  local points = run.planned(study)
  if not points then
    return out:fail(("study %s: which points the design '%s' asks for depends on results, so it cannot be cut "
      .. "into an array of jobs. Run it in one job: `mpirun barwright study run %s --mpi`"):format(study.name,
      study.design.name, opts.files[1]), {status = "unsupported"})
  end
  local jobs = math.min(opts.jobs or 10, #points)
  local path = opts.out or base_of(study.file) .. ".sbatch"
  local text = slurm.script(study, {path = opts.files[1], folder = folder_path(), program = program_path(),
    out = path, jobs = jobs, time = opts.time, partition = opts.partition, mem = opts.mem, cpus = opts.cpus,
    account = opts.account, seconds = opts.seconds, memory = opts.memory, retry = opts.retry,
    continue = opts.continue, output = opts.output})
  local file, why = io.open(path, "wb")
  if not file then
    return out:fail(("the job script could not be written: %s"):format(why))
  end
  file:write(text)
  file:close()
  out:say("%s: %d trials in %d jobs\nbash %s submit", path, #points, jobs, path)
  out:json {out = path, trials = #points, jobs = jobs}
  return 0
end

return slurm
