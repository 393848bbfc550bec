---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Studies
--
-- Designs of experiments and optimisations over a model: a trial for each point, run once, stored in a file, and evaluated.
-- docs/howto_study.md is the way in; the methods are in docs/theory/studies.md.

---Studies of a model over variables.
---@class bw.StudyModule
---@overload fun(options: bw.StudyOptions): bw.Study
local StudyModule = {}

---A study of a model. Nothing is run and no file is written before `run`. Options that contradict each other raise.
---
---A study is a file of trials. Each trial has a key, the SHA-256 of the study's name, seed and point: a point that the file
---has is not run again.
---
---Source: docs/theory/studies.md.
---```lua
---local study = bw.study {name = "ball", design = {"grid", levels = 3},
---  variables = {{name = "radius", unit = "m", min = 0.01, max = 0.02}},
---  measures = {{name = "volume", unit = "m3"}},
---  run = function(point) return {volume = bw.surface.sphere({radius = point.radius}).volume} end}
---print(assert(study:run()))
---```
---@param options bw.StudyOptions variables, measures, design and the function that makes a trial
---@return bw.Study study not run yet
function StudyModule:__call(options) end

---What a study asks for.
---@class bw.StudyOptions
---@field name string names the study in keys, messages and files; no slash
---@field seed? integer (seed) of designs and trials. Default: 1
---@field file? string of the trials. Default: the name and ".study"; blanks become "_"
---@field variables bw.StudyVariable[] (list) at least one, at most 1900
---@field correlations? bw.StudyCorrelation[] (list) of the values of two variables. Default: none
---@field measures (bw.StudyMeasure|string)[] (list) at least one, at most 1900; a string is a name
---@field objectives? (bw.StudyObjective|string)[] (list) measures to be minimised or maximised. Default: none
---@field constraints? bw.StudyConstraint[] (list) bounds of measures. Default: none
---@field design bw.StudyDesign which points are asked for
---@field run fun(point: table<string, any>, trial: bw.Trial): (table<string, number>?, any, bw.Details?) makes one trial: measures by name, and gradients[measure][variable] where a design uses them; nil, message, details of a trial that failed
---@field cache? bw.StudyCacheOptions of `study:cached`
---@field what? string a sentence for reports. Default: none

---A variable of a study: a real number, an integer or a choice.
---@class bw.StudyVariable
---@field name string as `run` gets it
---@field kind? "real"|"integer"|"choice" Default: "choice" with `of`, else "real"
---@field unit? string of min, max and values. Default: none
---@field min? number (any) the smallest value; needed but for a choice or a distribution
---@field max? number (any) the largest value, above min; needed but for a choice or a distribution
---@field scale? "linear"|"log" how designs spread a real; "log" needs min above 0. Default: "linear"
---@field of? (string|number|boolean)[] (any, n) the values of a choice, all different
---@field distribution? bw.Distribution how a real scatters, in place of min, max and scale. Default: none
---@field default? string|number|boolean (any) where one-at-a-time designs and optimisations begin. Default: the midpoint
---@field what? string a sentence for reports. Default: none

---The correlation of the values of two variables that have distributions: {"thickness", "strength", 0.3}.
---@class bw.StudyCorrelation
---@field [1] string name of a variable
---@field [2] string name of another one
---@field [3] number (-) of their values. Range: above -1 to below 1, and what the distributions permit

---How a variable scatters: the name of a distribution and its parameters. Values of a probability below 1e-19 are left out.
---"gumbel" is the distribution of largest values, such as loads.
---@class bw.Distribution
---@field [1] "normal"|"lognormal"|"uniform"|"weibull"|"gumbel" the name
---@field mean? number (any) of "normal", "lognormal" (above 0) and "gumbel"
---@field deviation? number (any) standard deviation of "normal", "lognormal" and "gumbel". Range: above 0
---@field scale? number (any) of "weibull": above `min`, 63.2 % of the values lie below it. Range: above 0
---@field shape? number (-) exponent of "weibull". Range: above 0
---@field min? number (any) of "uniform" and "weibull". Default: 0 of "weibull"
---@field max? number (any) of "uniform"

---A number that each trial gives.
---@class bw.StudyMeasure
---@field name string as `run` returns it; not that of a variable
---@field unit? string of the values. Default: none
---@field optional? boolean it may be missing in a trial. Default: false
---@field what? string a sentence for reports. Default: none

---A measure that is minimised or maximised.
---@class bw.StudyObjective
---@field name string of the measure
---@field goal? "min"|"max" Default: "min"

---Bounds of a measure; at least one of the two.
---@class bw.StudyConstraint
---@field name string of the measure
---@field min? number (any) in the unit of the measure. Default: none
---@field max? number (any) in the unit of the measure. Default: none

---Where `study:cached` keeps what it made.
---@class bw.StudyCacheOptions
---@field folder? string Default: barwright in $XDG_CACHE_HOME, or in ~/.cache; without both nothing is kept
---@field bytes? number (bytes) the least recently used entries beyond it are removed. Range: above 0. Default: 4e9

---Which points a study asks for: a table that begins with the name of a design, or a function that asks for lists of points
---until it has what it looks for. `evaluate` returns the results in the order of the points, false where a trial has none,
---and the trials; what the function returns becomes the summary.
---@alias bw.StudyDesign bw.GridDesign|bw.PointsDesign|bw.OneAtATimeDesign|bw.SamplingDesign|bw.MorrisDesign|bw.SobolIndicesDesign|bw.MinimiseDesign|bw.ParetoDesign|bw.BayesianDesign|bw.FormDesign|bw.ImportanceDesign|bw.SubsetDesign|fun(evaluate: bw.StudyEvaluate, problem: bw.StudyProblem): table<string, any>?

---Runs the trials of points that the file does not have.
---@alias bw.StudyEvaluate fun(points: table<string, any>[]): (table<string, number>|false)[], bw.TrialRecord[]

---All combinations of levels, at most ten million. The last variable changes fastest.
---@class bw.GridDesign
---@field [1] "grid" the name
---@field levels? integer|table<string, integer|any[]> (count) of values, evenly spread, for each real; or for variables by name, as a number or a list of values. Integers and choices that are not named take all their values. Default: none, needed for reals

---A list of points.
---@class bw.PointsDesign
---@field [1] "points" the name
---@field points table<string, any>[] (list) values by the names of variables; missing ones are the defaults

---Each variable over its levels, the others at the base point. The summary has `base` and `ranges`.
---@class bw.OneAtATimeDesign
---@field [1] "one_at_a_time" the name
---@field levels? integer|table<string, integer|any[]> (count) as of a grid. Default: 5
---@field at? table<string, any> the base point; missing values are defaults or midpoints. Default: none

---Points that fill the space of the variables: independent ones, a Latin hypercube, or Sobol's sequence. Variables with
---distributions are drawn from them; with constraints, the summary has `failure`.
---@class bw.SamplingDesign
---@field [1] "random"|"latin_hypercube"|"sobol" the name
---@field count integer (count) of points. Range: 1 to 10000000
---@field seed? integer (seed) Default: that of the study
---@field maximin? boolean of "latin_hypercube": spread the points apart, at most 1000 of them. Default: false
---@field centroids? boolean of "latin_hypercube": points in the centres of their slices. Default: false
---@field skip? integer (count) of "sobol": points of the sequence that are left out. Range: at least 0. Default: 0
---@field scramble? boolean of "sobol": scramble by the seed. Default: true

---Screening by elementary effects along random trajectories. The summary has `effects`.
---
---Source: M. D. Morris, Technometrics 33 (1991); mu_star: F. Campolongo, J. Cariboni, A. Saltelli, Environmental Modelling
---and Software 22 (2007).
---@class bw.MorrisDesign
---@field [1] "morris" the name
---@field trajectories? integer (count) each of one trial more than there are variables. Range: 2 to 1000000. Default: 10
---@field levels? integer (count) of each variable, even. Range: 2 to 1000. Default: 4
---@field resamples? integer (count) of the bootstrap for the intervals; 0: none. Range: 0 to 100000. Default: 200
---@field seed? integer (seed) Default: that of the study

---Sobol's indices of the variance of each measure. The summary has `indices`, `mean` and `variance`.
---
---Source: A. Saltelli and others, Computer Physics Communications 181 (2010).
---@class bw.SobolIndicesDesign
---@field [1] "sobol_indices" the name
---@field base integer (count) rows; base × (variables + 2) trials. A power of 2 is best. Range: 2 to 10000000
---@field estimator? "saltelli"|"jansen" of the first-order indices. Default: "saltelli"
---@field resamples? integer (count) of the bootstrap for the intervals; 0: none. Range: 0 to 100000. Default: 200
---@field level? number (-) confidence level of the intervals. Range: above 0 to 0.999. Default: 0.95
---@field seed? integer (seed) Default: that of the study

---Optimisation of one objective by NLopt, from one start or several. The summary has `starts`.
---@class bw.MinimiseDesign
---@field [1] "minimise" the name
---@field method? "cobyla"|"bobyqa"|"neldermead"|"sbplx"|"direct_l"|"crs2"|"isres"|"mma"|"slsqp"|"lbfgs" constraints: cobyla, isres, mma, slsqp; integers and choices: direct_l, crs2, isres. Default: "bobyqa"; "cobyla" with constraints or one variable
---@field starts? integer (count) run side by side. Range: 1 to 10000. Default: 1
---@field start? table<string, any> the first start; the others are spread by a Latin hypercube. Default: defaults or midpoints of the variables
---@field evaluations? integer (count) of the objective for each start. Range: at least 1. Default: 200
---@field tolerance? number (-) relative, of objective and variables. Range: at least 0. Default: 1e-6
---@field gradient? "run"|"differences" of mma, slsqp and lbfgs: those that `run` returns, or finite differences. Default: "differences"
---@field step? number (-) of the differences, a fraction of the range of a variable. Range: above 0 to 0.1. Default: 1e-4
---@field seed? integer (seed) Default: that of the study

---The Pareto front of several objectives by NSGA-II. The summary has `hypervolume` after each generation.
---
---Source: K. Deb, A. Pratap, S. Agarwal, T. Meyarivan, IEEE Trans. Evolutionary Computation 6 (2002).
---@class bw.ParetoDesign
---@field [1] "pareto" the name
---@field population? integer (count) trials in a generation. Range: 4 to 100000. Default: 40
---@field generations? integer (count) after the first. Range: 0 to 1000000. Default: 25
---@field crossover? number (-) its probability. Range: 0 to 1. Default: 0.9
---@field crossover_index? number (-) distribution index of the crossover. Range: at least 0. Default: 15
---@field mutation? number (-) its probability for each variable. Range: above 0 to 1. Default: one over the number of variables
---@field mutation_index? number (-) distribution index of the mutation. Range: at least 0. Default: 20
---@field seed? integer (seed) Default: that of the study

---Optimisation of one objective whose trials are expensive: each next trial is where a Gaussian process through all others
---expects the most improvement, times the probability that the constraints are kept. Choices count as ordered. A failed trial
---counts as the worst one. The summary has `why`, `expected`, `error` and `count`.
---
---Source: D. R. Jones, M. Schonlau, W. J. Welch, Journal of Global Optimization 13 (1998).
---@class bw.BayesianDesign
---@field [1] "bayesian" the name
---@field count integer (count) the most trials. Range: 3 to 500
---@field initial? integer (count) of them in a spread Latin hypercube first. Range: 2 to 500. Default: 3 for each variable and 2
---@field batch? integer (count) trials at a time. Range: 1 to 100. Default: 1
---@field tolerance? number (-) expected improvement, over the range of the objective so far, at which it ends. Range: at least 0. Default: 1e-5
---@field seed? integer (seed) Default: that of the study

---The probability that a constraint is violated, by the first-order reliability method: the likeliest point of failure of
---each bound, and a plane there in place of the limit. The error is unknown where limits are curved. The summary has
---`points`, `lost`, `low`, `high` and, of one point, `probability`.
---
---Source: A. M. Hasofer, N. C. Lind, J. Eng. Mech. Div. 100 (1974); Y. Zhang, A. Der Kiureghian, Reliability and
---Optimization of Structural Systems (1995).
---@class bw.FormDesign
---@field [1] "form" the name
---@field starts? integer (count) searches for each bound: from the medians, and at 3 standard deviations in random directions. Range: 1 to 1000. Default: 1
---@field iterations? integer (count) of each search. Range: 1 to 1000. Default: 30
---@field tolerance? number (-) of the design point, in standard deviations, relative beyond one. Range: above 0 to 0.1. Default: 1e-3
---@field gradient? "run"|"differences" those that `run` returns, or finite differences. Default: "differences"
---@field step? number (-) of the differences, in standard deviations. Range: above 0 to 1. Default: 1e-3
---@field seed? integer (seed) Default: that of the study

---The probability that a constraint is violated, with its error, by sampling around the points that "form" finds and, a
---tenth, around the medians. The estimate is unbiased; its error does not show an unlikely region of failure apart from these
---points. The summary has `probability`, `low`, `high`, `deviation`,
---`count`, `failures` and `form`.
---
---Source: R. E. Melchers, Structural Safety 6 (1989).
---@class bw.ImportanceDesign
---@field [1] "importance" the name
---@field count? integer (count) the most trials, beside those of the search. Range: 10 to 10000000. Default: 5000
---@field error? number (-) standard deviation over estimate at which it ends. Range: above 0 to 1. Default: 0.1
---@field batch? integer (count) trials at a time. Range: 1 to 100000. Default: 200
---@field starts? integer (count) as of "form". Range: 1 to 1000. Default: 1
---@field iterations? integer (count) as of "form". Range: 1 to 1000. Default: 30
---@field tolerance? number (-) as of "form". Range: above 0 to 0.1. Default: 1e-3
---@field gradient? "run"|"differences" as of "form". Default: "differences"
---@field step? number (-) as of "form". Range: above 0 to 1. Default: 1e-3
---@field seed? integer (seed) Default: that of the study

---A small probability that a constraint is violated, by subset simulation: a product of larger probabilities, with Markov
---chains between levels of the least margin. It needs no gradient and finds failures in several places. The summary has
---`probability`, `low`, `high`, `deviation`, `count` and `levels`.
---
---Source: S.-K. Au, J. L. Beck, Probabilistic Engineering Mechanics 16 (2001).
---@class bw.SubsetDesign
---@field [1] "subset" the name
---@field count? integer (count) trials of each level. Range: 50 to 1000000. Default: 1000
---@field share? number (-) of the trials of a level that begin the next one. Range: 0.01 to 0.5. Default: 0.1
---@field levels? integer (count) the most. Range: 1 to 40. Default: 12
---@field seed? integer (seed) Default: that of the study

---Saves what can be read of a damaged study file into a new one. Trials that do not match their checksums are left out, or
---asked for again where their points are sound; the next run on the new file runs them.
---
---Errors: io (a file cannot be read or written, or the new one exists), damaged (nothing can be saved), foreign (no study
---file), newer (written by a later version), full (the disk), memory, cancelled.
---```lua
---local study = bw.study {name = "ball", design = {"grid", levels = 3}, measures = {"volume"},
---  variables = {{name = "radius", unit = "m", min = 0.01, max = 0.02}},
---  run = function(point) return {volume = 4 / 3 * math.pi * point.radius ^ 3} end}
---assert(study:run())
---print(assert(bw.study.salvage("ball.study", "saved.study")))
---```
---@param path string the damaged file, a regular one
---@param into string the new file, which must not exist
---@return bw.SalvageReport? report what was saved
---@return string? message
---@return bw.Details? details
function StudyModule.salvage(path, into) end

---What was saved of a damaged study file.
---@class bw.SalvageReport
---@field tables integer (count) tables that were copied
---@field rows integer (count) rows that were copied
---@field lost integer (count) rows that could not be read, at most
---@field whole boolean whether all that was written is there
---@field relisted boolean whether the list of tables was replaced by that of the study's definition
---@field log string[] one sentence for each table, and for each thing that is missing

---The names of all designs.
---```lua
---local names = bw.study.designs()
---print(table.concat(names, ", "))
---```
---@return string[] names in alphabetical order
function StudyModule.designs() end

---The hypervolume of a set of cost vectors: the volume that they dominate below a reference point. All costs are minimised.
---Vectors that are not below the reference in every cost count nothing. Lists of different lengths raise.
---```lua
---local volume = bw.study.hypervolume({{1, 3}, {2, 1}}, {4, 4})
---print(volume) -- 7.0
---```
---@param costs number[][] (any, n × m) vectors of costs
---@param reference number[] (any, m) the reference point
---@return number volume (any) product of the units of the costs
function StudyModule.hypervolume(costs, reference) end

---A study: its problem, its design and its file.
---```lua
---local study = bw.study {name = "ball", design = {"latin_hypercube", count = 5}, measures = {"volume"},
---  variables = {{name = "radius", unit = "m", min = 0.01, max = 0.02}},
---  run = function(point) return {volume = 4 / 3 * math.pi * point.radius ^ 3} end}
---local trials = assert(study:run {workers = 1})
---print(study:status(), trials:column "volume"[1])
---```
---@class bw.Study
---@field name string of the study
---@field seed integer (seed) of designs and trials
---@field file string path of the file of trials
---@field problem bw.StudyProblem variables, measures, objectives and constraints
---@field design bw.StudyDesignInUse the design, checked
---@field trial_folder string in which trials have their folders
---@field script bw.StudyScript the script that has the function `run`
---@field run_function fun(point: table<string, any>, trial: bw.Trial): (table<string, number>?, any, bw.Details?) `run` of the options
---@field cache_options bw.StudyCacheOptions of `cached`
---@field what string? a sentence for reports
local Study = {}

---The design of a study, checked.
---@class bw.StudyDesignInUse
---@field name string its name, or "function"
---@field opts table<string, any> its options with defaults
---@field total integer? (count) the most trials that it may ask for; nil where its points are a list, or not known

---The script of a study.
---@class bw.StudyScript
---@field path string? nil where the function was typed at the prompt
---@field text string of the whole file; a run on a file whose trials another text made is refused

---Runs the trials that the file does not have, each in a process of its own, and stores each result before the next. Ctrl-C
---or a loss of power loses running trials only; another run goes on.
---
---Errors: busy (another process runs this study), different (the file is of another study, or the script has changed),
---damaged, foreign, newer (the file), full (the disk), format, io, cancelled (what has ended is in the file), memory,
---internal (a process of a trial cannot be started).
---```lua
---local study = bw.study {name = "ball", design = {"grid", levels = 9}, measures = {"volume"},
---  variables = {{name = "radius", unit = "m", min = 0.01, max = 0.02}},
---  run = function(point) return {volume = 4 / 3 * math.pi * point.radius ^ 3} end}
---local some = assert(study:run {workers = 2, seconds = 60, stop_when = function(trials) return #trials >= 3 end})
---print(some.stopped, #assert(study:run())) -- 9: three of them from the file
---```
---@param options? bw.StudyRunOptions how, and how many
---@return bw.Trials? trials in the order in which the design asked for them
---@return string? message
---@return bw.Details? details
function Study:run(options) end

---How trials are run, and when a run ends.
---@class bw.StudyRunOptions
---@field design? bw.StudyDesign in place of the study's, on the same file. Default: the study's
---@field workers? integer (count) trials side by side. Range: 1 to 4096. Default: the processors
---@field seconds? number (s) wall-clock time of a trial, above 0; longer ones end with status "time". Default: no limit
---@field bytes? number (bytes) memory of a trial, above 0; larger ones end with status "memory". Default: nine tenths of the machine's by `workers`, at least 4e9
---@field stop_when? fun(trials: bw.Trials): boolean? asked after each trial with those so far, in their order; true ends the run. Default: none
---@field evaluations? integer (count) different points, after which the run ends. Range: at least 1. Default: no limit
---@field seconds_total? number (s) after which the run ends. Default: no limit
---@field retry? boolean run trials again that failed, crashed or exceeded a limit. Default: false
---@field continue? boolean accept that the script has changed. Default: false
---@field output? boolean keep what trials print in output.txt of their folders. Default: false
---@field shard? integer[] (index from 1, 2) which of how many parts of the points is run; {2, 10}: the second of ten. Default: all
---@field executor? bw.StudyExecutor|fun(study: bw.Study, options: bw.StudyRunOptions): bw.StudyExecutor?, string?, bw.Details? what runs trials. Default: processes of this machine

---What runs trials in place of processes of this machine.
---@class bw.StudyExecutor
---@field capacity integer (count) trials side by side, at least 1
---@field start fun(self: bw.StudyExecutor, record: bw.TrialRecord): boolean?, string?, bw.Details? begins a trial; nil and a message ends the run
---@field wait fun(self: bw.StudyExecutor, seconds: number): bw.TrialRecord?, any a trial that has ended and its outcome; nil when the time has passed; nil and "cancelled", or a message, ends the run
---@field close fun(self: bw.StudyExecutor) ends what still runs

---The trials of the file that have ended.
---
---Errors: format (no study in the file), different (of another study), damaged, foreign, newer, io, memory.
---@return bw.Trials? trials by number
---@return string? message
---@return bw.Details? details
function Study:trials() end

---How far the study is, read from its file; also while another process runs it.
---
---Errors: format (no study in the file), different (of another study), damaged, foreign, newer, io, memory.
---@return bw.StudyStatus? status counts and times
---@return string? message
---@return bw.Details? details
function Study:status() end

---How far a study is.
---@class bw.StudyStatus
---@field name string of the study
---@field file string of its trials
---@field done integer (count) trials with results
---@field failed integer (count) trials whose `run` raised, or returned nil or something unusable
---@field time integer (count) trials that exceeded `seconds`
---@field memory integer (count) trials that exceeded `bytes`
---@field crashed integer (count) trials whose process ended
---@field asked integer (count) trials that have not ended
---@field planned integer? (count) points of the design; nil where they depend on results
---@field missing integer? (count) of these, which have not ended
---@field seconds number (s) of all trials that have ended
---@field mean_seconds number? (s) of one; nil where none has ended
---@field running string? which process runs the study; nil where none does
---@field messages bw.StudyMessage[] (list) the five most frequent messages

---A message of trials that failed.
---@class bw.StudyMessage
---@field message string without the number of the trial
---@field count integer (count) of trials
---@field first integer (index from 1) the first trial that has it

---Writes all trials of the file as CSV (RFC 4180), as `Trials:csv` does.
---
---Errors: as of `trials`; io (the table cannot be written).
---@param path string of the table
---@return true? written true
---@return string? message
---@return bw.Details? details
function Study:csv(path) end

---Adds trials of other files of the same study to the study's file. A trial that both have is kept as it is.
---
---Errors: busy (a process runs this study), different (of another study, or by another script), format, damaged, foreign,
---newer, full, io, memory.
---@param files string[]|string paths
---@param options? bw.StudyMergeOptions whether the script may differ
---@return bw.StudyMerged? merged how many were new
---@return string? message
---@return bw.Details? details
function Study:merge(files, options) end

---Whether trials of another script are taken.
---@class bw.StudyMergeOptions
---@field continue? boolean accept that the script differs. Default: false

---What a merge added.
---@class bw.StudyMerged
---@field file string of the study
---@field files integer (count) that were read
---@field taken integer (count) trials that were new
---@field duplicates integer (count) trials that were there with the same results
---@field conflicts bw.StudyConflict[] (list) trials that were there with other results

---A trial with different results in two files.
---@class bw.StudyConflict
---@field number integer (index from 1) in the study's file
---@field key string of the trial
---@field name string of the measure
---@field kept number? (any) the value in the study's file
---@field other number? (any) the value in the other file
---@field file string the other file

---Runs one trial again and compares it with the file, which does not change.
---
---Errors: empty (the file has no such trial, or several), as of `trials`, cancelled, internal (the process cannot be
---started).
---@param which integer|string|table<string, any> (index from 1) number of a trial, at least four digits that its key begins with, or a point
---@param options? bw.StudyTrialOptions where it runs, and limits
---@return bw.StudyRerun? rerun the trial, and what the file has
---@return string? message
---@return bw.Details? details
function Study:trial(which, options) end

---Where a single trial runs, and its limits.
---@class bw.StudyTrialOptions
---@field inside? boolean in this process, so that its output is seen and a debugger works. Default: false
---@field seconds? number (s) wall-clock time, above 0. Default: no limit
---@field bytes? number (bytes) memory, above 0. Default: as of `run` with one worker

---A trial that was run again.
---@class bw.StudyRerun
---@field trial bw.TrialRecord as it ended now
---@field before bw.TrialRecord? as the file has it; nil where it does not
---@field same boolean whether status and results are the same, bit for bit
---@field differences bw.StudyDifference[] (list) where they are not

---A value that differs between two runs of a trial.
---@class bw.StudyDifference
---@field name string of a measure, or "status"
---@field before any in the file
---@field now any in this run

---What `make` returns, made once for all trials, processes and runs, and kept in the cache. Meshes, surfaces, libraries,
---arrays, numbers, strings and tables of these are kept. The entry is named by `what`, the files' contents and the version
---of the program.
---
---Errors: those of `make`; io (one of `files` cannot be read), cancelled.
---@param what any names the entry: strings, numbers, booleans and tables of these
---@param make fun(): any makes it; nil, message, details on failure
---@param options? bw.StudyCachedOptions files that it depends on
---@return any made what `make` returns
---@return string? message
---@return bw.Details? details
function Study:cached(what, make, options) end

---What an entry of the cache depends on.
---@class bw.StudyCachedOptions
---@field files? string[] paths; another content is another entry. Default: none

---The points that the design asks for, with their keys; nil where they depend on results.
---@return bw.PlannedTrial[]? planned in the order of the design
function Study:planned() end

---A point that a design asks for.
---@class bw.PlannedTrial
---@field point table<string, any> values by the names of variables
---@field key string of the trial

---Sets the study's file.
---@param path string of the file, which may not exist
---@return bw.Study self
function Study:use_file(path) end

---What results depend on beside the script: program, version, libraries, machine.
---@return table<string, any> manifest as in `bw.results.surroundings`, with `script`
function Study:manifest() end

---The problem of a study, checked. Designs that are functions get it.
---```lua
---local function design(evaluate, problem)
---  local results = evaluate {problem:initial(), problem:point {0}}
---  return {change = results[2] and results[1].y - results[2].y}
---end
---print(bw.study({name = "line", variables = {{name = "x", min = 0, max = 1}}, measures = {"y"}, design = design,
---  run = function(point) return {y = 3 * point.x} end}):run().summary.change) -- 1.5
---```
---@class bw.StudyProblem
---@field variables bw.StudyVariable[] (list) with all fields filled in
---@field measures bw.StudyMeasure[] (list) with all fields filled in
---@field objectives bw.StudyObjective[] (list) with all fields filled in
---@field constraints bw.StudyConstraint[] (list) as they were given

---What `run` of a study gets beside the point. Its random numbers depend on the seed of the trial only.
---```lua
---local study = bw.study {name = "scatter", variables = {{name = "sample", kind = "integer", min = 1, max = 8}},
---  measures = {{name = "young", unit = "Pa"}}, design = {"grid"},
---  run = function(_, trial) return {young = trial:normal(2.3e9, 0.1e9)} end}
---print(assert(study:run()))
---```
---@class bw.Trial
---@field number integer (index from 1) in the file
---@field key string SHA-256 of the study's name, seed and point, hexadecimal
---@field seed integer (seed) of the trial, from the study's seed and the key
---@field point table<string, any> values by the names of variables
---@field study bw.Study that it is of
---@field folder string for files of this trial, made when it is first read
local Trial = {}

---A random number, as of math.random: from 0 to below 1; an integer from 1 to a; an integer from a to b.
---@param a? integer (any) the largest, or the smallest, integer
---@param b? integer (any) the largest integer, at least a
---@return number random (any) the number
function Trial:random(a, b) end

---A random number of a normal distribution.
---@param mean? number (any) its mean. Default: 0
---@param deviation? number (any) its standard deviation. Default: 1
---@return number random (any) the number
function Trial:normal(mean, deviation) end

---As `study:cached`.
---
---Errors: as of `study:cached`.
---@param what any names the entry
---@param make fun(): any makes it; nil, message, details on failure
---@param options? bw.StudyCachedOptions files that it depends on
---@return any made what `make` returns
---@return string? message
---@return bw.Details? details
function Trial:cached(what, make, options) end

---How a trial ended: with results; `run` failed; beyond its time; beyond its memory; its process ended.
---@alias bw.TrialStatus "done"|"failed"|"time"|"memory"|"crashed"

---A trial that has ended.
---@class bw.TrialRecord
---@field number integer (index from 1) in the file
---@field key string SHA-256 of the study's name, seed and point, hexadecimal
---@field seed integer (seed) of the trial
---@field status bw.TrialStatus how it ended
---@field message string? why it has no results
---@field point table<string, any> values by the names of variables
---@field results table<string, number>? by the names of measures; nil but for "done"
---@field gradients table<string, table<string, number>>? of measures by variables; nil where `run` returned none
---@field seconds number (s) wall-clock time
---@field processor_seconds number? (s) time on processors
---@field peak_bytes integer? (bytes) the most memory in use
---@field attempts integer (count) how often it was run
---@field folder string of its files; it may not exist

---A list of trials that have ended, each a bw.TrialRecord.
---```lua
---local study = bw.study {name = "ball", design = {"grid", levels = 5}, objectives = {"volume"},
---  variables = {{name = "radius", unit = "m", min = 0.01, max = 0.02}},
---  measures = {{name = "volume", unit = "m3"}}, constraints = {{name = "volume", min = 1e-5}},
---  run = function(point) return {volume = 4 / 3 * math.pi * point.radius ^ 3} end}
---local trials = assert(study:run())
---print(assert(trials:best()), #trials:where "done", assert(trials:plot("history"):write "history.svg"))
---```
---@class bw.Trials
---@field problem bw.StudyProblem of the study
---@field study bw.Study that they are of
---@field summary bw.StudySummary what the design found; empty but after `study:run`
---@field stopped string? why the run ended before the design did; nil where it did not
local Trials = {}

---What a design found. Which fields there are depends on the design.
---@class bw.StudySummary
---@field best? bw.TrialRecord of a study with one objective: the best feasible trial; nil where there is none
---@field front? bw.Trials of a study with several objectives: the Pareto front of the feasible trials
---@field text? string for `print`
---@field base? table<string, any> of "one_at_a_time": the base point
---@field ranges? table<string, bw.StudyRange[]> of "one_at_a_time": by measures, an entry for each variable
---@field effects? table<string, bw.StudyEffect[]> of "morris": by measures, an entry for each variable
---@field indices? table<string, bw.StudyIndex[]> of "sobol_indices": by measures, an entry for each variable
---@field mean? table<string, number> of "sobol_indices": of each measure
---@field variance? table<string, number> of "sobol_indices": of each measure
---@field dropped? integer (count) of "morris" and "sobol_indices": effects or rows left out, where a trial has no result
---@field starts? bw.StudyStart[] (list) of "minimise": how each start ended
---@field method? string of "minimise": NLopt's method
---@field generations? integer (count) of "pareto"
---@field population? integer (count) of "pareto"
---@field hypervolume? number[] (any, one for each generation) of "pareto": of the front so far, for at most three objectives
---@field failure? bw.StudyFailure of "random", "latin_hypercube" and "sobol" where variables have distributions and there are constraints
---@field probability? number (-) of "form", "importance" and "subset": that a constraint is violated; nil where no failure was found, and of "form" where there are several points or a bound without one
---@field low? number (-) of the same: the least, with 95 % confidence; of "form" the largest of its points
---@field high? number (-) of the same: the most, with 95 % confidence; of "form" the sum of its points
---@field deviation? number (-) of "importance" and "subset": standard deviation of `probability`
---@field count? integer (count) of "bayesian", "importance" and "subset": trials
---@field why? "tolerance"|"count"|"exhausted" of "bayesian": why it ended; "exhausted": all points were tried
---@field expected? number (any) of "bayesian": the improvement that one more trial promises; nil where none is feasible
---@field error? number (-) of "bayesian": root mean square of what the process misses by at trials that it does not know, over the range of the objective
---@field failures? integer (count) of "importance": trials that violate a constraint
---@field points? bw.DesignPoint[] (list) of "form": the likeliest points of failure
---@field lost? bw.DesignPoint[] (list) of "form": where searches ended that found none
---@field form? bw.StudySummary of "importance": `points` and `lost` of its search
---@field levels? bw.SubsetLevel[] (list) of "subset"
---@field value? any of a function that returned a number or a string

---The share of trials that violate a constraint, of trials drawn from the distributions.
---@class bw.StudyFailure
---@field probability number (-) their share; a trial without results counts
---@field low number (-) of Wilson's interval of 95 %
---@field high number (-) of Wilson's interval of 95 %
---@field failures integer (count) of such trials
---@field text string for `print`

---The likeliest point at which a bound of a constraint is violated.
---@class bw.DesignPoint
---@field limit bw.StudyLimit which bound
---@field point table<string, number> values by the names of variables
---@field y number[] (-, one for each variable) independent coordinates of the standard normal distribution
---@field reliability_index number (-) distance of y from the origin; negative where the medians violate the bound
---@field probability number (-) of a violation, by a plane at the point
---@field importance? table<string, number> (-) fractions of the variance of the plane's distance, by variable; nil with correlations
---@field converged boolean whether the search did
---@field why string "converged", "flat" (nothing changes there), "stuck" (no step lowers the merit), "iterations", or "a trial without a result"
---@field evaluations integer (count) trials

---One bound of a constraint.
---@class bw.StudyLimit
---@field name string of the measure
---@field side "min"|"max" which bound
---@field bound number (any) its value

---A level of subset simulation.
---@class bw.SubsetLevel
---@field margin number (-) distance from the bound, in parts of it, below which the next trials lie; 0: the last
---@field share number (-) of the trials below

---What one variable does to a measure, the others at the base point.
---@class bw.StudyRange
---@field name string of the variable
---@field values any[] of the variable, in order
---@field results number[] (any, n) of the measure at these values
---@field min number? (any) the smallest result; nil where there is none
---@field max number? (any) the largest result; nil where there is none
---@field range number? (any) their difference

---Elementary effects of one variable on a measure, for a change over the whole range of the variable.
---@class bw.StudyEffect
---@field name string of the variable
---@field count integer (count) of effects
---@field mu number? (any) their mean; nil without any
---@field mu_star number? (any) the mean of their magnitudes
---@field mu_star_interval number[]? (any, 2: low, high) 95 % interval of mu_star by the bootstrap
---@field sigma number? (any) their standard deviation

---Sobol's indices of one variable.
---@class bw.StudyIndex
---@field name string of the variable
---@field first number (-) fraction of the variance by this variable alone
---@field total number (-) fraction of the variance by this variable and all its interactions
---@field first_interval number[]? (-, 2: low, high) of `first`, by the bootstrap
---@field total_interval number[]? (-, 2: low, high) of `total`, by the bootstrap

---How an optimisation from one start ended.
---@class bw.StudyStart
---@field start table<string, any> the point that it began at
---@field point table<string, any>? the point that it ended at; nil where it failed
---@field value number? (any) the objective there
---@field why string what ended it
---@field evaluations integer? (count) of the objective
---@field converged boolean? whether a tolerance was met

---Values of one column, for each trial that is done and has one. An unknown name raises.
---@param name string of a variable or a measure; or "number", "key", "seed", "status", "seconds", "processor_seconds", "peak_bytes"
---@param options? bw.TrialsColumnOptions of which trials
---@return any[] values in the order of the trials
function Trials:column(name, options) end

---Which trials a column has.
---@class bw.TrialsColumnOptions
---@field all? boolean of every trial, false where there is no value. Default: false

---The trials with a status, or those that a function chooses.
---@param which bw.TrialStatus|fun(trial: bw.TrialRecord): boolean a status, or a choice
---@return bw.Trials trials in the same order
function Trials:where(which) end

---The best feasible trial by one objective. A study without objectives needs a name.
---
---Errors: infeasible (no trial satisfies the constraints).
---@param name? string of an objective, or of a measure, which is minimised. Default: the first objective
---@return bw.TrialRecord? best the trial
---@return string? message
---@return bw.Details? details
function Trials:best(name) end

---The Pareto front of the feasible trials: those that no other trial dominates. A study without objectives raises.
---@return bw.Trials front by the first objective
function Trials:front() end

---The number of trials of each status.
---@return table<bw.TrialStatus, integer> counts (count) by status, 0 where there is none
function Trials:counts() end

---Writes the trials as CSV (RFC 4180), with units in the head. With constraints the column `feasible` says whether a trial
---keeps them, with objectives `front` whether it is the best or on the Pareto front.
---
---Errors: io (the table cannot be written).
---@param path string of the table
---@return true? written true
---@return string? message
---@return bw.Details? details
function Trials:csv(path) end

---A measure between the trials, with its standard deviation: a Gaussian process through the trials that have the measure.
---Choices count as ordered. A name that is no measure raises.
---
---Errors: empty (fewer than 3 trials have the measure), limit (more than 1000 do), convergence (no process goes through them).
---@param name string of a measure
---@return bw.Surrogate? surrogate of the measure
---@return string? message
---@return bw.Details? details
function Trials:surrogate(name) end

---A measure between trials. `print` gives its error.
---```lua
---local study = bw.study {name = "arc", design = {"sobol", count = 16}, measures = {"y"},
---  variables = {{name = "x", min = 0, max = 3}}, run = function(point) return {y = math.sin(point.x)} end}
---local arc = assert(assert(study:run()):surrogate "y")
---local value, deviation = arc:predict {x = 1}
---print(value, deviation)
---```
---
---Source: C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for Machine Learning (2006).
---@class bw.Surrogate
---@field measure string its name
---@field unit string? of its values
---@field count integer (count) of trials
---@field error number (any) root mean square of what it misses trials by that are left out one by one
---@field lengths table<string, number> (-) by variables: lengths over which the measure changes, in parts of the range; a large one means little influence
local Surrogate = {}

---The value expected at a point. Far from the trials it goes to their mean, and the deviation to that of all.
---@param point table<string, any> values by the names of variables
---@return number value (any) in the unit of the measure
---@return number deviation (any) standard deviation of the value
function Surrogate:predict(point) end

---A figure with the study's names, units, goals and constraints. Kinds:
---
---- "history": a measure over the trials;
---- "convergence": the distance to the best value, or for two or three objectives the hypervolume of the front;
---- "pareto": objectives against each other, with the front;
---- "scatter": two columns against each other;
---- "scatter_matrix", "parallel_coordinates": many columns;
---- "sensitivity": after the designs sobol_indices, morris and one_at_a_time;
---- "contact_sheet": pictures in the folders of the trials.
---
---Options of other kinds, and studies that a kind is not for, raise.
---@param kind "history"|"convergence"|"pareto"|"scatter"|"scatter_matrix"|"parallel_coordinates"|"sensitivity"|"contact_sheet" which
---@param options? bw.TrialsPlotOptions of this kind
---@return bw.Figure figure to be written
function Trials:plot(kind, options) end

---Options of figures of trials. The text names the kinds that take an option; all take title, width and height.
---@class bw.TrialsPlotOptions
---@field title? string above the figure. Default: none, or by the kind
---@field width? number (pixels) Default: by the kind
---@field height? number (pixels) Default: by the kind
---@field measure? string of "history" and "sensitivity". Default: the first objective, else the first measure
---@field goal? "min"|"max" of "history". Default: that of the objective
---@field scale? "linear"|"log" of "history" and "scatter". Default: by the values
---@field objectives? string[] of "pareto": two or more. Default: the study's
---@field x? string of "scatter": a column, needed
---@field y? string of "scatter": a column, needed
---@field columns? string[]|integer (count) of "scatter_matrix" and "parallel_coordinates": names of columns. Default: all, at most 8 or 24; of "contact_sheet": pictures in a row
---@field colour? string of "scatter", "scatter_matrix" and "parallel_coordinates": a column. Default: the first objective, else the first measure; of "scatter" none
---@field picture? string of "contact_sheet": the file's name. Default: picture.png, else the first PNG file
---@field max? integer (count) of "contact_sheet": pictures. Range: 1 to 400. Default: 40
---@field cell? number (pixels) of "contact_sheet": width of a picture. Range: 60 to 2000. Default: 230

---Writes a page that needs no network: problem, results, failures, figures, pictures and all trials.
---
---Errors: io (the page cannot be written).
---@param path string of the HTML file
---@param options? bw.TrialsReportOptions what it shows
---@return true? written true
---@return string? message
---@return bw.Details? details
function Trials:report(path, options) end

---What a page of trials shows.
---@class bw.TrialsReportOptions
---@field title? string Default: "Study" and its name
---@field text? string a paragraph at the top. Default: `what` of the study
---@field picture? string name of a file in the folders of the trials. Default: picture.png, else the first PNG file
---@field pictures? integer (count) at most. Range: 0 to 400. Default: 40
---@field rows? integer (count) of the table of trials, at most. Range: at least 0. Default: 5000
---@field manifest? table<string, any> shown at the end. Default: `study:manifest()`
