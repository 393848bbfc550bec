-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Metallophone bars: an outline extruded to a plate, its natural frequencies while it is dragged, tuning,
-- supports, tone (responsive, section 5.1).
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local followed = require "barwright.followed"
local mode_kinds = require "barwright.mode_kinds"
local options = require "barwright.options"
local outlines = require "barwright.outline"
local pitch = require "barwright.pitch"
local tune = require "barwright.tune"

local raise = core.raise

local metallophone = {}

local rules = followed.with {
  material = {type = "material", needed = true},
  thickness = {type = "number", needed = true, above = 0},
  modes = {type = "integer", default = 1, min = 1, max = 200},
  tolerance = {type = "number", default = 1e-4, above = 0},
  solver = {type = "eigensolver", auto = true},
  max_lag = {type = "integer", min = 0},
}

local bar = followed.class("metallophone bar", {"frequencies", "thickness"}, {
  frequency = function(self) return rawget(self, "body").frequencies[1] end,
  note = function(self)
    local name, above = pitch.note(rawget(self, "body").frequencies[1])
    return ("%s %+.1f cents"):format(name, math.abs(above) < 0.05 and 0 or above) -- no "-0.0"
  end,
  nodal_lines = function(self) return rawget(self, "body"):nodal_lines(1) end,
})

bar.drag, bar.become, bar.solve, bar.start = followed.drag, followed.become, followed.solve,
  followed.solve

function bar.finish(self, report)
  local opts = self.opts
  return self.body:solve(report, {modes = opts.modes, tolerance = opts.tolerance, solver = opts.solver,
    max_lag = opts.max_lag})
end

local describe = bar.__tostring
function bar:__tostring()
  return ("%s; %.2f Hz, %s"):format(describe(self), self.frequency, self.note)
end

--- How the frequency of a mode (default 1) changes with the outline's points, Hz/m: an array.
function bar:gradient(mode)
  return self.body:gradient(mode)
end

--- Deflection and two rotations of a mode at every node.
function bar:mode(mode)
  return self.body:mode(mode)
end

--- The lowest frequencies of vibrations within the bar's plane (`count` of them, default 1): where one
--- lies below bar.frequency, the bar is too narrow for its thickness, and bending does not decide the tone.
function bar:inplane(count)
  return self.body:inplane(count)
end

--- All modes up to the highest that the bar has, the lowest first: {frequency, kind = "bending", "torsion"
--- or "in-plane", number = from 1 for each kind, mode = of those that are not in the plane}.
function bar:spectrum()
  local list = mode_kinds.of(self)
  local highest = list[#list].frequency
  local inplane, message, details = self.body:inplane(#list)
  if not inplane then return nil, message, details end
  for number, frequency in ipairs(inplane:totable()) do
    if frequency <= highest then
      list[#list + 1] = {frequency = frequency, kind = "in-plane", number = number}
    end
  end
  table.sort(list, function(a, b) return a.frequency < b.frequency end)
  return list
end

-- ---- supports ------------------------------------------------------------------------------------

--- Two places to support the bar where the lowest mode is at rest, one on either side of the centroid, as
--- near the long axis as the nodal lines come.
function bar:holes()
  local outline = self.outline
  local axis, centroid = mode_kinds.long_axis(outline), outline.centroid
  local best = {}
  for _, line in ipairs(self.nodal_lines:totable()) do
    for part = 0, 4 do
      local t = part / 4
      local x = line[1] + t * (line[3] - line[1]) - centroid[1]
      local y = line[2] + t * (line[4] - line[2]) - centroid[2]
      local along, across = x * axis[1] + y * axis[2], math.abs(y * axis[1] - x * axis[2])
      local side = along < 0 and 1 or 2
      if not best[side] or across < best[side].across then
        best[side] = {across = across, x + centroid[1], y + centroid[2]}
      end
    end
  end
  if not (best[1] and best[2]) then
    return nil, "the nodal lines of the lowest mode do not lie on both sides of the centroid: it is no bending "
      .. "mode", {status = "geometry"}
  end
  return {{best[1][1], best[1][2]}, {best[2][1], best[2][2]}}
end

-- ---- sound ---------------------------------------------------------------------------------------

--- The sound of a stroke, an array of samples: at = {x, y}, loss, contact, seconds, rate. With the modes
--- that the bar has; ask for some more in `modes`.
function bar:tone(given)
  return self.body:tone(given)
end

--- How loudly each mode sounds in it, with its sign, the loudest 1 in size: options of `tone`.
function bar:gains(given)
  return self.body:gains(given)
end

--- The tone as a .wav file.
function bar:write_tone(path, given)
  local samples, message, details = self.body:tone(given)
  if not samples then return nil, message, details end
  return core.wav_write(path, given and given.rate or 44100, samples)
end

-- ---- tuning --------------------------------------------------------------------------------------

local tune_rules = {
  keep = {type = "table", default = {}},
  pins = {type = "table", default = {}},
  smooth = {type = "number", above = 0},
  finer = {type = "integer", default = 4, min = 1},
  watch = {type = "function"},
  ratios = {type = "table"}, -- of the frequencies of the lowest modes of a kind
  kind = {type = "string", default = "bending", one_of = {"bending", "torsion"}},
  move_limit = {type = "number", default = 0.2, above = 0}, -- part of the local width that a point may move by
  stages = {type = "integer", default = 1, min = 1, max = 100}, -- each with a move limit of its own
}

local function wanted_frequency(where, target)
  local wanted = type(target) == "string" and pitch.frequency(target) or target
  if type(wanted) ~= "number" or not (wanted > 0 and wanted < math.huge) then
    raise(("%s: a frequency above 0 Hz or a note such as \"C5\" expected, got %s"):format(where,
      core.got(target)))
  end
  return wanted
end

-- The bar on a finer mesh of the same outline.
local function on_finer(self, finer)
  return metallophone.new {outline = self.outline, material = self.opts.material,
    thickness = self.opts.thickness, elements = self.element_count * finer, modes = self.opts.modes,
    tolerance = self.opts.tolerance}
end

-- Farther from the pitch than this (in ln f) the size is changed first.
local FAR = 0.05
-- Stages on the way need not be met nearer than this part of a step.
local PASSED = 0.25
-- Modes that are computed at most to find those that are tuned.
local MAX_MODES = 60

-- The frequencies wanted, from the first one and the ratios.
local function wanted_of(first, ratios)
  if not ratios then return {first} end
  local wanted = {}
  for k, ratio in ipairs(ratios) do
    if type(ratio) ~= "number" or not (ratio > (ratios[k - 1] or 0) and ratio < math.huge) then
      raise(("tune: option 'ratios': numbers above 0, each above the one before, expected, such as {1, 4, 10}; "
        .. "entry %d is %s"):format(k, core.got(ratio)))
    end
    wanted[k] = first * ratio / ratios[1]
  end
  if #wanted == 0 then raise "tune: option 'ratios': at least one number expected, got none" end
  return wanted
end

-- The function that says which modes of a bar are tuned. By kind and number, so that another kind's mode may
-- pass them.
local function choice(opts)
  if not opts.ratios then return function() return {1} end end
  return function(self) return mode_kinds.lowest(self, opts.kind, #opts.ratios) end
end

-- Computes so many modes that those to be tuned, and some more for others to pass, are among them.
local function enough_modes(self, choose)
  local modes = choose(self)
  while not modes or modes[#modes] + 2 > self.opts.modes do
    if modes and #modes == 1 and modes[1] == 1 then return true end
    if self.opts.modes >= MAX_MODES then
      return nil, ("the modes to be tuned are not among the lowest %d: ask for fewer ratios"):format(
        self.opts.modes), {status = "infeasible"}
    end
    self.opts.modes = math.min(MAX_MODES, self.opts.modes + 3)
    local ok, message, details = self:solve()
    if not ok then return nil, message, details end
    modes = choose(self)
  end
  return true
end

-- Goes towards the frequencies wanted by equal steps of their logarithms, all but the last step; each is the least
-- change of the outline that the one before led to. Returns the rounds.
local function approach(self, wanted, opts, search)
  local now, rounds, farthest = {}, 0, 0
  if opts.stages == 1 then return 0 end
  local modes = search.choose(self)
  if not modes then
    return nil, "the modes to be tuned are no longer among those computed: give the bar more modes",
      {status = "convergence"}
  end
  for k, mode in ipairs(modes) do
    now[k] = self.frequencies[mode]
    farthest = math.max(farthest, math.abs(math.log(wanted[k] / now[k])))
  end
  search.enough = PASSED * farthest / opts.stages
  for stage = 1, opts.stages - 1 do
    local aim = {}
    for k, from in ipairs(now) do aim[k] = from * (wanted[k] / from) ^ (stage / opts.stages) end
    local met, message, details = tune.search(self, aim, self.outline, search)
    if not met then return nil, ("stage %d of %d: %s"):format(stage, opts.stages, message), details end
    rounds = rounds + message
  end
  search.enough = nil
  return rounds
end

-- What `tune` does; where it fails the bar is at what it tried last.
local function tuned(self, wanted, opts, keep)
  local first, choose = self.outline, choice(opts)
  local enough, why, because = enough_modes(self, choose)
  if not enough then return nil, why, because end
  local far = math.log(self.frequencies[choose(self)[1]] / wanted[1])
  if math.abs(far) > FAR then
    local scaled, message, details = first:scaled(math.exp(far / 2))
    if scaled then scaled, message, details = self:become(scaled) end
    if not scaled then return nil, message, details end
  end
  local box = self.outline.box
  local size = math.sqrt((box.max[1] - box.min[1]) ^ 2 + (box.max[2] - box.min[2]) ^ 2)
  local search = {keep = keep, smooth = opts.smooth or 0.1 * size, watch = opts.watch, choose = choose,
    move_limit = opts.move_limit}
  local rounds, message, details = approach(self, wanted, opts, search)
  if not rounds then return nil, message, details end
  local base, aim, modes, off = self.outline, table.move(wanted, 1, #wanted, 1, {}), nil, 0
  for _ = 1, 6 do
    local met
    met, message, details = tune.search(self, aim, base, search)
    if not met then return nil, message, details end
    rounds = rounds + message
    local finer = self
    if opts.finer > 1 then
      finer, message, details = on_finer(self, opts.finer)
      if not finer then return nil, message, details end
    end
    local here, there = choose(self), choose(finer)
    if not there then
      return nil, "the modes to be tuned are not among those computed on the finer mesh: try another 'finer' or "
        .. "more elements", {status = "convergence"}
    end
    local worst = 0
    modes = {}
    for k, target in ipairs(wanted) do
      local ours, checked = self.frequencies[here[k]], finer.frequencies[there[k]]
      modes[k] = {frequency = checked, wanted = target, cents = pitch.cents(checked, target), number = k,
        kind = opts.ratios and opts.kind or nil}
      worst = math.max(worst, math.abs(modes[k].cents))
      if k == 1 then off = pitch.cents(checked, ours) end
      aim[k] = target * ours / checked
    end
    if worst < 0.1 then break end
  end
  local moved = 0
  local from, to = first.points:totable(), self.outline.points:totable()
  for i = 1, #from do
    moved = math.max(moved, math.sqrt((to[i][1] - from[i][1]) ^ 2 + (to[i][2] - from[i][2]) ^ 2))
  end
  return {frequency = modes[1].frequency, cents = modes[1].cents, moved = moved, rounds = rounds,
    mesh_cents = off, modes = modes}
end

--- Changes the outline until the tone is `target` (Hz, or a note), moving it least: |p|^2 along the
--- outline and, over the length `smooth` (default: a tenth of the size), its unevenness. `keep`: numbers
--- of points that stay; `pins`: of vertices that do, as in outline:pull. Where the pitch is more than 5 %
--- off, the size is changed first (the tone of a thin bar goes with its inverse square), and `keep` and
--- `pins` hold from there. The tone is met on a mesh `finer` times as fine (default 4; 1: on the bar's own).
--- `watch` is called with the bar after every round; when it returns false, all is as before.
--- `ratios`: of the frequencies of the lowest modes of a `kind` ("bending" or "torsion"), the first of which gets
--- the target: {1, 4, 10}. They are followed by kind and number while modes of another kind pass them.
--- `move_limit`: part of the local width that a point may move by (0.2). `stages`: the way is divided into so many
--- (1), each from the outline that the one before led to, with a move limit of its own; ratios far from an even
--- bar's need some.
--- Returns what was done: {frequency, cents, moved (largest displacement, m), rounds, mesh_cents, modes}.
function bar:tune(target, given)
  local wanted = wanted_frequency("tune", target)
  local opts = options.read("tune", given, tune_rules)
  local keep = {}
  for _, point in ipairs(opts.keep) do keep[point] = true end
  local segments = #opts.pins > 0 and self.outline.segments:totable()
  for _, vertex in ipairs(opts.pins) do
    if not segments[vertex] then
      raise(("tune: option 'pins': numbers of vertices from 1 to %d expected, got %s"):format(#segments,
        core.got(vertex)))
    end
    keep[segments[vertex][1]] = true
  end
  local targets, modes = wanted_of(wanted, opts.ratios), self.opts.modes
  local result, message, details = followed.attempt(self, function() return tuned(self, targets, opts, keep) end)
  self.opts.modes = modes
  return result, message, details
end

-- ---- trimming ------------------------------------------------------------------------------------

local MAX_CUT = 0.5 -- of the width of the bar: the change is linear for shallow cuts only

local trim_rules = {
  places = {type = "integer", default = 3, min = 1},
  width = {type = "number", above = 0},
}

-- The outline as one polygon per loop with corners about `spacing` apart.
local function polygonal(outline, spacing)
  local loops = {}
  for k = 1, #outline.loops do
    local loop, list = outline.loops[k], {}
    for edge = loop.first, loop.first + loop.count - 1 do
      local length, last = 0, outline:at(edge, 0)
      for i = 1, 16 do
        local at = outline:at(edge, i / 16)
        length = length + math.sqrt((at[1] - last[1]) ^ 2 + (at[2] - last[2]) ^ 2)
        last = at
      end
      local parts = math.max(1, math.ceil(length / spacing))
      for i = 0, parts - 1 do list[#list + 1] = outline:at(edge, i / parts) end
    end
    loops[k] = list
  end
  return loops
end

-- The loops of the outline, the same nesting, as polygons.
local function outline_of(loops)
  local opts = {points = loops[1], holes = {}}
  for k = 2, #loops do opts.holes[k - 1] = loops[k] end
  return outlines(opts)
end

--- Where to take material off a bar that was made and sounds at `measured` instead of `target`: places on
--- the edge, best first, {at = {x, y}, depth = m, cents = what it brings, per_mm = cents per mm}. Each
--- place alone, over `width` (default: a tenth of the perimeter), would do as far as a change that
--- small is linear; the model's own mistuning is taken out by the ratio of measured to computed. A cut is at most
--- half as deep as the bar is wide there: where more is needed, the place is left out.
function bar:trim(measured, target, given)
  if type(measured) ~= "number" or measured <= 0 then
    raise(("trim: a measured frequency above 0 Hz expected, got %s"):format(core.got(measured)))
  end
  local wanted = wanted_frequency("trim", target)
  local opts = options.read("trim", given, trim_rules)
  local needed = pitch.cents(wanted, measured)
  local width = opts.width or self.outline.perimeter / 10
  local loops = polygonal(self.outline, width / 4)
  local drawn, message, details = outline_of(loops)
  if not drawn then return nil, message, details end
  local polygonal_bar
  polygonal_bar, message, details = metallophone.new {outline = drawn, material = self.opts.material,
    thickness = self.opts.thickness, elements = self.element_count}
  if not polygonal_bar then return nil, message, details end
  local gradient = polygonal_bar:gradient():totable()
  local box = drawn.box
  local size = math.max(box.max[1] - box.min[1], box.max[2] - box.min[2])
  local across
  across, message, details = tune.widths(drawn, 1e-6 * size, 2 * size)
  if not across then return nil, message, details end
  local points, places = drawn.points:totable(), {}
  local most, where = 0, nil -- the largest change by one cut
  for _, ring in ipairs(tune.rings(drawn)) do
    local n = #ring
    local inward = {}
    for i = 1, n do
      local a, b = points[ring[(i - 2) % n + 1]], points[ring[i % n + 1]]
      local tx, ty = b[1] - a[1], b[2] - a[2]
      local length = math.sqrt(tx * tx + ty * ty)
      -- loops run with the material on their left
      inward[i] = {-ty / length, tx / length}
    end
    for i = 1, n do
      local change, here = 0, points[ring[i]]
      for j = 1, n do
        local at = points[ring[j]]
        local d = math.sqrt((at[1] - here[1]) ^ 2 + (at[2] - here[2]) ^ 2)
        if d < width / 2 then
          local part = 0.5 * (1 + math.cos(2 * math.pi * d / width))
          local g = gradient[ring[j]]
          change = change + part * (g[1] * inward[j][1] + g[2] * inward[j][2])
        end
      end
      local per_m = 1200 / math.log(2) * change / polygonal_bar.frequency
      local reached = MAX_CUT * across[ring[i]] * math.abs(per_m)
      if per_m * needed > 0 and reached > most then most, where = reached, here end
      if per_m * needed > 0 and reached >= math.abs(needed) then
        places[#places + 1] = {at = {here[1], here[2]}, depth = needed / per_m, cents = needed,
          per_mm = per_m / 1000}
      end
    end
  end
  table.sort(places, function(a, b) return a.depth < b.depth end)
  -- the best ones that are apart
  local chosen = {}
  for _, place in ipairs(places) do
    local apart = true
    for _, other in ipairs(chosen) do
      local d = math.sqrt((place.at[1] - other.at[1]) ^ 2 + (place.at[2] - other.at[2]) ^ 2)
      apart = apart and d >= width
    end
    if apart and #chosen < opts.places then chosen[#chosen + 1] = place end
  end
  if #chosen == 0 then
    local reason = "no cut changes the tone in that direction"
    if where then
      reason = ("the largest change by one cut of at most half the width is %.1f cents, at (%.1f, %.1f) mm; trim "
        .. "towards a nearer tone, or make another bar"):format(most, 1e3 * where[1], 1e3 * where[2])
    end
    return nil, ("trim: no cut changes the tone by %+.1f cents: %s"):format(needed, reason),
      {status = "infeasible"}
  end
  return chosen
end

--- A bar from {outline, material, thickness}; options modes, tolerance, elements, size, follow.
function metallophone.new(given)
  local opts = options.read("metallophone", given, rules)
  followed.one_size("metallophone", opts)
  local box = opts.outline.box
  local size = math.max(box.max[1] - box.min[1], box.max[2] - box.min[2])
  if opts.thickness > size or opts.thickness < 1e-6 * size then
    return nil, ("a thickness of %g m for an outline %g m long: a bar is thinner than long, and at least a "
      .. "millionth of its length thick"):format(opts.thickness, size), {status = "geometry"}
  end
  return followed.object(bar, opts, core.plate.create(opts.outline,
    {size = opts.size, elements = opts.elements or (not opts.size and 400 or nil)}, opts.follow,
    opts.material, opts.thickness))
end

arguments.methods("metallophone bar", bar, bar, {drag = "handle: any, by: any", become = "outline: any",
  solve = "",
  gradient = "mode?: integer", mode = "mode?: integer", inplane = "count?: integer", spectrum = "", holes = "",
    tone = "options?: options",
  gains = "options?: options", write_tone = "path: string, options?: options",
  tune = "target: number|string, options?: options",
    trim = "measured: any, target: number|string, options?: options"})

return metallophone
