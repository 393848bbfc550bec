-- Contact from Lua: what it gives, and what it says of misuse. Closed forms are in tests/engine/contact.
local bw = require "barwright"
local check = require "check"

describe("contact", function()
  local mesh = bw.mesh.box {max = {0.3, 0.2, 0.1}, cells = {6, 4, 2}, order = 2}
  local foot, top = mesh.boundary:below("z", 0), mesh.boundary:above("z", 0.1)
  local floor = bw.rigid.plane {point = {0, 0, -1e-3}, normal = {0, 0, 2}}

  local function block(load)
    load.on = top
    return bw.model {mesh = mesh, material = bw.material.steel}:load(load)
  end

  it("carries a free block on a floor", function()
    local contact = assert(block {pressure = 2e6}:contact {{on = foot, with = floor}})
    local pair = contact.pairs[1]
    assert.is_true(math.abs(pair.force[3] - 2e6 * 0.06) < 1e-3)
    assert.is_true(math.abs(pair.area - 0.06) < 1e-9)
    assert.is_true(math.abs(contact.pressure:max() - 2e6) < 10)
    assert.is_true(math.abs(contact.static.displacement:column(3):max() + 1e-3) < 1e-9)
    assert.are.equal(pair.candidates, pair.active)
    assert.are.equal(3, #contact.undetermined)
    assert.matches("nothing decides the translation along %(1, 0, 0%)", tostring(contact))
    assert.matches("%d+ changes of the active set", tostring(contact))
    assert.matches("pair 1: %(0, 0, 120000%) N .*; error unknown: one mesh", tostring(contact))
    assert.matches("^%(0, 0, 120000%) N .*; error unknown: one mesh$", tostring(contact.pairs[1]))
    assert.are.equal("cholesky", contact.report.solver)
    check.fails("unsupported", "load factors do not know contact", contact.static:buckling())
    local path = os.tmpname() .. ".vtu"
    assert(contact:write(path))
    assert.is_not_nil(bw.mesh.read(path))
    os.remove(path)
  end)

  it("gives the same by conjugate gradients", function()
    local pairs = {{on = foot, with = bw.rigid.sphere {centre = {0.15, 0.1, -2}, radius = 2}}}
    local a = assert(block {pressure = 1e7}:contact(pairs, {solver = bw.solver.cholesky {}}))
    local b = assert(block {pressure = 1e7}:contact(pairs, {solver = bw.solver.pcg {tolerance = 1e-10}}))
    assert.is_true(a.pairs[1].active < a.pairs[1].candidates)
    assert.are.equal(a.pairs[1].active, b.pairs[1].active)
    assert.is_true(math.abs(a.pairs[1].pressure - b.pairs[1].pressure) < 1e-5 * a.pairs[1].pressure)
  end)

  it("joins parts of one mesh", function()
    local lower = bw.mesh.box {max = {0.3, 0.2, 0.1}, cells = {4, 3, 2}}
    local upper = bw.mesh.box {min = {0.05, 0.05, 0.1}, max = {0.2, 0.15, 0.2}, cells = {4, 3, 3}}
    local nodes, elements = {}, {}
    for _, mesh_of in ipairs {lower, upper} do
      local first = #nodes
      for i = 1, mesh_of.node_count do
        nodes[#nodes + 1] = {mesh_of.nodes(i, 1), mesh_of.nodes(i, 2), mesh_of.nodes(i, 3)}
      end
      for e = 1, mesh_of.element_count do
        local corners = {}
        for k = 1, 4 do corners[k] = mesh_of.elements(e, k) + first end
        elements[#elements + 1] = corners
      end
    end
    local all = bw.mesh.new {nodes = nodes, elements = elements}
    local part = bw.model {mesh = all, material = bw.material.steel}
    part:fix(all.boundary:below("z", 0)):load {on = all.boundary:above("z", 0.2), force = {0, 0, -1000}}
    local at_joint = all.boundary:plane({0, 0, 0.1}, {0, 0, 1})
    local on = at_joint:facing {0, 0, -1}
    local contact = assert(part:contact {{on = on, with = at_joint:facing {0, 0, 1}, interference = 1e-6}})
    assert.is_true(math.abs(contact.pairs[1].force[3] - 1000) < 1e-3)
    assert.are.equal(3, #contact.undetermined)
    assert.matches("of body 2", contact.undetermined[1])
  end)

  it("has friction, along a path of loads", function()
    local pairs = {{on = foot, with = floor, friction = 0.5}}
    local part = block {pressure = 2e6}
    local pressed = assert(part:contact(pairs))
    assert.matches("friction 0.5: %(0, 0, 0%) N of it", tostring(pressed))
    part:load {on = top, traction = {0.4e6, 0, 0}}
    local sheared = assert(part:contact(pairs, {steps = 2, after = pressed}))
    local pair = sheared.pairs[1]
    assert.are.equal(3, sheared.steps)
    assert.is_true(math.abs(pair.friction[1] + 0.4e6 * 0.06) < 1)
    assert.is_true(pair.stick_area > 0 and pair.stick_area <= pair.area)
    assert.is_true(pair.work >= pressed.pairs[1].work and pair.slip > 0)
    for _, i in ipairs(foot.nodes:totable()) do
      local t = math.sqrt(sheared.traction(i, 1) ^ 2 + sheared.traction(i, 2) ^ 2)
      assert.is_true(t <= 0.5 * sheared.pressure(i) + 1)
    end
    assert.is_true(sheared.status:max() == 2 and sheared.slip:column(1):min() < 0)
    assert.matches("contact with friction", tostring(sheared))
    assert.matches("loads in 3 steps; with friction the result depends on their path", tostring(sheared))
    assert.matches("friction 0.5: %(%-24000, .*sticks on .*took .*; error unknown", tostring(sheared))
    local path = os.tmpname() .. ".vtu"
    assert(sheared:write(path))
    assert.is_not_nil(assert(bw.mesh.read(path)))
    os.remove(path)
    check.raises("both have friction", part.contact, part, {{on = foot, with = floor}}, {after = pressed})
    assert.is_nil(assert(part.contact(block {pressure = 1e6}, {{on = foot, with = floor}})).traction)
    part:fix(mesh.boundary:below("x", 0))
    check.raises("the same supports: these have changed", part.contact, part, pairs, {after = pressed})
    local other = bw.model {mesh = mesh, material = bw.material.pla}:load {on = top, pressure = 2e6}
    check.raises("of the same material", other.contact, other, pairs, {after = pressed})
    local copy = bw.mesh.box {max = {0.3, 0.2, 0.1}, cells = {6, 4, 2}, order = 2}
    other = bw.model {mesh = copy, material = bw.material.steel}
    check.raises("needs its mesh", other.contact, other,
      {{on = copy.boundary:below("z", 0), with = floor, friction = 0.5}}, {after = pressed})
    assert(block {pressure = 2e6}:contact(pairs, {after = pressed})) -- of equal material and supports
    check.raises("option 'after': an open contact", part.contact, part, pairs, {after = 3})
    pressed:close()
    check.raises("option 'after': this contact is closed", part.contact, part, pairs, {after = pressed})
  end)

  it("follows parts that slide over facets", function()
    local nodes, elements = {}, {}
    for body = 0, 1 do
      local box = bw.mesh.box {min = {0.15 * body, 0, 0.1 * body},
        max = {body == 0 and 0.5 or 0.25, 0.1, 0.1 + 0.1 * body},
        cells = {body == 0 and 10 or 3, 2, 2}}
      local first = #nodes
      for _, p in ipairs(box.nodes:totable()) do nodes[#nodes + 1] = {p[1], p[2], p[3] + 1e-6 * body} end
      for _, e in ipairs(box.elements:totable()) do
        for k = 1, #e do e[k] = e[k] + first end
        elements[#elements + 1] = e
      end
    end
    local both = assert(bw.mesh.new {nodes = nodes, elements = elements})
    local part = bw.model {mesh = both, material = bw.material.steel}
    part:fix(both.boundary:below("z", 0))
    part:prescribe(both.boundary:above("z", 0.2 + 1e-6), {0.2, 0, -1e-5})
    local joint = both.boundary:above("z", 0.09):below("z", 0.11)
    local pairs = {{on = joint:facing {0, 0, -1}, with = joint:facing {0, 0, 1}, friction = 0.2}}
    local near = assert(part:contact(pairs))
    local far = assert(part:contact(pairs, {finite_sliding = true, steps = 2}))
    assert.is_true(far.iterations > 2)
    assert.is_true(far.rotation < 1e-3)
    assert.is_true(math.abs(far.pairs[1].slip - 0.2) < 1e-3 and far.pairs[1].force[3] > 1e3)
    assert.is_true(near.iterations == 1)
    assert.matches("slides by 0%.2 m, more than the smallest facet of all pairs, 0%.0408 m", tostring(near))
    assert.falsy(tostring(far):find("slides by", 1, true))
    check.raises("option 'finite_sliding'", part.contact, part, pairs, {finite_sliding = 1})
  end)

  it("says what to do where a curved surface does not converge", function()
    local plate = bw.mesh.box {max = {0.1, 0.1, 0.02}, cells = {6, 6, 1}}
    local part = bw.model {mesh = plate, material = bw.material.steel}
    part:prescribe(plate.boundary:above("z", 0.02), {0.05, 0, -0.009})
    local ball = bw.rigid.sphere {centre = {0.05, 0.05, -0.2}, radius = 0.2}
    local pairs = {{on = plate.boundary:below("z", 0), with = ball}}
    assert.equal(3, assert(part:contact(pairs)).iterations)
    check.fails("convergence", "take more steps", part:contact(pairs, {max_iterations = 2}))
  end)

  it("a gap of rounding is none", function()
    local part = block {pressure = 0}
    part:prescribe(top, {0, 0, 1.7e-5})
    local raised = bw.rigid.plane {point = {0, 0, 1.7e-5}, normal = {0, 0, 1}}
    local contact = assert(part:contact {{on = foot, with = raised}})
    assert.equal(0, contact.pairs[1].gap)
    assert.matches("pair 1: touches without pressure", tostring(contact))
  end)

  it("is undecided where a node alone penetrates", function()
    local plate = bw.mesh.box {max = {0.1, 0.1, 0.02}, cells = {6, 6, 1}}
    local part = bw.model {mesh = plate, material = bw.material.steel}
    part:fix(plate.boundary:above("z", 0.02))
    local ball = bw.rigid.sphere {centre = {0.05, 0.05, 1e-6 - 0.2}, radius = 0.2}
    local contact = assert(part:contact {{on = plate.boundary:below("z", 0), with = ball}})
    assert.matches("pair 1: undecided\n  contact pair 1 is undecided: points penetrate by up to 1e%-06 m",
      tostring(contact))
  end)

  it("is uncertain where flat facets of a round face stay open", function()
    -- a quarter of a ring in a bore: facets of 2.85 mm at a radius of 20 mm, whose sagitta is 0.051 mm
    local flat = bw.mesh.box {cells = {2, 11, 1}}
    local nodes = {}
    for i, x in ipairs(flat.nodes:totable()) do
      local r, angle = 0.01 + 0.01 * x[1], math.pi / 2 * x[2]
      nodes[i] = {r * math.cos(angle), r * math.sin(angle), 0.004 * x[3]}
    end
    local ring = assert(flat:moved(nodes))
    local outer = ring.boundary:where(function(x, y) return math.abs(math.sqrt(x * x + y * y) - 0.02) < 1e-9 end)
    local function notes(gap, smooth)
      local part = bw.model {mesh = ring, material = bw.material.steel}:fix(ring.boundary:below("y", 0))
      local bore = bw.rigid.cylinder {axis = {0, 0, 1}, radius = 0.02 + gap, inside = true}
      return tostring(assert(part:contact {{on = outer, with = bore, smooth = smooth}}))
    end
    local far, near = notes(1e-3, true), notes(1e-7, true)
    assert.matches("pair 1 stays open: its smallest gap is 0.001 m", far)
    assert.falsy(far:find("uncertain", 1, true))
    assert.matches("it stays open by less than the error of its gaps, about %S+ m, .* refine the facets", near)
    assert.falsy(near:find("Set `smooth`", 1, true))
    assert.falsy(notes(1e-4, false):find("uncertain", 1, true))
  end)

  it("says what nothing stops", function()
    local contact, message, details = block {force = {0, 10, -100}}:contact {{on = foot, with = floor}}
    assert.is_nil(contact)
    assert.matches("nothing stops the translation along %(0, 1, 0%)%. Its first 100 m meet no surface%.", message)
    assert.are.equal("unconstrained", details.status)
    assert.are.equal("translation along (0, 1, 0)", details.motion)
    -- an axis far away would tell nothing
    local lifted = block {pressure = -1e4}
    lifted:load {on = top & lifted.mesh.boundary:above("x", 0.15), pressure = -100}
    contact, message, details = lifted:contact {{on = foot, with = floor}}
    assert.is_nil(contact)
    assert.matches("stops the translation along %(0, 0, 1%), with a slight rotation%. Its first %S+ m", message)
    assert.are.equal("translation along (0, 0, 1), with a slight rotation", details.motion)
  end)

  it("prints rigid surfaces", function()
    assert.are.equal("rigid plane through (0, 0, -1) mm, normal (0, 0, 1)", tostring(floor))
    assert.are.equal("rigid sphere about (0, 0, 0) mm, radius 2000 mm, body inside",
      tostring(bw.rigid.sphere {centre = {0, 0, 0}, radius = 2, inside = true}))
  end)

  it("refuses misuse", function()
    local part = block {pressure = 1}
    check.raises("contact: a list of pairs", part.contact, part, {})
    check.raises("contact: pair 1: a table", part.contact, part, {foot})
    check.raises("contact: pair 1: option 'with'", part.contact, part, {{on = foot}})
    check.raises("contact: pair 1: option 'with': a surface of bw.rigid, or an open selection", part.contact,
      part, {{on = foot, with = 3}})
    check.raises("did you mean 'with'", part.contact, part, {{on = foot, wiht = floor}})
    check.raises("option 'normal'", bw.rigid.plane, {})
    check.raises("must be positive", bw.rigid.sphere, {centre = {0, 0, 0}, radius = -1})
  end)
end)
