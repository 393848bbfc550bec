-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Scripts of edits and journals: saved, replayed, killed, cut off.
local bw = require "barwright"
local check = require "check"
local edit_bodies = require "edit_bodies"

local mm = 1e-3
local beam_skeleton, beam_part = edit_bodies.beam_skeleton, edit_bodies.beam_part
local beam, body, same_nodes = edit_bodies.beam, edit_bodies.body, edit_bodies.same_nodes

describe("a script of edits", function()
  local function edit(session)
    assert(session:bone("left_thigh"):scale {1, 1.1, 1 / 3 + 1})
    assert(session:limit("left_knee", {swing = 40}))
    assert(session:reach("left_foot", {16 * mm, 0.3 * mm, -41 * mm}, {tolerance = 1e-7}))
    assert(session:bone("neck"):rotate {axis = {1, 0.1, 0}, radians = 0.1})
    assert(session:undo())
    assert(session:pose {["right_shin"] = {scale = 1.05}})
  end

  it("replays to the same bits", function()
    local session, path = body(), check.folder() .. "/edits.lua"
    edit(session)
    assert(session:save(path))
    local again = body()
    assert.equal(again, assert(bw.edit.load(path, again)))
    assert.is_true(same_nodes(session.mesh, again.mesh))
    assert.same(session.edits, again.edits)
    assert.is_nil(check.read(path):find("undo", 1, true))
  end)

  it("grows with every edit, and goes on after it was killed", function()
    local folder = check.folder()
    local path = folder .. "/journal.lua"
    local session = body {journal = path}
    edit(session)
    local bits = session.mesh
    local text = check.read(path)
    check.write(folder .. "/cut.lua", text .. 'assert(session:bone("ne')
    local again, cut = bw.edit.load(folder .. "/cut.lua", body(), {resume = true})
    assert.is_true(cut)
    assert.is_true(same_nodes(bits, again.mesh))
    assert(again:bone("neck"):scale(1.01))
    assert(again:undo())
    again:close()
    assert.equal(text .. 'assert(session:bone("neck"):scale{1.01, 1.01, 1.01})\nassert(session:undo())\n',
      check.read(folder .. "/cut.lua"))
    body({journal = path}):close()
    assert.equal(text, check.read(path .. "~"))
  end)

  it("replays after the program was killed in the middle of its edits", function()
    local folder = check.folder()
    check.write(folder .. "/part.lua", [[
local bw = require "barwright"
local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}, cells = {12, 2, 2}, order = 2}
local part = bw.model {mesh = mesh, material = bw.material.steel}
return part, {skeleton = bw.skeleton.create {joints = {{0, 0.05, 0.05}, {0.5, 0.05, 0.05}, {1, 0.05, 0.05}},
  bones = {{1, 2, name = "upper"}, {2, 3, name = "lower"}}, root = 1}}
]])
    check.write(folder .. "/work.lua", ([[
local bw = require "barwright"
local folder = %q
local part, opts = dofile(folder .. "/part.lua")
opts.script, opts.journal = "part.lua", folder .. "/journal.lua"
local session = assert(bw.edit(part, opts))
for i = 1, 1e9 do
  assert(session:bone(i %% 2 == 0 and "upper" or "lower"):rotate {axis = {1, i %% 7, 2}, degrees = 1 / i})
  if i %% 5 == 0 then assert(session:undo()) end
end
]]):format(folder))
    local path = folder .. "/journal.lua"
    for _, max in ipairs {20, 60} do -- killed once the journal has so many lines
      os.remove(path)
      os.execute(("sh -c '\"%s\" %s/work.lua >/dev/null 2>&1 & pid=$!; "
        .. "until [ \"$(cat %s 2>/dev/null | wc -l)\" -gt %d ] || ! kill -0 $pid; do sleep 0.02; done; "
        .. "kill -9 $pid'")
        :format(check.program, folder, path, max))
      local lines = select(2, check.read(path):gsub("\n", "\n"))
      local session = assert(bw.edit.load(path))
      assert.truthy(#session.edits > 0 and #session.edits < lines)
    end
  end)

  it("runs by itself when it knows the script of its part", function()
    local folder = check.folder()
    check.write(folder .. "/part.lua", [[
local bw = require "barwright"
local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}, cells = {8, 1, 1}, order = 2}
local part = bw.model {mesh = mesh, material = bw.material.steel}
part:fix(mesh.boundary:below(1, 0)):gravity {0, 0, -9.81}
return part, {skeleton = bw.skeleton.create {joints = {{0, 0.05, 0.05}, {0.5, 0.05, 0.05}, {1, 0.05, 0.05}},
  bones = {{1, 2, name = "upper"}, {2, 3, name = "lower"}}, root = 1}}
]])
    local session = assert(bw.edit.begin(folder .. "/part.lua"))
    assert(session:bone("lower"):rotate {y = 12.5})
    assert(session:save(folder .. "/edits.lua"))
    local alone = assert(bw.edit.load(folder .. "/edits.lua"))
    assert.is_true(same_nodes(session.mesh, alone.mesh))
    local text = check.read(folder .. "/edits.lua"):gsub("return session", "print(session)")
    check.write(folder .. "/shown.lua", text)
    local code, out, complaint = check.run(folder .. "/shown.lua and arguments")
    assert.message(complaint).equal(0, code)
    assert.truthy(out:find 'session:bone%("lower"%):rotate{y = 12.5}')
  end)

  it("that is interrupted says so", function()
    local folder = check.folder()
    check.write(folder .. "/part.lua", [[
local bw = require "barwright"
local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}, cells = {8, 1, 1}}
return bw.model {mesh = mesh, material = bw.material.steel}, {skeleton = bw.skeleton.create {
  joints = {{0, 0.05, 0.05}, {1, 0.05, 0.05}}, bones = {{1, 2}}, root = 1}}
]])
    check.write(folder .. "/edits.lua", 'local session = require("barwright").edit.begin("part.lua")\n')
    local before = bw.progress(function() return false end)
    check.fails("cancelled", "edits.lua was interrupted while it was replayed: line 1: ",
      bw.edit.load(folder .. "/edits.lua"))
    bw.progress(before)
    assert(bw.edit.load(folder .. "/edits.lua"))
  end)

  it("that cannot be replayed says where", function()
    local folder = check.folder()
    local path = folder .. "/edits.lua"
    check.write(path, 'local session = require("barwright").edit.begin(nil, ...)\n'
      .. 'assert(session:bone("nobody"):scale{1, 1, 1})\n')
    check.fails("format", "nobody", bw.edit.load(path, beam()))
    check.fails("format", "name no script", bw.edit.load(path))
    check.fails("format", "edits.lua could not be replayed: line 2: there is no bone 'nobody'",
      bw.edit.load(path, beam()))
    check.raises("a session expected", bw.edit.load, path, {})
    check.write(path, "this is not Lua\n")
    check.fails("format", "edits.lua", bw.edit.load(path, beam()))
    check.fails("io", "none.lua", bw.edit.load(folder .. "/none.lua", beam()))
    check.fails("io", "", bw.edit(beam_part(), {skeleton = beam_skeleton(), journal = folder .. "/no/such"}))
  end)
end)

describe("a journal", function()
  it("takes the place of a journal, and of nothing else", function()
    local folder = check.folder()
    local function refuses(path)
      check.fails("io", "no journal of edits", bw.edit(beam_part(), {skeleton = beam_skeleton(), journal = path}))
    end
    check.write(folder .. "/part.lua", "return part\n")
    refuses(folder .. "/part.lua")
    assert.equal("return part\n", check.read(folder .. "/part.lua"))
    refuses(folder)
    refuses "/dev/zero"
    check.write(folder .. "/empty.lua", "")
    beam({journal = folder .. "/empty.lua"}):close()
  end)

  it("is whole again after a disk was full", function()
    local path = check.folder() .. "/journal.lua"
    local session = beam {journal = path}
    assert(session:bone("lower"):rotate {z = 5})
    local mesh, text = session.mesh, check.read(path)
    local full = io.open("/dev/full", "ab")
    if not full then return end
    session.record.file:close()
    session.record.file = full
    check.write(path, text .. 'assert(session:bone("lo') -- as much as went onto the disk
    local ok, message, details = session:bone("lower"):rotate {z = 5}
    check.fails("io", "journal.lua", ok, message, details)
    assert.is_true(same_nodes(mesh, session.mesh))
    assert.equal(1, #session.edits)
    assert(session:bone("upper"):scale(1.1)) -- there is room again
    session:close()
    assert.equal(text .. 'assert(session:bone("upper"):scale{1.1, 1.1, 1.1})\n', check.read(path))
  end)
end)
