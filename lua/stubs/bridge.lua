---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Bridges
--
-- Bridges of least area over a span, made by `bw.responsive.bridge`: a load on the middle and a limit of the von Mises
-- stress are given.

---A bridge. It is symmetric about the axis x = 0, and its right half is what is meshed, solved and edited. The edges of
---the half have the tags "foot", "pad", "middle" (of the pad), "axis" and "free". Foot and pad stay in their
---places. `print(bridge)` gives one line.
---
---Source: Umetani, Takayama, Mitani, Igarashi, A Responsive Finite Element Method to Aid Interactive Geometric Modeling,
---section 5.2.
---```lua
---local options = {span = 0.2, load = 500, stress_limit = 20e6, thickness = 0.006, material = bw.material.pla}
---local bridge = assert(bw.responsive.bridge(options))
---assert(bridge:hole({0.04, 0.05}, 0.004))
---print(bridge.area, bridge.utilisation, bridge.passes)
---```
---@class bw.Bridge
---@field outline bw.Outline the right half
---@field whole bw.Outline both halves, to cut or print
---@field area number (m2) of both halves
---@field stress_limit number (Pa) the largest von Mises stress that is allowed
---@field utilisation number (-) the largest von Mises stress at the nodes over the limit
---@field passes boolean whether the utilisation is 1 at most
---@field von_mises bw.Array (Pa, node_count × 1, per node) von Mises stress
---@field stress bw.Array (Pa, node_count × 4, per node) stress: xx, yy, xy, zz
---@field displacement bw.Array (m, node_count × 2, per node) displacement along x and y
---@field points bw.Array (m, node_count × 2, per node) x and y of the mesh of the right half
---@field elements bw.Array (index from 1, element_count × 6, per element) corners, then the mid-edge nodes of edges 1-2, 2-3 and 3-1
---@field element_count integer (count) elements of the right half
---@field node_count integer (count) nodes of the right half
---@field error_estimate number (-) estimated relative error in the energy norm
---@field reused bw.ReuseStatistics what the last solution reused
---@field options bw.BridgeSettings what was asked for, with the values that were chosen
local Bridge = {}

---The options of a bridge, with the values that were chosen, and lengths that follow from them.
---@class bw.BridgeSettings
---@field span number (m) between the banks
---@field load number (N) on the pad
---@field stress_limit number (Pa) the largest von Mises stress that is allowed
---@field material bw.Material the material
---@field thickness number (m) the thickness
---@field bearing number (m) how far a foot reaches onto its bank. Default: the larger of `bar` and 1/25 of the span
---@field pad number (m) the width under the load. Default: the larger of twice `bar` and 1/12 of the span
---@field wall number (m) the smallest width of a member. Default: 1/50 of the span
---@field size number (m) the edge length of elements. Default: 1/100 of the span
---@field start string the shape to begin with. Default: "gable"
---@field depth? number (m) the height of the pad above the feet, where it was given
---@field deck number (m) the height of the pad above the feet: `depth`, else half the span
---@field outline? bw.Outline the right half to begin with, where it was given
---@field bar number (m) the width of a bar that carries the load at the limit: load / (thickness stress_limit)
---@field spacing number (m) distance of the control points of free curves: 2.2 `size`
---@field middle number (m) half the width of the middle part of the pad: 0.02 `pad`
---@field member number (m) the width of members to begin with: the larger of 0.75 `bar` and 1.5 `wall`

---Moves a handle of the outline.
---
---Errors: geometry (edges would cross or touch, or the material would reach across the axis), and those of
---`bw.plane.fill`. After a failure the bridge is as it was.
---@param handle bw.OutlineHandle what is moved
---@param by number[] (m, {x, y}) the displacement
---@return bw.Bridge? bridge the same bridge, solved again
---@return string? message
---@return bw.Details? details
function Bridge:drag(handle, by) end

---Pulls a vertex to a place, as `Outline:pull`.
---
---Errors: geometry (edges would cross or touch, or the material would reach across the axis), and those of
---`bw.plane.fill`. After a failure the bridge is as it was.
---@param vertex integer (index from 1) the vertex
---@param to number[] (m, {x, y}) its new place
---@param how? bw.OutlinePullOptions what stays
---@return bw.Bridge? bridge the same bridge, solved again
---@return string? message
---@return bw.Details? details
function Bridge:pull(vertex, to, how) end

---Smooths the free curves, as `Outline:smooth`.
---
---Errors: geometry (edges would cross or touch, or the material would reach across the axis), and those of
---`bw.plane.fill`. After a failure the bridge is as it was.
---@param how? bw.OutlineSmoothOptions which loop, and how strongly
---@return bw.Bridge? bridge the same bridge, solved again
---@return string? message
---@return bw.Details? details
function Bridge:smooth(how) end

---Adds a round hole. The other half has its image.
---
---Errors: geometry (edges would cross or touch, or the material would reach across the axis), and those of
---`bw.plane.fill`. After a failure the bridge is as it was.
---@param centre number[] (m, {x, y}) the centre
---@param radius number (m) the radius, above 0
---@return bw.Bridge? bridge the same bridge, solved again
---@return string? message
---@return bw.Details? details
function Bridge:hole(centre, radius) end

---Removes a hole.
---
---Errors: geometry (the loop is the outer one), and those of `bw.plane.fill`. After a failure the bridge is as it was.
---@param loop string|integer (index from 1) the hole by name or number
---@return bw.Bridge? bridge the same bridge, solved again
---@return string? message
---@return bw.Details? details
function Bridge:without(loop) end

---Takes another right half. Where only points have moved, foot, pad and axis are put back. Another topology must have
---them in their places.
---
---Errors: geometry (foot, pad or axis is not in its place, or the outline reaches across the axis; details `tag` or
---`x`), and those of `bw.plane.fill`. After a failure the bridge is as it was.
---@param outline bw.Outline the right half
---@return bw.Bridge? bridge the same bridge, solved again
---@return string? message
---@return bw.Details? details
function Bridge:become(outline) end

---Solves the same shape on another mesh.
---
---Errors: those of `bw.plane.fill`.
---@param size number (m) the edge length of elements
---@param order? integer (-) order of the elements: 1 or 2. Default: 2
---@return number? von_mises (Pa) the largest von Mises stress at the nodes
---@return integer|string element_count (count) of elements, or the message
---@return bw.Details? details
function Bridge:check(size, order) end

---The lowest beam of constant height that passes, found by bisection. The search looks between 0.5 and 2 times the
---height √(1.5 `bar` `span`), and returns the upper end where no height between passes.
---
---Errors: those of `bw.plane.fill`.
---@return number? height (m) its height
---@return number|string area (m2) of the whole beam, or the message
---@return bw.Details? details
function Bridge:uniform_beam() end

---Michell's least area of bars for a force in the middle between the centres of the feet: (1 + π/2) F a / (t σ). F is
---the load, a half the distance of these centres, t the thickness and σ the limit.
---@return number area (m2) for an unlimited plane
function Bridge:michell_area() end

---The bending moment in the middle over σ t h² / 4, which the depth h carries with all of it at the limit σ. A solid beam
---reaches 2/3. No shape passes above 2/√3.
---@return number fraction (-) the ratio
function Bridge:moment_fraction() end

---Finds the shape of least area that passes, and takes it. Where no shape passes, it takes the one of least stress, and
---`message` of the result gives the load that it carries. Holes added by hand stay as they are. Ctrl-C ends the search and keeps
---the best shape.
---
---Errors: infeasible (no shape of this depth can pass, details `moment_fraction`; or no start could be analysed), and those
---of `bw.plane.fill`.
---@param options? bw.BridgeDesignOptions where it begins, and how long it goes on
---@return bw.BridgeDesign? design what was found
---@return string? message
---@return bw.Details? details
function Bridge:design(options) end

---How the search for the least area goes on.
---@class bw.BridgeDesignOptions
---@field starts? string[] where to begin: "current", "truss", "gable", "beam", "arch"; the best is kept. Default: "current" where the outline was given or changed, else all others
---@field rounds? integer (count) rounds of each start. Range: 1 and more. Default: 120
---@field holes? integer (count) the most holes in a half, besides one across the axis. Range: 0 and more. Default: 6
---@field polish? integer (count) rounds on a finer mesh; 0: none. Range: 0 and more. Default: 40
---@field report? fun(now: bw.BridgeRound): boolean? called after each round; false ends the search

---A round of the search.
---@class bw.BridgeRound
---@field start string the start that it belongs to
---@field round integer (count) rounds so far
---@field rounds integer (count) of this start
---@field area number (m2) of the whole bridge
---@field utilisation number (-) the largest von Mises stress over the limit
---@field best_area number (m2) of the best shape so far
---@field passes boolean whether the best shape passes
---@field outline bw.Outline the right half

---What the search found.
---@class bw.BridgeDesign
---@field start string the start of the best shape
---@field area number (m2) of the whole bridge
---@field utilisation number (-) the largest von Mises stress over the limit, on the bridge's mesh
---@field passes boolean whether `utilisation` and `checked_utilisation` are 1 at most
---@field checked_utilisation number? (-) the same on a mesh with elements of 0.4 times the size; nil without `polish`
---@field checked_elements integer? (count) elements of that mesh
---@field interrupted boolean whether Ctrl-C ended the search
---@field converged boolean whether the area fell by less than 1 % in the last fifth of the rounds
---@field message string? why it does not pass or has not converged; nil otherwise
---@field starts bw.BridgeStart[] what each start led to

---What a start of the search led to.
---@class bw.BridgeStart
---@field start string the start
---@field passes boolean whether its shape passes
---@field area? number (m2) of the whole bridge; nil where it could not be analysed
---@field utilisation? number (-) the largest von Mises stress over the limit
---@field converged? boolean whether the search converged
---@field rounds? integer (count) rounds that were made
---@field history? bw.BridgeHistory[] the rounds
---@field message? string why it could not be analysed

---A round of a start.
---@class bw.BridgeHistory
---@field area number (m2) of the right half
---@field max number (Pa) the largest von Mises stress
---@field radius number (m) how far control points may move in a round
---@field best_area? number (m2) of the best right half so far; nil where none passes

---Writes a picture, coloured by the von Mises stress.
---
---Errors: io (the file cannot be written), unsupported (the file ends otherwise).
---@param path string the file, which ends in .svg or .png
---@return true? written true
---@return string? message
---@return bw.Details? details
function Bridge:picture(path) end

---The bridge as a closed surface of its thickness.
---
---Errors: only those that every function may give.
---@return bw.Surface? surface both halves
---@return string? message
---@return bw.Details? details
function Bridge:body() end
