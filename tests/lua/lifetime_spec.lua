-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Objects keep what they depend on, go when they are closed or not needed, and a loop over big ones
-- does not fill memory.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

local function settle()
  for _ = 1, 4 do collectgarbage() end -- what an object holds goes a cycle after it
  return core.external()
end

describe("an object", function()
  it("keeps what it depends on when that is closed first", function()
    local mesh = check.beam({6, 2, 2})
    local foot = mesh.boundary:below(1, 0)
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(foot):load {on = mesh.boundary:above(1, 1), force = {0, 0, -1}}
    local nodes = mesh.nodes
    local view = nodes:rows(2, 5):column(3)
    local before = view:totable()
    mesh:close()
    foot:close()
    nodes:close()
    local static = assert(part:solve())
    part:close()
    collectgarbage()
    assert.same(before, view:totable())
    local u = static.displacement
    local max = static.von_mises:max()
    static:close()
    collectgarbage()
    assert.truthy(u:norm() > 0 and max > 0)
  end)

  it("survives any order of the collector, in both modes", function()
    for _, mode in ipairs {"generational", "incremental"} do
      collectgarbage(mode)
      for _ = 1, 300 do
        local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {2, 2, 2}}
        local some = mesh.boundary:below(1, 0) | mesh.boundary:above(2, 1)
        local column = mesh.nodes:column(1)
        mesh = nil
        assert(some.mesh.volume > 0 and column:sum() > 0 and mesh == nil)
      end
    end
    collectgarbage "incremental"
  end)

  it("is released by close, by scope, and by the collector", function()
    local bytes, blocks = settle()
    do
      local mesh <close> = check.beam()
      local _ <close> = mesh.nodes
      assert.truthy(core.external() > bytes)
    end
    local bytes_after, blocks_after = core.external()
    assert.equal(bytes, bytes_after)
    assert.equal(blocks, blocks_after)
    for _ = 1, 50 do check.beam() end
    bytes_after, blocks_after = settle()
    assert.equal(bytes, bytes_after)
    assert.equal(blocks, blocks_after)
  end)

  it("is not kept by a script of edits that began it", function()
    local path = check.folder() .. "/edits.lua"
    local _, before = settle()
    do
      local part = bw.model {mesh = check.beam({8, 1, 1}), material = bw.material.pla}
      local skeleton = bw.skeleton.create {joints = {{0, 0.05, 0.05}, {1, 0.05, 0.05}}, bones = {{1, 2}}}
      local session = assert(bw.edit(part, {skeleton = skeleton}))
      assert(session:save(path))
      assert.equal(session, (bw.edit.load(path, session)))
      assert.equal(session, bw.edit.begin(path, session))
    end
    local _, after = settle()
    assert.equal(before, after)
  end)

  it("is not kept by a model that its own solution's arrays were given to", function()
    local function solve_again()
      local mesh = check.beam({4, 2, 2})
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = {0, 0, -1}}
      local static = assert(part:solve())
      part:prescribe(mesh.boundary:above(1, 1), static.displacement)
      part:temperature(static.von_mises, 1e-12)
      assert(part:solve())
      bw.warnings()
    end
    solve_again()
    local _, blocks = settle()
    for _ = 1, 5 do solve_again() end
    assert.equal(blocks, (select(2, settle())))
  end)

  it("is the same as another box of the same thing", function()
    local mesh = check.beam()
    local part = bw.model {mesh = mesh, material = bw.material.pla}
    assert.equal(mesh, part.mesh)
    assert.are_not.equal(mesh, check.beam())
  end)
end)

describe("memory", function()
  it("is not filled by a loop over meshes that are dropped", function()
    settle()
    local max = 0
    for _ = 1, 60 do
      -- about 15 MB each, 900 MB in all
      local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {24, 24, 24}}
      assert(mesh.element_count > 0)
      max = math.max(max, (core.external()))
    end
    assert.truthy(max < 300e6, ("%.0f MB at most"):format(max / 1e6))
  end)

  it("that runs out is reported as nil, message, details; nothing leaks", function()
    local mesh = check.beam({4, 1, 1})
    local part = bw.model {mesh = mesh, material = bw.material.pla}
    assert(bw.worst_case(part, {force = 1, pressure = 1e6, modes = 1, regions = 1}))
    local _, before = settle()
    local step = os.getenv "BARWRIGHT_FULL" and 1 or 7
    local n, failures = 1, 0
    while true do
      core.fail_allocation(n, true)
      local ok, worst, message, details = pcall(function() -- luacheck: ignore 331
        local part_again = bw.model {mesh = mesh, material = part.material}
        if type(part_again) == "nil" then return nil, "not enough memory", {status = "memory"} end
        return bw.worst_case(part_again, {force = 1, pressure = 1e6, modes = 1, regions = 1})
      end)
      core.fail_allocation(0, false)
      if ok and worst then
        worst:close()
        break
      end
      failures = failures + 1
      if ok then
        assert.equal("memory", details.status, message)
      end -- else a property, which can only raise
      local _, after = settle()
      assert.equal(before, after, "blocks after failure " .. n)
      n = n + step
      assert(n < 200000)
    end
    assert.truthy(failures > 10)
  end)

end)
