-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The bodies of the verification of edit sessions: small parts with everything on them that an edit
-- takes along, their sessions, and random edits of these.
local bw = require "barwright"

local bodies = {}
local mm = 1e-3

-- A bar of three bones, fixed at one end and on a slide at its middle: pressure, a total force, a
-- torque, gravity.
local function bar(order, material)
  local mesh = assert(bw.mesh.box {min = {0, -12 * mm, -8 * mm}, max = {240 * mm, 12 * mm, 8 * mm},
    cells = {24, 3, 2}, order = order})
  local part = bw.model {mesh = mesh, material = material}
  local boundary = mesh.boundary
  part:fix(boundary:below(1, 0))
  part:slide(boundary:box({110 * mm, -1, -1}, {130 * mm, 1, -7.9 * mm}), {0, 0, 1})
  part:load {on = boundary:above(1, 240 * mm), force = {5, 20, -30}}
  part:load {on = boundary:above(1, 240 * mm), torque = {0.3, 0, 0.1}}
  part:load {on = boundary:above(3, 8 * mm) & boundary:box({30 * mm, -1, -1}, {90 * mm, 1, 1}), pressure = 2e4}
  part:gravity {1, 2, -9.81}
  local joints, bones = {}, {}
  for i = 0, 3 do joints[i + 1] = {80 * mm * i, 0, 0} end
  for i = 1, 3 do bones[i] = {i, i + 1, name = "bone " .. i} end
  return part, bw.skeleton.create {joints = joints, bones = bones, root = 1}
end

local figure_joints = {
  hip = {0, 0, 0}, chest = {0, 0, 40 * mm}, head = {0, 0, 60 * mm},
  left_hip = {8 * mm, 0, -4 * mm}, left_knee = {12 * mm, 0, -22 * mm}, left_foot = {14 * mm, 0, -42 * mm},
  right_hip = {-8 * mm, 0, -4 * mm}, right_knee = {-12 * mm, 0, -22 * mm},
  right_foot = {-14 * mm, 0, -42 * mm},
}
local figure_bones = {{"hip", "chest", name = "trunk"}, {"chest", "head", name = "neck"},
  {"hip", "left_hip", name = "left_side"}, {"left_hip", "left_knee", name = "left_thigh"},
  {"left_knee", "left_foot", name = "left_shin"}, {"hip", "right_hip", name = "right_side"},
  {"right_hip", "right_knee", name = "right_thigh"}, {"right_knee", "right_foot", name = "right_shin"}}

-- A figure on two legs, filled by TetGen: fixed at the feet, pushed at the head, heavy.
local function figure(order, material)
  local limbs = {}
  for _, bone in ipairs(figure_bones) do
    limbs[#limbs + 1] = bw.shapes.limb(figure_joints[bone[1]], figure_joints[bone[2]], 6 * mm, 5 * mm)
  end
  local surface = assert(bw.surface.implicit(bw.shapes.join(limbs, 3 * mm),
    {min = {-0.025, -0.01, -0.055}, max = {0.025, 0.01, 0.072}, cells = 40}))
  local mesh = assert(bw.mesh.fill(surface, {elements = 2000, order = order}))
  local part = bw.model {mesh = mesh, material = material}
  part:fix(mesh.boundary:below(3, -44 * mm))
  part:load {on = mesh.boundary:above(3, 60 * mm), force = {0, 1, -2}}
  part:load {on = mesh.boundary:near({0, 0, 20 * mm}, 9 * mm), pressure = 1e3}
  part:gravity {0, 0, -9.81}
  return part, bw.skeleton.create {joints = figure_joints, bones = figure_bones, root = "hip"}
end

-- Wood whose axes stay in space, as those of a printer do.
local function wood()
  return bw.material.orthotropic {young = {11e9, 0.9e9, 0.5e9}, poisson = {0.5, 0.02, 0.4},
    shear = {0.1e9, 0.7e9, 0.65e9}, density = 450}
end

bodies.list = {
  {name = "bar of three bones, tet10", make = function() return bar(2, bw.material.pla) end},
  {name = "figure of eight bones, tet10", heat = 1, -- wide joints: few elements stand wide turns
    make = function() return figure(2, bw.material.zp150) end},
  {name = "bar of three bones, orthotropic, tet4", make = function() return bar(1, wood()) end},
}

--- A session on a body of the list.
function bodies.session(body, opts)
  local part, skeleton = body.make()
  opts = opts or {}
  opts.skeleton, opts.heat = skeleton, opts.heat or body.heat
  return assert(bw.edit(part, opts))
end

-- ---- random edits -----------------------------------------------------------------------------------

--- Numbers that are the same on every machine: xoshiro256** of Lua, seeded.
function bodies.random(seed)
  math.randomseed(seed)
  return function(min, max) return min + (max - min) * math.random() end
end

function bodies.random_axis(random)
  while true do
    local axis = {random(-1, 1), random(-1, 1), random(-1, 1)}
    local square = axis[1] ^ 2 + axis[2] ^ 2 + axis[3] ^ 2
    if square > 0.01 and square <= 1 then return axis end
  end
end

local kinds = {
  {5, function(bone, random)
    return bone:scale {random(0.9, 1.1), random(0.85, 1.2), random(0.85, 1.2)}
  end},
  {5, function(bone, random)
    return bone:rotate {axis = bodies.random_axis(random), degrees = random(-20, 20)}
  end},
  {2, function(bone, random) -- often repaired, sometimes refused
    return bone:rotate {axis = bodies.random_axis(random), degrees = random(-75, 75)}
  end},
  {1, function(bone, random)
    return bone:translate {random(-1, 1) * mm, random(-1, 1) * mm, random(-1, 1) * mm}
  end},
  {1, function(bone, random)
    local to = bone.to
    return bone.session:reach(bone.tail, {to[1] + random(-3, 3) * mm, to[2] + random(-3, 3) * mm,
      to[3] + random(-3, 3) * mm})
  end},
  {2, function(bone) return bone.session:undo() end},
  {1, function(bone) return bone.session:redo() end},
  {1, function(bone) return bone:reset() end},
}

--- One random edit; whether it was made.
function bodies.edit(session, random)
  local names, sum = session.skeleton.bone_names, 0
  for _, kind in ipairs(kinds) do sum = sum + kind[1] end
  local bone = session:bone(names[math.random(#names)])
  local pick = random(0, sum)
  for _, kind in ipairs(kinds) do
    pick = pick - kind[1]
    if pick <= 0 then
      local ok, message, details = kind[2](bone, random)
      if not ok and details.status ~= "geometry" and details.status ~= "empty" then error(message) end
      return ok and true or false
    end
  end
end

return bodies
