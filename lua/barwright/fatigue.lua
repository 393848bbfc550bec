-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- bw.fatigue {...}: the damage of a load history on static solutions of unit loads. docs/theory/dynamics.md
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local fine_boundary = require "barwright.fine_boundary"
local histories = require "barwright.history"
local members = require "barwright.members"
local options = require "barwright.options"
local shown = require "barwright.shown"

local raise = core.raise

local fatigue = {}
fatigue.__index = members("fatigue", fatigue, {})
fatigue.__name = "barwright.fatigue"

-- The values of a file of times and values. times: those of the files before it, which it must have too.
local function read_values(path, times, length)
  local rows, message, details = histories.rows(path)
  if not rows then return nil, message, details end
  local function wrong(text, ...)
    return nil, path .. ": " .. text:format(...), {status = "format", file = path}
  end
  if #rows < 2 then return wrong("2 rows or more expected, got 1") end
  if length and #rows ~= length then
    return wrong("%d rows expected, as many numbers as load 1 has, got %d", length, #rows)
  end
  local values = {}
  for k, row in ipairs(rows) do
    values[k], times[k] = row[2], times[k] or row[1]
    if row[1] ~= times[k] then
      return wrong("row %d: the time %g expected, as in the first file, got %g", k, times[k], row[1])
    end
  end
  return values
end

-- The history of a load as a table of numbers, as long as that of the first load; nil, a message and details for a
-- file that cannot be read.
local function read_history(i, given, times, length)
  if type(given) == "string" then return read_values(given, times, length) end
  local history = options.kind(given) == "array" and given:totable() or given
  if type(history) ~= "table" or not options.countable(history) or #history < 2 then
    raise(("fatigue: load %d: 'history': a list of 2 numbers or more or the path of a CSV file expected, got %s")
      :format(i, core.got(given)))
  end
  if length and #history ~= length then
    raise(("fatigue: load %d: a history of %d numbers expected, as that of load 1, got %d"):format(i, length,
      #history))
  end
  for k, value in ipairs(history) do
    if type(value) ~= "number" or value ~= value or math.abs(value) == math.huge then
      raise(("fatigue: load %d: entry %d of the history: a finite number expected, got %s"):format(i, k,
        type(value) == "number" and tostring(value) or core.got(value)))
    end
  end
  return history
end

--- The damage of one pass: {loads = {{static =, history =}, ...}, curve = {amplitude =, cycles =, ...}}.
function fatigue.create(given)
  local opts = options.read("fatigue", given, {
    loads = {type = "table", needed = true},
    curve = {type = "table", needed = true},
  })
  local first, solutions, rows, times, length = nil, {}, {}, {}, nil
  if #opts.loads < 1 or #opts.loads > 1000 then
    raise(("fatigue: option 'loads': 1 to 1000 loads expected, got %d"):format(#opts.loads))
  end
  for i, load in ipairs(opts.loads) do
    local one = options.read(("fatigue: load %d"):format(i), load, {
      static = {type = "static", needed = true},
      history = {type = "any", needed = true},
    })
    first = first or one.static
    if one.static.mesh ~= first.mesh then
      raise(("fatigue: load %d: a static solution on the mesh of load 1 expected"):format(i))
    end
    local history, message, details = read_history(i, one.history, times, length)
    if not history then return nil, message, details end
    length = #history
    solutions[i] = one.static
    for t, value in ipairs(history) do
      rows[t] = rows[t] or {}
      rows[t][i] = value
    end
  end
  local damage, message, details = core.fatigue_damage(solutions, rows, opts.curve)
  if not damage then return nil, message, details end
  local node = damage:argmax()
  local worst = damage[node]
  return setmetatable({damage = damage, node = node, passes = worst > 0 and 1 / worst or math.huge,
    mesh = first.mesh, at = first.mesh.nodes:rows(node, node):totable()[1]}, fatigue)
end

--- The damage as .vtu (or what the ending says).
function fatigue:write(path, given)
  local opts = options.copied(given)
  opts.fields = options.copied(opts.fields, "fields")
  opts.fields.damage = {self.damage, on = "nodes"}
  return self.mesh:write(path, opts)
end

--- The body coloured by the damage over the largest; options of bw.picture.
function fatigue:picture(path, given)
  local opts = options.copied(given)
  local surface, nodes, details = fine_boundary(self.mesh)
  if not surface then return nil, nodes, details end
  opts.values = self.damage:gather(nodes)
  opts.unit = opts.unit or "damage of one pass"
  return core.picture(surface, path, opts)
end

function fatigue:__tostring()
  local unknown = "; error of the stress unknown; life curves scatter"
  if self.passes == math.huge then return "fatigue: no damage" .. unknown end
  local place = ("at node %d, %s"):format(self.node, core.point(self.at))
  if self.passes == 0 then
    return ("fatigue: the mean stress reaches the strength %s: not one pass%s"):format(place, unknown)
  end
  return ("fatigue: %s passes of the history until damage 1, %s%s by factors of 2 to 10"):format(
    shown.number(self.passes), place, unknown)
end

arguments.methods("fatigue", fatigue, fatigue, {write = "path: string, options?: options",
  picture = "path: string, options?: options"})

return fatigue.create
