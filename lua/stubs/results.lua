---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Results
--
-- Folders of results that can be computed again: result.json holds plain numbers, manifest.json what made them. `barwright rerun`
-- reads them (docs/howto_experiments.md).

---Folders of results, and what a run depends on.
---@class bw.ResultsModule
local results_module = {}

---A folder for results, which is made where it is missing. A folder that cannot be written into is found now.
---
---Errors: io (the folder cannot be made or written into, or an input cannot be read).
---```lua
---local results = assert(bw.results.open("out", {options = {force = 50}, seed = 1}))
---assert(results:write {stress_Pa = 1.2e6})
---print(results:path "result.json") -- out/result.json
---```
---@param folder string its path
---@param about? bw.ResultsAbout what made the results
---@return bw.Results? results the folder
---@return string? message
---@return bw.Details? details
function results_module.open(folder, about) end

---What made the results, for the manifest.
---@class bw.ResultsAbout
---@field script? string its name. Default: the file that runs
---@field inputs? string[] paths of files, which are named with their SHA-256; pieces that a .pvtu file names are inputs too. Default: none
---@field options? table<string, any> what the script was asked for. Default: none
---@field seed? integer|bw.JsonNull (seed) of random numbers; `bw.json.null`: none. Default: none

---The peak memory of the process; nil where the system does not report it.
---```lua
---local bytes = bw.results.peak_memory()
---print(bytes and bytes > 0)
---```
---@return integer? memory (bytes) the peak
function results_module.peak_memory() end

---What a run depends on besides its script and inputs.
---```lua
---local around = bw.results.surroundings()
---print(around.version, around.machine.processors, #around.libraries)
---```
---@return bw.Surroundings surroundings program and machine
function results_module.surroundings() end

---Program and machine of a run.
---@class bw.Surroundings
---@field program string "barwright"
---@field version string of barwright
---@field commit string|bw.JsonNull of barwright; null where it is not known
---@field libraries string[] names and versions
---@field required bw.RequiredFile[] (list) modules that `require` has loaded from files, but for those of barwright
---@field threads integer (count) in use
---@field machine bw.Machine the computer

---A module that a script has loaded. Files of `dofile` are not among them: name them in `inputs`.
---@class bw.RequiredFile
---@field module string its name
---@field file string where `package.path` or `package.cpath` finds it
---@field sha256? string of the file; nil where it cannot be read

---A computer.
---@class bw.Machine
---@field processor? string its model
---@field processors integer (count) of processors
---@field memory_bytes? integer (bytes) of memory
---@field system? string the operating system

---A folder of results.
---```lua
---local results = assert(bw.results.open "out")
---assert(bw.surface.sphere({radius = 0.01}):write(results:path "ball.stl"))
---assert(results:write {radius_m = 0.01})
---```
---@class bw.Results
---@field folder string its path
---@field manifest table<string, any> what manifest.json will hold; a script may add to it
local Results = {}

---The path of a file in the folder.
---@param name string the file
---@return string path folder and name
function Results:path(name) end

---Writes result.json and manifest.json.
---
---Errors: io (a file cannot be written).
---@param result table<string, any> plain numbers, with the unit in the key, texts, and tables of these
---@return true? written true
---@return string? message
---@return bw.Details? details
function Results:write(result) end
