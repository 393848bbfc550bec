-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Plots: marks and units on axes, numbers in their place, well-formed SVG, and data of every kind.
local bw = require "barwright"
local check = require "check"
local numbers = require "barwright.plot.numbers"

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
    assert.equal("10⁻¹² 10⁻⁸ 10⁻⁴ 1 10000 10⁸", texts(numbers.log(1e-12, 1e8, 6)))
    assert.equal("90 95 100 105 110", texts(numbers.log(90, 110, 5)))
  end)

  it("are in units with a prefix that keeps them short", function()
    local function unit(name, size) return select(2, numbers.unit(name, size)) end
    assert.equal("MPa", unit("Pa", 5.5e7))
    assert.equal("mm", unit("m", 0.0025))
    assert.equal("g", unit("kg", 0.012))
    assert.equal("kg", unit("kg", 3))
    assert.equal("cm³", unit("m3", 1e-4))
    assert.equal("mm²", unit("m²", 3e-5))
    assert.equal("µs", unit("s", 3e-5))
    assert.equal("s", unit("s", 5e4))
    assert.equal("mm/s", unit("m/s", 0.02))
    assert.equal("10⁻⁹", unit("", 3e-7 / 100))
    assert.equal("inch", unit("inch", 5))
    assert.near(1000, numbers.unit("kg", 0.012), 1e-9)
    assert.equal("55 MPa", numbers.quantity(55e6, "Pa"))
    assert.equal("−1.5·10⁻⁷", numbers.quantity(-1.5e-7, ""))
  end)
end)

describe("a plot", function()
  it("has its points where its axes say", function()
    local figure = bw.plot.scatter {series = {{x = {1, 2, 4}, y = {10, 30, 20}}},
      x = {label = "a", least = 0, most = 5}, y = {label = "b", least = 0, most = 40}}
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
    check.raises("a log axis shows numbers above 0, and there is none", bw.plot.lines,
      {series = {{y = {-1, -2}}}, y = {scale = "log"}})
    svg_of(bw.plot.lines {series = {{name = "bad \xff \1 bytes", y = {1, 2}}}})
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
    check.raises("series 1: x has 2 numbers, y has 3", bw.plot.lines, {series = {{x = {1, 2}, y = {1, 2, 3}}}})
    check.raises("series 2: unknown option 'color': did you mean 'colour'", bw.plot.lines,
      {series = {{y = {1}}, {y = {1}, color = "red"}}})
    check.raises("entry 2: a number expected, got string", bw.plot.lines, {series = {{y = {1, "2"}}}})
    check.raises("'logarithmic' is not known", bw.plot.lines, {series = {{y = {1}}}, x = {scale = "logarithmic"}})
    check.raises("least 3 must be below most 2", bw.plot.lines, {series = {}, x = {least = 3, most = 2}})
    check.raises("#rrggbb", bw.plot.lines, {series = {{y = {1}, colour = "red"}}})
  end)
end)

describe("a canvas", function()
  it("checks what it is given", function()
    local canvas <close> = assert(bw.canvas(100, 50, {name = "x"}))
    assert.equal(100, canvas.width)
    assert.equal(canvas, canvas:line({{1, 2}, {3, 4}}, {stroke = "#ff0000", dash = {3, 2}}))
    check.raises("is not even", canvas.line, canvas, {1, 2, 3})
    check.raises("a colour \"#rrggbb\"", canvas.line, canvas, {1, 2}, {stroke = "red"})
    check.raises("dash", canvas.line, canvas, {1, 2}, {dash = {1}})
    check.raises("did you mean 'disc'", canvas.markers, canvas, "disk", 3, {1, 2})
    check.raises("a finite number", canvas.text, canvas, "x", 0 / 0, 1)
    check.raises("no rows of 3 pixels", canvas.pixels, canvas, "12345678", 3, 0, 0, 1, 1)
    check.raises("left", canvas.leave, canvas)
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
