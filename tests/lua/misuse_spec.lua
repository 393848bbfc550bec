-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Errors of misuse name the line of the script that called, whatever of the library, in Lua or in C,
-- found it out.
local bw = require "barwright"
local check = require "check"

local here = debug.getinfo(1, "S").short_src

local function session_of()
  local mesh = check.beam({8, 2, 2}, 1)
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  part:fix(mesh.boundary:below(1, 0)):gravity {0, 0, -9.81}
  local skeleton = bw.skeleton.create {joints = {a = {0, 0.05, 0.05}, b = {0.5, 0.05, 0.05},
    c = {1, 0.05, 0.05}}, bones = {{"a", "b", name = "upper"}, {"b", "c", name = "lower"}}, root = "a"}
  return assert(bw.edit(part, {skeleton = skeleton})), part
end

-- Each stands on one line, which its error has to name.
local function calls(session, part)
  local solved = assert(session:solve())
  return {
    ["with a colon"] = function() session.solve(5) end,
    ["no 'slove': did you mean 'solve'"] = function() return session.slove end,
    ["'edti'"] = function() return bw.edti end,
    ["part: a model expected"] = function() bw.edit(5) end,
    ["'heat': a number expected"] = function() bw.edit(part, {heat = "much"}) end,
    ["unknown option 'haet'"] = function() bw.edit(part, {haet = 2}) end,
    ["no bone 'loer'"] = function() session:bone("loer") end, -- found out by C, called by Lua
    ["no bone 'uper'"] = function() session:pose {uper = {scale = 1}} end,
    ["greater than 0"] = function() session:bone("upper"):scale {0, 1, 1} end,
    ["an axis of some length"] = function() session:bone("upper"):rotate {axis = {0, 0, 0}, degrees = 1} end,
    ["cannot be changed by assignment"] = function() session:bone("upper").length = 2 end,
    ["translation: three finite"] = function() session:bone("upper"):set {translation = {1}} end,
    ["no joint or bone 'd'"] = function() session:reach("d", {0, 0, 0}) end,
    ["no bone 'd'"] = function() session:reach {{bone = "d", at = {0, 0, 0}}} end,
    ["twist"] = function() session:limit("b", {twist = {1}}) end,
    ["expected, got first"] = function() session:assign({"first"}, "upper") end,
    ["elements from 1 to"] = function() session:assign({0}, "upper") end,
    ["option 'von_mises': is missing"] = function() session:optimise {} end,
    ["no bone 'e'"] = function() session:optimise {von_mises = 1, bones = {"e"}} end,
    ["'fresh' is not known"] = function() session:solve {method = "fresh"} end,
    ["save: the path"] = function() session:save() end,
    ["edit.load: the path"] = function() bw.edit.load(5) end,
    ["report: "] = function() session:report("x.html", {titel = ""}) end,
    ["unknown field 'stress'"] = function() solved:picture("x.png", {field = "stress"}) end,
    ["joint 1: {x, y, z}"] = function() bw.skeleton.create {joints = {1}, bones = {}} end,
    ["no joint 'z'"] = function() bw.skeleton.create {joints = {a = {0, 0, 0}}, bones = {{"a", "z"}}} end,
    ["drop_test: part"] = function() bw.drop_test(5) end,
    ["worst_case: option 'force'"] = function() bw.worst_case(part, {force = -1}) end,
    ["json.decode: a string"] = function() bw.json.decode(5) end,
    ["a table that contains itself"] = function() local t = {} t[1] = t bw.json.encode(t) end,
    ["string expected, got mesh"] = function() bw.surface.read(part.mesh) end, -- C alone
    ["a whole number expected, got string"] = function() bw.array.zeros("many") end,
    ["selection expected"] = function() part:fix(5) end,
    ["the weights of node 1 sum to 0"] = function() -- an engine's refusal
      bw.domains(part.mesh, session.skeleton, bw.array.zeros(part.mesh.node_count, 2)) end,
  }
end

describe("an error of misuse", function()
  it("names the line of the script", function()
    for text, call in pairs(calls(session_of())) do
      local about = debug.getinfo(call, "S")
      local fine, message = pcall(call)
      assert.message(text).is_false(fine)
      assert.message(message).truthy(message:find(text, 1, true))
      local line = message:match("^" .. here:gsub("%p", "%%%0") .. ":(%d+): ")
      assert.message(message).truthy(line)
      line = tonumber(line)
      assert.message(message).is_true(about.linedefined <= line and line <= about.lastlinedefined)
    end
  end)

  it("names that of a function beside the library as well, and none where there is none", function()
    local session = session_of()
    local chunk = assert(load("local session = ...\n\nsession:bone 'c'", "=mine"))
    local _, message = pcall(chunk, session)
    assert.truthy(message:find("^mine:3: "))
    local inside = coroutine.create(session.bone)
    _, message = coroutine.resume(inside, session, "c")
    assert.truthy(message:find("^there is no bone 'c'"))
  end)
end)
