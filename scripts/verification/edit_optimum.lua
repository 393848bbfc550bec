-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The scaling optimisation of the five scenes of agile (scripts/agile): the limit is met, and among
-- random points near the answer none both changes the shape less and meets the limit.
local bw = require "barwright"
local core = require "barwright.core"
local bodies = require "edit_bodies"
local scenes = require "scenes"

local part = {title = "Scaling optimisation of the five scenes"}
local points = 200
local tolerance = 1e-4 -- of the change of shape: the default of session:optimise

-- The unknowns of an answer: the axes across each bone or across tied bones; how the corner nodes move
-- with each, from the start.
local function unknowns_of(session, found, ties, start)
  local with, list, H = {}, {}, {}
  for _, tied in ipairs(ties) do
    for _, name in ipairs(tied) do with[name] = tied end
  end
  local names, seen, corners = {}, {}, core.corner_nodes(session.mesh)
  for name in pairs(found.factors) do names[#names + 1] = name end
  table.sort(names)
  for _, name in ipairs(names) do
    if not seen[name] then
      local together = with[name] or {name}
      for _, other in ipairs(together) do seen[other] = true end
      for axis = 2, 3 do
        local moves
        for _, other in ipairs(together) do
          local d = session.domains:pose_derivative(session.current_pose, other, axis)
            :gather(corners) * start[other][axis]
          moves = moves and moves + d or d
        end
        list[#list + 1] = {bones = together, axis = axis, moves = moves,
          t = found.factors[name][axis] / start[name][axis]}
      end
    end
  end
  for i, a in ipairs(list) do
    H[i] = {}
    for j, b in ipairs(list) do H[i][j] = a.moves:dot(b.moves) end
  end
  return list, H
end

local function change_of(list, H, t)
  local sum = 0
  for i = 1, #list do
    for j = 1, #list do sum = sum + (t[i] - 1) * H[i][j] * (t[j] - 1) end
  end
  return sum
end

-- Random points around the answer, within 0.1 to 10 % of it in each factor. Those that would change
-- the shape less are solved.
local function sample(session, list, H, found, start, random)
  local seen = {less = 0, better = 0, lowest = math.huge, refused = 0}
  local optimum = {}
  for i, unknown in ipairs(list) do optimum[i] = unknown.t end
  seen.change = change_of(list, H, optimum)
  local fork = session:fork {refill = false}
  for _ = 1, points do
    local t, size = {}, 10 ^ random(-3, -1)
    for i, unknown in ipairs(list) do
      local factor = start[unknown.bones[1]][unknown.axis]
      t[i] = unknown.t * (1 + size * random(-1, 1))
      t[i] = math.max(math.min(0.5 / factor, 1), math.min(math.max(3 / factor, 1), t[i]))
    end
    if change_of(list, H, t) < seen.change * (1 - tolerance) then
      seen.less = seen.less + 1
      local changes = {}
      for i, unknown in ipairs(list) do
        for _, name in ipairs(unknown.bones) do
          local change = changes[name] or {scale = table.move(start[name], 1, 3, 1, {})}
          change.scale[unknown.axis] = start[name][unknown.axis] * t[i]
          changes[name] = change
        end
      end
      if fork:pose(changes) then
        local result = assert(fork:solve {tolerance = 1e-7})
        local most = result.von_mises:max()
        result:close()
        seen.lowest = math.min(seen.lowest, most)
        if most <= found.limit then seen.better = seen.better + 1 end
        fork:undo()
      else
        seen.refused = seen.refused + 1
      end
    end
  end
  fork:close()
  return seen
end

-- Where the nodes are by the pose alone, before inner ones are relaxed.
local function posed(session)
  return session.domains:posed_nodes(session.skeleton:pose_maps(session.current_pose))
end

local function run_scene(name, elements, rows)
  local random = bodies.random(55)
  local scene = scenes.make(name, {elements = elements})
  local session = assert(bw.edit(scene.part, scene.session))
  for _, edit in ipairs(scene.edits) do edit[2](session) end
  local function row(what, ...) rows[#rows + 1] = {name .. ": " .. what, ...} end
  local start = {}
  for _, bone in ipairs(session.skeleton.bone_names) do start[bone] = session:bone(bone).factors end
  local from = assert(session:solve()).von_mises:max()
  local found, message = session:optimise {von_mises = scenes.threshold, ties = scene.ties}
  if not found then
    row("largest stress, MPa", from / 1e6, "at most", scenes.threshold / 1e6, message)
    return
  end
  local after = assert(session.part:solve()).von_mises:max()
  row("largest stress, MPa", after / 1e6, "at most", scenes.threshold / 1e6,
    ("%d elements, %.1f MPa before; a part made anew; %d unknowns, %d steps"):format(
      scene.mesh.element_count, from / 1e6, found.unknowns, found.iterations))
  local moved, how = posed(session), session.edits[#session.edits].mesh
  assert(session:undo())
  local list, H = unknowns_of(session, found, scene.ties, start)
  local corners = core.corner_nodes(session.mesh)
  local d = moved:gather(corners) - posed(session):gather(corners)
  row("change of shape", math.abs(found.change / d:dot(d) - 1), "at most", 1e-9,
    ("reported, beside the moves of the corner nodes, mesh %s; relative"):format(how))
  local clock = bw.seconds()
  local seen = sample(session, list, H, found, start, random)
  row("points that change the shape less and meet the limit", seen.better, "at most", 0,
    ("of %d, %d change it less%s; their least stress is %.5g MPa"):format(points, seen.less,
      seen.refused > 0 and (", %d of them cannot be made"):format(seen.refused) or "", seen.lowest / 1e6))
  print(("   %s: %.0f s for the answer, %.0f s for points near it"):format(name, found.seconds,
    bw.seconds() - clock))
  session:close()
end

function part.run(wish)
  local rows = {}
  for _, name in ipairs(wish.scene and {wish.scene} or scenes.names) do
    run_scene(name, not wish.full and scenes.paper[name].elements // 2 or nil, rows)
    collectgarbage()
  end
  return rows
end

part.text = [[The scenes of `scripts/agile`, tet10, after their edits; the limit is 55 MPa. Points are drawn
within 0.1 to 10 % of the answer in every factor; a point changes the shape less when it does so by more
than the optimisation's own tolerance, 10⁻⁴ of the change.]]

return part
