-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Frames of a motion in time: states on the boundary at evenly spaced instants, kept while it runs; pictures and
-- animated pages of them.
local body_page = require "barwright.body_page"
local core = require "barwright.core"
local fine_boundary = require "barwright.fine_boundary"
local html = require "barwright.html"
local options = require "barwright.options"
local shown = require "barwright.shown"
local xdmf = require "barwright.xdmf"

local raise = core.raise

local transient_frames = {}

-- By frames: {mesh =, surface =} whose points the values belong to.
local bodies_of = setmetatable({}, {__mode = "k"})

--- What keeps `count` frames of a body between two times; or nil, message, details.
function transient_frames.new(body, count, first, last)
  local surface, nodes, details = fine_boundary(body.mesh)
  if not surface then return nil, nodes, details end
  local frames = {nodes = nodes, time = {}, displacement = {}}
  bodies_of[frames] = {mesh = body.mesh, surface = surface}
  return {frames = frames, count = count, next = 0, first = first, interval = (last - first) / (count - 1),
    rounding = 1e-6 * body.step_length}
end

--- Whether the state at a time is a frame: the first one that is not before the next instant.
function transient_frames.is_due(keeper, time)
  return keeper.next < keeper.count
    and time >= keeper.first + keeper.next * keeper.interval - keeper.rounding
end

--- Keeps the state of a body; `von_mises` of its nodes, or nil.
function transient_frames.keep(keeper, body, von_mises)
  local frames, past = keeper.frames, body.time - keeper.first + keeper.rounding
  local i = #frames.time + 1
  frames.time[i], frames.displacement[i] = body.time, body.displacement:gather(frames.nodes)
  if von_mises then
    frames.von_mises = frames.von_mises or {}
    frames.von_mises[i] = von_mises:gather(frames.nodes)
  end
  -- A step may pass several instants.
  keeper.next = keeper.interval > 0 and math.max(keeper.next, past // keeper.interval) + 1 or keeper.count
end

--- The frames, when the motion was followed.
function transient_frames.finish(keeper)
  keeper.frames.time = core.array.new(keeper.frames.time)
  return keeper.frames
end

local function lengths(displacement)
  return displacement:map "norm(a)"
end

--- The frames as XDMF: the boundary with its displacement, and where stresses were recorded their von Mises
--- stress.
function transient_frames.write(recording, path)
  local frames, states = recording.frames, {}
  if not frames then raise "write: the recording has no frames for .xdmf: give run frames" end
  for i, displacement in ipairs(frames.displacement) do
    states[i] = {time = frames.time[i], fields = {displacement = displacement,
      von_mises = frames.von_mises and frames.von_mises[i]}}
  end
  return xdmf.write(bodies_of[frames].surface, states, path)
end

--- A picture of the largest von Mises stress, or without stresses of the frame with the largest displacement;
--- options of bw.picture.
function transient_frames.picture(recording, path, given)
  local opts, frames = options.copied(given), recording.frames
  local peak = recording.stress and recording.stress.peak
  if peak then
    opts.title = opts.title or "motion at " .. core.quantity(peak.time, "s")
    return peak.static:picture(path, opts)
  end
  if not frames then
    raise "picture: the recording has neither stresses nor frames: give run stress_every or frames"
  end
  local most, at = -1, nil
  for i, displacement in ipairs(frames.displacement) do
    local largest = lengths(displacement):max()
    if largest > most then most, at = largest, i end
  end
  opts.displacement = frames.displacement[at]
  opts.values = lengths(opts.displacement)
  opts.unit, opts.scale = opts.unit or "displacement, mm", opts.scale or 1e3
  opts.title = opts.title or "motion at " .. core.quantity(frames.time[at], "s")
  return core.picture(bodies_of[frames].surface, path, opts)
end

-- What the page shows of the motion, and how fast.
local function of_frames(recording, seconds)
  local frames, states = recording.frames, #recording.time
  local count = #frames.time
  local duration = frames.time[count] - frames.time[1]
  local speed = ""
  if duration > 0 then
    local slower = seconds / duration
    speed = (", %s times %s than the part moves"):format(shown.number(math.max(slower, 1 / slower)),
      slower >= 1 and "slower" or "faster")
  end
  return ("%d of %d states from %s to %s, without what lies between them. The view plays them in %s%s. The error "
    .. "of the mesh is unknown."):format(count, states, core.quantity(frames.time[1], "s"),
    core.quantity(frames.time[count], "s"), core.quantity(seconds, "s"), speed)
end

--- Writes a page with the motion in time; options: title, seconds.
function transient_frames.report(recording, path, given)
  local opts = options.read("report", given, {
    title = {type = "string", default = "Motion in time"},
    seconds = {type = "number", default = 6, above = 0},
  })
  local frames = recording.frames
  if not frames then raise "report: the recording has no frames: give run frames, such as frames = 60" end
  local fields, magnitudes = {}, {}
  for i, displacement in ipairs(frames.displacement) do magnitudes[i] = lengths(displacement) end
  if frames.von_mises then
    fields[1] = {name = "von Mises stress", unit = "MPa", values = frames.von_mises, scale = 1e-6}
  end
  fields[#fields + 1] = {name = "displacement", unit = "mm", values = magnitudes, scale = 1e3}
  local body = bodies_of[frames]
  return body_page.write(path, body.mesh, {title = opts.title,
    answer = of_frames(recording, opts.seconds), surface = body.surface,
    body = ("<h2>The recording</h2>\n<pre>%s</pre>\n"):format(html.escape(tostring(recording))),
    fields = fields, displacements = {{name = "in time", kind = "motion", values = frames.displacement, field = 0,
      times = frames.time:totable(), seconds = opts.seconds}},
    manifest = {steps = #recording.time - 1, frames = #frames.time},
    picture = function(name) return transient_frames.picture(recording, name, {title = opts.title}) end})
end

return transient_frames
