-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A mesh that follows its outline, alone.
local bw = require "barwright"
local followed_kinds = require "followed_kinds"
local fuse = require "fuse"

local kind = {}
local text_of = followed_kinds.text_of

function kind.make()
  local size = fuse.around(function(x) return 0.2 + 0.1 * math.abs(x) end)
  local options = {order = math.random(2), elements = math.random(8, 80)}
  local mesh = assert(bw.plane.fill(followed_kinds.first(), options))
  local fill = math.random() < 0.3 and {field = size} or nil
  return {motion = assert(bw.plane.mesh_motion(mesh, {relocation = math.random() < 0.5 and "springs" or "harmonic",
    fill = fill}))}
end

function kind.seen(subject)
  local mesh = subject.motion.mesh
  return table.concat({text_of(mesh.points), text_of(mesh.elements), text_of(subject.motion.outline.points)}, "|")
end

function kind.check(subject) subject.motion:check() end

function kind.close(subject)
  subject.motion:close()
  subject.motion:close()
  if pcall(function() return subject.motion.mesh end) then error "a closed motion answers" end
end

kind.operations = {
  follow = {5, function(subject)
    local outline, message = followed_kinds.dragged(subject.motion.outline)
    if not outline then return nil, message end
    return subject.motion:follow(outline)
  end},
  other = {2, function(subject)
    local outline, message = followed_kinds.other(subject.motion.outline)
    if not outline then return nil, message end
    return subject.motion:follow(outline)
  end},
  ["pull back"] = {1, function(subject)
    local rows = {}
    local count = #subject.motion.mesh.points + (math.random() < 0.2 and 1 or 0)
    for i = 1, count do rows[i] = {math.random(), math.random()} end
    return subject.motion:pull_back(rows)
  end},
}

return kind
