-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Five scenes standing for those of the paper agile: shapes of its kind made by formula, of its
-- numbers of tetrahedra and bones, of its material, loaded so that they break in a thin limb as its
-- do. Nothing is read from files; the same call gives the same mesh.
local bw = require "barwright"
local figure = require "figure"

local scenes = {names = {"opener", "bird", "horse", "dinosaur", "earphone"}}

-- Table 1 (tetrahedra, subdomains of type R, tetrahedra of type F) and table 3 (largest von Mises stress
-- before) of agile.
scenes.paper = {
  opener = {elements = 38729, bones = 3, blended = 5436, von_mises = 89.95e6},
  bird = {elements = 58911, bones = 12, blended = 11915, von_mises = 164.86e6},
  horse = {elements = 15869, bones = 15, blended = 8056, von_mises = 91.40e6},
  dinosaur = {elements = 31409, bones = 16, blended = 10251, von_mises = 110.62e6},
  earphone = {elements = 42944, bones = 15, blended = 5764, von_mises = 87.83e6},
}

scenes.threshold = 55e6 -- Pa; the strength less a margin (section 9)
scenes.gravity = {0, 0, -9.8}

function scenes.material()
  return bw.material.isotropic {name = "PLA of agile", young = 2.3e9, poisson = 0.35, density = 1300,
    strength = 60e6}
end

local function metres(v) return {v[1] * 1e-3, v[2] * 1e-3, v[3] * 1e-3} end

-- The boundary, its selections taking boxes and balls in mm.
local function in_millimetres(selection)
  return setmetatable({}, {__index = function(_, name)
    return function(_, a, b)
      if name == "box" then return selection:box(metres(a), metres(b)) end
      if name == "near" then return selection:near(metres(a), b * 1e-3) end
      return selection[name](selection, a, b * 1e-3)
    end
  end})
end

--- The surface of a scene, before it is filled.
function scenes.surface(name)
  return figure.surface(require("scene_" .. name))
end

--- A scene: {name, title, surface, mesh, log, part, skeleton, fixed, loads, session, edits, ties,
--- paper}; session: options for bw.edit. elements: another number than the paper's; order: default 2.
function scenes.make(name, options)
  options = options or {}
  local about = require("scene_" .. name)
  local paper = scenes.paper[name]
  local scene = {name = name, title = about.title, paper = paper, edits = about.edits,
    ties = about.ties, loads = {}, session = {}}
  scene.surface = assert(figure.surface(about))
  local near = {} -- thin limbs get finer elements
  for i, place in ipairs(about.near or {}) do
    near[i] = {at = metres(place[1]), radius = place[2] * 1e-3, length = place[3] * 1e-3}
  end
  local mesh, log = assert(bw.mesh.fill(scene.surface, {elements = options.elements or paper.elements,
    order = options.order or 2, near = near, tolerance = 0.08}))
  scene.mesh, scene.log = mesh, log
  local joints, bones = {}, {}
  for i, joint in ipairs(about.joints) do
    joints[i] = metres(joint[2])
    joints[i].name = joint[1]
  end
  for i, bone in ipairs(about.bones) do bones[i] = {bone[2], bone[3], name = bone[1]} end
  scene.skeleton = assert(bw.skeleton.create {joints = joints, bones = bones, root = about.root})
  local part = bw.model {mesh = mesh, material = scenes.material()}
  local boundary = in_millimetres(mesh.boundary)
  scene.fixed = about.fix(boundary)
  part:fix(scene.fixed)
  part:gravity(scenes.gravity)
  for i, load in ipairs(about.loads) do
    local on = load[2](boundary)
    part:load {on = on, force = load[3]}
    scene.loads[i] = {what = load[1], on = on, force = load[3]}
  end
  scene.part = part
  for key, value in pairs(about.session) do scene.session[key] = value end
  scene.session.skeleton = scene.skeleton
  return scene
end

return scenes
