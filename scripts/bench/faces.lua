-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Areas of faces on the boundary of filled meshes against those of the surface: the largest and the mean relative
-- difference over the planes and over the round faces (cylinders, cones, spheres) that hold at least 0.1 % of the
-- area.
local bw = require "barwright"

-- Chosen before any was measured.
local surfaces = {"gear_spur.stl", "tray_bottom.stl", "bottle_opener_round.stl", "anchor.off", "fandisk.obj",
  "engine_bracket.obj", "fan_blade.stl", "rocker_arm.obj", "screwdriver.ply", "triceratops.off"}

package.path = (arg[0]:match "^(.*)/" or ".") .. "/?.lua;" .. package.path
local options = require "options"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "areas of faces on the boundary of filled meshes against those of the surface",
  about = "Prints a Markdown table; seconds are processor seconds. The bodies are solids by formula and, with "
    .. "--models, surfaces of a folder.",
  options = {options.models, options.containing, options.each_of_elements {5000, 20000, 80000},
    {name = "order", value = "N", type = "integer", default = 1, min = 1, max = 2, what = "order of elements"}},
}

local pi, cos, sin = math.pi, math.cos, math.sin

local function arc(list, x, y, radius, from, to, count)
  for k = 0, count do
    local angle = from + (to - from) * k / count
    list[#list + 1] = {x + radius * cos(angle), y + radius * sin(angle)}
  end
  return list
end

local function ring(x, y, radius, count)
  local list = arc({}, x, y, radius, 0, 2 * pi, count)
  list[#list] = nil
  return list
end

-- A polygon and its holes from z = 0 to a height; millimetres.
local function extruded(outside, height, holes)
  local mesh = assert(bw.plane.fill(assert(bw.outline {points = outside, holes = holes}), {size = 1e3}))
  local flat, n = mesh.points:totable(), mesh.node_count
  local points, triangles = {}, {}
  for level = 0, 1 do
    for k, p in ipairs(flat) do points[n * level + k] = {p[1], p[2], level * height} end
  end
  for _, t in ipairs(mesh.elements:totable()) do
    triangles[#triangles + 1] = {t[1], t[3], t[2]}
    triangles[#triangles + 1] = {n + t[1], n + t[2], n + t[3]}
  end
  for _, s in ipairs(mesh.sides:totable()) do
    triangles[#triangles + 1] = {s[1], s[2], n + s[2]}
    triangles[#triangles + 1] = {s[1], n + s[2], n + s[1]}
  end
  return assert(bw.surface.new {points = points, triangles = triangles}):scale(1e-3)
end

local solids = {
  {"plate with a hole", function()
    return extruded({{-50, -30}, {50, -30}, {50, 30}, {-50, 30}}, 10, {ring(0, 0, 10, 48)})
  end},
  {"bracket with a fillet", function()
    local list = {{0, 0}, {60, 0}, {60, 12}}
    arc(list, 20, 20, 8, -pi / 2, -pi, 12)
    list[#list + 1] = {12, 70}
    list[#list + 1] = {0, 70}
    return extruded(list, 25)
  end},
  {"flange", function()
    local holes = {ring(0, 0, 20, 48)}
    for k = 1, 6 do holes[#holes + 1] = ring(36 * cos(k * pi / 3), 36 * sin(k * pi / 3), 5, 24) end
    return extruded(ring(0, 0, 50, 72), 12, holes)
  end},
  {"stepped block", function()
    return extruded({{0, 0}, {40, 0}, {40, 8}, {25, 8}, {25, 30}, {31, 30}, {31, 36}, {9, 36}, {9, 30}, {15, 30},
      {15, 8}, {0, 8}}, 22)
  end},
  {"rod", function() return bw.surface.cylinder {axis = {0, 0, 0.05}, radius = 0.01, segments = 48} end},
  {"ball", function() return bw.surface.sphere {radius = 0.02, subdivisions = 4} end},
}

local function processor()
  local fields = {}
  for field in io.open "/proc/self/stat":read "a":match "%) (.*)":gmatch "%S+" do fields[#fields + 1] = field end
  return (tonumber(fields[12]) + tonumber(fields[13]) + tonumber(fields[14]) + tonumber(fields[15])) / 100
end

local function fraction(value) return value and ("%.1e"):format(value) or "" end

local function measure(name, surface, elements)
  local seconds = processor()
  local mesh, log = bw.mesh.fill(surface, {elements = elements, order = opts.order})
  if not mesh then
    print(("| %s | %d | %s |"):format(name, elements, log))
    return
  end
  seconds = processor() - seconds
  if opts.order == 2 then mesh = assert(mesh:curved(surface)) end
  local total, lost = surface.area, 0
  local groups = {plane = {n = 0, sum = 0}, round = {n = 0, sum = 0}}
  local own = surface:faces()
  for k, face in ipairs(mesh:faces(surface)) do
    local group = face.kind == "plane" and groups.plane or face.kind ~= "free form" and groups.round
    if group and own[k].area >= 1e-3 * total then
      local off = math.abs(face.area / own[k].area - 1)
      group.n, group.sum, group.max = group.n + 1, group.sum + off, math.max(group.max or 0, off)
    elseif group then
      lost = lost + 1
    end
  end
  local p, r, q = groups.plane, groups.round, mesh:quality()
  print(("| %s | %d | %d | %d | %s | %s | %d | %s | %s | %d | %.1f | %.1f |"):format(name, elements,
    mesh.element_count, p.n, fraction(p.max), fraction(p.max and p.sum / p.n), r.n, fraction(r.max),
    fraction(r.max and r.sum / r.n), lost, math.deg(q.dihedral_min), seconds))
end

print("| body | asked | elements | planes | largest | mean | round | largest | mean | smaller faces | least angle "
  .. "| s |")
print "|---|---|---|---|---|---|---|---|---|---|---|---|"
local function all(name, surface)
  for _, elements in ipairs(opts.elements) do measure(name, surface, elements) end
end
for _, solid in ipairs(solids) do
  if not opts.only or solid[1]:find(opts.only, 1, true) then all(solid[1], solid[2]()) end
end
for _, name in ipairs(opts.models and surfaces or {}) do
  if not opts.only or name:find(opts.only, 1, true) then
    local surface = assert(bw.surface.read(opts.models .. "/" .. name))
    if surface.volume < 0 then surface = surface:orient() end
    all(name, surface)
  end
end
