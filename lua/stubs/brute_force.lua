---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Brute force
--
-- The worst case with every element as its own region. It is slow, and measures what `bw.worst_case` misses.

---@class bw
local bw = {}

---The largest stress that any admissible load causes in each element, or in a sample of them. With the objective "trace" each
---load maximises the trace of the element's stress. With "principal" an ascent of its principal stress follows, about three times
---as long.
---
---Errors: those of `bw.worst_case`.
---
---Source: Zhou, Panetta and Zorin 2013, section 5; docs/theory/worst_case.md.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---local brute = assert(bw.brute_force(part, {force = 50, elements = 20}))
---print(brute, brute:percentile())
---```
---@param part bw.Model the part
---@param options? bw.BruteForceOptions the loads and the elements
---@return bw.BruteForce? brute the answer
---@return string? message
---@return bw.Details? details
function bw.brute_force(part, options) end

---Which loads are admissible, and which elements are tried.
---@class bw.BruteForceOptions
---@field force? number (N) total force, see `bw.WorstCaseOptions`. Default: 20
---@field pressure? number (Pa) largest pressure. Default: 2e5
---@field contact? number (m2) in place of `pressure`: the largest pressure is `force / contact`
---@field force_is_max? boolean the total force may also be smaller. Default: false
---@field forbidden? bw.Selection|bw.Selection[] facets on which no pressure acts. Default: none
---@field friction? number (-) Coulomb's coefficient of friction. Range: 0 to 100. Default: 0
---@field friction_facets? integer (count) facets of the pyramid in the friction cone. Range: 3 to 64. Default: 8
---@field hands? integer (count) the pressure lies within so many patches. Range: 1 to 16. Default: anywhere
---@field hand? number (m2) area that each of `hands` can reach. Default: `force / pressure`
---@field elements? integer (count) a random sample of so many elements, 1 or more. Default: all
---@field seed? integer (seed) of the sample. Default: 1
---@field one_sign? boolean try only the positive sign. Default: false, both
---@field batch? integer (count) elements that are worked on at once. Default: 0, chosen
---@field lp? bw.LpSolver|"auto" what solves the linear programs. Default: "auto", by counted cost
---@field objective? "trace"|"principal" what the loads maximise. Default: "trace"

---What brute force found. `print` gives it in one line.
---```lua
---local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}}
---local part = bw.model {mesh = mesh, material = bw.material.pla}
---local brute = assert(bw.brute_force(part, {force = 50, elements = 20}))
---print(brute:compare(assert(bw.worst_case(part, {force = 50}))).ratio)
---```
---@class bw.BruteForce
---@field weakness bw.Array (Pa, element_count × 1, per element) the largest stress over all loads
---@field peaks bw.Array (Pa, elements × 1, per element tried) the largest stress under its load
---@field max_principal number (Pa) the largest stress
---@field element integer (index from 1) the element with it
---@field elements integer (count) elements that were tried
---@field reports table<string, bw.SolverReport> of solvers: `lp`, all linear programs together
---@field seconds number (s) in all
---@field mesh bw.Mesh of the part
---@field options bw.BruteForceOptions as they were given, with defaults
local BruteForce = {}

---A percentile of the weakness by volume.
---@param p? number (-) per cent. Range: 0 to 100. Default: 99.75
---@return number stress (Pa) below which p per cent of the volume lie
function BruteForce:percentile(p) end

---A percentile of the weakness beside that of a worst case of the same part.
---@param worst bw.WorstCase of the same part
---@param p? number (-) per cent. Range: 0 to 100. Default: 99.75
---@return bw.BruteForceComparison comparison both percentiles
function BruteForce:compare(worst, p) end

---Percentiles of two weakness maps.
---@class bw.BruteForceComparison
---@field worst_case number (Pa) that of the worst case
---@field brute_force number (Pa) that of brute force
---@field ratio number (-) the first over the second
