-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Many columns at once: scatter_matrix and parallel_coordinates.
local axis = require "barwright.plot.axis"
local columns = require "barwright.plot.columns"
local data = require "barwright.plot.data"
local figure = require "barwright.plot.figure"
local frame = require "barwright.plot.frame"
local numbers = require "barwright.plot.numbers"
local options = require "barwright.options"
local palette = require "barwright.plot.palette"
local series = require "barwright.plot.series"
local thin = require "barwright.plot.thin"

local matrix = {}

local shared = {
  columns = {type = "table", needed = true},
  values = {type = "any"}, -- what colours the rows
  value = {type = "any"}, -- its axis
  goal = {type = "string", one_of = {"min", "max"}, default = "min"}, -- of it: the best lie above
  chosen = {type = "table"}, -- places of rows that stand out
  faint = {type = "table"}, -- flags: rows that stand back (infeasible)
}

-- Colour of each row (a step of 0 to 63, -1: none), the order in which rows are drawn: faint ones, then
-- from the worst to the best, then the chosen.
local function coloured(where, opts, count)
  local chosen = columns.chosen(where, "chosen", opts.chosen, count)
  local faint = columns.flags(where, "faint", opts.faint, count, false)
  local rows = {chosen = chosen, faint = faint, order = {}, colour = {}}
  local values = opts.values ~= nil and data.numbers(where, "values", opts.values, count)
  local bar = values and axis.new(where .. ": value", opts.value, {values}, {pad = 0})
  local rank = {}
  for i = 1, count do
    rows.order[i] = i
    local at = bar and bar:at(values[i])
    at = at and math.max(0, math.min(1, at))
    rows.colour[i] = faint[i] and "#c3cad1" or at and palette.value(math.floor(at * 63 + 0.5) / 63)
      or bar and "#a8a8a8" or palette.good
    rank[i] = (chosen[i] and 4 or 0) + (faint[i] and -4 or 0)
      + (at and (opts.goal == "max" and at or 1 - at) or 0)
  end
  table.sort(rows.order, function(a, b)
    if rank[a] ~= rank[b] then return rank[a] < rank[b] end
    return a < b
  end)
  return rows, bar
end

-- Runs of rows of one colour, in order: {colour, chosen, rows}.
local function runs(rows)
  local out, last = {}, nil
  for _, i in ipairs(rows.order) do
    local key = rows.colour[i] .. (rows.chosen[i] and "!" or "")
    if not last or last.key ~= key then
      last = {key = key, colour = rows.colour[i], chosen = rows.chosen[i], rows = {}}
      out[#out + 1] = last
    end
    last.rows[#last.rows + 1] = i
  end
  return out
end

-- ---- scatter matrix ----------------------------------------------------------------------------

local matrix_rules = series.rules {notes = {type = "table"}}
for key, rule in pairs(shared) do matrix_rules[key] = rule end
matrix_rules.width, matrix_rules.height = {type = "number", min = 200, max = 6000},
  {type = "number", min = 200, max = 6000}

local function draw_cell(s, f, a, b, all, notes, many)
  f:enter(4)
  for _, run in ipairs(all) do
    local points, texts = {}, {}
    for _, i in ipairs(run.rows) do
      local x, y = f:place(a.numbers[i], b.numbers[i])
      if x then
        points[#points + 1], points[#points + 2] = x, y
        texts[#texts + 1] = notes and notes[i] or false
      end
    end
    if #points > 0 then
      local pen = run.chosen and {fill = run.colour, stroke = palette.ink, width = 1.3} or {fill = run.colour}
      if many then points = thin.points(points) end
      s:markers("disc", run.chosen and 7 or many and 2.5 or 4.4, points, pen,
        notes and not many and texts or nil)
    end
  end
  f:leave()
end

-- The histogram of a column: bars over equal intervals of its axis.
local function draw_histogram(s, box, one, made)
  local whole = (one.names or one.whole) and made.high - made.low <= 40
  local bins, low = 12, 0
  if whole then bins, low = math.floor(made.high) - math.ceil(made.low) + 1, math.ceil(made.low) end
  local counts, max = {}, 1
  for k = 1, bins do counts[k] = 0 end
  for i = 1, #one.numbers do
    local at = made:at(one.numbers[i])
    if at then
      local k = whole and math.floor(one.numbers[i] - low + 0.5) + 1 or math.floor(at * bins) + 1
      k = math.max(1, math.min(bins, k))
      counts[k] = counts[k] + 1
      max = math.max(max, counts[k])
    end
  end
  for k = 1, bins do
    local high = (box[4] - 26) * counts[k] / max
    local from, to = (k - 1) / bins, k / bins
    if whole then from, to = made:at(low + k - 1.4), made:at(low + k - 0.6) end
    from, to = math.max(0, from), math.min(1, to)
    if high > 0 then
      s:rectangle(box[1] + from * box[3] + 0.5, box[2] + box[4] - high, math.max(1, (to - from) * box[3] - 1),
        high, {fill = "#cfdce8"})
    end
  end
  s:line({box[1], box[2] + box[4], box[1] + box[3], box[2] + box[4]}, {stroke = palette.line, width = 1})
  s:text(made:fitted(s, 12, box[3] + 6, true), box[1] + box[3] / 2, box[2] + 13, {size = 12, bold = true,
    align = 0.5})
end

-- The rank correlation as a number whose size and shade say how strong it is.
local function draw_correlation(s, box, a, b)
  local r = data.rank_correlation(a.numbers, b.numbers)
  if not r or a.names and #a.names > 2 or b.names and #b.names > 2 then
    s:text("–", box[1] + box[3] / 2, box[2] + box[4] / 2, {align = 0.5, middle = true, colour = palette.pale})
    return
  end
  local strength = math.abs(r)
  s:rectangle(box[1] + 2, box[2] + 2, box[3] - 4, box[4] - 4,
    {fill = ("%s%02x"):format(r < 0 and "#d55e00" or "#0072b2", math.floor(70 * strength + 0.5))}, 4)
  s:text(numbers.fixed(r, 2), box[1] + box[3] / 2, box[2] + box[4] / 2, {align = 0.5, middle = true,
    size = 11 + 7 * strength, colour = strength > 0.3 and palette.ink or palette.soft})
end

--- Each of two to ten columns against each other: points below the diagonal, how the values lie on it, rank
--- correlations above. columns: {name, unit, values (numbers or names), scale, of}.
function matrix.scatter_matrix(given)
  local where = "plot.scatter_matrix"
  local opts = options.read(where, given, matrix_rules)
  local list = columns.list(where, opts.columns, 2, 10)
  local n, count = #list, #list[1].numbers
  local rows, bar = coloured(where, opts, count)
  local notes = data.texts(where, "notes", opts.notes, count)
  local axes = {}
  for k, one in ipairs(list) do axes[k] = columns.axis(where, one, {pad = 0.08}) end
  local cell = math.max(92, math.min(170, 900 / n))
  local width = opts.width or cell * n + 90 + (bar and 80 or 0)
  local height = opts.height or cell * 0.86 * n + 90
  return figure.new {kind = where, width = width, height = height, name = opts.title or "scatter matrix",
    draw = function(s)
      local box = frame.around(s, {title = opts.title,
        notes = {"below: trials; diagonal: how often; above: rank correlation"}})
      if bar then box = frame.colour_bar(s, box, bar) end
      local all = runs(rows)
      local left, below, top = 62, 40, 4
      local w, h = (box[3] - left) / n, (box[4] - below - top) / n
      for down = 1, n do
        for across = 1, n do
          local x, y = box[1] + left + (across - 1) * w, box[2] + top + (down - 1) * h
          if across == down then
            draw_histogram(s, {x + 4, y + 4, w - 14, h - 8}, list[down], axes[down])
          elseif across > down then
            draw_correlation(s, {x + 4, y + 4, w - 14, h - 8}, list[across], list[down])
          else
            local first, last = across == 1, down == n
            local f = frame.new(s, {x - (first and left or 0), y, w + (first and left or 0),
              h + (last and below or 0)}, axes[across], axes[down], {quiet_x = not last, quiet_y = not first,
              few = true, left = first and left + 4 or 4, below = last and below or 4})
            draw_cell(s, f, list[across], list[down], all, notes, count > 2000)
          end
        end
      end
    end}
end

-- ---- parallel coordinates ----------------------------------------------------------------------

local parallel_rules = series.rules {}
for key, rule in pairs(shared) do parallel_rules[key] = rule end

-- One upright axis with marks on its left and its name above.
local function draw_upright(s, x, top, bottom, made, each)
  s:line({x, top, x, bottom}, {stroke = palette.line, width = 1.2})
  for _, mark in ipairs(made:marks(math.max(2, math.floor((bottom - top) / 42)))) do
    if mark.text and mark.at >= -1e-9 and mark.at <= 1 + 1e-9 then
      local y = bottom - mark.at * (bottom - top)
      s:line({x - 4, y, x, y}, {stroke = palette.line, width = 1})
      s:text(mark.text, x - 6, y, {size = 10.5, align = 1, middle = true, colour = palette.soft, halo = true,
        max = each * 0.62})
    end
  end
  local lines = made:wrapped(s, 12, each - 10, true)
  for i, line in ipairs(lines) do
    s:text(line, x, top - 10 - 15 * (#lines - i), {size = 12, bold = true, align = 0.5})
  end
end

--- Each row as a line over upright axes, coloured by values. columns: {name, unit, values, scale, of}.
function matrix.parallel_coordinates(given)
  local where = "plot.parallel_coordinates"
  local opts = options.read(where, given, parallel_rules)
  local list = columns.list(where, opts.columns, 2, 24)
  local n, count = #list, #list[1].numbers
  local rows, bar = coloured(where, opts, count)
  local axes = {}
  for k, one in ipairs(list) do axes[k] = columns.axis(where, one, {pad = 0.03}) end
  local width = given.width or math.max(720, 96 * n + 120)
  return figure.new {kind = where, width = width, height = opts.height,
    name = opts.title or "parallel coordinates",
    draw = function(s)
      local box = frame.around(s, {title = opts.title})
      if bar then box = frame.colour_bar(s, box, bar) end
      local each = box[3] / n
      local first = box[1] + math.min(70, each * 0.66)
      local name = s:text_width(axes[n].label, 12, true) / 2 + 8
      local last = box[1] + box[3] - math.max(math.min(52, each * 0.5), math.min(name, each * 0.6))
      local step, lines = (last - first) / (n - 1), 1
      for k = 1, n do lines = math.max(lines, #axes[k]:wrapped(s, 12, step - 10, true)) end
      local top, bottom = box[2] + 16 + 15 * lines, box[2] + box[4] - 14
      local alpha = count < 60 and "e0" or count < 400 and "a0" or count < 2000 and "60" or "38"
      for _, run in ipairs(runs(rows)) do
        local points = {}
        for _, i in ipairs(run.rows) do
          for k = 1, n do
            local at = axes[k]:at(list[k].numbers[i])
            points[#points + 1] = first + (k - 1) * step
            points[#points + 1] = at and bottom - at * (bottom - top) or 0 / 0
          end
          points[#points + 1], points[#points + 2] = 0 / 0, 0 / 0
        end
        s:line(points, {stroke = run.colour .. (run.chosen and "" or alpha), round = true,
          width = run.chosen and 2.6 or count > 2000 and 0.8 or 1.3})
      end
      for k = 1, n do draw_upright(s, first + (k - 1) * step, top, bottom, axes[k], step) end
      if count == 0 then
        s:text("no trials", (first + last) / 2, (top + bottom) / 2, {align = 0.5, colour = palette.soft})
      end
    end}
end

return matrix
