-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How a study went on (history), and what it found (pareto).
local core = require "barwright.core"
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

local raise = core.raise
local progress = {}

-- How points are drawn, from the least to the most important.
local looks = {
  infeasible = {marker = "diamond", size = 7, pen = {fill = "#ffffff", stroke = palette.bad, width = 1.2},
    name = "misses a constraint"},
  failed = {marker = "cross", size = 9, pen = {stroke = palette.bad, width = 1.8}, name = "no result"},
  done = {marker = "disc", size = 6, pen = {fill = "#8fb8d8", stroke = "#ffffff", width = 0.6}},
  front = {marker = "disc", size = 8.5, pen = {fill = palette.good, stroke = "#ffffff", width = 1}},
}

local function put(s, look, points, notes)
  local many = #points > 6000
  if #points == 0 then return end
  if many then
    points, notes = thin.points(points), nil
  end
  s:markers(look.marker, many and math.min(look.size, 4) or look.size, points, look.pen, notes)
end

-- ---- history -----------------------------------------------------------------------------------

local history_rules = series.rules {
  values = {type = "any", needed = true},
  numbers = {type = "any"}, -- of the trials, 1, 2, ... without
  goal = {type = "string", one_of = {"min", "max"}, default = "min"},
  failed = {type = "table"}, feasible = {type = "table"}, -- for each value true or false
  label = {type = "string", default = "value"}, unit = {type = "string", default = ""},
  scale = {type = "string", one_of = {"linear", "log"}, default = "linear"},
  notes = {type = "table"}, -- for each value a text
  trial = {type = "string", default = "trial"},
}

-- The best so far as steps: from each trial that was better to the next.
local function best_so_far(opts, xs, values, counts)
  local sign = opts.goal == "max" and -1 or 1
  local x, y, best = {}, {}, nil
  for i = 1, #values do
    local v = values[i]
    if counts[i] and v == v and (not best or sign * v < sign * values[best]) then
      best = i
      x[#x + 1], y[#y + 1] = xs[i], v
    end
  end
  if best then x[#x + 1], y[#y + 1] = xs[#xs], values[best] end
  return x, y, best
end

local function history_groups(opts, values, count)
  local failed = columns.flags("plot.history", "failed", opts.failed, count, false)
  local feasible = columns.flags("plot.history", "feasible", opts.feasible, count, true)
  local kind, counts = {}, {}
  for i = 1, count do
    kind[i] = (failed[i] or values[i] ~= values[i]) and "failed" or feasible[i] and "done" or "infeasible"
    counts[i] = kind[i] == "done"
  end
  return kind, counts
end

local function legend_for(used, name)
  local out = {{name = ("best so far (%s)"):format(name), line = palette.good},
    used.done and {name = "trial", marker = "disc", pen = looks.done.pen} or nil}
  for _, kind in ipairs {"infeasible", "failed"} do
    local look = looks[kind]
    if used[kind] then
      out[#out + 1] = {name = ("%s (%d)"):format(look.name, used[kind]), marker = look.marker, pen = look.pen}
    end
  end
  return out
end

-- In order of trials; in time: a number may be missing or stand twice.
local function trial_numbers(opts, count)
  if opts.numbers then
    local xs = data.numbers("plot.history", "numbers", opts.numbers, count)
    for i = 1, count do
      if xs[i] ~= xs[i] then
        raise(("plot.history: numbers: entry %d: a finite number expected, got %s"):format(i,
          core.got(opts.numbers[i])))
      end
    end
    return xs
  end
  local xs = {}
  for i = 1, count do xs[i] = i end
  return xs
end

--- Every trial's value in the order of the trials, and the best so far. values: a number or nan for each;
--- failed, feasible: flags for each; goal "min" or "max".
function progress.history(given)
  local where = "plot.history"
  local opts = options.read(where, given, history_rules)
  local values = data.numbers(where, "values", opts.values)
  local count = #values
  local xs = trial_numbers(opts, count)
  local notes = data.texts(where, "notes", opts.notes, count)
  local kind, counts = history_groups(opts, values, count)
  local used = {}
  for i = 1, count do used[kind[i]] = (used[kind[i]] or 0) + 1 end
  local scale = opts.scale
  if not data.range({values}, true) then scale = "linear" end
  local x = axis.new(where, {label = opts.trial, whole = true}, {xs}, {pad = 0.02})
  local y = axis.new(where, {label = opts.label, unit = opts.unit, scale = scale}, {values}, {pad = 0.06})
  return figure.new {kind = where, width = opts.width, height = opts.height,
    name = opts.title or ("%s of the trials"):format(opts.label),
    draw = function(s)
      local box = frame.around(s, {title = opts.title, legend = legend_for(used, opts.goal)})
      local f = frame.new(s, box, x, y)
      if count == 0 then f:say "no trials" end
      local groups = {done = {{}, {}}, infeasible = {{}, {}}, failed = {{}, {}}}
      for i = 1, count do
        local px, py = f:place(xs[i], values[i])
        local group = groups[kind[i]]
        if kind[i] == "failed" or not px then
          px, py, group = f:place(xs[i], y.low), f.bottom - 7, groups.failed
        end
        group[1][#group[1] + 1], group[1][#group[1] + 2] = px, py
        group[2][#group[2] + 1] = notes and notes[i] or false
      end
      f:enter(6)
      for _, name in ipairs {"failed", "infeasible", "done"} do
        put(s, looks[name], groups[name][1], notes and groups[name][2])
      end
      local bx, by, best = best_so_far(opts, xs, values, counts)
      s:line(series.staircase((series.pixels(f, bx, by))), {stroke = palette.good, width = 2.2})
      if best then
        local px, py = f:place(xs[best], values[best])
        if px then s:markers("disc", 9, {px, py}, looks.front.pen, {notes and notes[best] or false}) end
      end
      f:leave()
      if best then progress.name_best(s, f, xs[best], values[best], opts) end
      return f
    end}
end

-- The value beside the best point, where it hides least: away from the goal's side.
function progress.name_best(s, f, x, value, opts)
  local px, py = f:place(x, value)
  if not px then return end
  local text = numbers.quantity(value, opts.unit)
  local right = px + 10 + s:text_width(text, 11.5, true) < f.right
  local below = opts.goal == "min"
  local ty = py + (below and 17 or -9)
  if ty > f.bottom - 4 then ty = py - 9 end
  if ty < f.top + 10 then ty = py + 17 end
  s:text(text, right and px + 4 or px - 4, ty, {size = 11.5, bold = true, align = right and 0 or 1,
    halo = true, colour = palette.good})
end

-- ---- Pareto ------------------------------------------------------------------------------------

local pareto_rules = series.rules {
  objectives = {type = "table", needed = true}, -- columns with goals
  feasible = {type = "table"}, -- for each row true or false
  front = {type = "table"}, -- the places of those that no other beats; found here without
  notes = {type = "table"},
}

-- The rows that no other beats: in the order of their costs, each against those kept before it.
local function find_front(objectives, able)
  local order, costs = {}, {}
  for i = 1, #objectives[1].numbers do
    local row, whole = {}, able[i]
    for k, one in ipairs(objectives) do
      row[k] = one.goal == "max" and -one.numbers[i] or one.numbers[i]
      whole = whole and row[k] == row[k]
    end
    costs[i] = row
    if whole then order[#order + 1] = i end
  end
  table.sort(order, function(a, b)
    for k = 1, #objectives do
      if costs[a][k] ~= costs[b][k] then return costs[a][k] < costs[b][k] end
    end
    return a < b
  end)
  local kept, flags = {}, {}
  for _, i in ipairs(order) do
    local beaten = false
    for n = #kept, 1, -1 do
      local other, no_worse, same = costs[kept[n]], true, true
      for k = 1, #objectives do
        no_worse = no_worse and other[k] <= costs[i][k]
        same = same and other[k] == costs[i][k]
      end
      if no_worse and not same then
        beaten = true
        break
      end
    end
    if not beaten then
      kept[#kept + 1] = i
      flags[i] = true
    end
  end
  return flags
end
progress.find_front = find_front

-- The edge of what the front beats, of two objectives: from the best in the first to the best in the other.
local function front_line(a, b, front)
  local order = {}
  for i in pairs(front) do order[#order + 1] = i end
  local sign = a.goal == "max" and -1 or 1
  table.sort(order, function(p, q)
    if a.numbers[p] ~= a.numbers[q] then return sign * a.numbers[p] < sign * a.numbers[q] end
    return p < q
  end)
  local xs, ys = {}, {}
  for k, i in ipairs(order) do xs[k], ys[k] = a.numbers[i], b.numbers[i] end
  return xs, ys
end

local function draw_front(s, f, a, b, rows, two)
  local groups = {done = {{}, {}}, infeasible = {{}, {}}, front = {{}, {}}}
  for i = 1, #a.numbers do
    local x, y = f:place(a.numbers[i], b.numbers[i])
    if x then
      local group = groups[rows.front[i] and "front" or rows.able[i] and "done" or "infeasible"]
      group[1][#group[1] + 1], group[1][#group[1] + 2] = x, y
      group[2][#group[2] + 1] = rows.notes and rows.notes[i] or false
    end
  end
  f:enter(6)
  put(s, looks.infeasible, groups.infeasible[1], rows.notes and groups.infeasible[2])
  put(s, looks.done, groups.done[1], rows.notes and groups.done[2])
  if two then
    local xs, ys = front_line(a, b, rows.front)
    s:line(series.staircase((series.pixels(f, xs, ys))), {stroke = palette.good, width = 1.6})
  end
  put(s, looks.front, groups.front[1], rows.notes and groups.front[2])
  f:leave()
end

local function pareto_legend(objectives, rows, count)
  local front, able, rest, none = 0, 0, 0, 0
  for i = 1, count do
    local whole = true
    for _, one in ipairs(objectives) do whole = whole and one.numbers[i] == one.numbers[i] end
    if rows.front[i] then front = front + 1
    elseif not whole then none = none + 1
    elseif rows.able[i] then able = able + 1
    else rest = rest + 1 end
  end
  local out = {{name = ("front (%d)"):format(front), marker = "disc", pen = looks.front.pen}}
  if able > 0 then
    out[2] = {name = ("beaten (%d)"):format(able), marker = "disc", pen = looks.done.pen}
  end
  if rest > 0 then
    out[#out + 1] = {name = ("%s (%d)"):format(looks.infeasible.name, rest), marker = "diamond",
      pen = looks.infeasible.pen}
  end
  return out, none > 0 and {("%d trial%s without a result"):format(none, none == 1 and "" or "s")} or nil
end

--- The front of two objectives, with what it beats; of three to six the same for each pair. objectives:
--- columns {name, unit, goal, values, scale}.
function progress.pareto(given)
  local where = "plot.pareto"
  local opts = options.read(where, given, pareto_rules)
  local objectives = columns.list(where, opts.objectives, 2, 6)
  local n, count = #objectives, #objectives[1].numbers
  for _, one in ipairs(objectives) do
    if one.names then raise(("%s: objective '%s': numbers expected, got names"):format(where, one.name)) end
    one.goal = one.goal or "min"
  end
  local rows = {able = columns.flags(where, "feasible", opts.feasible, count, true),
    notes = data.texts(where, "notes", opts.notes, count)}
  rows.front = opts.front and columns.chosen(where, "front", opts.front, count)
    or find_front(objectives, rows.able)
  local names, axes = {}, {}
  for k, one in ipairs(objectives) do
    names[k] = one.name
    axes[k] = columns.axis(where, one, {goal = true, pad = 0.06})
  end
  local width, height = opts.width, opts.height
  if n > 2 then
    width = given.width or 120 + 230 * (n - 1)
    height = given.height or 100 + 190 * (n - 1)
  end
  return figure.new {kind = where, name = opts.title or table.concat(names, ", "), width = width,
    height = height,
    draw = function(s)
      local legend, foot = pareto_legend(objectives, rows, count)
      local box = frame.around(s, {title = opts.title, legend = legend, notes = foot})
      if n == 2 then
        local f = frame.new(s, box, axes[1], axes[2])
        if count == 0 then f:say "no trials" end
        draw_front(s, f, objectives[1], objectives[2], rows, true)
        return f
      end
      frame.pairs(s, box, axes, function(f, across, down)
        draw_front(s, f, objectives[across], objectives[down], rows, false)
      end)
    end}
end

return progress
