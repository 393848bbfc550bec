-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A frame with two axes in a part of a sketch: margins from what the marks need, grid, marks, labels;
-- then the way from values to pixels. And what lies around frames: title, legend, notes.
local palette = require "barwright.plot.palette"

local Frame = {}
Frame.__index = Frame

local frame = {}

local small, normal, large = 11.5, 12.5, 15

-- Marks along x such that their texts have room: fewer until they do.
local function x_marks(s, axis, width)
  local marks
  for max = math.max(2, math.floor(width / 45)), 1, -1 do
    marks = axis:marks(max)
    local fits, last = true, nil
    for _, mark in ipairs(marks) do
      if mark.text then
        local half = s:text_width(mark.text, small) / 2
        local at = mark.at * width
        if last and at - half < last + 8 then fits = false end
        last = at + half
      end
    end
    if fits or axis.names then break end
  end
  return marks
end

-- Names along x: how they are written (turned where they need it), and the height that this takes.
local function x_names(s, axis, width)
  local each, widest = width / #axis.names, 0
  for _, name in ipairs(axis.names) do widest = math.max(widest, s:text_width(name, small)) end
  if widest + 8 <= each then return 0, 20, widest end
  local max = math.min(widest, 130)
  return 40, max * math.sin(math.rad(40)) + 16, max
end

local function widest_text(s, marks)
  local widest = 0
  for _, mark in ipairs(marks) do
    if mark.text then widest = math.max(widest, s:text_width(mark.text, small)) end
  end
  return widest
end

local function half(pixel)
  return math.floor(pixel) + 0.5
end

-- The last mark's text may stand out on the right, the first one's on the left.
local function overhang(s, marks, width)
  local left, right = 0, 0
  for _, mark in ipairs(marks) do
    if mark.text then
      local h = s:text_width(mark.text, small) / 2
      left = math.max(left, h - mark.at * width)
      right = math.max(right, mark.at * width + h - width)
    end
  end
  return left, right
end

--- A frame in the box {x, y, width, height}. with = {quiet_x, quiet_y: no marks' texts and label;
--- grid = false; few: room for few marks; left, below: margins}.
function frame.new(s, box, x, y, with)
  with = with or {}
  local self = setmetatable({sketch = s, x = x, y = y}, Frame)
  local turn, below, max_name = 0, with.quiet_x and 4 or 20, nil
  if x.names and not with.quiet_x then turn, below, max_name = x_names(s, x, box[3] - (with.left or 70) - 10) end
  -- frames of a matrix line up: their margins are given, whatever their marks need
  local label_x = not with.quiet_x and x.label ~= ""
  local label_y = not with.quiet_y and y.label ~= ""
  local top = 8
  local height = math.max(10, box[4] - (with.below or below + (label_x and 20 or 4)) - top)
  local y_count = math.max(2, math.floor(height / (with.few and 30 or 38)))
  local marks_y = y:marks(y_count)
  local texts = with.quiet_y and 0 or math.min(widest_text(s, marks_y), box[3] * 0.4)
  local left = texts + (with.quiet_y and 4 or 10) + (label_y and 20 or 0)
  local width = math.max(10, box[3] - (with.left or left) - 10)
  local marks_x = x_marks(s, x, width)
  local out_left, out_right = overhang(s, marks_x, width)
  if with.quiet_x then out_left, out_right = 0, 0 end
  if turn > 0 and not with.quiet_x then -- the first name begins left of the frame
    out_left, out_right = max_name * math.cos(math.rad(turn)) - marks_x[1].at * width, 0
  end
  left = with.left or math.max(left, out_left)
  if with.left then out_right = 0 end
  self.left, self.top = half(box[1] + left), half(box[2] + top)
  self.right = half(box[1] + box[3] - math.max(10, out_right))
  self.bottom = half(box[2] + top + height)
  self.right = math.max(self.right, self.left + 10)
  self.width, self.height = self.right - self.left, self.bottom - self.top
  self:draw_grid(marks_x, marks_y, with)
  if not with.quiet_x then self:draw_x(marks_x, turn, below, max_name, with.left) end
  if not with.quiet_y then self:draw_y(marks_y, texts, box[1]) end
  return self
end

--- Pixels of a point of the data; nil where it has no place.
function Frame:place(x, y)
  local u, v = self.x:at(x), self.y:at(y)
  if not u or not v then return nil end
  return self.left + u * self.width, self.bottom - v * self.height
end

local function within(at)
  return at and at >= -1e-9 and at <= 1 + 1e-9
end

function Frame:draw_grid(marks_x, marks_y, with)
  local s = self.sketch
  if with.grid ~= false then
    local pen, faint = {stroke = palette.grid, width = 1}, {stroke = palette.grid .. "70", width = 1}
    if not self.x.names then
      for _, mark in ipairs(marks_x) do
        if within(mark.at) and (mark.text or #marks_x < 30) then
          local x = self.left + mark.at * self.width
          s:line({x, self.top, x, self.bottom}, mark.text and pen or faint)
        end
      end
    end
    if not self.y.names then
      for _, mark in ipairs(marks_y) do
        if within(mark.at) and (mark.text or #marks_y < 30) then
          local y = self.bottom - mark.at * self.height
          s:line({self.left, y, self.right, y}, mark.text and pen or faint)
        end
      end
    end
  end
  s:line({self.left, self.top, self.left, self.bottom, self.right, self.bottom},
    {stroke = palette.line, width = 1})
end

-- `close`: another frame is beside this one, so that texts stay within.
function Frame:draw_x(marks, turn, below, max_name, close)
  local s, y = self.sketch, self.bottom
  for _, mark in ipairs(marks) do
    if within(mark.at) then
      local x = self.left + mark.at * self.width
      s:line({x, y, x, y + (mark.text and 4 or 2.5)}, {stroke = palette.line, width = 1})
      if mark.text and turn > 0 then
        s:text(mark.text, x + 4, y + 14, {size = small, align = 1, angle = turn, max = max_name, midst = true,
          colour = palette.soft})
      elseif mark.text then
        local own = s:text_width(mark.text, small) / 2
        if close then x = math.max(self.left - 5 + own, math.min(self.right + 5 - own, x)) end
        s:text(mark.text, x, y + 17, {size = small, align = 0.5, max = max_name, midst = true,
          colour = palette.soft})
      end
    end
  end
  if self.x.label ~= "" then
    s:text(self.x:fitted(s, normal, math.max(self.width, 60)), (self.left + self.right) / 2, y + below + 15,
      {size = normal, align = 0.5})
  end
end

function Frame:draw_y(marks, texts, edge)
  local s, x, last = self.sketch, self.left, nil
  for _, mark in ipairs(marks) do
    if within(mark.at) then
      local y = self.bottom - mark.at * self.height
      if not self.y.names then
        s:line({x - (mark.text and 4 or 2.5), y, x, y}, {stroke = palette.line, width = 1})
      end
      if mark.text and (not last or last - y >= 11.5) then -- in a low frame not every one
        last = y
        s:text(mark.text, x - 7, y, {size = small, align = 1, middle = true, midst = true, max = texts + 1,
          colour = palette.soft})
      end
    end
  end
  if self.y.label ~= "" then
    s:text(self.y:fitted(s, normal, math.max(self.height, 60)), edge + 10, (self.top + self.bottom) / 2,
      {size = normal, align = 0.5, angle = 90, middle = true})
  end
end

--- What is drawn until `leave` is cut at the frame, with a margin for what lies on it.
function Frame:enter(margin)
  margin = margin or 0
  self.sketch:enter(self.left - margin, self.top - margin, self.width + 2 * margin,
    self.height + 2 * margin)
end

function Frame:leave()
  self.sketch:leave()
end

--- Words in the middle, where there is nothing to be shown.
function Frame:say(text)
  self.sketch:text(text, (self.left + self.right) / 2, (self.top + self.bottom) / 2,
    {size = normal, align = 0.5, colour = palette.soft, max = self.width - 10})
end

-- ---- around frames -----------------------------------------------------------------------------

local function draw_key(s, x, y, entry)
  if entry.fill then
    s:rectangle(x + 3, y - 5, 16, 10, {fill = entry.fill, stroke = entry.rim, width = 1}, 2)
  end
  if entry.line then
    s:line({x, y, x + 24, y}, {stroke = entry.line, width = entry.width or 2, dash = entry.dash})
  end
  if entry.marker then
    s:markers(entry.marker, entry.size or 7, {x + 12, y}, entry.pen)
  end
end

-- Rows of keys and names as wide as the sketch, at most a third of its height; returns where they end.
local function draw_legend(s, x, y, width, entries)
  local max = math.max(80, math.min(260, width * 0.45))
  local at, rows = x, math.max(1, math.floor(s.height / 3 / 19))
  for i, entry in ipairs(entries) do
    local name = s:shortened(entry.name, small, max, false, true)
    local wide = 28 + s:text_width(name, small) + 18
    local rest = #entries - i + 1
    local more = rest > 1 and rows == 1 and 90 or 0
    if at > x and at + wide - 18 > x + width - more then
      if rows == 1 then
        s:text(("and %d more"):format(rest), at, y + 9, {size = small, middle = true, colour = palette.soft})
        break
      end
      at, y, rows = x, y + 19, rows - 1
    end
    draw_key(s, at, y + 9, entry)
    s:text(name, at + 28, y + 9, {size = small, middle = true})
    at = at + wide
  end
  return y + 19
end

--- Title and legend at the top, notes at the bottom; returns the box that is left.
--- about = {title, legend = {{name, line, dash, marker, pen, fill}}, notes = {text}}
function frame.around(s, about)
  local x, y, width = 12, 8, s.width - 24
  if about.title and about.title ~= "" then
    for _, line in ipairs(s:wrapped(about.title, large, width, 2, true)) do
      s:text(line, x, y + 14, {size = large, bold = true})
      y = y + 20
    end
    y = y + 4
  end
  if about.legend and #about.legend > 0 then y = draw_legend(s, x, y, width, about.legend) + 2 end
  local bottom = s.height - 8
  for i = #(about.notes or {}), 1, -1 do
    s:text(about.notes[i], x + width, bottom - 3, {size = 10.5, align = 1, max = width,
      colour = palette.soft})
    bottom = bottom - 15
  end
  return {x - 4, y, width + 8, math.max(40, bottom - y)}
end

--- A bar of colours with marks, right in the box; returns the box that is left.
function frame.colour_bar(s, box, axis)
  local top, height = box[2] + 14, box[4] - 48
  local marks = axis:marks(math.max(2, math.floor(height / 38)))
  local texts = widest_text(s, marks)
  local label = axis.label ~= "" and 20 or 0
  local x = box[1] + box[3] - 14 - texts - 8 - label
  local steps = 64
  for i = 1, steps do
    local low = top + height * (1 - i / steps)
    s:rectangle(x, low, 14, height / steps + (i > 1 and 0.6 or 0),
      {fill = palette.value((i - 0.5) / steps)})
  end
  for _, mark in ipairs(marks) do
    if mark.text and within(mark.at) then
      local y = top + height * (1 - mark.at)
      s:line({x + 14, y, x + 17, y}, {stroke = palette.line, width = 1})
      s:text(mark.text, x + 20, y, {size = small, middle = true, colour = palette.soft})
    end
  end
  if label > 0 then
    s:text(axis:fitted(s, normal, height + 30), box[1] + box[3] - 8, top + height / 2, {size = normal,
      align = 0.5, angle = 90, middle = true})
  end
  return {box[1], box[2], x - box[1] - 8, box[4]}
end

--- Frames below the diagonal of a matrix, of axis `across` against axis `down`, with marks on the outer
--- ones only: draw(frame, across, down).
function frame.pairs(s, box, axes, draw)
  local n = #axes - 1
  local left, below = 62, 40
  local width, height = (box[3] - left) / n, (box[4] - below) / n
  for down = 2, n + 1 do
    for across = 1, down - 1 do
      local first, last = across == 1, down == n + 1
      local x = box[1] + left + (across - 1) * width - (first and left or 0)
      local y = box[2] + (down - 2) * height
      draw(frame.new(s, {x, y, width + (first and left or 0), height + (last and below or 0)}, axes[across],
        axes[down], {quiet_x = not last, quiet_y = not first, few = true, left = first and left or 4,
          below = last and below or 4}), across, down)
    end
  end
end

frame.small, frame.normal, frame.large = small, normal, large
return frame
