-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Pitches: names of notes, equal temperament at a4 = 440 Hz, differences in cents.
local pitch = {}

local names = {"C", "C#", "D", "D#", "E", "F", "F#", "G", "G#", "A", "A#", "B"}

--- How far a frequency lies above another, in cents (1200 to the octave).
function pitch.cents(frequency, from)
  return 1200 * math.log(frequency / from, 2)
end

--- The nearest note and how far the frequency lies above it: "C5", 3.2.
function pitch.note(frequency)
  local steps = 12 * math.log(frequency / 440, 2) + 57 -- above C0
  local nearest = math.floor(steps + 0.5)
  return names[nearest % 12 + 1] .. nearest // 12, 100 * (steps - nearest)
end

--- Hz of a note: "A4", "C#5", "Bb3". nil where it is none.
function pitch.frequency(note)
  local letter, sign, octave = tostring(note):match "^([A-Ga-g])([#b]?)(-?%d+)$"
  if not letter then return nil end
  local step
  for i, name in ipairs(names) do
    if name == letter:upper() then step = i - 1 end
  end
  step = step + (sign == "#" and 1 or sign == "b" and -1 or 0) + 12 * math.tointeger(octave)
  return 440 * 2 ^ ((step - 57) / 12)
end

return pitch
