-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The workbench without a browser: actions on a beam with closed forms, undo to the same bits, scripts that rerun
-- to the same numbers, refusals in words; and its controller with a table in place of the server.
local bw = require "barwright"
local controller = require "barwright.workbench.controller"
local json = require "barwright.json"
local live_pack = require "barwright.live_pack"

local folder = os.tmpname()
os.remove(folder)
os.execute(("mkdir -p '%s'"):format(folder))

local LENGTH, WIDTH, HEIGHT = 0.1, 0.02, 0.01

local function file(name, surface, options)
  local path = folder .. "/" .. name
  assert(surface:write(path, options))
  return path
end

local beam_path = file("beam.stl", bw.surface.box {max = {LENGTH, WIDTH, HEIGHT}})

local function facing(bench, normal)
  for i, face in ipairs(bench:current().body.faces) do
    local n = face.normal
    if n[1] * normal[1] + n[2] * normal[2] + n[3] * normal[3] > 0.99 then return i end
  end
end

local function beam()
  local bench = assert(bw.workbench.open(beam_path))
  return bench, facing(bench, {-1, 0, 0}), facing(bench, {1, 0, 0}), facing(bench, {0, 0, 1})
end

local function bits(number) return ("%a"):format(number) end

local function near(expected, got, tolerance)
  assert.is_true(math.abs(got / expected - 1) < tolerance, ("%g expected, got %g"):format(expected, got))
end

describe("the workbench", function()
  it("lists faces with their area, centre and normal", function()
    local bench, _, right = beam()
    local state = bench:state()
    assert.equal(6, #state.faces)
    near(WIDTH * HEIGHT, state.faces[right].area, 1e-6)
    near(LENGTH, state.faces[right].centre[1], 1e-6)
    assert.equal("plane", state.faces[right].kind)
    assert.is_true(state.units_plausible)
    assert.is_true(state.repair.sound)
    near(LENGTH * WIDTH * HEIGHT * bw.material.pla.density, state.mass, 1e-6)
  end)

  it("answers a cantilever as beam theory does", function()
    local bench, left, right = beam()
    assert(bench:fix {faces = {left}})
    assert(bench:load {faces = {right}, force = {0, 0, -20}})
    local answer = assert(bench:answer {accuracy = "coarse"})
    local young, inertia = bw.material.pla.young, WIDTH * HEIGHT ^ 3 / 12
    near(20 * LENGTH ^ 3 / (3 * young * inertia), answer.max_displacement, 0.02)
    near(3.516 / (2 * math.pi) * math.sqrt(young * inertia
      / (bw.material.pla.density * WIDTH * HEIGHT * LENGTH ^ 4)), answer.frequency, 0.02)
    near(20, answer.load, 1e-6)
    near(20 / answer.utilisation, answer.force, 1e-12)
    assert.is_true(answer.low < answer.utilisation and answer.utilisation < answer.high)
    assert.equal("holds", answer.verdict)
    assert.equal("green", answer.colour)
    -- bending stress at the support, 6 F L / (b h^2), with the concentration of the clamped edge
    local bending = 6 * 20 * LENGTH / (WIDTH * HEIGHT ^ 2) / bw.material.pla.strength
    assert.is_true(answer.utilisation > 0.8 * bending and answer.utilisation < 1.6 * bending)
    -- half way along, where the bending moment is half as large
    local found = assert(bench:probe {point = {LENGTH / 2, WIDTH / 2, HEIGHT}})
    near(bending * bw.material.pla.strength / 2, found.von_mises, 0.05)
    -- the strength times a hundredth breaks
    assert(bench:material {young = young, poisson = 0.35, strength = bw.material.pla.strength / 100,
      density = 1240})
    assert.equal("breaks", assert(bench:answer {accuracy = "coarse"}).verdict)
    local state = bench:state()
    assert.equal(2, #state.conditions)
    assert.truthy(state.conditions[2].text:find("force", 1, true))
    assert.truthy(json.encode(state))
  end)

  it("reruns its script to the same bits", function()
    local bench, left, right, top = beam()
    assert(bench:fix {faces = {left}})
    assert(bench:load {faces = {right}, force = {0.1, 1 / 3, -20}})
    assert(bench:gravity())
    assert(bench:push {faces = {top}, distance = 1 / 700})
    assert(bench:thicken {at = {0.02, 0.01, HEIGHT + 1 / 700}, radius = 0.008, offset = 0.001})
    local answer = assert(bench:answer {accuracy = "coarse"})
    local path = assert(bench:save {path = folder .. "/beam.workbench.lua"})
    local pipe = assert(io.popen(("BARWRIGHT_QUIET=1 build/barwright -e 'local w = dofile(%q) local a = "
      .. "w:current().answer print((\"%%a %%a %%a\"):format(a.utilisation, a.max_displacement, a.frequency))'")
      :format(path)))
    local text = pipe:read "a"
    pipe:close()
    assert.truthy(text:find(("%s %s %s"):format(bits(answer.utilisation), bits(answer.max_displacement),
      bits(answer.frequency)), 1, true), text)
  end)

  it("undoes and redoes everything", function()
    local bench, left, right, top = beam()
    local before = bench:current().body.surface.points:tostring "<f8"
    assert(bench:fix {faces = {left}})
    assert(bench:push {faces = {top}, distance = 0.003})
    assert(bench:load {faces = {right}, force = {0, 0, -20}})
    assert(bench:remove {condition = 1})
    assert(bench:material {name = "steel"})
    assert(bench:lock {faces = {top}})
    local after, script = bench:current().body.surface.points:tostring "<f8", bench:script()
    for _ = 1, 6 do assert(bench:undo()) end
    assert.is_nil(bench:undo())
    assert.equal(before, bench:current().body.surface.points:tostring "<f8")
    assert.same({}, bench:current().conditions)
    for _ = 1, 6 do assert(bench:redo()) end
    assert.is_nil(bench:redo())
    assert.equal(after, bench:current().body.surface.points:tostring "<f8")
    assert.equal(script, bench:script())
  end)

  it("undoes and redoes the choice of a unit and of a thickness, and its script goes along", function()
    local path = file("unsure.stl", bw.surface.box {max = {0.1, 0.02, 0.01}}, {unit = "m"})
    local bench = assert(bw.workbench.open(path))
    local script = bench:script()
    assert(bench:fix {faces = {facing(bench, {-1, 0, 0})}})
    assert(bench:unit {unit = "m"})
    assert.equal("the unit metres", bench:state().undo_words)
    near(0.1, bench:state().size[1], 1e-6)
    assert.is_true(bench:state().units_plausible)
    assert.equal(1, #bench:state().conditions)
    assert(bench:unit {unit = "in"})
    near(0.1 * 0.0254, bench:state().size[1], 1e-6)
    local inches = bench:script()
    assert(bench:undo())
    near(0.1, bench:state().size[1], 1e-6)
    assert.equal("the unit inches", bench:state().redo_words)
    assert.equal("m", bench:state().unit)
    assert(bench:undo())
    near(0.1e-3, bench:state().size[1], 1e-6)
    assert.is_false(bench:state().units_plausible)
    assert.truthy(bench:state().units_message:find("In metres it is 100 x 20 x 10 mm", 1, true))
    assert.is_nil(bench:answer())
    assert(bench:undo())
    assert.equal(script, bench:script())
    for _ = 1, 3 do assert(bench:redo()) end
    assert.equal(inches, bench:script())
    assert.equal(bits(bench:current().body.surface.volume), bits(load(inches)():current().body.surface.volume))
    -- Lengths of an edit are those of its unit: undone with it.
    assert(bench:undo())
    assert(bench:push {faces = {1}, distance = 0.001})
    local made, message = bench:unit {unit = "in"}
    assert.is_nil(made)
    assert.truthy(message:find("undo that", 1, true))

    path = folder .. "/sheet.svg"
    assert(bw.outline.rectangle({width = 0.06, height = 0.02}):write(path))
    bench = assert(bw.workbench.open(path))
    assert(bench:thickness {thickness = 0.002})
    assert.equal("the thickness of 2 mm", bench:state().undo_words)
    assert(bench:undo())
    near(0.003, bench:state().size[3], 1e-9)
    near(0.003, bench:state().thickness, 1e-9)
    assert(bench:redo())
    near(0.002, bench:state().size[3], 1e-9)
  end)

  it("says of every action what is undone", function()
    local bench, left, right, top = beam()
    local function does(words, made, message)
      assert(made, message)
      assert.equal(words, bench:state().undo_words)
    end
    local name = function(face) return bench:state().faces[face].name end
    does("the fixed support of " .. name(left), bench:fix {faces = {left}})
    does("the sliding support of " .. name(top), bench:fix {faces = {top}, kind = "normal"})
    does("the force of 5 N on " .. name(right), bench:load {faces = {right}, force = {3, 0, -4}})
    does("the pressure of 0.1 MPa on " .. name(top), bench:pressure {faces = {top}, pressure = 1e5})
    does("the moment of 2 N m on " .. name(right), bench:moment {faces = {right}, moment = {0, 0, 2}})
    does("gravity", bench:gravity())
    does("the change of the force on " .. name(right), bench:change {condition = 3, vector = {0, 0, -1}})
    does("the removal of gravity", bench:remove {condition = 6})
    does("the material steel", bench:material {name = "steel"})
    does("the material of own values", bench:material {young = 1e9, poisson = 0.3})
    does("the lock of " .. name(left), bench:lock {faces = {left}})
    -- Of the faces that were not locked before, or are no longer.
    does("the lock of " .. name(right), bench:lock {faces = {left, right}})
    does("the unlocking of " .. name(right), bench:lock {faces = {left}})
    does("the lock of " .. name(top) .. " and the unlocking of " .. name(left), bench:lock {faces = {top}})
    local all = {}
    for i = 1, #bench:state().faces do all[i] = i end
    does(("the lock of %d faces"):format(#all - 1), bench:lock {faces = all})
    does("the unchanged locks", bench:lock {faces = all})
    does(("the unlocking of %d faces"):format(#all), bench:lock {faces = {}})
    does("symmetry", bench:symmetry {across = "y"})
    does("the push of " .. name(top) .. " by 1 mm", bench:push {faces = {top}, distance = 0.001})
    does("the offset by 0.5 mm", bench:offset {distance = 0.0005})
    does("the end of symmetry", bench:symmetry {across = "none"})
    does("the thickening by 1 mm at (20, 10, 11.5) mm",
      bench:thicken {at = {0.02, 0.01, 0.0115}, radius = 0.008, offset = 0.001})
    does("the patch", bench:grow {point = {0.09, 0.01, 0.0115}, radius = 0.005})
  end)

  it("prints the deviation from the original, and moves no other point by a bit", function()
    local bench, _, right, top = beam()
    assert.is_nil(bench:state().deviation)
    local same = assert(bench:deviation())
    assert.equal(0, same.largest)
    assert.equal(8, same.unmoved)
    assert(bench:push {faces = {top}, distance = 0.002})
    local found = bench:state().deviation
    near(0.002, found.largest, 1e-9)
    near(HEIGHT + 0.002, found.at[3], 1e-6)
    assert.equal(4, found.unmoved)
    assert.equal(8, found.points)
    assert.truthy(found.text:find("At most 2 mm from the original, at (", 1, true), found.text)
    assert.truthy(found.text:find("4 of 8 points of the original are where they were, bit for bit", 1, true))
    assert.truthy(bench:script():find("print(workbench:deviation())", 1, true))
    -- A corner of two pushed faces lies farther away; a push of -2 mm gives the surface of the file again.
    assert(bench:push {faces = {right}, distance = 0.001})
    near(math.sqrt(0.002 ^ 2 + 0.001 ^ 2), bench:deviation().largest, 1e-6)
    assert(bench:undo())
    assert(bench:thicken {at = {0.02, 0.01, HEIGHT + 0.002}, radius = 0.008, offset = 0.001})
    near(0.003, bench:deviation().largest, 1e-3)
    assert.equal(4, bench:deviation().unmoved)
    -- In a file of single precision too: what was not moved has the bytes of the file that was opened.
    local path, deviation = assert(bench:export {path = folder .. "/deviation.stl"})
    assert.equal(tostring(bench:deviation()), tostring(deviation))
    local function vertices(name)
      local input, set = assert(io.open(name, "rb")), {}
      local bytes = input:read "a"
      input:close()
      for at = 85, #bytes, 50 do
        for k = 1, 3 do set[bytes:sub(at + 12 * k, at + 12 * k + 11)] = true end
      end
      return set
    end
    local before, after, kept = vertices(beam_path), vertices(path), 0
    for vertex in pairs(before) do kept = kept + (after[vertex] and 1 or 0) end
    assert.equal(4, kept)
    for _ = 1, 2 do assert(bench:undo()) end
    assert.is_nil(bench:state().deviation)
    assert.is_nil(bench:script():find("deviation", 1, true))
  end)

  it("pushes planes, keeps neighbours plane, and refuses what crosses itself", function()
    local bench, _, right, top = beam()
    assert(bench:push {faces = {top, right}, distance = 0.002})
    near((LENGTH + 0.002) * WIDTH * (HEIGHT + 0.002), bench:current().body.surface.volume, 1e-9)
    near(WIDTH * (HEIGHT + 0.002), bench:state().faces[right].area, 1e-6)
    local made, message = bench:push {faces = {top}, distance = -0.05}
    assert.is_nil(made)
    assert.truthy(message:find("smaller distance", 1, true))
    assert(bench:lock {faces = {top}})
    made, message = bench:push {faces = {top}, distance = 0.001}
    assert.is_nil(made)
    assert.truthy(message:find("locked", 1, true))
    local volume = bench:current().body.surface.volume
    assert(bench:offset {distance = 0.001}) -- all faces but the locked one
    near((LENGTH + 0.004) * (WIDTH + 0.002) * (HEIGHT + 0.003), bench:current().body.surface.volume, 1e-9)
    assert.is_true(bench:current().body.surface.volume > volume)
    assert(bench:undo())
    assert.equal(bits(volume), bits(bench:current().body.surface.volume))
  end)

  it("gives a rod another radius", function()
    local path = file("rod.stl", bw.surface.cylinder {axis = {0, 0, 0.04}, radius = 0.008, segments = 64})
    local bench, round = assert(bw.workbench.open(path)), nil
    for i, face in ipairs(bench:current().body.faces) do round = face.kind == "cylinder" and i or round end
    local before = bench:current().body.surface.volume
    assert(bench:radius {face = round, radius = 0.012})
    near(before * 1.5 ^ 2, bench:current().body.surface.volume, 1e-6)
    assert.equal(0.012, bench:state().faces[round].radius)
    local made, message = bench:radius {face = round == 1 and 2 or 1, radius = 0.01}
    assert.is_nil(made)
    assert.truthy(message:find("no radius", 1, true))
  end)

  it("refuses in words what cannot be computed", function()
    local bench, left, right = beam()
    assert(bench:fix {faces = {left}})
    local function refused(text, made, message)
      assert.is_nil(made)
      assert.truthy(message:find(text, 1, true), message)
    end
    refused("a load on a support does nothing", bench:load {faces = {left}, force = {0, 0, -1}})
    assert.error_matches(function()
      bench:load {faces = {99}, force = {0, 0, -1}}
    end, "there is no face 99", 1, true)
    assert.error_matches(function() bench:load {faces = {}, force = {0, 0, -1}} end, "choose one face", 1, true)
    assert.error_matches(function()
      bench:load {faces = {right}, force = {0, 0 / 0, 1}}
    end, "three numbers", 1, true)
    assert(bench:gravity())
    assert(bench:change {condition = 1, faces = {1, 2, 3, 4, 5, 6}})
    refused("Every face is fixed", bench:answer {accuracy = "coarse"})
    assert(bench:remove {condition = 1})
    refused("No face is fixed", bench:answer {accuracy = "coarse"})
    assert(bench:fix {faces = {left}, kind = "normal"})
    refused("leave the part free to move", bench:answer {accuracy = "coarse"})
    assert.error_matches(function() bench:remove {condition = 7} end, "no support or load 7", 1, true)
    assert.has_error(function() bench:fix {surfaces = {1}} end)
  end)

  it("says in the words of the page where a load goes into the fixed faces around it", function()
    local bench, _, right = beam()
    bench:current().body.faces[7] = {name = "free form 1", kind = "free form", area = 1e-12, normal = {1, 0, 0},
      centre = {LENGTH, WIDTH / 2, HEIGHT / 2}} -- smaller than all elements: it takes a facet of the right face
    assert(bench:fix {faces = {right}})
    assert(bench:load {faces = {7}, force = {0, 0, -10}})
    local answer, message = bench:answer {accuracy = "coarse"}
    assert.is_nil(answer)
    assert.truthy(message:find("The force on free form 1", 1, true), message)
    assert.truthy(message:find("press Remove beside the support", 1, true))
    assert.is_nil(message:find("metres", 1, true))
  end)

  it("balances loads without a support", function()
    local bench, left, right = beam()
    assert(bench:load {faces = {left}, force = {-100, 0, 0}})
    assert(bench:load {faces = {right}, force = {100, 0, 0}})
    local answer = assert(bench:answer {accuracy = "coarse"})
    near(100 / (WIDTH * HEIGHT), answer.max_stress, 0.05)
    -- Of a free beam the first that bends it, not one of a rigid body; shear lowers it by about 3 %.
    local pla = bw.material.pla
    near(22.373 / (2 * math.pi) * math.sqrt(pla.young * HEIGHT ^ 2 / (12 * pla.density * LENGTH ^ 4)),
      answer.frequency, 0.05)
  end)

  it("computes nothing for an implausible size until the unit is confirmed", function()
    local path = file("tiny.stl", bw.surface.box {max = {0.1, 0.02, 0.01}}, {unit = "m"})
    local bench = assert(bw.workbench.open(path))
    assert.is_false(bench:state().units_plausible)
    local answer, message = bench:answer()
    assert.is_nil(answer)
    assert.truthy(message:find("Nothing was computed", 1, true))
    assert(bench:unit {unit = "m"})
    assert.is_true(bench:state().units_plausible)
    near(0.1, bench:state().size[1], 1e-6)
    assert.truthy(bench:script():find('unit = "m"', 1, true))
  end)

  it("grows a patch from a triangle within a face without lines", function()
    local path = file("ball.stl", bw.surface.implicit("x^2 + 2 * y^2 + 3 * z^2 + x * y / 2 - 4e-4",
      {min = {-0.03, -0.03, -0.03}, max = {0.03, 0.03, 0.03}, cells = 24}))
    local bench = assert(bw.workbench.open(path))
    local count, area = #bench:current().body.faces, 0
    for _, face in ipairs(bench:current().body.faces) do area = area + face.area end
    assert(bench:fix {faces = {1}})
    assert(bench:grow {triangle = 1, angle = 0.2})
    local patch = bench:state().faces[bench.grown_faces[1]]
    assert.equal(count + 1, #bench:state().faces)
    assert.is_true(patch.area > 0 and patch.area < 0.1 * area)
    local sum = 0
    for _, face in ipairs(bench:current().body.faces) do sum = sum + face.area end
    near(area, sum, 1e-9)
  end)

  it("advises places with gains of a new analysis, applies them, keeps the best of optimising", function()
    local lever = bw.surface.box {max = {0.07, 0.02, 0.006}} -- with a neck in the middle
    for _, y in ipairs {-0.01, 0.014} do
      lever = assert(lever:difference(bw.surface.box {min = {0.03, y, -0.01}, max = {0.045, y + 0.016, 0.02}}))
    end
    local bench, left, right = assert(bw.workbench.open(file("lever.stl", lever))), nil, nil
    for i, face in ipairs(bench:state().faces) do
      if face.centre[1] < 1e-6 then left = i elseif face.centre[1] > 0.07 - 1e-6 then right = i end
    end
    assert(bench:fix {faces = {left}})
    assert(bench:load {faces = {right}, force = {0, 0, -12}})
    local before = assert(bench:answer {accuracy = "coarse"}).utilisation
    local list = assert(bench:advice())
    assert.is_true(#list > 0)
    for i = 2, #list do assert.is_true(list[i].gain <= list[i - 1].gain) end
    assert(bench:apply {advice = 1})
    near(before / (1 + list[1].gain), assert(bench:answer {accuracy = "coarse"}).utilisation, 1e-9)
    assert(bench:undo())
    assert(bench:optimise {factor = 1000, steps = 1})
    assert.truthy(bench:state().note:find("the surface was moved by up to %d"), bench:state().note)
    assert.truthy(bench:state().note:find("the best that was found", 1, true))
    near(before / (1 + list[1].gain), assert(bench:answer {accuracy = "coarse"}).utilisation, 1e-9)
  end)

  it("thickens without loads, and the script has the accuracy", function()
    local bench = beam()
    assert(bench:answer {accuracy = "coarse", force = 5})
    local volume = bench:current().body.surface.volume
    assert(bench:optimise {force = 2000, steps = 1})
    local body = bench:current().body
    assert.is_true(body.surface.volume > volume)
    assert.truthy(bench:script():find('accuracy = "coarse"', 1, true))
    assert(bench:undo())
    assert(bench:symmetry {across = "x"})
    local made, message = bench:optimise {force = 2000, steps = 1, accuracy = "coarse"}
    assert.is_nil(made)
    assert.truthy(message:find("switch the symmetry off", 1, true))
  end)

  it("checks what is tried before it moves the mesh of a drag", function()
    local bench, left, right, top = beam()
    assert(bench:fix {faces = {left}})
    assert(bench:load {faces = {right}, force = {0, 0, -20}})
    assert(bench:try {push = {faces = {top}, distance = 1e-3}})
    for _, wrong in ipairs {{faces = {top}}, {faces = {top}, distance = "x"}, {faces = {{}}, distance = 1e-3},
      {faces = {top}, distance = 1e-3, more = 1}} do
      assert.error_matches(function() bench:try {push = wrong} end, "push")
    end
    assert.error_matches(function() bench:try {} end, "push, radius or offset")
  end)

  it("drags alike whether a drag was prepared or not", function()
    local bench, left, right, top = beam()
    assert(bench:prepare_drag()) -- without loads there is nothing to be done
    assert(bench:fix {faces = {left}})
    assert(bench:load {faces = {right}, force = {0, 0, -20}})
    local push = {push = {faces = {top}, distance = 2e-3}}
    local first = assert(bench:try(push))
    assert.equal(bits(first.max_stress), bits(assert(bench:try(push)).max_stress))
    local other = beam()
    assert(other:fix {faces = {left}})
    assert(other:load {faces = {right}, force = {0, 0, -20}})
    assert.equal(other, other:prepare_drag {push = {faces = {top}, distance = 1e-3}})
    near(first.max_stress, assert(other:try(push)).max_stress, 1e-9)
    -- At rest, and so far that the surface would cross itself.
    near(LENGTH * WIDTH * HEIGHT * bw.material.pla.density,
      assert(other:try {push = {faces = {top}, distance = 0}}).mass, 1e-6)
    local made, message = other:try {push = {faces = {top}, distance = -0.05}}
    assert.is_nil(made)
    assert.truthy(message:find("smaller distance", 1, true), message)
    assert(bench:lock {faces = {top}})
    made, message = bench:prepare_drag(push)
    assert.is_nil(made)
    assert.truthy(message:find("locked", 1, true), message)
  end)

  it("follows a dragged face with one coarse mesh, near the answer of the edit", function()
    local bench, left, right, top = beam()
    assert(bench:fix {faces = {left}})
    assert(bench:load {faces = {right}, force = {0, 0, -20}})
    local elements
    for i = 1, 3 do
      local distance = i * 1e-3
      local answer, static = bench:try {push = {faces = {top}, distance = distance}}
      assert(answer, static)
      elements = elements or answer.elements
      assert.equal(elements, answer.elements) -- the mesh of the first step
      near(LENGTH * WIDTH * (HEIGHT + distance) * bw.material.pla.density, answer.mass, 1e-6)
      near(20 * LENGTH ^ 3 / (3 * bw.material.pla.young * WIDTH * (HEIGHT + distance) ^ 3 / 12),
        answer.max_displacement, 0.05)
    end
    near(HEIGHT, bench:state().size[3], 1e-9) -- nothing has changed
  end)

  it("edits both sides of a symmetric part, and refuses what has no other side", function()
    local bench, _, right = beam()
    assert(bench:symmetry {across = "x"})
    assert(bench:push {faces = {right}, distance = 0.002})
    near(LENGTH + 0.004, bench:state().size[1], 1e-9)
    assert(bench:thicken {at = {LENGTH, 0.01, 0.005}, radius = 0.004, offset = 0.001})
    local box = bench:current().body.surface.box
    near(box.max[1] - LENGTH, -box.min[1], 1e-6)
    assert(bench:undo())
    assert(bench:grow {point = {0.09, 0.01, HEIGHT}, radius = 0.008})
    assert.equal("plane", bench:state().faces[bench.grown_faces[1]].kind)
    local made, message = bench:push {faces = bench.grown_faces, distance = 1e-4}
    assert.is_nil(made)
    assert.truthy(message:find("Nothing lies opposite", 1, true))
    local lever = file("wedge.stl", assert(bw.surface.box({max = {0.04, 0.02, 0.01}}):difference(
      bw.surface.box {min = {0.03, -0.01, 0.005}, max = {0.05, 0.03, 0.02}})))
    made, message = assert(bw.workbench.open(lever)):symmetry {across = "x"}
    assert.is_nil(made)
    assert.truthy(message:find("no mirror images", 1, true))
  end)

  it("makes a body of a drawing, of the thickness that is chosen", function()
    local path = folder .. "/sign.svg"
    assert(bw.outline.rectangle({width = 0.06, height = 0.02}):write(path))
    local bench = assert(bw.workbench.open(path))
    near(0.003, bench:state().thickness, 1e-9)
    assert(bench:thickness {thickness = 0.002})
    near(0.06 * 0.02 * 0.002, bench:current().body.surface.volume, 1e-9)
    assert.truthy(bench:script():find("thickness = 0.002", 1, true))
    -- Where the long sides are larger than the drawing, numbers mean other faces.
    assert(bench:fix {faces = {1}})
    local made, message = bench:thickness {thickness = 0.03}
    assert.is_nil(made)
    assert.truthy(message:find("other numbers", 1, true))
    -- What was undone is lost with the former thickness; a shape that was changed keeps it.
    assert(bench:push {faces = {1}, distance = 1e-3})
    assert(bench:undo())
    assert(bench:thickness {thickness = 0.0025})
    made, message = bench:redo()
    assert.is_nil(made)
    assert.truthy(message:find("nothing", 1, true), message)
    assert(bench:push {faces = {1}, distance = 1e-3})
    made, message = bench:thickness {thickness = 0.002}
    assert.is_nil(made)
    assert.truthy(message:find("undo that", 1, true), message)
    made, message = beam():thickness {thickness = 0.002}
    assert.is_nil(made)
    assert.truthy(message:find("push a face", 1, true))
  end)

  it("makes faces of what lies in a rectangle, and keeps their supports", function()
    local bench, _, _, top = beam()
    assert(bench:fix {faces = {top}})
    local planes = {{1, 0, 0, -1}, {-1, 0, 0, -LENGTH / 2}} -- x up to the middle
    assert(bench:patch {planes = planes, towards = {0, 0, 1}})
    assert.equal(7, #bench:state().faces)
    assert.same({top, 7}, bench:current().conditions[1].faces)
    local made, message = bench:patch {planes = {{1, 0, 0, 1}}, towards = {0, 0, 1}}
    assert.is_nil(made)
    assert.truthy(message:find("Nothing of the part", 1, true))
  end)
end)

describe("the workbench's controller", function()
  teardown(function() os.execute(("rm -r '%s'"):format(folder)) end)

  local function served()
    local sent, pages = {}, {}
    local server = {}
    function server.send(_, _, bytes, options) sent[#sent + 1] = {bytes, options} return true end
    function server.serve(_, path, _, bytes) pages[path] = bytes end
    function server.receive() end
    local self = controller.new(server)
    local function last(kind)
      for i = #sent, 1, -1 do
        local message = not sent[i][2] and json.decode(sent[i][1])
        if message and message.type == kind then return message end
      end
    end
    local function scene()
      for i = #sent, 1, -1 do
        if sent[i][2] then return live_pack.read(sent[i][1]) end
      end
    end
    local function message(value) self:handle {{1, "message", json.encode(value)}} end
    self:handle {{1, "open", ""}}
    return self, message, last, scene, pages
  end

  it("sends the shape with its faces, acts, refuses, and exports", function()
    local self, message, last, scene, pages = served()
    message {id = 1, ["do"] = "fix", faces = {1}}
    assert.truthy(last "refused".message:find("No part is open", 1, true))
    assert(self:open(beam_path))
    local header, blocks = scene()
    assert.equal("shape", header.kind)
    assert.equal(12, header.triangles)
    assert.equal(48, #blocks.faces)
    message {id = 2, ["do"] = "fix", faces = {5}}
    assert.equal(2, last "done".id)
    message {id = 3, ["do"] = "load", faces = {5}, force = {0, 0, -1}}
    assert.equal(3, last "refused".id)
    assert.truthy(last "state".message.text:find("is fixed and cannot be loaded", 1, true))
    message {id = 4, ["do"] = "load", faces = {6}, force = {0, 0, -1}}
    assert.is_nil(last "state".message)
    message {id = 5, ["do"] = "answer", accuracy = "coarse"}
    assert.equal("green", last "state".answer.colour)
    header, blocks = scene()
    assert.equal("result", header.kind)
    assert.equal(4 * header.points, #blocks.von_mises)
    message {id = 6, ["do"] = "drag", push = {faces = {2}, distance = 0.001}}
    assert.truthy(last "drag".latency_ms)
    message {id = 7, ["do"] = "undo"}
    assert.truthy(last "done".message:find("^Undone: the force of 1 N on "))
    header = scene()
    assert.equal("shape", header.kind)
    message {id = 8, ["do"] = "export", format = "stl"}
    assert.equal(684, #pages[last "file".url])
    local signs = {glb = "^glTF", usda = "^#usda 1.0", step = "^ISO%-10303%-21;", ["3mf"] = "^PK", off = "^OFF"}
    for format, sign in pairs(signs) do
      message {id = 8, ["do"] = "export", format = format}
      assert.truthy(pages[last "file".url]:find(sign), format)
    end
    message {id = 9, ["do"] = "export", format = "../x"}
    assert.equal(9, last "refused".id)
    message {id = 10, ["do"] = "open", path = beam_path}
    assert.equal(10, last "refused".id)
    for _, text in ipairs {"", "[]", "7", "{}", '{"do":7}', '{"do":"fix"}', '{"do":"fix","faces":7}',
      '{"do":"fix","faces":[1],"more":1}', '{"do":"load","faces":[2],"force":{"x":1}}', '{"do":"__index"}'} do
      self:handle {{1, "message", text}}
    end
    assert.equal(1, #last "state".conditions)
  end)

  -- The body of work, and how often a mesh was filled in it.
  local function counting(work)
    local body, count = require "barwright.workbench.body", 0
    local fill = body.mesh
    function body.mesh(...)
      count = count + 1
      return fill(...)
    end
    local ok, why = pcall(work)
    body.mesh = fill
    assert(ok, why)
    return count
  end

  it("prepares a drag while nobody asks for anything, and lets a request go first", function()
    local self, message, last = served()
    assert(self:open(beam_path))
    self:idle()
    message {id = 1, ["do"] = "fix", faces = {5}}
    message {id = 2, ["do"] = "load", faces = {6}, force = {0, 0, -1}}
    message {id = 3, ["do"] = "prepare", push = {faces = {2}, distance = 0.001}}
    -- A request that arrives meanwhile is done before the preparation goes on.
    local arrives, masses = {1, "message", json.encode {id = 4, ["do"] = "material", name = "steel"}}, {}
    function self.server.receive()
      local event = arrives
      arrives = nil
      if event then return table.unpack(event) end
    end
    assert.equal(2, counting(function() self:idle() end))
    assert.equal(4, last "done".id)
    assert.equal(0, counting(function()
      self:idle()
      for i = 1, 3 do
        message {id = 4 + i, ["do"] = "drag", push = {faces = {2}, distance = i * 1e-3}}
        masses[i] = last "drag".answer.mass
        assert.truthy(last "drag".answer.sentence:find("coarse", 1, true))
      end
    end))
    near(masses[3] - masses[2], masses[2] - masses[1], 1e-6)
    -- A drag needs the preparation, and waits for it.
    message {id = 8, ["do"] = "push", faces = {2}, distance = 1e-3}
    arrives = {1, "message", json.encode {id = 9, ["do"] = "drag", push = {faces = {2}, distance = 1e-3}}}
    assert.equal(1, counting(function() self:idle() end))
    assert.equal(9, last "done".id)
    near(masses[2], last "drag".answer.mass, 1e-6)
    -- Faces that are not there prepare nothing and say nothing.
    message {id = 10, ["do"] = "prepare", push = {faces = {77}, distance = 1e-3}}
    self:idle()
    assert.equal(10, last "done".id)
  end)

  it("opens a dropped file, and runs no dropped script", function()
    local self, _, last, scene = served()
    local input = assert(io.open(beam_path, "rb"))
    local bytes = input:read "a"
    input:close()
    self:handle {{0, "upload", "name=..%2f..%2fmy%20beam.stl\n" .. bytes}}
    assert.equal("shape", scene().kind)
    assert.equal("_.._my beam.stl", last "state".file)
    assert.truthy(last "state")
    self:handle {{0, "upload", "name=evil.lua\nos.exit(7)"}}
    assert.truthy(last "state".message.text:find("script", 1, true))
    self:handle {{0, "upload", "name=broken.stl\nnothing"}}
    assert.truthy(last "state".message.text)
    assert.equal(6, #last "state".faces)
    self:finish()
  end)
end)
