-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Geometrically nonlinear statics: columns with an imperfection, what is refused, files, and CalculiX.
local bw = require "barwright"
local check = require "check"
local deck = require "deck"

local steel = bw.material.isotropic {young = 2e11, poisson = 0.3, density = 7800}
local L, SIDE = 1, 0.02
local EULER = math.pi ^ 2 * 2e11 * SIDE ^ 4 / 12 / (4 * L ^ 2)

local function column(mesh, force, material)
  local part = bw.model {mesh = mesh, material = material or steel}
  return part:fix(mesh.boundary:below("x", 0)):load {on = mesh.boundary:above("x", L - 1e-3), force = force}
end

describe("geometrically nonlinear statics", function()
  local straight = assert(bw.mesh.box {max = {L, SIDE, SIDE}, cells = {30, 2, 2}, order = 2})

  -- The amplitude a0 of the shape grows to a0 / (1 - P / Pcr): w / P over w has the slope 1 / Pcr
  -- (Southwell 1932).
  it("bends an imperfect column as Southwell's plot has it, and past the critical load", function()
    local linear = assert(column(straight, {-EULER, 0, 0}):buckling {count = 1})
    local bent = assert(linear:imperfect_mesh {amplitude = 1e-3 * L})
    local path = assert(column(bent, {-EULER, 0, 0}):nonlinear {factor = 1.05, arc_length = true,
      monitor = {{L, SIDE / 2, SIDE / 2}}})
    local w, y, n = {}, {}, 0
    for i, move in ipairs(path:path(1):totable()) do
      local deflection = math.sqrt(move[2] ^ 2 + move[3] ^ 2)
      if path.factors[i] > 0.5 and path.factors[i] < 0.95 then
        n = n + 1
        w[n], y[n] = deflection, deflection / path.factors[i]
      end
    end
    local slope = (y[n] - y[1]) / (w[n] - w[1])
    assert.is_true(n >= 4)
    check.near(1 / slope / linear.factor, 1, 0.01)
    check.near(y[1] - slope * w[1], 1e-3 * L / linear.factor, 0.02) -- the imperfection
    assert.are.equal("factor", path.ended)
    check.near(path.factor, 1.05, 1e-12)
    assert.is_true(path.largest_displacements:max() > 0.3 and path.negative_pivots:max() == 0)
  end)

  it("finds one unstable direction of the perfect column past the critical load", function()
    local linear = assert(column(straight, {-EULER, 0, 0}):buckling {count = 4})
    local path = assert(column(straight, {-EULER, 0, 0}):nonlinear {factor = 1.2, steps = 6})
    for i = 1, path.count do
      local below = 0
      for k = 1, 4 do below = below + (linear.factors[k] < path.factors[i] and 1 or 0) end
      assert.are.equal(below, path.negative_pivots[i])
    end
    assert.are.equal(2, path.negative_pivots[path.count]) -- to both sides
    assert.is_truthy(tostring(path):find("unstable from step 6 on, load factor 1.2: up to 2 negative", 1, true))
  end)

  it("says what it did, in words and files", function()
    local part = column(straight, {0, 0, 200})
    local path = assert(part:nonlinear {steps = 2, monitor = {{L, 0, 0}, {L / 2, 0, 0}}})
    assert.is_truthy(tostring(path):find("the error of the mesh is unknown", 1, true))
    assert.are.equal(2, #path)
    check.near(path:reaction_on(straight.boundary:below("x", 0))[3], -200, 1e-3)
    local corner = straight.boundary:nearest({L, 0, 0}, 1).nodes[1]
    check.near(path:path(1)(2, 3), path.displacement(corner, 3), 0)
    local stem = os.tmpname()
    assert(path:write_history(stem .. ".csv"))
    local head, first = check.read(stem .. ".csv"):match "^(.-)\n(.-)\n"
    assert.is_truthy(head:find "^load_factor,u1_x_m,u1_y_m,u1_z_m,u2_x_m.*negative_pivots$")
    assert.is_truthy(first:find "^0%.5,")
    assert(path:write(stem .. ".vtu"))
    assert(path:picture(stem .. ".png", {width = 80, height = 64}))
    assert(path:figure({axis = "z", monitor = 2}):write(stem .. ".svg"))
    os.execute(("rm -f '%s'*"):format(stem))
    local small = assert(column(straight, {0, 0, 1e-3}):nonlinear {steps = 1}) -- as the linear analysis
    local static = assert(column(straight, {0, 0, 1e-3}):solve())
    check.near(small.displacement(1, 3), static.displacement(1, 3), 1e-12)
    check.near(small.von_mises:max() / static.von_mises:max(), 1, 1e-4)
  end)

  it("moves supports, and heats", function()
    local mesh = assert(bw.mesh.box {max = {1, 0.1, 0.1}, cells = {4, 1, 1}, order = 2})
    local soft = bw.material.isotropic {young = 1e9, poisson = 0, expansion = 1e-4}
    local part = bw.model {mesh = mesh, material = soft}
    local left, right = mesh.boundary:below("x", 0), mesh.boundary:above("x", 1)
    part:fix(left):prescribe(right, {0.1, 0, 0})
    local path = assert(part:nonlinear {steps = 2}) -- S = E (1.1^2 - 1) / 2, force = F S A
    check.near(path:reaction_on(right)[1], 1.1 * 1e9 * 0.105 * 0.01, 1)
    check.near(path.element_stress(1, 1), 1.1 * 1e9 * 0.105, 1e-6)
    check.near(path.largest_strains[2], 0.105, 1e-9)
    assert.is_truthy(tostring(path):find "largest strain in an element 1%d %%, where the law of small")
    part:clear_supports():fix(left):fix(right):temperature(20)
    check.near(assert(part:nonlinear {steps = 1}):reaction_on(right)[1], -1e9 * 1e-4 * 20 * 0.01, 1e-3)
  end)

  it("refuses what it does not know, in a sentence", function()
    local part = column(straight, {0, 0, 1})
    local ok, message = pcall(part.nonlinear, part, {factor = -1})
    assert.is_true(not ok and message:find("the load factor is -1", 1, true) ~= nil)
    ok, message = pcall(part.nonlinear, part, {monitor = {{1, 2}}})
    assert.is_true(not ok and message:find("monitor", 1, true) ~= nil)
    part:attach {on = straight.boundary:above("x", L), mass = 1}
    local none, why, details = part:nonlinear {}
    assert.is_true(none == nil and why:find("mass", 1, true) ~= nil and details.status == "unsupported")
  end)

  it("names the element that inverts, and where it stopped", function()
    local mesh = assert(bw.mesh.box {max = {1, 1, 1}, cells = {2, 2, 2}})
    local part = bw.model {mesh = mesh, material = steel}
    part:fix(mesh.boundary:below("x", 0)):prescribe(mesh.boundary:above("x", 1), {-2, 0, 0})
    local none, message, details = part:nonlinear {steps = 4}
    assert.is_true(none == nil and details.factor > 0 and details.factor < 1, message)
    assert.is_truthy(message:find "load factor 0%.%d")
  end)

  if not os.execute "command -v ccx >/dev/null 2>&1" then return end

  --- Displacements of all nodes at load factor 1 by ccx.
  local function by_calculix(part)
    local stem = os.tmpname()
    assert(part:write_inp(stem .. ".inp"))
    local model, step = check.read(stem .. ".inp"):match "^(.-)%*STEP[^\n]*\n(.*)$"
    step = step:gsub("%*STATIC[^\n]*\n", "*STATIC\n.1, 1.\n"):gsub("%*NODE FILE.-%*END STEP", "*END STEP")
      :gsub("%*END STEP", "*NODE PRINT, NSET=NALL, FREQUENCY=500\nU\n*END STEP")
    check.write(stem .. ".inp", model .. deck.node_set("NALL", part.mesh.boundary)
      .. "\n*STEP, NLGEOM, INC=500\n" .. step)
    os.execute(("cd /tmp && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1"):format(stem, stem))
    local u = {}
    for line in assert(io.open(stem .. ".dat")):lines() do
      local i, x, y, z = line:match("^%s+(%d+)" .. ("%s+(%-?%d%.%d+E[+-]%d+)"):rep(3) .. "%s*$")
      if i then u[tonumber(i)] = {tonumber(x), tonumber(y), tonumber(z)} end
    end
    os.execute(("rm -f '%s' '%s'.*"):format(stem, stem))
    return u
  end

  it("has the displacements of CalculiX", function()
    local cases = {{1, {3000, 20000, 250000}}, {2, {3000, 20000, 25000}},
      {2, {-6, 60, 60}, bw.material.zp150:rotated {{0.8, 0, 0.6}, {0, 1, 0}, {-0.6, 0, 0.8}}}}
    for _, case in ipairs(cases) do
      local order, force, material = table.unpack(case)
      local mesh = assert(bw.mesh.box {max = {1, 0.05, 0.03}, cells = {10, 2, 1}, order = order})
      local part = column(mesh, force, material)
      local path = assert(part:nonlinear {tolerance = 1e-10})
      local theirs, largest, off = by_calculix(part), path.largest_displacements:max(), 0
      for i, u in pairs(theirs) do
        for k = 1, 3 do off = math.max(off, math.abs(u[k] - path.displacement(i, k))) end
      end
      assert.is_true(largest > 0.2 and off < 2e-6 * largest)
    end
  end)
end)
