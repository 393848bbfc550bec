-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- STEP and IGES files, written by OpenCASCADE in the test. Skipped where barwright was built without it.
local bw = require "barwright"
local check = require "check"

local maker = check.root .. "/build/tests/make_shapes"
local built = io.open(maker, "rb")
if not built then
  describe("STEP and IGES", function() pending "barwright was built without OpenCASCADE (scripts/setup --cad)" end)
  return
end
built:close()

local folder, made = os.tmpname() .. ".cad", {}

local function near(expected, got, tolerance, what)
  assert.is_true(math.abs(got / expected - 1) <= tolerance,
    ("%s: %.12g expected, got %.12g"):format(what, expected, got))
end

local function write(name, text)
  local file = assert(io.open(folder .. "/" .. name, "wb"))
  file:write(text)
  file:close()
  return folder .. "/" .. name
end

local function content(name)
  local file = assert(io.open(folder .. "/" .. name, "rb"))
  local text = file:read "a"
  file:close()
  return text
end

local function run(command)
  local pipe = assert(io.popen(check.program .. " " .. command .. " 2>&1"))
  local text = pipe:read "a"
  local _, _, status = pipe:close()
  return status, text
end

setup(function()
  assert(os.execute(("rm -rf %s && mkdir %s"):format(folder, folder)))
  local pipe = assert(io.popen(("%s %s"):format(maker, folder)))
  for line in pipe:lines() do
    local name, volume, area = line:match "^([%w_]+%.%w+) (%S+) (%S+)$"
    if name then made[name] = {volume = 1e-9 * tonumber(volume), area = 1e-6 * tonumber(area)} end
  end
  pipe:close()
end)
teardown(function() os.execute("rm -rf " .. folder) end)

-- Closed forms, in mm3 and mm2: independent of OpenCASCADE.
local exact = {
  box = {24000, 5200},
  cylinder = {math.pi * 64 * 25, 2 * math.pi * 8 * (8 + 25)},
  sphere = {4 / 3 * math.pi * 12 ^ 3, 4 * math.pi * 144},
  torus = {2 * math.pi ^ 2 * 20 * 36, 4 * math.pi ^ 2 * 20 * 6},
  cone = {math.pi * 100 * 15 / 3, math.pi * 10 * (10 + math.sqrt(325))},
  hollow = {24000 - 4 / 3 * math.pi * 343, 5200 + 4 * math.pi * 49},
  plate = {12000 - 5 * math.pi * (9 + 16 + 25 + 36), 2 * (2400 + 300 + 200) + 2 * math.pi * (5 * 18 - 86)},
}
exact.mirrored = exact.plate
local shapes = {"box", "cylinder", "sphere", "torus", "cone", "fillet", "plate", "hollow", "mirrored"}
local units = {MM = 1e-3, INCH = 0.0254, M = 1}

describe("a STEP or IGES file", function()
  for _, ending in ipairs {".step", ".igs", "_solid.iges"} do
    it("has volume and area of the exact shape, in any unit" .. ending, function()
      for unit, metres in pairs(units) do
        for _, shape in ipairs(shapes) do
          local name = shape .. "_" .. unit .. ending
          local surface, info = assert(bw.surface.read(folder .. "/" .. name))
          local report = surface:check()
          assert.is_true(report.sound, name .. " is not sound")
          assert.equal(metres, info.metres_per_unit)
          near(made[name].volume, info.exact_volume, 1e-6, name .. " volume")
          near(made[name].area, info.exact_area, 1e-6, name .. " area")
          if exact[shape] then
            near(1e-9 * exact[shape][1], info.exact_volume, 1e-6, name .. " closed form of the volume")
            near(1e-6 * exact[shape][2], info.exact_area, 1e-6, name .. " closed form of the area")
          end
          near(info.exact_volume, surface.volume, 0.03, name .. " triangles")
        end
      end
    end)
  end

  it("is followed more closely with a smaller tolerance", function()
    for _, shape in ipairs {"cylinder", "sphere", "torus", "fillet"} do
      local before
      for _, tolerance in ipairs {0.4e-3, 0.1e-3, 0.025e-3} do
        local surface, info = assert(bw.surface.read(folder .. "/" .. shape .. "_MM.step",
          {tolerance = tolerance, angle = 1.5}))
        local off = math.abs(surface.volume / info.exact_volume - 1)
        assert.is_true(surface:check().sound)
        if before then assert.is_true(off < before / 2.5, ("%s: %g after %g"):format(shape, off, before)) end
        before = off
      end
      assert.is_true(before < 0.005, shape)
    end
  end)

  it("keeps bodies and names, and places them", function()
    local surface, info = assert(bw.surface.read(folder .. "/assembly.step"))
    assert.same({"block", "pin", "pin 2"}, {info.bodies[1].name, info.bodies[2].name, info.bodies[3].name})
    assert.equal(3, #info.bodies)
    near(6e-6, info.bodies[1].volume, 1e-9, "block")
    near(math.pi * 9 * 12e-9, info.bodies[3].volume, 1e-9, "pin 2")
    near(0.037, info.bodies[2].surface.box.min[1], 1e-3, "pin begins at 37 mm")
    assert.equal(3, surface:check().shells)
    for _, body in ipairs(info.bodies) do
      assert.is_true(body.surface:check().sound)
    end
    assert.equal(6 + 3 + 3, #info.faces)
  end)

  it("has a face for each group, with kind, radius and area", function()
    local surface, info = assert(bw.surface.read(folder .. "/cylinder_MM.step"))
    local kinds, groups = {}, {}
    for _, face in ipairs(info.faces) do kinds[face.kind] = (kinds[face.kind] or 0) + 1 end
    for _, group in ipairs(surface.groups:totable()) do groups[group] = true end
    assert.same({plane = 2, cylinder = 1}, kinds)
    assert.same({true, true, true}, groups)
    near(0.008, info.faces[1].radius, 1e-12, "radius")
    near(2 * math.pi * 0.008 * 0.025, info.faces[1].area, 1e-9, "area")
  end)

  it("takes the names of faces from the file", function()
    local text, count = content("box_MM.step"):gsub("ADVANCED_FACE%(''", "ADVANCED_FACE('clamped'", 1)
    assert.equal(1, count)
    local _, info = assert(bw.surface.read(write("named.step", text)))
    assert.same({"clamped", "face 2"}, {info.faces[1].name, info.faces[2].name})
  end)

  it("is recognised by its content, and a given unit counts", function()
    local _, info = assert(bw.surface.read(write("box.stl", content "box_MM.step"), {unit = "in"}))
    near(24000 * 0.0254 ^ 3, info.exact_volume, 1e-9, "volume")
    assert.equal("IGES", select(2, assert(bw.surface.read(write("box.txt", content "box_MM.igs")))).format)
  end)

  it("gives the same bits again", function()
    local path = folder .. "/fillet_MM.step"
    local a, b = assert(bw.surface.read(path)), assert(bw.surface.read(path))
    assert.same(a.points:totable(), b.points:totable())
    assert.same(a.triangles:totable(), b.triangles:totable())
  end)

  it("fails in one sentence with the file", function()
    local step, iges = content "plate_MM.step", content "plate_MM.igs"
    for name, text in pairs {["empty.step"] = "", ["text.step"] = "a drawing",
      ["curve.step"] = content "curve.step",
      ["head.step"] = "ISO-10303-21;\n", ["cut.step"] = step:sub(1, #step // 2),
      ["cut.igs"] = iges:sub(1, #iges // 2), ["head.igs"] = iges:sub(1, 81)} do
      local surface, message, details = bw.surface.read(write(name, text))
      assert.is_nil(surface, name)
      assert.is_truthy(message:find(name, 1, true), name .. ": " .. message)
      assert.is_truthy(details.status == "format" or details.status == "geometry", name .. ": " .. message)
      assert.is_nil(message:find "\n")
    end
    local mesh, message = bw.mesh.read(folder .. "/box_MM.step")
    assert.is_nil(mesh)
    assert.is_truthy(message:find "STEP")
  end)

  it("does not end the process, whatever bytes it has", function()
    -- without the time at which it was written: the same bytes on every day
    local text = content "plate_MM.step":gsub("'%d+%-%d+%-%d+T[%d:]+'", "''")
    math.randomseed(7)
    for trial = 1, 12 do
      local bytes = {text:byte(1, -1)}
      for _ = 1, 20 do bytes[math.random(40, #bytes)] = math.random(32, 126) end
      local parts = {}
      for i = 1, #bytes, 4000 do
        parts[#parts + 1] = string.char(table.unpack(bytes, i, math.min(i + 3999, #bytes)))
      end
      local surface, message = bw.surface.read(write("wild.step", table.concat(parts)))
      assert.is_truthy(surface or type(message) == "string", trial)
    end
  end)
end)

describe("a STEP file that barwright writes", function()
  -- Corners of a solid with flat faces: read back by OpenCASCADE, which knows nothing of the triangles.
  local function back(name, surface, unit)
    local path = folder .. "/" .. name .. ".step"
    assert(surface:write(path, {unit = unit, flat = true}))
    local read, info = assert(bw.surface.read(path))
    assert.is_true(read:check().sound, name)
    near(surface.volume, info.exact_volume, 1e-6, name .. " volume")
    near(surface.area, info.exact_area, 1e-6, name .. " area")
    for k = 1, 3 do near(surface.box.size[k], read.box.size[k], 1e-6, name .. " box") end
    return info
  end
  local box = bw.surface.box {max = {0.03, 0.02, 0.01}}

  it("keeps the names of faces, with any characters", function()
    local names = {left = "bolt hole", top = "Ø 6 'deep' \\ 5", right = "平面", front = "\u{1F600}"}
    local body = bw.surface.box {max = {1, 2, 3}}
    for face, name in pairs(names) do body = body:named(name, face) end
    local path = folder .. "/names.step"
    assert(body:write(path, {unit = "mm"}))
    assert.truthy(content("names.step"):find("6 ''deep'' \\\\ 5", 1, true)) -- some readers take others too
    local found = assert(bw.surface.read(path)):face_names()
    local expected = body:face_names()
    table.sort(found)
    table.sort(expected)
    assert.same(expected, found)
  end)

  it("has volume and area, and a face for each plane, in any unit", function()
    for unit, metres in pairs {mm = 1e-3, cm = 1e-2, m = 1, ["in"] = 0.0254, ft = 0.3048} do
      local info = back("own_box", box, unit)
      assert.equal(6, #info.faces)
      assert.equal(metres, info.metres_per_unit)
    end
    local hole = bw.surface.cylinder {base = {0.015, 0.01, -0.01}, axis = {0, 0, 0.05}, radius = 0.004,
      segments = 24}
    local plate = assert(box:difference(hole))
    assert.equal(6 + 24, #back("own_plate", plate).faces)
    assert.equal(6 + 24, #back("own_turned", assert(plate:rotate({1, 2, 3}, 0.7))).faces)
    assert.equal(320, #back("own_ball", bw.surface.sphere {radius = 0.01, subdivisions = 2}).faces)
  end)

  it("has voids, and bodies in voids", function()
    local pocket = bw.surface.box {min = {0.01, 0.005, 0.002}, max = {0.02, 0.015, 0.008}}
    local hollow = assert(box:difference(pocket))
    local info = back("own_hollow", hollow)
    assert.equal(12, #info.faces)
    assert.equal(1, #info.bodies)
    local core = bw.surface.box {min = {0.012, 0.007, 0.004}, max = {0.018, 0.013, 0.006}}
    assert.equal(2, #back("own_core", assert(hollow:union(core))).bodies)
  end)

  -- OpenCASCADE repairs such files as it reads them.
  it("has edges that follow each other around faces, in either direction once, the outer loop first", function()
    local plate = assert(box:difference(bw.surface.cylinder {base = {0.015, 0.01, -0.01}, axis = {0, 0, 0.05},
      radius = 0.004, segments = 24}))
    assert(plate:write(folder .. "/own_edges.step", {flat = true}))
    local entity, used, loops = {}, {}, {}
    for number, kind, given in content "own_edges.step":gmatch "#(%d+)=([%u_]+)(%b())" do
      local list = {kind = kind, same = not given:find(".F.", 1, true)}
      for other in given:gmatch "#(%d+)" do list[#list + 1] = other end
      entity[number] = list
    end
    local function ends(oriented)
      local edge = entity[oriented[1]]
      return edge[oriented.same and 1 or 2], edge[oriented.same and 2 or 1]
    end
    for _, one in pairs(entity) do
      if one.kind == "ORIENTED_EDGE" then
        local key = one[1] .. tostring(one.same)
        assert.is_nil(used[key])
        used[key] = true
      elseif one.kind == "EDGE_LOOP" then
        for i, number in ipairs(one) do
          local _, last = ends(entity[number])
          assert.equal(last, (ends(entity[one[i % #one + 1]])))
        end
      elseif one.kind == "ADVANCED_FACE" and #one == 3 then -- two bounds and a plane
        local bounds = {entity[one[1]], entity[one[2]]}
        assert.same({"FACE_OUTER_BOUND", "FACE_BOUND"}, {bounds[1].kind, bounds[2].kind})
        loops[#loops + 1] = {#entity[bounds[1][1]], #entity[bounds[2][1]]}
      end
    end
    assert.same({{4, 24}, {4, 24}}, loops)
  end)

  it("gives each void to the body around it", function()
    local pocket = bw.surface.box {min = {0.01, 0.005, 0.002}, max = {0.02, 0.015, 0.008}}
    local hollow = assert(box:difference(pocket))
    local large = assert(assert(hollow:scale(1.5)):translate {0.05, 0, 0})
    local info = back("own_two", assert(hollow:union(large)))
    local volumes = {info.bodies[1].volume, info.bodies[2].volume}
    table.sort(volumes)
    near(hollow.volume, volumes[1], 1e-6, "small")
    near(large.volume, volumes[2], 1e-6, "large")
  end)

  it("keeps faces in a plane apart by their names, and planes that are nearly the same", function()
    local beside = bw.surface.box {min = {0.03, 0, 0}, max = {0.04, 0.02, 0.01}}
    local both = assert(box:named("table", "top"):union(beside:named("shelf", "top")))
    local info = back("own_names", both)
    local count = {}
    for _, face in ipairs(info.faces) do count[face.name] = (count[face.name] or 0) + 1 end
    assert.equal(1, count.table)
    assert.equal(1, count.shelf)
    -- A pyramid of 3 um on a plate of 30 mm.
    local points = {{0, 0, 0}, {0.03, 0, 0}, {0.03, 0.02, 0}, {0, 0.02, 0}, {0, 0, 0.01}, {0.03, 0, 0.01},
      {0.03, 0.02, 0.01}, {0, 0.02, 0.01}, {0.015, 0.01, 0.010003}}
    local shallow = bw.surface.new {points = points, triangles = {{1, 3, 2}, {1, 4, 3}, {1, 2, 6}, {1, 6, 5},
      {2, 3, 7}, {2, 7, 6}, {3, 4, 8}, {3, 8, 7}, {4, 1, 5}, {4, 5, 8}, {5, 6, 9}, {6, 7, 9}, {7, 8, 9},
      {8, 5, 9}}}
    assert.equal(5 + 4, #back("own_shallow", shallow).faces)
  end)

  it("holds a part that was made elsewhere", function()
    for _, name in ipairs {"gear_spur.stl", "anchor.off"} do
      local path = check.root .. "/../shared/models/" .. name
      local file = io.open(path, "rb")
      if file then
        file:close()
        back("own_part", (assert(bw.surface.read(path))))
      end
    end
  end)

  it("is refused where the surface is open or turned, and has the same bytes again", function()
    local open = bw.surface.new {points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, triangles = {{1, 2, 3}}}
    local nothing, message = open:write(folder .. "/open.step")
    assert.is_nil(nothing)
    assert.truthy(message:find "two")
    local points, triangles = box.points, box.triangles:totable()
    for _, t in ipairs(triangles) do t[1], t[2] = t[2], t[1] end
    nothing, message = bw.surface.new({points = points, triangles = triangles}):write(folder .. "/b.step")
    assert.is_nil(nothing)
    assert.truthy(message:find "inside out")
    assert(box:write(folder .. "/c.step"))
    assert(box:write(folder .. "/d.step"))
    assert.equal(content "c.step", content "d.step")
  end)
end)

describe("commands on a STEP file", function()
  it("check prints the unit of the file, volumes, and no more than that", function()
    local status, text = run("check " .. folder .. "/plate_INCH.step")
    assert.equal(0, status, text)
    assert.is_truthy(text:find("The unit of the file: in", 1, true), text)
    assert.is_truthy(text:find("10.65 cm3", 1, true), text)
    status, text = run("check " .. folder .. "/assembly.step")
    assert.equal(0, status, text)
    assert.is_truthy(text:find("pin 2: 0.3393 cm3", 1, true), text)
  end)

  it("convert writes its triangles", function()
    local out = folder .. "/plate.stl"
    local status, text = run(("convert %s/plate_MM.step %s"):format(folder, out))
    assert.equal(0, status, text)
    assert.is_true(assert(bw.surface.read(out)):check().sound)
  end)

  it("statics and modes compute", function()
    local status, text = run("statics --elements 2000 --fix min:x --gravity 0,0,-9.81 " .. folder
      .. "/plate_MM.step")
    assert.is_true(status == 0 or status == 1, text)
    status, text = run(("modes %s/plate_MM.step --elements 2000 --count 3"):format(folder))
    assert.equal(0, status, text)
  end)
end)
