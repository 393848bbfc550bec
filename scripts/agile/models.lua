-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A scene from a model of one's own: the surface is filled, its skeleton extracted; it stands on its
-- lowest part, and is pushed sideways at the end of the limb that is farthest from there.
local bw = require "barwright"
local scenes = require "scenes"

local models = {}

-- Ends of limbs: joints that are the tail of a bone without children.
local function tips_of(skeleton)
  local tips = {}
  for _, name in ipairs(skeleton.bone_names) do
    local bone = skeleton:bone(name)
    if #bone.children == 0 then tips[#tips + 1] = {bone = name, joint = bone.tail} end
  end
  return tips
end

local function distance(a, b)
  return math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2)
end

--- A scene as scenes.make gives it. opts: elements (default 20,000), order (2), bones (as many as
--- the shape asks for), force (5 N), unit, material (that of the paper).
function models.make(path, opts)
  local surface, message, details = bw.surface.read(path, {unit = opts.unit})
  if not surface then return nil, message, details end
  local mesh
  mesh, message, details = bw.mesh.fill(surface, {elements = opts.elements or 20000,
    order = opts.order or 2})
  if not mesh then return nil, message, details end
  local boundary
  boundary, message, details = mesh:surface()
  if not boundary then return nil, message, details end
  local skeleton
  skeleton, message, details = bw.skeleton.extract(boundary, {bones = opts.bones or 0})
  if not skeleton then return nil, message, details end

  local min, max = mesh.box.min, mesh.box.max
  local size = distance(min, max)
  local material = opts.material and bw.material.named(opts.material) or scenes.material()
  local part = bw.model {mesh = mesh, material = material}
  local fixed = mesh.boundary:below("z", min[3] + 0.04 * (max[3] - min[3]))
  part:fix(fixed)
  part:gravity(scenes.gravity)
  local centre, tips, joints = fixed.centre, tips_of(skeleton), skeleton.joints:totable()
  local best = {far = -1}
  for i, name in ipairs(skeleton.joint_names) do
    local far = distance(joints[i], centre)
    if far > best.far then best = {far = far, at = joints[i], joint = name} end
  end
  local across = (max[1] - min[1] < max[2] - min[2]) and {opts.force or 5, 0, 0}
    or {0, opts.force or 5, 0}
  local nearest = mesh.boundary:nearest(best.at, 1).centre
  local on = mesh.boundary:near(nearest, 0.04 * size)
  part:load {on = on, force = across}

  local edits = {}
  for i, tip in ipairs(tips) do
    if i > 3 then break end
    edits[#edits + 1] = {("%s turned"):format(tip.bone), function(session)
      return session:bone(tip.bone):rotate {axis = {0, 0, 1}, degrees = 8}
    end}
    edits[#edits + 1] = {("%s thicker"):format(tip.bone), function(session)
      return session:bone(tip.bone):scale {1, 1.1, 1.1}
    end}
  end
  edits[#edits + 1] = {"taken back", function(session) return session:undo() end}
  local name = path:match "([^/]+)%.%w+$" or path
  return {name = name, title = name, surface = surface, mesh = mesh, part = part, skeleton = skeleton,
    inputs = {path}, fixed = fixed, loads = {{what = ("a push at %s"):format(best.joint), on = on,
      force = across}}, session = {skeleton = skeleton, heat = 10, threshold = 0.65}, edits = edits,
    ties = {}}
end

return models
