---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Plots
--
-- Plots as SVG and PNG.

---Plots: plain data in, a figure out. An axis is its label, or {label, unit, scale = "linear" | "log", least,
---most, prefix = true, whole}: values are in the unit, what is written at the axis may have an SI prefix.
---Lists of numbers are tables or arrays; what is not finite is left out and counted at the foot. Every kind
---takes title, width and height (pixels) too; unknown options raise.
---@class bw.PlotModule
local PlotModule = {}

---Lines through points in their order. A series: {name, y, x (1, 2, ... without), low and high: a band,
---colour, dashed, steps, markers, width}. marks: lines across, {{x = or y =, name}}.
---@param options bw.PlotLinesOptions
---@return bw.Figure
function PlotModule.lines(options) end

---@class bw.PlotLinesOptions
---@field series table[]
---@field x? table|string
---@field y? table|string
---@field marks? table[]
---@field notes? string[]
---@field legend? boolean
---@field diagonal? boolean

---Points. A series: {name, x, y, low and high: intervals, values: colours by the axis `values`, notes,
---colour, marker, size}.
---@param options bw.PlotScatterOptions
---@return bw.Figure
function PlotModule.scatter(options) end

---@class bw.PlotScatterOptions
---@field series table[]
---@field x? table|string
---@field y? table|string
---@field values? table|string
---@field marks? table[]
---@field notes? string[]
---@field legend? boolean
---@field diagonal? boolean

---Bars from 0: for each name one of every series {name, values, low, high, colour}.
---@param options bw.PlotBarsOptions
---@return bw.Figure
function PlotModule.bars(options) end

---@class bw.PlotBarsOptions
---@field names string[]
---@field series table[]
---@field value? table|string
---@field label? string
---@field horizontal? boolean
---@field notes? string[]
---@field legend? boolean

---The value of each trial in their order, and the best so far; those that miss a constraint (feasible: false)
---and those without a result (failed: true, or no number) are marked.
---@param options bw.PlotHistoryOptions
---@return bw.Figure
function PlotModule.history(options) end

---@class bw.PlotHistoryOptions
---@field values number[]
---@field numbers? integer[]
---@field goal? "min"|"max"
---@field failed? boolean[]
---@field feasible? boolean[]
---@field label? string
---@field unit? string
---@field scale? "linear"|"log"
---@field notes? string[]
---@field trial? string

---Two objectives with the front and what it beats; three to six pair by pair. An objective: {name, unit,
---goal = "min" | "max", values, scale}.
---@param options bw.PlotParetoOptions
---@return bw.Figure
function PlotModule.pareto(options) end

---@class bw.PlotParetoOptions
---@field objectives table[]
---@field feasible? boolean[]
---@field front? integer[]
---@field notes? string[]

---Two to ten columns against each other: points below the diagonal, how often on it, rank correlations
---above. A column: {name, unit, values: numbers or names, of: all names, scale, whole}. values: what colours
---the points, value: its axis; chosen: places that stand out; faint: flags of those that stand back.
---@param options bw.PlotScatterMatrixOptions
---@return bw.Figure
function PlotModule.scatter_matrix(options) end

---@class bw.PlotScatterMatrixOptions
---@field columns table[]
---@field values? number[]
---@field value? table|string
---@field goal? "min"|"max"
---@field chosen? integer[]
---@field faint? boolean[]
---@field notes? string[]

---Rows of two to 24 columns as lines over upright axes; options as those of scatter_matrix. The best by the
---coloured values lie on top.
---@param options bw.PlotParallelCoordinatesOptions
---@return bw.Figure
function PlotModule.parallel_coordinates(options) end

---@class bw.PlotParallelCoordinatesOptions
---@field columns table[]
---@field values? number[]
---@field value? table|string
---@field goal? "min"|"max"
---@field chosen? integer[]
---@field faint? boolean[]

---What matters: Sobol's indices (first, total) as bars with intervals (first_low, first_high, total_low,
---total_high), Morris' effects (mu_star, sigma, mu_star_low, mu_star_high) in a plane, or one variable at a
---time (low, high: the measure at its least and most; base). label, unit: of the measure.
---@param options bw.PlotSensitivityOptions
---@return bw.Figure
function PlotModule.sensitivity(options) end

---@class bw.PlotSensitivityOptions
---@field names string[]
---@field first? number[]
---@field total? number[]
---@field mu_star? number[]
---@field sigma? number[]
---@field low? number[]
---@field high? number[]
---@field base? number
---@field label? string
---@field unit? string

---Errors against size, both logarithmic, with triangles of the slope of each series {name, x, y, slope: what
---it should be, last: so many of the finest are fitted}; the fitted slope stands in the legend.
---@param options bw.PlotConvergenceOptions
---@return bw.Figure
function PlotModule.convergence(options) end

---@class bw.PlotConvergenceOptions
---@field series table[]
---@field x? table|string
---@field y? table|string
---@field triangles? boolean

---Pictures in a grid: {path: a PNG file, or figure, caption, chosen: a frame around it}. cell: their width in
---pixels (230), ratio: height by width, lines: of a caption (2).
---@param options bw.PlotContactSheetOptions
---@return bw.Figure
function PlotModule.contact_sheet(options) end

---@class bw.PlotContactSheetOptions
---@field pictures table[]
---@field title? string
---@field columns? integer
---@field cell? number
---@field ratio? number
---@field lines? integer

---What a plot gives: redrawn for each file.
---@class bw.Figure
---@field kind string
---@field name string
---@field width number
---@field height number
local Figure = {}

---By the ending: .svg or .png. text: "paths" (default, looks the same everywhere) or "text"; scale: pixels
---of a PNG for each of the figure's (2).
---@param path string
---@param options? bw.FigureWriteOptions
---@return boolean?
---@return string? message
---@return bw.Details? details
function Figure:write(path, options) end

---@class bw.FigureWriteOptions
---@field text? "paths"|"text"
---@field scale? number

---One <svg> element for a page. text: "text" (default) or "paths".
---@param options? bw.FigureSvgOptions
---@return string?
---@return string? message
---@return bw.Details? details
function Figure:svg(options) end

---@class bw.FigureSvgOptions
---@field text? "paths"|"text"

---Where a point of the data lies, in pixels from the figure's top left corner; nil for figures of several
---frames.
---@param x number
---@param y number
---@return number? x
---@return number? y
function Figure:place(x, y) end
