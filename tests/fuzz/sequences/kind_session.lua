-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- An edit session on a beam of two bones, with forks and a journal.
local bw = require "barwright"
local edit_bodies = require "edit_bodies"
local followed_kinds = require "followed_kinds"

local kind = {}
local text_of, uniform = followed_kinds.text_of, followed_kinds.uniform
local bones = {"upper", "lower"}
local cholesky = bw.solver.cholesky()
local solvers = {"auto", cholesky, bw.solver.pcg {preconditioner = cholesky}, bw.solver.pcg(),
  bw.solver.cholesky {full = true}, bw.solver.cholesky {backend = "cholmod"}}
local mesh, steel, other

local function part(force)
  local made = assert(bw.model {mesh = mesh, material = steel})
  return made:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = force}
end

function kind.make()
  mesh = mesh or assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}, cells = {10, 1, 1},
    order = math.random(2)})
  steel = steel or bw.material.steel
  other = other or part {0, 10, 0}
  local journal = os.tmpname()
  local session = assert(bw.edit(part {0, 0, -10}, {skeleton = edit_bodies.beam_skeleton(), journal = journal,
    relax = math.random() < 0.8, refill = math.random() < 0.8, rotate_material = math.random() < 0.3}))
  return {session = session, forks = {}, journal = journal}
end

local function lines_of(path)
  local count = 0
  for line in io.lines(path) do
    if line:find "^assert" then count = count + 1 end
  end
  return count
end

local function seen(session)
  local parts = {session.position, text_of(session.mesh.nodes), text_of(session.mesh.elements),
    text_of(session.current_pose), text_of(session.subdomains.element_subdomain), text_of(session.joints)}
  for i, state in ipairs(session.history) do
    parts[#parts + 1] = ("%d %s"):format(i, state.script)
    for b, limit in pairs(state.limits) do
      parts[#parts + 1] = ("%d %s %s %s"):format(b, limit.swing, limit.twist_min, limit.twist_max)
    end
  end
  return table.concat(parts, "|")
end

-- The journal too: what is in it is what was done.
function kind.seen(subject)
  local parts = {seen(subject.session), tostring(lines_of(subject.journal))}
  for _, fork in ipairs(subject.forks) do parts[#parts + 1] = seen(fork) end
  return table.concat(parts, "|")
end

function kind.check(subject)
  subject.session:check()
  for _, fork in ipairs(subject.forks) do fork:check() end
end

function kind.close(subject)
  for _, fork in ipairs(subject.forks) do fork:close() end
  subject.session:close()
  subject.session:close()
  if pcall(subject.session.solve, subject.session) then error "a closed session answers" end
  os.remove(subject.journal)
end

-- The session or one of its forks.
local function one_of(subject)
  local at = math.random(0, #subject.forks)
  return at == 0 and subject.session or subject.forks[at]
end

local function factor()
  local at = math.random()
  return at < 0.7 and uniform(0.8, 1.25) or at < 0.9 and uniform(0.2, 4) or at < 0.95 and 1e7 or -1
end

local function vector(size) return {uniform(-size, size), uniform(-size, size), uniform(-size, size)} end

local function turn()
  local degrees = math.random() < 0.6 and uniform(-15, 15) or uniform(-180, 180)
  return {axis = vector(1), degrees = degrees}
end

local function bone(subject) return one_of(subject):bone(bones[math.random(2)]) end

kind.operations = {
  scale = {3, function(subject)
    return bone(subject):scale(math.random() < 0.5 and factor() or {factor(), factor(), factor()})
  end},
  rotate = {4, function(subject) return bone(subject):rotate(turn()) end},
  translate = {2, function(subject) return bone(subject):translate(vector(math.random() < 0.8 and 0.02 or 1)) end},
  set = {1, function(subject)
    return bone(subject):set {scale = factor(), rotation = turn(), translation = vector(0.01)}
  end},
  ["reset a bone"] = {0.5, function(subject) return bone(subject):reset() end},
  pose = {1, function(subject)
    return one_of(subject):pose {upper = {scale = factor()}, lower = {rotation = turn()}}
  end},
  reach = {1, function(subject) return one_of(subject):reach("c", vector(1)) end},
  limit = {1, function(subject)
    local limits = {{swing = 20}, {twist = {-10, 10}}, {swing = 500}, {twist = {10, -10}}}
    return one_of(subject):limit(bones[math.random(2)], limits[math.random(5)])
  end},
  assign = {1, function(subject)
    local session = one_of(subject)
    local first = math.random(session.mesh.element_count)
    local elements = {}
    for e = first, math.min(first + math.random(10), session.mesh.element_count) do elements[#elements + 1] = e end
    return session:assign(elements, ({"upper", "lower"})[math.random(3)])
  end},
  set_material = {1, function(subject)
    local library = {"steel", "pla", "zp150"}
    return one_of(subject):set_material(bw.material[library[math.random(#library)]])
  end},
  reset = {0.5, function(subject) return one_of(subject):reset() end},
  undo = {2, function(subject) return one_of(subject):undo() end},
  redo = {2, function(subject) return one_of(subject):redo() end},
  fork = {0.7, function(subject)
    if #subject.forks > 2 then table.remove(subject.forks, 1):close() end
    subject.forks[#subject.forks + 1] = one_of(subject):fork {relax = math.random() < 0.5}
    return true
  end},
  adopt = {1, function(subject)
    local fork = subject.forks[math.random(math.max(1, #subject.forks))]
    if not fork then return nil, "there is no fork" end
    return subject.session:adopt(fork)
  end},
  solve = {3, function(subject)
    return one_of(subject):solve {solver = solvers[math.random(#solvers)], check = math.random() < 0.3,
      tolerance = 10 ^ uniform(-12, -3)}
  end},
  ["solve another load"] = {0.7, function(subject) return one_of(subject):solve {part = other} end},
  synchronise = {0.5, function(subject) return one_of(subject):synchronise() end},
  surface = {0.3, function(subject) return one_of(subject):surface() end},
  optimise = {0.3, function(subject)
    return one_of(subject):optimise {von_mises = 10 ^ uniform(3, 7)}
  end},
}

return kind
