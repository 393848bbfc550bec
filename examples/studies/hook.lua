-- SPDX-License-Identifier: MIT
-- Study: a hook made safe against its worst load.
--   build/barwright examples/studies/hook.lua [FOLDER] [--quick]
--
-- Nobody says how the hook will be pulled. The optimiser scales its limbs until the worst load of all (found again
-- after each round, until it no longer changes) leaves no stress above the limit, and changes the shape as
-- little as that takes. The study asks what safety costs: how much heavier for a stronger hand?
local bw = require "barwright"
local quick = arg[#arg] == "--quick"
local folder = arg[1] ~= "--quick" and arg[1] or "out/hook" .. (quick and "_quick" or "")
local mm, MPa = 1e-3, 1e6

-- 1. The hook with a skeleton of four bones, made once.
local top, eye, bend, tip = {0, 0, 60 * mm}, {0, 0, 25 * mm}, {18 * mm, 0, 0}, {40 * mm, 0, 14 * mm}
local shapes = bw.shapes
local surface = assert(bw.surface.implicit(shapes.join({shapes.limb(top, eye, 7 * mm),
  shapes.limb(eye, bend, 6 * mm), shapes.limb(bend, tip, 5 * mm)}, 3 * mm),
  {min = {-12 * mm, -12 * mm, -10 * mm}, max = {50 * mm, 12 * mm, 72 * mm}, cells = 60}))
local mesh = assert(bw.mesh.fill(surface, {elements = quick and 2500 or 6000, order = 2}))
local pla = bw.material.pla
local skeleton = bw.skeleton.create {joints = {top = top, eye = eye, bend = bend, tip = tip}, root = "top",
  bones = {{"top", "eye", name = "shank"}, {"eye", "bend", name = "throat"}, {"bend", "tip", name = "point"}}}
local opts = {pressure = 1e6, modes = quick and 3 or 8, regions = 2}

local function worst_of(part, force)
  local options = {force = force}
  for key, value in pairs(opts) do options[key] = value end
  return bw.worst_case(part, options)
end

local limit = 12 * MPa
local results = assert(bw.results.open(folder, {script = arg[0], seed = 1}))
local study = bw.study {
  name = "safe hook", seed = 1, file = results:path(quick and "hook_quick.study" or "hook.study"),
  variables = {{name = "force", unit = "N", min = 60, max = 240}},
  measures = {{name = "before", unit = "Pa"}, {name = "after", unit = "Pa"}, {name = "mass", unit = "kg"},
    {name = "moved", unit = "m"}, {name = "rounds"}},
  objectives = {{name = "mass", goal = "min"}},
  design = {"grid", levels = quick and 2 or 4},
  run = function(point, trial)
    local part = bw.model {mesh = mesh, material = pla}
    local before, message = worst_of(part, point.force)
    if not before then return nil, message end
    local session = assert(bw.edit(part, {skeleton = skeleton}))
    local options = {force = point.force}
    for key, value in pairs(opts) do options[key] = value end
    local found
    found, message = session:optimise {von_mises = limit, max_factor = 2.5, loads = "worst", worst = options}
    if not found then return nil, message end
    assert(session:picture(trial.folder .. "/hook.png"))
    assert(assert(session:surface()):write(trial.folder .. "/hook.stl"))
    -- The check is a new worst case on the shape that was found.
    local after = assert(worst_of(session.part, point.force))
    return {before = before.max_principal, after = after.max_principal,
      mass = session.part.mesh.volume * pla.density, moved = found.mean_move,
      rounds = #found.rounds}
  end,
}
local trials = assert(study:run())
print(trials)
for _, trial in ipairs(trials) do
  if trial.status == "done" then
    print(("%3.0f N: worst case %5.1f MPa before, %5.1f MPa after, %5.1f g (%.1f g as drawn)"):format(
      trial.point.force, trial.results.before / MPa, trial.results.after / MPa, 1e3 * trial.results.mass,
      1e3 * mesh.volume * pla.density))
  else
    print(("%3.0f N: %s"):format(trial.point.force, trial.message))
  end
end
assert(trials:report(results:path "hook.html"))
local done = trials:column "after"
assert(#done > 0)
assert(results:write {hooks = #done, limit_pa = limit, after_largest_pa = math.max(table.unpack(done))})
