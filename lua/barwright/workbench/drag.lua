-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Answers while a handle is dragged. One coarse mesh of the body follows the edit: its boundary moves with the
-- surface, its inside as an elastic body would. An edit moves points in proportion to its length, so the motion of
-- the mesh is found once, and each step only moves nodes and solves.
local body = require "barwright.workbench.body"
local core = require "barwright.core"
local judge = require "barwright.workbench.judge"
local model = require "barwright.command.model"
local nearest = require "barwright.workbench.nearest"

local drag = {}

local function sub(a, b) return {a[1] - b[1], a[2] - b[2], a[3] - b[3]} end
local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end

-- The weights of a triangle's corners at the point of its plane below another one.
local function weights(a, b, c, p)
  local u, v, w = sub(b, a), sub(c, a), sub(p, a)
  local uu, uv, vv, wu, wv = dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v)
  local size = uu * vv - uv * uv
  if size <= 0 then return 1, 0, 0 end
  local y, z = (vv * wu - uv * wv) / size, (uu * wv - uv * wu) / size
  return 1 - y - z, y, z
end

-- How the surface moves at the boundary nodes of a mesh of the surface `at`, per unit of the edit's length, which
-- moves the points of `before` to those of `after`: rows for all nodes.
local function boundary_motion(mesh, at, before, after, length)
  local nodes, rows, list, points = mesh.nodes:totable(), {}, mesh.boundary.nodes:totable(), {}
  for i = 1, #nodes do rows[i] = {0, 0, 0} end
  for i, node in ipairs(list) do points[i] = nodes[node] end
  local found, message, details = nearest(at, points)
  if not found then return nil, message, details end
  local triangles, there = at.triangles:totable(), at.points:totable()
  local old, new = before.points:totable(), after.points:totable()
  for i, t in ipairs(found) do
    local p = triangles[t]
    local share = {weights(there[p[1]], there[p[2]], there[p[3]], points[i])}
    local row = rows[list[i]]
    for corner = 1, 3 do
      local u = sub(new[p[corner]], old[p[corner]])
      for k = 1, 3 do row[k] = row[k] + share[corner] * u[k] / length end
    end
  end
  return rows
end

-- The motion of all nodes that continues that of the boundary.
local function motion_of(mesh, ...)
  local rows, message, details = boundary_motion(mesh, ...)
  if not rows then return nil, message, details end
  local part
  part, message, details = core.model {mesh = mesh, material = core.material.isotropic {young = 1, poisson = 0}}
  if not part then return nil, message, details end
  local static
  static, message, details = model.try(part.solve, part:prescribe(mesh.boundary, core.array.new(rows)))
  if not static then return nil, message, details end
  return static.displacement
end

--- Begins to drag: a mesh of `made`, the body of the edit of a length, and its part. nil, message, details where
--- it has no answer.
function drag.begin(entry, made, length)
  local mesh, labels, details = body.mesh(made, judge.elements.drag, 1)
  if not mesh then return nil, labels, details end
  local part, held, about = judge.part(made, entry.material, entry.conditions, mesh:with_order(2), labels)
  if not part then return nil, held, about end
  local motion, message, why = motion_of(mesh, made.surface, entry.body.surface, made.surface, length)
  if not motion then return nil, message, why end
  return {entry = entry, mesh = mesh, labels = labels, part = part, held = held, motion = motion, length = length}
end

--- The answer at a length of the edit; nil where the mesh cannot follow so far.
function drag.step(self, length)
  local start = core.seconds()
  local mesh, message, details = self.mesh:moved(self.mesh.nodes + self.motion * (length - self.length))
  if not mesh then return nil, message, details end
  local part
  part, message, details = self.part:moved(mesh:with_order(2))
  if not part then return nil, message, details end
  local static
  static, message, details = model.try(part.solve, part, {inertia_relief = not self.held or nil})
  if not static then return nil, message, details end
  return judge.quick(static, self.entry.material, core.seconds() - start), static, {labels = self.labels}
end

return drag
