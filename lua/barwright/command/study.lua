-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- barwright study ACTION FILE ...: what can be done with a file that returns a study.
local core = require "barwright.core"
local json = require "barwright.json"
local output = require "barwright.command.output"
local plots = require "barwright.study.plots"
local saved = require "barwright.study.salvage"
local script_file = require "barwright.script_file"

local actions = {}

-- ---- the study of a file -------------------------------------------------------------------------------

local function is_study(value)
  local meta = getmetatable(value)
  return type(value) == "table" and type(meta) == "table" and meta.__name == "study"
end

-- What an error says: its file first, then the calls in that file that led to it. Those of barwright, which say
-- nothing to who wrote the file, are left out.
local function located(path, chunk)
  local source = debug.getinfo(chunk, "S").short_src
  return function(problem)
    if type(problem) ~= "string" or core.interrupted() then return problem end
    if not problem:find(source, 1, true) then problem = path .. ": " .. problem end
    local lines, last = {}, 0
    for line in debug.traceback("", 2):gmatch "[^\n]+" do
      if line:find("in function 'xpcall'", 1, true) then break end
      lines[#lines + 1] = line
      if line:find(source .. ":", 1, true) then last = #lines end
    end
    return last > 0 and problem .. "\n" .. table.concat(lines, "\n", 1, last) or problem
  end
end

-- The file of a study in place of its script is an easy mistake, and no syntax error.
local function is_database(path)
  local file <close> = io.open(path, "rb")
  return file and file:read(15) == "SQLite format 3"
end

-- The study, or nil and the exit code of what has been said.
local function load_study(path, opts, out)
  if is_database(path) then
    return nil, out:misuse(("%s holds trials: the study's script is expected there (and --file %s, if the script "
      .. "does not name that file)"):format(path, path))
  end
  local refusal = script_file.refusal(path)
  if refusal then return nil, out:misuse(refusal) end
  local chunk, message = loadfile(path, "t")
  if not chunk then
    return nil, out:fail(message) -- not readable, or no Lua
  end
  local before = rawget(_G, "arg")
  rawset(_G, "arg", {[0] = path})
  local ok, study = xpcall(chunk, located(path, chunk), path)
  rawset(_G, "arg", before)
  if not ok then
    return nil, out:fail(study)
  end
  if not is_study(study) then
    return nil, out:misuse(("%s returned %s: a file of a study ends with `return bw.study{...}`"):format(path,
      study == nil and "nothing" or "a " .. type(study)))
  end
  if opts.file then study:use_file(opts.file) end
  return study
end

local function too_many(opts, out, count)
  if #opts.files > count then
    return out:misuse(("'%s' is one argument too many for %s"):format(opts.files[count + 1], opts.action))
  end
end

-- ---- trials as plain data ------------------------------------------------------------------------------

local function plain(trial)
  return {number = trial.number, key = trial.key, seed = trial.seed, status = trial.status,
    message = trial.message, seconds = trial.seconds, peak_bytes = trial.peak_bytes, point = trial.point,
    results = trial.results}
end

-- What of a summary JSON can hold.
local function plain_summary(value, depth)
  local kind = type(value)
  if kind == "string" or kind == "number" or kind == "boolean" then return value end
  if kind ~= "table" or depth > 6 then return nil end
  local meta = getmetatable(value)
  if type(meta) == "table" and meta.__name == "trial" then return plain(value) end
  local copy = {}
  if type(meta) == "table" and meta.__name == "trials" then
    for i, trial in ipairs(value) do copy[i] = plain(trial) end
    return json.list(copy)
  end
  for key, inner in pairs(value) do
    if math.type(key) == "integer" or type(key) == "string" then copy[key] = plain_summary(inner, depth + 1) end
  end
  return #copy > 0 and json.list(copy) or copy
end

-- ---- actions -------------------------------------------------------------------------------------------

local function shard_of(text)
  if not text then return nil end
  local which, count = text:match "^(%d+)/(%d+)$"
  which, count = tonumber(which), tonumber(count)
  if which and which >= 1 and which <= count then return {math.tointeger(which), math.tointeger(count)} end
  return nil, ("option --shard: WHICH/COUNT expected (2/10), got '%s'"):format(text)
end

function actions.run(study, opts, out)
  local code = too_many(opts, out, 1)
  if code then return code end
  local shard, fault = shard_of(opts.shard)
  if fault then
    return out:misuse(fault)
  end
  if not opts.mpi then out:say("%s", tostring(study)) end -- rank 0 alone tells
  local options = {workers = opts.workers, seconds = opts.seconds,
    bytes = opts.memory, evaluations = opts.evaluations, seconds_total = opts.seconds_total,
    retry = opts.retry, continue = opts.continue, output = opts.output, shard = shard}
  local trials, message, details
  if opts.mpi then
    trials, message, details = require("barwright.study.mpi").run(study, options)
  else
    trials, message, details = study:run(options)
  end
  if trials == true then return output.DONE end -- a rank that ran trials for rank 0
  if not trials then
    return out:fail(message, details)
  end
  out:say("%s", tostring(trials))
  local counts = trials:counts()
  out:json {study = study.name, file = study.file, trials = #trials, counts = counts, stopped = trials.stopped,
    summary = plain_summary(trials.summary, 0)}
  if counts.done < #trials then
    for _, trial in ipairs(trials) do
      if trial.status ~= "done" then
        out:say("first that is not done: %s", tostring(trial))
        break
      end
    end
  end
  return counts.done == 0 and #trials > 0 and output.NO or output.DONE
end

function actions.status(study, opts, out)
  local code = too_many(opts, out, 1)
  if code then return code end
  local status, message, details = study:status()
  if not status then
    return out:fail(message, details)
  end
  out:say("%s", tostring(status))
  local fields = {messages = json.list(status.messages)}
  for key, value in pairs(status) do
    if type(value) ~= "table" then fields[key] = value end
  end
  out:json(fields)
  return output.DONE
end

-- trials of the file, or nil and the exit code
local function read_trials(study, out)
  local trials, message, details = study:trials()
  if not trials then return nil, out:fail(message, details) end
  return trials
end

-- What all trials give as one file, beside the study's where no other is named.
local function written(study, opts, out, ending, write)
  local code = too_many(opts, out, 1)
  if code then return code end
  local trials
  trials, code = read_trials(study, out)
  if not trials then return code end
  local path = opts.out or study.file:gsub("%.study$", "") .. ending
  local ok, message, details = write(trials, path)
  if not ok then
    return out:fail(message, details)
  end
  out:say("%s: %d trials", path, #trials)
  out:json {out = path, trials = #trials}
  return output.DONE
end

function actions.csv(study, opts, out)
  return written(study, opts, out, ".csv", function(trials, path) return trials:csv(path) end)
end

function actions.merge(study, opts, out)
  local files = table.move(opts.files, 2, #opts.files, 1, {})
  if #files == 0 then
    return out:misuse "merge: the files to be taken in are missing"
  end
  local merged, message, details = study:merge(files, {continue = opts.continue})
  if not merged then
    return out:fail(message, details)
  end
  out:say("%s", tostring(merged))
  out:json {file = study.file, taken = merged.taken, duplicates = merged.duplicates,
    conflicts = json.list(merged.conflicts)}
  if #merged.conflicts > 0 then
    out:fail(("%d trials have different numbers in two files; the ones that were there first are kept")
      :format(#merged.conflicts))
    return output.NO
  end
  return output.DONE
end

function actions.trial(study, opts, out)
  local which = opts.files[2]
  if not which then
    return out:misuse "trial: the number or the key of a trial is missing"
  end
  local code = too_many(opts, out, 2)
  if code then return code end
  local number = math.tointeger(tonumber(which))
  if number and #which < 10 then which = number end
  if type(which) == "string" and not which:match "^%x%x%x%x%x*$" then
    return out:misuse(("trial: a number, or four or more digits of a key expected, got '%s'"):format(which))
  end
  local again, message, details = study:trial(which, {inside = opts.inside, seconds = opts.seconds,
    bytes = opts.memory})
  if not again then
    return out:fail(message, details)
  end
  out:say("%s", tostring(again))
  out:json {trial = plain(again.trial), same = again.same, differences = json.list(again.differences),
    before = again.before and plain(again.before)}
  return (again.same or not again.before) and output.DONE or output.NO
end

function actions.plot(study, opts, out)
  local kind = opts.files[2]
  if not kind then
    return out:misuse(("plot: the kind of plot is missing: %s"):format(table.concat(plots.kinds(), ", ")))
  end
  local code = too_many(opts, out, 2)
  if code then return code end
  local trials
  trials, code = read_trials(study, out)
  if not trials then return code end
  local path = opts.out or ("%s_%s.svg"):format(study.file:gsub("%.study$", ""), kind)
  -- a kind that there is not, or that says nothing of this design, is raised: misuse of the command line here
  local drawn, figure, message, details = pcall(trials.plot, trials, kind, {x = opts.x, y = opts.y,
    colour = opts.colour})
  if not drawn then
    if type(figure) == "string" and figure:find "^plot" then
      return out:misuse((figure:gsub("option '(%l+)'", "option --%1")))
    end
    error(figure, 0)
  end
  local ok
  if figure then ok, message, details = figure:write(path) end
  if not ok then
    return out:fail(message, details)
  end
  out:say("%s", path)
  out:json {out = path}
  return output.DONE
end

function actions.report(study, opts, out)
  return written(study, opts, out, ".html", function(trials, path) return trials:report(path) end)
end

function actions.slurm(study, opts, out)
  return require("barwright.study.slurm").command(study, opts, out)
end

-- A damaged file needs no study.
local function salvage(opts, out)
  local damaged, new = opts.files[1], opts.files[2] or opts.out
  if not new or #opts.files > 2 then
    return out:misuse(("salvage: the damaged file and the new one expected, got %d path%s"):format(#opts.files,
      #opts.files == 1 and "" or "s"))
  end
  local report, message, details = saved.into(damaged, new)
  if not report then
    return out:fail(message, details)
  end
  out:say("%s", tostring(report))
  core.warnings() -- reported above
  out:json {out = new, rows = report.rows, lost = report.lost, whole = report.whole, log = json.list(report.log)}
  return output.DONE
end

local names = {"run", "status", "csv", "merge", "trial", "plot", "report", "slurm", "salvage"}

return {
  summary = "run a study, look at it, take its results elsewhere",
  about = [[
A study is a script that returns bw.study{...}; its trials are kept in one file, NAME.study.
A run that was ended at any moment goes on where it was when it is run again.

  run FILE              run what is missing
  status FILE           how far it is, also while it is being run
  csv FILE              all trials as a table (--out)
  merge FILE PART ...   take over the trials of other files of the same study
  trial FILE WHICH      run one trial again, by its number or key, and compare
  plot FILE KIND        a figure (--out x.svg or x.png): history, pareto,
                        convergence, scatter (--x, --y), scatter_matrix,
                        contact_sheet, parallel_coordinates, sensitivity
  report FILE           one HTML page (--out)
  slurm FILE            a job script for Slurm
  salvage OLD NEW       save what can be read of a damaged file]],
  arguments = {
    {name = "action", one_of = names, what = "what is to be done"},
    {name = "files", many = true, what = "the study's script, and what the action takes besides"},
  },
  options = {
    {name = "file", value = "PATH", type = "file", what = "the file of trials, in place of the study's own"},
    {name = "out", value = "PATH", type = "file", what = "what is written"},
    {name = "workers", value = "COUNT", type = "integer", min = 1,
      what = "trials side by side (default: one for each processor)"},
    {name = "seconds", value = "SECONDS", type = "number", above = 0, unit = "s", what = "limit of one trial"},
    {name = "memory", value = "SIZE", type = "number", unit = "bytes", above = 0,
      what = "limit of one trial (default: its worker's part of the machine's)"},
    {name = "evaluations", value = "COUNT", type = "integer", min = 1, what = "end after so many trials"},
    {name = "seconds-total", value = "SECONDS", type = "number", above = 0, unit = "s",
      what = "end after so long"},
    {name = "retry", type = "flag", what = "run trials again that failed"},
    {name = "continue", type = "flag", what = "go on although the script has changed"},
    {name = "output", type = "flag", what = "keep what trials print in their folders"},
    {name = "inside", type = "flag", what = "trial: in this process, so that what it prints is seen"},
    {name = "mpi", type = "flag", what = "run, under mpirun: rank 0 hands out trials, the other ranks run them"},
    {name = "x", value = "COLUMN", what = "plot scatter: the variable or measure along x"},
    {name = "y", value = "COLUMN", what = "plot scatter: the one along y"},
    {name = "colour", value = "COLUMN",
      what = "plot scatter, scatter_matrix and parallel_coordinates: the one that colours show"},
    {name = "jobs", value = "COUNT", type = "integer", min = 1, max = 100000,
      what = "slurm: jobs of the array (10)"},
    {name = "time", value = "LIMIT", what = "slurm: of one job, as sbatch takes it (2:00:00)"},
    {name = "partition", value = "NAME", what = "slurm: where the jobs run"},
    {name = "mem", value = "SIZE", what = "slurm: memory of one job (8G)"},
    {name = "cpus", value = "COUNT", type = "integer", min = 1,
      what = "slurm: processors of one job, a trial on each (1)"},
    {name = "account", value = "NAME", what = "slurm: whom the time is charged to"},
    {name = "shard", value = "WHICH/COUNT", what = "run: one of several parts, into a --file of its own"},
  },
  examples = {
    "barwright study run hook.lua --workers 2",
    "barwright study status hook.lua",
    "barwright study plot hook.lua scatter --x thickness --y stress",
    "barwright study trial hook.lua 17 --inside",
    "barwright study run hook.lua --shard 1/2 --file one.study",
    "barwright study merge hook.lua one.study two.study",
    "mpirun -n 9 barwright study run hook.lua --mpi",
    "barwright study slurm hook.lua --jobs 50 --time 2:00:00 --mem 4G",
  },
  run = function(opts, out)
    if #opts.files == 0 then
      return out:misuse(("%s: a file is missing"):format(opts.action))
    end
    if opts.action == "salvage" then return salvage(opts, out) end
    local study, code = load_study(opts.files[1], opts, out)
    if not study then return code end
    local exit_code = actions[opts.action](study, opts, out)
    out:warnings()
    return exit_code
  end,
}
