-- Contact of two bodies with and without friction beside CalculiX (ccx) on the same elements, with its contact
-- from surface to surface on stiff springs: forces agree within 2 %. Lengths are in mm. Skipped without ccx.
local bw = require "barwright"
local check = require "check"
local deck = require "deck"

local HIGH, K = 100, 1e6 -- MPa/mm of the springs: 100 times the stiffness of a layer of elements

--- Two meshes as one whose bodies share no node.
local function joined(a, b)
  local nodes, elements = a.nodes:totable(), a.elements:totable()
  local first = #nodes
  table.move(b.nodes:totable(), 1, b.node_count, first + 1, nodes)
  for _, e in ipairs(b.elements:totable()) do
    for k = 1, #e do e[k] = e[k] + first end
    elements[#elements + 1] = e
  end
  return assert(bw.mesh.new {nodes = nodes, elements = elements, order = a.order})
end

--- A block on a block whose top is moved; the upper one has a foot that is round by `crown`.
local function assembly(order, cells, crown)
  local body = {}
  for k = 0, 1 do
    local mesh = assert(bw.mesh.box {min = {0, 0, (k - 1) * HIGH}, max = {100, 100, k * HIGH},
      cells = cells[k + 1], order = order})
    local nodes = mesh.nodes:totable()
    for _, p in ipairs(nodes) do
      local x, y = p[1] / 50 - 1, p[2] / 50 - 1
      p[3] = p[3] + k * crown * (x * x + y * y) / 2 * (1 - p[3] / HIGH)
    end
    body[k + 1] = assert(mesh:moved(nodes))
  end
  return joined(body[1], body[2])
end

--- The forces on the top by ccx for its moves, one step after the other. With `foot` for large displacements:
-- those on it follow each.
local function by_calculix(part, on, against, friction, moves, top, foot)
  local stem = os.tmpname()
  assert(part:write_inp(stem .. ".inp"))
  local model = check.read(stem .. ".inp"):match "^(.-)%*STEP"
  local out = {model, deck.surface(part.mesh, on, "UPPER"), deck.surface(part.mesh, against, "LOWER"),
    deck.node_set("NTOP", top), foot and deck.node_set("NFOOT", foot) or "**",
    "*SURFACE INTERACTION, NAME=TOUCH", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", ("%g"):format(K)}
  if friction > 0 then
    out[#out + 1] = "*FRICTION"
    out[#out + 1] = ("%g, %g"):format(friction, K / 10)
  end
  out[#out + 1] = "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE"
  out[#out + 1] = "UPPER, LOWER"
  for _, move in ipairs(moves) do
    out[#out + 1] = foot and "*STEP, NLGEOM, INC=500\n*STATIC\n.01, 1., 1e-5, .01\n*BOUNDARY"
      or "*STEP, INC=200\n*STATIC\n1., 1.\n*BOUNDARY"
    for k = 1, 3 do out[#out + 1] = ("NTOP, %d, %d, %.9e"):format(k, k, move[k]) end
    out[#out + 1] = "*NODE PRINT, NSET=NTOP, TOTALS=ONLY, FREQUENCY=500\nRF"
    if foot then out[#out + 1] = "*NODE PRINT, NSET=NFOOT, TOTALS=ONLY, FREQUENCY=500\nRF" end
    out[#out + 1] = "*END STEP\n"
  end
  check.write(stem .. ".inp", table.concat(out, "\n"))
  os.execute(("cd /tmp && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1"):format(stem, stem))
  local forces = {}
  for line in assert(io.open(stem .. ".dat")):lines() do
    local x, y, z = line:match "^%s+(%-?%d%.%d+E[+-]%d+)%s+(%-?%d%.%d+E[+-]%d+)%s+(%-?%d%.%d+E[+-]%d+)%s*$"
    if x then forces[#forces + 1] = {tonumber(x), tonumber(y), tonumber(z)} end
  end
  os.execute(("rm -f '%s' '%s'.*"):format(stem, stem))
  return forces
end

describe("contact beside CalculiX", function()
  local function compare(order, cells, crown, friction, moves)
    local mesh = assembly(order, cells, crown)
    local joint = mesh.boundary:above("z", -HIGH / 4):below("z", HIGH / 4)
    local on, against = joint:facing {0, 0, -1}, joint:facing {0, 0, 1}
    local foot, top = mesh.boundary:below("z", -HIGH), mesh.boundary:above("z", HIGH)
    local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 2e5, poisson = 0.3}}
    part:fix(foot):fix(top) -- which the steps move
    local forces = by_calculix(part, on, against, friction, moves, top)
    assert.are.equal(#moves, #forces)
    local before
    for i, move in ipairs(moves) do
      part:clear_supports():fix(foot):prescribe(top, move)
      local found = assert(part:contact({{on = on, with = against, friction = friction}}, {after = before}))
      local ours = found.static:reaction_on(top)
      assert.is_true(math.abs(ours[3] - forces[i][3]) < 0.02 * math.abs(forces[i][3]))
      if friction > 0 and i > 1 then
        assert.is_true(math.abs(ours[1] - forces[i][1]) < 0.02 * math.abs(forces[i][1]))
      end
      before = friction > 0 and found or nil
    end
    return before
  end

  if not os.execute "command -v ccx >/dev/null 2>&1" then return end

  -- In large sliding ccx depends on its increments: in 20 of them it is off by 2 % from what it has of a block
  -- that was made there, in 100 by 0.4 %.
  it("has the forces of a block that slides over four elements of a beam", function()
    local mesh = joined(assert(bw.mesh.box {min = {0, 0, -50}, max = {300, 50, 0}, cells = {12, 2, 2}}),
      assert(bw.mesh.box {min = {40, 5, 0}, max = {100, 45, 40}, cells = {5, 3, 2}}))
    local joint = mesh.boundary:above("z", -1):below("z", 1)
    local on, against = joint:facing {0, 0, -1}, joint:facing {0, 0, 1}
    local left, right = mesh.boundary:below("x", 0), mesh.boundary:above("x", 300)
    local top = mesh.boundary:above("z", 40)
    local part = bw.model {mesh = mesh, material = bw.material.isotropic {young = 2e5, poisson = 0.3}}
    local moves = {{0, 0, -1e-2}, {110, 0, -1e-2}}
    for _, friction in ipairs {0, 0.2} do
      part:clear_supports():fix(left):fix(right):fix(top)
      local forces, before = by_calculix(part, on, against, friction, moves, top, left), nil
      assert.are.equal(4, #forces)
      for i, move in ipairs(moves) do
        part:clear_supports():fix(left):fix(right):prescribe(top, move)
        local found = assert(part:contact({{on = on, with = against, friction = friction}},
          {after = before, steps = friction > 0 and i > 1 and 10 or 1, finite_sliding = true}))
        for side, face in ipairs {top, left} do
          local ours, theirs = found.static:reaction_on(face), forces[2 * i - 2 + side]
          for axis = friction > 0 and 1 or 3, 3, 2 do
            assert.is_true(math.abs(ours[axis] - theirs[axis]) < 0.02 * math.abs(theirs[axis]))
          end
        end
        before = friction > 0 and found or nil
      end
    end
  end)

  it("has the forces of two blocks whose faces touch", function()
    compare(1, {{4, 4, 3}, {4, 4, 3}}, 0, 0, {{0, 0, -1e-2}})
    local path = {{0, 0, -1e-2}, {2e-3, 0, -1e-2}, {1e-2, 0, -1e-2}}
    assert.are.equal(3, compare(2, {{4, 4, 3}, {4, 4, 3}}, 0, 0.3, path).steps)
  end)

  it("has the forces of a crowned block, pressed and then sheared until it slips", function()
    local cells, path = {{5, 5, 3}, {6, 6, 3}}, {{0, 0, -1e-2}, {2e-3, 0, -1e-2}, {6e-3, 0, -1e-2}}
    compare(2, cells, 2e-2, 0, {path[1]})
    local last = compare(2, cells, 2e-2, 0.2, path)
    assert.is_true(last.pairs[1].stick_area < 0.5 * last.pairs[1].area)
  end)
end)
