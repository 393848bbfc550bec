-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What benchmarks of the workbench do with a part: the unit is confirmed in millimetres, or the first likely one;
-- the largest face is constrained, and the face farthest from it is loaded with 10 N along -z.

-- Of the faces above a hundredth of the largest.
local function farthest(faces)
  local from, best, max = faces[1].centre, 2, -1
  for i = 2, #faces do
    local c = faces[i].centre
    local away = (c[1] - from[1]) ^ 2 + (c[2] - from[2]) ^ 2 + (c[3] - from[3]) ^ 2
    if faces[i].area > 0.01 * faces[1].area and away > max then best, max = i, away end
  end
  return best
end

--- Gives a prepared workbench its supports and its load. The loaded face and the number of faces; or nil, message,
--- and the number.
return function(bench)
  local ok, message
  local state = bench:state()
  if not state.units_plausible then
    ok, message = bench:unit {unit = state.units_likely[1] or "mm"}
    if not ok then return nil, message end
  end
  local count = #bench:current().body.faces
  if count < 2 then bench:grow {triangle = 1, angle = 0.5} end
  local faces = bench:current().body.faces
  if #faces < 2 then return nil, "one face", count end
  local far = farthest(faces)
  ok, message = bench:fix {faces = {1}}
  if ok then ok, message = bench:load {faces = {far}, force = {0, 0, -10}} end
  if not ok then return nil, message, count end
  return far, count
end
