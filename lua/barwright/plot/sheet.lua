-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Contact sheets: pictures of variants (PNG files, figures) in a grid, each with its caption.
local core = require "barwright.core"
local data = require "barwright.plot.data"
local figure = require "barwright.plot.figure"
local frame = require "barwright.plot.frame"
local options = require "barwright.options"
local palette = require "barwright.plot.palette"
local sketch = require "barwright.plot.sketch"

local raise = core.raise
local where = "plot.contact_sheet"

local rules = {
  pictures = {type = "table", needed = true},
  title = {type = "string"},
  columns = {type = "integer", min = 1, max = 24},
  cell = {type = "number", min = 60, max = 2000, default = 230}, -- width of a picture
  ratio = {type = "number", min = 0.1, max = 10}, -- height of a picture by its width
  lines = {type = "integer", min = 0, max = 8, default = 2}, -- of a caption
}
local one_rules = {
  path = {type = "string"}, figure = {type = "table"},
  caption = {type = "string", default = ""},
  chosen = {type = "boolean", default = false}, -- a frame around it
}

local function read(given, i)
  local at = ("%s: picture %d"):format(where, i)
  local one = options.read(at, given, one_rules)
  if one.figure and not figure.is(one.figure) then
    raise(at .. ": figure: a figure of bw.plot expected, got " .. core.got(one.figure))
  end
  if one.figure and one.path then raise(at .. ": path or figure expected, got both") end
  return one
end

local function draw_missing(s, box, text)
  s:rectangle(box[1], box[2], box[3], box[4], {fill = "#eef1f4"}, 4)
  s:text(text, box[1] + box[3] / 2, box[2] + box[4] / 2, {size = 11.5, align = 0.5, middle = true,
    colour = palette.soft, max = box[3] - 12})
end

local function draw_picture(s, box, one)
  if one.figure then
    local inner = one.figure
    s:enter(box[1], box[2], box[3], box[4], {0, 0, inner.width, inner.height})
    inner.draw(sketch.within(s, inner.width, inner.height))
    s:leave()
  elseif one.path then
    local ok, message = s:image(one.path, box[1], box[2], box[3], box[4])
    if not ok then
      local name = one.path:match "[^/]*$"
      draw_missing(s, box, message:find("No such file", 1, true) and "no picture: " .. name
        or message:gsub("^.*/", ""))
    end
  else
    draw_missing(s, box, "no picture")
  end
end

local function caption_lines(s, one, width, max)
  local lines = {}
  for part in (one.caption .. "\n"):gmatch "(.-)\n" do
    if #lines < max then
      for _, line in ipairs(s:wrapped(part, 11.5, width, max - #lines)) do lines[#lines + 1] = line end
    end
  end
  return lines
end

--- Pictures {path = PNG file or figure =, caption, chosen} in a grid; one that cannot be read is an empty
--- place that says so.
return function(given)
  local opts = options.read(where, given, rules)
  local all = {}
  for i, one in ipairs(data.list(where, "pictures", opts.pictures)) do all[i] = read(one, i) end
  local count = math.max(1, #all)
  local wide = opts.columns or math.min(count, math.max(1, math.min(6, math.ceil(math.sqrt(count * 1.4)))))
  local ratio = opts.ratio
  if not ratio then
    local first = all[1] and all[1].figure
    ratio = first and first.height / first.width or 0.75
  end
  local gap, line = 14, 15
  local cell_height = opts.cell * ratio + 8 + line * opts.lines
  local rows = math.ceil(count / wide)
  local width = math.max(160, 24 + wide * opts.cell + (wide - 1) * gap)
  local top = opts.title and 44 or 12
  local height = top + rows * cell_height + (rows - 1) * gap + 12
  if height > 20000 or width > 20000 then
    raise(("%s: fewer or smaller pictures (cell) expected, got %d that make %d x %d pixels"):format(where, #all,
      math.ceil(width), math.ceil(height)))
  end
  return figure.new {kind = where, width = width, height = height, name = opts.title or "contact sheet",
    draw = function(s)
      if opts.title then frame.around(s, {title = s:shortened(opts.title, frame.large, width - 24, true)}) end
      if #all == 0 then draw_missing(s, {12, top, opts.cell, opts.cell * ratio}, "no pictures") end
      for i, one in ipairs(all) do
        local x = 12 + (i - 1) % wide * (opts.cell + gap)
        local y = top + (i - 1) // wide * (cell_height + gap)
        local box = {x, y, opts.cell, opts.cell * ratio}
        draw_picture(s, box, one)
        s:rectangle(box[1], box[2], box[3], box[4], {width = one.chosen and 2.5 or 1,
          stroke = one.chosen and palette.good or palette.grid}, 3)
        for k, text in ipairs(caption_lines(s, one, opts.cell, opts.lines)) do
          s:text(text, x + opts.cell / 2, y + box[4] + 4 + line * k - 2, {size = 11.5, align = 0.5,
            bold = one.chosen and k == 1})
        end
      end
    end}
end
