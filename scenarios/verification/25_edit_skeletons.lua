-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Skeletons of real models: how many bones are found, that their joints lie inside the surface, and
-- how much of the bones does. Whether a point is inside follows from the solid angle that the surface
-- fills as seen from there, which takes nothing from the extraction.
local bw = require "barwright"
local project = require "project"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Edit sessions: skeletons of real models",
  text = [[Closed surfaces of a folder of models. A point is inside where the surface fills the whole sphere
around it. A bone may leave the body between two joints where it is curved or hollow ([theory](theory/edit.md));
the last column says how much of the length of all bones is inside, by twenty places on each.]]}

-- 1 inside, 0 outside, whichever way the facets face.
local function inside_of(surface)
  local points, triangles = surface.points, surface.triangles
  local corners = {}
  for k = 1, 3 do corners[k] = points:gather(triangles:column(k)) end
  return function(at)
    local v = {ax = corners[1]:column(1) - at[1], ay = corners[1]:column(2) - at[2],
      az = corners[1]:column(3) - at[3], bx = corners[2]:column(1) - at[1],
      by = corners[2]:column(2) - at[2], bz = corners[2]:column(3) - at[3],
      cx = corners[3]:column(1) - at[1], cy = corners[3]:column(2) - at[2],
      cz = corners[3]:column(3) - at[3]}
    v.a = bw.array.map("sqrt(ax^2 + ay^2 + az^2)", v)
    v.b = bw.array.map("sqrt(bx^2 + by^2 + bz^2)", v)
    v.c = bw.array.map("sqrt(cx^2 + cy^2 + cz^2)", v)
    local angles = bw.array.map("2 * atan2(ax*(by*cz - bz*cy) + ay*(bz*cx - bx*cz) + az*(bx*cy - by*cx)"
      .. ", a*b*c + (ax*bx + ay*by + az*bz)*c + (bx*cx + by*cy + bz*cz)*a"
      .. " + (cx*ax + cy*ay + cz*az)*b)", v)
    return math.abs(angles:sum()) / (4 * math.pi)
  end
end

local function fraction_inside(skeleton, inside)
  local joints, within, length = skeleton.joints:totable(), 0, 0
  for _, bone in ipairs(skeleton.bones:totable()) do
    local a, b = joints[bone[1]], joints[bone[2]]
    local l = math.sqrt((a[1] - b[1]) ^ 2 + (a[2] - b[2]) ^ 2 + (a[3] - b[3]) ^ 2)
    for i = 1, 20 do
      local along, at = (i - 0.5) / 20, {}
      for k = 1, 3 do at[k] = a[k] + along * (b[k] - a[k]) end
      if inside(at) > 0.5 then within = within + l / 20 end
    end
    length = length + l
  end
  return within / length
end

scenario("Skeletons of real models", {tags = {"slow", "models"}}, function(t)
  local folder, names = project.models(t)
  local rows, outside, failed, joints = {}, 0, 0, 0
  for _, name in ipairs(names) do
    if not name:find "^bad_" and not name:find "^ok_" then
      local surface = t:require(bw.surface.read(folder .. "/" .. name))
      local skeleton, message = bw.skeleton.extract(surface)
      if not skeleton then
        failed = failed + 1
        rows[#rows + 1] = {name, surface.triangle_count, "", "", message}
      else
        local inside, out = inside_of(surface), 0
        for _, at in ipairs(skeleton.joints:totable()) do
          if inside(at) < 0.5 then out = out + 1 end
        end
        outside, joints = outside + out, joints + skeleton.joint_count
        rows[#rows + 1] = {name, surface.triangle_count, skeleton.bone_count, out,
          ("%.0f %%"):format(100 * fraction_inside(skeleton, inside))}
      end
      bw.warnings()
    end
  end
  expect(outside, "joints outside"):below(0, {how = ("%d joints of %d models"):format(joints, #rows)})
  expect(failed, "models without a skeleton"):below(0)
  t:table {heads = {"model", "facets", "bones", "joints outside", "of the bones inside"}, rows = rows}
end)
