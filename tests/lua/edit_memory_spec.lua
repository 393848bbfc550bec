-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What a session keeps and for how long; memory that runs out.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"
local edit_bodies = require "edit_bodies"

local beam_skeleton, beam_part = edit_bodies.beam_skeleton, edit_bodies.beam_part
local beam, same_nodes, compare = edit_bodies.beam, edit_bodies.same_nodes, edit_bodies.compare

describe("a session", function()
  it("keeps its results when it is closed, and lets go of the rest", function()
    assert(beam():solve()):close() -- what the engine keeps for good is there from now on
    collectgarbage()
    collectgarbage()
    local _, blocks = core.external()
    do
      local session = beam()
      assert(session:bone("lower"):rotate {z = 5})
      local result = assert(session:solve())
      local bone, mesh = session:bone "lower", session.mesh
      session:close()
      collectgarbage()
      assert.truthy(result.von_mises:max() > 0 and result.reused.subdomains == 3 and mesh.volume > 0)
      assert.equal("edit session (closed)", tostring(session))
      check.raises("closed", session.bone, session, "lower")
      check.raises("closed", bone.scale, bone, 2)
      check.raises("closed", function() return session.mesh end)
    end
    collectgarbage()
    collectgarbage()
    local _, after = core.external()
    assert.equal(blocks, after)
  end)

  it("keeps poses of its states, not meshes", function()
    local session, bytes = beam(), nil
    for i = 1, 120 do
      assert(session:bone("lower"):rotate {z = i % 2 == 0 and 1 or -1})
      if i == 20 then
        collectgarbage()
        collectgarbage()
        bytes = core.external()
      end
    end
    collectgarbage()
    collectgarbage()
    assert.equal(bytes, (core.external()))
    for _ = 1, 120 do assert(session:undo()) end
    assert.is_true(same_nodes(session.rest, session.mesh))
  end)

  it("ends with a status wherever memory runs out, and leaves nothing behind", function()
    local part, path = beam_part(), check.folder() .. "/journal.lua"
    local function whole()
      local session <close> = assert(bw.edit(part, {skeleton = assert(beam_skeleton()), journal = path}))
      assert(session:bone("lower"):rotate {z = 10})
      local limit = 0.95 * assert(session:solve()).von_mises:max()
      assert(session:optimise {von_mises = limit, move_supports = true})
      assert(session:undo())
      assert(session:save(path .. ".saved"))
      return assert(session:solve()).von_mises:max()
    end
    local function blocks()
      collectgarbage()
      collectgarbage()
      return select(2, core.external())
    end
    local highest = whole()
    local before, failures = blocks(), 0
    for _, and_later in ipairs {true, false} do
      for n = 1, 1500, os.getenv "BARWRIGHT_FULL" and 1 or 97 do
        core.fail_allocation(n, and_later)
        local ok, answer = pcall(whole)
        core.fail_allocation(0, false)
        if ok then
          check.near(highest, answer, 1e-7)
        else
          failures = failures + 1
          assert.truthy(tostring(answer):find("memory", 1, true), tostring(answer))
        end
        assert.equal(before, blocks())
      end
    end
    assert.truthy(failures > 10)
  end)

  it("is as it was when memory runs out in an edit or a solve", function()
    local session = beam()
    assert(session:bone("lower"):rotate {z = 5})
    assert(session:solve())
    local mesh, n, failures = session.mesh, 1, 0
    while true do
      core.fail_allocation(n, true)
      local ok, result, message, details = pcall(function() -- luacheck: ignore 331
        local bone, why, about = session:bone("upper"):scale {1, 1.01, 1.01}
        if not bone then return nil, why, about end
        return session:solve()
      end)
      core.fail_allocation(0, false)
      if ok and result then break end
      failures = failures + 1
      if ok then assert.equal("memory", details.status, message) end
      if #session.edits == 2 then assert(session:undo()) end
      assert.is_true(same_nodes(mesh, session.mesh))
      n = n + 11
      assert(n < 100000)
    end
    assert.truthy(failures > 3)
    compare(session, assert(session:solve()))
  end)
end)
