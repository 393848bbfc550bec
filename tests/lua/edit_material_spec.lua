-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edit sessions on parts of several materials, and materials that change in them.
local bw = require "barwright"
local check = require "check"
local bodies = require "edit_bodies"

local soft = bw.material.isotropic {name = "soft", young = 2e10, poisson = 0.3, density = 1200}
local directed = bw.material.orthotropic {name = "directed", young = {3e9, 1e9, 2e9}, poisson = {0.3, 0.3, 0.3},
  axes = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}}

-- The beam of two bones with an insert that lies in both, in its upper half.
local function beam(materials, opts)
  local mesh = assert(check.beam({16, 2, 4}, 2):split({min = {0.25, 0, 0.05}, max = {0.8, 0.1, 0.1}}, "insert"))
  local part = bw.model {mesh = mesh, materials = materials}
  part:fix(mesh.boundary:below(1, 0)):gravity {0, 0, -9.81}
  part:load {on = mesh.boundary:above(1, 1), force = {0, 0, -10}}
  opts = opts or {}
  opts.skeleton = bodies.beam_skeleton()
  return assert(bw.edit(part, opts)), part
end

local function names(mesh)
  local out = {}
  for i, region in ipairs(mesh.regions) do out[i] = region.name end
  return out
end

local function both(first, second)
  local mesh = check.beam({16, 2, 4}, 2):split({min = {0.25, 0, 0.05}, max = {0.8, 0.1, 0.1}}, "insert")
  local out = {}
  for _, name in ipairs(names(mesh)) do out[name] = name == "insert" and second or first end
  return out
end

local factor = {solver = bw.solver.cholesky {}, precision = 64}

-- The session's part solved from scratch.
local function fresh(session)
  return assert(session.part:solve {solver = bw.solver.cholesky {}}).displacement
end


describe("edit sessions with materials by region", function()
  it("follow edits of a part of several materials", function()
    local session = beam(both(soft, bw.material.steel))
    local region_of = {} -- of each stiffness subdomain: one
    for e = 1, session.mesh.element_count do
      local d, region = session.subdomains.element_stiffness_subdomain[e], session.mesh.element_regions(e, 1)
      region_of[d] = region_of[d] or region
      assert.equals(region_of[d], region)
    end
    assert(session:solve(factor))
    assert(session:bone("lower"):rotate {y = 15})
    assert(session:bone("upper"):scale {1, 1.2, 1.1})
    local result = assert(session:solve(factor))
    assert.is_true((result.displacement - fresh(session)):norm() / result.displacement:norm() < 1e-9)
    session:check()
  end)

  it("change the material of a region at the cost of its elements", function()
    local session = beam(both(soft, soft))
    assert(session:solve(factor))
    assert.equals(session, session:set_material(bw.material.steel, "insert"))
    local changed = assert(session:solve(factor))
    local touched, count = {}, 0
    local stiffness, region = session.subdomains.element_stiffness_subdomain, session.mesh.element_regions
    for e = 1, session.mesh.element_count do
      local d = stiffness[e]
      if session.mesh.regions[region(e, 1)].name == "insert" then
        if not touched[d] then touched[d], count = true, count + 1 end
      end
    end
    assert.equals(count, changed.reused.subdomains_changed)
    assert.is_true(changed.reused.factor_reused > 0)
    assert.is_true((changed.displacement - fresh(session)):norm() / changed.displacement:norm() < 1e-9)
    assert.equals("steel", session.part.material.parts[2] and session.part.material.parts[2].name)
  end)

  it("refuse a material that does not expand where the temperature changes", function()
    local mesh = check.beam({16, 2, 4}, 2)
    local part = bw.model {mesh = mesh, material = bw.material.steel}:fix(mesh.boundary:below(1, 0))
    local session = assert(bw.edit(part:temperature(10), {skeleton = bodies.beam_skeleton()}))
    check.raises("the material soft has no coefficient of expansion", session.set_material, session, soft)
    assert(session:set_material(bw.material.aluminium))
    local result = assert(session:solve(factor))
    assert.is_true((result.displacement - fresh(session)):norm() / result.displacement:norm() < 1e-9)
  end)

  it("give the same bits back and forth, and undo", function()
    local session = beam(both(soft, bw.material.steel))
    local before = assert(session:solve(factor)).displacement
    for _ = 1, 2 do
      assert(session:set_material(bw.material.aluminium, "insert"))
      assert.is_true((assert(session:solve(factor)).displacement - before):norm() > 0)
      assert(session:set_material(bw.material.steel, "insert"))
      assert.equals(0, (assert(session:solve(factor)).displacement - before):norm())
    end
    assert(session:set_material(bw.material.aluminium))
    assert.is_nil(session.part.material.parts)
    local all = assert(session:solve(factor)).displacement
    assert.is_true((all - fresh(session)):norm() / all:norm() < 1e-9)
    assert(session:undo())
    assert.equals(0, (assert(session:solve(factor)).displacement - before):norm())
  end)

  it("make equations again for a law whose axes they do not know", function()
    for _, rotates in ipairs {false, true} do
      local session = beam(both(soft, bw.material.steel), {rotate_material = rotates})
      assert(session:bone("lower"):rotate {y = 15})
      assert(session:solve(factor))
      assert(session:set_material(directed, "insert"))
      local result = assert(session:solve(factor))
      assert.equals(result.reused.subdomains, result.reused.subdomains_changed)
      assert.is_true((result.displacement - fresh(session)):norm() / result.displacement:norm() < 1e-9)
      assert(session:bone("upper"):rotate {y = 5})
      result = assert(session:solve(factor))
      assert.is_true((result.displacement - fresh(session)):norm() / result.displacement:norm() < 1e-9)
      assert(session:set_material(bw.material.aluminium, (names(session.mesh))[1]))
      result = assert(session:solve(factor))
      assert.is_true(result.reused.subdomains_changed < result.reused.subdomains)
      assert.is_true((result.displacement - fresh(session)):norm() / result.displacement:norm() < 1e-9)
    end
  end)

  it("are written and replayed with their materials", function()
    local path = os.tmpname()
    local session, part = beam(both(soft, bw.material.steel))
    assert(session:set_material(soft, "insert"))
    assert(session:set_material(directed))
    assert(session:set_material(bw.material.pla, "insert"))
    assert(session:save(path))
    local other = assert(bw.edit(part, {skeleton = bodies.beam_skeleton()}))
    assert(bw.edit.load(path, other))
    os.remove(path)
    assert.equals(#session.edits, #other.edits)
    assert.matches('material.pla, "insert"', other.edits[3].script, 1, true)
    local a, b = assert(session:solve(factor)).displacement, assert(other:solve(factor)).displacement
    assert.equals(0, (a - b):norm())
  end)

  it("are optimised with the materials that they have", function()
    local strong = {}
    for i, first in ipairs {soft, bw.material.steel} do
      local session = beam(both(first, first))
      if i == 2 then assert(session:set_material(soft)) end
      local limit = 0.9 * assert(session:solve(factor)).von_mises:max()
      strong[i] = assert(session:optimise {von_mises = limit, move_supports = true}).change
    end
    check.near(strong[1], strong[2], 1e-6)
  end)

  it("refuse regions that are not there, and materials that differ by element", function()
    local session, part = beam(both(soft, bw.material.steel))
    check.raises("there is no region 'inser': did you mean 'insert'?", session.set_material, session, soft,
      "inser")
    check.raises("a material that is the same in all elements expected", session.set_material, session,
      part.material, "insert")
    check.raises("material", session.set_material, session, "steel", "insert")
    assert.equals(0, #session.edits)
  end)
end)
