---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Results
--
-- Folders of results that can be computed again.

---Results that can be run again: result.json and manifest.json in a folder.
---@class bw.ResultsModule
local results_module = {}

---@param folder string made when missing
---@param about? bw.ResultsAbout
---@return bw.Results?
---@return string? message
---@return bw.Details? details
function results_module.open(folder, about) end

---@class bw.ResultsAbout
---@field script string
---@field inputs string[]
---@field options table
---@field seed integer

---Peak memory of the process, bytes.
---@return integer?
function results_module.peak_memory() end

---What a run depends on besides its script and inputs: version, commit, libraries, threads, machine.
---@return table
function results_module.surroundings() end

---@class bw.Results
---@field folder string
---@field manifest table
local Results = {}

---The path of a file in the folder.
---@param name string
---@return string
function Results:path(name) end

---Writes result.json (plain numbers, unit in the key) and manifest.json.
---@param result table
---@return true?
---@return string? message
---@return bw.Details? details
function Results:write(result) end
