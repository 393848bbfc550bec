-- SPDX-License-Identifier: MIT
-- Study: wall thickness against weight.
--   build/barwright examples/studies/wall_thickness.lua [FOLDER] [--quick]
--
-- A tube sticks out of a wall and carries 50 N at its end. It may be wide or narrow, its wall thick or
-- thin. Light and stiff are at odds: there is no best tube but a front of tubes, none of which is beaten in
-- both. A search by populations finds it; stresses above the limit are not allowed.
local bw = require "barwright"
local quick = arg[#arg] == "--quick"
local folder = arg[1] ~= "--quick" and arg[1] or "out/wall_thickness" .. (quick and "_quick" or "")
local mm, length = 1e-3, 0.12
local shapes, pla = bw.shapes, bw.material.pla

local results = assert(bw.results.open(folder, {script = arg[0], seed = 1}))
local study = bw.study {
  name = "wall thickness", seed = 1, file = results:path(quick and "walls_quick.study" or "walls.study"),
  variables = {
    {name = "radius", unit = "m", min = 6 * mm, max = 14 * mm},
    {name = "wall", unit = "m", min = 1.6 * mm, max = 5 * mm},
  },
  measures = {{name = "mass", unit = "kg"}, {name = "sag", unit = "m"}, {name = "stress", unit = "Pa"}},
  objectives = {{name = "mass", goal = "min"}, {name = "sag", goal = "min"}},
  constraints = {{name = "stress", max = 25e6}},
  design = {"pareto", population = quick and 4 or 12, generations = quick and 1 or 5},
  run = function(point)
    local r, wall = point.radius, point.wall
    local far = {length, 0, 0}
    local tube = shapes.cut(shapes.limb({-r, 0, 0}, far, r), shapes.join {
      shapes.limb({-2 * r, 0, 0}, {length - wall, 0, 0}, r - wall),
      shapes.box({-1, -1, -1}, {0, 1, 1})})
    local surface, message = bw.surface.implicit(tube, {min = {-2 * mm, -r - 2 * mm, -r - 2 * mm},
      max = {length + r + 2 * mm, r + 2 * mm, r + 2 * mm},
      cells = math.ceil((quick and 1.6 or 2) * length / wall)})
    if not surface then return nil, message end
    local mesh
    mesh, message = bw.mesh.fill(surface, {elements = quick and 1000 or 4000, order = 2})
    if not mesh then return nil, message end
    local part = bw.model {mesh = mesh, material = pla}
    part:fix(mesh.boundary:below(1, 0.5 * mm))
    part:load {on = mesh.boundary:above(1, length), force = {0, 0, -50}}
    local static
    static, message = part:solve()
    if not static then return nil, message end
    return {mass = mesh.volume * pla.density, sag = -static.displacement:column(3):min(),
      stress = static.von_mises:max()}
  end,
}
local trials = assert(study:run())
print(trials)

-- The front, lightest first.
local front = trials:front()
table.sort(front, function(a, b) return a.results.mass < b.results.mass end)
for _, trial in ipairs(front) do
  print(("%5.1f g, sags by %.2f mm: radius %4.1f mm, wall %.1f mm, %4.1f MPa"):format(trial.results.mass * 1e3,
    trial.results.sag / mm, trial.point.radius / mm, trial.point.wall / mm, trial.results.stress / 1e6))
end

-- Along a front one measure gets better only while the other gets worse. The beam's formula says which tubes
-- are on it: thin and wide ones, until the stress limit or a bound stops them.
for i = 2, #front do assert(front[i].results.sag < front[i - 1].results.sag) end
assert(trials:plot("pareto"):write(results:path "front.svg"))
assert(trials:report(results:path "walls.html"))
assert(results:write {front_count = #front, mass_lightest_kg = front[1].results.mass,
  sag_stiffest_m = front[#front].results.sag})
