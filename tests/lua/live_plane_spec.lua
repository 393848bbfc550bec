-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The controller of the plane's live view, through a table in place of its server, and its file of edits. The
-- page is tested in tests/pages/plane.mjs.
local bw = require "barwright"
local core = require "barwright.core"
local edits = require "barwright.live_plane_edits"
local kinds = require "barwright.live_plane_kinds"
local live_plane_controller = require "barwright.live_plane_controller"
local live_pack = require "barwright.live_pack"
local check = require "check"
local live_talk = require "live_talk"

local function made(name)
  return assert(dofile(check.root .. "/tests/lua/live_plane/" .. name .. ".lua"))
end

local function controller_on(object, about)
  return live_talk(live_plane_controller, object, about, function(bytes, server)
    local message, blocks = live_pack.read(bytes)
    server.blocks[message.type] = blocks
    return message
  end)
end

local function points_of(object)
  return object.outline.points:tostring "<f8"
end

describe("a controller in the plane", function()
  it("tells a window the scene, the mesh and the state", function()
    local talk = controller_on(made "steady", {limit = 30e6})
    local got = talk.open(3)
    assert.equal("welcome", got[1].type)
    assert.equal("scene", got[2].type)
    assert.equal("hole", got[2].loops[2].name)
    assert.equal("outline", got[2].loops[2].parent)
    assert.equal("von_mises", got[2].fields[1].key)
    assert.is_false(got[2].steps)
    assert.equal(5 * talk.object.outline.edge_count, got[2].blocks[1].count)
    assert.equal("mesh", got[3].type)
    assert.equal(3 * talk.object.element_count, got[3].blocks[1].count)
    local state = got[4]
    assert.equal("state", state.type)
    check.near(talk.object.von_mises:max(), state.maximum, 1e-12)
    check.near(talk.object.outline.area, state.area, 1e-12)
    assert.equal(30e6, state.limit)
    local x, y = ("<ff"):unpack(talk.server.blocks.state.outline, 9)
    check.near(0.2, x, 1e-6)
    assert.equal(0, y)
  end)

  it("makes one edit of a drag, of moves that wait only the newest, each from where the drag began", function()
    local talk = controller_on(made "steady")
    talk.open(1)
    talk.open(2)
    local handle = {loop = "hole"}
    talk.say(1, {type = "begin", handle = handle, seq = 1})
    local last, all = talk.say(1, {type = "move", seq = 2, by = {0.001, 0}},
      {type = "move", seq = 3, by = {0.002, 0}}, {type = "move", seq = 4, by = {0.004, 0.001}})
    assert.equal(1, #all)
    assert.equal(4, last.drag.seq)
    assert.equal(0, last.edits)
    assert.same(last, talk.server.got[2][#talk.server.got[2]])
    talk.say(1, {type = "move", seq = 5, by = {0.01, 0}})
    assert.equal("refused", talk.say(2, {type = "undo"}).type)
    assert.equal("refused", talk.say(2, {type = "begin", handle = handle, seq = 1}).type)
    assert.equal("refused", talk.say(2, {type = "end"}).type)
    last = talk.say(1, {type = "end"})
    assert.equal(1, last.edits)
    assert.is_nil(last.drag)
    assert.equal('assert(object:drag({loop = "hole"}, {0.01, 0}))', last.script[1])
    -- the same as one drag of a script
    local other = made "steady"
    assert(other:drag(handle, {0.01, 0}))
    assert.equal(points_of(other), points_of(talk.object))
    last = talk.say(2, {type = "undo"})
    assert.is_true(last.can_redo)
    assert.equal(points_of(made "steady"), points_of(talk.object))
    assert.equal(1, talk.say(2, {type = "redo"}).edits)
    assert.equal(points_of(other), points_of(talk.object))
    assert.equal(0, talk.say(2, {type = "reset"}).edits)
  end)

  it("counts the levels and tells a new mesh only where there is one", function()
    local talk = controller_on(made "steady")
    talk.open(1)
    talk.say(1, {type = "begin", handle = {loop = "hole"}, seq = 1})
    local _, all = talk.say(1, {type = "move", seq = 2, by = {1e-4, 0}})
    assert.equal("state", all[1].type)
    assert.equal("relocation", all[1].level)
    local meshes = 0
    for i = 1, 12 do
      _, all = talk.say(1, {type = "move", seq = 2 + i, by = {5e-3 * i, 0}})
      for _, message in ipairs(all) do
        if message.type == "mesh" then meshes = meshes + 1 end
      end
    end
    local levels = all[#all].levels
    assert.is_true(meshes > 0)
    assert.equal(13, (levels.relocation or 0) + (levels.reconnecting or 0) + (levels.reconstruction or 0))
    assert.equal(meshes, (levels.reconnecting or 0) + (levels.reconstruction or 0))
    talk.say(1, {type = "end", cancel = true})
    assert.equal(points_of(made "steady"), points_of(talk.object))
  end)

  it("says why it refuses, and keeps the last good shape", function()
    local talk = controller_on(made "steady")
    talk.open(1)
    talk.say(1, {type = "begin", handle = {loop = "hole"}, seq = 1})
    talk.say(1, {type = "move", seq = 2, by = {0.01, 0}})
    local answer = talk.say(1, {type = "move", seq = 3, by = {1, 0}})
    assert.equal("refused", answer.type)
    assert.equal(3, answer.seq)
    assert.truthy(answer.message:find "hole")
    assert.equal('assert(object:drag({loop = "hole"}, {0.01, 0}))', talk.say(1, {type = "end"}).script[1])
    answer = talk.say(1, {type = "edit", edit = {kind = "hole", at = {5 / 3, 0.05}, radius = 0.01}})
    assert.equal("refused", answer.type)
    assert.equal(1, talk.controller.position - 1)
  end)

  it("ends a drag whose window is closed", function()
    local talk = controller_on(made "steady")
    talk.open(1)
    talk.open(2)
    talk.say(1, {type = "begin", handle = {vertex = 3}, seq = 1})
    talk.say(1, {type = "move", seq = 2, by = {0.01, 0.01}})
    talk.close(1)
    local got = talk.server.got[2]
    assert.equal(1, got[#got].edits)
    assert.is_nil(got[#got].drag)
  end)

  it("makes holes, smooths, splits, joins, pulls, removes; and the lines make it again", function()
    local talk = controller_on(made "steady", {script = "steady.lua"})
    talk.open(1)
    local function edit(e)
      local answer = talk.say(1, {type = "edit", edit = e})
      assert.equal("state", answer.type, answer.message)
      return answer
    end
    edit {kind = "hole", at = {0.15, 0.05}, radius = 0.01}
    assert.equal("hole 1", talk.object.outline.loops[3].name)
    edit {kind = "split", edge = 3, t = 0.5}
    talk.say(1, {type = "begin", handle = {vertex = 4}, pins = {3, 5}, seq = 1})
    talk.say(1, {type = "move", seq = 2, by = {0, 0.01}})
    talk.say(1, {type = "end"})
    edit {kind = "smooth", loop = "hole"}
    edit {kind = "smooth"}
    edit {kind = "join", vertex = 4}
    edit {kind = "remove", loop = "hole 1"}
    assert.equal(7, talk.controller.position - 1)
    local points = points_of(talk.object)
    talk.say(1, {type = "export", format = "lua"})
    local script, lines = edits.read(talk.server.files["outline.lua"])
    assert.equal("steady.lua", script)
    assert.equal(7, #lines)
    local again = made "steady"
    for _, line in ipairs(lines) do assert(edits.replay(again, line)) end
    assert.equal(points, points_of(again))
    -- and a controller begins with them, so that they can be undone
    local later = controller_on(made "steady", {lines = lines})
    later.open(1)
    assert.equal(6, later.say(1, {type = "undo"}).edits)
    local _, err = controller_on(made "steady", {lines = {"assert(object:melt())"}})
    assert.truthy(err:find "edit 1, .*melt")
  end)

  it("keeps the edits in a file before they are reported, and the file runs", function()
    local folder = check.folder()
    local save = folder .. "/kept.lua"
    local talk = controller_on(made "steady", {saved = save,
      script = check.root .. "/tests/lua/live_plane/steady.lua"})
    talk.open(1)
    talk.say(1, {type = "begin", handle = {edge = 2}, seq = 1})
    talk.say(1, {type = "move", seq = 2, by = {0.01, 0}})
    talk.say(1, {type = "end"})
    local script = check.root .. "/tests/lua/live_plane/steady.lua"
    if script:sub(1, 1) ~= "/" then
      -- a name from the file's own folder
      local text = check.read(save):gsub("dofile%(folder %.%. ", "dofile(")
      check.write(save, text)
    end
    local object = dofile(save)
    assert.equal(points_of(talk.object), points_of(object))
    assert.same({'assert(object:drag({edge = 2}, {0.01, 0}))'}, select(2, edits.read(check.read(save))))
    talk.say(1, {type = "undo"})
    assert.equal(0, #select(2, edits.read(check.read(save))))
  end)

  it("sends the fields that some window looks at", function()
    local talk = controller_on(made "steady")
    talk.open(1)
    talk.open(2)
    local state = talk.say(2, {type = "show", field = "displacement"})
    assert.truthy(state.fields.von_mises and state.fields.displacement)
    assert.is_nil(state.fields.stress_xx)
    check.near(talk.object.displacement:map("sqrt(a[1]^2 + a[2]^2)"):max(), state.fields.displacement[2], 1e-12)
    talk.close(2)
    assert.is_nil(talk.say(1, {type = "limit", von_mises = 1e7}).fields.displacement)
  end)

  it("goes back from a cancelled drag with the next message, where it could not at once", function()
    local talk = controller_on(made "vibration")
    talk.open(1)
    local before = points_of(talk.object)
    talk.say(1, {type = "begin", handle = {loop = "window"}, seq = 1})
    talk.say(1, {type = "move", seq = 2, by = {0, -0.01}})
    rawset(talk.object, "become", function() return nil, "there is no memory" end)
    talk.say(1, {type = "end", cancel = true})
    assert.not_equal(before, points_of(talk.object))
    rawset(talk.object, "become", nil)
    talk.say(1, {type = "pace", running = false})
    assert.equal(before, points_of(talk.object))
  end)

  it("makes no edit that it cannot keep", function()
    local folder = check.folder()
    local talk = controller_on(made "steady", {saved = folder .. "/edits.lua", script = "made.lua"})
    talk.open(1)
    local function drag()
      talk.say(1, {type = "begin", handle = {loop = "hole"}, seq = 1})
      talk.say(1, {type = "move", seq = 2, by = {0.01, 0}})
      return select(2, talk.say(1, {type = "end"}))
    end
    drag()
    local before, position = points_of(talk.object), talk.controller.position
    os.execute("rm -r '" .. folder .. "'")
    for _, act in ipairs {drag, function() return select(2, talk.say(1, {type = "undo"})) end} do
      local all, reported = act(), nil
      for _, message in ipairs(all) do reported = reported or message.type == "refused" and message.message end
      assert.truthy(reported and reported:find "cannot be kept")
      assert.equal(before, points_of(talk.object))
      assert.equal(position, talk.controller.position)
    end
  end)

  it("lets time go on at its own pace while a window is open, through drags, until it is paused", function()
    local talk = controller_on(made "vibration")
    assert.equal(3600, talk.controller:wait())
    talk.open(1)
    assert.equal(0, talk.controller:wait())
    local before = core.seconds()
    talk.controller:idle()
    check.near(2e-3, talk.object.time, 1e-12)
    assert.is_true(talk.controller.due > before)
    talk.controller.due = core.seconds() + 1000
    assert.is_true(talk.controller:wait() > 0)
    talk.controller:idle() -- nothing is due
    check.near(2e-3, talk.object.time, 1e-12)
    talk.say(1, {type = "pace", steps = 5})
    talk.say(1, {type = "begin", handle = {loop = "window"}, seq = 1})
    local _, all = talk.say(1, {type = "move", seq = 2, by = {0, -0.01}})
    assert.equal(0, #all) -- the step that is due next shows it
    talk.controller.due, talk.controller.a_step = 0, 1e-6 -- a machine that has time for all five
    talk.controller:idle()
    all = talk.server.got[1]
    assert.equal(2, all[#all].drag.seq)
    assert.equal("relocation", all[#all].level)
    check.near(12e-3, all[#all].time, 1e-12)
    talk.say(1, {type = "end"})
    assert.is_false(talk.say(1, {type = "pace", running = false}).running)
    assert.equal(3600, talk.controller:wait())
    assert.equal("refused", controller_on(made "steady").say(1, {type = "pace", running = true}).type)
  end)

  it("stops the time where a step fails, and says why", function()
    local object = made "vibration"
    local talk = controller_on(object)
    talk.open(1)
    rawset(object, "step", function() return nil, "the house fell down" end)
    talk.controller:idle()
    local got = talk.server.got[1]
    assert.equal("the house fell down", got[#got].failure)
    assert.is_false(got[#got].running)
  end)

  it("tells the tone, and tunes in sight; stop brings the shape back", function()
    local talk = controller_on(made "bar")
    local got = talk.open(1)
    local state = got[#got]
    check.near(talk.object.frequency, state.frequency, 1e-12)
    assert.equal(3, #state.tone.frequencies)
    assert.equal(1, state.tone.gains[1])
    assert.equal(2, #state.holes)
    assert.is_true(#talk.server.blocks.state.lines > 100)
    assert.truthy(talk.say(1, {type = "tune", target = "H9"}).message:find "note like C5")
    local last, all = talk.say(1, {type = "tune", target = "C#5"})
    local seen = {}
    for _, message in ipairs(all) do seen[message.type] = (seen[message.type] or 0) + 1 end
    assert.is_true(seen.progress >= 2 and seen.state >= 2 and seen.tuned == 1)
    assert.equal("C#5", last.note)
    assert.equal('assert(object:tune("C#5"))', last.script[1])
    -- pinned vertices stay, from where the size is about right
    local from = talk.object.outline:edge(2).from
    last = talk.say(1, {type = "tune", target = 1.01 * last.frequency, pins = {2, 3}})
    assert.truthy(last.script[2]:find(", {pins = {2, 3}}))", 1, true))
    assert.same(from, talk.object.outline:edge(2).from)
    assert.equal("error", talk.say(1, {type = "tune", target = 700, pins = {99}}).type)
    local points = points_of(talk.object)
    talk.server.waiting = {{1, "message", '{"type":"stop"}'}}
    last, all = talk.say(1, {type = "tune", target = 700})
    assert.equal(2, last.edits)
    assert.truthy(all[#all - 1].message:find "stopped")
    assert.equal(points, points_of(talk.object))
  end)

  it("takes a steady flow back to the very state that it was in", function()
    local tunnel = assert(bw.outline {points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}},
      tags = {sides = {1, 3}, outlet = 2, inlet = 4},
      holes = {bw.outline.circle {centre = {0.6, 0.5}, radius = 0.12, name = "body", tag = "body"}}})
    local flow = assert(bw.responsive.flow {outline = tunnel, viscosity = 0.02, elements = 400, steady = true,
      conditions = {inlet = {x = 1, y = 0}, sides = {y = 0}, body = "wall"}})
    local talk = controller_on(flow)
    talk.open(1)
    local function bits() return flow.velocity:tostring "<f8" .. flow.points:tostring "<f8" end
    local states = {bits()}
    for k = 1, 2 do
      talk.say(1, {type = "begin", handle = {loop = "body"}, seq = 3 * k})
      talk.say(1, {type = "move", seq = 3 * k + 1, by = {0.1, 0.02}})
      talk.say(1, {type = "end"})
      states[k + 1] = bits()
    end
    talk.say(1, {type = "begin", handle = {loop = "body"}, seq = 20})
    talk.say(1, {type = "move", seq = 21, by = {0.3, 0}})
    assert.not_equal(states[3], bits())
    talk.say(1, {type = "end", cancel = true})
    assert.is_true(states[3] == bits())
    assert.equal(1, talk.say(1, {type = "undo"}).edits)
    assert.is_true(states[2] == bits())
    talk.say(1, {type = "redo"})
    assert.is_true(states[3] == bits())
    talk.say(1, {type = "reset"})
    assert.is_true(states[1] == bits())
    assert.equal(0, flow.reused.solves)
  end)

  it("shows flows with arrows", function()
    for _, name in ipairs {"flow", "kettle"} do
      local talk = controller_on(made(name))
      talk.open(1)
      talk.controller:idle()
      local got = talk.server.got[1]
      local state = got[#got]
      assert.is_nil(state.failure)
      assert.equal(8 * talk.object.node_count, #talk.server.blocks.state.arrows)
      assert.is_true(state.time > 0)
      assert.truthy(state.readouts[1][1]:find(name == "flow" and "force on cylinder" or "heat in at bottom"))
    end
    -- a hole in a stream is a wall
    local stream = controller_on(made "flow")
    stream.open(1)
    stream.say(1, {type = "edit", edit = {kind = "hole", at = {1.5, 0.5}, radius = 0.1}})
    assert.truthy(stream.controller.history[2].line:find 'tag = "cylinder"')
  end)

  it("answers what is no message with what was expected, and changes nothing", function()
    local talk = controller_on(made "steady")
    talk.open(1)
    local before = points_of(talk.object)
    for text, expected in pairs {
      ["melt"] = "not JSON", ["[]"] = "type", ['{"type":"melt"}'] = "unknown type",
      ['{"type":"begin","seq":1,"handle":{}}'] = "one of vertex",
      ['{"type":"begin","seq":1,"handle":{"vertex":0}}'] = "whole number from 1",
      ['{"type":"begin","seq":1,"handle":{"vertex":1,"edge":1}}'] = "one of vertex",
      ['{"type":"begin","seq":1,"handle":{"edge":1,"control":1}}'] = "edge that is a curve",
      ['{"type":"begin","seq":1,"handle":{"loop":"moon"}}'] = "name of a loop",
      ['{"type":"begin","seq":1,"handle":{"loop":"hole"},"pins":[1]}'] = "a vertex is pulled",
      ['{"type":"begin","seq":1,"handle":{"vertex":1},"pins":[1,77]}'] = "numbers of vertices",
      ['{"type":"move","seq":1,"by":[1e9,0]}'] = "two numbers",
      ['{"type":"move","seq":1,"by":[0,0,0]}'] = "two numbers",
      ['{"type":"edit","edit":{"kind":"hole","at":[0,0]}}'] = "radius",
      ['{"type":"edit","edit":{"kind":"hole","at":[0,0],"radius":-1}}'] = "a number from",
      ['{"type":"edit","edit":{"kind":"os"}}'] = "of kind smooth",
      ['{"type":"show","field":"soul"}'] = "key of a field",
      ['{"type":"export","format":"../x"}'] = "svg or dxf or lua",
      ['{"type":"tune","target":-1}'] = "frequency",
      ['{"type":"pace","steps":0}'] = "a number from 1",
      ['{"type":"undo","now":1}'] = "unknown field",
    } do
      local answer = talk.say(1, text)
      assert.equal("error", answer.type, text)
      assert.truthy(answer.message:find(expected, 1, true), text .. ": " .. answer.message)
    end
    assert.equal("refused", talk.say(1, {type = "undo"}).type)
    assert.equal("refused", talk.say(1, {type = "tune", target = "A4"}).type)
    assert.equal("refused", talk.say(1, {type = "move", seq = 1, by = {0, 0}}).type)
    assert.equal(before, points_of(talk.object))
  end)

  it("stands through random messages with wild values", function()
    local talk = controller_on(made "steady")
    talk.open(1)
    local seed = 7
    local function random(n)
      seed = (seed * 1103515245 + 12345) % 2147483648
      return seed // 65536 % n + 1
    end
    local function length() return (random(4001) - 2001) * 1e-4 end
    local makers = {
      function() return {type = "begin", seq = 1, handle = ({{vertex = random(12)}, {edge = random(12)},
        {loop = "hole"}, {loop = "outline"}})[random(4)], pins = random(4) == 1 and {random(12)} or nil} end,
      function() return {type = "move", seq = 1, by = {length(), length()}} end,
      function() return {type = "move", seq = 1, by = {length() / 20, length() / 20}} end,
      function() return {type = "end", cancel = random(2) == 1} end,
      function() return {type = "edit", edit = ({{kind = "smooth"}, {kind = "join", vertex = random(12)},
        {kind = "split", edge = random(12), t = 0.3}, {kind = "remove", loop = "hole"},
        {kind = "hole", at = {length() + 0.2, length() + 0.2}, radius = 0.005 * random(6)}})[random(5)]} end,
      function() return {type = ({"undo", "redo", "undo", "reset"})[random(4)]} end,
    }
    for _ = 1, 250 do talk.say(1, makers[random(#makers)]()) end
    talk.say(1, {type = "end"})
    local object = talk.object
    assert.is_true(object.outline.area > 0)
    -- the last good state is a solved one: solving again changes nothing
    local max = object.von_mises:max()
    assert(object:solve())
    check.near(max, object.von_mises:max(), 1e-6)
  end)
end)

describe("live views of other things", function()
  it("know what can be shown", function()
    assert.is_nil(kinds.of({}))
    assert.is_nil(kinds.of(nil))
    assert.is_nil(kinds.of(core))
    assert.is_nil(kinds.of(made "steady".outline))
    assert.equal("Large-deflection sheet", kinds.of(made "cantilever").title)
    check.raises("unknown option 'ties'", bw.live, made "steady", {ties = {}})
  end)
end)

describe("barwright live, given an outline's analysis,", function()
  it("says in a sentence what it cannot go on with", function()
    local folder = check.folder()
    check.write(folder .. "/sheet.lua", check.read(check.root .. "/tests/lua/live_plane/steady.lua"))
    check.write(folder .. "/failed.lua", 'return nil, "the mesh is too fine"')
    local begun = edits.text("sheet.lua", {"assert(object:drag({vertex = 3}, {-1, 0}))"})
    for _, case in ipairs {
      {"return 5", 2, "not a file of edits of an outline"},
      {begun, 3, "edit 1, assert(object:drag({vertex = 3}, {-1, 0}))"},
      {(begun:gsub("drag%(.-}%)", "drag(")), 3, "edit 1, assert(object:drag("},
    } do
      local text, code, expected = table.unpack(case)
      check.write(folder .. "/sheet.edits.lua", text)
      local status, _, err = check.run("live --no-open " .. folder .. "/sheet.lua")
      assert.equal(code, status, err)
      assert.truthy(err:find(expected, 1, true), err)
      assert.is_nil(err:find "traceback")
      assert.equal(text, check.read(folder .. "/sheet.edits.lua")) -- left as it was
    end
    local status, _, err = check.run("live --no-open " .. folder .. "/failed.lua")
    assert.equal(2, status)
    assert.truthy(err:find("the mesh is too fine", 1, true), err)
    check.write(folder .. "/lost.lua", (begun:gsub("sheet", "nowhere")))
    status, _, err = check.run("live --no-open " .. folder .. "/lost.lua")
    assert.equal(3, status)
    assert.truthy(err:find("nowhere.lua", 1, true), err)
  end)
end)
