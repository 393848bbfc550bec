---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Bridges
--
-- Bridges of least area over a span.

---A bridge: its right half is what is held, meshed and moved; tags "foot", "pad", "hold" (the middle of the
---pad), "axis" and "free". Feet and pad stay where they are. Prints as one line.
---@class bw.Bridge
---@field outline bw.Outline of the right half
---@field whole bw.Outline both halves, to cut or print
---@field area number of the whole, m2
---@field stress_limit number Pa
---@field utilisation number largest von Mises stress over the limit
---@field passes boolean
---@field von_mises bw.Array at the nodes, Pa
---@field stress bw.Array xx, yy, xy, zz at the nodes, Pa
---@field displacement bw.Array x, y at the nodes, m
---@field points bw.Array of the half's mesh, m
---@field elements bw.Array corners and middles of edges 12, 23, 31, from 1
---@field element_count integer
---@field node_count integer
---@field error_estimate number relative, in energy
---@field reused bw.Kept what the last frame kept
---@field options table as asked for, with what was chosen
local Bridge = {}

---Moves a handle of the outline by {dx, dy}.
---@param handle bw.DragHandle
---@param by number[]
---@return bw.Bridge?
---@return string? message
---@return bw.Details? details
function Bridge:drag(handle, by) end

---Push-pin pulling of a curve, as Outline:pull.
---@param vertex integer
---@param to number[]
---@param how? bw.OutlinePullOptions
---@return bw.Bridge?
---@return string? message
---@return bw.Details? details
function Bridge:pull(vertex, to, how) end

---Smooths the free curves, as Outline:smooth.
---@param how? bw.OutlineSmoothOptions
---@return bw.Bridge?
---@return string? message
---@return bw.Details? details
function Bridge:smooth(how) end

---A round hole more, and its image on the other half.
---@param centre number[]
---@param radius number
---@return bw.Bridge?
---@return string? message
---@return bw.Details? details
function Bridge:hole(centre, radius) end

---A hole less.
---@param loop string|integer
---@return bw.Bridge?
---@return string? message
---@return bw.Details? details
function Bridge:without(loop) end

---Becomes another right half; feet and pad are put back where only points moved, else they must be there.
---@param outline bw.Outline
---@return bw.Bridge?
---@return string? message
---@return bw.Details? details
function Bridge:become(outline) end

---Largest von Mises stress on another mesh of the same shape, and its number of elements.
---@param size number of elements, m
---@param order? integer
---@return number?
---@return integer|string
---@return bw.Details? details
function Bridge:check(size, order) end

---The lowest beam of one height that passes: height and area of the whole.
---@return number?
---@return number|string area
---@return bw.Details? details
function Bridge:uniform_beam() end

---Michell's least area of bars for a force in the middle between the middles of the feet.
---@return number
function Bridge:michell_area() end

---Bending moment in the middle over limit thickness depth^2 / 4, which the depth could bear with all of it at the
---limit: a solid beam bears 0.67, nothing above 1.155.
---@return number
function Bridge:moment_share() end

---Finds the shape of least area that passes, and becomes it; where none was found, that of the least stress, and
---`message` says what it bears. passes: utilisation and checked_utilisation are 1 at most. converged: the area
---fell by less than 1 % in the last fifth of the rounds, else `message` says so. starts: where to begin, the best
---is kept: "current" (the outline as it is; default where it was given or changed), "truss", "gable", "beam",
---"arch" (else the default). Holes that were put in by hand stay as they are, whatever the start; a place that must stay
---free of material is such a hole. rounds: of each; holes: most in a half; polish: rounds on a finer mesh, until it passes on one finer still.
---report is told of every round and may return false to end it. Ctrl-C keeps the best.
---@param options? bw.BridgeDesignOptions
---@return bw.BridgeDesign?
---@return string? message
---@return bw.Details? details
function Bridge:design(options) end

---@class bw.BridgeDesignOptions
---@field starts? string[]
---@field rounds? integer
---@field holes? integer
---@field polish? integer
---@field report? fun(now: table): boolean?

---@class bw.BridgeDesign
---@field start string
---@field area number
---@field utilisation number
---@field passes boolean
---@field checked_utilisation number?
---@field checked_elements integer?
---@field interrupted boolean
---@field converged boolean
---@field message string?
---@field starts table[]

---Writes a picture, coloured by stress (.svg, .png).
---@param path string
---@return boolean?
---@return string? message
---@return bw.Details? details
function Bridge:picture(path) end

---The bridge as a closed surface of its thickness.
---@return bw.Surface?
---@return string? message
---@return bw.Details? details
function Bridge:body() end
