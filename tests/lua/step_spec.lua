-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Exact solids in STEP files: cylinders and cones of the modeller against closed forms, read by OpenCASCADE alone.
local bw = require "barwright"
local check = require "check"

local checker = check.root .. "/build/tests/check_shapes"
local built = io.open(checker, "rb")
if not built then
  describe("exact STEP", function() pending "barwright was built without OpenCASCADE (scripts/setup --cad)" end)
  return
end
built:close()

local pi, mm = math.pi, 1e-3
local path = os.tmpname() .. ".step"
teardown(function() os.remove(path) end)

-- What OpenCASCADE finds in the file: volume in m3, area in m2.
local function exact(surface, options)
  assert(surface:write(path, options or {unit = "mm"}))
  local pipe = assert(io.popen(checker .. " " .. path))
  local text = pipe:read "a"
  pipe:close()
  local found = {}
  for word in text:gmatch "%S+" do found[#found + 1] = tonumber(word) or word end
  return {valid = found[1] == "valid", volume = found[2] * 1e-9, area = found[3] * 1e-6, solids = found[4],
    planes = found[5], cylinders = found[6], cones = found[7], others = found[8], text = text}
end

local function near(expected, got, what)
  assert.is_true(math.abs(got / expected - 1) <= 1e-9,
    ("%s: %.15g expected, got %.15g"):format(what, expected, got))
end

-- A valid solid with this volume, area and numbers of faces.
local function holds(surface, volume, area, planes, cylinders, cones)
  local found = exact(surface)
  assert.is_true(found.valid, found.text)
  assert.same({1, planes, cylinders, cones or 0, 0},
    {found.solids, found.planes, found.cylinders, found.cones, found.others})
  near(volume, found.volume, "volume")
  near(area, found.area, "area")
end

local function drill(x, y, radius, options)
  return bw.surface.cylinder {base = {x, y, -0.1}, axis = {0, 0, 0.2}, radius = radius,
    segments = options and options.segments}
end

describe("a STEP file of the modeller", function()
  -- The axis of three narrow strips is known to few digits; that of far ones is not.
  it("has one cone however fine its strips are", function()
    local r, q = 10 * mm, 9.8 * mm
    for _, segments in ipairs {100, 500, 2000, 5000} do
      holds(bw.surface.cone {axis = {0.01, 0.02, 0.02}, radius = r, top_radius = q, segments = segments},
        pi * 0.03 / 3 * (r * r + r * q + q * q),
        pi * (r * r + q * q + (r + q) * math.sqrt((r - q) ^ 2 + 0.03 ^ 2)), 2, 0, 1)
    end
  end)

  it("has no cylinder in an ellipse", function()
    for _, segments in ipairs {24, 50, 51} do
      local found = exact(bw.surface.cylinder {axis = {0, 0, 0.02}, radius = 0.01, segments = segments}
        :transform {{2, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}})
      assert.is_true(found.valid, found.text)
      assert.same({segments + 2, 0}, {found.planes, found.cylinders})
    end
  end)

  it("has true cylinders and cones", function()
    local r, q, h = 5 * mm, 2 * mm, 20 * mm
    for _, turn in ipairs {0, 0.7} do
      local function moved(surface)
      return assert(surface:rotate({1, 2, 3}, turn)):translate {turn, 0, 2 * turn}
    end
      holds(moved(bw.surface.cylinder {base = {0, 0, 0}, axis = {0, 0, h}, radius = r}), pi * r * r * h,
        2 * pi * r * (r + h), 2, 1)
      local slant = math.sqrt((r - q) ^ 2 + h * h)
      holds(moved(bw.surface.cone {axis = {0, 0, h}, radius = r, top_radius = q}),
        pi * h / 3 * (r * r + r * q + q * q), pi * (r * r + q * q + (r + q) * slant), 2, 0, 1)
      holds(moved(bw.surface.cone {axis = {0, 0, h}, radius = r}), pi * h / 3 * r * r,
        pi * r * (r + math.sqrt(r * r + h * h)), 1, 0, 1)
    end
    -- a fine one: strips of 0.36 degrees
    holds(bw.surface.cylinder {base = {0, 0, 0}, axis = {0, 0, h}, radius = r, segments = 1000}, pi * r * r * h,
      2 * pi * r * (r + h), 2, 1)
  end)

  it("has a rounded plate with holes, extruded or drilled", function()
    local a, b, h, r, hole = 60 * mm, 40 * mm, 5 * mm, 6 * mm, 3 * mm
    local places = {{-20 * mm, -10 * mm}, {20 * mm, -10 * mm}, {0, 12 * mm}}
    for k = 0, #places do
      local holes = {}
      for i = 1, k do holes[i] = bw.outline.circle {centre = places[i], radius = hole, tag = "hole"} end
      local section = a * b - (4 - pi) * r * r - k * pi * hole ^ 2
      local border = 2 * (a + b) - 8 * r + 2 * pi * r + k * 2 * pi * hole
      local whole = assert(bw.outline.rectangle {centre = {0, 0}, width = a, height = b, radius = r})
      local extruded = assert(bw.outline.rectangle {centre = {0, 0}, width = a, height = b, radius = r,
        holes = holes})
      local part = assert(bw.surface.extrude(whole, {height = h}))
      for i = 1, k do part = assert(part:difference(drill(places[i][1], places[i][2], hole))) end
      -- where an outline makes a hole, its circle is eight arcs, which are one face
      holds(assert(bw.surface.extrude(extruded, {height = h})), section * h, 2 * section + border * h, 6, 4 + k)
      holds(part, section * h, 2 * section + border * h, 6, 4 + k)
    end
  end)

  it("has what is revolved, bored and stepped", function()
    local outline = bw.outline {points = {{10 * mm, 0}, {30 * mm, 0}, {30 * mm, 5 * mm}, {15 * mm, 5 * mm},
      {12 * mm, 20 * mm}, {10 * mm, 20 * mm}}}
    local flange = assert(bw.surface.revolve(outline, {segments = 60}))
    local cone = pi * 15 * mm / 3 * (15 ^ 2 + 15 * 12 + 12 ^ 2) * mm ^ 2
    local volume = pi * (30 ^ 2 * 5 - 10 ^ 2 * 20) * mm ^ 3 + cone
    local area = pi * (2 * 30 * 5 + 2 * 10 * 20 + (30 ^ 2 - 10 ^ 2) + (30 ^ 2 - 15 ^ 2) + (12 ^ 2 - 10 ^ 2)
      + (15 + 12) * math.sqrt(3 ^ 2 + 15 ^ 2)) * mm ^ 2
    holds(flange, volume, area, 3, 2, 1)
    local bolts = assert(drill(22.5 * mm, 0, 2 * mm):polar_array {count = 6})
    holds(assert(flange:difference(bolts)), volume - 6 * pi * 4 * 5 * mm ^ 3,
      area + 6 * (2 * pi * 2 * 5 - 2 * pi * 4) * mm ^ 2, 3, 8, 1)
  end)

  it("has windows, blind holes, halves and cavities", function()
    local body = bw.surface.cylinder {base = {0, 0, 0}, axis = {0, 0, 40 * mm}, radius = 10 * mm}
    local whole, side = pi * 4000 * mm ^ 3, 2 * pi * 10 * 40 * mm ^ 2
    local far = 0.1
    local half = bw.surface.box {min = {0, -far, -far}, max = {far, far, far}}
    holds(assert(body:difference(half)), whole / 2, side / 2 + (pi * 100 + 20 * 40) * mm ^ 2, 3, 1)
    local window = bw.surface.box {min = {0, -far, 10 * mm}, max = {far, far, 20 * mm}}
    holds(assert(body:difference(window)), whole - pi * 500 * mm ^ 3,
      side + (2 * pi * 100 - pi * 10 * 10 + pi * 100 + 20 * 10) * mm ^ 2, 5, 1)
    local blind = bw.surface.cylinder {base = {0, 0, 30 * mm}, axis = {0, 0, far}, radius = 4 * mm}
    holds(assert(body:difference(blind)), whole - pi * 160 * mm ^ 3,
      side + (2 * pi * 100 + 2 * pi * 4 * 10) * mm ^ 2, 3, 2)
    local cavity = bw.surface.cylinder {base = {0, 0, 10 * mm}, axis = {0, 0, 10 * mm}, radius = 4 * mm}
    holds(assert(body:difference(cavity)), whole - pi * 160 * mm ^ 3,
      side + (2 * pi * 100 + 2 * pi * (16 + 4 * 10)) * mm ^ 2, 4, 2)
  end)

  it("keeps what is no circle flat, and valid", function()
    local body = bw.surface.cylinder {base = {0, 0, 0}, axis = {0, 0, 40 * mm}, radius = 10 * mm}
    local across = bw.surface.cylinder {base = {-0.1, 0, 20 * mm}, axis = {0.2, 0, 0}, radius = 4 * mm}
    local slanted = assert(bw.surface.box {min = {-0.1, -0.1, 0}, max = {0.1, 0.1, 0.1}}:rotate({0, 1, 0}, 0.3))
      :translate {0, 0, 25 * mm}
    local cases = {
      assert(body:difference(across)), assert(body:difference(slanted)), assert(body:union(across)),
      bw.surface.torus {radius = 20 * mm, tube = 5 * mm, segments = 12},
      -- an octagon and a hexagon are no cylinders, whatever their names
      bw.surface.cylinder {base = {0, 0, 0}, axis = {0, 0, 0.01}, radius = 0.01, segments = 8},
      assert(body:difference(bw.surface.prism {base = {0, 0, -0.1}, axis = {0, 0, 0.2}, radius = 5 * mm,
        sides = 6})):named "all",
    }
    for i, surface in ipairs(cases) do
      local found = exact(surface)
      assert.is_true(found.valid, i .. ": " .. found.text)
      assert.equal(1, found.solids)
      assert.is_true(math.abs(found.volume / surface.volume - 1) < 0.01, i .. ": " .. found.text)
    end
    assert.equal(10, exact(cases[5]).planes)
    local nut = exact(cases[6])
    assert.same({8, 1}, {nut.planes, nut.cylinders})
  end)

  it("has flat faces where these are asked for, and from files of triangles", function()
    local part = bw.surface.cylinder {base = {0, 0, 0}, axis = {0, 0, 20 * mm}, radius = 5 * mm, segments = 24}
    local flat = exact(part, {unit = "mm", flat = true})
    assert.same({26, 0}, {flat.planes, flat.cylinders})
    near(part.volume, flat.volume, "volume")
    local again = bw.surface.new {points = part.points, triangles = part.triangles, groups = part.groups,
      face_names = part:face_names()}
    assert.equal(26, exact(again).planes)
    assert.same({"side"}, part:curved_faces())
    assert.same({}, again:curved_faces())
    local round = bw.surface.new {points = part.points, triangles = part.triangles, groups = part.groups,
      face_names = part:face_names(), curved_faces = {"side"}}
    assert.same({2, 1}, {exact(round).planes, exact(round).cylinders})
    assert.has_error(function()
      bw.surface.new {points = part.points, triangles = part.triangles, groups = part.groups,
        face_names = part:face_names(), curved_faces = {"lid"}}
    end)
  end)

  it("lists each face behind a neighbour, or reading takes the square of their number", function()
    assert(bw.surface.sphere({radius = 10 * mm, subdivisions = 3}):write(path))
    local file = assert(io.open(path, "rb"))
    local line_of, shell = {}, nil
    for number, text in file:read "a":gmatch "#(%d+)=(.-);\n" do
      line_of[number] = text
      shell = text:match "^CLOSED_SHELL" and text or shell
    end
    file:close()
    local function edges_of(number, list) -- of what a face refers to
      for other in line_of[number]:gmatch "#(%d+)" do
        local text = line_of[other]
        if text:find "^EDGE_CURVE" then list[#list + 1] = other
        elseif text:find "^FACE_" or text:find "^EDGE_LOOP" or text:find "^ORIENTED" then edges_of(other, list) end
      end
      return list
    end
    local known, faces = {}, 0
    for face in shell:gmatch "#(%d+)" do
      local some = faces == 0
      for _, edge in ipairs(edges_of(face, {})) do
        some = some or known[edge]
        known[edge] = true
      end
      faces = faces + 1
      assert.is_true(some, "face " .. faces)
    end
    assert.equal(1280, faces)
  end)

  it("keeps names of faces", function()
    local plate = bw.surface.box {max = {60 * mm, 40 * mm, 5 * mm}}
    local part = assert(plate:difference(drill(20 * mm, 20 * mm, 4 * mm):named "bolt hole"))
    assert(part:write(path))
    local back, info = assert(bw.surface.read(path))
    local kinds = {}
    for _, face in ipairs(info.faces) do kinds[face.name] = face.kind end
    assert.equal("cylinder", kinds["bolt hole"])
    assert.equal("plane", kinds.top)
    assert.equal(7, #info.faces)
    near((60 * 40 - pi * 16) * 5 * mm ^ 3, info.exact_volume, "volume")
    assert.is_true(back:check().sound)
  end)

  it("has random brackets", function()
    math.randomseed(20261129)
    local function between(a, b) return a + (b - a) * math.random() end
    for i = 1, 20 do
      local arm, wall, thick, width = between(40, 80) * mm, between(30, 60) * mm, between(4, 8) * mm,
        between(30, 50) * mm
      local radius, bolt = between(2, 8) * mm, between(2, 4) * mm
      local corners = {{0, 0}, {arm, 0}, {arm, thick}, {thick, thick}, {thick, wall}, {0, wall}}
      local profile = assert(bw.outline {points = corners}:fillet(radius, {vertices = 4}))
      local part = assert(bw.surface.extrude(profile, {height = width, tolerance = between(0.01, 0.05) * mm}))
      local count = math.random(1, 3)
      local hole = bw.surface.cylinder {base = {-0.1, wall - 2 * bolt, width / (2 * count)}, axis = {0.2, 0, 0},
        radius = bolt, segments = math.random(12, 90)}
      part = assert(part:difference(assert(hole:linear_array {count = count, step = {0, 0, width / count}})))
      local post = between(2, 4) * mm
      local boss = bw.surface.cylinder {base = {arm - 6 * mm, thick / 2, width / 2}, axis = {0, 15 * mm, 0},
        radius = post}
      part = assert(part:union(boss)):rotate({between(-1, 1), between(-1, 1), 1}, between(0, 3))
      local section = arm * thick + (wall - thick) * thick + (1 - pi / 4) * radius ^ 2
      local volume = section * width - count * pi * bolt ^ 2 * thick + pi * post ^ 2 * (15 * mm - thick / 2)
      local found = exact(part)
      assert.is_true(found.valid, i .. ": " .. found.text)
      assert.same({1, 0}, {found.solids, found.others})
      assert.equal(count + 2, found.cylinders)
      near(volume, found.volume, "volume of bracket " .. i)
    end
  end)
end)
