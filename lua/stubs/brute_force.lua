---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Brute force
--
-- The worst case with every element as its own region: slow, the measure of the rest.

---@class bw
local bw = {}

---The same as `bw.worst_case` with every element, or a sample of them, as its own region. Slow; the measure of the rest.
---With objective "trace" (default, the paper's) each load maximises the trace of the element's stress;
---with "principal" an ascent of its principal stress follows, about three times as long.
---@param part bw.Model
---@param options? bw.BruteForceOptions
---@return bw.BruteForce?
---@return string? message
---@return bw.Details? details
function bw.brute_force(part, options) end

---@class bw.BruteForceOptions
---@field force? number
---@field pressure? number
---@field contact? number
---@field at_most? boolean
---@field forbidden? bw.Selection|bw.Selection[]
---@field friction? number
---@field friction_facets? integer
---@field hands? integer
---@field hand? number
---@field elements? integer
---@field seed? integer
---@field one_sign? boolean
---@field batch? integer
---@field objective? "trace"|"principal"

---@class bw.BruteForce
---@field weakness bw.Array of every element, Pa
---@field peaks bw.Array of every region tried
---@field max_principal number
---@field element integer
---@field elements integer how many were tried
---@field seconds number
---@field mesh bw.Mesh
---@field options table
local BruteForce = {}

---A percentile of the weakness map by volume; default 99.75.
---@param p? number
---@return number
function BruteForce:percentile(p) end

---Beside a worst case: {worst_case, brute_force, ratio}.
---@param worst bw.WorstCase
---@param p? number
---@return table
function BruteForce:compare(worst, p) end
