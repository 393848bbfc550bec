-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes docs/images/edit.png: the horse of scripts/agile as drawn, and posed and strengthened.
local root = arg[0]:match "^(.*)/scripts/docs/[^/]*$" or "."
package.path = root .. "/scripts/agile/?.lua;" .. package.path
local bw = require "barwright"
local scenes = require "scenes"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "docs/images/edit.png: the horse of scripts/agile as drawn, and posed and strengthened",
  arguments = {{name = "out", type = "file", endings = {"png"}, optional = true, what = "another file"}},
}

local points, triangles, values = {}, {}, {}

-- Adds the boundary of a tet10 mesh with its stresses, moved by a vector; each facet in four, so that
-- the stresses of mid-edge nodes show.
local function add(mesh, von_mises, by)
  local number, nodes = {}, mesh.nodes
  for _, facet in ipairs(mesh.facets:totable()) do
    local at = {}
    for k, node in ipairs(facet) do
      if not number[node] then
        points[#points + 1] = {nodes(node, 1) + by[1], nodes(node, 2) + by[2], nodes(node, 3) + by[3]}
        values[#values + 1] = von_mises[node]
        number[node] = #points
      end
      at[k] = number[node]
    end
    for _, t in ipairs {{1, 4, 6}, {4, 2, 5}, {6, 5, 3}, {4, 5, 6}} do
      triangles[#triangles + 1] = {at[t[1]], at[t[2]], at[t[3]]}
    end
  end
end

local scene = scenes.make "horse"
local session = assert(bw.edit(scene.part, scene.session))
local before = assert(session:solve()).von_mises
add(session.mesh, before, {0, 0, 0})

-- Head down to graze, the tail out, a foreleg forward; then as strong as it takes.
assert(session:bone("lower neck"):rotate {y = 10})
assert(session:bone("upper neck"):rotate {y = 18})
assert(session:bone("head"):rotate {y = 15})
assert(session:bone("tail"):rotate {y = 20})
local found = assert(session:optimise {von_mises = scenes.threshold, move_supports = true, ties = scene.ties})
local after = assert(session:solve()).von_mises
print(("%.1f MPa as drawn"):format(before:max() / 1e6))
print(found)
add(session.mesh, after, {94e-3, 0, 0})

local surface = assert(bw.surface.new {points = points, triangles = triangles})
assert(bw.picture(surface, opts.out or root .. "/docs/images/edit.png", {values = bw.array.new(values),
  unit = "von Mises stress, MPa", scale = 1e-6, min = 0, max = before:max(), width = 1200, height = 590,
  direction = {0.35, -1, 0.22}, up = {0, 0, 1}}))
