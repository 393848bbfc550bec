-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The scripts that `barwright new` writes, {summary =, next = what to do with FILE, text =} of each kind. They
-- belong to whoever has them written, and carry no licence. FILE is the name of the file, NAME the same without
-- its ending.
local skeletons = {}

skeletons.part = {summary = "a part from numbers, its STL file, its stress over its strength",
  next = {"barwright FILE", "barwright open FILE"}, text = [=[
-- A part from numbers. `barwright FILE` writes NAME.stl and prints its stress over its strength;
-- `barwright open FILE` opens it in the browser.
local bw = require "barwright"

-- Sizes, in m.
local length, width, height, thickness = 0.06, 0.03, 0.04, 0.005
local force = 20 -- N, downwards at the end of the foot
local material = bw.material.pla -- `barwright materials` lists what is known

-- The shape: a foot and a wall, joined. More: bw.surface.extrude, bw.shapes, body:difference(other).
local foot = bw.surface.box {max = {length, width, thickness}}
local wall = bw.surface.box {max = {thickness, width, height}}
local body = assert(foot:union(wall))
assert(body:write("NAME.stl", {unit = "mm"}))

-- The model: the wall is screwed on at x = 0, the force acts at the other end.
local mesh = assert(bw.mesh.fill(body, {elements = 4000, order = 2}))
local part = bw.model {mesh = mesh, material = material}
part:fix(mesh.boundary:below(1, 0))
part:load {on = mesh.boundary:above(1, length), force = {0, 0, -force}}

-- The answer. An inner edge without a fillet has no finite stress: `barwright check NAME.stl --edges yes`.
local static = assert(part:solve())
print(static)
print(("mass %.1f g, largest stress of an element %.0f %% of the strength, sag %.2f mm"):format(
  1e3 * mesh.volume * material.density, 100 * static.utilisation:max(),
  -1e3 * static.displacement:column(3):min()))

return body
]=]}

skeletons.study = {summary = "a design study: variables, measures, a design of trials",
  next = {"barwright study run FILE", "barwright study report FILE"}, text = [=[
-- A design study of a cantilever. `barwright study run FILE` computes its trials and keeps them;
-- `barwright study report FILE` makes a page of them. docs/howto_study.md has more.
local bw = require "barwright"

return bw.study {
  name = "NAME",
  -- What is varied, in SI units, or of a list.
  variables = {
    {name = "height", unit = "m", min = 0.006, max = 0.02},
    {name = "material", of = {"pla", "aluminium"}},
  },
  -- What is measured, which of it is to be small, and what it may not exceed.
  measures = {{name = "mass", unit = "kg"}, {name = "stress", unit = "Pa"}, {name = "sag", unit = "m"}},
  objectives = {"mass", "sag"},
  constraints = {{name = "stress", max = 20e6}},
  -- Which points: also "grid", "sobol", "morris" and others.
  design = {"latin_hypercube", count = 8, maximin = true},
  -- One trial, in a process of its own: the measures, or nil and a message.
  run = function(point)
    local material = bw.material[point.material]
    local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, point.height}, cells = {10, 2, 2},
      order = 2})
    local part = bw.model {mesh = mesh, material = material}
    part:fix(mesh.boundary:below(1, 0))
    part:load {on = mesh.boundary:above(1, 0.1), force = {0, 0, -20}}
    local static, message, details = part:solve()
    if not static then return nil, message, details end
    return {mass = mesh.volume * material.density, stress = static.von_mises:max(),
      sag = -static.displacement:column(3):min()}
  end,
}
]=]}

skeletons.experiment = {summary = "an experiment that others can repeat to the last bit",
  next = {"barwright FILE", "barwright rerun NAME/manifest.json"}, text = [=[
-- An experiment that can be repeated. `barwright FILE [FOLDER] [FORCE]` writes result.json and manifest.json;
-- `barwright rerun NAME/manifest.json` runs it again and compares. docs/howto_experiments.md has more.
local bw = require "barwright"
local folder, force = arg[1] or "NAME", tonumber(arg[2] or 20)

-- Options and seed are kept in the manifest; name files that the numbers depend on: inputs = {"part.stl"}.
local results = assert(bw.results.open(folder, {options = {force_n = force}, seed = 1}))

local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.01}, cells = {20, 4, 2}, order = 2})
local part = bw.model {mesh = mesh, material = bw.material.pla}
part:fix(mesh.boundary:below(1, 0))
part:load {on = mesh.boundary:above(1, 0.1), force = {0, 0, -force}}

-- Numbers have their unit in the name; seconds_ marks what depends on the machine, and is not compared.
local start = bw.seconds()
local static = assert(part:solve())
assert(results:write {max_von_mises_pa = static.von_mises:max(), sag_m = -static.displacement:column(3):min(),
  seconds_solve = bw.seconds() - start})
print("written: " .. results:path "result.json")
]=]}

skeletons.scenario = {summary = "requirements of a part, as a test",
  next = {"barwright test FILE"}, text = [=[
-- Requirements of a part as a test. `barwright test FILE` says which are met; see docs/howto_scenarios.md.
local bw = require "barwright"
local scenario, expect = bw.scenario, bw.scenario.expect

-- What all of them are about. Of a file: bw.mesh.fill(assert(bw.surface.read "part.stl"), {elements = 20000}).
local function bracket()
  local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.01}, cells = {20, 4, 2}, order = 2})
  local part = bw.model {mesh = mesh, material = bw.material.pla}
  part:fix(mesh.boundary:below(1, 0))
  return part, mesh
end

scenario("it holds 20 N", function(t)
  local part, mesh = bracket()
  part:load {on = mesh.boundary:above(1, 0.1), force = {0, 0, -20}}
  local static = t:require(part:solve()) -- ends the scenario with the message where it fails
  t:picture_of(static)
  expect(static.von_mises:max(), "largest von Mises stress", "Pa"):below(45e6)
  expect(-static.displacement:column(3):min(), "sag of the tip", "m"):below(0.02)
end)

scenario("it has no natural frequency below 100 Hz", {tags = {"modes"}}, function(t)
  local modes = t:require((bracket()):modes {count = 1})
  expect(modes.frequencies[1], "first frequency", "Hz"):above(100)
end)
]=]}

return skeletons
