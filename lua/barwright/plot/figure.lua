-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A figure: a size, a name, and a function that draws it. It is redrawn for each file.
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local options = require "barwright.options"
local sketch = require "barwright.plot.sketch"

local figure = {}

local Figure = {}
Figure.__index = Figure
Figure.__name = "figure"
figure.class = Figure

Figure.__tostring = function(self)
  return ("%s: %s, %d x %d pixels"):format(self.kind, self.name, self.width, self.height)
end

--- {kind, name, width, height, draw = function(sketch) -> {place = function(x, y) -> pixel x, y}?}
function figure.new(about)
  return setmetatable(about, Figure)
end

function figure.is(value)
  return getmetatable(value) == Figure
end

-- The canvas with the figure on it, and what drawing gave.
local function drawn(self)
  local canvas, message, details = core.canvas(self.width, self.height, {name = self.name})
  if not canvas then return nil, message, details end
  local ok, result = pcall(self.draw, sketch.new(canvas))
  if ok then return canvas, result end
  local refusal = sketch.refusal(result)
  if not refusal then error(result, 0) end
  return nil, refusal.message, refusal.details
end

local ways = {text = {type = "string", one_of = {"paths", "text"}}, scale = {type = "number", above = 0}}

--- Writes the figure by the ending of the path: .svg, .png. Options: text = "paths" (default: looks
--- the same everywhere) or "text" (can be searched and selected); scale: pixels of a PNG for each of
--- the figure's, default 2.
function Figure:write(path, given)
  local opts = options.read("write", given, ways)
  local canvas <close>, message, details = drawn(self)
  if not canvas then return nil, message, details end
  return canvas:write(path, {scale = opts.scale, outlines = opts.text ~= "text"})
end

--- The figure as one <svg> element, for a page. Options: text = "text" (default) or "paths".
function Figure:svg(given)
  local opts = options.read("svg", given, {text = ways.text})
  local canvas <close>, message, details = drawn(self)
  if not canvas then return nil, message, details end
  return canvas:svg {outlines = opts.text == "paths"}
end

--- Where a point of the data lies in the figure, in pixels from its top left corner; nil for figures of
--- several frames and for what cannot be shown.
function Figure:place(x, y)
  local canvas <close>, result, details = drawn(self)
  if not canvas then return nil, result, details end
  if type(result) ~= "table" or not result.place then return nil end
  return result:place(x, y)
end

arguments.methods("figure", Figure, Figure, {write = "path: string, options?: options", svg = "options?: options",
  place = "x: number, y: number"})

return figure
