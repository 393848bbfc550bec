---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Drawings
--
-- Vector drawings of lines, markers, text and images, written as SVG or PNG.

---@class bw
local bw = {}

---A drawing of lines, markers, text and images, in pixels from the top left corner, y downwards: to be
---written as SVG or PNG. Plots (bw.plot) are made of these.
---@param width number
---@param height number
---@param options? bw.CanvasOptions name: what it shows, for those who cannot see it
---@return bw.Canvas?
---@return string? message
---@return bw.Details? details
function bw.canvas(width, height, options) end

---@class bw.CanvasOptions
---@field name? string

---A drawing. Points are rows of two numbers or a flat list x, y, x, y; where one is not finite a line
---breaks. A pen is {fill, stroke, width, dash, round}: colours "#rrggbb" or "#rrggbbaa", the stroke's width
---(1), lengths on and off, round ends and corners. What is drawn later lies above. Each drawing method
---returns the canvas.
---@class bw.Canvas
---@field width number
---@field height number
local Canvas = {}

---@param points bw.Array|number[][]|number[]
---@param pen? table
---@return bw.Canvas?
function Canvas:line(points, pen) end

---A closed line, filled by the even-odd rule: loops within are holes.
---@param points bw.Array|number[][]|number[]
---@param pen? table
---@return bw.Canvas?
function Canvas:polygon(points, pen) end

---@param x number
---@param y number
---@param width number
---@param height number
---@param pen? table
---@param radius? number of the corners
---@return bw.Canvas?
function Canvas:rectangle(x, y, width, height, pen, radius) end

---Markers `size` pixels across. Where the pointer rests on one an SVG shows its note.
---@param kind "disc"|"square"|"diamond"|"triangle"|"triangle_down"|"cross"|"plus"
---@param size number
---@param points bw.Array|number[][]|number[]
---@param pen? table
---@param notes? string[] one for each point, or false
---@return bw.Canvas?
function Canvas:markers(kind, size, points, pen, notes) end

---Text on a baseline; align 0 (begins at x), 0.5 or 1 (ends there); angle in degrees, counterclockwise;
---halo: a pale rim.
---@param text string
---@param x number
---@param y number
---@param options? bw.CanvasTextOptions
---@return bw.Canvas?
function Canvas:text(text, x, y, options) end

---@class bw.CanvasTextOptions
---@field size? number
---@field align? number
---@field angle? number
---@field colour? string
---@field bold? boolean
---@field halo? boolean

---How wide a text will be, in pixels.
---@param text string
---@param size number
---@param bold? boolean
---@return number?
function Canvas:text_width(text, size, bold) end

---What is drawn until `leave` is cut at the box; there the part `view` {x, y, width, height} of a drawing
---of its own is seen, as large as fits. Without a view coordinates stay.
---@param x number
---@param y number
---@param width number
---@param height number
---@param view? number[]
---@return bw.Canvas?
function Canvas:enter(x, y, width, height, view) end

---@return bw.Canvas?
function Canvas:leave() end

---A PNG file, as large as fits in the box; one with more pixels than are seen is reduced.
---@param path string
---@param x number
---@param y number
---@param width number
---@param height number
---@return bw.Canvas?
---@return string? message
---@return bw.Details? details
function Canvas:image(path, x, y, width, height) end

---Rows of pixels, three bytes each (red, green, blue), from the top, stretched to the box.
---@param bytes string
---@param columns integer
---@param x number
---@param y number
---@param width number
---@param height number
---@return bw.Canvas?
function Canvas:pixels(bytes, columns, x, y, width, height) end

---By the ending: .svg, or .png with `scale` (2) pixels for each of the drawing's. With `outlines` (true)
---the text in an SVG is paths, which look the same everywhere.
---@param path string
---@param options? bw.CanvasWriteOptions
---@return boolean?
---@return string? message
---@return bw.Details? details
function Canvas:write(path, options) end

---@class bw.CanvasWriteOptions
---@field scale? number
---@field outlines? boolean

---One <svg> element for a page; text is text unless `outlines`.
---@param options? bw.CanvasSvgOptions
---@return string?
---@return string? message
---@return bw.Details? details
function Canvas:svg(options) end

---@class bw.CanvasSvgOptions
---@field outlines? boolean

function Canvas:close() end
