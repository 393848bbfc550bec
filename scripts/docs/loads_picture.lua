-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes docs/images/selections.png, supports.png and loads.png: what docs/loads_and_supports.md says, on one
-- bracket. Every displacement and stress in them is computed.
local bw = require "barwright"
local core = require "barwright.core"
local script = require "barwright.command.script"
local static_picture = require "barwright.command.static_picture"
local root = arg[0]:match "^(.*)/scripts/" or "."

local opts = script.read {
  summary = "docs/images/selections.png, supports.png and loads.png: what docs/loads_and_supports.md says",
  arguments = {{name = "out", type = "folder", optional = true, default = root .. "/docs/images",
    what = "the folder of the pictures"}},
}

local pi, mm = math.pi, 1e-3

local function arc(list, x, y, radius, from, to, count)
  for k = 0, count do
    local angle = from + (to - from) * k / count
    list[#list + 1] = {x + radius * math.cos(angle), y + radius * math.sin(angle)}
  end
  return list
end

-- An L in the plane x, z with a fillet and a hole through its foot, extruded along y; millimetres.
local function bracket()
  local outside = {{0, 0}, {60, 0}, {60, 12}}
  arc(outside, 20, 20, 8, -pi / 2, -pi, 10)
  outside[#outside + 1] = {12, 50}
  outside[#outside + 1] = {0, 50}
  local hole = arc({}, 44, 6, 3.5, 0, 2 * pi, 28)
  hole[#hole] = nil
  local flat = assert(bw.plane.fill(assert(bw.outline {points = outside, holes = {hole}}), {size = 1e3}))
  local corners, n, depth = flat.points:totable(), flat.node_count, 24
  local points, triangles = {}, {}
  for side = 0, 1 do
    for k, p in ipairs(corners) do points[n * side + k] = {p[1], (1 - side) * depth, p[2]} end
  end
  for _, t in ipairs(flat.elements:totable()) do
    triangles[#triangles + 1] = {t[1], t[3], t[2]}
    triangles[#triangles + 1] = {n + t[1], n + t[2], n + t[3]}
  end
  for _, s in ipairs(flat.sides:totable()) do
    triangles[#triangles + 1] = {s[1], s[2], n + s[2]}
    triangles[#triangles + 1] = {s[1], n + s[2], n + s[1]}
  end
  local surface = assert(bw.surface.new {points = points, triangles = triangles}):scale(mm)
  return surface.volume < 0 and surface:orient() or surface
end

local mesh = assert(bw.mesh.fill(bracket(), {elements = 8000, order = 2}))
local boundary = mesh.boundary

-- ---- selections ----------------------------------------------------------------------------------------

local WIDTH, HEIGHT, GREY, CHOSEN = 380, 300, {196, 202, 210}, {214, 39, 40}

-- Axes of a view {from the object to the viewer}: right, up, towards the viewer.
local function axes_of(direction)
  local function unit(v)
    local size = math.sqrt(v[1] ^ 2 + v[2] ^ 2 + v[3] ^ 2)
    return {v[1] / size, v[2] / size, v[3] / size}
  end
  local to = unit(direction)
  local right = unit {-to[2], to[1], 0}
  return right, {to[2] * right[3] - to[3] * right[2], to[3] * right[1] - to[1] * right[3],
    to[1] * right[2] - to[2] * right[1]}, to
end

local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end

-- The facets that face the viewer from the farthest to the nearest: {depth, number, light = brightness}.
local function visible(points, facets, right, up, to)
  local list = {}
  for number, f in ipairs(facets) do
    local a, b, c = points[f[1]], points[f[2]], points[f[3]]
    local u = {b[1] - a[1], b[2] - a[2], b[3] - a[3]}
    local v = {c[1] - a[1], c[2] - a[2], c[3] - a[3]}
    local n = {u[2] * v[3] - u[3] * v[2], u[3] * v[1] - u[1] * v[3], u[1] * v[2] - u[2] * v[1]}
    local size = math.sqrt(dot(n, n))
    if dot(n, to) > 0 then
      list[#list + 1] = {depth = dot(a, to) + dot(b, to) + dot(c, to), number = number,
        light = math.max(0, 0.75 * dot(n, to) + 0.35 * dot(n, up) - 0.25 * dot(n, right)) / size}
    end
  end
  table.sort(list, function(p, q)
    if p.depth ~= q.depth then return p.depth < q.depth end
    return p.number < q.number
  end)
  return list
end

-- A panel of a drawing with the facets of a selection in red.
local function draw(canvas, x0, y0, title, selection, direction)
  local points, facets, is_chosen = mesh.nodes:totable(), mesh.facets:totable(), {}
  for _, facet in ipairs(selection.facets:totable()) do is_chosen[facet] = true end
  local right, up, to = axes_of(direction)
  local min, max = {math.huge, math.huge}, {-math.huge, -math.huge}
  local function flat(p) return {dot(p, right), -dot(p, up)} end
  for _, p in ipairs(points) do
    for k, value in ipairs(flat(p)) do min[k], max[k] = math.min(min[k], value), math.max(max[k], value) end
  end
  local scale = math.min((WIDTH - 40) / (max[1] - min[1]), (HEIGHT - 60) / (max[2] - min[2]))
  local function place(p)
    local at = flat(p)
    return x0 + WIDTH / 2 + scale * (at[1] - (min[1] + max[1]) / 2),
      y0 + (HEIGHT - 24) / 2 + scale * (at[2] - (min[2] + max[2]) / 2)
  end
  for _, one in ipairs(visible(points, facets, right, up, to)) do
    local colour, rgb = is_chosen[one.number] and CHOSEN or GREY, {}
    for k = 1, 3 do rgb[k] = math.floor(math.min(255, colour[k] * (0.5 + 0.6 * one.light)) + 0.5) end
    local fill, corners = ("#%02x%02x%02x"):format(table.unpack(rgb)), {}
    for k = 1, 3 do
      corners[2 * k - 1], corners[2 * k] = place(points[facets[one.number][k]])
    end
    canvas:polygon(corners, {fill = fill, stroke = fill, width = 0.7})
  end
  canvas:text(title, x0 + WIDTH / 2, y0 + HEIGHT - 8, {size = 14, align = 0.5})
end

local above, below = {1, -1.5, 0.9}, {1, -1.5, -0.7}
local on = {
  {"boundary:below(\"z\", 0), seen from below", boundary:below("z", 0), below},
  {"boundary:box(min, max)", boundary:box({-1 * mm, -1 * mm, 30 * mm}, {13 * mm, 25 * mm, 51 * mm}), above},
  {"boundary:near(point, radius)", boundary:near({60 * mm, 12 * mm, 12 * mm}, 10 * mm), above},
  {"boundary:facing({0, 0, 1}, angle)", boundary:facing({0, 0, 1}, math.rad(20)), above},
  {"boundary:patch(point, angle)", boundary:patch({14.3 * mm, 12 * mm, 14.3 * mm}, math.rad(30)), above},
  {"boundary:face \"cylinder 1\"", boundary:face "cylinder 1", above},
}
local canvas = bw.canvas(3 * WIDTH, 2 * HEIGHT, {name = "six selections on the boundary of a bracket"})
canvas:rectangle(0, 0, 3 * WIDTH, 2 * HEIGHT, {fill = "#ffffff"})
for i, one in ipairs(on) do
  draw(canvas, (i - 1) % 3 * WIDTH, (i - 1) // 3 * HEIGHT, one[1], one[2], one[3])
end
assert(canvas:write(opts.out .. "/selections.png", {scale = 1}))

-- ---- supports ------------------------------------------------------------------------------------------

local folder <close> = assert(core.temporary_folder())
local pictures = {}

local function sheet(name)
  local made = bw.plot.contact_sheet {pictures = pictures, columns = 3, cell = 380, ratio = 0.78, lines = 2}
  assert(made:write(opts.out .. "/" .. name, {scale = 1}))
  pictures = {}
end

-- A solution with its supports outlined in violet and its loads as arrows.
local function solved(title, supports, load, arrows)
  local part, lines = bw.model {mesh = mesh, material = bw.material.pla}, {}
  for _, support in ipairs(supports) do
    local border = static_picture.border(support[2])
    table.move(border, 1, #border, #lines + 1, lines)
    part[support[1]](part, table.unpack(support, 2))
  end
  load(part)
  local static = assert(part:solve())
  local path = ("%s/%d.png"):format(folder.path, #pictures)
  assert(static:picture(path, {lines = lines, line_name = "border of the supports", arrows = arrows, ghost = true,
    direction = {1, -1.5, 0.9}, width = 640, height = 500}))
  pictures[#pictures + 1] = {path = path, caption = title}
end

local foot, wall, side = boundary:below("z", 0), boundary:below("x", 0), boundary:below("y", 0)
local top = boundary:above("z", 50 * mm)

solved("fix: the foot cannot move", {{"fix", foot}}, function(part) part:load {on = top, force = {30, 0, 0}} end,
  {{at = top.centre, force = {30, 0, 0}}})
solved("slide: foot, wall and front stay in their planes", {{"slide", foot, {0, 0, 1}}, {"slide", wall, {1, 0, 0}},
  {"slide", side, {0, 1, 0}}}, function(part) part:load {on = top, force = {0, 0, -200}} end,
  {{at = top.centre, force = {0, 0, -200}}})
solved("prescribe: the top moves by 1 mm along x", {{"fix", foot}, {"prescribe", top, {1 * mm, false, false}}},
  function() end)
sheet "supports.png"

-- ---- loads ---------------------------------------------------------------------------------------------

local arm, finish = boundary:face {near = {40 * mm, 12 * mm, 12 * mm}}, boundary:above("x", 60 * mm)

-- The same force at places that cover the arm.
local function arrows_on_arm(force)
  local out = {}
  for i = 0, 3 do
    for k = 0, 2 do out[#out + 1] = {at = {(25 + 10 * i) * mm, (4 + 8 * k) * mm, 12 * mm}, force = force} end
  end
  return out
end

local function loaded(title, load, arrows) solved(title, {{"fix", wall}}, load, arrows) end

loaded("force: 20 N in all", function(part) part:load {on = finish, force = {0, 0, -20}} end,
  {{at = finish.centre, force = {0, 0, -20}}})
loaded("pressure: normal to the surface", function(part) part:load {on = arm, pressure = 2e4} end,
  arrows_on_arm {0, 0, -2e4 * arm.area / 12})
loaded("traction: along any direction", function(part) part:load {on = arm, traction = {0, 5e4, 0}} end,
  arrows_on_arm {0, 5e4 * arm.area / 12, 0})
loaded("torque: 0.2 N m about x", function(part) part:load {on = finish, torque = {0.2, 0, 0}} end,
  {{at = {60 * mm, 24 * mm, 6 * mm}, force = {0, 0, 8.3}}, {at = {60 * mm, 0, 6 * mm}, force = {0, 0, -8.3}}})
local weight = 9.81 * mesh.volume * bw.material.pla.density
loaded("gravity: on the whole body", function(part) part:gravity {0, 0, -9.81} end,
  {{at = {35 * mm, 12 * mm, 12 * mm}, force = {0, 0, -weight}}})
loaded("temperature: 40 K warmer", function(part) part:temperature(40, 9e-5) end)
sheet "loads.png"
