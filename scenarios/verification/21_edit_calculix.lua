-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edited parts beside CalculiX: the input deck of the edited model solved by `ccx`, which prints
-- seven digits. Its stresses at the four integration points of each element are compared as means of
-- elements, and at nodes averaged as barwright does (by volume): CalculiX's own nodal stresses are
-- means of another kind.
local bw = require "barwright"
local bodies = require "bodies"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Edit sessions: stress beside CalculiX",
  text = [[Each body after ten random edits (redrawn where one is refused). CalculiX prints seven digits of
displacements at nodes and of stresses at the integration points of elements; stresses at nodes are made of
these as barwright makes its own, extrapolated to corners and averaged by volume. Differences are the largest,
relative to the largest displacement and von Mises stress.]]}

-- Coordinates of the integration points of C3D10: near a corner, the others.
local a, b = 0.25 + 0.75 * math.sqrt(0.2), 0.25 - 0.25 * math.sqrt(0.2)

local function solve(model)
  local stem = os.tmpname()
  assert(model:write_inp(stem .. ".inp"))
  local deck = assert(io.open(stem .. ".inp"))
  local text, changed = deck:read("a"):gsub("%*END STEP", "*EL PRINT, ELSET=EALL\nS\n%0")
  deck:close()
  assert(changed == 1, "one step expected")
  deck = assert(io.open(stem .. ".inp", "w"))
  deck:write(text)
  deck:close()
  local ok = os.execute(("OMP_NUM_THREADS=1 ccx -i '%s' >'%s.log' 2>&1"):format(stem, stem))
  local u, stress = {}, {}
  local file = ok and io.open(stem .. ".dat")
  if file then
    for line in file:lines() do
      local n = {}
      for word in line:gmatch "%S+" do n[#n + 1] = tonumber(word) end
      if #n == 4 then u[n[1]] = {n[2], n[3], n[4]} end
      if #n == 8 then
        stress[n[1]] = stress[n[1]] or {}
        stress[n[1]][n[2]] = {n[3], n[4], n[5], n[8], n[7], n[6]} -- xx yy zz yz zx xy
      end
    end
    file:close()
  end
  os.execute(("rm -f '%s' '%s'.*"):format(stem, stem))
  assert(#u == model.mesh.node_count and #stress == model.mesh.element_count, "ccx did not solve the deck")
  return bw.array.new(u), stress
end

local function von_mises(s)
  return math.sqrt(0.5 * ((s[1] - s[2]) ^ 2 + (s[2] - s[3]) ^ 2 + (s[3] - s[1]) ^ 2)
    + 3 * (s[4] ^ 2 + s[5] ^ 2 + s[6] ^ 2))
end

-- Means over elements; at corners, averaged by volume.
local function of_elements(stress, mesh)
  local means, sums, volumes = {}, {}, mesh.volumes
  for e, corners in ipairs(mesh.elements:totable()) do
    local points, mean = stress[e], {0, 0, 0, 0, 0, 0}
    for _, s in ipairs(points) do
      for k = 1, 6 do mean[k] = mean[k] + s[k] / #points end
    end
    means[e] = mean
    for c = 1, 4 do
      local sum = sums[corners[c]] or {0, 0, 0, 0, 0, 0, volume = 0}
      sums[corners[c]] = sum
      sum.volume = sum.volume + volumes[e]
      for k = 1, 6 do
        local at = #points == 4 and (points[c][k] - b * 4 * mean[k]) / (a - b) or mean[k]
        sum[k] = sum[k] + volumes[e] * at
      end
    end
  end
  return bw.array.new(means), sums
end

local function largest(array)
  return math.max(array:max(), -array:min())
end

scenario("Stress on edited meshes beside CalculiX", function(t)
  if not os.execute "command -v ccx >/dev/null 2>&1" then t:skip "ccx is not installed" end
  local random = bodies.random(2)
  for _, body in ipairs(bodies.list) do
    local session, made = bodies.session(body), 0
    while made < 10 do
      made = made + (bodies.edit(session, random) and 1 or 0)
    end
    local result, mesh = assert(session:solve()), session.mesh
    local u, stress = solve(session.part)
    local top = result.von_mises:max()
    local means, corners = of_elements(stress, mesh)
    local own = assert(bw.element_stress(mesh, session.part.material, result.displacement))
    local worst = 0
    for node, s in pairs(corners) do
      for k = 1, 6 do s[k] = s[k] / s.volume end
      worst = math.max(worst, math.abs(von_mises(s) - result.von_mises[node]))
    end
    expect(largest(u - result.displacement) / largest(result.displacement), body.name .. ": displacement")
      :below(1e-6, {how = ("%d elements after %d edits in force"):format(mesh.element_count, #session.edits)})
    expect(largest(means - own) / top, body.name .. ": stress of elements")
      :below(1e-6, {how = "six components of the mean of each element"})
    expect(worst / top, body.name .. ": von Mises stress at corners"):below(1e-6, {how = "averaged by volume"})
  end
end)
