-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes the reports that tests/pages/run.mjs opens: FOLDER/report.html, FOLDER/session.html,
-- FOLDER/pulled.html, FOLDER/motion.html, FOLDER/respond.html, FOLDER/warm.html.
local bw = require "barwright"
local mesh = bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.01}, cells = {20, 4, 2}}
local part = bw.model {mesh = mesh, material = bw.material.pla}
local worst = assert(bw.worst_case(part, {force = 5, modes = 4, regions = 2}))
assert(worst:report(arg[1] .. "/report.html"))

-- One bone, half as thick again: the first corner, at (0, 0, 0), goes to (0, -0.005, -0.0025).
local bone = bw.skeleton.create {joints = {a = {0, 0.01, 0.005}, b = {0.1, 0.01, 0.005}},
  bones = {{"a", "b", name = "beam"}}, root = "a"}
part:fix(mesh.boundary:below(1, 0)):gravity {0, 0, -9.81}
local session = assert(bw.edit(part, {skeleton = bone}))
assert(session:bone("beam"):scale(1.5))
assert(session:report(arg[1] .. "/session.html"))

-- A bar pulled at its end, constrained at the other.
local loads = {{place = "max:x", force = {100, 0, 0}}, {place = "max:z", pressure = 1e4}}
local pulled = bw.model {mesh = mesh, material = bw.material.pla}
pulled:fix(mesh.boundary:below(1, 0))
pulled:load {on = mesh.boundary:above(1, 0.1), force = loads[1].force}
pulled:load {on = mesh.boundary:above(3, 0.01), pressure = loads[2].pressure}
local static = assert(pulled:solve())
local static_picture = require "barwright.command.static_picture"
assert(static_picture.report(static, arg[1] .. "/pulled.html",
  static_picture.options(static, "A bar", loads, {"min:x"}), {text = "It is pulled."}))

-- The bar let go of a load that acts at once: 40 frames of 10 ms.
local transient = assert(pulled:transient {step = 1e-4})
local recording = assert(transient:run {time = 0.01, frames = 40, stress_every = 10})
assert(recording:report(arg[1] .. "/motion.html", {title = "A bar under loads that act at once", seconds = 2}))

-- The commands' pages of a bar that is shaken, and of one between heat and air.
assert(mesh:write(arg[1] .. "/bar.msh"))
for _, words in ipairs {
  "respond FOLDER/bar.msh --material pla --fix min:x --base 0,0,1g --to 300 --damping 0.1 "
    .. "--report FOLDER/respond.html",
  "heat FOLDER/bar.msh --material steel --temperature min:x=80C --convection all=10,20C "
    .. "--report FOLDER/warm.html"} do
  local line = ("build/barwright " .. words):gsub("FOLDER", "'" .. arg[1] .. "'")
  local _, _, status = os.execute(line .. " >/dev/null")
  assert(status < 2, line)
end
