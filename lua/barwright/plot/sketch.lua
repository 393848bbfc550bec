-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A canvas for the plots: what it refuses is raised as a table, which the figure turns back into nil,
-- message, details; and text in a box: shortened, wrapped, in the middle.
local palette = require "barwright.plot.palette"

local Sketch = {}
Sketch.__index = Sketch

local sketch = {}

--- Around a canvas.
function sketch.new(canvas)
  return setmetatable({canvas = canvas, width = canvas.width, height = canvas.height, widths = {}}, Sketch)
end

--- The same for a drawing of another size within it.
function sketch.within(outer, width, height)
  return setmetatable({canvas = outer.canvas, width = width, height = height, widths = outer.widths}, Sketch)
end

local function must(value, message, details)
  if value == nil then error(setmetatable({message = message, details = details}, sketch), 0) end
  return value
end

--- The refusal of a canvas that was raised, or nil.
function sketch.refusal(problem)
  return getmetatable(problem) == sketch and problem or nil
end

for _, name in ipairs {"line", "polygon", "rectangle", "markers", "enter", "leave", "pixels"} do
  Sketch[name] = function(self, ...)
    return must(self.canvas[name](self.canvas, ...))
  end
end

--- nil, message where the file is not there or no PNG: for the caller to draw around.
function Sketch:image(...)
  local ok, message, details = self.canvas:image(...)
  if not ok and details.status == "memory" then must(nil, message, details) end
  return ok, message
end

function Sketch:text_width(text, size, bold)
  local key = ("%s%s%s"):format(size, bold and "b" or "n", text)
  local width = self.widths[key]
  if not width then
    width = must(self.canvas:text_width(text, size, bold))
    self.widths[key] = width
  end
  return width
end

-- The bytes of the first n characters; texts that are no UTF-8 count bytes.
local function first(text, n)
  local at = utf8.len(text) and utf8.offset(text, n + 1) or n + 1
  return at and text:sub(1, at - 1) or text
end

-- k characters with an ellipsis behind them, or in their midst.
local function cut(text, k, midst)
  if not midst or k < 4 then return (first(text, k):gsub("%s+$", "")) .. "…" end
  local length, behind = utf8.len(text) or #text, k // 2
  return first(text, k - behind) .. "…" .. text:sub(#first(text, length - behind) + 1)
end

--- The text, or as much of it as fits with an ellipsis. `midst`: names that may differ at their end.
function Sketch:shortened(text, size, width, bold, midst)
  if self:text_width(text, size, bold) <= width then return text end
  local low, high = 0, utf8.len(text) or #text
  while low < high do
    local midpoint = (low + high + 1) // 2
    if self:text_width(cut(text, midpoint, midst), size, bold) <= width then low = midpoint
    else high = midpoint - 1 end
  end
  return cut(text, low, midst)
end

--- Lines of at most `width`, `most` of them, the last one shortened.
function Sketch:wrapped(text, size, width, max, bold)
  local lines, line = {}, nil
  for word in text:gmatch "%S+" do
    local longer = line and line .. " " .. word or word
    if line and #lines < max - 1 and self:text_width(longer, size, bold) > width then
      lines[#lines + 1] = self:shortened(line, size, width, bold)
      line = word
    else
      line = longer
    end
  end
  if line then lines[#lines + 1] = self:shortened(line, size, width, bold) end
  return lines
end

--- Text; with `middle` y is the middle of the small letters, with `most` it is shortened.
function Sketch:text(text, x, y, style)
  style = style or {}
  local size = style.size or 12
  if style.max then text = self:shortened(text, size, style.max, style.bold, style.midst) end
  if style.middle then
    local angle = math.rad(style.angle or 0)
    x, y = x + 0.36 * size * math.sin(angle), y + 0.36 * size * math.cos(angle)
  end
  must(self.canvas:text(text, x, y, {size = size, align = style.align, angle = style.angle,
    bold = style.bold, halo = style.halo, colour = style.colour or palette.ink}))
end

return sketch
