-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Answers while a handle is dragged. One coarse mesh of the body at rest follows the edit: its boundary moves
-- with the surface, its inside as an elastic body would. An edit moves points in proportion to its length, so the
-- motion of the mesh is found once, and each step only moves nodes and solves.
local body = require "barwright.workbench.body"
local core = require "barwright.core"
local judge = require "barwright.workbench.judge"
local model = require "barwright.command.model"

local drag = {}

local function sub(a, b) return {a[1] - b[1], a[2] - b[2], a[3] - b[3]} end
local function dot(a, b) return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] end

-- The weights of a triangle's corners at a point of it.
local function weights(a, b, c, p)
  local u, v, w = sub(b, a), sub(c, a), sub(p, a)
  local uu, uv, vv, wu, wv = dot(u, u), dot(u, v), dot(v, v), dot(w, u), dot(w, v)
  local size = uu * vv - uv * uv
  if size <= 0 then return 1, 0, 0 end
  local y, z = (vv * wu - uv * wv) / size, (uu * wv - uv * wu) / size
  return 1 - y - z, y, z
end

-- How the surface moves at the boundary nodes of a mesh of it, per unit of an edit's length: rows for all nodes.
local function boundary_motion(rest, edit, length)
  local rows, list, there = {}, rest.mesh.boundary.nodes:totable(), rest.body.surface.points:totable()
  for i = 1, rest.mesh.node_count do rows[i] = {0, 0, 0} end
  local nearest, places, details = rest.body.surface:nearest(rest.mesh.nodes:gather(rest.mesh.boundary.nodes))
  if not nearest then return nil, places, details end
  local numbers, at = nearest:totable(), places:totable()
  for i, t in ipairs(numbers) do
    local p, row = edit.triangles[t], rows[list[i]]
    local share = {weights(there[p[1]], there[p[2]], there[p[3]], at[i])}
    for corner = 1, 3 do
      local u = sub(edit.after[p[corner]], edit.before[p[corner]])
      for k = 1, 3 do row[k] = row[k] + share[corner] * u[k] / length end
    end
  end
  return rows
end

--- How the nodes of a mesh at rest move per unit of an edit's length: the motion of its boundary, continued.
--- nil, message, details where it has no answer.
function drag.motion(rest, edit, length)
  local rows, message, details = boundary_motion(rest, edit, length)
  if not rows then return nil, message, details end
  local part
  part, message, details = core.model {mesh = rest.mesh,
    material = core.material.isotropic {young = 1, poisson = 0}}
  if not part then return nil, message, details end
  local static
  static, message, details = model.try(part.solve, part:prescribe(rest.mesh.boundary, core.array.new(rows)))
  if not static then return nil, message, details end
  return static.displacement
end

--- The body of an entry at rest: a coarse mesh with its labels, the part on it. `former`: one from before, whose
--- mesh serves where the body is the same. nil, message, details where the part cannot be solved.
function drag.rest(entry, former)
  if former and former.entry == entry then return former end
  local mesh, labels, details
  if former and former.body == entry.body then
    mesh, labels = former.mesh, former.labels
  else
    mesh, labels, details = body.mesh(entry.body, judge.elements.drag, 1)
  end
  if not mesh then return nil, labels, details end
  local part, fixed, about = judge.part(entry.body, entry.material, entry.conditions, mesh:with_order(2), labels)
  if not part then return nil, fixed, about end
  return {entry = entry, body = entry.body, mesh = mesh, labels = labels, part = part, fixed = fixed}
end

--- The answer at a length of the edit that a trial follows, {rest =, motion =, from = the length of `rest`,
--- else 0}; nil where the mesh cannot follow so far.
function drag.step(trial, length)
  local start, rest, part = core.seconds(), trial.rest, trial.rest.part
  local message, details
  if trial.motion then
    local mesh
    mesh, message, details = rest.mesh:moved(rest.mesh.nodes + trial.motion * (length - (trial.from or 0)))
    if not mesh then return nil, message, details end
    part, message, details = part:moved(mesh:with_order(2))
    if not part then return nil, message, details end
  end
  local static
  static, message, details = model.try(part.solve, part, {inertia_relief = not rest.fixed or nil})
  if not static then return nil, message, details end
  return judge.quick(static, trial.entry.material, core.seconds() - start), static, {labels = rest.labels}
end

return drag
