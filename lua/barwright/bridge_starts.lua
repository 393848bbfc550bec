-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Right halves of bridges as free forms: where the design of bw.responsive.bridge begins.
--
-- The feet stand at y = 0 from x = span / 2 outwards, the pad is at y = deck from the middle. Both are pressed
-- evenly, so that curves may leave them at any angle and no stress is singular: stiff supports would have
-- infinite stresses at their edges. As the two forces balance, a short piece in the middle of the pad that is
-- fixed takes no more than the pressure that would be on it.
local form_of = require "barwright.free_form"

local starts = {}

-- A chain through points along a polygon, knots every `spacing`, ends as wanted.
local function chain(polygon, spacing, first, last)
  local lengths, total = {0}, 0
  for i = 2, #polygon do
    local a, b = polygon[i - 1], polygon[i]
    total = total + math.sqrt((b[1] - a[1]) ^ 2 + (b[2] - a[2]) ^ 2)
    lengths[i] = total
  end
  local count = math.max(5, math.floor(total / spacing + 0.5))
  local controls, at = {}, 1
  for k = 0, count do
    local length = total * k / count
    while at < #polygon - 1 and lengths[at + 1] < length do at = at + 1 end
    local a, b = polygon[at], polygon[at + 1]
    local t = (length - lengths[at]) / math.max(lengths[at + 1] - lengths[at], 1e-300)
    t = math.max(0, math.min(1, t))
    controls[k + 1] = {a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])}
  end
  controls[1][3] = first == "axis" and "y" or "fixed"
  controls[count + 1][3] = last == "axis" and "y" or "fixed"
  return {controls = controls, first = first, last = last, tag = "free"}
end

-- The outer loop from the undersides' polygons: bottom from the axis to the foot, top from the foot to the
-- pad, and where there is a hole across the axis its polygon from the upper end to the lower.
local function make(opts, bottom, top, middle)
  local s = opts.spacing
  local loop = {name = "bridge",
    chain(bottom, s, "axis", "clamped"), {line = true, tag = "foot"},
    chain(top, s, "clamped", "clamped"), {line = true, tag = "pad"},
    {controls = {{opts.middle, opts.deck, "fixed"}}}, {line = true, tag = "middle"},
    {controls = {{0, opts.deck, "fixed"}}}, {line = true, tag = "axis"}}
  if middle then
    loop[#loop + 1] = chain(middle, s, "axis", "axis")
    loop[#loop + 1] = {line = true, tag = "axis"}
  end
  return form_of.create {loop}
end

-- What all share: a = inner edge of the foot, e = outer edge, H = deck, c = half the pad, w = a wall.
local function measures(opts)
  return opts.span / 2, opts.span / 2 + opts.bearing, opts.deck, opts.pad / 2, opts.wall
end

local function underside(opts)
  return {{0, 0}, {opts.span / 2, 0}}
end

--- A beam of the height of the deck.
function starts.beam(opts)
  local _, e, H, c, w = measures(opts)
  return make(opts, underside(opts), {{e, 0}, {e, H - 2 * w}, {e - 0.6 * w, H - 0.4 * w},
    {e - 2 * w, H}, {c, H}})
end

--- Straight slopes from the feet to the pad, solid.
function starts.gable(opts)
  local _, e, H, c, w = measures(opts)
  return make(opts, underside(opts), {{e, 0}, {e, 2.5 * w}, {c, H}})
end

--- Two struts and a tie.
function starts.truss(opts)
  local a, e, H, c, w = measures(opts)
  local t = opts.member
  local middle = {{0, H - 1.8 * t - w}, {c, H - 1.9 * t - w}, {a - 2.2 * t - w, 2 * t + w},
    {a - 2.7 * t - w, t}, {0, t}}
  return make(opts, underside(opts),
    {{e, 0}, {e, 2.5 * w}, {e - w, 4 * w}, {c, H}}, middle)
end

--- An arch over the gap without a tie.
function starts.arch(opts)
  local a, e, H, c, w = measures(opts)
  local bottom = {}
  for i = 0, 12 do
    local angle = math.pi / 2 * (1 - i / 12)
    bottom[#bottom + 1] = {(a - 0.2 * w) * math.cos(angle), 0.4 * H * math.sin(angle) + 0.1 * w}
  end
  bottom[#bottom] = {a, 0}
  return make(opts, bottom, {{e, 0}, {e, 0.3 * H}, {e - 2 * w, H - 2 * w}, {c, H}})
end

-- ---- from an outline -----------------------------------------------------------------------------

-- Places along edges first to last (of a loop), without the last one's end.
local function trace(outline, first, last)
  local list = {}
  for n = first, last do
    for j = 0, 7 do list[#list + 1] = outline:at(n, j / 8) end
  end
  return list
end

-- A chain of edges of one outline whose knots lie on it.
local function fitted(polygon, spacing, first, last)
  local made = chain(polygon, spacing, first, last)
  local knots = {}
  for k, c in ipairs(made.controls) do knots[k] = {c[1], c[2]} end
  made.controls = form_of.through(made, knots)
  return made
end

local function ring(outline, loop, spacing)
  local polygon = trace(outline, loop.first, loop.first + loop.count - 1)
  polygon[#polygon + 1] = polygon[1]
  local made = chain(polygon, spacing, "clamped", "clamped")
  local knots = {}
  for k = 1, #made.controls - 1 do knots[k] = {made.controls[k][1], made.controls[k][2]} end
  local closed = {controls = knots, closed = true, tag = "free"}
  closed.controls = form_of.through(closed, knots)
  return {name = loop.name, hole = true, closed}
end

-- The outer loop: runs of edges that carry nothing become curves, the others stay lines.
local function outer(outline, loop, spacing)
  local count = loop.count
  local function tag(k) return outline:edge(loop.first + (k - 1) % count).tag end
  local function carries(k)
    local name = tag(k)
    return name == "foot" or name == "pad" or name == "middle" or name == "axis"
  end
  local begin = 1
  while not (carries(begin) and not carries(begin + 1)) do begin = begin + 1 end
  local pieces, k = {name = loop.name}, begin + 1
  while k <= begin + count do
    if carries(k) then
      pieces[#pieces + 1] = {line = true, tag = tag(k)}
      if carries(k + 1) then
        local to = outline:edge(loop.first + (k - 1) % count).to
        pieces[#pieces + 1] = {controls = {{to[1], to[2], "fixed"}}}
      end
      k = k + 1
    else
      local from, polygon = k, {}
      while not carries(k) do
        local n = loop.first + (k - 1) % count
        table.move(trace(outline, n, n), 1, 8, #polygon + 1, polygon)
        k = k + 1
      end
      polygon[#polygon + 1] = outline:edge(loop.first + (k - 2) % count).to
      pieces[#pieces + 1] = fitted(polygon, spacing, tag(from - 1) == "axis" and "axis" or "clamped",
        tag(k) == "axis" and "axis" or "clamped")
    end
  end
  return pieces
end

--- Holes of an outline that stay as they are: all but those named in `designed`.
function starts.kept_holes(outline, designed)
  local points, segments, list = outline.points:totable(), outline.segments:totable(), {}
  for _, loop in ipairs(outline.loops) do
    if loop.hole and not designed[loop.name] then
      local bezier = {}
      for n = loop.first, loop.first + loop.count - 1 do
        local s = segments[n]
        bezier[#bezier + 1] = {at = points[s[1]], control = s[2] > 0 and points[s[2]] or nil,
          control2 = s[3] > 0 and points[s[3]] or nil}
      end
      list[#list + 1] = {name = loop.name, hole = true, {bezier = bezier, tag = "free"}}
    end
  end
  return list
end

--- The outline as it is, its curves as splines; holes named in `designed` are curves too.
function starts.current(opts, outline, designed)
  local loops = {}
  for _, loop in ipairs(outline.loops) do
    if not loop.hole then
      table.insert(loops, 1, outer(outline, loop, opts.spacing))
    elseif designed[loop.name] then
      loops[#loops + 1] = ring(outline, loop, opts.spacing)
    end
  end
  return form_of.create(loops)
end

return starts
