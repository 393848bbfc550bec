---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Studies
--
-- Many runs of a model, done once each, kept and read.

---Making studies; called, it makes one.
---@class bw.StudyModule
---@overload fun(options: bw.StudyOptions): bw.Study
local StudyModule = {}

---A study: how many runs of a model are asked for, done once each, kept, and read. docs/howto_study.md begins at
---the beginning. Raises where the options do not make a study.
---@param options bw.StudyOptions
---@return bw.Study study
function StudyModule:__call(options) end

---@class bw.StudyOptions
---@field name string
---@field seed? integer default 1
---@field file? string where trials are kept; default NAME.study
---@field variables table[] {name, min, max, unit, scale = "linear"|"log"}, {name, kind = "integer", min, max} or {name, kind = "choice", of = {...}}; default = a value
---@field measures table[] {name, unit, optional}: the numbers that run returns
---@field objectives? table[] {name, goal = "min"|"max"}
---@field constraints? table[] {name, min, max}
---@field design table|fun(evaluate: function, problem: table, options: table): table {"latin_hypercube", count = 100}; see design names
---@field run fun(point: table, trial: bw.Trial): table?, any, any measures by name, and gradients where there are any; nil and a message for a trial that failed
---@field cache? bw.StudyCacheOptions
---@field what? string a sentence for people

---@class bw.StudyCacheOptions
---@field folder? string
---@field bytes? number

---Saves what can be read of a damaged file of a study into a new one. Trials that do not match their
---checksums are left out, or asked again where their points are sound: the next run on the new file runs them.
---@param path string a regular file
---@param into string a file that is not there yet
---@return table? report tables, rows, lost, whole, relisted, log
---@return string? message
---@return bw.Details? details
function StudyModule.salvage(path, into) end

---The names of all designs.
---@return string[]
function StudyModule.designs() end

---The volume that vectors of costs, all to be small, dominate below a reference.
---@param costs number[][]
---@param reference number[]
---@return number
function StudyModule.hypervolume(costs, reference) end

---@class bw.Study
---@field name string
---@field seed integer
---@field file string
---@field problem table variables, measures, objectives, constraints, completed
---@field design table
---@field trial_folder string where folders of trials lie
---@field script table path and text of the script
---@field run_function function
---@field cache_options table
---@field what string?
local Study = {}

---Runs what is missing of the design's trials, each in a process of its own; what is done before stays. Ends
---early by stop_when(trials so far, in order), after `evaluations` different points, or `seconds_total`;
---seconds and bytes are limits of one trial. retry: trials that failed once more; continue: with a script that
---has changed; output: what trials print goes to output.txt in their folders; shard = {2, 10}: the second of
---ten parts; executor: who runs trials (lua/barwright/study/executor.lua); design: another one than the study's,
---on the same file.
---@param options? bw.StudyRunOptions
---@return bw.Trials?
---@return string? message
---@return bw.Details? details
function Study:run(options) end

---@class bw.StudyRunOptions
---@field design? table
---@field workers? integer
---@field seconds? number
---@field bytes? number
---@field stop_when? function
---@field evaluations? integer
---@field seconds_total? number
---@field retry? boolean
---@field continue? boolean
---@field output? boolean
---@field shard? integer[]
---@field executor? any

---The trials of the file that have ended, by number.
---@return bw.Trials?
---@return string? message
---@return bw.Details? details
function Study:trials() end

---How far it is, from the file: done, failed, time, memory, crashed, asked, planned, missing, seconds, running.
---@return table?
---@return string? message
---@return bw.Details? details
function Study:status() end

---All trials of the file as a table (RFC 4180).
---@param path string
---@return boolean?
---@return string? message
---@return bw.Details? details
function Study:csv(path) end

---Takes over the trials of other files of the same study: taken, duplicates, conflicts.
---@param files string[]|string
---@param options? bw.StudyMergeOptions
---@return table?
---@return string? message
---@return bw.Details? details
function Study:merge(files, options) end

---@class bw.StudyMergeOptions
---@field continue? boolean

---Runs one trial again, by number, the beginning of its key, or a point: trial, before, same (all numbers are
---the same bits), differences. inside: in this process.
---@param which integer|string|table
---@param options? bw.StudyTrialOptions
---@return table?
---@return string? message
---@return bw.Details? details
function Study:trial(which, options) end

---@class bw.StudyTrialOptions
---@field inside? boolean
---@field seconds? number
---@field bytes? number

---What `make` returns, made once for all processes and runs and kept in the cache's folder: a mesh, a
---surface, a library, arrays, numbers, strings, tables of these. `what` says what it is; files: files whose
---content matters too.
---@param what any
---@param make fun(): any
---@param options? bw.StudyCachedOptions
---@return any
---@return string? message
---@return bw.Details? details
function Study:cached(what, make, options) end

---@class bw.StudyCachedOptions
---@field files? string[]

---The points that the design will ask for with their keys; nil where they depend on results.
---@return bw.PlannedTrial[]?
function Study:planned() end

---@class bw.PlannedTrial
---@field point table
---@field key string

---The same study with another file.
---@param path string
---@return bw.Study
function Study:use_file(path) end

---What makes the results: program, version, libraries, processors.
---@return table
function Study:manifest() end

---What a study's function gets beside the point.
---@class bw.Trial
---@field number integer
---@field key string
---@field seed integer
---@field point table
---@field study bw.Study
---@field folder string for files of this trial, made when it is asked for
local Trial = {}

---As math.random, from the trial's own seed.
---@param a? integer
---@param b? integer
---@return number
function Trial:random(a, b) end

---A number of the normal distribution, from the trial's own seed.
---@param mean? number
---@param deviation? number
---@return number
function Trial:normal(mean, deviation) end

---See Study:cached.
---@param what any
---@param make fun(): any
---@param options? bw.StudyCachedOptions
---@return any
function Trial:cached(what, make, options) end

---A list of trials that have ended: number, key, seed, status ("done", "failed", "time", "memory",
---"crashed"), message, seconds, processor_seconds, peak_bytes, attempts, point, results, gradients, folder.
---@class bw.Trials
---@field problem table
---@field study bw.Study
---@field summary table of the design: best, front, indices, effects, ranges, starts, ...
---@field stopped string? why the design was ended early
local Trials = {}

---The values of a variable or a measure, one for each trial that is done; all: of every trial, false where
---there is none.
---@param name string
---@param options? bw.TrialsColumnOptions
---@return any[]
function Trials:column(name, options) end

---@class bw.TrialsColumnOptions
---@field all? boolean

---Those of a status, or those that a function chooses.
---@param which string|fun(trial: table): boolean
---@return bw.Trials
function Trials:where(which) end

---The best by the first objective, or the one named, of those that keep the constraints.
---@param name? string
---@return table?
---@return string? message
---@return bw.Details? details
function Trials:best(name) end

---Those that none beats in every objective, of those that keep the constraints.
---@return bw.Trials
function Trials:front() end

---How many there are of each status.
---@return table<string, integer>
function Trials:counts() end

---As a table for other programs (RFC 4180), units in the head.
---@param path string
---@return boolean?
---@return string? message
---@return bw.Details? details
function Trials:csv(path) end

---A figure with the study's names, units, goals and constraints: history (measure, goal, scale), convergence
---(how the search came closer to the best, or its front to the last one), pareto (objectives: names), scatter
---(x, y, colour: names), scatter_matrix and parallel_coordinates (columns: names, colour), sensitivity
---(measure; of the designs sobol_indices, morris, one_at_a_time), contact_sheet (picture: the file's name,
---most, columns, cell). All take title, width, height.
---@param kind string
---@param options? table
---@return bw.Figure?
---@return string? message
---@return bw.Details? details
function Trials:plot(kind, options) end

---One HTML file that needs no network: what was asked and found, failures, plots, pictures of the trials'
---folders (`picture`: the file's name, else picture.png or the first PNG), all trials.
---@param path string
---@param options? bw.TrialsReportOptions
---@return boolean?
---@return string? message
---@return bw.Details? details
function Trials:report(path, options) end

---@class bw.TrialsReportOptions
---@field title? string
---@field text? string
---@field picture? string
---@field pictures? integer
---@field rows? integer
---@field manifest? table
