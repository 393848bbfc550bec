-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How von Mises stresses change with the scaling factors of bones, by one adjoint solve for each node,
-- beside central differences of complete solves of new parts.
local bw = require "barwright"
local core = require "barwright.core"
local bodies = require "bodies"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Edit sessions: sensitivities",
  text = [[Bodies after five random edits that leave their mesh posed (nodes are linear in the factors then). For
the nodes of the highest stress of every subdomain, the derivative of the von Mises stress by all three factors of
every bone, through subdomains of type R and F, gravity, pressure and torque. The differences are central ones of
complete solves, extrapolated from steps of 0.4 and 0.2 % of the factor; the figure is the largest deviation,
relative to the largest derivative of the stress at that node.]]}

local function edited(body, random)
  local session, made = bodies.session(body), 0
  while made < 5 do
    if bodies.edit(session, random) then
      made = made + 1
      local edits = session.edits
      if #edits > 0 and edits[#edits].mesh ~= "posed" then session:undo() end
    end
  end
  return session
end

-- Two nodes of every subdomain: that of the highest stress, and the median.
local function nodes_of(session, von_mises)
  local subdomains, list, about = session.subdomains, {}, {}
  for d = 1, subdomains.count do
    local own = subdomains.node_subdomain:map("a == d", {d = d}):where()
    if #own > 0 then
      local values = von_mises:gather(own)
      local rank = values:order()
      for _, place in ipairs {#own, #own // 2 + 1} do
        list[#list + 1] = math.tointeger(own[rank[place]])
        about[#list] = subdomains[d].type
      end
    end
  end
  return list, about
end

-- Stresses at the nodes with one factor of a bone multiplied by `by`.
local function stresses(session, bone, axis, by, nodes)
  local fork = session:fork()
  local factors = {1, 1, 1}
  factors[axis] = by
  assert(fork:bone(bone):scale(factors))
  local result = assert(fork.part:solve())
  local values = result.von_mises:gather(nodes)
  result:close()
  fork:close()
  return values
end

local function difference(session, bone, axis, step, nodes)
  local up = stresses(session, bone, axis, 1 + step, nodes)
  local down = stresses(session, bone, axis, 1 - step, nodes)
  return (up - down) / (2 * step)
end

scenario("Sensitivities beside central differences", {tags = {"slow"}}, function()
  local random = bodies.random(7)
  for _, body in ipairs(bodies.list) do
    local session = edited(body, random)
    local result = assert(session:solve())
    local nodes, types = nodes_of(session, result.von_mises)
    local names, motions, factors = session.skeleton.bone_names, {}, {}
    for _, name in ipairs(names) do
      for axis = 1, 3 do
        local factor = session:bone(name).factors[axis]
        motions[#motions + 1] = session.subdomains:pose_derivative(session.current_pose, name, axis) * factor
        factors[#factors + 1] = {name, axis}
      end
    end
    local now = session.part
    local _, slopes = assert(core.von_mises_slopes(now, now:system(), result.displacement, nodes, motions))
    local worst = {R = 0, F = 0}
    local largest, off = {}, {}
    for i in ipairs(nodes) do largest[i], off[i] = 0, 0 end
    for m, factor in ipairs(factors) do
      local whole = difference(session, factor[1], factor[2], 4e-3, nodes)
      local half = difference(session, factor[1], factor[2], 2e-3, nodes)
      local best = (half * 4 - whole) / 3
      for i in ipairs(nodes) do
        largest[i] = math.max(largest[i], math.abs(best[i]))
        off[i] = math.max(off[i], math.abs(best[i] - slopes(i, m)))
      end
    end
    local counts = {R = 0, F = 0}
    for i in ipairs(nodes) do
      counts[types[i]] = counts[types[i]] + 1
      worst[types[i]] = math.max(worst[types[i]], off[i] / largest[i])
    end
    for _, kind in ipairs {"R", "F"} do
      expect(worst[kind], ("%s: nodes of type %s"):format(body.name, kind))
        :below(1e-5, {how = ("%d nodes, %d factors"):format(counts[kind], #factors)})
    end
    session:close()
  end
end)
