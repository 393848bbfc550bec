---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Plots
--
-- Plots of data as SVG and PNG files.

---Plots: lists of numbers in, a figure out. Lists are tables or arrays of one column. A place without a finite number is not
---drawn. Unknown options raise, and so do lists of different lengths.
---@class bw.PlotModule
local PlotModule = {}

---Lines through points, in their order. A line breaks where a number is missing. The foot says how many points are left out.
---```lua
---local force = {name = "spring", x = {0, 1, 2, 3}, y = {0, 4, 8.5, 12}, low = {0, 3, 7, 10}, high = {0, 5, 10, 14}}
---local limit = {y = 10, name = "limit"}
---local figure = bw.plot.lines {series = {force}, x = {label = "length", unit = "m"}, y = "force, N", marks = {limit}}
---assert(figure:write "force.svg")
---```
---@param options bw.PlotLinesOptions series and axes
---@return bw.Figure figure the figure
function PlotModule.lines(options) end

---What every plot may have.
---@class bw.PlotOptions
---@field title? string the title above. Default: none
---@field width? number (pixels) width of the figure. Range: 120 to 6000. Default: 720
---@field height? number (pixels) height of the figure. Range: 100 to 6000. Default: 440

---An axis. Data are in its unit. The unit at the axis may get an SI prefix.
---@class bw.PlotAxis
---@field label? string the quantity. Default: none
---@field unit? string its unit, such as "Pa". Default: none
---@field scale? "linear"|"log" a log axis shows numbers above 0. Default: "linear"
---@field min? number (any) the lower end. Default: a little below the data
---@field max? number (any) the upper end, above `min`. Default: a little above the data
---@field prefix? boolean whether the unit may get an SI prefix. Default: true
---@field whole? boolean whether marks are at whole numbers only. Default: false

---Series of x and y in one frame.
---@class bw.PlotLinesOptions: bw.PlotOptions
---@field series bw.PlotSeries[] the series; each has a colour and a marker of its own
---@field x? string|bw.PlotAxis the axis across, or its label. Default: no label
---@field y? string|bw.PlotAxis the axis upwards, or its label. Default: no label
---@field values? string|bw.PlotAxis the axis of the colour bar, for series with `values`. Default: no label
---@field marks? bw.PlotMark[] lines across the frame. Default: none
---@field notes? string[] lines below the frame. Default: none
---@field legend? boolean whether series with a name are in a legend. Default: true
---@field diagonal? boolean whether the line x = y is drawn. Default: false

---One series of x and y.
---@class bw.PlotSeries
---@field name? string its name in the legend. Default: none
---@field x? number[]|bw.Array (any, n × 1) across. Default: 1, 2, 3, ...
---@field y number[]|bw.Array (any, n × 1) upwards
---@field low? number[]|bw.Array (any, n × 1) lower ends of a band (lines) or of intervals (scatter); beside `high`. Default: none
---@field high? number[]|bw.Array (any, n × 1) upper ends; beside `low`. Default: none
---@field values? number[]|bw.Array (any, n × 1) of scatters: what colours the points. Default: none, one colour
---@field notes? string[] for each point a text that an SVG shows under the mouse. Default: none
---@field colour? string "#rrggbb" or "#rrggbbaa". Default: the next colour
---@field marker? "disc"|"square"|"diamond"|"triangle"|"triangle_down"|"cross"|"plus" the marker. Default: the next one
---@field size? number (pixels) of markers, above 0. Range: up to 60. Default: 7, smaller for many points
---@field markers? boolean of lines: whether points have markers, too. Default: false
---@field dashed? boolean of lines: whether the line is dashed. Default: for the eighth series and on
---@field steps? boolean of lines: whether the line is a staircase, each y up to the next x. Default: false
---@field width? number (pixels) of lines, above 0. Range: up to 30. Default: 2

---A line across the frame; `x` or `y` is needed, not both.
---@class bw.PlotMark
---@field x? number (any) where an upright line is
---@field y? number (any) where a level line is
---@field name? string its name. Default: none

---Points, on request coloured by values with a colour bar. The foot says how many points are left out.
---```lua
---local points = {x = {1, 2, 3, 4}, y = {2, 4, 3, 5}, values = {10, 20, 30, 40}}
---local figure = bw.plot.scatter {series = {points}, x = "width, mm", y = "mass, g", values = {label = "stress", unit = "Pa"}}
---assert(figure:write "mass.png")
---```
---@param options bw.PlotLinesOptions series and axes
---@return bw.Figure figure the figure
function PlotModule.scatter(options) end

---Bars from 0: for each name one of every series.
---```lua
---local masses = {name = "mass", values = {1.2, 3.4}, low = {1, 3}, high = {1.5, 3.6}}
---local figure = bw.plot.bars {names = {"hook", "bracket"}, series = {masses}, value = {label = "mass", unit = "kg"}}
---assert(figure:write "masses.svg")
---```
---@param options bw.PlotBarsOptions names and series
---@return bw.Figure figure the figure
function PlotModule.bars(options) end

---Bars. Without a width or a height the figure grows with the names.
---@class bw.PlotBarsOptions: bw.PlotOptions
---@field names string[] what the bars are of
---@field series bw.PlotBarSeries[] the series
---@field value? string|bw.PlotAxis the axis of the values, or its label. Default: no label
---@field label? string what the names are, along their axis. Default: none
---@field horizontal? boolean whether bars run across. Default: for more than 8 names, or one of more than 12 letters
---@field legend? boolean whether series with a name are in a legend. Default: true
---@field notes? string[] lines below the frame. Default: none

---One series of bars.
---@class bw.PlotBarSeries
---@field name? string its name in the legend. Default: none
---@field values number[]|bw.Array (any, name_count × 1, per name) the bars
---@field low? number[]|bw.Array (any, name_count × 1, per name) lower ends of intervals; beside `high`. Default: none
---@field high? number[]|bw.Array (any, name_count × 1, per name) upper ends; beside `low`. Default: none
---@field colour? string "#rrggbb" or "#rrggbbaa". Default: the next colour

---The value of each trial in the order of the trials, and the best so far. Trials that miss a constraint or have no result are
---marked.
---```lua
---local values, failed = {3, 2.5, 2.8, 0 / 0, 2.1}, {false, false, false, true, false}
---local figure = bw.plot.history {values = values, failed = failed, label = "mass", unit = "kg"}
---assert(figure:write "history.svg")
---```
---@param options bw.PlotHistoryOptions values and what they are
---@return bw.Figure figure the figure
function PlotModule.history(options) end

---The values of trials.
---@class bw.PlotHistoryOptions: bw.PlotOptions
---@field values number[]|bw.Array (any, n × 1, per trial) the values; one that is not finite is a trial without a result
---@field numbers? number[]|bw.Array (any, n × 1, per trial) numbers of the trials, or times. Default: 1, 2, 3, ...
---@field goal? "min"|"max" which values are better. Default: "min"
---@field failed? boolean[] for each trial, whether it has no result. Default: none has failed
---@field feasible? boolean[] for each trial, whether it meets the constraints. Default: all do
---@field label? string the measure. Default: "value"
---@field unit? string its unit. Default: none
---@field scale? "linear"|"log" of its axis; "linear" where no value is above 0. Default: "linear"
---@field notes? string[] for each trial a text that an SVG shows under the mouse. Default: none
---@field trial? string the label of the other axis. Default: "trial"

---Two objectives with their Pareto front and the points that it dominates; three to six objectives pair by pair.
---```lua
---local mass = {name = "mass", unit = "kg", values = {1, 2, 3, 3}}
---local stiffness = {name = "stiffness", unit = "N/m", goal = "max", values = {1e3, 5e3, 6e3, 2e3}}
---local figure = bw.plot.pareto {objectives = {mass, stiffness}}
---assert(figure:write "front.svg")
---```
---@param options bw.PlotParetoOptions the objectives
---@return bw.Figure figure the figure
function PlotModule.pareto(options) end

---Objectives of trials. Of more than two, the default size grows with their number.
---@class bw.PlotParetoOptions: bw.PlotOptions
---@field objectives bw.PlotColumn[] two to six columns of numbers, with their `goal`
---@field feasible? boolean[] for each row, whether it meets the constraints. Default: all do
---@field front? integer[] (index from 1, n) rows of the front. Default: those that no feasible row dominates
---@field notes? string[] for each row a text that an SVG shows under the mouse. Default: none

---A column of a table of trials. All columns of a plot have the same length.
---@class bw.PlotColumn
---@field name string the quantity
---@field unit? string its unit. Default: none
---@field values number[]|string[]|bw.Array (any, n × 1, per row) numbers, or names
---@field of? string[] all names, in their order. Default: in the order in which they occur
---@field scale? "linear"|"log" of its axis; "linear" where no value is above 0. Default: "linear"
---@field min? number (any) the lower end of its axis. Default: a little below the data
---@field max? number (any) the upper end of its axis. Default: a little above the data
---@field whole? boolean whether marks are at whole numbers only. Default: false
---@field goal? "min"|"max" of an objective: which values are better. Default: "min"

---Two to ten columns against each other: points below the diagonal, histograms on it, Spearman's rank correlations above.
---```lua
---local width = {name = "width", unit = "m", values = {0.01, 0.02, 0.03, 0.04}}
---local mass = {name = "mass", unit = "kg", values = {1, 2.2, 2.9, 4.1}}
---local material = {name = "material", values = {"pla", "steel", "pla", "steel"}}
---local figure = bw.plot.scatter_matrix {columns = {width, mass, material}, values = mass.values, value = "mass, kg"}
---assert(figure:write "matrix.png")
---```
---@param options bw.PlotScatterMatrixOptions the columns
---@return bw.Figure figure the figure
function PlotModule.scatter_matrix(options) end

---Columns, and how their rows are coloured. Rows of better values are drawn above others.
---@class bw.PlotScatterMatrixOptions
---@field columns bw.PlotColumn[] two to ten columns
---@field values? number[]|bw.Array (any, n × 1, per row) what colours the rows. Default: none, one colour
---@field value? string|bw.PlotAxis the axis of the colour bar, or its label. Default: no label
---@field goal? "min"|"max" which of `values` are better. Default: "min"
---@field chosen? integer[] (index from 1, n) rows that are emphasised. Default: none
---@field faint? boolean[] for each row, whether it is drawn in grey, such as one that misses a constraint. Default: none is
---@field notes? string[] for each row a text that an SVG shows under the mouse. Default: none
---@field title? string the title above. Default: none
---@field width? number (pixels) width of the figure. Range: 200 to 6000. Default: by the number of columns
---@field height? number (pixels) height of the figure. Range: 200 to 6000. Default: by the number of columns

---Parallel coordinates: two to 24 columns as upright axes, and each row as a line over them.
---```lua
---local width = {name = "width", unit = "m", values = {0.01, 0.02, 0.03, 0.04}}
---local mass = {name = "mass", unit = "kg", values = {1, 2.2, 2.9, 4.1}}
---local figure = bw.plot.parallel_coordinates {columns = {width, mass}, values = mass.values, value = "mass, kg", chosen = {1}}
---assert(figure:write "rows.svg")
---```
---@param options bw.PlotParallelCoordinatesOptions the columns
---@return bw.Figure figure the figure
function PlotModule.parallel_coordinates(options) end

---Columns, and how their rows are coloured. Rows of better values are drawn above others.
---@class bw.PlotParallelCoordinatesOptions: bw.PlotOptions
---@field columns bw.PlotColumn[] two to 24 columns
---@field values? number[]|bw.Array (any, n × 1, per row) what colours the rows. Default: none, one colour
---@field value? string|bw.PlotAxis the axis of the colour bar, or its label. Default: no label
---@field goal? "min"|"max" which of `values` are better. Default: "min"
---@field chosen? integer[] (index from 1, n) rows that are emphasised. Default: none
---@field faint? boolean[] for each row, whether it is drawn in grey, such as one that misses a constraint. Default: none is

---Which variables matter. Three kinds: with `mu_star` and `sigma` Morris' elementary effects in their plane; with `low` and `high`
---the measure with one variable at a time changed; with `first` or `total` Sobol's indices as bars. Other choices raise.
---```lua
---local names = {"width", "height"}
---local figure = bw.plot.sensitivity {names = names, first = {0.2, 0.5}, total = {0.3, 0.7}, total_low = {0.2, 0.6},
---  total_high = {0.4, 0.8}, label = "mass"}
---assert(figure:write "indices.svg")
---```
---@param options bw.PlotSensitivityOptions names and what is known of them
---@return bw.Figure figure the figure
function PlotModule.sensitivity(options) end

---What is known of variables. All lists have a value for each name.
---@class bw.PlotSensitivityOptions: bw.PlotOptions
---@field names string[] names of the variables
---@field first? number[]|bw.Array (-, name_count × 1, per name) Sobol's indices of first order. Default: none
---@field first_low? number[]|bw.Array (-, name_count × 1, per name) lower ends of their intervals. Default: none
---@field first_high? number[]|bw.Array (-, name_count × 1, per name) upper ends of their intervals. Default: none
---@field total? number[]|bw.Array (-, name_count × 1, per name) Sobol's total indices. Default: none
---@field total_low? number[]|bw.Array (-, name_count × 1, per name) lower ends of their intervals. Default: none
---@field total_high? number[]|bw.Array (-, name_count × 1, per name) upper ends of their intervals. Default: none
---@field mu_star? number[]|bw.Array (any, name_count × 1, per name) mean absolute elementary effects (Morris). Default: none
---@field mu_star_low? number[]|bw.Array (any, name_count × 1, per name) lower ends of their intervals. Default: none
---@field mu_star_high? number[]|bw.Array (any, name_count × 1, per name) upper ends of their intervals. Default: none
---@field sigma? number[]|bw.Array (any, name_count × 1, per name) standard deviations of elementary effects. Default: none
---@field low? number[]|bw.Array (any, name_count × 1, per name) the measure with the variable at its minimum. Default: none
---@field high? number[]|bw.Array (any, name_count × 1, per name) the measure with the variable at its maximum. Default: none
---@field base? number (any) the measure with no variable changed. Default: none
---@field label? string the measure. Default: none
---@field unit? string its unit. Default: none

---Errors against size, both logarithmic, with a triangle of the slope of each series. The slope that is fitted by least squares is
---in the legend.
---```lua
---local linear = {name = "linear", x = {0.1, 0.05, 0.025}, y = {1e-2, 2.6e-3, 6.4e-4}, slope = 2}
---local figure = bw.plot.convergence {series = {linear}, x = {label = "edge length", unit = "m"}}
---assert(figure:write "convergence.svg")
---```
---@param options bw.PlotConvergenceOptions the series
---@return bw.Figure figure the figure
function PlotModule.convergence(options) end

---Errors by size.
---@class bw.PlotConvergenceOptions: bw.PlotOptions
---@field series bw.PlotConvergenceSeries[] the series
---@field x? string|bw.PlotAxis the axis of the sizes, or its label. Default: "size", logarithmic
---@field y? string|bw.PlotAxis the axis of the errors, or its label. Default: "error", logarithmic
---@field triangles? boolean whether slopes are drawn. Default: true

---One series of errors. Points of 0 or less are left out.
---@class bw.PlotConvergenceSeries
---@field name? string its name in the legend. Default: none
---@field x number[]|bw.Array (any, n × 1) sizes
---@field y number[]|bw.Array (any, n × 1) errors
---@field slope? number (-) the slope that theory predicts, drawn as the triangle. Default: the fitted one, rounded to a half
---@field last? integer (count) how many of the smallest sizes the slope is fitted to, 2 and more. Default: all
---@field colour? string "#rrggbb" or "#rrggbbaa". Default: the next colour
---@field notes? string[] for each point a text. Default: none

---A grid of pictures with captions. A picture that cannot be read leaves its place empty, with a note.
---```lua
---local figure = bw.plot.lines {series = {{y = {1, 4, 9}}}}
---local pictures = {{figure = figure, caption = "squares", chosen = true}, {path = "missing.png", caption = "none"}}
---assert(bw.plot.contact_sheet({pictures = pictures, columns = 2}):write "sheet.svg")
---```
---@param options bw.PlotContactSheetOptions the pictures
---@return bw.Figure figure the figure
function PlotModule.contact_sheet(options) end

---Pictures in a grid. More than 20000 pixels along a side raise.
---@class bw.PlotContactSheetOptions
---@field pictures bw.PlotPicture[] the pictures, row by row
---@field title? string the title above. Default: none
---@field columns? integer (count) pictures in a row. Range: 1 to 24. Default: by their number, up to 6
---@field cell? number (pixels) width of a picture. Range: 60 to 2000. Default: 230
---@field ratio? number (-) height of a picture over its width. Range: 0.1 to 10. Default: that of the first, if it is a figure, else 0.75
---@field lines? integer (count) lines of a caption. Range: 0 to 8. Default: 2

---A picture of a contact sheet: a file or a figure.
---@class bw.PlotPicture
---@field path? string a PNG file; not beside `figure`. Default: none
---@field figure? bw.Figure a figure of bw.plot. Default: none
---@field caption? string the text below. Default: none
---@field chosen? boolean whether it has a frame. Default: false

---A figure, made by the functions of `bw.plot`. It is drawn when it is written.
---```lua
---local figure = bw.plot.lines {title = "squares", series = {{x = {1, 2, 3}, y = {1, 4, 9}}}}
---assert(figure:write("squares.png", {scale = 1}))
---print(figure, figure:place(2, 4))
---```
---@class bw.Figure
---@field kind string the function that made it, such as "plot.lines"
---@field name string the title, or what it shows
---@field width number (pixels) width
---@field height number (pixels) height
local Figure = {}

---Writes the figure to a file, whose ending decides the format: .svg or .png. Another ending raises.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.FigureWriteOptions text and resolution. Default: as stated there
---@return boolean? written true
---@return string? message
---@return bw.Details? details
function Figure:write(path, options) end

---How a figure is written.
---@class bw.FigureWriteOptions
---@field text? "paths"|"text" the text of an SVG: as paths, which look the same everywhere, or as text. Default: "paths"
---@field scale? number (-) pixels of a PNG for each of the figure's, above 0. Default: 2

---The figure as one <svg> element for a page.
---
---Errors: only those that every function may give.
---@param options? bw.FigureSvgOptions how text is written. Default: as stated there
---@return string? svg the element
---@return string? message
---@return bw.Details? details
function Figure:svg(options) end

---How the text of an SVG is written.
---@class bw.FigureSvgOptions
---@field text? "paths"|"text" as paths, or as text that can be searched and selected. Default: "text"

---Where a point of the data lies in the figure, from its top left corner. Both are nil for figures of several frames, and for a
---point that has no place, such as one of 0 on a log axis.
---@param x number (any) x of the point
---@param y number (any) y of the point
---@return number? x (pixels) to the right
---@return number? y (pixels) downwards
function Figure:place(x, y) end
