-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Commands: how their words are read, what help is made, what each answers, with which exit code.
local bw = require "barwright"
local check = require "check"
local core = require "barwright.core"
local commands = require "barwright.command"
local arguments = require "barwright.command.arguments"
local help_text = require "barwright.command.help_text"
local lengths = require "barwright.command.lengths"
local made_of = require "barwright.command.made_of"
local model = require "barwright.command.model"
local places = require "barwright.command.places"
local static_picture = require "barwright.command.static_picture"
local prism = require "prism"
local quantity = require "barwright.command.quantity"
local shown = require "barwright.shown"

local sample = {
  summary = "a sample",
  arguments = {{name = "model", type = "file", what = "the model"},
    {name = "rest", many = true, optional = true, what = "more"}},
  options = {
    {name = "force", value = "N", type = "number", unit = "N", default = 20, above = 0, what = "total"},
    {name = "count", value = "N", type = "integer", min = 1, max = 9, what = "how many"},
    {name = "kind", value = "KIND", one_of = {"stress", "energy"}, default = "stress", what = "which"},
    {name = "fix", value = "PLACE", many = true, what = "where"},
    {name = "no-open", type = "flag", what = "not"},
  },
  run = function() end,
}

local function refused(text, ...)
  local opts, message = arguments.parse(sample, {...})
  assert.is_nil(opts)
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

  it("has its unit where it is a length or an area", function()
    for _, option in ipairs {model.contact_option, model.length_option} do
      local units = option.unit == "m2" and "1mm2, 1cm2 or 1m2" or "1mm or 1m"
      local value, message = arguments.value(option, "1")
      assert.is_nil(value)
      assert.equal("'1' has no unit: write " .. units, message)
      assert.truthy(select(2, arguments.value(option, "0")):find "above 0")
      check.near(option.unit == "m2" and 2e-6 or 2e-3, arguments.value(option, "2mm" .. option.unit:sub(2)), 1e-12)
    end
    assert.equal(" (default 1 cm2)", help_text.notes(model.contact_option))
    assert.equal(" (with its unit)", help_text.notes(model.length_option))
    assert.equal("20 N", quantity.text(20, "N"))
    assert.equal("7", quantity.text(7))
    local status, _, fault = check.run "worst part.stl --contact 1"
    assert.equal(2, status)
    assert.truthy(fault:find("option --contact: '1' has no unit", 1, true), fault)
  end)
end)

describe("numbers and words in sentences", function()
  it("are fractions in percent and words that a shell takes", function()
    assert.equal("(4.68, 15.63, 0) mm", core.point {4.68e-3, 15.63e-3, 1.45e-11})
    assert.equal("(1e-05, 0, 0) mm", core.point {1e-8, -0.0, 0})
    assert.same({"0.53 %", "8.2 %", "110 %"}, {shown.error(0.00527), shown.error(0.0823), shown.error(1.1)})
    assert.same({"3.1 cents", "12 cents"}, {shown.cents(3.14), shown.cents(12.4)})
    assert.equal("37.1 %", shown.percent(0.371234))
    assert.same({"3556", "25.83", "0.001234", "-2000000", "0"}, {shown.number(3555.5), shown.number(25.83),
      shown.number(0.001234), shown.number(-2e6), shown.number(-0.0)})
    assert.equal("25.8 N (21.3 to 1310 N)", shown.interval(25.83, 21.34, 1306, "N"))
    assert.equal("123 kN (99 to 2000 kN)", shown.interval(123400, 99e3, 2e6, "N"))
    assert.equal("(0, 0, -10) N", shown.vector({-0.0, 0, -10}, "N"))
    assert.equal("45 x 64.94 x 13 mm", shown.size {0.045, 0.06494, 0.013})
    local pla = {default = bw.material.pla, named = {}}
    assert.equal("pla", made_of.text(pla, {}))
    assert.equal("pla with the given strength and density", made_of.text(pla, {strength = 1e6, density = 1000}))
    for verdict, pair in pairs {holds = {0.5, 0.9}, breaks = {4, 0.5}, unsure = {0.5, 1.1}} do
      assert.equal(verdict, (model.verdict(table.unpack(pair))))
    end
    assert.equal("unsure", (model.verdict(1e-3, 1))) -- an error as large as the value decides nothing
    assert.equal("unsure", (model.verdict(0.9, 0.2)))
    assert.equal("unsure", (model.verdict(nil, 0.2)))
    assert.equal("parts/hook-2.stl", model.shell "parts/hook-2.stl")
    assert.equal("'2 mm'", model.shell "2 mm")
    assert.equal("'it'\\''s.stl'", model.shell "it's.stl")
  end)
end)

describe("a place on the command line", function()
  local box = {min = {0, 0, 0}, max = {0.1, 0.1, 0.1}}

  it("has one unit for the point before it, and means what it says", function()
    for text, points in pairs {
      ["near:49,-2,20mm:8mm"] = {{0.049, -0.002, 0.02}, {0.049, 0.005, 0.02}},
      ["near:4.9,-2mm,2cm:8mm"] = {{0.049, -0.002, 0.02}},
      ["near:0,0,0:1mm"] = {{0, 0, 0.0009}},
      ["below:z:1mm"] = {{0.5, 0.5, 0.001}},
      ["below:x:0"] = {{0, 1, 1}},
      ["above:y:0.05m"] = {{0, 0.05, 0}},
      ["min:z"] = {{9, 9, 0.0019}},
    } do
      local inside = assert(places.test({text}, {box = box}))
      for _, p in ipairs(points) do assert.is_true(inside(table.unpack(p)), text) end
      assert.is_false(inside(0.03, 0.03, 0.03), text)
    end
    assert.same({0, 0, -1e4}, places.vector("0,0,-10kN", "N"))
    assert.same({1e3, 2, 3e3}, places.vector("1,2N,3kN", "N"))
    assert.same({1, 2, 3}, places.vector("1,2,3", "N"))
  end)

  it("is refused where a length has no unit", function()
    for text, what in pairs {
      ["below:z:1"] = "'below:z:1': '1' has no unit: write 1mm or 1m",
      ["near:49,-2,20:8mm"] = "'49,-2,20' has no unit: write 49,-2,20mm or 49,-2,20m",
      ["near:49mm,-2,20:8mm"] = "has no unit",
      ["near:1,0,0:8mm"] = "has no unit",
      ["near:49,-2,20mm:8"] = "'8' has no unit: write 8mm or 8m",
      ["above:x:-0.2e1"] = "'-0.2e1' has no unit",
      ["below:z:1kg"] = "a number with one of the units",
      ["near:x,0,0:1mm"] = "got 'x'",
    } do
      local ok, message = places.check(text)
      assert.is_nil(ok, text)
      assert.truthy(message:find(what, 1, true), message)
    end
  end)
end)

describe("sentences of the engine", function()
  it("have their lengths in mm, and all else as it was", function()
    for text, expected in pairs {
      ["a support of 2.46e-08 m2"] = "a support of 0.0246 mm2",
      ["the mesh fills the box (-0.002, 0, 1e-05) to (0.25, 0.4, 0.2) m"] =
        "the mesh fills the box (-2, 0, 0.01) to (250, 400, 200) mm",
      ["nothing deforms. Move the load or fix less; coordinates and tolerances are in metres"] =
        "nothing deforms. Move the load or fix less",
      ["an edge length of about 0.00303 m, which moved it by up to 0.00075 m (0.0064 of its size)"] =
        "an edge length of about 3.03 mm, which moved it by up to 0.75 mm (0.0064 of its size)",
      ["at (0, 0.1, -2e-3) m, cells 0.1 x 0.2 x 1e-05 m"] = "at (0, 100, -2) mm, cells 100 x 200 x 0.01 mm",
      ["from 0.1 to 0.2 m along z"] = "from 100 to 200 mm along z",
    } do
      assert.equal(expected, lengths(text))
    end
    for _, text in ipairs {"2e6 Pa m^0.5", "3 m2 and 4 m/s", "write 1mm or 1m", "a number of m", "(2, x) m"} do
      assert.equal(text, lengths(text))
    end
  end)
end)

describe("the words behind a command", function()
  it("become options", function()
    local opts = assert(arguments.parse(sample, {"a.stl"}))
    assert.same({model = "a.stl", rest = {}, force = 20, kind = "stress", fix = {}, no_open = false, json = false,
      quiet = false, help = false, given = {}}, opts)
    opts = assert(arguments.parse(sample, {"--force=1kN", "a.stl", "--count", "3", "--fix", "x:0", "b",
      "--fix=y", "--no-open", "--json", "--", "--kind"}))
    assert.equal(1000, opts.force)
    assert.equal(3, opts.count)
    assert.same({"x:0", "y"}, opts.fix)
    assert.same({"b", "--kind"}, opts.rest)
    assert.is_true(opts.no_open)
    assert.is_true(opts.json)
    assert.same({["--force"] = "1kN", ["--count"] = "3", ["--fix"] = "y", ["--no-open"] = true,
      ["--json"] = true}, opts.given)
    assert.equal("-", arguments.parse(sample, {"-"}).model)
    assert.equal("-5", arguments.parse(sample, {"a", "--fix", "-5"}).fix[1]) -- a value, whatever it looks like
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
    assert.truthy(text:find("--force N    total (default 20 N)", 1, true), text)
    assert.truthy(text:find("(stress, energy; default stress)", 1, true), text)
    for line in text:gmatch "[^\n]+" do assert.truthy(utf8.len(line) <= 80, line) end
  end)
end)

describe("every command", function()
  for _, name in ipairs(commands.names()) do
    it(name .. " is sound data and reports how it is used", function()
      local command = commands.load(name)
      assert.is_nil(arguments.fault(command))
      local status, out, err = check.run(name .. " --help")
      assert.equal(0, status)
      assert.equal("", err)
      assert.truthy(out:find("usage: barwright " .. name, 1, true))
      status, _, err = check.run(name .. " --no-such-option")
      assert.equal(2, status)
      assert.truthy(err:find("unknown option %-%-no%-such%-option: known are %-%-"), err)
      for _, option in ipairs(command.options or {}) do
        assert.truthy(err:find("--" .. option.name, 1, true), option.name)
      end
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
    assert.truthy(err:find("did you mean 'live'?", 1, true), err)
    for _, file in ipairs {"part.STL", "part.pvtu"} do
      status, _, err = check.run(file)
      assert.equal(2, status)
      assert.truthy(err:find(("%s is no script: `barwright check %s`"):format(file, file), 1, true), err)
    end
    for _, name in ipairs {"init", "arguments", "output", "help_text", "quantity"} do
      assert.is_false(commands.known(name))
    end
  end)

  it("is on the page of the command line", function()
    local text = check.read(check.root .. "/docs/command_line.md")
    for _, name in ipairs(commands.names()) do
      assert.truthy(name == "help" or text:find("`barwright " .. name, 1, true), name)
    end
    for _, rule in ipairs(commands.program_options) do
      assert.truthy(text:find((rule.short and "`-" or "`--") .. rule.name, 1, true) or rule.name == "gc-stress",
        rule.name)
    end
  end)

  it("is not run in place of a file that is named with its folder", function()
    local folder = check.folder()
    check.write(folder .. "/help", "print 'a script'")
    local status, out = check.run(folder .. "/help")
    assert.equal(0, status)
    assert.equal("a script\n", out)
  end)
end)

-- ---- what they answer ----------------------------------------------------------------------------------

-- A mesh and its copy behind it along x, which goes into it by a depth.
local function two_of(mesh, depth)
  local nodes, elements = mesh.nodes:totable(), mesh.elements:totable()
  local shift, points, count = mesh.box.max[1] - mesh.box.min[1] - depth, #nodes, #elements
  for i = 1, points do nodes[points + i] = {nodes[i][1] + shift, nodes[i][2], nodes[i][3]} end
  for e = 1, count do
    local copy = {}
    for k, node in ipairs(elements[e]) do copy[k] = node + points end
    elements[count + e] = copy
  end
  return assert(bw.mesh.new {nodes = nodes, elements = elements, order = mesh.order})
end

-- A folder with small models, good and bad.
local function models()
  local folder = check.folder() .. "/"
  local box = assert(bw.surface.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.01}})
  assert(box:write(folder .. "sound.stl"))
  assert(box:write(folder .. "metres.stl", {unit = "m"}))
  local triangles = box.triangles:totable()
  table.remove(triangles)
  assert(bw.surface.new({points = box.points, triangles = triangles}):write(folder .. "open.stl"))
  local thin = assert(bw.surface.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.0005}})
  assert(thin:write(folder .. "thin.stl"))
  check.write(folder .. "cut.stl", check.read(folder .. "sound.stl"):sub(1, 300))
  check.write(folder .. "empty.obj", "")
  check.write(folder .. "flat.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\n"
    .. "vertex 0 9 0\nendloop\nendfacet\nendsolid a\n")
  local beam = check.beam({8, 2, 2})
  assert(beam:write(folder .. "beam.vtu"))
  assert(two_of(beam, 0.003):write(folder .. "pressed.vtu"))
  assert(two_of(beam, 0.5 * (beam.box.max[1] - beam.box.min[1])):write(folder .. "overlapping.vtu"))
  assert(bw.outline.rectangle {width = 0.05, height = 0.02}:write(folder .. "plate.svg"))
  check.write(folder .. "crossed.svg", '<svg xmlns="http://www.w3.org/2000/svg" width="10mm" height="10mm" '
    .. 'viewBox="0 0 10 10"><path d="M 1 1 L 9 9 L 9 1 L 1 9 Z"/></svg>')
  return folder
end

local answer = check.answer

describe("barwright check", function()
  local folder = models()

  it("says of each model whether it is sound", function()
    for name, expected in pairs {["sound.stl"] = 0, ["metres.stl"] = 0, ["open.stl"] = 1, ["thin.stl"] = 0,
      ["cut.stl"] = 3, ["empty.obj"] = 3, ["flat.stl"] = 1, ["beam.vtu"] = 0, ["plate.svg"] = 0,
      ["crossed.svg"] = 3, ["missing.stl"] = 3} do
      local status, object, err = answer("check " .. folder .. name)
      assert.equal(expected, status, name .. ": " .. err)
      assert.equal(expected == 0, object.sound, name)
      if object.error then assert.truthy(object.error.message:find(name, 1, true), object.error.message) end
    end
  end)

  it("tells numbers that are right", function()
    local _, object = answer("check " .. folder .. "sound.stl")
    check.near(0.06 * 0.02 * 0.01, object.volume_m3, 1e-6)
    check.near(2 * (0.06 * 0.02 + 0.06 * 0.01 + 0.02 * 0.01), object.area_m2, 1e-6)
    check.near(0.02, object.thickness_median_m, 0.51) -- between the lesser two sides
    check.near(0.01, object.thickness_1_percent_m, 1e-6)
    assert.is_false(object.unit_doubtful)
    _, object = answer("check " .. folder .. "open.stl")
    assert.equal(3, object.defects.open_edge)
    assert.equal(1, object.holes)
    assert.is_true(object.repairable)
    check.near(0.06 * 0.02 * 0.01, object.repaired_volume_m3, 1e-6)
    _, object = answer("check " .. folder .. "open.stl --repair no")
    assert.is_nil(object.repairable)
    _, object = answer("check " .. folder .. "plate.svg")
    check.near(1e-3, object.area_m2, 1e-9)
  end)

  it("reports bodies that overlap, with place and depth", function()
    local status, object = answer("check " .. folder .. "pressed.vtu")
    assert.equal(0, status)
    assert.equal(1, #object.overlaps)
    check.near(0.003, object.overlaps[1].depth_m, 1e-9)
    status, object = answer("check " .. folder .. "overlapping.vtu")
    assert.equal(1, status)
    local overlap = object.overlaps[1]
    assert.same({1, 2}, overlap.bodies)
    check.near(0.5, overlap.fraction_of_smaller, 1e-9)
    local _, out = check.run("check " .. folder .. "overlapping.vtu")
    assert.truthy(out:find("50 % of the smaller one.\nAnalyses refuse it", 1, true), out)
  end)

  it("of them every command refuses those that overlap by much", function()
    for _, words in ipairs {"statics %s --fix min:x --force max:x=10,0,0", "modes %s", "drop %s",
      "drop %s --drops 2", "buckle %s --fix min:x --force max:x=-1,0,0", "buckle %s --fix min:x --worst 1",
      "respond %s --fix min:x --base 0,0,1g --to 500 --damping 0.02", "worst %s",
      "heat %s --temperature min:x=80C --convection all=10,20C"} do
      local status, object = answer(words:format(folder .. "overlapping.vtu"))
      assert.equal(2, status, words)
      assert.truthy(object.error.message:find("bodies 1 and 2 of the mesh overlap", 1, true), object.error.message)
    end
  end)

  it("guesses a unit where the size is no part's", function()
    local _, object = answer("check " .. folder .. "metres.stl")
    assert.is_true(object.unit_doubtful)
    assert.equal("m", object.unit_suggestions[#object.unit_suggestions])
    local _, out = check.run("check " .. folder .. "metres.stl")
    assert.truthy(out:find("--unit m makes it 60 x 20 x 10 mm", 1, true), out)
    _, object = answer("check " .. folder .. "metres.stl --unit m")
    assert.is_false(object.unit_doubtful)
    check.near(0.06, object.size_m[1], 1e-6)
  end)

  it("takes a least thickness as a condition", function()
    assert.equal(0, (answer("check " .. folder .. "thin.stl --thin 0.4mm")))
    local status, object = answer("check " .. folder .. "thin.stl --thin 0.8mm")
    assert.equal(1, status)
    assert.is_true(object.sound)
    assert.is_false(object.good)
    assert.truthy(object.thin_fraction > 0.9)
  end)

  it("speaks to people, or not at all", function()
    local _, out = check.run("check " .. folder .. "open.stl")
    assert.truthy(out:find("3 open edges: only one facet has this edge", 1, true), out)
    assert.truthy(out:find("Repair corrects it", 1, true), out)
    local status, quiet, err = check.run("check --quiet " .. folder .. "open.stl")
    assert.equal(1, status)
    assert.equal("", quiet .. err)
  end)
end)

describe("commands that compute", function()
  local folder = models()
  local beam = folder .. "beam.vtu"

  it("worst answers, and says by its exit code whether it holds", function()
    local status, object = answer("worst " .. folder .. "sound.stl --elements 600 --modes 3 --regions 1 --out "
      .. folder .. "out")
    assert.equal(0, status)
    assert.equal("holds", object.verdict)
    assert.is_true(object.breaking_force_low_n < object.breaking_force_n)
    assert.is_true(object.breaking_force_n < object.breaking_force_high_n and object.breaking_force_low_n > 20)
    assert.equal(3, #object.at_m)
    assert.equal("mm", object.unit)
    assert.equal("boolean", type(object.singular))
    for _, key in ipairs {"contact_area_m2", "estimated_error", "mass_kg", "elements", "seconds"} do
      assert.is_true(object[key] > 0, key)
    end
    for _, name in ipairs {"weakness.png", "worst_load.png", "worst.vtu", "report.html", "result.json",
      "manifest.json"} do
      assert.truthy(#check.read(folder .. "out/" .. name) > 100, name)
    end
    local kept = assert(bw.json.decode(check.read(folder .. "out/result.json")))
    assert.equal(object.breaking_force_n, kept.breaking_force_n)
    assert.equal("cholesky", object.solver.solver)
    assert.equal("multifrontal", object.solver.backend)
    local _, other = answer("worst " .. folder .. "sound.stl --elements 600 --modes 3 --regions 1 --solver pcg")
    check.near(object.breaking_force_n, other.breaking_force_n, 1e-4)
    assert.equal("pcg", other.solver.solver)
    assert.equal("two_level", other.solver.preconditioner)
    assert.is_true(other.solver.iterations > 5)
    -- The breaking force does not depend on the force that is asked for; the verdict does.
    local words = "worst %ssound.stl --elements 600 --modes 3 --regions 1 --force %.17gN"
    local scaled, stronger = answer(words:format(folder, 2 * object.breaking_force_high_n))
    check.near(object.breaking_force_n, stronger.breaking_force_n, 5e-3) -- rounding decides between tied places
    assert.equal("breaks", stronger.verdict)
    assert.equal(1, scaled)
    local advice = stronger.advice
    assert.is_true(#advice.places > 0)
    assert.is_true(advice.predicted_breaking_force_n > stronger.breaking_force_n)
    assert.is_true(advice.places[1].offset_m > 0 and advice.places[1].radius_m > 0 and #advice.places[1].at_m == 3)
    assert.is_nil(object.advice)
    scaled, stronger = answer(words:format(folder, object.breaking_force_n))
    assert.equal("unsure", stronger.verdict)
    assert.equal(1, scaled)
    local _, out = check.run("worst " .. folder
      .. "sound.stl --elements 600 --modes 3 --regions 1 --force 2MN --strength 10MPa --young 1GPa --report "
      .. folder .. "r.html")
    assert.truthy(out:find("it breaks", 1, true), out)
    assert.truthy(out:find("r.html", 1, true), out)
    -- The page has the answer of the terminal, and the advised command computes the same part.
    local headline = '<p class="headline">Breaks at [%d.]+ N %([%d.]+ to [%d.]+ N%) '
      .. "under the worst load; 2000 kN were asked for%."
    assert.truthy(check.read(folder .. "r.html"):find(headline))
    local advised = "--force 2000000N --young 1GPa --strength 10MPa --elements 600 --modes 3 --regions 1 --out"
    assert.truthy(out:find(advised, 1, true), out)
    -- What cannot be written is reported before anything is computed.
    local code, said, fault = check.run("worst " .. folder .. "sound.stl --report " .. folder
      .. "no/such/folder/r.html")
    assert.equal(3, code)
    assert.falsy(said:find("breaks", 1, true), said)
    assert.truthy(fault:find("no/such/folder/r.html", 1, true), fault)
  end)

  it("worst judges a small part for the force asked, on the contact that it has", function()
    local small = check.folder() .. "/small.vtu"
    assert(assert(bw.mesh.box {min = {0, 0, 0}, max = {6e-3, 1e-3, 0.5e-3}, cells = {18, 3, 2}}):write(small))
    local words = "worst --modes 2 --regions 1 " .. small
    local status, object = answer(words)
    assert.equal(1, status)
    assert.equal("breaks", object.verdict)
    assert.equal(20, object.force_n)
    assert.equal(1e-4, object.contact_area_asked_m2)
    check.near(object.area_m2 / 20, object.contact_area_m2, 1e-9)
    local _, out = check.run(words .. " --force 0.1N")
    assert.truthy(out:find("Under 0.1 N it holds", 1, true), out)
    assert.truthy(out:find("The contact is 0.95 mm2 instead of 1 cm2, a twentieth of the surface.", 1, true),
      out)
  end)

  it("worst says where a soft thin ring is beyond linear theory", function()
    local ring = check.folder() .. "/ring.vtu"
    local grid, moved = assert(bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {24, 1, 1}, order = 2}), {}
    for i, p in ipairs(grid.nodes:totable()) do -- open by a twentieth, of 140 mm, 2 mm thick
      local angle, r = 1.9 * math.pi * p[1], 0.068 + 0.002 * p[2]
      moved[i] = {r * math.sin(angle), r * math.cos(angle), 0.01 * p[3]}
    end
    assert(assert(grid:moved(moved)):write(ring))
    local sentence = "Displacements are beyond the range of linear theory: more than a tenth of the part's "
      .. "length ("
    for young, beyond in pairs {["20MPa"] = true, ["2000GPa"] = false} do
      local status, out = check.run(("worst --young %s --modes 3 --regions 1 %s"):format(young, ring))
      assert.equal(1, status) -- it breaks
      assert.equal(beyond, out:find(sentence, 1, true) ~= nil, out)
    end
  end)

  it("worst refines until the error asked for", function()
    local command, given = commands.load "worst", nil
    local breaking_force, silent = bw.breaking_force, function() end
    local deaf = {say = silent, json = silent, warnings = silent, fail = silent}
    bw.breaking_force = function(_, options) given = options return nil, "enough", {status = "limit"} end
    for _, words in ipairs {{}, {"--error", "0.1"}, {"--error", "0.1", "--elements", "300000"}} do
      command.run(assert(arguments.parse(command, {beam, table.unpack(words)})), deaf)
      assert.equal(tonumber(words[2]), given.error)
      assert.equal(words[4] and 300000 or words[2] and 200000 or nil, given.max_elements)
    end
    bw.breaking_force = breaking_force
    if os.getenv "BARWRIGHT_FULL" ~= "1" then return end
    local path, meshes = check.folder() .. "/angle.stl", {}
    assert(prism({{0, 0}, {0.04, 0}, {0.04, 0.01}, {0.01, 0.01}, {0.01, 0.04}, {0, 0.04}}, {0.005, 0.005}, 0.02)
      :write(path))
    for i, fraction in ipairs {1, 0.1} do
      local _, object = answer(("worst --elements 300 --modes 3 --regions 1 --error %g %s"):format(fraction, path))
      meshes[i] = #object.history
    end
    assert.is_true(meshes[2] > meshes[1])
  end)

  it("statics takes a density in place of the material's", function()
    local words = "statics --material steel --fix min:x --gravity 0,0,-1g " .. beam
    local _, steel = answer(words)
    local _, heavy = answer(words .. " --density 31400")
    check.near(4 * steel.mass_kg, heavy.mass_kg, 1e-9)
    check.near(4 * steel.max_displacement_m, heavy.max_displacement_m, 1e-9)
  end)

  it("strengthen thickens a part, and says by its exit code whether that is enough", function()
    local words = "strengthen --elements 200 --modes 2 --regions 1 --steps 1 --out %sstrong.stl %ssound.stl "
      .. "--force %s"
    local status, object = answer(words:format(folder, folder, "5N"))
    assert.equal(0, status)
    assert.equal("reached", object.verdict)
    assert.equal(0, object.added_mass_kg)
    local box = assert(bw.surface.read(folder .. "strong.stl")).box
    check.near(assert(bw.surface.read(folder .. "sound.stl")).box.max[1], box.max[1], 1e-6)
    if os.getenv "BARWRIGHT_FULL" ~= "1" then return end
    status, object = answer(words:format(folder, folder, "1MN --keep min:z"))
    assert.equal(1, status)
    assert.equal("not reached", object.verdict)
    assert.equal("mm", object.unit)
    assert.is_true(object.after.breaking_force_n > 0.9 * object.before.breaking_force_n)
    assert.is_true(object.added_mass_kg > 0 and #object.steps == 1)
    local strong, given = bw.surface.read(folder .. "strong.stl"), bw.surface.read(folder .. "sound.stl")
    assert.is_true(strong:check().sound)
    assert.is_true(strong.volume > given.volume)
    check.near(given.box.min[3] + 1, strong.box.min[3] + 1, 1e-9) -- kept
  end)

  it("strengthen makes a real part carry 1.5 times the force", function()
    if os.getenv "BARWRIGHT_FULL" ~= "1" then return pending "only with BARWRIGHT_FULL=1" end
    local given = (os.getenv "BARWRIGHT_SHARED" or check.root .. "/../shared") .. "/models/fan_blade.stl"
    local file = io.open(given)
    if not file then return pending "no shared models here" end
    file:close()
    local options = "--unit mm --elements 2500 "
    local _, before = answer(("worst %s '%s'"):format(options, given))
    local force = 1.5 * before.breaking_force_n
    local words = ("strengthen %s --force %.6gN --out %sblade.stl '%s'"):format(options, force, folder, given)
    local status, object, err = answer(words)
    assert.equal(0, status, err)
    assert.equal("reached", object.verdict)
    assert.is_true(object.after.breaking_force_low_n >= 0.999 * force)
    assert.is_true(object.added_fraction < 0.2, object.added_fraction)
    -- The file itself, analysed again and finer.
    local strong = assert(bw.surface.read(folder .. "blade.stl"))
    local report, first = strong:check(), assert(bw.surface.read(given))
    assert.is_true(report.sound)
    assert.equal(first.point_count - first.triangle_count / 2, strong.point_count - strong.triangle_count / 2)
    local _, after = answer(("worst --unit mm --elements 5000 %sblade.stl"):format(folder))
    assert.is_true(after.breaking_force_n > force, after.breaking_force_n)
  end)

  it("worst, statics and modes refuse a size that is implausible until the unit is given", function()
    for words, unit in pairs {["worst --elements 300 --modes 2 --regions 1 %s"] = "um",
      ["statics --elements 300 --fix min:z --gravity 0,0,-1 %s"] = "um", ["modes --elements 300 %s"] = "um"} do
      local status, object, err = answer(words:format(("--unit %s %ssound.stl"):format(unit, folder)))
      assert.truthy(status ~= 2 and status ~= 3, err)
      assert.is_nil(object.error)
    end
    local surface = assert(bw.surface.read(folder .. "sound.stl", {unit = "um"}))
    assert(surface:write(folder .. "tiny.off"))
    -- A mesh of tetrahedra whose numbers are millimetres: they are taken as metres.
    local millimetres = assert(bw.mesh.box {min = {0, 0, 0}, max = {60, 20, 10}, cells = {6, 2, 1}})
    assert(millimetres:write(folder .. "millimetres.msh"))
    for name, question in pairs {["tiny.off"] = "--unit m makes it 60 x 20 x 10 mm",
      ["millimetres.msh"] = "taken as metres, which makes it 60000 x 20000 x 10000 mm: large for a part. "
        .. "--unit mm makes it 60 x 20 x 10 mm"} do
      for _, words in ipairs {"worst ", "statics --fix min:z --gravity 0,0,-1 ", "modes "} do
        local status, _, err = answer(words .. folder .. name)
        assert.truthy(err:find(question, 1, true), err)
        assert.equal(2, status, words)
      end
    end
    local status, object, err = answer("statics --fix min:z --gravity 0,0,-1 --unit mm " .. folder
      .. "millimetres.msh")
    assert.equal(0, status, err)
    assert.equal("mm", object.unit)
  end)

  it("statics warns of volumetric locking, and takes the formulation that cures it", function()
    local words = "statics " .. beam .. " --material steel --poisson 0.499 --fix min:x --force max:x=0,0,-100N "
    local function locking(object)
      return table.concat(object.remarks or {}, " "):find("volumetric locking", 1, true) ~= nil
    end
    local _, standard = answer(words)
    assert.is_true(locking(standard))
    local _, cured = answer(words .. "--formulation b_bar")
    assert.is_false(locking(cured))
    assert.is_true(cured.max_displacement_m > 1.01 * standard.max_displacement_m)
    local status, _, err = answer(words .. "--formulation hybrid")
    assert.equal(2, status)
    assert.truthy(err:find("b_bar", 1, true), err)
  end)

  it("statics counts the facets that stand for a fillet in its error", function()
    -- An angle of arms 10 mm wide with a fillet of 2 mm.
    local function stress(facets)
      local profile = {{0, 0}, {0.04, 0}, {0.04, 0.01}}
      for k = 0, facets do
        local angle = k / facets * math.pi / 2
        profile[#profile + 1] = {0.012 - 0.002 * math.sin(angle), 0.012 - 0.002 * math.cos(angle)}
      end
      profile[#profile + 1], profile[#profile + 2] = {0.01, 0.04}, {0, 0.04}
      local path = folder .. "fillet.stl"
      assert(prism(profile, {0.005, 0.005}, 0.01):write(path))
      local _, object = answer("statics --elements 8000 --fix above:y:40mm --force above:x:40mm=0,-100,0 "
        .. "--material abs " .. path)
      return object
    end
    local coarse, fine = stress(2), stress(16) -- facets of 1.6 and of 0.2 mm
    assert.is_true(math.abs(fine.value - coarse.value) > 0.1 * coarse.value)
    assert.is_true(math.abs(fine.value - coarse.value) < coarse.estimated_error * coarse.value)
    assert.near(0.25, coarse.facet_error, 1e-6) -- 2/pi of 22.5 degrees
    assert.is_true(fine.facet_error < 0.01)
  end)

  it("statics names a singular place, and what says so", function()
    local profile, points, triangles = {{0, 0}, {40, 0}, {40, 10}, {10, 10}, {10, 40}, {0, 40}, {5, 5}}, {}, {}
    for i, p in ipairs(profile) do
      points[2 * i - 1], points[2 * i] = {p[1] * 1e-3, p[2] * 1e-3, 0}, {p[1] * 1e-3, p[2] * 1e-3, 0.01}
    end
    for i = 1, 6 do
      local a, b = 2 * i - 1, 2 * (i % 6) + 1
      for _, t in ipairs {{a, b, b + 1}, {a, b + 1, a + 1}, {13, b, a}, {14, a + 1, b + 1}} do
        triangles[#triangles + 1] = t
      end
    end
    local path = folder .. "angle.stl"
    assert(assert(bw.surface.new {points = points, triangles = triangles}):write(path))
    local _, shape = answer("check --edges yes " .. path)
    assert.equal(1, #shape.singular_edges)
    assert.near(0.01, shape.singular_edges[1].length_m, 1e-6)
    local _, text = check.run("check --edges yes " .. path)
    assert.truthy(text:find("Re-entrant edges without a fillet: 1 singular place", 1, true), text)
    local words = "statics --elements 2000 --fix above:y:40mm --force above:x:40mm=0,-20,0 --material abs "
    local _, object = answer(words .. path)
    assert.is_true(object.singular)
    assert.truthy(object.singular_by:find("geometry", 1, true))
    assert.equal("re-entrant edge", object.singular_place.kind)
    assert.near(1.5 * math.pi, object.singular_place.angle_rad, 1e-5)
    assert.near(0.01, object.singular_place.at_m[1], 1e-6)
    assert.near(0.4555, object.growth_expected, 1e-3)
    assert.is_true(object.effective_stress_pa > 2e6 and object.effective_stress_pa < 4e6)
    assert.near(bw.material.abs.critical_distance, object.critical_distance_m, 1e-12)
    local page = folder .. "singular.html"
    local _, out = check.run(words .. "--error 0.05 --report " .. page .. " " .. path)
    -- The title has the stress that is judged.
    local judged, error = out:match("The judged stress is ([%d.]+ MPa), [%d.]+ %% of the strength of abs "
      .. "%(estimated error ([%d.]+) %%%)")
    assert.truthy(check.read(page):find(("angle.stl: judged mean stress %s ± %s %%"):format(judged, error), 1,
      true), judged)
    assert.truthy(out:find("The largest stress has no finite value: it is at a re-entrant edge of 270 degrees "
      .. "inside the material at (10, 10, ", 1, true), out)
    assert.truthy(out:find("(by geometry and growth; h^-0.4555 expected, ", 1, true), out)
    assert.truthy(out:find("The effective stress of the theory of critical distances, the mean over 4.421 mm", 1,
      true), out)
    _, object = answer("statics --elements 2000 --fix above:y:40mm --force above:x:40mm=0,-20,0 " .. path)
    assert.is_nil(object.effective_stress_pa) -- the toughness of PLA is not known
    _, object = answer("statics --elements 2000 --toughness 3e6 --fix above:y:40mm --force above:x:40mm=0,-20,0 "
      .. path)
    assert.near((3 / 53) ^ 2 / math.pi, object.critical_distance_m, 1e-12)
    local near, far, critical
    local finer = words:gsub("2000", "4000")
    _, near = answer(finer .. "--length 0.2mm --fillet 0.5mm " .. path)
    _, far = answer(finer .. "--length 2mm --fillet 1mm " .. path)
    _, critical = answer(words .. "--length critical " .. path)
    assert.equal(2e-4, near.averaging_radius_m)
    assert.near(bw.material.abs.critical_distance / 2, critical.averaging_radius_m, 1e-12)
    assert.is_true(near.utilisation > 1.05 * far.utilisation)
    assert.near(2 ^ 0.4555, near.fillet_stress_pa / far.fillet_stress_pa, 0.01)
    assert.near(5e-4, near.fillet_radius_m, 1e-12)
    assert.is_true(near.fillet_stress_error >= 0.1)
    assert.near(0.01, near.fillet_at_m[1], 1e-6)
    assert.is_nil(critical.fillet_stress_pa)
    _, out = check.run(finer .. "--fillet 1mm " .. path)
    assert.truthy(out:find("With a fillet of 1 mm the re-entrant edge at (10, 10, ", 1, true), out)
    _, out = check.run("statics --fix min:x --gravity 0,0,-1 --fillet 1mm " .. beam)
    assert.truthy(out:find("The stress of a fillet is not known: there is no re-entrant edge.", 1, true), out)
    _, object = answer("worst --elements 1200 --modes 4 --regions 1 " .. path)
    assert.is_true(object.singular)
    assert.truthy(object.singular_by:find("geometry", 1, true))
    assert.equal("re-entrant edge", object.singular_place.kind)
    _, object = answer(("strengthen --force 1N --elements 300 --modes 2 --regions 1 --out %s.stl %s"):format(path,
      path))
    assert.is_true(object.before.singular)
    _, out = check.run("worst --elements 1200 --modes 4 --regions 1 " .. path)
    assert.truthy(out:find("meshes overestimate it by up to 18 %, which the interval contains", 1, true), out)
    assert.truthy(out:find("The largest stress has no finite value: it is at a re-entrant edge of 270", 1,
      true), out)
  end)

  it("check draws the re-entrant edges, and pictures of statics the one that is named", function()
    local place_of = check.folder()
    local path, drawn, none = place_of .. "/angle.stl", place_of .. "/edges.png", place_of .. "/none.png"
    local angle = prism({{0, 0}, {0.04, 0}, {0.04, 0.01}, {0.01, 0.01}, {0.01, 0.04}, {0, 0.04}}, {0.005, 0.005},
      0.02)
    assert(angle:write(path))
    local status, object = answer("check --edges yes --picture " .. drawn .. " " .. path)
    assert.equal(0, status)
    assert.same({drawn}, object.files)
    assert(angle:picture(none, {title = "angle.stl"}))
    assert.are_not.equal(check.read(none), check.read(drawn))
    local unmarked = place_of .. "/unmarked.png"
    assert.equal(0, (answer("check --picture " .. unmarked .. " " .. path)))
    assert.equal(check.read(none), check.read(unmarked)) -- without --edges yes nothing is marked
    local place = assert(angle:singular_edges())[1]
    local view = model.view_of {place} -- from outside, across the edge
    assert.is_true(view[1] > 0.5 and view[2] > 0.5 and view[3] > 0)
    local behind = {length = 2, inward = {{1, 0, 0}}}
    assert.same({-1, 0, 0.5}, model.view_of {{length = 1.9, inward = {{-1, 0, 0}}}, behind})
    assert.is_nil(model.view_of {})
    local seen = place_of .. "/seen.png"
    assert(angle:picture(seen, {title = "angle.stl", lines = {place.points}, direction = view,
      line_name = "1 re-entrant edge without a fillet"}))
    assert.is_true(check.read(seen) == check.read(drawn))
    local given = model.edge_lines {place = place}
    assert.same({place.points}, given.lines)
    assert.equal("re-entrant edge, 270 degrees inside the material: no finite stress", given.line_name)
    assert.same({}, model.edge_lines(nil))
    assert(angle:picture(none, given))
    check.raises("option 'lines': a list of lists of points", angle.picture, angle, none, {lines = 1})
    check.raises("rows of 3 numbers expected, got 2", angle.picture, angle, none, {lines = {{{1, 2}}}})
  end)

  it("check lists the faces and names them in the picture", function()
    local path, drawn, plain = folder .. "angle.stl", folder .. "faces.png", folder .. "plain.png"
    local angle = prism({{0, 0}, {0.04, 0}, {0.04, 0.01}, {0.01, 0.01}, {0.01, 0.04}, {0, 0.04}}, {0.005, 0.005},
      0.01)
    assert(angle:write(path))
    local status, object = answer("check --faces yes --picture " .. drawn .. " " .. path)
    assert.equal(0, status)
    assert.equal(8, #object.faces)
    assert.equal("plane 1", object.faces[1].name)
    check.near(7e-4, object.faces[1].area_m2, 1e-6)
    assert.same({drawn}, object.files)
    local _, numbers = angle:faces()
    assert.equal(8, numbers:max())
    -- A label inside of the body or behind it is left out, and so is one over another.
    local function picture(labels)
      assert(angle:picture(plain, {title = "angle.stl", direction = {0, 0, 1}, labels = labels}))
      return check.read(plain)
    end
    local none, one = picture(nil), picture {{at = {0.005, 0.005, 0.01}, text = "here"}}
    assert.is_true(none ~= one and none ~= check.read(drawn))
    assert.is_true(none == picture {{at = {0.005, 0.005, 0}, text = "behind"}})
    assert.is_true(one == picture {{at = {0.005, 0.005, 0.01}, text = "here"}, {at = {0.005, 0.006, 0.01},
      text = "over it"}})
    check.raises("label 1: a string 'text' expected, got nil", angle.picture, angle, plain,
      {labels = {{at = {0, 0, 0}}}})
    check.raises("a list of at most 10000", angle.picture, angle, plain, {labels = 1})
    local _, out = check.run("check --faces yes " .. path)
    assert.truthy(out:find("8 faces:\n  plane 1      7 cm2\n", 1, true), out)
  end)

  it("materials prints fracture toughness and critical distance with scatter", function()
    local _, out = check.run "materials"
    assert.truthy(out:find("3 +- 0.4", 1, true), out)
    assert.truthy(out:find("2.21 +- 0.59", 1, true), out)
    local _, object = answer "materials abs"
    local abs = object.materials[1]
    assert.near(0.4e6, abs.toughness_scatter_pa_sqrt_m, 1e-9)
    assert.near(2 * abs.critical_distance_m * 0.4 / 3, abs.critical_distance_scatter_m, 1e-12)
    assert.truthy(abs.sources.toughness.source:find("Dowling", 1, true))
    assert.truthy(tostring(bw.material.abs):find("critical distance 2.21 mm +- 0.59 mm", 1, true))
    _, object = answer "materials pla" -- no published value fits it
    assert.is_nil(object.materials[1].toughness_pa_sqrt_m)
    assert.is_nil(object.materials[1].critical_distance_m)
  end)

  it("worst names and draws the stress that is judged", function()
    local path = check.folder() .. "/plate.vtu"
    local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.008}, cells = {6, 2, 1}, order = 2})
    assert(mesh:write(path))
    local pictures = {}
    for material, name in pairs {steel = "von Mises stress", abs = "largest principal stress"} do
      local page = ("%s.%s.html"):format(path, material)
      pictures[material] = ("%s.%s.png"):format(path, material)
      local status, out = check.run(("worst %s --material %s --modes 2 --regions 1 --report %s --picture %s")
        :format(path, material, page, pictures[material]))
      assert.is_true(status <= 1)
      assert.truthy(out:find(material == "steel" and "judged by von Mises" or "judged by the largest principal", 1,
        true), out)
      assert.truthy(check.read(page):find(name .. " under the load of", 1, true))
    end
    -- The picture of a worst case says the same.
    local given
    local before = core.picture
    core.picture = function(_, _, opts) given = opts return true end -- luacheck: ignore
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    for failure, unit in pairs {von_mises = "von Mises stress under this load, MPa",
      principal = "largest principal stress under this load, MPa"} do
      local worst = assert(bw.worst_case(part, {modes = 2, regions = 1, length = 2e-3, failure = failure}))
      assert(worst:picture("x.png", {region = 1}))
      assert.equal(unit, given.unit)
      local stress = assert(worst:stress(1))
      local values = failure == "von_mises" and core.von_mises(stress) or core.max_principal(stress)
      local _, nodes = mesh:surface()
      assert.equal(mesh:to_nodes(values, "max"):gather(nodes):max(), given.values:max())
    end
    core.picture = before -- luacheck: ignore
  end)

  it("worst averages over half the critical distance where that is asked for", function()
    local path = check.folder() .. "/plate.vtu"
    assert(assert(bw.mesh.box {min = {0, 0, 0}, max = {0.06, 0.02, 0.008}, cells = {6, 2, 1}}):write(path))
    local words = "worst --modes 2 --regions 1 " .. path .. " --length "
    local _, object = answer(words .. "critical --material abs")
    assert.near(0.5 * bw.material.abs.critical_distance, object.averaging_radius_m, 1e-12)
    assert.near(bw.material.abs.critical_distance, object.critical_distance_m, 1e-12)
    _, object = answer(words .. "1.5mm")
    assert.near(1.5e-3, object.averaging_radius_m, 1e-12)
    assert.is_nil(object.critical_distance_m)
    local status
    status, object = answer(words .. "critical")
    assert.equal(2, status)
    assert.truthy(object.error.message:find("the fracture toughness of pla is not known", 1, true))
    assert.truthy(object.error.message:find("give it by --toughness, or take a material that has one (steel, "
      .. "aluminium, abs)", 1, true))
    status, object = answer(words .. "criticl")
    assert.equal(2, status)
    assert.truthy(object.error.message:find("option --length: 'critical' or a number", 1, true))
  end)

  it("statics titles its picture with the number that is judged", function()
    local about = {stress = 30e6, error = 1.05, verdict = "it holds"}
    assert.equal("x: largest von Mises stress 30 MPa ± 105 %; it holds", static_picture.title("x", about))
    about.judged = {used = 0.5, error = 0.2, strength = 40e6}
    assert.equal("x: judged mean stress 20 MPa ± 20 %; it holds", static_picture.title("x", about))
    about.judged.strength = {40e6, 40e6, 20e6}
    assert.equal("x: judged mean stress 50 % of the strength ± 20 %; it holds", static_picture.title("x", about))
    about.judged.used = nil
    assert.equal("x: the largest stress has no finite value", static_picture.title("x", about))
  end)

  it("statics draws loads, supports and the value that it prints", function()
    local mesh = check.beam({8, 2, 2}, 2)
    local border, length = static_picture.border(mesh.boundary:below("x", 0)), 0
    for _, line in ipairs(border) do
      assert.equal(0, line[1][1] + line[2][1])
      length = length + math.abs(line[1][2] - line[2][2]) + math.abs(line[1][3] - line[2][3])
    end
    check.near(0.4, length, 1e-9)
    local arrows = static_picture.arrows(mesh, {{place = "max:x", force = {0, 0, -3}}, {place = "min:z",
      pressure = 200}, gravity = {0, 0, -10}}, 2)
    assert.same({at = {1, 0.05, 0.05}, force = {0, 0, -3}}, arrows[1])
    local up = 0
    for i = 2, #arrows - 1 do
      check.near(1, 1 + arrows[i].at[3], 1e-12)
      up = up + arrows[i].force[3]
    end
    check.near(200 * 0.1, up, 1e-9) -- towards the body
    assert.same({0, 0, -20}, arrows[#arrows].force)
    -- All nodes are on the picture, the mid-edge nodes too.
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(mesh.boundary:below("x", 0))
    part:load {on = mesh.boundary:above("x", 1), force = {0, 0, -100}}
    local static, before, given, drawn = assert(part:solve()), core.picture, nil, nil
    core.picture = function(surface, _, opts) drawn, given = surface, opts return true end -- luacheck: ignore
    assert(static:picture("x.png", static_picture.options(static, "title", {{place = "max:x",
      force = {0, 0, -100}}}, {"below:x:0"})))
    core.picture = before -- luacheck: ignore
    assert.equal(static.von_mises:max(), given.values:max())
    check.near(0.42, drawn.area, 1e-6)
    assert.equal("title", given.title)
    assert.equal("border of the supports", given.line_name)
    assert.same({#border, 1}, {#given.lines, #given.arrows})
    local path = folder .. "statics.png"
    local page = folder .. "statics.html"
    local _, out = check.run(("statics %s --material steel --fix min:x --gravity 0,0,-1g --picture %s "
      .. "--report %s"):format(beam, path, page))
    local html = check.read(page)
    for _, sentence in ipairs {out:match "The largest displacement[^\n]*", out:match "The judged stress[^\n]*",
      "border of the supports", "MPa ±"} do
      assert.truthy(html:find(sentence, 1, true), sentence)
    end
    local data = assert(bw.json.decode(html:match 'id="data">(.-)</script>'))
    assert.same({1, 2}, {#data.displacements[1].arrows, #data.fields})
    -- The page is seen from where the picture is, which shows the largest value and the loads.
    local ball = bw.surface.sphere {radius = 1, subdivisions = 2}
    local behind = core.picture_direction(ball, nil, {values = ball.points:column(2)})
    assert.is_true(behind[2] > 0.3 * math.sqrt(behind[1] ^ 2 + behind[3] ^ 2))
    assert.same({1, 2, 3}, core.picture_direction(ball, nil, {direction = {1, 2, 3}}))
    local report = require "barwright.report"
    local written, write = nil, report.page
    report.page = function(_, given) written = given return true end -- luacheck: ignore
    assert(static_picture.report(static, "x.html", {title = "", arrows = {{at = {1, 0.1, 0.05},
      force = {0, 50, 0}}}}, {text = ""}))
    report.page = write -- luacheck: ignore
    assert.is_true(written.data.view[2] > 0) -- the arrow is on the side y = 0.1
    assert.is_true(#data.lines > 0)
    assert.truthy(out:find("%% of the strength of steel %(estimated error %d+ %%%): it holds%."), out)
    assert.is_nil(out:find("beyond the range", 1, true))
    _, out = check.run(("statics %s --material abs --fix min:x --force max:x=0,0,-100kN"):format(beam))
    assert.truthy(out:find("Displacements are beyond the range of linear theory: more than a tenth", 1, true), out)
    assert.truthy(#check.read(path) > 1000)
  end)

  it("modes refines until the frequencies are within an error", function()
    local path = folder .. "bar.stl"
    assert(prism({{0, 0}, {0.1, 0}, {0.1, 0.01}, {0, 0.01}}, {0.05, 0.005}, 0.01):write(path))
    local words = "modes --count 2 --elements 800 --fix min:x %s" .. path
    local _, plain = answer(words:format "--order 2 ")
    local _, fine = answer(words:format "--error 0.01 ")
    assert.is_true(fine.converged)
    assert.is_true(#fine.steps >= 2 and fine.estimated_error <= 0.01)
    check.near(1200 * math.log(1 + fine.estimated_error, 2), fine.estimated_error_cents, 1e-12)
    check.near(plain.frequencies_hz[1], fine.frequencies_hz[1], 0.05)
    local _, out = check.run(words:format "--error 0.01 ")
    assert.truthy(out:find("every frequency is within [%d.]+ cents%."), out)
  end)

  it("statics refuses a support without a facet", function()
    local status, _, fault = check.run("statics " .. beam .. " --fix near:0,0,0:1mm --gravity 0,0,-1")
    assert.equal(2, status)
    assert.truthy(fault:find("near:0,0,0:1mm: a fixed support acts on area", 1, true), fault)
  end)

  it("statics refuses a part that is fixed everywhere", function()
    -- All coordinates lie below 2 m.
    local status, out, fault = check.run("statics " .. beam .. " --fix below:z:2m --force max:x=0,0,-100N")
    assert.equal(2, status)
    assert.is_nil(out:find("it holds", 1, true))
    local sentence = "the whole surface is constrained at below:z:2m: no load reaches the body"
    assert.truthy(fault:find(sentence, 1, true), fault)
  end)

  it("statics gives the beam's deflection and stress", function()
    local status, object = answer("statics " .. beam .. " --material steel --order 2 --fix below:x:0 --force "
      .. "above:x:1m=0,0,-100N")
    assert.equal(0, status)
    local moment = 0.1 ^ 4 / 12 -- second moment of area
    check.near(100 * 1 / (3 * 210e9 * moment), object.max_displacement_m, 0.03)
    assert.equal("holds", object.verdict)
    assert.equal(object.value, object.max_von_mises_pa)
    check.near(0.01, object.supported_area_m2, 1e-9)
    assert.is_true(object.estimated_error >= 0.5) -- one mesh only
    assert.equal(3, #object.at_m)
    status, object = answer("statics " .. beam .. " --material steel --fix min:x --force max:x=0,0,-10MN")
    assert.equal(1, status)
    assert.equal("breaks", object.verdict)
    status, object = answer("statics " .. beam .. " --material steel --fix min:x --gravity 0,0,-1g")
    assert.equal(0, status)
    check.near(7850 * 0.1 ^ 2 * 9.80665 * 1 / (8 * 210e9 * moment), object.max_displacement_m, 0.05)
    assert.equal("cholesky", object.solver.solver)
    assert.equal("multifrontal", object.solver.backend)
    local before = object.max_displacement_m
    status, object = answer("statics " .. beam .. " --material steel --fix min:x --gravity 0,0,-1g --solver pcg")
    assert.equal(0, status)
    check.near(before, object.max_displacement_m, 1e-8)
    assert.equal("pcg", object.solver.solver)
    assert.equal("two_level", object.solver.preconditioner)
    assert.is_true(object.solver.iterations > 5 and object.solver.residual < 1e-9)
    status, object = answer("statics " .. beam .. " --material steel --fix min:x --gravity 0,0,-1g --error 0.1")
    assert.equal(0, status)
    assert.is_true(#object.steps >= 2)
    assert.equal(object.steps[#object.steps].value, object.value)
    assert.equal(object.steps[#object.steps].elements, object.elements)
    assert.equal(object.steps[#object.steps].estimated_error, object.estimated_error)
    assert.equal(object.reason == "tolerance", object.converged)
    check.near(0.01, object.supported_area_m2, 1e-9)
  end)

  it("modes has the frequencies of a beam, free and constrained", function()
    local _, object = answer("modes " .. beam .. " --material steel --count 2 --sure")
    local function bending(root) -- Euler and Bernoulli; shear and rotation lower it by some percent
      return root ^ 2 / (2 * math.pi) * math.sqrt(210e9 * 0.1 ^ 4 / 12 / (7850 * 0.1 ^ 2))
    end
    check.near(bending(4.730), object.frequencies_hz[1], 0.08)
    assert.equal(6, object.rigid_motions)
    assert.is_true(object.counted)
    _, object = answer("modes " .. beam .. " --material steel --count 2 --fix below:x:0 --vtu " .. folder
      .. "m.vtu")
    check.near(bending(1.875), object.frequencies_hz[1], 0.03)
    assert.equal(0, object.rigid_motions)
    assert.truthy(#check.read(folder .. "m.vtu") > 1000)
  end)

  it("refuse what makes no sense, with a sentence", function()
    for words, text in pairs {
      ["statics " .. beam] = "--fix PLACE is missing",
      ["statics --fix min:x " .. beam] = "no load is given",
      ["statics --fix min:x --gravity 0,0,1 --length 2 " .. beam] = "'2' has no unit",
      ["statics --fix min:x --gravity 0,0,1 --fillet 0mm " .. beam] = "option --fillet",
      ["statics --fix min:x --gravity 0,0,1 --length critical " .. beam] = "the fracture toughness of pla",
      ["modes --error 2 " .. beam] = "option --error",
      ["statics --fix lwo:x --gravity 0,0,1 " .. beam] = "'lwo:x' is no place",
      ["statics --fix min:w --gravity 0,0,1 " .. beam] = "an axis x, y or z expected",
      ["statics --fix min:x --force min:y=3 " .. beam] = "three numbers such as",
      ["statics --fix min:x --force min:y " .. beam] = "PLACE=VALUE expected",
      ["statics --fix min:x --pressure min:y=3N " .. beam] = "a number with one of the units",
      ["modes --fix near:0,0:1mm " .. beam] = "three numbers such as",
      ["modes --fix below:x:1kg " .. beam] = "a number with one of the units",
      ["worst --material plaa " .. beam] = "did you mean 'pla'",
      ["worst --force -3 " .. beam] = "above 0 expected",
      ["materials plaa"] = "did you mean 'pla'",
      ["strengthen --force 5 --out x.stl " .. beam] = "strengthening needs a surface",
      ["strengthen --out x.stl " .. beam] = "--force FORCE is missing",
      ["strengthen --force 5 " .. beam] = "--out FILE.stl is missing",
      ["strengthen --force 5 --out x.vtu " .. beam] = "ends in .stl, .obj",
      ["strengthen --force 5 --keep lwo:z --out x.stl " .. beam] = "'lwo:z' is no place",
      ["strengthen --force 5 --out x.stl " .. folder .. "plate.svg"] = "a drawing is flat",
      ["worst " .. folder .. "plate.svg"] = "a drawing is flat",
      ["statics --fix near:9,9,9m:1mm --gravity 0,0,1 " .. beam] = "selects no boundary node",
      ["worst --material zp150 --young 1GPa " .. beam] = "differs with the direction",
    } do
      local status, _, err = answer(words)
      assert.equal(2, status, words .. ": " .. err)
      assert.truthy(err:find(text, 1, true), words .. ": " .. err)
    end
    for words, text in pairs {
      ["worst " .. folder .. "cut.stl"] = "cut.stl: ",
      ["convert " .. folder .. "cut.stl " .. folder .. "x.obj"] = "cut.stl",
      ["worst --report " .. folder .. "no/such.html --modes 2 --regions 1 " .. beam] = "such.html",
    } do
      local status, _, err = answer(words)
      assert.equal(3, status, words .. ": " .. err)
      assert.truthy(err:find(text, 1, true), words .. ": " .. err)
    end
    for words, text in pairs {
      ["modes --fix near:0,0,0:1mm " .. beam] = "near:0,0,0:1mm: a fixed support acts on area",
      ["modes --fix near:9,9,9m:1mm " .. beam] = "selects no boundary node",
      ["convert " .. folder .. "sound.stl " .. folder .. "x.dxf"] = "not as a drawing",
      ["convert " .. folder .. "sound.stl " .. folder .. "x.xyz"] = "ending .xyz is not known",
      ["convert " .. folder .. "plate.svg " .. folder .. "x.stl"] = "a drawing can be written as",
    } do
      local status, _, err = answer(words)
      assert.equal(2, status, words .. ": " .. err)
      assert.truthy(err:find(text, 1, true), words .. ": " .. err)
    end
  end)
end)

describe("barwright convert", function()
  local folder = models()

  it("goes there and back", function()
    for _, ending in ipairs {"obj", "ply", "off", "stl"} do
      assert.equal(0, (answer(("convert %ssound.stl %sa.%s"):format(folder, folder, ending))))
      check.near(1.2e-5, assert(bw.surface.read(folder .. "a." .. ending)).volume, 1e-6)
    end
    assert.equal(0, (answer(("convert %sopen.stl %sb.stl --repair --scale 2 --out-unit cm"):format(folder,
      folder))))
    local repaired = assert(bw.surface.read(folder .. "b.stl", {unit = "cm"}))
    assert.is_true(repaired:check().sound)
    check.near(8 * 1.2e-5, repaired.volume, 1e-6)
    for _, ending in ipairs {"msh", "mesh", "inp", "vtu"} do
      assert.equal(0, (answer(("convert %ssound.stl %sc.%s --elements 300 --order 2"):format(folder, folder,
        ending))))
      local mesh = assert(bw.mesh.read(folder .. "c." .. ending))
      assert.equal(2, mesh.order)
      check.near(1.2e-5, mesh.volume, 1e-6)
    end
    assert.equal(0, (answer(("convert %sc.msh %sd.stl"):format(folder, folder))))
    check.near(1.2e-5, assert(bw.surface.read(folder .. "d.stl")).volume, 1e-6)
    assert.equal(0, (answer(("convert %splate.svg %se.dxf --scale 3"):format(folder, folder))))
    check.near(9e-3, assert(bw.outline.read(folder .. "e.dxf")).area, 1e-9)
  end)
end)

describe("the shells", function()
  it("complete commands, options, values and files in bash", function()
    local folder = check.folder()
    local status, text = check.run "completion bash"
    assert.equal(0, status)
    check.write(folder .. "/completion", text)
    check.write(folder .. "/model.stl", "")
    check.write(folder .. "/run.sh", [[
      source ./completion
      complete_line() { # the words, the last one being completed
        COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMPREPLY=(); _barwright 2>/dev/null; echo "${COMPREPLY[*]}"
      }
      complete_line barwright wo
      complete_line barwright --san
      complete_line barwright worst --mat
      complete_line barwright worst --material st
      complete_line barwright worst --material = st
      complete_line barwright worst --unit ""
      complete_line barwright worst mod
      complete_line barwright --sandbox . check --th
      complete_line barwright completion z
      complete_line barwright help conv
      complete_line barwright worst --force ""
    ]])
    local pipe = assert(io.popen("cd '" .. folder .. "' && bash run.sh"))
    local lines = {}
    for line in pipe:lines() do lines[#lines + 1] = line end
    pipe:close()
    assert.same({"worst", "--sandbox", "--material", "steel", "steel", "mm cm m km um in ft", "model.stl",
      "--thin", "zsh", "convert", ""}, lines)
  end)

  it("have a completion of every command and option", function()
    for _, shell in ipairs {"bash", "zsh", "fish"} do
      local status, text = check.run("completion " .. shell)
      assert.equal(0, status)
      for _, name in ipairs(commands.names()) do
        assert.truthy(text:find(name, 1, true), shell .. " " .. name)
        for _, option in ipairs(commands.load(name).options or {}) do
          assert.truthy(text:find(option.name, 1, true), ("%s %s --%s"):format(shell, name, option.name))
        end
      end
      if os.execute("command -v " .. shell .. " >/dev/null") then
        local folder = check.folder()
        check.write(folder .. "/completion", text)
        assert(os.execute(("%s -n '%s/completion'"):format(shell, folder)))
      end
    end
    assert.equal(2, (check.run "completion csh"))
  end)
end)

describe("the man page", function()
  it("tells of every command and option, in roff without warnings", function()
    local status, text = check.run "manual"
    assert.equal(0, status)
    for _, name in ipairs(commands.names()) do
      assert.truthy(text:find(".SS " .. name, 1, true), name)
      for _, option in ipairs(commands.load(name).options or {}) do
        local escaped = "\\-\\-" .. option.name:gsub("%-", "\\-")
        assert.truthy(text:find(escaped, 1, true), name .. " --" .. option.name)
      end
    end
    if not os.execute "command -v groff >/dev/null" then return pending "groff is not installed" end
    local folder = check.folder()
    check.write(folder .. "/barwright.1", text)
    local pipe = io.popen(("LC_ALL=C groff -man -ww -z -Tascii '%s/barwright.1' 2>&1"):format(folder))
    assert.equal("", pipe:read "a")
    pipe:close()
  end)
end)

describe("every model of the collection", function()
  local shared = os.getenv "BARWRIGHT_SHARED" or check.root .. "/../shared"
  local pipe = io.popen("ls '" .. shared .. "/models' 2>/dev/null")
  local names = {}
  for name in pipe:lines() do
    if not name:match "^README" then names[#names + 1] = name end
  end
  pipe:close()
  local full = os.getenv "BARWRIGHT_FULL" == "1"

  it("is checked", function()
    if #names == 0 then return pending "there is no collection" end
    for _, name in ipairs(names) do
      local status, object, err = answer(("check %s --repair no '%s/models/%s'"):format("", shared, name))
      assert.equal(object.sound and 0 or object.error and 3 or 1, status, name .. err)
      local bad = name:match "^bad_" or name == "engine_bracket.obj" or name == "manifest.csv"
      assert.equal(not bad, object.sound, name .. ": " .. err)
    end
  end)

  it("is answered by every command #slow", function()
    if #names == 0 or not full then return pending "only with BARWRIGHT_FULL=1" end
    local folder = check.folder()
    for _, name in ipairs(names) do
      for command, options in pairs {check = "", worst = "--elements 3000 --modes 6 --regions 2",
        modes = "--elements 3000 --order 1", convert = folder .. "/out.ply --repair",
        statics = "--elements 3000 --order 1 --fix min:z --gravity 0,0,-9.81"} do
        local status, object, err = answer(("%s '%s/models/%s' %s"):format(command, shared, name, options))
        assert.truthy(status >= 0 and status <= 3, command .. " " .. name .. err)
        assert.is_true(status == 0 or object.error ~= nil or object.sound == false or object.verdict ~= nil,
          command .. " " .. name .. ": " .. err)
      end
    end
  end)
end)
