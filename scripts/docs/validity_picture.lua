-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes docs/images/validity_*.svg: a picture for each assumption of docs/validity.md. Curves are computed, the
-- intervals are those of docs/benchmarks.md, and the bodies of the loads are sketches.
local bw = require "barwright"
local script = require "barwright.command.script"
local root = arg[0]:match "^(.*)/scripts/" or "."

local opts = script.read {
  summary = "docs/images/validity_*.svg: a picture for each assumption of docs/validity.md",
  arguments = {{name = "out", type = "folder", optional = true, default = root .. "/docs/images",
    what = "the folder of the pictures"}},
}

local INK, SOFT, BLUE, RED, GREEN, FILL = "#1c2430", "#7a8696", "#1f77b4", "#c0392b", "#2e7d32", "#dfe7f0"

local function drawing(width, height, name)
  return bw.canvas(width, height, {name = name}):rectangle(0, 0, width, height, {fill = "#ffffff"})
end

local function write(canvas, name)
  assert(canvas:write(("%s/validity_%s.svg"):format(opts.out, name)))
end

local function text(canvas, words, x, y, options)
  options = options or {}
  canvas:text(words, x, y, {size = options.size or 13, align = options.align or 0, colour = options.colour or INK,
    bold = options.bold, angle = options.angle})
end

local function arrow(canvas, x0, y0, x1, y1, colour)
  local size = math.sqrt((x1 - x0) ^ 2 + (y1 - y0) ^ 2)
  local u, v = (x1 - x0) / size, (y1 - y0) / size
  canvas:line({x0, y0, x1 - 6 * u, y1 - 6 * v}, {stroke = colour or INK, width = 2})
  canvas:polygon({x1, y1, x1 - 9 * u - 4 * v, y1 - 9 * v + 4 * u, x1 - 9 * u + 4 * v, y1 - 9 * v - 4 * u},
    {fill = colour or INK})
end

-- A frame with axes: x and y map values to pixels.
local function frame(canvas, box, x_axis, y_axis)
  local self = {}
  function self.x(value) return box[1] + box[3] * (value - x_axis.min) / (x_axis.max - x_axis.min) end
  function self.y(value) return box[2] + box[4] * (1 - (value - y_axis.min) / (y_axis.max - y_axis.min)) end
  for _, value in ipairs(x_axis.at) do
    canvas:line({self.x(value), box[2], self.x(value), box[2] + box[4]}, {stroke = "#e6eaf0"})
    text(canvas, ("%g"):format(value), self.x(value), box[2] + box[4] + 17, {align = 0.5, size = 12})
  end
  for _, value in ipairs(y_axis.at) do
    canvas:line({box[1], self.y(value), box[1] + box[3], self.y(value)}, {stroke = "#e6eaf0"})
    text(canvas, ("%g"):format(value), box[1] - 7, self.y(value) + 4, {align = 1, size = 12})
  end
  canvas:line({box[1], box[2], box[1], box[2] + box[4], box[1] + box[3], box[2] + box[4]}, {stroke = INK})
  text(canvas, x_axis.name, box[1] + box[3] / 2, box[2] + box[4] + 38, {align = 0.5})
  text(canvas, y_axis.name, box[1] - 42, box[2] + box[4] / 2, {align = 0.5, angle = 90})
  function self.curve(points, pen)
    local flat = {}
    for i, p in ipairs(points) do flat[2 * i - 1], flat[2 * i] = self.x(p[1]), self.y(p[2]) end
    canvas:line(flat, pen)
  end
  return self
end

-- ---- small deformation ---------------------------------------------------------------------------------

-- The deflection of the tip over the length of a cantilever by its end load a = P L^2 / (E I): the elastica by
-- shooting on the curvature at the wall, with the midpoint rule.
local function deflection(a)
  local function shoot(curvature)
    local steps, angle, height = 400, 0, 0
    local h = 1 / steps
    for _ = 1, steps do
      local mid_angle = angle + h / 2 * curvature
      local mid_curvature = curvature - h / 2 * a * math.cos(angle)
      height = height + h * math.sin(mid_angle)
      angle, curvature = angle + h * mid_curvature, curvature - h * a * math.cos(mid_angle)
    end
    return curvature, height
  end
  local min, max = 0, a
  for _ = 1, 60 do -- bisection
    local midpoint = (min + max) / 2
    if shoot(midpoint) < 0 then min = midpoint else max = midpoint end
  end
  return select(2, shoot((min + max) / 2))
end

do
  local canvas = drawing(560, 320, "deflection of a cantilever by linear theory and by large-deflection theory")
  local f = frame(canvas, {70, 20, 460, 240}, {min = 0, max = 3, at = {0, 1, 2, 3}, name = "load P L² / (E I)"},
    {min = 0, max = 1, at = {0, 0.2, 0.4, 0.6, 0.8, 1}, name = "deflection / length"})
  canvas:rectangle(f.x(0), f.y(0.1), 460, f.y(0) - f.y(0.1), {fill = "#2e7d3222"})
  local exact = {}
  for i = 0, 30 do exact[i + 1] = {i / 10, i == 0 and 0 or deflection(i / 10)} end
  f.curve({{0, 0}, {3, 1}}, {stroke = BLUE, width = 2.5})
  f.curve(exact, {stroke = RED, width = 2.5})
  text(canvas, "linear theory", f.x(1.1), f.y(0.62), {colour = BLUE, bold = true})
  text(canvas, "large deflection", f.x(2.05), f.y(0.4), {colour = RED, bold = true})
  text(canvas, "up to a tenth of the length", f.x(0.4), f.y(0.035), {colour = GREEN})
  write(canvas, "deformation")
end

-- ---- failure -------------------------------------------------------------------------------------------

do
  local canvas = drawing(560, 340, "what fails in plane stress: largest principal stress and von Mises stress")
  local axis = {min = -1.5, max = 1.5, at = {-1, 0, 1}}
  axis.name = "first principal stress / strength"
  local f = frame(canvas, {80, 20, 260, 260}, axis, {min = -1.5, max = 1.5, at = {-1, 0, 1},
    name = "second / strength"})
  local ellipse = {}
  for i = 0, 120 do
    local t = 2 * math.pi * i / 120
    local u, v = math.sqrt(2) * math.cos(t), math.sqrt(2 / 3) * math.sin(t)
    ellipse[i + 1] = {(u - v) / math.sqrt(2), (u + v) / math.sqrt(2)}
  end
  f.curve(ellipse, {stroke = BLUE, width = 2.5})
  f.curve({{1, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}, {stroke = RED, width = 2.5})
  text(canvas, "von Mises:", 370, 70, {colour = BLUE, bold = true})
  text(canvas, "metals yield", 370, 90)
  text(canvas, "largest principal:", 370, 130, {colour = RED, bold = true})
  text(canvas, "brittle and printed", 370, 150)
  text(canvas, "materials crack; in", 370, 170)
  text(canvas, "compression the same", 370, 190)
  text(canvas, "strength is taken", 370, 210)
  write(canvas, "failure")
end

-- ---- the mean over a patch -----------------------------------------------------------------------------

do
  local canvas = drawing(560, 320, "stress near a re-entrant edge of 90 degrees, and its mean over a patch")
  local f = frame(canvas, {70, 20, 460, 240}, {min = 0, max = 3, at = {0, 1, 2, 3},
    name = "distance from the edge / radius of the patch"},
    {min = 0, max = 6, at = {0, 1, 2, 3, 4, 5, 6}, name = "stress"})
  local exponent, curve = 0.54448373678246 - 1, {} -- Williams, symmetric mode
  for i = 1, 300 do
    local r = 3 * (i / 300) ^ 2
    if r ^ exponent < 6 then curve[#curve + 1] = {r, r ^ exponent} end
  end
  -- over half a disc of radius 1 beside the edge, with the midpoint rule in x = t^2
  local sum, area = 0, 0
  for i = 1, 4000 do
    local t = (i - 0.5) / 4000
    local weight = math.sqrt(1 - t ^ 4) * 2 * t
    sum, area = sum + weight * t ^ (2 * exponent), area + weight
  end
  f.curve(curve, {stroke = RED, width = 2.5})
  f.curve({{0, sum / area}, {1, sum / area}}, {stroke = BLUE, width = 3})
  f.curve({{1, 0}, {1, sum / area}}, {stroke = BLUE, dash = {5, 4}})
  text(canvas, "linear elasticity: no finite value at the edge", f.x(0.14), f.y(5.3), {colour = RED, bold = true})
  text(canvas, "mean over the patch", f.x(1.08), f.y(sum / area) + 4, {colour = BLUE, bold = true})
  write(canvas, "mean")
end

-- ---- loads ---------------------------------------------------------------------------------------------

-- A body as a sketch: an ellipse with its top at y.
local function body(canvas, x, y, rx, ry)
  local points = {}
  for i = 0, 60 do
    local t = 2 * math.pi * i / 60
    points[2 * i + 1], points[2 * i + 2] = x + rx * math.cos(t), y + ry * math.sin(t)
  end
  canvas:polygon(points, {fill = FILL, stroke = INK, width = 1.5})
end

-- The point of the ellipse at an angle (degrees, counterclockwise) and its outward normal.
local function at(x, y, rx, ry, degrees)
  local t = math.rad(degrees)
  local u, v = math.cos(t) / rx, -math.sin(t) / ry
  local size = math.sqrt(u * u + v * v)
  return x + rx * math.cos(t), y - ry * math.sin(t), u / size, v / size
end

local function push(canvas, x, y, rx, ry, degrees, length, tilt, colour)
  local px, py, u, v = at(x, y, rx, ry, degrees)
  local t = math.rad(tilt or 0)
  local a, b = u * math.cos(t) - v * math.sin(t), u * math.sin(t) + v * math.cos(t)
  arrow(canvas, px + length * a, py + length * b, px + a, py + b, colour)
end

do
  local canvas = drawing(880, 560, "which loads are searched: four sketches")
  local rx, ry = 120, 60
  local function panel(k, title, words)
    local x, y = 220 + 440 * ((k - 1) % 2), 150 + 280 * ((k - 1) // 2)
    text(canvas, title, x, y - 122, {align = 0.5, bold = true, size = 15})
    body(canvas, x, y, rx, ry)
    for i, line in ipairs(words) do text(canvas, line, x, y + 96 + 17 * (i - 1), {align = 0.5, colour = SOFT}) end
    return x, y
  end
  local x, y = panel(1, "pressure on a contact area", {"on at least the contact area, balanced by inertia (grey)"})
  for _, degrees in ipairs {70, 77, 84, 91} do push(canvas, x, y, rx, ry, degrees, 48, 0, RED) end
  for _, dx in ipairs {-80, -40, 0, 40, 80} do arrow(canvas, x + dx, y + 22, x + dx, y - 4, SOFT) end

  x, y = panel(2, "supports and forbidden places", {"supports balance the load; nothing presses on",
    "forbidden places (green)"})
  for _, degrees in ipairs {112, 119, 126, 133} do push(canvas, x, y, rx, ry, degrees, 48, 0, RED) end
  local lines = {}
  for degrees = 235, 305, 5 do
    local px, py, u, v = at(x, y, rx, ry, degrees)
    canvas:line({px, py, px + 9 * u - 5, py + 9 * v}, {stroke = INK})
    lines[#lines + 1], lines[#lines + 2] = px, py
  end
  canvas:line(lines, {stroke = INK, width = 3.5})
  lines = {}
  for degrees = 20, 80, 5 do
    local px, py = at(x, y, rx, ry, degrees)
    lines[#lines + 1], lines[#lines + 2] = px, py
  end
  canvas:line(lines, {stroke = GREEN, width = 6})

  x, y = panel(3, "--friction", {"shear up to the coefficient of friction times the pressure"})
  local px, py, u, v = at(x, y, rx, ry, 90)
  for _, tilt in ipairs {-20, 20} do
    local t = math.rad(tilt)
    canvas:line({px, py, px + 62 * (u * math.cos(t) - v * math.sin(t)), py + 62 * (u * math.sin(t)
      + v * math.cos(t))}, {stroke = SOFT, dash = {5, 4}})
  end
  for _, one in ipairs {{84, 12}, {90, 20}, {96, 5}} do push(canvas, x, y, rx, ry, one[1], 48, one[2], RED) end

  x, y = panel(4, "--hands 2", {"pressure within few patches at once"})
  for _, angle in ipairs {55, 200} do
    local patch = {}
    for degrees = angle - 13, angle + 13, 2 do
      local qx, qy = at(x, y, rx, ry, degrees)
      patch[#patch + 1], patch[#patch + 2] = qx, qy
    end
    canvas:line(patch, {stroke = RED, width = 6})
    for d = -10, 10, 10 do push(canvas, x, y, rx, ry, angle + d, 46, 0, RED) end
  end
  write(canvas, "loads")
end

-- ---- intervals -----------------------------------------------------------------------------------------

do
  -- docs/benchmarks.md: {lower end, force, upper end} from 2,500, 5,000 and 10,000 elements, and the force of the
  -- finest mesh.
  local models = {
    {"cat", 66.86, {64.44, 67.16, 70.32}, {63.15, 66.64, 69.78}, {62.69, 66.01, 69.12}},
    {"chair", 1018, {957.2, 998, 1228}, {870.3, 1005, 1236}, {918.9, 999.2, 1228}},
    {"screwdriver", 21.93, {21.03, 21.94, 22.98}, {16.82, 21.98, 23.01}, {21, 21.84, 22.87}},
    {"bottle opener", 77.13, {67.32, 79.61, 93.54}, {69.26, 79.96, 93.95}, {71.02, 79.98, 93.98}},
    {"tray", 6.784, {6.251, 7.775, 8.141}, {6.375, 7.511, 7.865}, {6.554, 7.409, 7.758}},
  }
  local canvas = drawing(620, 330,
    "intervals of five breaking forces from three meshes, over the force of a much finer mesh")
  local f = frame(canvas, {70, 20, 530, 240},
    {min = 0, max = 5, at = {}, name = "from 2,500, 5,000 and 10,000 elements"},
    {min = 0.7, max = 1.3, at = {0.7, 0.8, 0.9, 1, 1.1, 1.2, 1.3}, name = "force / finest mesh"})
  f.curve({{0, 1}, {5, 1}}, {stroke = RED, width = 2})
  for i, model in ipairs(models) do
    text(canvas, model[1], f.x(i - 0.5), f.y(0.7) + 17, {align = 0.5, size = 12})
    for k = 1, 3 do
      local x, low, force, high = f.x(i - 0.8 + 0.15 * k), table.unpack(model[k + 2])
      local truth = model[2]
      canvas:line({x, f.y(low / truth), x, f.y(high / truth)}, {stroke = BLUE, width = 4})
      canvas:markers("disc", 9, {x, f.y(force / truth)}, {fill = INK})
    end
  end
  write(canvas, "intervals")
end

-- ---- the material --------------------------------------------------------------------------------------

do
  local canvas = drawing(560, 320, "Young's moduli of two printed materials by direction, with their scatter")
  local f = frame(canvas, {70, 20, 460, 240}, {min = 0, max = 6, at = {}, name = "direction of the print"},
    {min = 0, max = 1.5, at = {0, 0.5, 1, 1.5}, name = "Young's modulus, GPa"})
  local place = 0
  for _, name in ipairs {"zp150", "nylon_pa2200"} do
    for direction = 1, 3 do
      local source = bw.material[name].sources["young_" .. direction]
      place = place + 1
      local x, value, scatter = place - 0.5, source.mean / 1e9, (source.scatter or 0) / 1e9
      canvas:rectangle(f.x(x - 0.3), f.y(value), f.x(0.6) - f.x(0), f.y(0) - f.y(value), {fill = "#9ecae1"})
      if scatter > 0 then
        f.curve({{x, value - scatter}, {x, value + scatter}}, {stroke = INK, width = 2})
        for _, y in ipairs {value - scatter, value + scatter} do
          f.curve({{x - 0.1, y}, {x + 0.1, y}}, {stroke = INK, width = 2})
        end
      end
      text(canvas, ("%s %d"):format(name == "zp150" and name or "PA2200", direction), f.x(x), f.y(0) + 17,
        {align = 0.5, size = 12})
    end
  end
  text(canvas, "black: one standard deviation", f.x(2.4), f.y(1.38), {colour = SOFT})
  write(canvas, "material")
end
