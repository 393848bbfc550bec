-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Right halves of bridges as free forms: where the design of bw.responsive.bridge begins.
--
-- The feet stand at y = 0 from x = span / 2 outwards, the pad is at y = deck from the middle. Both are pressed
-- evenly, so that curves may leave them at any angle and no stress is singular: stiff supports would have
-- infinite stresses at their edges. As the two forces balance, a short piece in the middle of the pad that is
-- held takes no more than the pressure that would be on it.
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
local function make(wish, bottom, top, middle)
  local s = wish.spacing
  local loop = {name = "bridge",
    chain(bottom, s, "axis", "clamped"), {line = true, tag = "foot"},
    chain(top, s, "clamped", "clamped"), {line = true, tag = "pad"},
    {controls = {{wish.hold, wish.deck, "fixed"}}}, {line = true, tag = "hold"},
    {controls = {{0, wish.deck, "fixed"}}}, {line = true, tag = "axis"}}
  if middle then
    loop[#loop + 1] = chain(middle, s, "axis", "axis")
    loop[#loop + 1] = {line = true, tag = "axis"}
  end
  return form_of.create {loop}
end

-- What all share: a = inner edge of the foot, e = outer edge, H = deck, c = half the pad, w = a wall.
local function measures(wish)
  return wish.span / 2, wish.span / 2 + wish.bearing, wish.deck, wish.pad / 2, wish.wall
end

local function underside(wish)
  return {{0, 0}, {wish.span / 2, 0}}
end

--- A beam of the height of the deck.
function starts.beam(wish)
  local _, e, H, c, w = measures(wish)
  return make(wish, underside(wish), {{e, 0}, {e, H - 2 * w}, {e - 0.6 * w, H - 0.4 * w},
    {e - 2 * w, H}, {c, H}})
end

--- Straight slopes from the feet to the pad, solid.
function starts.gable(wish)
  local _, e, H, c, w = measures(wish)
  return make(wish, underside(wish), {{e, 0}, {e, 2.5 * w}, {c, H}})
end

--- Two struts and a tie.
function starts.truss(wish)
  local a, e, H, c, w = measures(wish)
  local t = wish.member
  local middle = {{0, H - 1.8 * t - w}, {c, H - 1.9 * t - w}, {a - 2.2 * t - w, 2 * t + w},
    {a - 2.7 * t - w, t}, {0, t}}
  return make(wish, underside(wish),
    {{e, 0}, {e, 2.5 * w}, {e - w, 4 * w}, {c, H}}, middle)
end

--- An arch over the gap without a tie.
function starts.arch(wish)
  local a, e, H, c, w = measures(wish)
  local bottom = {}
  for i = 0, 12 do
    local angle = math.pi / 2 * (1 - i / 12)
    bottom[#bottom + 1] = {(a - 0.2 * w) * math.cos(angle), 0.4 * H * math.sin(angle) + 0.1 * w}
  end
  bottom[#bottom] = {a, 0}
  return make(wish, bottom, {{e, 0}, {e, 0.3 * H}, {e - 2 * w, H - 2 * w}, {c, H}})
end

return starts
