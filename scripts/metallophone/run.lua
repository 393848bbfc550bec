-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A metallophone: bars of an artistic outline tuned to a scale, with cutting files, sounds, places for
-- the screws, and a table beside the one of the paper (responsive, table 4).
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. package.path
local bw = require "barwright"
local page = require "page"
local pitch = require "barwright.pitch"
local script = require "barwright.command.script"
local shapes = require "shapes"
local tune = require "barwright.tune"

local MET, NOT_MET = 0, 1

-- Table 4 of the paper, Hz.
local paper = {
  C = {target = 523, simulated = 525, measured = 506, adjusted = 523},
  D = {target = 587, simulated = 588, measured = 604, adjusted = 587},
  E = {target = 659, simulated = 661, measured = 621, adjusted = 659},
  F = {target = 698, simulated = 699, measured = 698, adjusted = 698},
  G = {target = 783, simulated = 786, measured = 787, adjusted = 783},
  A = {target = 880, simulated = 880, measured = 860, adjusted = 881},
  B = {target = 987, simulated = 989, measured = 993, adjusted = 987},
}

local opts = script.read {
  summary = "a metallophone: bars of one outline tuned to a scale",
  about = "Makes bars of one outline tuned to a scale: cutting files, sounds, places for the screws, and a page "
    .. "with a table beside that of the paper responsive.\n\n"
    .. "Exit status: 0 every bar within 1 cent; 1 one is not; 2 the input was refused; 130 interrupted, what is "
    .. "done is kept.",
  options = {script.option.needed_out,
    {name = "shape", value = "SHAPE", default = "fish",
      what = "fish, leaf, bone, or a drawing: FILE.svg, FILE.dxf"},
    {name = "notes", value = "NOTE,...", list = true, default = {"C5", "D5", "E5", "F5", "G5", "A5", "B5"},
      what = "the notes of the bars"},
    {name = "thickness", value = "LENGTH", type = "number", unit = "m", default = 0.004, above = 0,
      what = "thickness of the plate"},
    {name = "material", value = "NAME", default = "aluminium", what = "of `barwright materials`"},
    {name = "elements", value = "N", type = "integer", default = 300, min = 20, what = "number of triangles of a "
      .. "bar"},
    {name = "screw", value = "LENGTH", type = "number", unit = "m", default = 0.003, above = 0,
      what = "diameter of the holes for screws"},
  },
}

local function read_outline()
  if shapes[opts.shape] then return assert(shapes[opts.shape]()), 0.2 end
  local outline, message = bw.outline.read(opts.shape)
  if not outline then script.refuse(message) end
  return outline
end

-- With a hole for a screw at each place.
local function drilled(outline, places)
  for k, at in ipairs(places) do
    local hole = assert(bw.outline.circle {centre = at, radius = opts.screw / 2,
      name = "screw " .. k})
    local more, message = outline:hole(hole)
    if not more then return nil, message end
    outline = more
  end
  return outline
end

-- The points of all loops but the first.
local function points_of_holes(outline)
  local list = {}
  for k, ring in ipairs(tune.rings(outline)) do
    if k > 1 then table.move(ring, 1, #ring, #list + 1, list) end
  end
  return list
end

local function make(note, base, material, results)
  local target = pitch.frequency(note)
  local clock = bw.seconds()
  -- Plates go with the inverse square of their size: first the size, then the shape.
  local first = assert(bw.responsive.metallophone {outline = base, thickness = opts.thickness,
    material = material, elements = opts.elements})
  local size = math.sqrt(first.frequency / target)
  local bar, message, details = bw.responsive.metallophone {outline = assert(base:scaled(size)),
    thickness = opts.thickness, material = material, elements = opts.elements, modes = 6}
  if not bar then return nil, message, details end
  local from, rounds = bar.frequency, 0
  local tuned
  tuned, message, details = bar:tune(target)
  if not tuned then return nil, message, details end
  -- Screws take a few cents: they are drilled, and the bar is tuned once more around them.
  local holes = bar:holes()
  local with = holes and drilled(bar.outline, holes)
  if with then
    rounds = tuned.rounds
    bar, message, details = bw.responsive.metallophone {outline = with, thickness = opts.thickness,
      material = material, elements = 2 * opts.elements, modes = 6}
    if not bar then return nil, message, details end
    tuned, message, details = bar:tune(target, {keep = points_of_holes(with)})
    if not tuned then return nil, message, details end
  end
  local made = {note = note, target_hz = target, before_hz = from, simulated_hz = tuned.frequency,
    cents = tuned.cents, rounds = rounds + tuned.rounds, mesh_cents = tuned.mesh_cents,
    area_m2 = bar.outline.area, scaled_by = size, holes_m = holes,
    overtones_hz = bar.frequencies:totable(), paper = paper[note:match "^%a"]}
  local start, finish = base:scaled(size).points:totable(), bar.outline.points:totable()
  made.moved_m = 0
  for k, point in ipairs(start) do
    made.moved_m = math.max(made.moved_m,
      math.sqrt((point[1] - finish[k][1]) ^ 2 + (point[2] - finish[k][2]) ^ 2))
  end
  local cut = bar.outline
  assert(cut:write(results:path(note .. ".svg")))
  assert(cut:write(results:path(note .. ".dxf")))
  assert(bar:write_tone(results:path(note .. ".wav")))
  -- The paper's bars came out mistuned: what should be taken off ours, were they as theirs.
  if made.paper and made.paper.measured ~= made.paper.target then
    local places, why = bar:trim(made.paper.measured, made.paper.target)
    made.trim = places or {refused = why}
  end
  made.seconds = bw.seconds() - clock
  return made, bar
end

local function main()
  local material, message = bw.material.named(opts.material)
  if not material then script.refuse(message) end
  for _, note in ipairs(opts.notes) do
    if not pitch.frequency(note) then script.refuse(("'%s' is no note: C5, F#4, Bb3"):format(note)) end
  end
  local base, length = read_outline()
  if length then base = assert(base:scaled(length)) end
  local results
  results, message = script.results(opts.out, opts, {script = "scripts/metallophone/run.lua",
    inputs = shapes[opts.shape] and {} or {opts.shape}, seed = bw.json.null})
  if not results then script.refuse(message) end
  local result = {shape = opts.shape, thickness_m = opts.thickness, material = opts.material,
    bars = bw.json.list {}, finished = false}
  local pictures, status = {}, MET
  print "note   target   before    tuned   cents   moved mm   rounds   paper's simulation"
  for _, note in ipairs(opts.notes) do
    local made, bar = make(note, base, material, results)
    if bw.interrupted() then
      status = script.INTERRUPTED
      break
    end
    if not made then
      result.bars[#result.bars + 1] = {note = note, message = bar}
      print(("%-4s %s"):format(note, bar))
      status = NOT_MET
    else
      result.bars[#result.bars + 1] = made
      pictures[#pictures + 1] = bar
      if math.abs(made.cents) >= 1 then status = NOT_MET end
      print(("%-4s %8.2f %8.2f %8.2f %7.2f %10.2f %8d   %s"):format(note, made.target_hz,
        made.before_hz, made.simulated_hz, made.cents, 1e3 * made.moved_m, made.rounds,
        made.paper and made.paper.simulated or ""))
    end
  end
  result.finished = status ~= script.INTERRUPTED
  assert(results:write(result))
  assert(page.write(results:path "report.html", result, pictures))
  print("written: " .. opts.out)
  return status
end

script.run(main, NOT_MET)
