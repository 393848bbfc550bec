-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Bridges (the paper *responsive*, section 5.2): a span, a load on its centre, a limit of stress, and the
-- smallest area that passes. Shapes are symmetric: what is fixed, meshed and moved is the right half, its
-- outline with the tags "foot", "pad", "middle" (the middle of the pad), "axis" and "free".
local arguments = require "barwright.arguments"
local core = require "barwright.core"
local form_of = require "barwright.free_form"
local members = require "barwright.members"
local mirror = require "barwright.mirror"
local options = require "barwright.options"
local picture = require "barwright.bridge_picture"
local shapes = require "barwright.outline_shapes"
local shape_design = require "barwright.shape_design"
local sheets = require "barwright.sheets"
local starts = require "barwright.bridge_starts"
local shown = require "barwright.shown"

local raise, quantity = core.raise, core.quantity

local rules = {
  span = {type = "number", needed = true, above = 0}, -- between the banks, m
  load = {type = "number", needed = true, above = 0}, -- N
  stress_limit = {type = "number", needed = true, above = 0}, -- von Mises, Pa
  material = {type = "any", needed = true},
  thickness = {type = "number", needed = true, above = 0},
  depth = {type = "number", above = 0}, -- of the load above the banks; span / 2
  bearing = {type = "number", above = 0}, -- how far a foot reaches onto its bank
  pad = {type = "number", above = 0}, -- width under the load
  wall = {type = "number", above = 0}, -- least width of any member; span / 50
  size = {type = "number", above = 0}, -- of elements; span / 100
  start = {type = "string", default = "gable"},
  outline = {type = "outline"}, -- a right half to begin with
}

local order_of_starts = {"truss", "gable", "beam", "arch"}
local known_starts = {"current", table.unpack(order_of_starts)}
local is_start = {}
for _, name in ipairs(known_starts) do is_start[name] = true end

local bridge, class = {}, {}

-- ---- the problem ---------------------------------------------------------------------------------

local function complete(opts)
  options.object("bridge", "material", opts.material, "material")
  -- width of a bar that carries the load at the limit
  local bar = opts.load / (opts.thickness * opts.stress_limit)
  opts.bar = bar
  opts.deck = opts.depth or opts.span / 2
  opts.bearing = opts.bearing or math.max(bar, opts.span / 25)
  opts.pad = opts.pad or math.max(2 * bar, opts.span / 12)
  opts.wall = opts.wall or opts.span / 50
  opts.size = opts.size or opts.span / 100
  opts.spacing = 2.2 * opts.size
  opts.middle = 0.02 * opts.pad
  opts.member = math.max(0.75 * bar, 1.5 * opts.wall)
  local pressed = opts.load / (opts.thickness * math.min(opts.pad, 2 * opts.bearing))
  if pressed > opts.stress_limit then
    raise(("bridge: %s on a pad of %s and two bearings of %s press with %s, more than the limit of %s: make "
      .. "them wider, or the bridge thicker"):format(quantity(opts.load, "N"), quantity(opts.pad, "m"),
      quantity(opts.bearing, "m"), quantity(pressed, "Pa"), quantity(opts.stress_limit, "Pa")))
  end
  if opts.pad >= opts.span then
    raise(("bridge: option 'pad': a pad shorter than the span of %s expected, got %s"):format(
      quantity(opts.span, "m"), quantity(opts.pad, "m")))
  end
  if opts.deck < 4 * opts.wall then
    raise(("bridge: a depth of at least four walls of %s expected, got %s"):format(
      quantity(opts.wall, "m"), quantity(opts.deck, "m")))
  end
  return opts
end

local function conditions_of(opts)
  return {axis = {x = 0}, middle = {y = 0},
    pad = {traction = {0, -opts.load / (opts.thickness * opts.pad)}},
    foot = {traction = {0, opts.load / (2 * opts.thickness * opts.bearing)}}}
end

local function problem_of(opts, more)
  local problem = {material = opts.material, thickness = opts.thickness, limit = opts.stress_limit,
    conditions = conditions_of(opts), wall = opts.wall, gap = 0.8 * opts.wall, size = opts.size,
    spacing = opts.spacing, box = {{0, 0}, {opts.span / 2 + opts.bearing, opts.deck}}, axis = true,
    smooth = 0.3, margin = 0.003, idle = 0.35, holes = 0}
  for name, value in pairs(more or {}) do problem[name] = value end
  return problem
end

-- ---- the object ----------------------------------------------------------------------------------

local properties = {
  outline = function(self) return rawget(self, "sheet").outline end,
  whole = function(self)
    local whole, message = mirror.outline(self.outline, "axis")
    return whole or raise(message)
  end,
  area = function(self) return 2 * self.outline.area end,
  stress_limit = function(self) return rawget(self, "opts").stress_limit end,
  utilisation = function(self) return self.von_mises:max() / self.stress_limit end,
  passes = function(self) return self.utilisation <= 1 end,
  options = function(self) return rawget(self, "opts") end,
}
for _, name in ipairs {"points", "elements", "von_mises", "stress", "displacement", "reused",
  "element_count", "node_count", "error_estimate"} do
  properties[name] = function(self) return rawget(self, "sheet")[name] end
end
class.__index = members("bridge", class, properties)
class.__name = "barwright.bridge"

function class:__tostring()
  return ("bridge of %s: %s, %s of %s: %s; %s"):format(quantity(self.options.span, "m"),
    quantity(self.area, "m2"), shown.percent(self.utilisation), quantity(self.stress_limit, "Pa"),
    self.passes and "passes" or "fails", tostring(self.reused))
end

-- Points that must stay, {number = "fixed" or "axis"}.
local function protected(outline)
  local kept = {}
  for n, segment in ipairs(outline.segments:totable()) do
    local tag = outline:edge(n).tag
    local how = tag == "axis" and "axis" or tag ~= "free" and "fixed"
    if how == "fixed" or how == "axis" then
      for _, k in ipairs {1, 4} do
        local point = segment[k]
        if kept[point] ~= "fixed" then kept[point] = how end
      end
    end
  end
  return kept
end

-- `wanted` with supports, pad and axis as they are in `outline`.
local function with_supports(outline, wanted)
  local now, points = outline.points, wanted.points:totable()
  for point, how in pairs(protected(outline)) do
    points[point][1] = now[point][1]
    if how == "fixed" then points[point][2] = now[point][2] end
  end
  return wanted:with_points(points)
end

local function same_place(a, b, span)
  return math.abs(a[1] - b[1]) + math.abs(a[2] - b[2]) <= 1e-9 * span
end

-- The edges that carry: where they have to be.
local function check_supports(opts, outline)
  local a, H = opts.span / 2, opts.deck
  local wanted = {foot = {{a, 0}, {a + opts.bearing, 0}}, pad = {{opts.pad / 2, H}, {opts.middle, H}},
    middle = {{opts.middle, H}, {0, H}}}
  local left = outline:measure().box.min[1]
  if left < -1e-9 * opts.span then
    return nil, ("the outline reaches x = %s, across the axis at x = 0 into its own image"):format(
      quantity(left, "m")),
      {status = "geometry", x = left}
  end
  local found = {}
  for n = 1, outline.edge_count do
    local edge = outline:edge(n)
    local ends = wanted[edge.tag]
    if ends then
      found[edge.tag] = same_place(edge.from, ends[1], opts.span) and same_place(edge.to, ends[2], opts.span)
    elseif edge.tag == "axis" then
      found.axis = edge.from[1] == 0 and edge.to[1] == 0
    end
  end
  for _, tag in ipairs {"foot", "pad", "middle", "axis"} do
    if not found[tag] then
      return nil, ("the edge '%s' of the bridge was moved: it has to stay in its place"):format(tag),
        {status = "geometry", tag = tag}
    end
  end
  return true
end

--- Becomes another right half. Feet, pad and axis are put back where only points have moved; another
--- topology must have them in their places. Refused (nil, message, details), it stays.
function class.become(self, outline)
  options.object("become", "outline", outline, "outline")
  local message, details
  if self.outline:same_topology(outline) then
    outline, message, details = with_supports(self.outline, outline)
    if not outline then return nil, message, details end
  end
  local ok
  ok, message, details = check_supports(self.opts, outline)
  if not ok then return nil, message, details end
  if self.sheet.outline:same_topology(outline) then
    ok, message, details = self.sheet:become(outline)
  else
    ok, message, details = sheets.steady {outline = outline, material = self.opts.material,
      thickness = self.opts.thickness, size = self.opts.size, order = 2,
      conditions = conditions_of(self.opts)}
    if ok then rawset(self, "sheet", ok) end
  end
  if not ok then return nil, message, details end
  rawset(self, "edited", true)
  return self
end

local function changed(self, outline, message, details)
  if not outline then return nil, message, details end
  return class.become(self, outline)
end

--- Moves a handle of the outline by {dx, dy}; feet and pad stay, and the axis on itself.
function class.drag(self, handle, by)
  return changed(self, self.outline:moved(handle, by))
end

--- Push-pin pulling of a curve: outline:pull.
function class.pull(self, vertex, to, how)
  return changed(self, self.outline:pull(vertex, to, how))
end

--- outline:smooth.
function class.smooth(self, how)
  return changed(self, self.outline:smooth(how))
end

--- A round hole at {x, y}; on the other half is its image.
function class.hole(self, centre, radius)
  local n, names = 1, {}
  for _, loop in ipairs(self.outline.loops) do names[loop.name] = true end
  while names["hole " .. n] do n = n + 1 end
  local name = "hole " .. n
  local circle, message, details = shapes.circle {centre = centre, radius = radius, name = name,
    tag = "free"}
  if not circle then return nil, message, details end
  return changed(self, self.outline:hole(circle))
end

--- Takes a hole away.
function class.without(self, loop)
  return changed(self, self.outline:without(loop))
end

--- Largest von Mises stress on another mesh: size of its elements, order.
function class.check(self, size, order)
  local sheet, message, details = shape_design.sheet(problem_of(self.opts), self.outline, size, order)
  if not sheet then return nil, message, details end
  return sheet.von_mises:max(), sheet.element_count
end

class.picture, class.body = picture.write, picture.body

-- ---- what it is compared with ----------------------------------------------------------------------

--- The lowest beam of one height that passes: height, area (of the whole).
function class.uniform_beam(self)
  local opts = self.opts
  local a, e, c, d = opts.span / 2, opts.span / 2 + opts.bearing, opts.pad / 2, opts.middle
  local problem = problem_of(opts)
  local function max(h)
    local outline = core.outline.make({{0, 0}, {a, 0}, {e, 0}, {e, h}, {c, h}, {d, h}, {0, h}},
      {{1, 0, 0, 2, 1}, {2, 0, 0, 3, 2}, {3, 0, 0, 4, 1}, {4, 0, 0, 5, 1}, {5, 0, 0, 6, 3},
      {6, 0, 0, 7, 4}, {7, 0, 0, 1, 5}}, {{count = 7, region = 1, name = "beam"}},
      {"free", "foot", "pad", "middle", "axis"})
    local sheet, message, details = shape_design.sheet(problem, outline, math.max(opts.size, h / 20))
    if not sheet then return nil, message, details end
    return sheet.von_mises:max()
  end
  local guess = math.sqrt(1.5 * opts.bar * opts.span)
  local low, high = 0.5 * guess, 2 * guess
  for _ = 1, 12 do
    local h = (low + high) / 2
    local stress, message, details = max(h)
    if not stress then return nil, message, details end
    if stress > opts.stress_limit then low = h else high = h end
  end
  return high, 2 * e * high
end

--- Michell's least area of bars for a force in the middle between two feet in an unlimited plane:
--- (1 + pi/2) F a / (t limit), a half the distance of the centres of the feet.
function class.michell_area(self)
  local opts = self.opts
  return (1 + math.pi / 2) * opts.bar * (opts.span + opts.bearing) / 2
end

-- ---- automatic design ----------------------------------------------------------------------------

local design_rules = {
  starts = {type = "table"}, -- the current outline where it was given or changed, else all of the others
  rounds = {type = "integer", default = 120, min = 1},
  holes = {type = "integer", default = 6, min = 0}, -- in the half, besides one across the axis
  polish = {type = "integer", default = 40, min = 0},
  report = {type = "function"}, -- of {start, round, rounds, area, utilisation, passes, outline}
}

-- `stop` gets message and details where the progress function asks to stop.
local function reported(self, opts, name, first, count, report_total, stop)
  return function(round, here, best)
    local fraction = (first + round / count) / report_total
    stop.message, stop.details = select(2, core.report_progress(("bridge: %s, %s"):format(name,
      quantity(2 * best.area, "m2")), math.min(fraction, 1)))
    if stop.message or core.interrupted() then return false end
    if opts.report then
      return opts.report {start = name, round = round, rounds = count, area = 2 * here.area,
        utilisation = here.max / self.opts.stress_limit, best_area = 2 * best.area,
        passes = best.passes, outline = here.outline}
    end
  end
end

-- Makes a shape the bridge's, and checks it on every mesh that answers are given for: the bridge's own and,
-- where the shape was polished, one finer than that.
local function check_meshes(self, found, polish)
  local ok, message, details = class.become(self, (found.form:outline()))
  if not ok then return nil, message, details end
  found.worst = self.sheet.von_mises:max()
  if polish then
    local sheet
    sheet, message, details = shape_design.sheet(problem_of(self.opts), self.outline, 0.4 * self.opts.size)
    if not sheet then return nil, message, details end
    found.checked, found.checked_elements = sheet.von_mises:max(), sheet.element_count
    found.worst = math.max(found.worst, found.checked)
  end
  return found
end

-- The best of the starts again, on finer meshes where it is polished, until it passes wherever it is checked.
-- One that failed before is not tried again without that.
local function settled(self, opts, best, report)
  local polish = opts.polish > 0 and not core.interrupted()
  local margin, found = polish and 0.004 or 0.003, best
  local message, details
  if not polish then
    found, message, details = check_meshes(self, best, false)
    if not found or not best.passes then return found, message, details end
  end
  for _ = 1, 4 do
    if found.worst then
      if found.worst <= self.opts.stress_limit or core.interrupted() then break end
      margin = margin + math.log(found.worst / self.opts.stress_limit) + 0.002
    end
    local problem = problem_of(self.opts, {size = (polish and 0.6 or 1) * self.opts.size,
      rounds = polish and opts.polish or 10, margin = margin, polish = true})
    local start = found
    found, message, details = shape_design.search(problem, start.form:copy(), report)
    if found then found, message, details = check_meshes(self, found, polish) end
    if not found then return nil, message, details end
    if not polish then found.falling, found.converged = best.falling, best.converged end
  end
  return found
end

--- Bending moment in the middle over what the whole depth carries there with all of it at the limit, half in
--- tension and half in compression: limit thickness depth^2 / 4. A stress along the bridge can pass the limit
--- of von Mises by 2 / sqrt(3) where another across it helps, so that above 1.155 there is no shape. A solid
--- beam reaches 2 / 3, since its stress falls towards the middle of its height.
function class.moment_fraction(self)
  local opts = self.opts
  local moment = opts.load / 4 * (opts.span + opts.bearing - opts.pad / 2)
  return 4 * moment / (opts.stress_limit * opts.thickness * opts.deck ^ 2)
end

-- Stress goes as load over thickness: what the shape carries, and which thickness would do.
local function failing(self, utilisation)
  local opts = self.opts
  return ("no shape was found that passes: the best is stressed to %s of the limit. It carries %s, or "
    .. "%s with a thickness of %s. The bending moment in the middle is %.2f of what the depth can carry "
    .. "(a solid beam carries 0.67)"):format(shown.percent(utilisation), quantity(opts.load / utilisation, "N"),
    quantity(opts.load, "N"), quantity(opts.thickness * utilisation, "m"), self:moment_fraction())
end

-- The form to begin with; holes that were put in by hand stay in it. nil and why where they do not fit.
local function form_of_start(self, name, kept)
  local form = starts[name](self.opts, self.outline, self.designed)
  if #kept == 0 then return form end
  form = form_of.create(table.move(kept, 1, #kept, #form.loops + 1,
    table.move(form.loops, 1, #form.loops, 1, {})))
  local ok, message = form:outline()
  if ok then return form end
  return nil, ("the holes that were put in by hand do not fit the start '%s': %s. Remove them with "
    .. "bridge:without, or start from 'current'"):format(name, message)
end

-- The names of the holes that a design made, which the next one may move.
local function note_designed(self, kept)
  local by_hand, designed = {}, {}
  for _, loop in ipairs(kept) do by_hand[loop.name] = true end
  for _, loop in ipairs(self.outline.loops) do designed[loop.name] = not by_hand[loop.name] or nil end
  rawset(self, "designed", designed)
end

-- What to say of the end of a search; nil: nothing.
local function warning_of(self, last, max)
  if max > 1 then return failing(self, max) end
  if last.converged then return nil end
  if not last.falling then return "the search has not converged: more rounds are needed" end
  return ("the search has not converged: the area fell by %s in the last %d rounds; more rounds are "
    .. "needed"):format(shown.percent(last.falling), last.falling_rounds)
end

--- Finds the shape of least area that passes, from the current outline or several starts, and becomes it; holes
--- that were put in by hand stay. Where none was found that passes, the one of the least stress, and a
--- `message`; where there is none, nil and why.
function class.design(self, given)
  local opts = options.read("design", given, design_rules)
  local fraction = self:moment_fraction()
  if fraction > 2 / math.sqrt(3) then
    return nil, ("no bridge of this depth can pass: the bending moment in the middle is %.2f times the one of a "
      .. "section %s deep with the stress limit everywhere. At least %s of depth, or %s of "
      .. "thickness, or less load is needed")
      :format(fraction, quantity(self.opts.deck, "m"),
        quantity(self.opts.deck * math.sqrt(fraction * math.sqrt(3) / 2), "m"),
        quantity(self.opts.thickness * fraction * math.sqrt(3) / 2, "m")),
      {status = "infeasible", moment_fraction = fraction}
  end
  local results, stop, best = {}, {}, nil
  opts.starts = opts.starts or self.edited and {"current"} or order_of_starts
  local kept = starts.kept_holes(self.outline, self.designed)
  local total = #opts.starts + 1
  for i, name in ipairs(opts.starts) do
    if type(name) ~= "string" or not is_start[name] then
      raise(("design: start '%s' is not known: %s"):format(tostring(name),
        core.suggestion(tostring(name), known_starts)))
    end
    local problem = problem_of(self.opts, {holes = opts.holes, rounds = opts.rounds})
    local form, message = form_of_start(self, name, kept)
    local found
    if form then
      found, message = shape_design.search(problem, form,
        reported(self, opts, name, i - 1, opts.rounds, total, stop))
    end
    if stop.message then return nil, stop.message, stop.details end
    if found then
      results[i] = {start = name, area = 2 * found.area, utilisation = found.max / self.opts.stress_limit,
        passes = found.passes and found.max <= self.opts.stress_limit, converged = found.converged,
        rounds = found.rounds, history = found.history}
      found.start = name
      if not best or found.passes and (not best.passes or found.area < best.area)
        or not found.passes and not best.passes and found.max < best.max then
        best = found
      end
    else
      results[i] = {start = name, message = message, passes = false}
    end
    if core.interrupted() then break end
  end
  if not best then
    return nil, ("no start could be analysed: %s"):format(results[1] and results[1].message or ""),
      {status = "infeasible"}
  end
  local last, message, details = settled(self, opts, best, reported(self, opts, best.start, total - 1,
    math.max(opts.polish, 10), total, stop))
  if stop.message then return nil, stop.message, stop.details end
  if not last then return nil, message, details end
  note_designed(self, kept)
  local max = last.worst / self.opts.stress_limit
  return {starts = results, start = best.start, area = self.area, utilisation = self.utilisation,
    checked_utilisation = last.checked and last.checked / self.opts.stress_limit,
    checked_elements = last.checked_elements, interrupted = core.interrupted(), passes = max <= 1,
    converged = last.converged, message = warning_of(self, last, max)}
end

-- ---- making --------------------------------------------------------------------------------------

--- A bridge from {span, load, stress_limit, material, thickness, depth, bearing, pad, wall, size, start,
--- outline}.
function bridge.create(given)
  local opts = complete(options.read("bridge", given, rules))
  local outline, message, details = opts.outline
  if outline then
    local ok
    ok, message, details = check_supports(opts, outline)
    if not ok then return nil, message, details end
  else
    if not is_start[opts.start] or opts.start == "current" then
      raise(("bridge: start '%s' is not known: %s"):format(opts.start,
        core.suggestion(opts.start, order_of_starts)))
    end
    outline, message, details = starts[opts.start](opts):outline()
    if not outline then return nil, message, details end
  end
  local sheet
  sheet, message, details = shape_design.sheet(problem_of(opts), outline, opts.size)
  if not sheet then return nil, message, details end
  return setmetatable({sheet = sheet, opts = opts, edited = opts.outline ~= nil, designed = {}}, class)
end

arguments.methods("bridge", class, class, {become = "outline: any", drag = "handle: table, by: pair",
  pull = "vertex: integer, to: pair, how?: options", smooth = "how?: options",
    hole = "centre: pair, radius: number",
  without = "loop: string|integer", check = "size: number, order?: integer", uniform_beam = "", michell_area = "",
  moment_fraction = "", design = "options?: options", picture = "path: string", body = ""})

bridge.class, bridge.properties = class, properties

return bridge
