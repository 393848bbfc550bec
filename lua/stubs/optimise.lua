---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Optimisation of edits
--
-- Scaling of bones until a stress limit is met, and the gradients behind it.

---@class bw
local bw = {}

---The von Mises stress of a static solution at some nodes, and how it changes with the position of
---every node: a block of a row for every node of the mesh for each of the nodes. What middle nodes
---contribute is part of their edge's ends; their own rows are zero. Straight elements only.
---@param part bw.Model
---@param system bw.System|bw.LocalSystem of the part
---@param displacement bw.Array
---@param nodes integer[]|bw.Array
---@param options? bw.VonMisesGradientOptions where a local system iterates: relative residual, or (energy) error in energy; fields to begin with; iterations at most over predicted
---@return bw.Array? von_mises
---@return bw.Array|string gradient or a message
---@return bw.Details? details
function bw.von_mises_gradient(part, system, displacement, nodes, options) end

---@class bw.VonMisesGradientOptions
---@field method? "auto"|"refactor"|"iterate"|"pcg"|"scratch"
---@field tolerance? number
---@field energy? boolean
---@field guess? bw.Array[]
---@field max_iteration_ratio? number

---The same for some motions of all nodes: a row for each of the nodes, a column for each motion.
---@param part bw.Model
---@param system bw.System|bw.LocalSystem of the part
---@param displacement bw.Array
---@param nodes integer[]|bw.Array
---@param motions bw.Array[] a row for every node of the mesh each
---@param options? bw.VonMisesGradientOptions
---@return bw.Array? von_mises
---@return bw.Array|string slopes or a message
---@return bw.Array|table adjoint displacements, a block of a row for every node of the mesh for each of the nodes; or details
function bw.von_mises_slopes(part, system, displacement, nodes, motions, options) end

---@class bw.OptimiseOptions
---@field von_mises number the limit, Pa
---@field bones? string[] these bones; left out: those of domains with stresses above the limit, and those next to blended domains with such stresses
---@field keep? (string|bw.Selection)[] bones that stay as they are, by name; and selections on the session's original mesh (faces, places) that do not move: no bone is scaled in a direction that would move a node of them
---@field move_supports? boolean let scaled bones move the supports too; default false: as for selections that are kept, in the directions that a support holds
---@field ties? string[][] lists of bones that change by the same factors
---@field low? number least factor since rest; default 0.5
---@field high? number largest factor since rest; default 3
---@field cases? bw.Model[] further load cases: parts on the session's original mesh, with the same supports
---@field loads? "own"|"worst" "worst": the worst load of a part without supports, found again after each round
---@field worst? bw.WorstCaseOptions of finding the worst load
---@field rounds? integer of finding the worst load, at most; default 8
---@field change? number a worst load whose stress is above the limit by no more than this fraction is the last; default 0.02
---@field iterations? integer steps, at most; default 40
---@field tolerance? number relative change of the change of shape at which to stop; default 1e-4
---@field refills? integer how often domains may be filled again where the mesh stops steps; default 3
---@field step? number largest relative change of a factor in the first step; default 0.5
---@field inertia_relief? boolean see bw.Session:solve; with loads = "worst" by default

---What a scaling optimisation found. Prints as a few lines.
---@class bw.Optimisation
---@field met boolean whether no stress is above the limit
---@field von_mises number the largest, Pa
---@field node integer where
---@field case integer under which load: 1 the session's own (unless loads = "worst"), then `cases`, then worst loads
---@field from number the largest before, Pa
---@field limit number
---@field factors table<string, number[]> of the bones that were free to change, since rest
---@field change number m2: the sum over the corner nodes of the squares of their moves
---@field mean_move number m: root mean square
---@field iterations integer steps taken
---@field unknowns integer factors that were free
---@field constrained integer
---@field nodes table[] the constrained nodes: {node, case, von_mises}
---@field history table[] after each step: {max, node, case, change, constrained, unknowns}
---@field rounds? table[] of worst loads: {max, max_principal, mode, at}
---@field shapes integer that were tried
---@field solves integer
---@field adjoints integer
---@field factorisations number a partial one counts as the part of the work that was done
---@field seconds number
