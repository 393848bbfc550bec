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
    ["factors above 0"] = function() session:bone("upper"):scale {0, 1, 1} end,
    ["an axis expected, got {0, 0, 0}"] = function()
      session:bone("upper"):rotate {axis = {0, 0, 0}, degrees = 1} end,
    ["cannot be changed by assignment"] = function() session:bone("upper").length = 2 end,
    ["translation: three finite"] = function() session:bone("upper"):set {translation = {1}} end,
    ["no joint or bone 'd'"] = function() session:reach("d", {0, 0, 0}) end,
    ["no bone 'd'"] = function() session:reach {{bone = "d", at = {0, 0, 0}}} end,
    ["twist"] = function() session:limit("b", {twist = {1}}) end,
    ["expected, got string 'first'"] = function() session:assign({"first"}, "upper") end,
    ["elements from 1 to"] = function() session:assign({0}, "upper") end,
    ["option 'von_mises' is missing"] = function() session:optimise {} end,
    ["no bone 'e'"] = function() session:optimise {von_mises = 1, bones = {"e"}} end,
    ["a solver of bw.solver, or \"auto\""] = function() session:solve {solver = "fresh"} end,
    ["save: the path"] = function() session:save() end,
    ["moved: part: a model expected, got table"] = function() session:moved {1} end,
    ["undo: a session expected, got nil"] = function() session.undo() end,
    ["bone: name: a string or a whole number expected"] = function() session:bone {} end,
    ["write: option 'fields'"] = function() session:write("x.vtu", {fields = 5}) end,
    ["edit.begin: script: a string expected"] = function() bw.edit.begin(5) end,
    ["picture: options: a table of options expected"] = function() solved:picture("x.png", 5) end,
    ["picture: option 'field': an array expected"] = function() solved:picture("x.png", {field = part}) end,
    ["reaction_on: selection: a selection expected"] = function() solved:reaction_on(5) end,
    ["picture: option 'values': an array expected"] = function() part.mesh:picture("x.png", {values = part}) end,
    ["scale: factor: a number expected"] = function() part.mesh:scale "big" end,
    ["results.open: folder: a string expected"] = function() bw.results.open(5) end,
    ["results.open: unknown option 'sed': did you mean 'seed'"] = function() bw.results.open("x", {sed = 1}) end,
    ["costs 1: numbers expected, got string 'x' at 2"] = function() bw.study.hypervolume({{1, "x"}}, {2,
      2}) end,
    ["hypervolume: reference"] = function() bw.study.hypervolume({}, {}) end,
    ["json.list: a table whose metatable is not protected"] = function()
      bw.json.list(setmetatable({}, {__metatable = 5})) end,
    ["json.list: a table expected"] = function() bw.json.list "x" end,
    ["json.encode: indent: a string expected"] = function() bw.json.encode({}, 2) end,
    ["more than 200 deep"] = function() local t = {} for _ = 1, 1000 do t = {t} end bw.json.encode(t) end,
    ["live: served: "] = function() bw.live(5) end,
    ["edit.load: path: a string expected, got 5"] = function() bw.edit.load(5) end,
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
      bw.subdomains(part.mesh, session.skeleton, bw.array.zeros(part.mesh.node_count, 2)) end,
  }
end

describe("an error of misuse", function()
  it("names the line of the script", function()
    for text, call in pairs(calls(session_of())) do
      local about = debug.getinfo(call, "S")
      local ok, message = pcall(call)
      assert.message(text).is_false(ok)
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

-- What each raises, on objects of classes that are written in Lua.
describe("a method written in Lua", function()
  it("says which argument is wrong", function()
    local part = bw.model {mesh = check.beam({4, 1, 1}), material = bw.material.pla}
    local worst = assert(bw.worst_case(part, {force = 1, pressure = 1e6, modes = 1, regions = 1}))
    local brute = assert(bw.brute_force(part, {force = 1, pressure = 1e6, elements = 2}))
    local drops = assert(bw.drop_test(part, {drops = 2}))
    local flow = assert(bw.responsive.flow {outline = bw.outline.rectangle {width = 2, height = 1}, viscosity = 1,
      elements = 20, step = 0.1})
    local study = bw.study {name = "x", file = check.folder() .. "/x.study", variables = {{name = "a",
      min = 0, max = 1}}, measures = {"m"},
      design = {"random", count = 1}, run = print}
    local trials = require("barwright.study.trials").new(study)
    local figure = bw.plot.lines {series = {{name = "a", y = {1, 2}}}}
    for text, call in pairs {
      ["percentile: p: a number expected, got function"] = function() brute:percentile(print) end,
      ["compare: worst: a worst case expected, got brute_force"] = function() brute:compare(brute) end,
      ["correlation: other: a worst case or a brute force or an array"] = function() drops:correlation {} end,
      ["picture: options: a table of options expected"] = function() drops:picture("x.png", 5) end,
      ["write: path: a string expected, got nil"] = function() worst:write() end,
      ["pressure_drop: from: two finite numbers {x, y} expected"] = function() flow:pressure_drop() end,
      ["record: name: a string expected"] = function() flow:record(0 / 0) end,
      ["coefficients: option 'stream': two finite numbers"] = function()
        flow:coefficients("boundary", {velocity = 1, length = 1, stream = {"x"}}) end,
      ["outline.polygon: option 'points': a table with a length"] = function()
        bw.outline.polygon(setmetatable({{0, 0}, {1, 0}, {1, 1}}, {__len = function() return "3" end})) end,
      ["steady: option 'material': a table with a length"] = function()
        bw.responsive.steady {outline = bw.outline.circle {centre = {0, 0}, radius = 0.1},
          material = setmetatable({bw.material.pla}, {__len = function() return "3" end})} end,
      ["rounded: point 2"] = function() bw.outline.rounded {points = {{0, 0}, nil, {1, 1}}, radius = 0.1} end,
      ["at: a flow expected, got 1: call it with a colon, as in flow:at(...)"] = function() flow.at(1,
        2) end,
      ["use_file: path: a string expected"] = function() study:use_file(setmetatable({}, {__index = print})) end,
      ["study:run: option 'executor': {capacity, start, wait, close}, or a function"] = function()
        study:run {executor = {}}
      end,
      ["study:merge: file 1: a path expected"] = function() study:merge {{}} end,
      ["column: options: a table of options expected"] = function() trials:column("m", 5) end,
      ["where: which: a string or a function expected"] = function() trials:where(5) end,
      ["place: x: a number expected"] = function() figure:place "x" end,
    } do check.raises(text, call) end
    worst:close()
    check.raises("pressure: this worst case is closed", worst.pressure, worst)
    check.raises("surface_weakness: this worst case is closed", worst.surface_weakness, worst)
  end)
end)

-- Functions of all modules, each with a value of a wrong type.
describe("a message about a wrong type", function()
  it("says what was expected and what was found", function()
    local mesh = check.beam({4, 1, 1})
    local part = bw.model {mesh = mesh, material = bw.material.pla}
    for _, call in ipairs {
      {bw.array, print}, {bw.surface.read, print}, {bw.mesh.fill, print}, {bw.material.isotropic, print},
      {part.fix, part, print}, {mesh.boundary.below, mesh.boundary, "x", print}, {part.solve, part, print},
      {bw.worst_case, part, print}, {bw.breaking_force, mesh, print}, {bw.strengthen, print},
      {bw.skeleton.create, print}, {bw.edit, print}, {bw.outline.polygon, print}, {bw.responsive.flow, print},
      {bw.shapes.sphere, print}, {bw.study, print}, {bw.study.salvage, "a.study", print}, {bw.plot.lines, print},
      {bw.canvas, print}, {bw.json.decode, print}, {bw.results.open, print}, {bw.live, print},
    } do
      local raised, message = pcall(table.unpack(call))
      assert.is_false(raised)
      assert.message(message).truthy(message:find "expected, got .*function$")
    end
  end)
end)
