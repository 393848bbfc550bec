-- Contact of two bodies with and without friction beside CalculiX (ccx) on the same elements, with its contact
-- from surface to surface on stiff springs: forces agree within 2 %. Lengths are in mm. Skipped without ccx.
local bw = require "barwright"
local check = require "check"
local deck = require "deck"

local HIGH, K = 100, 1e6 -- MPa/mm of the springs: 100 times the stiffness of a layer of elements

--- A block on a block whose top is moved; the upper one has a foot that is round by `crown`.
local function assembly(order, cells, crown)
  local nodes, elements = {}, {}
  for body = 0, 1 do
    local mesh = assert(bw.mesh.box {min = {0, 0, (body - 1) * HIGH}, max = {100, 100, body * HIGH},
      cells = cells[body + 1], order = order})
    local first = #nodes
    for _, p in ipairs(mesh.nodes:totable()) do
      local x, y = p[1] / 50 - 1, p[2] / 50 - 1
      nodes[#nodes + 1] = {p[1], p[2], p[3] + body * crown * (x * x + y * y) / 2 * (1 - p[3] / HIGH)}
    end
    for _, e in ipairs(mesh.elements:totable()) do
      for k = 1, #e do e[k] = e[k] + first end
      elements[#elements + 1] = e
    end
  end
  return assert(bw.mesh.new {nodes = nodes, elements = elements, order = order})
end

--- The forces on the top by ccx for its moves, one step after the other.
local function by_calculix(part, on, against, friction, moves, top)
  local stem = os.tmpname()
  assert(part:write_inp(stem .. ".inp"))
  local model = check.read(stem .. ".inp"):match "^(.-)%*STEP"
  local out = {model, deck.surface(part.mesh, on, "UPPER"), deck.surface(part.mesh, against, "LOWER"),
    deck.node_set("NTOP", top),
    "*SURFACE INTERACTION, NAME=TOUCH", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR", ("%g"):format(K)}
  if friction > 0 then
    out[#out + 1] = "*FRICTION"
    out[#out + 1] = ("%g, %g"):format(friction, K / 10)
  end
  out[#out + 1] = "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE"
  out[#out + 1] = "UPPER, LOWER"
  for _, move in ipairs(moves) do
    out[#out + 1] = "*STEP, INC=200\n*STATIC\n1., 1.\n*BOUNDARY"
    for k = 1, 3 do out[#out + 1] = ("NTOP, %d, %d, %.9e"):format(k, k, move[k]) end
    out[#out + 1] = "*NODE PRINT, NSET=NTOP, TOTALS=ONLY\nRF\n*END STEP\n"
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
