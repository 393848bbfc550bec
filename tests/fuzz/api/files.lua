-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Good files of some formats, for what reads, and studies. Each batch of calls has a new folder of its own,
-- so that no batch reads what another one wrote.
local bw = require "barwright"
local core = require "barwright.core"

local files = {}

local folder = "good"

--- The path of a name in the batch's folder.
function files.path(name)
  return folder .. "/" .. name
end

--- The folder of a batch (that it is in), with the good files and nothing else.
function files.begin(slot)
  folder = tostring(slot or folder)
  if folder ~= "good" then assert(os.execute(("rm -rf %s && cp -r good %s"):format(folder, folder))) end
end

assert(core.make_folder(folder))

local function write(path, text)
  local file = assert(io.open(path, "wb"))
  file:write(text)
  file:close()
end

local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}, cells = {2, 1, 1}})
local surface = mesh:surface()
for _, ending in ipairs {"stl", "obj", "off", "ply"} do assert(surface:write(files.path("good." .. ending))) end
for _, ending in ipairs {"vtu", "msh", "mesh", "inp"} do assert(mesh:write(files.path("good." .. ending))) end
assert(bw.outline.circle({radius = 1, name = "a", tag = "b"}):write(files.path "good.svg"))
assert(bw.outline.circle({radius = 1, name = "a", tag = "b"}):write(files.path "good.dxf"))
assert(bw.picture(surface, files.path "good.png", {width = 64, height = 64}))
assert(bw.skeleton.create({joints = {{0, 0, 0}, {1, 0, 0}}, bones = {{1, 2}}}):write(files.path "good.tgf"))
assert(bw.metamaterial.build({bw.hyperelastic {young = 1e5, poisson = 0.3, density = 1000, name = "soft"},
  bw.hyperelastic {young = 1e6, poisson = 0.3, density = 1000, name = "hard"}}, {directions = 4, magnitudes = 1,
  stretches = 4, voids = false, seed = 3}):write(files.path "good.bwm"))
write(files.path "good.lua", "local bw = require 'barwright'\nlocal session = ...\nreturn session\n")

--- A study of a file.
function files.study(file)
  return bw.study {name = "beam", seed = 7, file = files.path(file), variables = {
      {name = "height", unit = "m", min = 0.01, max = 0.1, scale = "log"},
      {name = "holes", kind = "integer", min = 0, max = 4}, {name = "stiff", kind = "choice", of = {"a",
        "b"}}},
    measures = {{name = "mass", unit = "kg"}, {name = "sag", unit = "m"}}, objectives = {{name = "mass"},
      {name = "sag"}}, constraints = {{name = "sag", max = 0.05}}, design = {"random", count = 3},
    run = function(point) return {mass = point.height * (10 - point.holes), sag = point.height} end}
end

assert(files.study("good.study"):run {workers = 1})

return files
