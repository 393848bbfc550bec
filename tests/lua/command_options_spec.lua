-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The commands of a first question take the same options. What they print, write as JSON and put on the page is
-- the same. Pages of the others begin with their verdict.
local bw = require "barwright"
local check = require "check"
local core = require "barwright.core"
local shown = require "barwright.shown"

local folder = check.folder()
local MATERIAL <const> = "young=2GPa,poisson=0.3,strength=40MPa,density=1200"

local point = core.point
local function length(value) return core.quantity(value, "m") end

-- Of each command: more words, texts of the numbers of its JSON object as they are printed and shown on the page,
-- a text of the page or a function that gives it, its model and exit status where they are others.
local commands = {
  {"check", "", function(answer)
    return {core.quantity(answer.volume_m3, "m3"), core.quantity(answer.mass_kg, "kg"),
      length(answer.thickness_median_m)}
  end, "It is sound"},
  {"modes", "--fix min:x --count 2 --elements 300", function(answer)
    return {shown.number(answer.frequencies_hz[1]), shown.number(answer.frequencies_hz[2]),
      core.quantity(answer.mass_kg, "kg")}
  end, function(answer)
    return ('<p class="word">%s</p>'):format(core.quantity(answer.frequencies_hz[1], "Hz"))
  end},
  {"statics", "--fix min:x --force max:x=0,0,-1N --elements 300", function(answer)
    return {shown.estimate(answer.max_displacement_m, "m"), shown.estimate(answer.max_von_mises_pa, "Pa"),
      point(answer.max_von_mises_at_m), core.quantity(answer.mass_kg, "kg")}
  end, "It holds"},
  {"worst", "--force 1N --modes 1 --regions 1", function(answer)
    return {
      shown.interval(answer.breaking_force_n, answer.breaking_force_low_n, answer.breaking_force_high_n, "N"),
      point(answer.at_m), core.quantity(answer.contact_area_m2, "m2"), core.quantity(answer.mass_kg, "kg")}
  end, "Not certain", "bar.msh", 1}, -- one mesh: of a surface it makes several, which takes longer
}

local function path(name) return folder .. "/" .. name end
local function read(name) return check.read(path(name)) end

-- Standard output of a command that ends with a status.
local function run(words, expected)
  local status, text, fault = check.run(words)
  assert.equal(expected, status, fault .. text)
  return text
end

describe("a command of a first question", function()
  setup(function()
    assert(bw.surface.box {max = {0.1, 0.01, 0.01}}:write(path "bar.stl", {unit = "cm"}))
    -- The numbers of a mesh file are metres: these mean centimetres.
    assert(bw.mesh.box({max = {10, 1, 1}, cells = {10, 2, 2}, order = 2}):write(path "bar.msh"))
  end)

  for _, case in ipairs(commands) do
    local name, more, numbers, word, file, status = table.unpack(case)
    it("takes a unit, constants, a page, a picture and --json: " .. name, function()
      local words = ("%s %s --unit cm --material %s %s"):format(name, path(file or "bar.stl"), MATERIAL, more)
      local printed = run(words, status or 0)
      local answer = bw.json.decode(run(("%s --json --report %s --picture %s"):format(words, path "page.html",
        path "p.png"), status or 0))
      local page = read "page.html"
      assert.equal("\137PNG", read "p.png":sub(1, 4))
      assert.truthy(page:find('<section class="verdict', 1, true))
      local first = type(word) == "function" and word(answer) or word
      assert.truthy(page:find(first, 1, true), first)
      table.sort(answer.files)
      assert.same({path "p.png", path "page.html"}, answer.files)
      check.near(1.2e-2, answer.mass_kg, 1e-3)
      for _, text in ipairs(numbers(answer)) do
        assert.truthy(printed:find(text, 1, true), text .. "\n" .. printed)
        assert.truthy(page:find(text, 1, true), text)
      end
    end)
  end
end)

describe("the page of `barwright check`", function()
  it("shows the faults of an open surface, and what repair does", function()
    local box = assert(bw.surface.box {max = {0.02, 0.02, 0.02}})
    local triangles = box.triangles:totable()
    table.remove(triangles)
    assert(bw.surface.new {points = box.points, triangles = triangles}:write(path "open.stl", {unit = "mm"}))
    local status, text = check.run(("check %s --report %s --picture %s"):format(path "open.stl",
      path "open.html", path "open.png"))
    local page = read "open.html"
    assert.equal(1, status, text)
    assert.truthy(page:find("It has faults", 1, true))
    assert.truthy(page:find("<h2>What is wrong</h2>", 1, true))
    assert.truthy(page:find("open edges", 1, true))
    assert.truthy(page:find("Repair corrects it", 1, true))
    assert.falsy(text:find "facet %d")
    assert.equal("\137PNG", read "open.png":sub(1, 4))
  end)

  it("is refused for a drawing, which a picture shows", function()
    check.write(path "plate.svg", '<svg xmlns="http://www.w3.org/2000/svg" width="40mm" height="20mm" '
      .. 'viewBox="0 0 40 20"><path d="M0 0H40V20H0Z"/></svg>')
    local status, _, fault = check.run(("check %s --report %s"):format(path "plate.svg", path "plate.html"))
    assert.equal(2, status)
    assert.truthy(fault:find("has no view to turn: --picture FILE.png draws it", 1, true), fault)
    assert.equal(0, (check.run(("check %s --picture %s"):format(path "plate.svg", path "plate.png"))))
    assert.equal("\137PNG", read "plate.png":sub(1, 4))
  end)
end)

-- Of each command: words, the exit status, texts of the head of its page, a number of its object that is there.
local OPTIONS <const> = "--elements 300 --unit cm --json"
local heads = {
  {"buckle", "--force max:x=-1N,0,0", 0, {"It does not buckle", "Assumption", "perfect shape"},
    function(answer) return shown.number(tonumber(("%.3g"):format(answer.load_factor))) end},
  -- It does not buckle, and the load itself is too much.
  {"buckle", "--force max:x=-1N,0,0 --material young=2GPa,poisson=0.3,strength=5kPa", 1,
    {"Not certain", "The material may fail before"},
    function(answer) return shown.percent(answer.utilisation_at_factor) end},
  {"respond", "--base 0,0,1g --to 500 --damping 0.02", 0, {"It holds", "loads in phase", "2 % of critical"},
    function(answer) return shown.percent(answer.utilisation) end},
  {"respond", "--base 0,0,1g --duration 1h --damping 0.02 --psd QUIET", 0,
    {"It holds", "probability below 0.001 %", "Gaussian vibration"},
    function(answer) return shown.percent(answer.utilisation) end},
  -- Three root mean squares stay below the strength, and an hour has some of four.
  {"respond", "--base 0,0,1g --duration 1h --damping 0.02 --psd LOUD", 1, {"Not certain", "probability at most"},
    function(answer)
      assert.is_true(answer.utilisation * (1 + answer.utilisation_error) < 1)
      assert.is_true(answer.first_passage > 0.01)
      return shown.percent(answer.first_passage)
    end},
  {"respond", "--base 0,0,1g --duration 1s --damping 0.02 --psd LOUD --first-passage 0.5", 0,
    {"It holds", "up to 50 % is taken as safe"}, function(answer)
      assert.is_true(answer.first_passage > 0.01 and answer.first_passage_limit == 0.5)
      return shown.percent(answer.utilisation)
    end},
  {"drop", "--height 1m --down -1,-2,-3", 1, {"Not certain", "no friction", "Stress where it touches"},
    function(answer) return shown.estimate(answer.force_n, "N") end},
  {"heat", "--temperature min:x=80C --convection all=10,20C", 0, {"80 C", "steady state"},
    function(answer) return ("%.4g C"):format(answer.lowest_k - 273.15) end},
}

describe("the page of a command", function()
  setup(function()
    assert(bw.surface.box {max = {0.1, 0.01, 0.01}}:write(path "held.stl", {unit = "cm"}))
    check.write(path "quiet.csv", "10 0.001\n2000 0.001\n")
    check.write(path "loud.csv", "10 16\n2000 16\n")
  end)

  for _, case in ipairs(heads) do
    local name, more, status, texts, number = table.unpack(case)
    it(("begins with the verdict: %s %s"):format(name, more), function()
      local own = more:gsub("QUIET", path "quiet.csv"):gsub("LOUD", path "loud.csv")
      local held = (name == "drop" or name == "heat") and "" or "--fix min:x"
      local words = ("%s %s %s %s %s --report %s"):format(name, path "held.stl", own, held, OPTIONS,
        path "head.html")
      local answer = bw.json.decode(run(words, status))
      local head = read "head.html":match '<section class="verdict.-</section>'
      for _, text in ipairs(texts) do assert.truthy(head:find(text, 1, true), text .. "\n" .. head) end
      assert.truthy(head:find(number(answer), 1, true), number(answer) .. "\n" .. head)
    end)
  end
end)
