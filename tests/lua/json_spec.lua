-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
local bw = require "barwright"
local check = require "check"
local json = bw.json

describe("JSON", function()
  it("is written the same way every time", function()
    assert.equal('{"a":[1,2.5,"x"],"b":{"c":true},"n":null}',
      json.encode {b = {c = true}, a = {1, 2.5, "x"}, n = json.null})
    assert.equal("{}", json.encode {})
    assert.equal("[]", json.encode(json.list()))
    assert.equal('{\n  "a": [1, 2],\n  "b": [\n    {\n      "c": 1\n    }\n  ]\n}',
      json.encode({a = {1, 2}, b = {{c = 1}}}, "  "))
    assert.equal("[1,2]", json.encode(bw.array {1, 2}):gsub("%.0", ""))
  end)

  it("writes numbers so that they read back the same", function()
    for _, x in ipairs {0.1, 1 / 3, 1e300, 5e-324, -0.0, 2 ^ 53, 123456789, 1e21, math.pi} do
      local back = json.decode(json.encode(x))
      assert.equal(x, back)
    end
    assert.equal("0.1", json.encode(0.1))
    assert.equal("9007199254740993", json.encode(9007199254740993))
    assert.equal(9007199254740993, json.decode "9007199254740993")
    assert.equal("[null,null,null]", json.encode {0 / 0, math.huge, -math.huge})
  end)

  it("escapes text", function()
    local text = 'a"b\\c\n\t\1\127ü'
    assert.equal('"a\\"b\\\\c\\n\\t\\u0001\\u007fü"', json.encode(text))
    assert.equal(text, json.decode(json.encode(text)))
    assert.equal("€\u{1F600}/", json.decode [["\u20ac\ud83d\ude00\/"]])
  end)

  it("refuses what it cannot write", function()
    local loop = {}
    loop[1] = loop
    check.raises("contains itself", json.encode, loop)
    check.raises("type function", json.encode, {print})
    check.raises("key of type number", json.encode, {[2] = 1})
  end)

  it("names line and byte of what it cannot read", function()
    for text, place in pairs {
      ['{"a": 1,\n "b" 2}'] = "line 2, byte 15: ':' expected, got '2'",
      ["[1, 2"] = "byte 6: ',' or ']' expected, got the end",
      ["[1] 2"] = "byte 5: the end expected, got '2'",
      ['"abc'] = 'the closing " expected, got the end',
      ['"abc\n"'] = 'byte 5: the closing " expected, got byte 0x0A',
      ['"\\x"'] = "an escape such as \\n expected, got 'x'",
      ["01"] = "a value expected, got '0'",
      ["nil"] = "a value expected, got 'n'",
      ["[é]"] = "a value expected, got 'é'",
      ["[\xA9]"] = "a value expected, got byte 0xA9",
      [""] = "byte 1: a value expected, got the end",
      ['["\\ud800x"]'] = "the second half of a pair expected, got 'x'",
      [("["):rep(1000)] = "less nesting expected, got '['",
    } do
      local value, message = json.decode(text)
      assert.is_nil(value)
      assert.truthy(message:find(place, 1, true), message)
    end
  end)
end)

describe("a folder of results", function()
  it("holds result and manifest", function()
    local folder = check.folder()
    check.write(folder .. "/input.txt", "abc")
    local results = assert(bw.results.open(folder .. "/deep/er", {script = "s.lua",
      inputs = {folder .. "/input.txt"}, options = {modes = 3}, seed = 7}))
    assert(results:write {max_principal_pa = 5.83e6})
    local result = assert(json.decode(check.read(results:path "result.json")))
    assert.equal(5.83e6, result.max_principal_pa)
    local manifest = assert(json.decode(check.read(results:path "manifest.json")))
    assert.equal("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
      manifest.inputs[1].sha256)
    assert.equal(7, manifest.seed)
    assert.equal(3, manifest.options.modes)
    assert.equal(bw.version(), manifest.version)
    assert.equal(bw.threads(), manifest.threads)
    assert.truthy(#manifest.libraries > 3)
    assert.truthy(manifest.machine.memory_bytes > 1e8)
  end)

  it("names the pieces of a .pvtu as inputs", function()
    local folder = check.folder()
    local mesh = assert(bw.mesh.box {max = {1, 1, 1}, cells = {2, 2, 2}})
    assert(mesh:write(folder .. "/a&b.pvtu"))
    local function digests()
      local results = assert(bw.results.open(folder .. "/out", {inputs = {folder .. "/a&b.pvtu"}}))
      return results.manifest.inputs
    end
    local first = digests()
    assert.equal(2, #first)
    assert.equal(folder .. "/a&b_0.vtu", first[2].file)
    check.write(first[2].file, check.read(first[2].file) .. "\n")
    local second = digests()
    assert.equal(first[1].sha256, second[1].sha256)
    assert.not_equal(first[2].sha256, second[2].sha256)
    os.remove(first[2].file)
    check.fails("io", "a&b_0.vtu", bw.results.open(folder .. "/out", {inputs = {folder .. "/a&b.pvtu"}}))
    -- A name with the other quotation mark, and a file that names itself.
    check.write(folder .. "/o'clock.pvtu", [[<Piece Source="o'clock.pvtu"/>]])
    local own = assert(bw.results.open(folder .. "/out", {inputs = {folder .. "/o'clock.pvtu"}})).manifest.inputs
    assert.equal(2, #own)
    assert.equal(folder .. "/o'clock.pvtu", own[2].file)
  end)

  it("is refused where it cannot be made or an input is missing", function()
    local folder = check.folder()
    check.write(folder .. "/file", "")
    check.fails("io", "cannot be made as a folder", bw.results.open(folder .. "/file/x"))
    check.fails("io", "missing.stl", bw.results.open(folder, {inputs = {folder .. "/missing.stl"}}))
  end)

  it("replaces files whole", function()
    local core = require "barwright.core"
    local path = check.folder() .. "/x.json"
    assert(core.write_file(path, "one"))
    assert(core.write_file(path, "two"))
    assert.equal("two", check.read(path))
    check.fails("io", "no/such", core.write_file(check.folder() .. "/no/such/x", "a"))
  end)
end)
