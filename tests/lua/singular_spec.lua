-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Singular places: re-entrant edges of surfaces.
local bw = require "barwright"
local prism = require "prism"

local pi = math.pi

local function l_section()
  return prism({{0, 0}, {2e-2, 0}, {2e-2, 1e-2}, {1e-2, 1e-2}, {1e-2, 3e-2}, {0, 3e-2}}, {5e-3, 5e-3}, 4e-2)
end

describe("the singular edges of a surface", function()
  it("are one for an L-section, with angle and exponent", function()
    local edges = assert(l_section():singular_edges())
    assert.equal(1, #edges)
    local edge = edges[1]
    assert.equal("re-entrant edge", edge.kind)
    assert.near(1.5 * pi, edge.angle, 1e-9)
    assert.near(0.5444837, edge.exponent, 1e-6)
    assert.near(1 - edge.exponent, edge.growth, 1e-15)
    assert.near(4e-2, edge.length, 1e-12)
    assert.equal(2, #edge.points)
    assert.near(-math.sqrt(0.5), edge.inward[1][1], 1e-9)
    local text = tostring(edges)
    assert.truthy(text:find("1 singular place\n", 1, true))
    assert.truthy(text:find("270 degrees inside the material: stress like h^-0.4555", 1, true), text)
  end)

  it("are found near a point", function()
    local edges = assert(l_section():singular_edges())
    local near = assert(edges:near({1e-2, 1.1e-2, 1e-2}, 2e-3))
    assert.near(1e-3, near.distance, 1e-12)
    assert.near(1e-2, near.at[3], 1e-12)
    assert.equal(edges[1], near.place)
    assert.is_nil(edges:near({2e-2, 0, 0}, 2e-3))
    for _, bad in ipairs {{1, 2}, {1, 2, "3"}, {1, 2, 0 / 0}, {1, 2, 3, 4}} do
      assert.error_matches(function() edges:near(bad) end, "three finite numbers")
    end
    assert.equal(1, #edges.list {edges[1]})
    assert.error_matches(function() edges.list {{length = 1}} end, "item 1: a place of singular_edges")
  end)

  it("are none on convex bodies, on facets of a cylinder, and by a wide margin", function()
    assert.equal(0, #assert(bw.surface.box {min = {0, 0, 0}, max = {3, 2, 1}}:singular_edges()))
    local cylinder = bw.surface.cylinder {axis = {0, 0, 1}, radius = 0.3, segments = 20}
    local none = assert(cylinder:singular_edges())
    assert.equal(0, #none)
    assert.equal("no singular places", tostring(none))
    local wide = math.sqrt(3)
    local notched = prism({{-9, -2}, {9, -2}, {9, 1}, {wide, 1}, {0, 0}, {-wide, 1}, {-9, 1}}, {0, -1}, 1)
    assert.equal(1, #assert(notched:singular_edges {angle = 1}))
    assert.equal(0, #assert(notched:singular_edges {angle = 1.1}))
  end)

  it("need a surface with an inside", function()
    local box = bw.surface.box {min = {0, 0, 0}, max = {1, 1, 1}}
    local triangles = box.triangles:totable()
    triangles[#triangles] = nil
    local open = assert(bw.surface.new {points = box.points:totable(), triangles = triangles})
    local edges, message, details = open:singular_edges()
    assert.is_nil(edges)
    assert.truthy(message:find("the surface is open", 1, true))
    assert.equal("geometry", details.status)
    assert.has_error(function() box:singular_edges {angle = 2} end)
    assert.has_error(function() box:singular_edges {corner = 2} end)
  end)
end)

describe("the singular places of a model", function()
  local elastic = bw.material.isotropic {young = 1, poisson = 0.3}

  local function bar(order)
    return assert(bw.mesh.box {min = {0, 0, 0}, max = {2, 1, 1}, cells = {4, 2, 2}, order = order})
  end

  it("are the border of a fixed face", function()
    for order = 1, 2 do
      local mesh = bar(order)
      local part = bw.model {mesh = mesh, material = elastic}
      part:fix(mesh.boundary:below(1, 0))
      local list = assert(part:singular_places())
      assert.equal(4, #list)
      for _, place in ipairs(list) do
        assert.equal("border of a support", place.kind)
        assert.near(0.7112, place.exponent, 1e-4)
        assert.near(pi / 2, place.angle, 1e-12)
        assert.near(1, place.length, 1e-12)
        for _, point in ipairs(place.points) do assert.equal(0, point[1]) end
      end
    end
  end)

  it("are the border of a support inside of a face", function()
    local mesh = bar(1)
    local part = bw.model {mesh = mesh, material = elastic}
    part:fix(mesh.boundary:box({0, 0, 0}, {1, 1, 0}))
    local inside
    for _, place in ipairs(assert(part:singular_places())) do
      if place.points[1][1] == 1 then inside = place end
    end
    assert.near(0.5, inside.exponent, 1e-9)
    assert.near(pi, inside.angle, 1e-12)
    assert.near(1, inside.length, 1e-12)
  end)

  it("are none where faces slide on planes of symmetry", function()
    local mesh = bar(2)
    local part = bw.model {mesh = mesh, material = elastic}
    part:slide(mesh.boundary:below(1, 0), {1, 0, 0}):slide(mesh.boundary:below(2, 0))
    part:prescribe(mesh.boundary:below(3, 0), {false, false, 0})
    part:load {on = mesh.boundary:above(1, 2), traction = {1, 0, 0}}
    assert.equal(0, #assert(part:singular_places()))
  end)

  it("are forces on single nodes and on lines of them, and no area loads", function()
    for order = 1, 2 do
      local mesh = bar(order)
      local part = bw.model {mesh = mesh, material = elastic}
      local area = bw.model {mesh = mesh, material = elastic}
      area:load {on = mesh.boundary:above(1, 2), traction = {1, 0, 0}}
      local rows, force = {}, area:force_vector():totable()
      for i, p in ipairs(mesh.nodes:totable()) do
        rows[i] = force[i]
        if p[1] == 0.5 and p[2] == 0 then rows[i] = {0, 1, 0} end
        if p[1] == 1 and p[2] == 1 and p[3] == 0.5 then rows[i] = {0, 0, 2} end
      end
      part:load {nodal = bw.array.new(rows)}
      local list = assert(part:singular_places())
      assert.equal(2, #list)
      assert.equal("line load", list[1].kind)
      assert.equal(0, list[1].exponent)
      assert.near(1, list[1].length, 1e-12)
      assert.equal("point load", list[2].kind)
      assert.equal(-1, list[2].exponent)
      assert.near(-1, list[2].inward[1][2], 1e-12)
      assert.is_nil(list[2].angle)
      assert.truthy(tostring(list):find("point load at (1000, 1000, 500) mm: stress like h^-2", 1, true))
    end
  end)

  it("are supports on points", function()
    local mesh = bar(1)
    local part = bw.model {mesh = mesh, material = elastic}
    part:fix(mesh.boundary:nearest({1, 0.5, 0}, 1))
    local list = assert(part:singular_places())
    assert.equal(1, #list)
    assert.equal("point support", list[1].kind)
  end)

  it("take re-entrant edges from the surface that was filled", function()
    local surface = l_section()
    local mesh = assert(bw.mesh.fill(surface, {elements = 400}))
    local part = bw.model {mesh = mesh, material = elastic}
    local own, given = assert(part:singular_places()), assert(part:singular_places {surface = surface})
    assert.equal(1, #own)
    assert.equal(1, #given)
    assert.near(given[1].length, own[1].length, 1e-6)
    assert.equal(2, #given[1].points)
    assert.has_error(function() part:singular_places {surface = mesh} end)
  end)
end)
