-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Plots: marks and units on axes, numbers in their place, well-formed SVG, and data of every kind.
local bw = require "barwright"
local check = require "check"
local core = require "barwright.core"
local numbers = require "barwright.plot.numbers"
local quantity = require "barwright.command.quantity"

-- Every element is closed by its own name, attributes are quoted, no stray < or &.
local function assert_well_formed(svg)
  local open = {}
  local rest = svg:gsub("<(/?)([%w:]+)([^<>]*)>", function(close, name, inside)
    if close == "/" then
      assert.equal(open[#open], name)
      open[#open] = nil
    elseif inside:sub(-1) ~= "/" then
      open[#open + 1] = name
    end
    local left = inside:gsub('%s+[%w:%-]+="[^"<]*"', ""):gsub("/$", "")
    assert.equal("", left)
    return ""
  end)
  assert.equal(0, #open)
  assert.is_nil(rest:find("[<>]"))
  for entity in svg:gmatch "&(.-)[;%s\"<]" do
    assert.truthy(({amp = true, lt = true, gt = true, quot = true})[entity], entity)
  end
  assert.truthy(utf8.len(svg))
  assert.is_nil(svg:find("nan", 1, true))
  assert.is_nil(svg:find("inf", 1, true))
end

local function svg_of(figure)
  local svg = assert(figure:svg())
  assert_well_formed(svg)
  return svg
end

local function texts(marks)
  local out = {}
  for _, mark in ipairs(marks) do out[#out + 1] = mark.text end
  return table.concat(out, " ")
end

describe("marks", function()
  it("are round numbers with as many decimals as they need", function()
    assert.equal("0.0 0.2 0.4 0.6 0.8 1.0", texts(numbers.linear(0, 1, 5)))
    assert.equal("−20 0 20 40", texts(numbers.linear(-21, 55, 4)))
    assert.equal("0.0012 0.0014 0.0016", texts(numbers.linear(0.0011, 0.0017, 3)))
    assert.equal("1 2 3", texts(numbers.linear(0.9, 3.1, 8, true)))
  end)

  it("of a log axis are decades, 2 and 5 where there is room", function()
    assert.equal("0.01 0.1 1 10 100 1000", texts(numbers.log(0.01, 1000, 8)))
    assert.equal("1 2 5 10 20 50 100", texts(numbers.log(1, 100, 9)))
    assert.equal("10⁻¹² 10⁻⁸ 10⁻⁴ 10⁰ 10⁴ 10⁸", texts(numbers.log(1e-12, 1e8, 6)))
    assert.equal("90 95 100 105 110", texts(numbers.log(90, 110, 5)))
  end)

  it("are in units with a prefix that keeps them short", function()
    local function unit(name, size) return select(2, numbers.unit(name, size)) end
    assert.equal("MPa", unit("Pa", 5.5e7))
    assert.equal("mm", unit("m", 0.0025))
    assert.equal("g", unit("kg", 0.012))
    assert.equal("kg", unit("kg", 3))
    assert.equal("cm³", unit("m3", 1e-4))
    assert.equal("cm²", unit("m²", 3e-5))
    assert.equal("kN", unit("N", 5e4))
    assert.equal("µs", unit("s", 3e-5))
    assert.equal("s", unit("s", 5e4))
    assert.equal("mm/s", unit("m/s", 0.02))
    assert.equal("10⁻⁹", unit("", 3e-7 / 100))
    assert.equal("inch", unit("inch", 5))
    assert.near(1000, numbers.unit("kg", 0.012), 1e-9)
    for unit_name, value in pairs {Pa = 55e6, m = 0.0025, N = 123400, kg = 0.012, m3 = 2e-6, Hz = 440} do
      local text = core.quantity(value, unit_name) -- as print shows it
      assert.equal((text:gsub("m3$", "m³")), numbers.quantity(value, unit_name))
      assert.equal(text, quantity.text(value, unit_name))
    end
    assert.equal("−1.5·10⁻⁷", numbers.quantity(-1.5e-7, ""))
  end)
end)

describe("a plot", function()
  it("has its points where its axes say", function()
    local figure = bw.plot.scatter {series = {{x = {1, 2, 4}, y = {10, 30, 20}}},
      x = {label = "a", min = 0, max = 5}, y = {label = "b", min = 0, max = 40}}
    local svg = svg_of(figure)
    local found = {}
    for x, y in svg:gmatch '<circle cx="([%d.]+)" cy="([%d.]+)"' do
      found[#found + 1] = {tonumber(x), tonumber(y)}
    end
    assert.equal(3, #found)
    -- the marks at 0 and at 5, at 0 and at 40 give the scale
    local function mark(text, anchor)
      local x, y = svg:match('<text x="([%d.]+)" y="([%d.]+)"[^>]*text%-anchor="' .. anchor .. '"[^>]*>'
        .. text .. "<")
      return tonumber(anchor == "middle" and x or y)
    end
    local left, right = mark("0.0", "middle"), mark("5.0", "middle")
    local low, high = mark("0", "end"), mark("40", "end")
    for i, at in ipairs {{1, 10}, {2, 30}, {4, 20}} do
      assert.near(left + (right - left) * at[1] / 5, found[i][1], 0.02)
      local baseline = low + (high - low) * at[2] / 40
      assert.near(baseline - 0.36 * 11.5, found[i][2], 0.02)
      local x, y = figure:place(at[1], at[2])
      assert.near(found[i][1], x, 0.01)
      assert.near(found[i][2], y, 0.01)
    end
  end)

  it("writes files of both kinds, and says why where it cannot", function()
    local figure = bw.plot.lines {series = {{name = "a < b & \"c\"", y = {1, 3, 2}}}, title = "größer µ ≥ 0"}
    local folder = check.folder()
    assert(figure:write(folder .. "/a.svg"))
    assert_well_formed(check.read(folder .. "/a.svg"))
    assert.is_nil(check.read(folder .. "/a.svg"):find("<text", 1, true))
    assert(figure:write(folder .. "/a.png", {scale = 1}))
    assert.equal("\137PNG", check.read(folder .. "/a.png"):sub(1, 4))
    assert.equal(figure:svg(), figure:svg())
    check.fails("io", "nowhere", figure:write "/nowhere/a.svg")
    check.fails("unsupported", ".svg or .png", figure:write(folder .. "/a.pdf"))
    check.raises("did you mean 'scale'", function() figure:write(folder .. "/a.png", {scal = 1}) end)
  end)

  it("shows what can be shown of any numbers", function()
    local nan, inf = 0 / 0, math.huge
    local lists = {{}, {1}, {0, 0, 0}, {nan, nan}, {1, nan, inf, -inf, 2}, {1e300, -1e300}, {1e-310, 2e-310},
      {1e15, 1e15 + 1}, {-5, -5, -5}, {1e-7, 3e-7}}
    for _, y in ipairs(lists) do
      svg_of(bw.plot.lines {series = {{y = y}}})
      svg_of(bw.plot.scatter {series = {{name = ("ü"):rep(300), y = y, values = y}}})
      local names = {}
      for i = 1, #y do names[i] = ("name " .. i):rep(i) end
      svg_of(bw.plot.bars {names = names, series = {{values = y}}})
    end
    assert.truthy(svg_of(bw.plot.lines {series = {}}):find("no data", 1, true))
    assert.truthy(svg_of(bw.plot.lines {series = {{y = {1, nan, 3}}}})
      :find("1 point without a finite number", 1, true))
    assert.truthy(svg_of(bw.plot.lines {series = {{y = {1, -2, 3}}}, y = {scale = "log"}})
      :find("1 point of 0 or less has no place on a log axis", 1, true))
    check.raises("numbers above 0 expected for scale 'log'", bw.plot.lines,
      {series = {{y = {-1, -2}}}, y = {scale = "log"}})
    svg_of(bw.plot.lines {series = {{name = "bad \xff \1 bytes", y = {1, 2}}}})
  end)

  it("of very many series keeps room for them", function()
    local series = {}
    for i = 1, 200 do series[i] = {name = "series " .. i, y = {i, 2 * i}} end
    local figure = bw.plot.lines {series = series}
    assert.truthy(svg_of(figure):find("and %d+ more"))
    local _, low = figure:place(1, 1)
    local _, high = figure:place(1, 400)
    assert.truthy(low - high > 200 and high > 0 and low < 440)
  end)

  it("of very many points is small", function()
    local x, y = {}, {}
    local random = check.random(5)
    for i = 1, 100000 do x[i], y[i] = random(), random() end
    assert.truthy(#svg_of(bw.plot.scatter {series = {{x = x, y = y}}}) < 4e6)
    assert.truthy(#svg_of(bw.plot.lines {series = {{y = y}}}) < 2e5)
  end)

  it("takes arrays, and names what it does not know", function()
    svg_of(bw.plot.lines {series = {{y = bw.array.new {1, 2, 3}}}})
    check.raises("unknown option 'serie': did you mean 'series'", bw.plot.lines, {serie = {}})
    check.raises("series 1: y: 2 numbers expected, as x has, got 3",
      bw.plot.lines, {series = {{x = {1, 2}, y = {1, 2, 3}}}})
    check.raises("series 2: unknown option 'color': did you mean 'colour'", bw.plot.lines,
      {series = {{y = {1}}, {y = {1}, color = "red"}}})
    check.raises("entry 2: a number expected, got string", bw.plot.lines, {series = {{y = {1, "2"}}}})
    local endless = setmetatable({}, {__len = function() return "3" end})
    check.raises("a table with a length", bw.plot.lines, {series = {{y = endless}}})
    check.raises("a table with a length", bw.plot.lines, {series = endless})
    check.raises("a table with a length", bw.plot.sensitivity,
      {base = 1, high = endless, low = {1}, names = {"a"}})
    check.raises("'logarithmic' is not known", bw.plot.lines, {series = {{y = {1}}}, x = {scale = "logarithmic"}})
    check.raises("min below max expected, got min = 3 and max = 2",
      bw.plot.lines, {series = {}, x = {min = 3, max = 2}})
    check.raises("#rrggbb", bw.plot.lines, {series = {{y = {1}, colour = "red"}}})
  end)
end)

-- A study's worth of columns.
local function trials(count, seed)
  local random = check.random(seed or 3)
  local out = {thickness = {}, material = {}, mass = {}, stress = {}, feasible = {}, failed = {}, notes = {}}
  for i = 1, count do
    out.thickness[i] = 1e-3 + 4e-3 * random()
    out.material[i] = random() < 0.5 and "pla" or "zp150"
    out.mass[i] = 9 * out.thickness[i] * (1 + 0.2 * random())
    out.stress[i] = 4e4 / out.thickness[i] * (1 + 0.2 * random())
    out.failed[i] = i % 10 == 7
    if out.failed[i] then out.mass[i], out.stress[i] = 0 / 0, 0 / 0 end
    out.feasible[i] = out.stress[i] < 3e7
    out.notes[i] = ("trial %d & <more>"):format(i)
  end
  return out
end

local function count_of(text, part)
  return select(2, text:gsub(part, ""))
end

describe("a plot of trials", function()
  it("reports how they went on", function()
    local t = trials(40)
    local svg = svg_of(bw.plot.history {values = t.mass, feasible = t.feasible, failed = t.failed,
      notes = t.notes, label = "mass", unit = "kg"})
    assert.truthy(svg:find("mass, g", 1, true))
    assert.truthy(svg:find("no result (4)", 1, true))
    -- the notes of all trials, and of the best once more
    assert.equal(41, count_of(svg, "<title>"))
    local best
    for i = 1, 40 do
      if t.feasible[i] and not t.failed[i] and (not best or t.mass[i] < t.mass[best]) then best = i end
    end
    assert.equal(2, count_of(svg, "<title>trial " .. best .. " &amp; &lt;more&gt;<"))
    assert.truthy(svg:find(numbers.quantity(t.mass[best], "kg"), 1, true))
    for _, values in ipairs {{}, {1}, {2, 2, 2}, {0 / 0, 0 / 0}, {math.huge, 1}} do
      svg_of(bw.plot.history {values = values, goal = "max", scale = "log"})
    end
    check.raises("40 numbers expected", bw.plot.history, {values = t.mass, numbers = {1, 2}})
  end)

  it("finds the front, of two objectives and of more", function()
    local x, y = {1, 2, 3, 4, 2, 0.5, 3}, {4, 3, 1, 2, 3, 9, 0 / 0}
    local feasible = {true, true, true, true, true, false, true}
    local function front(goals, able)
      local objectives = {{numbers = x, goal = goals[1]}, {numbers = y, goal = goals[2]}}
      local out = {}
      for i in pairs(require "barwright.plot.progress".find_front(objectives, able)) do out[#out + 1] = i end
      table.sort(out)
      return table.concat(out, " ")
    end
    assert.equal("1 2 3 5", front({"min", "min"}, feasible))
    assert.equal("4", front({"max", "max"}, {false, false, false, true, false, false, false}))
    assert.equal("1 4 6", front({"max", "max"}, {true, false, true, true, false, true, true}))
    local svg = svg_of(bw.plot.pareto {objectives = {{name = "a", values = x}, {name = "b", values = y,
      goal = "min"}}, feasible = feasible})
    assert.truthy(svg:find("front (4)", 1, true))
    assert.truthy(svg:find("a  ← better", 1, true))
    local t = trials(30)
    svg_of(bw.plot.pareto {objectives = {{name = "a", values = t.mass}, {name = "b", values = t.stress},
      {name = "c", values = t.thickness, goal = "max"}}})
    for _, values in ipairs {{}, {1}, {1, 1}, {0 / 0}} do
      svg_of(bw.plot.pareto {objectives = {{name = "a", values = values}, {name = "b", values = values}}})
    end
    check.raises("2 to 6 columns", bw.plot.pareto, {objectives = {{name = "a", values = {1}}}})
    check.raises("2 values expected, as the first column has, got 3", bw.plot.pareto,
      {objectives = {{name = "a", values = {1, 2}}, {name = "b", values = {1, 2, 3}}}})
  end)

  it("shows many columns at once", function()
    for _, count in ipairs {0, 1, 2, 40} do
      local t = trials(count)
      local columns = {{name = "thickness", unit = "m", values = t.thickness},
        {name = "material", values = t.material, of = {"pla", "zp150"}},
        {name = "mass", unit = "kg", values = t.mass}, {name = "stress", unit = "Pa", values = t.stress,
          scale = "log"}}
      svg_of(bw.plot.scatter_matrix {columns = columns, values = t.mass, value = {label = "mass", unit = "kg"},
        chosen = count > 0 and {1} or nil, faint = t.failed, notes = t.notes})
      svg_of(bw.plot.parallel_coordinates {columns = columns, values = t.mass, goal = "max"})
    end
    check.raises("one of its names expected, got 'steel'", bw.plot.scatter_matrix, {columns = {
      {name = "a", values = {"steel"}, of = {"pla"}}, {name = "b", values = {1}}}})
    local wrong = {["a list of names expected, got string"] = "steel",
      ["entries expected, got entry"] = {[1 << 40] = "pla"}}
    for said, values in pairs(wrong) do
      check.raises(said, bw.plot.parallel_coordinates, {values = {1}, columns = {
        {name = "a", values = {1}}, {name = "b", of = {"pla", "steel"}, values = values}}})
    end
    check.raises("places from 1 to 1", bw.plot.parallel_coordinates, {columns = {
      {name = "a", values = {1}}, {name = "b", values = {1}}}, chosen = {2}})
    assert.near(1, require "barwright.plot.data".rank_correlation({1, 2, 3, 4}, {1, 4, 9, 16}), 1e-12)
    assert.near(-0.8, require "barwright.plot.data".rank_correlation({1, 2, 3, 4}, {9, 5, 7, 1}), 1e-12)
  end)

  it("says what matters", function()
    local names = {"thickness", "holes", "größe"}
    local svg = svg_of(bw.plot.sensitivity {names = names, first = {0.1, 0.2, 0.6}, total = {0.1, 0.25, 0.7},
      total_low = {0, 0.2, 0.6}, total_high = {0.2, 0.3, 0.8}})
    local function height_of(text) return tonumber(svg:match('y="([%d.]+)"[^>]*>' .. text .. "<")) end
    assert.truthy(height_of "größe" < height_of "holes") -- the largest on top
    assert.truthy(height_of "holes" < height_of "thickness")
    svg_of(bw.plot.sensitivity {names = names, mu_star = {1, 2, 0}, sigma = {0.5, 3, 0}})
    svg_of(bw.plot.sensitivity {names = names, low = {1, 2, 3}, high = {3, 2, 0 / 0}, base = 2})
    for _, values in ipairs {{}, {0 / 0}, {0}} do
      local few = {table.unpack(names, 1, #values)}
      svg_of(bw.plot.sensitivity {names = few, total = values})
      svg_of(bw.plot.sensitivity {names = few, mu_star = values, sigma = values})
      svg_of(bw.plot.sensitivity {names = few, low = values, high = values})
    end
    check.raises("Sobol", bw.plot.sensitivity, {names = names})
  end)

  it("fits slopes", function()
    local svg = svg_of(bw.plot.convergence {series = {{name = "tet10", x = {0.1, 0.2, 0.4}, y = {1, 4, 16}},
      {name = "flat", x = {0.1, 0.2}, y = {1, 1}}, {name = "one", x = {0.1}, y = {1}},
      {name = "exact", x = {0.1, 0.2}, y = {0, 1e-3}}}})
    assert.truthy(svg:find("tet10 (slope 2.00)", 1, true))
    assert.truthy(svg:find("1 point without place", 1, true))
    svg_of(bw.plot.convergence {series = {}})
    check.raises("plot.convergence: x: a table of options expected, got", bw.plot.convergence,
      {series = {}, x = 1e300})
  end)

  it("puts pictures side by side, also those that are not there", function()
    local folder = check.folder()
    local inner = bw.plot.lines {series = {{y = {1, 2}}}}
    assert(inner:write(folder .. "/a.png"))
    check.write(folder .. "/bad.png", "no picture")
    local svg = svg_of(bw.plot.contact_sheet {title = "variants", pictures = {{path = folder .. "/a.png",
      caption = "first\nsecond"}, {path = folder .. "/none.png"}, {path = folder .. "/bad.png"},
      {figure = inner, chosen = true}, {caption = "x"}}})
    assert.equal(1, count_of(svg, "<image "))
    assert.truthy(svg:find("no picture: none.png", 1, true))
    assert.truthy(svg:find("this is no PNG file", 1, true))
    svg_of(bw.plot.contact_sheet {pictures = {}})
    check.raises("fewer or smaller", bw.plot.contact_sheet, {pictures = {{}, {}, {}}, cell = 2000, ratio = 10,
      columns = 1})
  end)

  it("of ten thousand can be drawn", function()
    local t = trials(10000)
    svg_of(bw.plot.history {values = t.mass, feasible = t.feasible, failed = t.failed})
    svg_of(bw.plot.pareto {objectives = {{name = "a", values = t.mass}, {name = "b", values = t.stress}}})
  end)
end)

describe("a canvas", function()
  it("checks what it is given", function()
    local canvas <close> = assert(bw.canvas(100, 50, {name = "x"}))
    assert.equal(100, canvas.width)
    assert.equal(canvas, canvas:line({{1, 2}, {3, 4}}, {stroke = "#ff0000", dash = {3, 2}}))
    check.raises("an even number of values expected", canvas.line, canvas, {1, 2, 3})
    check.raises("a colour \"#rrggbb\"", canvas.line, canvas, {1, 2}, {stroke = "red"})
    check.raises("dash", canvas.line, canvas, {1, 2}, {dash = {1}})
    check.raises("did you mean 'disc'", canvas.markers, canvas, "disk", 3, {1, 2})
    check.raises("a finite number", canvas.text, canvas, "x", 0 / 0, 1)
    check.raises("a whole number of rows expected, of 3 pixels", canvas.pixels, canvas, "12345678", 3, 0, 0, 1, 1)
    check.raises("no nested drawing", canvas.leave, canvas)
    check.fails("io", "nothing.png", canvas:image("nothing.png", 0, 0, 10, 10))
    canvas:pixels(("\255\0\0"):rep(6), 3, 10, 10, 30, 20):markers("disc", 5, {10, 10}, {fill = "#00ff0080"},
      {"a note"})
    local svg = canvas:svg()
    assert_well_formed(svg)
    assert.truthy(svg:find("<title>a note</title>", 1, true))
    canvas:close()
    check.raises("closed", canvas.svg, canvas)
  end)
end)

describe("the letters of a picture", function()
  it("do not depend on what the process drew before", function()
    local folder = check.folder() .. "/"
    check.write(folder .. "draw.lua", [[
      local bw = require "barwright"
      if arg[2] then assert(bw.plot.lines {series = {{y = {1, 3, 2}}}, title = "a plot"}:svg()) end
      assert(bw.surface.sphere {radius = 0.02, subdivisions = 2}:picture(arg[1], {title = "A ball of 40 mm"}))]])
    assert.equal(0, (check.run(("%sdraw.lua %sa.png"):format(folder, folder))))
    assert.equal(0, (check.run(("%sdraw.lua %sb.png svg"):format(folder, folder))))
    assert.is_true(check.read(folder .. "a.png") == check.read(folder .. "b.png"))
  end)
end)
