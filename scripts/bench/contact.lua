-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Contact of two bodies beside one factorisation of their equations: a crowned block on a flat one whose facets do
-- not match. The crown sets how many corners touch.
local bw = require "barwright"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "contact of two bodies beside one factorisation",
  about = "Each body is of N x N x N/2 cells of six tetrahedra, 100 mm wide, with a cell less along x above. "
    .. "The load is 1 kN, with friction also a tenth of it along x. Processor seconds of the equations (assembly, "
    .. "order and factor), and of contact "
    .. "without them. Prints a Markdown table.",
  arguments = {{name = "cells", type = "integer", min = 2, many = true, optional = true,
    what = "cells along an edge of a body (default 26: about 50,000 elements in each)"}},
  options = {
    {name = "order", value = "N", type = "integer", default = 1, min = 1, max = 2, what = "order of elements"},
    {name = "crown", value = "M,M,...", type = "number", list = true, default = {0, 1e-7, 1e-6, 1e-5},
      what = "heights of the crown in metres: 0 touches everywhere"},
    {name = "rough", value = "M", type = "number", default = 0, min = 0,
      what = "largest of random gaps between the faces"},
    {name = "friction", value = "MU", type = "number", default = 0, min = 0,
      what = "coefficient of friction"},
    {name = "repeats", value = "N", type = "integer", default = 3, min = 1, max = 100,
      what = "runs of each; the fastest counts"},
  },
}

local WIDE, HIGH = 0.1, 0.05

-- Numbers from 0 to 1, the same in each run.
local seed = 1
local function random()
  seed = seed * 1103515245 + 12345 & 0x7fffffff
  return seed / 0x7fffffff
end

local function assembly(n, crown)
  seed = 1
  local nodes, elements = {}, {}
  for body = 0, 1 do
    local mesh = assert(bw.mesh.box {min = {0, 0, (body - 1) * HIGH}, max = {WIDE, WIDE, body * HIGH},
      cells = {n - body, n, math.max(1, n // 2)}, order = opts.order})
    local first = #nodes
    for _, p in ipairs(mesh.nodes:totable()) do
      local x, y = 2 * p[1] / WIDE - 1, 2 * p[2] / WIDE - 1
      local lift = body * crown * (x * x + y * y) / 2 * (1 - p[3] / HIGH)
      if body == 1 and p[3] == 0 then lift = lift + opts.rough * random() end
      nodes[#nodes + 1] = {p[1], p[2], p[3] + lift}
    end
    for _, e in ipairs(mesh.elements:totable()) do
      for k = 1, #e do e[k] = e[k] + first end
      elements[#elements + 1] = e
    end
  end
  return assert(bw.mesh.new {nodes = nodes, elements = elements, order = opts.order})
end

print("| elements | unknowns | crown, m | corners | active | changes | solves | equations, s | contact, s "
  .. "| times |")
print "|---|---|---|---|---|---|---|---|---|---|"
for _, n in ipairs(#opts.cells > 0 and opts.cells or {26}) do
  for _, crown in ipairs(opts.crown) do
    local mesh = assembly(n, crown)
    local equations, seconds, contact = math.huge, math.huge, nil
    for _ = 1, opts.repeats do
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      part:fix(mesh.boundary:below("z", -HIGH))
      part:load {on = mesh.boundary:above("z", HIGH), force = {opts.friction > 0 and 100 or 0, 0, -1e3}}
      local joint = mesh.boundary:above("z", -HIGH / 4):below("z", HIGH / 4)
      local start = os.clock()
      local system = assert(part:system {solver = bw.solver.cholesky {}})
      equations, start = math.min(equations, os.clock() - start), os.clock()
      contact = assert(part:contact {{on = joint:facing {0, 0, -1}, with = joint:facing {0, 0, 1},
        friction = opts.friction > 0 and opts.friction or nil}})
      seconds = math.min(seconds, os.clock() - start)
      system:close()
    end
    local pair = contact.pairs[1]
    print(("| %d | %d | %g | %d | %d | %d | %d | %.2f | %.2f | %.2f |"):format(
      mesh.element_count, 3 * mesh.node_count, crown, pair.candidates, pair.active,
      contact.changes, contact.solves, equations, seconds, seconds / equations))
  end
end
