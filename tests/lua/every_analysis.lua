-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Every kind of analysis on a small body, printed to the last digit: scripts/check_same_bits compares its runs.
local bw = require "barwright"

local function show(name, ...)
  local list = {...}
  for i, x in ipairs(list) do list[i] = type(x) == "number" and ("%a"):format(x) or bw.json.encode(x:totable()) end
  print(name, table.concat(list, " "))
end

local mesh = bw.mesh.box {max = {0.08, 0.02, 0.01}, cells = {8, 3, 2}, order = 2}
local function body() return bw.model {mesh = mesh, material = bw.material.pla} end
local foot, tip, top = mesh.boundary:below("x", 0), mesh.boundary:above("x", 0.08), mesh.boundary:above("z", 0.01)
local part = body():fix(foot):load {on = tip, force = {-3, 1, -2}}
local static = assert(part:solve())
show("statics", static.displacement, static.von_mises)
show("modes", assert(part:modes {count = 4}).frequencies)
local buckling = assert(part:buckling {count = 2})
show("buckling", table.unpack(buckling.factors))
print(assert(bw.worst_case(body(), {force = 20, contact = 1e-4, modes = 4, regions = 2})))
local response = assert(part:harmonic {range = {10, 3000}, damping = {ratio = 0.02}})
show("harmonic", response:von_mises(500))
print(response:random {psd = {{10, 1}, {3000, 1}}})
local transient = assert(part:transient {step = 1e-4})
print(assert(transient:run {time = 1e-3, stress_every = 5}))
show("transient", transient.displacement)
local drop = assert(body():drop {height = 0.5, down = {-1, -2, -3}})
show("drop", drop.impacts[1].force, drop.impacts[1].duration, drop.peak.stress)
show("contact", assert(part:contact {{on = mesh.boundary:below("z", 0),
  with = bw.rigid.plane {point = {0, 0, -1e-5}, normal = {0, 0, 1}}}}).static.displacement)
local heat = bw.heat {mesh = mesh, material = bw.material.aluminium}
heat:load {on = foot, power = 3}:load {on = top, convection = {coefficient = 20, temperature = 293}}
show("heat", assert(heat:solve()).temperature)

local halves = assert(mesh:split({max = {0.04, 0.02, 0.01}}, "left")):separated "left"
local glued = bw.model {mesh = halves, material = bw.material.pla}
local seam = halves.boundary:plane({0.04, 0, 0}, {1, 0, 0}, 1e-9)
glued:bond {a = seam & halves.boundary:region "left", b = seam & halves.boundary:region "rest"}
glued:fix(halves.boundary:below("x", 0)):load {on = halves.boundary:above("x", 0.08), force = {0, 0, -2}}
show("bond", assert(glued:solve()).displacement)

local skeleton = bw.skeleton.create {root = "a",
  joints = {a = {0, 0.01, 0.005}, b = {0.04, 0.01, 0.005}, c = {0.08, 0.01, 0.005}},
  bones = {{"a", "b", name = "root"}, {"b", "c", name = "arm"}}}
local session = assert(bw.edit(part, {skeleton = skeleton}))
assert(session:bone("arm"):scale {1, 1.2, 1.1})
show("session", assert(session:solve()).von_mises)
