-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the specs of edit sessions share: a beam of two bones, a body with limbs, comparisons.
local bw = require "barwright"
local check = require "check"

local edit_bodies = {}

function edit_bodies.beam_skeleton()
  return bw.skeleton.create {joints = {a = {0, 0.05, 0.05}, b = {0.5, 0.05, 0.05}, c = {1, 0.05, 0.05}},
    bones = {{"a", "b", name = "upper"}, {"b", "c", name = "lower"}}, root = "a"}
end

function edit_bodies.beam_part(order)
  local mesh = check.beam({16, 2, 2}, order or 2)
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  part:fix(mesh.boundary:below(1, 0)):gravity {0, 0, -9.81}
  return part:load {on = mesh.boundary:above(1, 1), force = {0, 0, -10}}
end

function edit_bodies.beam(opts)
  opts = opts or {}
  opts.skeleton = opts.skeleton or edit_bodies.beam_skeleton()
  return assert(bw.edit(edit_bodies.beam_part(), opts))
end

local mm = 1e-3
edit_bodies.body_joints = {
  hip = {0, 0, 0}, chest = {0, 0, 40 * mm}, head = {0, 0, 60 * mm},
  left_hip = {8 * mm, 0, -4 * mm}, left_knee = {12 * mm, 0, -22 * mm}, left_foot = {14 * mm, 0, -42 * mm},
  right_hip = {-8 * mm, 0, -4 * mm}, right_knee = {-12 * mm, 0, -22 * mm},
  right_foot = {-14 * mm, 0, -42 * mm},
}
edit_bodies.body_bones = {{"hip", "chest", name = "trunk"}, {"chest", "head", name = "neck"},
  {"hip", "left_hip"}, {"left_hip", "left_knee", name = "left_thigh"},
  {"left_knee", "left_foot", name = "left_shin"}, {"hip", "right_hip"},
  {"right_hip", "right_knee", name = "right_thigh"}, {"right_knee", "right_foot", name = "right_shin"}}

function edit_bodies.body_skeleton()
  return bw.skeleton.create {joints = edit_bodies.body_joints, bones = edit_bodies.body_bones, root = "hip"}
end

local made
function edit_bodies.body_mesh()
  if made then return made end
  local limbs = {}
  for _, bone in ipairs(edit_bodies.body_bones) do
    limbs[#limbs + 1] = bw.shapes.limb(edit_bodies.body_joints[bone[1]],
      edit_bodies.body_joints[bone[2]], 6 * mm, 5 * mm)
  end
  local surface = assert(bw.surface.implicit(bw.shapes.join(limbs, 3 * mm),
    {min = {-0.025, -0.01, -0.055}, max = {0.025, 0.01, 0.072}, cells = 40}))
  made = assert(bw.mesh.fill(surface, {elements = 1500, order = 2}))
  return made
end

function edit_bodies.body(opts)
  local mesh = edit_bodies.body_mesh()
  local part = bw.model {mesh = mesh, material = bw.material.zp150}
  part:fix(mesh.boundary:below(3, -44 * mm))
  part:load {on = mesh.boundary:above(3, 60 * mm), force = {0, 1, -2}}
  opts = opts or {}
  opts.skeleton = opts.skeleton or edit_bodies.body_skeleton()
  opts.heat = opts.heat or 1 -- wide joints: few elements stand wide turns
  return assert(bw.edit(part, opts)), part
end

function edit_bodies.same_nodes(a, b)
  return (a.nodes - b.nodes):norm() == 0
end

local function same(what, a, b)
  local difference = (a - b):norm() / a:norm()
  if difference >= 1e-8 or difference ~= difference then
    error(("%s differs by %g"):format(what, difference), 3)
  end
end

--- The session's result is that of its part solved again.
function edit_bodies.compare(session, result)
  local direct = assert(session.part:solve())
  same("displacement", direct.displacement, result.displacement)
  same("von Mises stress", direct.von_mises, result.von_mises)
end

return edit_bodies
