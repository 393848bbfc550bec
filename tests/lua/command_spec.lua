-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Commands: how their words are read, what help is made, what each answers, with which exit code.
local bw = require "barwright"
local check = require "check"
local commands = require "barwright.command"
local arguments = require "barwright.command.arguments"
local help_text = require "barwright.command.help_text"
local quantity = require "barwright.command.quantity"

local sample = {
  summary = "a sample",
  arguments = {{name = "model", type = "file", what = "the model"},
    {name = "rest", many = true, optional = true, what = "more"}},
  options = {
    {name = "force", value = "N", type = "number", unit = "N", default = 20, above = 0, what = "total"},
    {name = "count", value = "N", type = "integer", least = 1, most = 9, what = "how many"},
    {name = "kind", value = "KIND", one_of = {"stress", "energy"}, default = "stress", what = "which"},
    {name = "hold", value = "PLACE", many = true, what = "where"},
    {name = "no-open", type = "flag", what = "not"},
  },
  run = function() end,
}

local function refused(text, ...)
  local wish, message = arguments.parse(sample, {...})
  assert.is_nil(wish)
  assert.truthy(message:find(text, 1, true), message)
end

describe("a number on the command line", function()
  it("may have a unit where the option names one", function()
    for text, expected in pairs {["20"] = 20, ["2e5"] = 2e5, ["0.2MPa"] = 2e5, ["200 kPa"] = 2e5, [".5GPa"] = 5e8,
      ["+3Pa"] = 3, ["-1e-3bar"] = -100} do
      check.near(expected, assert(quantity.read(text, "Pa")), 1e-15)
    end
    assert.equal(0.03, quantity.read("30mm", "m")) -- the nearest number, not a product's rounding
    assert.equal(2 * 1024 ^ 3, quantity.read("2G", "bytes"))
    assert.equal(300, quantity.read("5min", "s"))
    assert.equal(1e-3, quantity.read "1e-3")
  end)

  it("is nothing else", function()
    for _, text in ipairs {"", "x", "0x10", "nan", "inf", "1e999", "1,5", "--", "5 5", "5mm", "e5", ".", "5Pas"} do
      local value, expected = quantity.read(text, "Pa")
      assert.is_nil(value, text)
      assert.equal("string", type(expected))
    end
    local _, expected = quantity.read("5 mm", "N")
    assert.truthy(expected:find("mN, N, lbf, kgf, kN, MN", 1, true), expected)
    _, expected = quantity.read "5mm"
    assert.equal("a number without a unit", expected)
  end)
end)

describe("the words behind a command", function()
  it("become a wish", function()
    local wish = assert(arguments.parse(sample, {"a.stl"}))
    assert.same({model = "a.stl", rest = {}, force = 20, kind = "stress", hold = {}, no_open = false, json = false,
      quiet = false, help = false}, wish)
    wish = assert(arguments.parse(sample, {"--force=1kN", "a.stl", "--count", "3", "--hold", "x:0", "b", "--hold=y",
      "--no-open", "--json", "--", "--kind"}))
    assert.equal(1000, wish.force)
    assert.equal(3, wish.count)
    assert.same({"x:0", "y"}, wish.hold)
    assert.same({"b", "--kind"}, wish.rest)
    assert.is_true(wish.no_open)
    assert.is_true(wish.json)
    assert.equal("-", arguments.parse(sample, {"-"}).model)
    assert.equal("-5", arguments.parse(sample, {"a", "--hold", "-5"}).hold[1]) -- a value, whatever it looks like
    assert.is_true(arguments.parse(sample, {"--help", "--nonsense"}).help)
    assert.is_true(arguments.parse(sample, {"-h"}).help)
  end)

  it("are refused with a sentence", function()
    refused "MODEL is missing"
    refused("unknown option --forse: did you mean --force?", "a", "--forse", "3")
    refused("unknown option -x", "a", "-x")
    refused("option --force: a value is missing (N)", "a", "--force")
    refused("option --force: a value is missing (N)", "a", "--force", "--json")
    refused("option --force: a value is missing (N)", "a", "--force", "--count=3")
    refused("option --force is given twice", "a", "--force", "3", "--force=3")
    refused("option --force: a number of N above 0 expected, got '-3'", "a", "--force", "-3")
    refused("option --force: a number of N above 0 expected, got 'x'", "a", "--force", "x")
    refused("option --count: a whole number from 1 up to 9 expected, got '2.5'", "a", "--count", "2.5")
    refused("option --count: a whole number from 1 up to 9 expected, got '10'", "a", "--count", "10")
    refused("option --kind: one of stress, energy expected, got 'stres'", "a", "--kind", "stres")
    refused("option --kind: a value expected, got an empty one", "a", "--kind=")
    refused("option --no-open takes no value", "a", "--no-open=yes")
    local one = {summary = "one", arguments = {{name = "model", what = "it"}}, run = print}
    local _, message = arguments.parse(one, {"a", "b"})
    assert.equal("'b' is one argument too many", message)
    _, message = arguments.parse({summary = "none", run = print}, {"a"})
    assert.equal("no argument expected, got 'a'", message)
  end)

  it("and the help come from the same table", function()
    local text = help_text.of("sample", sample)
    assert.truthy(text:find("usage: barwright sample MODEL [REST ...] [options]", 1, true))
    assert.truthy(text:find("--force N     total (default 20 N)", 1, true), text)
    assert.truthy(text:find("(stress, energy; default stress)", 1, true), text)
    for line in text:gmatch "[^\n]+" do assert.truthy(utf8.len(line) <= 80, line) end
  end)
end)

describe("every command", function()
  for _, name in ipairs(commands.names()) do
    it(name .. " is sound data and tells how it is used", function()
      local command = commands.load(name)
      assert.is_nil(arguments.fault(command))
      local status, out, err = check.run(name .. " --help")
      assert.equal(0, status)
      assert.equal("", err)
      assert.truthy(out:find("usage: barwright " .. name, 1, true))
      status, _, err = check.run(name .. " --no-such-option")
      assert.equal(2, status)
      assert.truthy(err:find("unknown option --no-such-option: did you mean", 1, true), err)
      assert.equal(1, select(2, err:gsub("\n", "")), err)
      local text
      status, text = check.run(name .. " --json --no-such-option")
      assert.equal(2, status)
      local object = assert(bw.json.decode(text))
      assert.equal(name, object.command)
      assert.equal(2, object.exit_code)
      assert.truthy(object.error.message:find "unknown option")
    end)
  end

  it("is listed, and nothing else is one", function()
    local status, out = check.run "--help"
    assert.equal(0, status)
    for _, name in ipairs(commands.names()) do assert.truthy(out:find("\n  " .. name .. " ", 1, true), name) end
    local _, again = check.run "help"
    assert.equal(out, again)
    local err
    status, _, err = check.run "lvie x.lua"
    assert.equal(2, status)
    assert.truthy(err:find("did you mean 'barwright live'", 1, true), err)
    for _, name in ipairs {"init", "arguments", "output", "help_text", "quantity"} do
      assert.is_false(commands.known(name))
    end
  end)

  it("gives way to a file that is named with its folder", function()
    local folder = check.folder()
    check.write(folder .. "/help", "print 'a script'")
    local status, out = check.run(folder .. "/help")
    assert.equal(0, status)
    assert.equal("a script\n", out)
  end)
end)
