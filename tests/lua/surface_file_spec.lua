-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Surface files with colours and fields: glTF, USD, PLY, OBJ, 3MF; by VTK, meshio, assimp where installed.
local bw = require "barwright"
local check = require "check"

local PYTHON = "/usr/bin/python3"

local function run(command)
  local pipe = assert(io.popen(command .. " 2>/dev/null"))
  local text = pipe:read "a"
  local _, _, status = pipe:close()
  return status == 0 and text or nil
end

-- What a Python program prints; nil where a module that it needs is not installed.
local function python(folder, modules, text)
  local file = assert(io.open(folder .. "/p.py", "w"))
  file:write(text)
  file:close()
  if not run(("%s -c 'import %s'"):format(PYTHON, modules)) then return nil end
  return assert(run(("cd %s && %s -W ignore p.py"):format(folder, PYTHON)), "the Python program fails")
end

-- The bytes that an sRGB colour has, of linear light.
local function srgb(light)
  return 255 * (light <= 0.0031308 and 12.92 * light or 1.055 * light ^ (1 / 2.4) - 0.055)
end

describe("surface files with colours", function()
  local folder
  local ball = bw.surface.sphere {radius = 0.01, subdivisions = 3, centre = {0.1, 0.2, 0.3}}
  local height = ball.points:column(3)
  before_each(function()
    folder = os.tmpname()
    os.remove(folder)
    assert(os.execute("mkdir " .. folder))
  end)
  after_each(function() os.execute("rm -r " .. folder) end)

  it("come back with their points, facets and unit", function()
    local numbers = {}
    for i = 1, ball.triangle_count do numbers[i] = {i} end
    for _, ending in ipairs {"glb", "ply", "obj", "3mf"} do
      for _, values in ipairs {height, ending ~= "obj" and bw.array.new(numbers) or nil} do
        local path = folder .. "/a." .. ending
        assert(ball:write(path, {values = values}))
        local back, info = assert(bw.surface.read(path))
        assert.equal(ball.point_count, back.point_count)
        assert.equal(ball.triangle_count, back.triangle_count)
        assert.near(ball.volume, back.volume, 1e-6 * ball.volume)
        for k = 1, 3 do assert.near(ball.box.max[k], back.box.max[k], 1e-7) end
        assert.is_true(back:check().sound)
        assert.equal(ending == "glb" and 1 or 1e-3, info.metres_per_unit)
      end
    end
  end)

  it("keep objects apart, and groups that touch together", function()
    local box, points, triangles, groups = bw.surface.box {max = {0.02, 0.02, 0.02}}, {}, {}, {}
    for k, body in ipairs {ball, box} do
      local first = #points
      for i = 1, body.point_count do
        points[#points + 1] = {body.points(i, 1), body.points(i, 2), body.points(i, 3)}
      end
      for i = 1, body.triangle_count do
        local t = body.triangles
        triangles[#triangles + 1] = {first + t(i, 1), first + t(i, 2), first + t(i, 3)}
        groups[#groups + 1] = k
      end
    end
    local two = bw.surface.new {points = points, triangles = triangles, groups = groups}
    assert(two:write(folder .. "/two.glb"))
    local back, info = assert(bw.surface.read(folder .. "/two.glb"))
    assert.same({"group 1", "group 2"}, info.group_names)
    assert.same(info.group_names, back:face_names()) -- places of supports and loads
    assert.is_true(back:check().sound)
    assert.near(two.volume, back.volume, 1e-6 * two.volume)
  end)

  -- The ball and a box beside it as two groups, each with numbers of its own on its facets.
  local function ball_and_box()
    local box, points, triangles, groups = bw.surface.box {max = {0.02, 0.02, 0.02}}, {}, {}, {}
    for k, body in ipairs {box, ball} do
      local first = #points
      table.move(body.points:totable(), 1, body.point_count, first + 1, points)
      for _, t in ipairs(body.triangles:totable()) do
        triangles[#triangles + 1] = {first + t[1], first + t[2], first + t[3]}
        groups[#groups + 1] = k
      end
    end
    return bw.surface.new {points = points, triangles = triangles, groups = groups}, bw.array.new(groups)
  end

  it("have colours on the facets of each of two objects", function()
    local two, numbers = ball_and_box()
    for _, ending in ipairs {"glb", "3mf"} do
      local path = folder .. "/two." .. ending
      assert(two:write(path, {values = numbers}))
      local back, info = assert(bw.surface.read(path))
      assert.equal(two.triangle_count, back.triangle_count)
      assert.near(two.volume, back.volume, 1e-6 * two.volume)
      assert.same({"group 1", "group 2"}, info.group_names)
      assert.is_true(back:check().sound)
    end
    -- A .glb begins with its text, which bounds the points of each object: y is up there.
    local file <close> = assert(io.open(folder .. "/two.glb", "rb"))
    local bytes = file:read "a"
    local accessors = bw.json.decode(bytes:sub(21, 20 + string.unpack("<I4", bytes, 13))).accessors
    for i, bounds in ipairs {{{0, 0, -0.02}, {0.02, 0.02, 0}}, {{0.09, 0.29, -0.21}, {0.11, 0.31, -0.19}}} do
      local points = accessors[3 * i - 1]
      for k = 1, 3 do
        assert.near(bounds[1][k], points.min[k], 1e-8)
        assert.near(bounds[2][k], points.max[k], 1e-8)
      end
    end
  end)

  it("have in a 3MF the colour of each facet, by resources of different numbers", function()
    local two, numbers = ball_and_box()
    assert(two:write(folder .. "/two.3mf", {values = numbers}))
    local text = python(folder, "zipfile", [[
import re, zipfile
import xml.etree.ElementTree as tree
z = zipfile.ZipFile("two.3mf")
root = tree.fromstring(z.read([n for n in z.namelist() if n.endswith(".model")][0]))
ids, palettes = [], {}
for e in root.iter():
    tag = e.tag.split("}")[1]
    if tag in ("colorgroup", "object"): ids.append(e.get("id"))
    if tag == "colorgroup": palettes[e.get("id")] = [c.get("color") for c in e]
    if tag == "object":
        print(*{palettes[t.get("pid")][int(t.get("p1"))] for t in e.iter() if t.tag.endswith("}triangle")})
print(len(ids) - len(set(ids)))
]])
    if not text then return pending "Python is not installed" end
    assert.equal("#AED6F9\n#860F27\n0\n", text) -- the ends of the scale, as in the .glb
  end)

  it("are read from a .gltf and a file beside it, whose name is encoded", function()
    local function write(name, bytes)
      local file <close> = assert(io.open(folder .. "/" .. name, "wb"))
      file:write(bytes)
    end
    assert(ball:write(folder .. "/a.glb"))
    local file <close> = assert(io.open(folder .. "/a.glb", "rb"))
    local bytes = file:read "a"
    local size = string.unpack("<I4", bytes, 13)
    write("my data.bin", bytes:sub(29 + size))
    local text, count = bytes:sub(21, 20 + size):gsub('"buffers":%[{', '"buffers":[{"uri":"my%%20d%%61ta.bin",')
    assert.equal(1, count)
    write("b.gltf", text)
    local back = assert(bw.surface.read(folder .. "/b.gltf"))
    assert.equal(ball.triangle_count, back.triangle_count)
    assert.near(ball.volume, back.volume, 1e-6 * ball.volume)
  end)

  it("refuse what a format cannot hold", function()
    local function refused(path, options, text)
      local ok, message = pcall(ball.write, ball, folder .. "/" .. path, options)
      assert.is_false(ok)
      assert.truthy(message:find(text, 1, true), message)
    end
    refused("a.stl", {values = height}, "no colours")
    refused("a.obj", {fields = {height = height}}, "no fields")
    refused("a.ply", {fields = {where = ball.points}}, "3 components")
    refused("a.glb", {unit = "mm"}, "metres")
    refused("a.obj", {values = ball.triangles:column(1)}, "colours of points only")
    refused("a.glb", {values = {1, 2, 3}}, "a row for each of 642 points or 1280 facets")
    refused("a.xyz", {}, ".glb .usda")
  end)

  it("are read by VTK with the colours of pictures", function()
    assert(ball:write(folder .. "/a.glb", {values = height, min = 0.29, max = 0.31}))
    local text = python(folder, "vtk", [[
import vtk
from vtk.util.numpy_support import vtk_to_numpy
r = vtk.vtkGLTFReader(); r.SetFileName("a.glb")
f = vtk.vtkCompositeDataGeometryFilter(); f.SetInputConnection(r.GetOutputPort()); f.Update()
o = f.GetOutput()
m = vtk.vtkMassProperties(); m.SetInputData(o)
c, p = vtk_to_numpy(o.GetPointData().GetArray("COLOR_0")), vtk_to_numpy(o.GetPoints().GetData())
print(o.GetNumberOfCells(), m.GetVolume(), *o.GetBounds(), *c[p[:, 1].argmin()], *c[p[:, 1].argmax()])
]])
    if not text then return pending "VTK for Python is not installed" end
    local got = {}
    for word in text:gmatch "%S+" do got[#got + 1] = tonumber(word) end
    assert.equal(ball.triangle_count, got[1])
    assert.near(ball.volume, got[2], 1e-4 * ball.volume)
    for k, value in ipairs {0.09, 0.11, 0.29, 0.31, -0.21, -0.19} do assert.near(value, got[2 + k], 1e-6) end
    for k, byte in ipairs {174, 214, 249, 134, 15, 39} do assert.near(byte, srgb(got[8 + k]), 0.6) end
  end)

  it("are read by meshio with their fields, and by assimp", function()
    assert(ball:write(folder .. "/a.ply", {values = height, fields = {height = height}, unit = "m"}))
    assert(ball:write(folder .. "/a.obj", {values = height}))
    assert(ball:write(folder .. "/a.glb", {values = height}))
    local text = python(folder, "meshio", [[
import meshio
m, o = meshio.read("a.ply"), meshio.read("a.obj")
print(len(m.points), m.point_data["height"].min(), m.point_data["height"].max(), abs(m.point_data["height"]
  - m.points[:, 2]).max(), m.point_data["red"][m.points[:, 2].argmax()] & 255, len(o.points))
]])
    local assimp = run("assimp info " .. folder .. "/a.glb")
    if not text and not assimp then return pending "neither meshio nor assimp is installed" end
    if text then
      local got = {}
      for word in text:gmatch "%S+" do got[#got + 1] = tonumber(word) end
      assert.same({642, 0, 134, 642}, {got[1], got[4], got[5], got[6]})
      assert.near(0.29, got[2], 1e-12)
    end
    if assimp then assert.equal("1280", assimp:match "Faces:%s*(%d+)") end
  end)

  it("begin at the smallest value where only the largest is given, and end at the largest", function()
    local function bytes(given)
      given.values, given.unit = height, "m"
      assert(ball:write(folder .. "/range.ply", given))
      local file <close> = assert(io.open(folder .. "/range.ply", "rb"))
      return file:read "a"
    end
    local least, greatest = height:min(), height:max()
    local whole = bytes {}
    assert.equal(whole, bytes {min = least})
    assert.equal(whole, bytes {max = greatest})
    assert.equal(bytes {min = least, max = 0.25}, bytes {max = 0.25})
    assert.not_equal(whole, bytes {min = 0})
  end)

  it("have the lists that USD prescribes", function()
    assert(ball:write(folder .. "/a.usda", {values = height, fields = {["height, m"] = height}, unit = "mm"}))
    local file = assert(io.open(folder .. "/a.usda"))
    local text = file:read "a"
    file:close()
    assert.truthy(text:find "^#usda 1%.0\n")
    assert.truthy(text:find("metersPerUnit = 0.001", 1, true))
    assert.truthy(text:find('upAxis = "Z"', 1, true))
    local function count(name, entry)
      local list = assert(text:match("%] " .. name .. " = (%b[])"), name)
      return select(2, list:gsub(entry, ""))
    end
    assert.equal(642, count("points", "%b()"))
    assert.equal(642, count("primvars:displayColor", "%b()"))
    assert.equal(642, count("primvars:height__m", "[%d.]+"))
    assert.equal(1280, count("faceVertexCounts", "3"))
    assert.equal(3840, count("faceVertexIndices", "%d+"))
    local open, close = select(2, text:gsub("[%[({]", "")), select(2, text:gsub("[%])}]", ""))
    assert.equal(open, close)
  end)

  -- The numbers of a list of USD, and what stands behind it.
  local function list_of(text, name)
    local list, behind = text:match(name .. " = (%b[]) ?(%b())")
    list = list or assert(text:match(name .. " = (%b[])"), name)
    local numbers = {}
    for word in list:gmatch "[%d.e+-]+" do numbers[#numbers + 1] = tonumber(word) end
    return numbers, behind
  end

  it("have meshes in USD that bound the volume of each object", function()
    local two, numbers = ball_and_box()
    assert(two:write(folder .. "/a.usda", {values = numbers, unit = "m", fields = {
      height = two.points:column(3), ["which one"] = numbers}}))
    local file <close> = assert(io.open(folder .. "/a.usda"))
    local volumes = {}
    for mesh in file:read "a":gmatch "def Mesh .-\n    }" do
      local points, corners, sum = list_of(mesh, "points"), list_of(mesh, "faceVertexIndices"), 0
      local function at(i, k) return assert(points[3 * corners[i] + k]) end
      for i = 1, #corners, 3 do
        for k = 1, 3 do
          local l, m = k % 3 + 1, (k + 1) % 3 + 1
          sum = sum + at(i, k) * (at(i + 1, l) * at(i + 2, m) - at(i + 1, m) * at(i + 2, l)) / 6
        end
      end
      volumes[#volumes + 1] = sum
      for name, place in pairs {height = "vertex", which_one = "uniform"} do
        local values, behind = list_of(mesh, "primvars:" .. name)
        assert.equal(place == "vertex" and #points / 3 or #corners / 3, #values)
        assert.truthy(behind:find('interpolation = "' .. place .. '"', 1, true), behind)
      end
      local colours = list_of(mesh, "displayColor") -- the ends of the scale, as linear light
      for k, byte in ipairs(#volumes == 1 and {174, 214, 249} or {134, 15, 39}) do
        assert.near(byte, srgb(colours[k]), 0.6)
      end
    end
    assert.equal(2, #volumes)
    assert.near(8e-6, volumes[1], 1e-12)
    assert.near(ball.volume, volumes[2], 1e-6 * ball.volume)
  end)
end)

describe("barwright convert", function()
  it("writes a field of a mesh as colours", function()
    local folder = os.tmpname()
    os.remove(folder)
    assert(os.execute("mkdir " .. folder))
    local mesh = assert(bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {8, 2, 2}})
    assert(mesh:write(folder .. "/a.vtu", {fields = {height = mesh.nodes:column(1), where = mesh.nodes}}))
    local function converts(arguments, expected)
      local pipe = assert(io.popen(("cd %s && %s convert %s 2>&1"):format(folder, check.program, arguments)))
      local text = pipe:read "a"
      local _, _, status = pipe:close()
      assert.equal(expected, status, text)
      return text
    end
    converts("a.vtu a.glb --colours height", 0)
    assert.near(mesh.volume, assert(bw.surface.read(folder .. "/a.glb")).volume, 1e-6 * mesh.volume)
    converts("a.vtu a.usda --colours where", 0)
    assert.truthy(converts("a.vtu a.glb --colours heigt", 2):find "the fields height, where")
    converts("a.vtu a.stl --colours height", 2)
    converts("a.vtu a.glb --out-unit mm", 2)
    converts("a.glb b.ply --colours height", 2)
    os.execute("rm -r " .. folder)
  end)
end)
