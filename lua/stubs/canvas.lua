---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Drawings
--
-- Vector drawings of lines, markers, text and images, written as SVG or PNG. Plots are made of them. Lengths are in pixels from
-- the top left corner, y downwards.

---@class bw
local bw = {}

---An empty drawing.
---```lua
---local canvas = bw.canvas(200, 100, {name = "a rising line"})
---canvas:line({{10, 90}, {190, 10}}, {stroke = "#1f77b4", width = 3}):text("up", 100, 40)
---assert(canvas:write "line.svg")
---```
---@param width number (pixels) Range: 1 to 20000
---@param height number (pixels) Range: 1 to 20000
---@param options? bw.CanvasOptions its name
---@return bw.Canvas canvas the drawing
function bw.canvas(width, height, options) end

---The name of a drawing.
---@class bw.CanvasOptions
---@field name? string what it shows, for those who cannot see it; only in SVG. Default: none

---How a line, a shape or a marker is drawn. Colours are "#rrggbb" or "#rrggbbaa".
---@class bw.Pen
---@field fill? string colour of the inside. Default: none
---@field stroke? string colour of the line. Default: none
---@field width? number (pixels) of the line. Default: 1
---@field dash? number[] (pixels, 2 or 4) lengths on and off. Default: a solid line
---@field round? boolean round ends and corners. Default: false

---A drawing. What is drawn later lies above. Each drawing method returns the canvas, so that calls can be chained. Points are rows
---of two numbers, or a flat list x, y, x, y; where one is not finite a line breaks.
---```lua
---local canvas = bw.canvas(120, 120)
---canvas:polygon({10, 10, 110, 10, 60, 100}, {fill = "#cce5ff", stroke = "#004080"})
---canvas:markers("disc", 8, {60, 50}, {fill = "#d62728"}, {"the middle"})
---assert(canvas:write("triangle.png", {scale = 1}))
---```
---@class bw.Canvas
---@field width number (pixels) of the drawing
---@field height number (pixels) of the drawing
local Canvas = {}

---A line through points.
---@param points bw.Array|number[][]|number[] (pixels, n × 2) the points
---@param pen? bw.Pen how it is drawn
---@return bw.Canvas self
function Canvas:line(points, pen) end

---A closed line, filled by the even-odd rule: loops within it, behind a point that is not finite, are holes.
---@param points bw.Array|number[][]|number[] (pixels, n × 2) the points
---@param pen? bw.Pen how it is drawn
---@return bw.Canvas self
function Canvas:polygon(points, pen) end

---A rectangle.
---@param x number (pixels) of the left side
---@param y number (pixels) of the top
---@param width number (pixels) 0 or more
---@param height number (pixels) 0 or more
---@param pen? bw.Pen how it is drawn
---@param radius? number (pixels) of the corners. Default: 0
---@return bw.Canvas self
function Canvas:rectangle(x, y, width, height, pen, radius) end

---A marker at each point. Points that are not finite are passed over.
---@param kind "disc"|"square"|"diamond"|"triangle"|"triangle_down"|"cross"|"plus" its shape; the last two have a stroke alone
---@param size number (pixels) how far it reaches across
---@param points bw.Array|number[][]|number[] (pixels, n × 2) the points
---@param pen? bw.Pen how it is drawn
---@param notes? (string|false)[] what an SVG shows where the pointer rests on a marker, one for each point. Default: none
---@return bw.Canvas self
function Canvas:markers(kind, size, points, pen, notes) end

---A line of text on a baseline.
---@param text string the text
---@param x number (pixels) where it begins, or as `align` says
---@param y number (pixels) of the baseline
---@param options? bw.CanvasTextOptions how it is drawn
---@return bw.Canvas self
function Canvas:text(text, x, y, options) end

---How a text is drawn.
---@class bw.CanvasTextOptions
---@field size? number (pixels) of the font. Default: 12
---@field align? number (-) 0: it begins at x, 0.5: its middle is there, 1: it ends there. Default: 0
---@field angle? number (degrees) counterclockwise. Default: 0
---@field colour? string "#rrggbb" or "#rrggbbaa". Default: "#000000"
---@field bold? boolean bold letters. Default: false
---@field halo? boolean a pale rim, for text over lines. Default: false

---How wide a text will be.
---@param text string the text
---@param size number (pixels) of the font
---@param bold? boolean bold letters. Default: false
---@return number width (pixels) its width
function Canvas:text_width(text, size, bold) end

---Cuts what is drawn until `leave` at a box. With a view, the part `view` of a drawing of its own is seen in the box, centred and as
---large as fits; without one coordinates stay.
---@param x number (pixels) of the left side
---@param y number (pixels) of the top
---@param width number (pixels) 0 or more
---@param height number (pixels) 0 or more
---@param view? number[] (pixels, 4) {x, y, width, height} of the part that is seen. Default: the box
---@return bw.Canvas self
function Canvas:enter(x, y, width, height, view) end

---Ends the last `enter`.
---@return bw.Canvas self
function Canvas:leave() end

---A PNG file, centred in a box and as large as fits. One of more pixels than are seen is reduced to twice the box.
---
---Errors: io (the file cannot be read), format (it is no PNG file that can be read).
---@param path string the PNG file
---@param x number (pixels) of the left side
---@param y number (pixels) of the top
---@param width number (pixels) 0 or more
---@param height number (pixels) 0 or more
---@return bw.Canvas? self the canvas
---@return string? message
---@return bw.Details? details
function Canvas:image(path, x, y, width, height) end

---Rows of pixels, stretched to a box.
---@param bytes string three bytes (red, green, blue) for each pixel, rows from the top
---@param columns integer (count) pixels of a row. Range: 1 to 20000
---@param x number (pixels) of the left side
---@param y number (pixels) of the top
---@param width number (pixels) 0 or more
---@param height number (pixels) 0 or more
---@return bw.Canvas self
function Canvas:pixels(bytes, columns, x, y, width, height) end

---Writes the drawing to a file, whose ending decides the format: .svg or .png.
---
---Errors: io (the file cannot be written).
---@param path string the file
---@param options? bw.CanvasWriteOptions resolution and text
---@return boolean? written true
---@return string? message
---@return bw.Details? details
function Canvas:write(path, options) end

---How a drawing is written.
---@class bw.CanvasWriteOptions
---@field scale? number (-) pixels of a PNG for each of the drawing's. Default: 2
---@field outlines? boolean the text of an SVG is paths, which look the same everywhere. Default: true

---The drawing as one <svg> element for a page.
---
---Errors: only those that every function may give.
---@param options? bw.CanvasSvgOptions how text is written
---@return string? svg the element
---@return string? message
---@return bw.Details? details
function Canvas:svg(options) end

---How the text of an SVG is written.
---@class bw.CanvasSvgOptions
---@field outlines? boolean as paths. Default: false, as text

---Releases the drawing at once.
function Canvas:close() end
