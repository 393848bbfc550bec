-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Names of faces: those of bodies by distance, and names that outlast edits of mesh and surface.
local bw = require "barwright"
local shapes = bw.shapes

local pi, sqrt, abs = math.pi, math.sqrt, math.abs

-- {[name] = area (m2)} of the facets of a surface; "" for those without a name.
local function areas(surface)
  local names, groups, points, out = surface:face_names(), surface.groups, surface.points:totable(), {}
  for t, p in ipairs(surface.triangles:totable()) do
    local a, b, c = points[p[1]], points[p[2]], points[p[3]]
    local u, v = {}, {}
    for k = 1, 3 do u[k], v[k] = b[k] - a[k], c[k] - a[k] end
    local x, y, z = u[2] * v[3] - u[3] * v[2], u[3] * v[1] - u[1] * v[3], u[1] * v[2] - u[2] * v[1]
    local name = groups and names[groups(t)] or ""
    out[name] = (out[name] or 0) + sqrt(x * x + y * y + z * z) / 2
  end
  return out
end

local function within(bound, expected, got, what)
  assert.is_true(abs((got or 0) - expected) <= bound, ("%s: %.6g +- %.2g expected, got %.6g"):format(
    what or "area", expected, bound, got or 0))
end

local mm = 1e-3

-- The bracket of examples/35_a_bracket.lua.
local function bracket()
  local arm, wall, thick, width, bolt, radius = 60 * mm, 50 * mm, 6 * mm, 40 * mm, 6 * mm, 6 * mm
  local corners = {{0, 0}, {arm, 0}, {arm, thick}, {thick, thick}, {thick, wall}, {0, wall}}
  local profile = assert(bw.outline {points = corners, tags = {tip = 2, back = 6}}:fillet(radius, {vertices = 4}))
  local angle = assert(bw.surface.extrude(profile, {height = width}))
  local drill = bw.surface.cylinder({base = {-thick, 0.7 * wall, width / 4}, axis = {3 * thick, 0, 0},
    radius = bolt / 2}):named "bolt hole"
  return assert(angle:difference(assert(drill:linear_array {count = 2, step = {0, 0, width / 2}})))
end

-- The names are the same, and so are the areas, but for those of `changed`: a set, or nil.
local function same_faces(before, after, changed)
  for name, area in pairs(before) do
    local moved = math.abs((after[name] or 0) / area - 1)
    if changed and changed[name] then
      assert.is_true(after[name] > 0 and moved > 1e-6, name .. " did not change")
    else
      assert.is_true(moved < 1e-9, ("%s: %.9g became %.9g"):format(name, area, after[name] or 0))
    end
  end
  for name in pairs(after) do assert.is_not_nil(before[name]) end
end

describe("names of faces of a bracket", function()
  local folder = os.tmpname()
  os.remove(folder)
  os.execute("mkdir " .. folder)
  local path = folder .. "/bracket.obj"
  assert(bracket():write(path, {unit = "mm"}))

  it("stay in a workbench where a face is pushed and the fillet thickened, and in its export", function()
    local bench = assert(bw.workbench.open(path, {unit = "mm"}))
    local before = areas(bench:current().body.surface)
    local top
    for i, face in ipairs(bench:current().body.faces) do
      if face.kind == "plane" and face.normal[1] > 0.99 and face.area > 1e-3 then top = i end
    end
    assert(bench:push {faces = {top}, distance = 1 * mm}) -- the front of the wall, which the bolts go through
    local pushed = areas(bench:current().body.surface)
    same_faces(before, pushed, {boundary = true, ["bolt hole"] = true, fillet = true, start = true,
      ["end"] = true})
    assert(bench:thicken {at = {7 * mm, 7 * mm, 20 * mm}, radius = 8 * mm, offset = 0.5 * mm})
    local thick = areas(bench:current().body.surface)
    for _, name in ipairs {"tip", "back", "start", "end", "bolt hole"} do
      assert.is_true(abs(thick[name] / pushed[name] - 1) < 1e-9, name)
    end
    assert.is_true(thick.fillet ~= pushed.fillet)
    local out = folder .. "/out.obj"
    assert(bench:export {path = out})
    for name, area in pairs(areas(assert(bw.surface.read(out, {unit = "mm"})))) do
      assert.is_true(abs(area / thick[name] - 1) < 1e-6)
    end
  end)

  it("stay where parts of the mesh are refilled, and in what is made from such a mesh", function()
    local mesh = assert(bw.mesh.fill(bracket(), {elements = 2500, order = 2}))
    local before = areas((mesh:surface()))
    local mask = {}
    for e, nodes in ipairs(mesh.elements:totable()) do mask[e] = mesh.nodes(nodes[1], 1) < 20 * mm and 1 or 0 end
    local refilled = assert(mesh:refill(mesh.nodes, bw.array.new(mask)))
    assert.is_true(refilled.element_count ~= mesh.element_count)
    same_faces(before, areas((refilled:surface())))
    -- a wall twice as far from its middle: only what lies in the moved part changes
    local nodes = refilled.nodes:totable()
    for _, p in ipairs(nodes) do
      if p[1] > 50 * mm then p[1] = p[1] + 0.2 * (p[1] - 50 * mm) end
    end
    local moved = areas((assert(refilled:moved(bw.array.new(nodes))):surface()))
    for _, name in ipairs {"back", "bolt hole", "fillet", "tip"} do
      assert.is_true(abs(moved[name] / before[name] - 1) < 1e-9, name)
    end
    assert.is_true(moved.start > before.start * 1.01)
  end)

  it("that do not exist are refused by commands with those that do, the nearest first", function()
    local places = require "barwright.command.places"
    local mesh = assert(bw.mesh.fill(bracket(), {elements = 800}))
    local _, message = places.select(mesh, "face:bolthole")
    assert.truthy(message:find("has the name 'bolthole': there are 'bolt hole', 'back', ", 1, true), message)
    assert.is_nil(message:find("print(", 1, true))
    _, message = places.select(mesh, "face:xyzzy")
    assert.truthy(message:find("there are 'back', 'bolt hole', 'boundary', ", 1, true), message)
    local bare = bw.mesh.new {nodes = mesh.nodes, elements = mesh.elements}
    _, message = places.select(bare, "face:tip")
    assert.truthy(message:find("the file names no faces", 1, true), message)
    assert.error_matches(function() mesh.boundary:face "bolthole" end, "print(mesh:surface())", 1, true)
  end)
end)

describe("names of faces of bodies by distance", function()
  it("have the areas of a plate with a hole, into the mesh", function()
    local side, thick, radius = 0.06, 0.005, 0.008
    local plate = shapes.named(shapes.box({-side / 2, -side / 2, 0}, {side / 2, side / 2, thick}), "plate")
    local drill = shapes.named(shapes.cylinder({0, 0, -thick}, {0, 0, 2 * thick}, radius), "bolt hole")
    local body = shapes.cut(plate, drill)
    local hole = 2 * pi * radius * thick
    local flat = 2 * (side ^ 2 - pi * radius ^ 2) + 4 * side * thick
    for _, cells in ipairs {32, 64} do
      local width = 0.064 / cells
      local surface = assert(bw.surface.implicit(body, {min = {-0.032, -0.032, -0.002},
        max = {0.032, 0.032, 0.007}, cells = cells}))
      assert.same({"plate", "bolt hole"}, surface:face_names())
      -- A facet that crosses an edge is within a cell of it.
      local found = areas(surface)
      within(width * 4 * pi * radius, hole, found["bolt hole"])
      within(width * (4 * pi * radius + 8 * side + 4 * thick), flat, found.plate)
      assert.is_nil(found[""])
      if cells == 32 then
        local mesh = assert(bw.mesh.fill(surface, {elements = 2500}))
        local meshed = areas((mesh:surface()))
        within(0.1 * hole, found["bolt hole"], meshed["bolt hole"])
        within(0.05 * flat, found.plate, meshed.plate)
        assert.is_nil(meshed[""])
        assert.is_true(abs(mesh.boundary:face("bolt hole").area / meshed["bolt hole"] - 1) < 1e-12)
      end
    end
  end)

  it("have the areas of caps of balls that meet", function()
    math.randomseed(20)
    for _ = 1, 5 do
      local a, b = 0.6 + 0.5 * math.random(), 0.6 + 0.5 * math.random()
      local d = abs(a - b) + (0.2 + 0.6 * math.random()) * (a + b - abs(a - b))
      local turn = {math.random() - 0.5, math.random() - 0.5, math.random() + 0.1}
      local function balls(combine, ...)
        return shapes.rotate(combine({shapes.named(shapes.sphere({0, 0, 0}, a), "first"),
          shapes.named(shapes.sphere({d, 0, 0}, b), "second")}, ...), turn, 1)
      end
      -- the plane of the circle where they meet, and its radius
      local x = (d * d + a * a - b * b) / (2 * d)
      local circle = 2 * pi * sqrt(a * a - x * x)
      local cap = {first = 2 * pi * a * (a - x), second = 2 * pi * b * (b - (d - x))}
      local box = {min = {-3.5, -3.5, -3.5}, max = {3.5, 3.5, 3.5}, cells = 50}
      local joined = areas(assert(bw.surface.implicit(balls(shapes.join), box)))
      local common = areas(assert(bw.surface.implicit(balls(shapes.intersect), box)))
      for name, area in pairs(cap) do
        local radius = name == "first" and a or b
        within(0.14 * circle + 0.02 * area, 4 * pi * radius ^ 2 - area, joined[name], "joined " .. name)
        within(0.14 * circle + 0.02 * area, area, common[name], "common " .. name)
      end
    end
  end)

  it("are those of the primitive that a facet lies on, in random bodies", function()
    math.randomseed(31)
    local random = math.random
    local function place() return {random() * 2 - 1, random() * 2 - 1, random() * 2 - 1} end
    local makers = {
      function() return shapes.sphere(place(), 0.4 + 0.4 * random()) end,
      function()
        local p = place()
        return shapes.box({p[1] - 0.5, p[2] - 0.3, p[3] - 0.4}, {p[1] + 0.3, p[2] + 0.5, p[3] + 0.6})
      end,
      function() return shapes.cylinder(place(), place(), 0.3 + 0.3 * random()) end,
      function() return shapes.torus(place(), place(), 0.6, 0.25) end,
    }
    for _ = 1, 6 do
      local list, primitive = {}, {}
      for i = 1, 4 do
        local made = makers[random(#makers)]()
        if random() < 0.5 then made = shapes.rotate(made, {0.3, 1, -0.5}, random() * 3) end
        if random() < 0.3 then made = shapes.mirror(made, {1, random(), 0}) end
        if random() < 0.3 then made = shapes.translate(made, {0.1, 0, -0.1}) end
        primitive["part " .. i], list[i] = made, shapes.named(made, "part " .. i)
      end
      local body = shapes.cut(shapes.join {list[1], list[2], list[3]}, list[4])
      local cells = 28
      local surface = assert(bw.surface.implicit(body, {min = {-3.5, -3.5, -3.5}, max = {3.5, 3.5, 3.5},
        cells = cells}))
      local reach = sqrt(3) * 7 / cells -- a facet lies in a cell
      local names, groups, points = surface:face_names(), surface.groups, surface.points:totable()
      local alone = 0
      for t, p in ipairs(surface.triangles:totable()) do
        local x, near = {}, 0
        for k = 1, 3 do x[k] = (points[p[1]][k] + points[p[2]][k] + points[p[3]][k]) / 3 end
        for name, f in pairs(primitive) do
          local far = abs(f(x[1], x[2], x[3])) > reach
          if not far then near = near + 1 end
          if far and name == names[groups(t)] then error(name .. " is far from a facet of it") end
        end
        if near == 1 then alone = alone + 1 end
      end
      assert.is_true(alone > surface.triangle_count / 20) -- elsewhere two surfaces are near
    end
  end)

  it("go to fillets, rounded edges and inner walls that have one, else to the nearest surface", function()
    local floor = shapes.named(shapes.box({-1, -1, -1}, {1, 1, 0}), "floor")
    local wall = shapes.named(shapes.box({-1, -1, -1}, {-0.5, 1, 1}), "wall")
    local function name_of(body, ...) return (select(2, body(...))) end
    local filleted = shapes.fillet({floor, wall}, 0.3, "fillet")
    assert.equal("fillet", name_of(filleted, -0.4, 0, 0.1))
    assert.equal("floor", name_of(filleted, 0.5, 0, 0))
    assert.equal("wall", name_of(filleted, -0.5, 0, 0.6))
    local without = shapes.fillet({floor, wall}, 0.3)
    assert.equal("floor", name_of(without, -0.35, 0, 0.03))
    assert.equal("wall", name_of(without, -0.47, 0, 0.15))
    local joined = shapes.join({floor, wall}, 0.3, "blend")
    assert.equal("blend", name_of(joined, -0.45, 0, 0.05))
    assert.equal("floor", name_of(joined, 0.5, 0, 0))
    local cut = shapes.cut(floor, wall, 0.2, "rim")
    assert.equal("rim", name_of(cut, -0.45, 0, -0.05))
    assert.equal("wall", name_of(cut, -0.5, 0, -0.5))
    local ball = shapes.named(shapes.sphere({0, 0, 0}, 1), "outside")
    local shell = shapes.shell(ball, 0.2, "inside")
    assert.equal("outside", name_of(shell, 0.99, 0, 0))
    assert.equal("inside", name_of(shell, 0.81, 0, 0))
    assert.is_nil(name_of(shapes.shell(ball, 0.2), 0.81, 0, 0))
    assert.equal("outside", name_of(shapes.offset(ball, 0.1), 1.1, 0, 0))
    -- Along the foot of a post: quarters of cylinders, and around its corners, by Pappus, a quarter of a torus
    local plate = shapes.named(shapes.box({-2, -2, -1}, {2, 2, 0}), "plate")
    local post = shapes.named(shapes.box({-0.5, -1, -0.5}, {0.5, 1, 1}), "post")
    local surface = assert(bw.surface.implicit(shapes.fillet({plate, post}, 0.3, "fillet"),
      {min = {-2.1, -2.1, -1.1}, max = {2.1, 2.1, 1.1}, cells = 44}))
    local foot = pi / 2 * 0.3 * 6 + pi * 0.3 ^ 2 * (pi - 2)
    within(0.08 * foot, foot, areas(surface).fillet)
  end)

  it("may be given by a function of the place, and replace those of parts", function()
    local box = shapes.named(shapes.box({0, 0, 0}, {3, 2, 1}), "sides")
    local body = shapes.named(box, function(_, _, z) return z > 0.99 and "top" or z < 0.01 and "bottom" or nil end)
    local found = areas(assert(bw.surface.implicit(body, {min = {-0.2, -0.2, -0.2}, max = {3.2, 2.2, 1.2},
      cells = 51})))
    within(0.067 * 10, 6, found.top)
    within(0.067 * 10, 6, found.bottom)
    within(0.067 * 20, 10, found.sides)
    local renamed = assert(bw.surface.implicit(shapes.named(body, "all"), {min = {-0.2, -0.2, -0.2},
      max = {3.2, 2.2, 1.2}, cells = 20}))
    assert.same({"all"}, renamed:face_names())
    assert.same({}, assert(bw.surface.implicit(shapes.sphere({0, 0, 0}, 1), {min = {-2, -2, -2}, max = {2, 2, 2},
      cells = 12})):face_names())
    local bad = function(x, y, z) return x * x + y * y + z * z - 1, {} end
    assert.error_matches(function() bw.surface.implicit(bad, {min = {-2, -2, -2}, max = {2, 2, 2}, cells = 8}) end,
      "the name of a face or nil expected as its second result, got table", 1, true)
    assert.error_matches(function() shapes.named(body, "") end, "not empty", 1, true)
  end)
end)
