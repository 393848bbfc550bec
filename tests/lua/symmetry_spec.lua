-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Planes of symmetry and antisymmetry in Lua: half a body beside the whole one, what is printed, and misuse.
local bw = require "barwright"
local check = require "check"

-- A rotation that leaves no axis where it was.
local R = {{0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}}
local function turn(v)
  local x = {}
  for i = 1, 3 do x[i] = R[i][1] * v[1] + R[i][2] * v[2] + R[i][3] * v[3] end
  return x
end

-- Half a block (x from 0 to 1) with bent sides, or both halves, one the mirror image of the other.
local function block(order, whole)
  local box = bw.mesh.box {min = {0, 0, 0}, max = {1, 0.7, 0.4}, cells = {3, 2, 2}, order = order}
  local random, unit, nodes, number, elements = check.random(19), box.nodes:totable(), {}, {}, {}
  local place = {}
  for i, p in ipairs(unit) do
    local x = p[1] * (1 + 0.1 * (random() - 0.5))
    place[i] = {x, p[2] + 0.1 * p[1] * p[3], p[3] + 0.05 * math.sin(3 * p[2] + x)}
  end
  for side = 1, whole and 2 or 1 do
    local sign = side == 1 and 1 or -1
    for i, p in ipairs(place) do
      if side == 1 or p[1] > 1e-12 then
        nodes[#nodes + 1] = turn {sign * p[1], p[2], p[3]}
        number[i] = #nodes
      end
    end
    for _, e in ipairs(box.elements:totable()) do
      local row = {}
      for k, n in ipairs(e) do row[k] = number[n] end
      if side == 2 then -- the mirror image of a tetrahedron: two corners, and the middles beside them, exchanged
        row[1], row[2] = row[2], row[1]
        if order == 2 then row[6], row[7], row[8], row[9] = row[7], row[6], row[9], row[8] end
      end
      elements[#elements + 1] = row
    end
  end
  local mesh = assert(bw.mesh.new {nodes = nodes, elements = elements, order = order})
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  return part, mesh.boundary
end

local normal = turn {1, 0, 0}
local function middle(boundary) return boundary:plane({0, 0, 0}, normal, 1e-9) end
local function side(boundary, sign) return boundary:beyond(turn {sign * 0.7, 0, 0}, turn {sign, 0, 0}) end

-- A traction at the sides of the block, mirrored, or turned round beside it.
local function pull(part, boundary, both, sign)
  part:load {on = side(boundary, 1), traction = turn {2e6, -1e6, 3e6}}
  if both then part:load {on = side(boundary, -1), traction = turn {-2e6 * sign, -1e6 * sign, 3e6 * sign}} end
end

local function hold(part, boundary) -- a stiff foot below, on both sides alike
  part:attach {on = boundary:facing(turn {0, -1, 0}, 0.3), spring = {1e12, 1e12, 1e12}}
end

describe("a plane of symmetry", function()
  for order = 1, 2 do
    for sign, kind in pairs {[1] = "symmetric", [-1] = "antisymmetric"} do
      it(("makes half a body the %s whole, order %d"):format(kind, order), function()
        local half, edge = block(order)
        local whole, all = block(order, true)
        half:fix(edge:facing(turn {0, -1, 0}, 0.3))
        whole:fix(all:facing(turn {0, -1, 0}, 0.3))
        half:symmetry(middle(edge), kind)
        pull(half, edge, false)
        pull(whole, all, true, sign)
        local a, b = assert(half:solve()), assert(whole:solve())
        local far, largest = 0, 0
        for i = 1, half.mesh.node_count do -- the first nodes of the whole are those of the half
          for k = 1, 3 do
            far = math.max(far, math.abs(a.displacement(i, k) - b.displacement(i, k)))
            largest = math.max(largest, math.abs(b.displacement(i, k)))
          end
        end
        assert.is_true(far < 1e-9 * largest, far / largest)
        check.near(b.energy / 2, a.energy, 1e-9)
        check.near(whole.mesh.volume / 2, half.mesh.volume, 1e-12)
      end)
    end
  end

  it("splits the modes of the whole", function()
    local all = {}
    for _, kind in ipairs {"symmetric", "antisymmetric"} do
      local half, edge = block(2)
      hold(half, edge)
      half:symmetry(middle(edge), kind)
      local modes = assert(half:modes {count = 8})
      for i = 1, 8 do all[#all + 1] = modes.frequencies[i] end
    end
    table.sort(all)
    local whole, edge = block(2, true)
    whole:attach {on = edge:facing(turn {0, -1, 0}, 0.3), spring = {2e12, 2e12, 2e12}} -- that of both halves
    local modes = assert(whole:modes {count = 8})
    for i = 1, 8 do check.near(modes.frequencies[i], all[i], 1e-8) end
  end)

  it("is listed and printed", function()
    local half, edge = block(1)
    half:symmetry(middle(edge))
    assert.equal("symmetric", half.supports[1].symmetry)
    assert.truthy(tostring(half):find("support 1: plane of symmetry, fixed along (", 1, true), tostring(half))
    half:clear_supports()
    half:symmetry(middle(edge), "antisymmetric")
    assert.equal(2, #half.supports)
    local one, two = half.supports[1].direction, half.supports[2].direction
    for _, pair in ipairs {{one, two}, {one, normal}, {two, normal}} do
      local a, b = table.unpack(pair)
      assert.is_true(math.abs(a[1] * b[1] + a[2] * b[2] + a[3] * b[3]) < 1e-12)
    end
    assert.truthy(tostring(half):find("support 2: plane of antisymmetry, fixed along (", 1, true), tostring(half))
  end)

  it("is plane", function()
    local half, edge = block(1)
    check.fails("geometry", "deviates by 0.0", half:symmetry(edge:facing(turn {0, 0, 1}, 0.5)))
    check.fails("geometry", "look in different directions", half:symmetry(edge))
    check.raises("known are antisymmetric, symmetric", function() half:symmetry(middle(edge), "odd") end)
    check.raises("no whole facet", function() half:symmetry(edge:nearest({0, 0, 0}, 3)) end)
    assert.equal(0, #half.supports)
  end)
end)
