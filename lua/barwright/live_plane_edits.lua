-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edits of an outline in the plane's live view, each with the line of Lua that makes it again, and the
-- file that these lines are kept in: ordinary Lua,
--
--   local object = ... or assert(dofile(folder .. "plate.lua"))
--   assert(object:drag({loop = "hole"}, {0.01, 0}))
--   return object
--
-- whose every line that begins with "assert(object" is one edit.
local core = require "barwright.core"
local edit_script = require "barwright.edit_script"
local kinds = require "barwright.live_plane_kinds"
local outlines = require "barwright.outline"

local edits = {}

local value = edit_script.value

-- ---- what an edit makes of an outline ------------------------------------------------------------

local function become(method, ...)
  local list = {}
  for i, argument in ipairs {...} do list[i] = value(argument) end
  return ("assert(object:become(assert(object.outline:%s(%s))))"):format(method,
    table.concat(list, ", "))
end

-- Tag of a new hole: that of the kind, of walls where the flow has some, else one without conditions.
local function tag_for_hole(object)
  local kind = kinds.of(object)
  if kind and kind.hole_tag then return kind.hole_tag end
  local conditions, tags = object.opts.conditions or {}, object.outline.tags
  table.sort(tags)
  for _, tag in ipairs(tags) do
    if conditions[tag] == "wall" then return tag end
  end
  return not conditions.boundary and "boundary" or "hole"
end

-- A name that no loop has.
local function free_name(outline)
  local taken, n = {}, 1
  for _, loop in ipairs(outline.loops) do taken[loop.name] = true end
  while taken["hole " .. n] do n = n + 1 end
  return "hole " .. n
end

local makers = {}

function makers.smooth(object, e)
  local opts = {loop = e.loop, strength = e.strength}
  local made, why = object.outline:smooth(opts)
  return made, why, become("smooth", opts)
end

function makers.hole(object, e)
  local kind, at = kinds.of(object), e.at
  if kind and kind.mirror then
    -- The outline is the right half; a hole in the image is one there.
    at = {math.abs(at[1]), at[2]}
    if at[1] <= e.radius then
      return nil, "the hole crosses the axis of symmetry: put it farther from the axis, or make it smaller"
    end
  end
  local opts = {centre = at, radius = e.radius, tag = tag_for_hole(object),
    name = free_name(object.outline)}
  local hole, why = outlines.circle(opts)
  if not hole then return nil, why end
  local made
  made, why = object.outline:hole(hole)
  return made, why, ('assert(object:become(assert(object.outline:hole(require("barwright").outline.circle(%s)))))')
    :format(value(opts))
end

function makers.remove(object, e)
  local made, why = object.outline:without(e.loop)
  return made, why, become("without", e.loop)
end

function makers.split(object, e)
  local made, why = object.outline:split(e.edge, e.t)
  return made, why, become("split", e.edge, e.t)
end

function makers.join(object, e)
  local made, why = object.outline:join(e.vertex)
  return made, why, become("join", e.vertex)
end

--- The outline that an edit {kind, ...} makes of an object's, or nil and why; and its line.
function edits.make(object, edit)
  return makers[edit.kind](object, edit)
end

--- The outline of a drag {handle, pins, reach} from `base`, moved by {dx, dy}; and the line that makes it
--- an edit of the object.
function edits.dragged(base, drag, by)
  if not drag.pins then
    local made, why = base:moved(drag.handle, by)
    return made, why, ("assert(object:drag(%s, %s))"):format(value(drag.handle), value(by))
  end
  local vertex = drag.handle.vertex
  local from = base:edge(vertex).from
  local to, options = {from[1] + by[1], from[2] + by[2]}, {pins = drag.pins, reach = drag.reach}
  local made, why = base:pull(vertex, to, options)
  return made, why, become("pull", vertex, to, options)
end

--- The line that tunes a bar, some vertices staying where they are.
function edits.tuned(target, pins)
  if not pins or #pins == 0 then return ("assert(object:tune(%s))"):format(value(target)) end
  return ("assert(object:tune(%s, {pins = %s}))"):format(value(target), value(pins))
end

-- ---- the file ------------------------------------------------------------------------------------

local head = "-- Edits of a barwright live view: run them with `barwright`, or go on with `barwright live`.\n"
local begun = "local object = ... or assert(dofile(folder .. %s))\n"

--- The text of a file of edits; `script` makes the object, named as seen from the file.
function edits.text(script, lines)
  local whole = script:sub(1, 1) == "/"
  return head .. 'local folder = debug.getinfo(1, "S").source:match "^@(.*[/\\\\])" or ""\n'
    .. (whole and begun:gsub("folder %.%. ", "") or begun):format(value(script))
    .. table.concat(lines, "\n") .. (#lines > 0 and "\n" or "") .. "return object\n"
end

--- Writes it, in place of what was there.
function edits.write(path, script, lines)
  return core.write_file(path, edits.text(script, lines))
end

--- The script and the lines of a text, or nil where it is no file of edits.
function edits.read(text)
  if text:sub(1, #head) ~= head then return nil end
  local script = text:match '\nlocal object = %.%.%. or assert%(dofile%([^"\n]*(".-")%)%)\n'
  script = script and load("return " .. script, "=script", "t", {})
  if not script then return nil end
  local lines = {}
  for line in text:gmatch "[^\n]+" do
    if line:find "^assert%(object" then lines[#lines + 1] = line end
  end
  return script(), lines
end

--- Does one line: true, or nil and why.
function edits.replay(object, line)
  local chunk, why = load(line, "=edit", "t", {object = object, assert = assert, require = require})
  if not chunk then return nil, why end
  local ok
  ok, why = pcall(chunk)
  if ok then return true end
  return nil, tostring(why)
end

return edits
