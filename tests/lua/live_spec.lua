-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The live view's controller, through a table in place of its server, and the command. Sockets are tested in
-- test_live.c, the page in tests/pages/live.mjs.
local bw = require "barwright"
local core = require "barwright.core"
local live_controller = require "barwright.live_controller"
local live_frame = require "barwright.live_frame"
local check = require "check"
local live_talk = require "live_talk"

local session_file = check.root .. "/tests/lua/live_session.lua"

-- States and scenes are tables.
local function controller_on(session, about)
  return assert(live_talk(live_controller, session, about, live_frame.read))
end

local shared
local function hook()
  if not shared then shared = assert(dofile(session_file)) end
  while shared:undo() do end
  return shared
end

-- The last message of a type: a shape may come before the last state, where the machine is busy.
local function last_of(got, kind)
  for i = #got, 1, -1 do
    if got[i].type == kind then return got[i] end
  end
  error("there is no " .. kind)
end

local function scaled(by)
  return {scale = {1, by, by}}
end

describe("a controller", function()
  it("tells a window who it is, the scene, the state", function()
    local talk = controller_on(hook())
    local got = talk.open(3)
    assert.equal("welcome", got[1].type)
    assert.equal(3, got[1].client)
    assert.equal("scene", got[2].type)
    assert.equal("arm", got[2].bones[1].name)
    assert.equal(3 * #got[2].blocks, got[2].blocks[1].count % 3 == 0 and 3 or 0)
    local state = got[3]
    assert.equal("state", state.type)
    check.near(assert(talk.object:solve()).von_mises:max(), state.maximum, 1e-9)
    assert.is_false(state.can_undo)
    assert.equal(3 * state.blocks[2].count, state.blocks[1].count)
    assert.equal(53e6, state.limit)
  end)

  it("makes one edit of a drag, and the newest of moves that wait", function()
    local talk = controller_on(hook())
    talk.open(1)
    talk.open(2)
    talk.say(1, {type = "begin", bone = "arm", seq = 1})
    local last, all = talk.say(1, {type = "move", seq = 2, change = scaled(1.05)},
      {type = "move", seq = 3, change = scaled(1.1)}, {type = "move", seq = 4, change = scaled(1.2)})
    assert.equal(1, #all)
    assert.equal(4, last.drag.seq)
    assert.equal(0, last.edits)
    assert.equal(0, #talk.object.edits)
    assert.same(last, talk.server.got[2][#talk.server.got[2]])
    assert.equal("refused", talk.say(2, {type = "undo"}).type)
    assert.equal("refused", talk.say(2, {type = "begin", bone = "nose", seq = 1}).type)
    assert.equal("refused", talk.say(2, {type = "end"}).type)
    last = talk.say(1, {type = "end"})
    assert.equal(1, last.edits)
    assert.is_nil(last.drag)
    assert.equal('session:bone("arm"):scale{1, 1.2, 1.2}', talk.object.edits[1].script)
    assert.is_true(talk.say(2, {type = "undo"}).can_redo)
    assert.equal(1, talk.say(2, {type = "redo"}).edits)
  end)

  it("shows a shape before stresses that take long", function()
    local talk = controller_on(hook())
    talk.open(1)
    talk.controller.seconds = 5
    local _, all = talk.say(1, {type = "edit", bone = "arm", change = scaled(1.1)})
    assert.equal("shape", all[1].type)
    assert.equal("state", all[2].type)
    assert.same(all[2].joints, all[1].joints)
    assert.equal(all[2].blocks[1].count, all[1].blocks[1].count)
  end)

  it("says why it refuses, and the session is as it was", function()
    local talk = controller_on(hook())
    talk.open(1)
    local bent = {rotate = {axis = {0, 1, 0}, degrees = -170}}
    local answer = talk.say(1, {type = "edit", bone = "nose", change = bent, seq = 7})
    assert.equal("refused", answer.type)
    assert.equal(7, answer.seq)
    assert.truthy(answer.message:find "folds the part over itself, at worst at")
    assert.equal(0, #talk.object.edits)
    -- In a drag the shape before stays, and is what the drag's end makes an edit of.
    talk.say(1, {type = "begin", bone = "nose", seq = 1})
    talk.say(1, {type = "move", seq = 2, change = scaled(1.1)})
    assert.equal("refused", talk.say(1, {type = "move", seq = 3, change = bent}).type)
    talk.say(1, {type = "end"})
    assert.equal('session:bone("nose"):scale{1, 1.1, 1.1}', talk.object.edits[1].script)
    assert.equal(1, #talk.object.edits)
  end)

  it("ends a drag whose window is closed, and takes one back that is cancelled", function()
    local talk = controller_on(hook())
    talk.open(1)
    talk.open(2)
    talk.say(1, {type = "begin", bone = "arm", seq = 1}, {type = "move", seq = 2, change = scaled(1.1)})
    talk.close(1)
    assert.equal(1, #talk.object.edits)
    local reported = talk.server.got[2][#talk.server.got[2]]
    assert.is_nil(reported.drag)
    assert.equal(1, reported.edits)
    talk.say(2, {type = "begin", bone = "arm", seq = 1}, {type = "move", seq = 2, change = scaled(1.1)},
      {type = "end", cancel = true})
    assert.equal(1, #talk.object.edits)
    talk.say(2, {type = "begin", bone = "arm", seq = 1})
    talk.close(2)
    assert.equal(1, #talk.object.edits)
  end)

  it("does every kind of change", function()
    local talk = controller_on(hook())
    talk.open(1)
    for i, change in ipairs {scaled(1.1), {rotate = {axis = {0, 0, 1}, degrees = 5}},
      {translate = {0.001, 0, 0}}, {reach = {0.06, 0.002, 0.025}}, {reset = true}} do
      assert.equal(i, talk.say(1, {type = "edit", bone = "nose", change = change}).edits)
    end
    assert.equal(6, talk.say(1, {type = "reset"}).edits)
    assert.equal(20e6, talk.say(1, {type = "limit", von_mises = 20e6}).limit)
    assert.is_nil(talk.say(1, {type = "limit", von_mises = bw.json.null}).limit)
    local file = talk.say(1, {type = "export", format = "stl"})
    assert.equal(#talk.server.files[file.path], file.bytes)
    file = talk.say(1, {type = "export", format = "lua"})
    assert.truthy(talk.server.files[file.path]:find("session:reset()", 1, true))
  end)

  it("pulls joints, the root with everything, and keeps to the angles that bones may turn by", function()
    local talk = controller_on(hook())
    local before = talk.open(1)[3].joints
    local function place(name)
      for j, joint in ipairs(talk.object.skeleton.joint_names) do
        if joint == name then return j end
      end
    end
    local tip, wall = place "tip", place "wall"
    local state = talk.say(1, {type = "joint_limits", bone = "nose", swing = 3, twist = bw.json.null})
    check.near(3, state.joint_limits[2].swing, 1e-12)
    assert.is_nil(state.joint_limits[2].twist)
    assert.equal(bw.json.null, state.joint_limits[1])
    talk.say(1, {type = "begin", joint = "tip", seq = 1})
    state = talk.say(1, {type = "move", seq = 2, change = {reach = {0.03, 0, 0.05}}})
    assert.equal("tip", state.drag.joint)
    assert.is_nil(state.drag.bone)
    local refused = talk.say(1, {type = "move", seq = 3, change = {reset = true}})
    assert.truthy(refused.message:find("a joint is moved by 'reach'", 1, true))
    state = talk.say(1, {type = "end"})
    assert.truthy(state.script[#state.script]:find("session:reach", 1, true))
    local swing = state.joints[tip][3] - before[tip][3]
    assert.is_true(swing > 1e-3)
    local rotation = talk.object:bone "nose".rotation
    local trace = rotation[1][1] + rotation[2][2] + rotation[3][3]
    assert.is_true(math.deg(math.acos(math.min(1, (trace - 1) / 2))) < 3.001)
    local at = state.joints[wall]
    local moved = talk.say(1, {type = "edit", joint = "wall", change = {reach = {at[1], at[2], at[3] + 1e-3}}})
    for j, now in ipairs(moved.joints) do check.near(1e-3, now[3] - state.joints[j][3], 1e-9) end
    state = talk.say(1, {type = "joint_limits", bone = "nose"})
    assert.equal(bw.json.null, state.joint_limits[2])
  end)

  it("ties bones for the optimiser", function()
    local talk = controller_on(hook())
    talk.open(1)
    local state = talk.say(1, {type = "ties", ties = {{"arm", "nose"}}})
    assert.same({{"arm", "nose"}}, state.ties)
    state = talk.say(1, {type = "optimise", von_mises = 0.8 * state.maximum, move_supports = true})
    check.near(state.factors[1][2], state.factors[2][2], 1e-12)
    check.near(state.factors[1][3], state.factors[2][3], 1e-12)
    assert.is_true(state.factors[1][2] > 1.001)
    state = talk.say(1, {type = "ties", ties = {}})
    assert.same({}, state.ties)
  end)

  it("shows the worst load of the shape, and knows when it is of an earlier one", function()
    local talk = controller_on(hook())
    local own = talk.open(1)[3]
    assert.equal("own", own.loads.kind)
    local state, got = talk.say(1, {type = "loads", loads = "worst"})
    assert.equal("progress", got[1].type)
    assert.equal("worst", state.loads.kind)
    assert.is_false(state.loads.outdated)
    assert.is_true(#state.loads.arrows >= 2)
    local force, twist = {0, 0, 0}, 0
    for _, arrow in ipairs(state.loads.arrows) do
      for k = 1, 3 do force[k] = force[k] + arrow.force[k] end
      twist = twist + math.abs(arrow.force[1]) + math.abs(arrow.force[2]) + math.abs(arrow.force[3])
    end
    for k = 1, 3 do assert.is_true(math.abs(force[k]) < 1e-6 * twist) end -- balanced
    local part = bw.model {mesh = talk.object.source.mesh, material = talk.object.source.material}
    local worst = assert(bw.worst_case(part))
    part:load {nodal = worst:force()}
    check.near(assert(part:solve {inertia_relief = true}).von_mises:max(), state.maximum, 1e-6)
    state = talk.say(1, {type = "edit", bone = "nose", change = scaled(1.1)})
    assert.is_true(state.loads.outdated)
    -- a stop that arrives while it is looked for: what was found before stays
    talk.server.waiting = {{1, "message", '{"type":"stop"}'}}
    state, got = talk.say(1, {type = "loads", loads = "worst"})
    assert.truthy(last_of(got, "optimised").message:find("stopped", 1, true))
    assert.is_true(state.loads.outdated)
    state = talk.say(1, {type = "loads", loads = "own"})
    assert.equal("own", state.loads.kind)
    assert.equal(0, #(state.loads.arrows or {}))
    state = talk.say(1, {type = "undo"})
    check.near(own.maximum, state.maximum, 1e-9)
  end)

  it("gives up the stresses of a move that a newer one overtakes, but not for ever", function()
    local talk = controller_on(hook())
    talk.open(1)
    local function move(seq, by)
      return bw.json.encode {type = "move", seq = seq, change = scaled(by)}
    end
    local function kinds(got)
      local out = {}
      for _, message in ipairs(got) do
        out[#out + 1] = message.type .. (message.drag and message.drag.seq or "")
      end
      return table.concat(out, " ")
    end
    talk.say(1, {type = "begin", bone = "nose", seq = 1})
    talk.controller.seconds, talk.server.waiting = 1, {{1, "message", move(3, 1.2)}}
    local _, got = talk.say(1, move(2, 1.1))
    assert.equal("shape2 shape3 state3", kinds(got))
    -- another window's message, and a drag that has had no stresses for long, wait
    talk.controller.seconds, talk.server.waiting = 1, {{2, "message", '{"type":"undo"}'}}
    _, got = talk.say(1, move(4, 1.3))
    assert.equal("shape4 state4", kinds(got))
    talk.controller.seconds, talk.controller.reported_at = 1, -100
    talk.server.waiting = {{1, "message", move(6, 1.4)}}
    _, got = talk.say(1, move(5, 1.35))
    assert.equal("shape5 state5 state6", (kinds(got):gsub("shape6 ", ""))) -- shape6: on a busy machine
    -- the end of a drag overtakes it too, and what it leaves is the last move
    talk.controller.seconds, talk.server.waiting = 1, {{1, "message", '{"type":"end"}'}}
    local state
    state, got = talk.say(1, move(7, 1.25))
    assert.equal("shape7 shape state", kinds(got))
    check.near(1.25, state.factors[2][2], 1e-12)
    local full = assert(talk.object:solve {solver = bw.solver.cholesky {full = true}})
    check.near(full.von_mises:max(), state.maximum, 1e-8)
    -- in one batch the move before the end is not solved at all
    talk.say(1, {type = "begin", bone = "nose", seq = 8})
    talk.controller.seconds = 0
    state, got = talk.say(1, move(9, 0.8), {type = "end"})
    assert.equal("state", kinds(got))
    check.near(1, state.factors[2][2], 1e-12)
  end)

  it("optimises, says why not, and stops when asked", function()
    local talk = controller_on(hook())
    talk.open(1)
    local last, all = talk.say(1, {type = "optimise", von_mises = 30e6})
    -- The bone with the large stresses is the one that reaches the support.
    assert.truthy(last_of(all, "optimised").message:find("would move support 1", 1, true))
    assert.equal(0, last.edits)
    last, all = talk.say(1, {type = "optimise", von_mises = 30e6, move_supports = true})
    assert.is_true(last_of(all, "optimised").met)
    assert.truthy(last.maximum <= 30e6 * 1.0001)
    assert.equal(1, last.edits)
    last, all = talk.say(1, {type = "optimise", von_mises = 1e3})
    assert.is_false(last_of(all, "optimised").met)
    assert.truthy(#last_of(all, "optimised").message > 20)
    assert.equal(1, last.edits)
    -- What arrives while the engine works is kept for afterwards.
    talk.server.waiting = {{1, "message", '{"type":"undo"}'}, {1, "message", '{"type":"stop"}'}}
    last, all = talk.say(1, {type = "optimise", von_mises = 20e6, move_supports = true})
    local stopped
    for _, message in ipairs(all) do stopped = stopped or message.type == "optimised" and message end
    assert.is_false(stopped.met)
    assert.truthy(stopped.message:find "stopped")
    assert.equal(0, last.edits)
    assert.is_true(last.can_redo)
  end)
end)

-- ---- what is no message ------------------------------------------------------------------------------

describe("a message that is none", function()
  it("is answered with what was expected", function()
    local talk = controller_on(hook())
    talk.open(1)
    for text, expected in pairs {
      [""] = "not JSON", ["{"] = "not JSON", ["[]"] = "unknown type", ["3"] = "a JSON object",
      ["null"] = "a JSON object", ['{"type":"jump"}'] = "unknown type of message 'jump'",
      ['{"type":{}}'] = "unknown type", ['{"type":"undo","x":1}'] = "unknown field 'x'",
      ['{"type":"begin","bone":"arm"}'] = "'seq' is missing",
      ['{"type":"begin","bone":"leg","seq":1}'] = "the name of a bone expected",
      ['{"type":"begin","bone":1,"seq":1}'] = "the name of a bone expected",
      ['{"type":"begin","bone":"arm","seq":-1}'] = "a whole number expected",
      ['{"type":"begin","bone":"arm","seq":1.5}'] = "a whole number expected",
      ['{"type":"edit","bone":"arm","change":{}}'] = "one of rotate, scale",
      ['{"type":"edit","bone":"arm","change":[]}'] = "one of rotate, scale",
      ['{"type":"edit","bone":"arm","change":{"scale":[1,1,1],"reset":true}}'] = "one of rotate, scale",
      ['{"type":"edit","bone":"arm","change":{"scale":[1,1]}}'] = "three factors",
      ['{"type":"edit","bone":"arm","change":{"scale":[1,null,1]}}'] = "three factors",
      ['{"type":"edit","bone":"arm","change":{"scale":[1,1,1,1]}}'] = "three factors",
      ['{"type":"edit","bone":"arm","change":{"scale":[1,-1,1]}}'] = "three factors",
      ['{"type":"edit","bone":"arm","change":{"scale":[1,1e999,1]}}'] = "three factors",
      ['{"type":"edit","bone":"arm","change":{"translate":[1e300,0,0]}}'] = "three numbers of at most",
      ['{"type":"edit","bone":"arm","change":{"rotate":{"axis":[0,0,0],"degrees":1}}}'] = "not all 0",
      ['{"type":"edit","bone":"arm","change":{"rotate":{"axis":[0,0,1]}}}'] = "'degrees' is missing",
      ['{"type":"edit","bone":"arm","change":{"reset":false}}'] = "true expected",
      ['{"type":"optimise","von_mises":"NaN"}'] = "a number from",
      ['{"type":"optimise","von_mises":1e6,"bones":["arm","leg"]}'] = "a list of names",
      ['{"type":"optimise","von_mises":1e6,"move_supports":1}'] = "true or false",
      ['{"type":"begin","seq":1}'] = "one of 'bone' and 'joint'",
      ['{"type":"begin","bone":"arm","joint":"tip","seq":1}'] = "one of 'bone' and 'joint'",
      ['{"type":"begin","joint":"arm","seq":1}'] = "the name of a joint expected",
      ['{"type":"edit","joint":{},"change":{"reset":true}}'] = "the name of a joint expected",
      ['{"type":"joint_limits","swing":1}'] = "'bone' is missing",
      ['{"type":"joint_limits","bone":"arm","swing":181}'] = "a number from 0 to 180",
      ['{"type":"joint_limits","bone":"arm","twist":[5,-5]}'] = "two angles",
      ['{"type":"joint_limits","bone":"arm","twist":[1,2,3]}'] = "two angles",
      ['{"type":"joint_limits","bone":"arm","twist":{"1":2}}'] = "two angles",
      ['{"type":"ties"}'] = "'ties' is missing",
      ['{"type":"ties","ties":["arm","nose"]}'] = "lists of names of bones",
      ['{"type":"ties","ties":[["arm"]]}'] = "lists of names of bones",
      ['{"type":"ties","ties":[["arm","arm"]]}'] = "none of them twice",
      ['{"type":"ties","ties":[["arm","nose"],["nose","arm"]]}'] = "none of them twice",
      ['{"type":"ties","ties":{"x":["arm","nose"]}}'] = "lists of names of bones",
      ['{"type":"loads","loads":"all"}'] = "own or worst expected",
      ['{"type":"export","format":"../../x"}'] = "stl or lua expected",
      ['{"type":"x\\u0000\\udc00"}'] = "unknown type of message",
      ['{"\\u0000":1,"type":"undo"}'] = "unknown field '?'",
      [("["):rep(5000)] = "less nesting",
    } do
      local answer = talk.say(1, text)
      assert.equal("error", answer.type, text:sub(1, 80))
      assert.truthy(answer.message:find(expected, 1, true), text:sub(1, 80) .. ": " .. answer.message)
    end
    assert.equal(0, #talk.object.edits)
  end)

  it("changes nothing, whatever is in it", function()
    local talk = controller_on(hook())
    talk.open(1)
    math.randomseed(20130701)
    local good = {
      '{"type":"edit","bone":"arm","change":{"scale":[1,1.1,1.1]}}',
      '{"type":"begin","bone":"nose","seq":1}',
      '{"type":"move","seq":2,"change":{"rotate":{"axis":[0,1,0],"degrees":12.5}}}',
      '{"type":"optimise","von_mises":30000000,"min_factor":0.5,"bones":["arm"]}',
      '{"type":"limit","von_mises":null}',
    }
    local pieces = {"{", "}", "[", "]", ":", ",", '"', "null", "true", "1e308", "-", '"type"', '"edit"',
      '"change"', "\\u", "\\ud800", "\0", "\255", "NaN", "9999999999999999999999", '"scale"', "{}"}
    local answered = 0
    for round = 1, 900 do
      local text = good[round % #good + 1]
      if round % 3 == 0 then
        text = text:sub(1, math.random(#text) - 1) -- cut off
      elseif round % 3 == 1 then -- something put in its midst, so that it is no message any more
        local at = math.random(#text)
        text = text:sub(1, at - 1) .. pieces[math.random(#pieces)] .. text:sub(at + math.random(0, 9))
          .. pieces[math.random(#pieces)]
      else
        local bytes = {}
        for i = 1, math.random(200) do bytes[i] = string.char(math.random(0, 255)) end
        text = table.concat(bytes)
      end
      local answer = talk.say(1, text)
      if answer and answer.type == "error" then answered = answered + 1 end
      if talk.controller.drag then talk.say(1, {type = "end", cancel = true}) end
    end
    assert.truthy(answered > 890, answered)
    assert.equal(0, #talk.object.edits)
    assert.equal(1, talk.say(1, good[1]).edits)
  end)

  it("of right form and wild values leaves a sound session", function()
    local talk = controller_on(hook())
    talk.open(1)
    math.randomseed(7)
    local function wild()
      local kind = math.random(6)
      if kind == 1 then return 0 end
      if kind == 2 then return 10 ^ math.random(-300, 300) end
      return (math.random() - 0.5) * 10 ^ math.random(-3, 2)
    end
    for round = 1, 60 do
      local change = ({{scale = {wild(), wild(), wild()}}, {translate = {wild(), wild(), wild()}},
        {reach = {wild(), wild(), wild()}},
        {rotate = {axis = {wild(), wild(), wild()}, degrees = 100 * wild()}}})[round % 4 + 1]
      local answer = talk.say(1, {type = "edit", bone = round % 2 == 0 and "arm" or "nose", change = change})
      assert.truthy(answer.type == "state" or answer.type == "refused" or answer.type == "error")
      if answer.type == "state" then talk.say(1, {type = "undo"}) end
    end
    local state = talk.open(2)[3]
    assert.equal(0, state.edits)
    check.near(assert(hook():solve()).von_mises:max(), state.maximum, 1e-6)
  end)
end)

-- ---- the command --------------------------------------------------------------------------------------

-- Starts `barwright live` as a child; gives its address and number.
local function start(folder, arguments, environment)
  check.write(folder .. "/out", "")
  os.execute(("cd '%s' && { %s BARWRIGHT_QUIET=1 '%s' live hook.lua %s >out 2>&1 & echo $! >pid; }")
    :format(folder, environment or "", check.program:match "^/" and check.program
      or os.getenv "PWD" .. "/" .. check.program, arguments or "--no-open"))
  local address
  for _ = 1, 2400 do -- two minutes, on a busy machine
    address = check.read(folder .. "/out"):match "http://%S+"
    if address then break end
    os.execute "sleep 0.05"
  end
  return assert(address, check.read(folder .. "/out")), check.read(folder .. "/pid"):match "%d+"
end

local function stop(folder, pid, signal)
  os.execute(("kill -%s %s; for i in $(seq 1200); do kill -0 %s 2>/dev/null || break; sleep 0.05; done")
    :format(signal, pid, pid))
  return check.read(folder .. "/out")
end

local has_page = io.open(check.root .. "/build/web/live.js", "rb")
if has_page then has_page:close() end

describe("barwright live", function()
  it("says in a sentence what it cannot use", function()
    local folder = check.folder()
    check.write(folder .. "/nothing.lua", "return 5")
    check.write(folder .. "/broken.lua", "return (")
    for arguments, text in pairs {
      [""] = "FILE is missing",
      [folder .. "/missing.lua"] = "No such file",
      [folder .. "/nothing.lua"] = "must return a session",
      [folder .. "/broken.lua"] = "unexpected symbol",
      ["--prot 3 x.lua"] = "did you mean --port",
      ["x.lua --port 70000"] = "a whole number from 0 up to 65535 expected",
      ["x.lua --save"] = "a value is missing",
      ["x.lua y.lua"] = "one argument too many",
    } do
      local status, _, err = check.run("live " .. arguments)
      local unreadable = text == "No such file" or text == "unexpected symbol"
      assert.equal(unreadable and 3 or 2, status, arguments .. ": " .. err)
      assert.truthy(err:find(text, 1, true), err)
    end
    local status, out = check.run "live --help"
    assert.equal(0, status)
    assert.truthy(out:find("usage: barwright live", 1, true))
  end)

  it("serves a message where the page was not bundled", function()
    local server, pages = {}, {}
    function server.serve(_, path, mime, bytes) pages[path] = {mime, bytes} end
    local beside = require "barwright.beside"
    local find = beside.find
    beside.find = function(name) return name ~= "live.js" and find(name) or nil end
    local ok, why = pcall(require("barwright.live").serve_page, server)
    beside.find = find
    assert(ok, why)
    assert.truthy(pages[""][2]:find("nodejs and npm", 1, true))
    assert.is_nil(pages["live.js"])
  end)

  it("serves a page, ends at Ctrl-C, and goes on with the edits that were kept", function()
    if not has_page then return pending "the page is not bundled" end
    local folder = check.folder()
    check.write(folder .. "/hook.lua", check.read(session_file))
    local address, pid = start(folder)
    assert.truthy(address:match "^http://127%.0%.0%.1:%d+/%x+/$")
    local out = stop(folder, pid, "INT")
    assert.truthy(out:find("0 edits in force, kept in hook.edits.lua", 1, true), out)
    assert.is_nil(out:find "traceback")
    -- Killed in the midst of writing an edit: what is whole is replayed.
    local kept = check.read(folder .. "/hook.edits.lua")
    check.write(folder .. "/hook.edits.lua", kept .. 'assert(session:bone("arm"):scale{1, 1.1, 1.1})\nassert(sess')
    local _, second = start(folder)
    out = stop(folder, second, "KILL")
    assert.truthy(out:find("1 edits replayed", 1, true), out)
    assert.truthy(out:find("cut off in the middle", 1, true))
    local session = assert(bw.edit.load(folder .. "/hook.edits.lua"))
    assert.equal(1, #session.edits)
    -- A file of edits is served as well; --fresh begins without.
    os.execute(("cp '%s/hook.edits.lua' '%s/hook2.lua'"):format(folder, folder))
    local _, third = start(folder, "--no-open --fresh")
    out = stop(folder, third, "INT")
    assert.truthy(out:find("0 edits in force", 1, true), out)
    assert.truthy(check.read(folder .. "/hook.edits.lua~"):find("scale{1, 1.1, 1.1}", 1, true))
  end)
end)

describe("the browser", function()
  it("is opened through a file in a folder that only its user can look into", function()
    if not has_page then return pending "the page is not bundled" end
    local folder = check.folder()
    check.write(folder .. "/hook.lua", check.read(session_file))
    -- In place of the desktop's program: notes the mode of the folder of the file it is given,
    -- which nobody else can enter, then what is in the file.
    check.write(folder .. "/xdg-open",
      '#!/bin/sh\nprintf "%s\\n" "$1" >argument; { stat -c %a "${1%/*}"; cat "$1"; } >part; mv part seen\n')
    os.execute(("chmod +x '%s/xdg-open'"):format(folder))
    local address, pid = start(folder, "", 'DISPLAY=:0 PATH="$PWD:$PATH"')
    os.execute(("cd '%s'; for i in $(seq 1200); do [ -e seen ] && break; sleep 0.05; done"):format(folder))
    local mode, page = check.read(folder .. "/seen"):match "^(%d+)\n(.*)$"
    assert.equal("700", mode)
    assert.truthy(page:find(address, 1, true))
    local argument = check.read(folder .. "/argument")
    assert.is_nil(argument:find(address:match "%x+/$", 1, true)) -- arguments can be read by others
    stop(folder, pid, "INT")
    assert.is_nil(io.open((argument:gsub("\n", "")))) -- removed at the end
  end)
end)

describe("docs/live.md", function()
  it("names tests that there are", function()
    local specs = check.read(check.root .. "/tests/lua/test_live.c")
    local promises = check.read(check.root .. "/docs/live.md"):match "## Who can reach it\n(.-)\n## "
    local count = 0
    for name in promises:gmatch "`(test_[%w_]+)`" do
      assert.truthy(specs:find("check_test(" .. name .. ")", 1, true), name)
      count = count + 1
    end
    assert.is_true(count >= 10)
  end)
end)

describe("what barwright live is given", function()
  local part_file = [[
    local bw = require "barwright"
    local mesh = bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.01, 0.01}, cells = {10, 2, 2}, order = 2}
    local part = bw.model {mesh = mesh, material = bw.material.pla}
    part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 0.1), force = {0, 0, -1}}
    return part, {skeleton = bw.skeleton.create {joints = {a = {0, 0.005, 0.005}, b = {0.05, 0.005, 0.005},
      c = {0.1, 0.005, 0.005}}, root = "a", bones = {{"a", "b", name = "one"}, {"b", "c", name = "two"}}}}
  ]]

  it("may be a part with options, and saved edits, kept where asked", function()
    if not has_page then return pending "the page is not bundled" end
    local folder = check.folder()
    os.execute("mkdir " .. folder .. "/kept")
    check.write(folder .. "/hook.lua", part_file)
    local _, pid = start(folder, "--no-open --save kept/mine.lua")
    local out = stop(folder, pid, "INT")
    assert.truthy(out:find("kept in kept/mine.lua", 1, true), out)
    local file = assert(io.open(folder .. "/kept/mine.lua", "ab"))
    file:write('assert(session:bone("two"):scale{1, 1.5, 1.5})\n')
    file:close()
    -- From another folder: the file of edits finds its part.
    local session = assert(bw.edit.load(folder .. "/kept/mine.lua"))
    assert.equal(1, #session.edits)
    -- The file of edits itself, which grows further.
    os.execute(("mv '%s/hook.lua' '%s/part.lua' && sed 's/hook/part/' '%s/kept/mine.lua' >'%s/hook.lua'")
      :format(folder, folder, folder, folder))
    _, pid = start(folder)
    out = stop(folder, pid, "INT")
    assert.truthy(out:find("1 edits in force, kept in hook.lua", 1, true), out)
    assert.equal(1, #assert(bw.edit.load(folder .. "/hook.lua")).edits)
  end)
end)

describe("the live server", function()
  it("takes its arguments apart and closes like any object", function()
    check.raises("did you mean 'port'", core.live_server, {prot = 1})
    check.raises("a port from 0 to 65535", core.live_server, {port = 70000})
    local server = assert(core.live_server {})
    assert.truthy(server.address:find(server.token, 1, true))
    assert.equal(32, #server.token)
    assert.equal(0, server.client_count)
    assert.is_nil(server:receive(0.01))
    assert.is_false(server:send(1, "x", {replace = "state"}))
    check.raises("plain text", server.serve, server, "a\r\nb", "text/plain", "")
    check.raises("plain text", server.serve, server, "a", "text/plain", "", 'x"y')
    check.raises("a key of fewer bytes", server.send, server, 1, "x", {replace = ("k"):rep(30)})
    check.fails("io", "is the port taken", core.live_server {port = server.port})
    server:close()
    check.raises("closed", function() return server:receive(0) end)
    do
      local another <close> = assert(core.live_server {})
      assert.truthy(tostring(another):find "live server at")
    end
  end)
end)
