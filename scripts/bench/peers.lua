-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- One bracket of quadratic tetrahedra under a load at its end, solved by CalculiX from the input deck that
-- barwright writes, and by barwright itself, in one run on one machine: wall seconds of CalculiX's whole job
-- (its reading of the deck and printing of displacements included) and of barwright's from the model to von Mises
-- stress at every node, and how far the displacements differ.
package.path = (arg[0]:match "^(.*)/" or ".") .. "/?.lua;" .. package.path
local bw = require "barwright"
local core = require "barwright.core"
local options = require "options"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "one bracket of quadratic tetrahedra, solved by CalculiX and by barwright",
  about = "Prints one JSON object. The program ccx (Debian package calculix-ccx) must be installed.",
  options = {options.elements(20000)},
}
if not os.execute "command -v ccx >/dev/null 2>&1" then
  script.stop(1, "ccx is not installed (Debian package calculix-ccx)")
end

-- A bracket: a plate to be screwed on, an arm, a rib.
local mm, shapes = 1e-3, bw.shapes
local body = shapes.join({
  shapes.box({0, -20 * mm, 0}, {6 * mm, 20 * mm, 50 * mm}),
  shapes.box({0, -10 * mm, 0}, {70 * mm, 10 * mm, 6 * mm}),
  shapes.limb({2 * mm, 0, 40 * mm}, {60 * mm, 0, 3 * mm}, 3 * mm),
}, 2 * mm)
local surface = assert(bw.surface.implicit(body,
  {min = {-2 * mm, -22 * mm, -4 * mm}, max = {74 * mm, 22 * mm, 54 * mm}, cells = 70}))
local mesh = assert(bw.mesh.fill(surface, {elements = opts.elements, order = 2}))
local part = bw.model {mesh = mesh, material = bw.material.pla}
part:fix(mesh.boundary:below(1, 1 * mm))
part:load {on = mesh.boundary:above(1, 68 * mm), force = {0, 0, -20}}

local folder = assert(core.temporary_folder())
local stem = folder.path .. "/part"
assert(part:write_inp(stem .. ".inp"))
local threads = bw.threads()

local function run(command)
  local start = bw.seconds()
  local ok = os.execute(("OMP_NUM_THREADS=%d CCX_NPROC_EQUATION_SOLVER=%d %s >'%s.log' 2>&1"):format(threads,
    threads, command, stem))
  return ok and bw.seconds() - start
end
local calculix = assert(run(("ccx -i '%s'"):format(stem)), "ccx failed")

local start = bw.seconds()
local static = assert(part:solve())
local max_stress = static.von_mises:max()
local own = bw.seconds() - start

-- Displacements that CalculiX printed: lines of node, x, y, z.
local u, own_u, difference, max = {}, static.displacement, 0, 0
for line in io.lines(stem .. ".dat") do
  local node, x, y, z = line:match "^%s*(%d+)%s+(%S+)%s+(%S+)%s+(%S+)%s*$"
  if node and not u[tonumber(node)] then u[tonumber(node)] = {tonumber(x), tonumber(y), tonumber(z)} end
end
for node, value in pairs(u) do
  for k = 1, 3 do
    difference = math.max(difference, math.abs(own_u[node][k] - value[k]))
    max = math.max(max, math.abs(value[k]))
  end
end
folder:close()

print(bw.json.encode({elements = mesh.element_count, nodes = mesh.node_count, threads = threads,
  seconds_calculix = calculix, seconds_barwright = own, ratio = calculix / own,
  relative_difference = difference / max, compared_nodes = #u, max_von_mises_pa = max_stress}, "  "))
