-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The page of `barwright modes`: the lowest frequency first, a view of the part in each shape, and a table.
local body_page = require "barwright.body_page"
local bw = require "barwright"
local core = require "barwright.core"
local modes_table = require "barwright.command.modes_table"
local page_head = require "barwright.command.page_head"
local pitch = require "barwright.pitch"
local shown = require "barwright.shown"

local modes_page = {}

-- How far each node moves in a mode, of what moves farthest.
local function motion_of(modes, i)
  local far = modes:shape(i):map "norm(a)"
  local largest = far:max()
  return largest > 0 and far / largest or far
end

--- The head of the page. errors: in cents; about: {fixed = area (m2), fix = places, part = facts}.
function modes_page.head(modes, errors, about)
  local frequency, cents = modes.frequencies[1], errors[1]
  local free = #about.fix == 0
  return {verdict = "computed", word = core.quantity(frequency, "Hz"),
    headline = ("This is the lowest natural frequency. The mesh makes it %s: with it, from %s on."):format(
      modes_table.error(cents), shown.estimate(frequency / 2 ^ (cents / 1200), "Hz")),
    facts = {free and {"Constrained at", "nothing: the part is free"}
      or page_head.constrained(about.fix, about.fixed),
      {"Left out", free and ("%d rigid-body modes"):format(modes.rigid_count) or nil},
      about.part[1], about.part[2],
      {"Modes", ("%d%s"):format(modes.count, modes.counted and ", counted: none is missing" or "")}},
    advice = {"Vibration near one of these frequencies makes the part swing far: `barwright respond` says how "
      .. "far, and whether it holds. Damping is not in these numbers."}}
end

--- Writes the page: about = {title =, head =, answer =}.
function modes_page.write(modes, path, about)
  local motions, fields = {}, {}
  for i = 1, modes_table.shown(modes) do
    fields[i] = {name = ("motion in mode %d, of the largest"):format(i), unit = "%", values = motion_of(modes, i),
      scale = 100}
  end
  local body = modes_table.add(modes, motions, {head = {"nearest note"}, cells = function(i)
    return {("%s %+.0f cents"):format(pitch.note(modes.frequencies[i]))}
  end}, function(i) return i - 1 end)
  return body_page.write(path, modes.mesh, {title = about.title, verdict = about.head,
    answer = about.answer, fields = fields, displacements = motions, body = body,
    rows = "mode", manifest = {frequencies_hz = bw.json.list(modes.frequencies:totable())},
    picture = function(name) return modes:picture(1, name) end})
end

return modes_page
