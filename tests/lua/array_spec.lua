-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
local bw = require "barwright"
local check = require "check"

describe("an array", function()
  local a = bw.array {3, 1, 2}
  local m = bw.array {{1, 2}, {3, 4}, {5, 6}}

  it("is made from tables, and says what it is", function()
    assert.equal(3, #a)
    assert.equal(1, a.column_count)
    assert.equal(2, m.column_count)
    assert.equal("f64", m.type)
    assert.equal("i32", bw.array.new({1, 2}, "i32").type)
    assert.equal("array of 3 x 2 f64: {{1, 2}, {3, 4}, {5, 6}}", tostring(m))
    assert.same({{1, 2}, {3, 4}, {5, 6}}, m:totable())
    assert.same({0, 0}, bw.array.zeros(2):totable())
    assert.same({2, 4, 6}, bw.array.range(2, 7, 2):totable())
    assert.equal(11, #bw.array.range(0, 1, 0.1))
    assert.equal(0, #bw.array {})
  end)

  it("counts rows and columns from 1", function()
    assert.equal(3, a[1])
    assert.equal(4, m[2][2])
    assert.equal(2, #m[2])
    assert.equal(6, m(3, 2))
    check.raises("row: a number from 1 to 3 expected, got 4", function() return a[4] end)
    check.raises("column: a number from 1 to 2 expected, got 0", m, 1, 0)
    check.raises("did you mean 'mean'", function() return a.maen end)
    check.raises("cannot be changed by assignment", function() a[1] = 5 end)
  end)

  it("has views that share memory", function()
    assert.same({2, 4, 6}, m:column(2):totable())
    assert.same({{5, 6}, {3, 4}}, m:rows(3, 2, -1):totable())
    assert.same({{2, 1}, {4, 3}, {6, 5}}, m:columns(2, 1, -1):totable())
    assert.same({1, 2}, a:rows(-2):totable())
    assert.same({}, a:rows(3, 2):totable())
    assert.same({3}, a:rows(1, 1, math.maxinteger):totable())
    assert.same({{3, 4}}, m:rows(2, -1, 1 << 62):totable())
    assert.same({4}, m:rows(2, 2):column(2):totable())
    assert.same({{1, 2}}, m:rows(1, 3, math.maxinteger):totable())
    assert.same({{5, 6}}, m:rows(3, 1, math.mininteger):totable())
    check.raises("rows or columns from 1 to 3 expected, got 1 to 4", a.rows, a, 1, 4)
    check.raises("sizes must be 0 or more, and its bytes must fit", bw.array.zeros, 0, 1 << 62, "i32")
    check.raises("from 1 to 2 expected", m.columns, m, math.mininteger, math.maxinteger)
  end)

  it("is reduced", function()
    assert.equal(1, a:min())
    assert.equal(3, a:max())
    assert.equal(21, m:sum())
    assert.equal(2, a:mean())
    assert.equal(2.5, a:mean(bw.array {3, 0, 3}))
    assert.equal(math.sqrt(14), a:norm())
    assert.equal(14, a:dot(a))
    assert.same({9, 12}, m:column_sums())
    local row, column = m:argmax()
    assert.same({3, 2}, {row, column})
    assert.equal(2, (a:argmin()))
    assert.is_nil(bw.array {}:max())
    -- the sum of many small numbers beside a large one keeps them
    assert.equal(2, bw.array {1, 1e100, 1, -1e100}:sum())
    -- NaN is passed over by extremes
    assert.equal(2, bw.array {0 / 0, 2, 1}:max())
    -- squares beyond the largest double
    check.near(5e200, bw.array {3e200, 4e200}:norm(), 1e-15)
  end)

  it("has an order", function()
    assert.same({1, 2, 3}, a:sorted():totable())
    assert.same({2, 3, 1}, a:order():totable())
    assert.equal(2, a:quantile(0.5))
    assert.equal(1.5, a:quantile(0.25))
    assert.equal(3, a:quantile(1))
    assert.equal(math.huge, bw.array {1, math.huge, math.huge}:quantile(0.7))
    check.raises("fraction from 0 to 1", a.quantile, a, 1.5)
    check.raises("NaN", bw.array {0 / 0}.sorted, bw.array {0 / 0})
  end)

  it("is gathered, selected, scattered", function()
    assert.same({2, 3, 3}, a:gather({3, 1, 1}):totable())
    assert.same({{5, 6}}, m:gather(bw.array.new({3}, "i32")):totable())
    assert.same({3, 2}, a:select(a:above(1)):totable())
    assert.same({1, 3}, a:above(1):where():totable())
    assert.same({2}, a:below(2):where():totable())
    assert.same({0, 3, 1, 0, 2}, a:scatter({2, 3, 5}, 5):totable())
    check.raises("count from 1", a.gather, a, {0})
    check.raises("rows from 1 to 3 expected, got 9", a.gather, a, {9})
    check.raises("3 rows expected, got 2", a.select, a, bw.array {1, 0})
  end)

  it("has arithmetic", function()
    assert.same({4, 2, 3}, (a + 1):totable())
    assert.same({6, 2, 4}, (2 * a):totable())
    assert.same({0, 0, 0}, (a - a):totable())
    assert.same({9, 1, 4}, (a ^ 2):totable())
    assert.same({-3, -1, -2}, (-a):totable())
    assert.same({1.5, 0.5, 1}, (a / 2):totable())
    assert.same({{3, 6}, {3, 4}, {10, 12}}, (m * a):totable()) -- one column fits all
    check.raises("arrays of equally many rows expected, got 3 and 2", function() return a + bw.array {1, 2} end)
    check.raises("an array or a number expected beside an array, got string 'x'", function() return a + "x" end)
  end)

  it("goes to bytes and back", function()
    for _, format in ipairs {"<f8", ">f8", "<f4", ">f4", "<i2", ">u4", "<u1", "<i8"} do
      local bytes = m:tostring(format)
      assert.equal(6 * tonumber(format:sub(3)), #bytes)
      assert.same({{1, 2}, {3, 4}, {5, 6}}, bw.array.from_string(format, bytes, 2):totable())
    end
    assert.equal("\1\0\0\0", bw.array {1}:tostring "<i4")
    assert.equal("\0\0\0\1", bw.array {1}:tostring ">i4")
    assert.equal("\0\0\0\0", bw.array {1}:tostring("<u4", -1))
    assert.equal(string.pack("<d", math.pi), bw.array {math.pi}:tostring "<f8")
    assert.same({-2}, bw.array.from_string("<i2", "\254\255"):totable())
    check.raises("does not fit", a.tostring, bw.array {300}, "<u1")
    check.raises("byte format", a.tostring, a, "double")
    check.raises("whole rows of 8 bytes expected", bw.array.from_string, "<f8", "abc")
  end)

  it("says what is wrong with a table", function()
    check.raises("entry 2: a number of type f64 expected", bw.array, {1, "2"})
    check.raises("row 2: a table of 2 numbers expected, got 1", bw.array, {{1, 2}, {3}})
    check.raises("entry (1, 2)", bw.array, {{1, {}}})
    check.raises("entry 1: a number of type u8 expected, got 256", bw.array.new, {256}, "u8")
    check.raises("entry 1: a number of type i32 expected, got 1.5", bw.array.new, {1.5}, "i32")
  end)

  it("can be closed, and is then of no use", function()
    local b = bw.array {1}
    do
      local _ <close> = b
    end
    assert.equal("array (closed)", tostring(b))
    check.raises("closed", function() return #b end)
    check.raises("closed", function() return b.type end)
    b:close() -- again: nothing
  end)
end)

describe("a formula", function()
  local x = bw.array {1, 2, 3}
  local v = bw.array {{1, 2, 2}, {0, 3, 4}}

  it("is mapped over arrays", function()
    assert.same({3, 5, 7}, x:map("a*2 + b", {b = 1}):totable())
    assert.same({3, 5, 7}, bw.array.map("2*x + one", {x = x, one = bw.array {1, 1, 1}}):totable())
    assert.same({3, 5}, v:map "norm(a)":totable())
    assert.same({5, 7}, v:map "a.y + a[2] - a.x*0 + a[1]*0 + where(a.x > 0, 1, 1)":totable())
    assert.same({{2, 4, 4}, {0, 6, 8}}, v:map "2*a":totable())
  end)

  it("has the precedence of Lua", function()
    local function value(text) return bw.array {0}:map(text)[1] end
    for text in ([[1+2*3; (1+2)*3; -2^2; 2^3^2; 2^-1; 7%3; -7%3; 10/4; 1-2-3; 2*3%4; 1e3+.5; - - 2;
      5e-1*4; 2^0.5*2^0.5]]):gmatch "[^;]+" do
      local expected = load("return " .. text)()
      check.near(expected, value(text), 1e-15)
    end
    for text in ([[1 < 2 and 3 >= 4 or not (1 == 2); 1 ~= 1 or 2 > 1; not 0 == 1; 1 <= 1]]):gmatch "[^;]+" do
      local lua = text:gsub("not 0 == 1", "(not false) == true")
      assert.equal(load("return " .. lua)() and 1 or 0, value(text), text)
    end
    assert.equal(math.pi, value "pi")
    check.near(math.atan(1, 2), value "atan2(1, 2)", 1e-15)
    assert.equal(3, value "where(1 > 2, 5, max(min(4, 3), -1))")
    assert.equal(5, value "hypot(3, 4)")
  end)

  it("makes masks of comparisons", function()
    local mask = x:map "a > 1 and a < 3"
    assert.equal("u8", mask.type)
    assert.same({0, 1, 0}, mask:totable())
    assert.equal("f64", x:map "a + (a > 1)".type)
  end)

  it("crosses the ends of blocks", function()
    local n = 1000
    local long = bw.array.range(1, n)
    local squares = long:map "a^2 - a"
    for i = 1, n do assert.equal(i * i - i, squares[i]) end
  end)

  it("says where it is wrong", function()
    local function wrong(text, formula, variables)
      check.raises(text, x.map, x, formula, variables)
    end
    wrong("'b' (known: a) at character 3", "a+b")
    wrong("operator expected at character 3", "a b")
    wrong("')' expected", "(a")
    wrong("unknown function at character 1", "foo(a)")
    wrong("no such column", "a[2]")
    wrong("no such column", "a.z")
    wrong("a number, a name or '(' expected at character 4", "a +")
    wrong("variable 'c': 3 rows expected", "a + c", {c = bw.array {1, 2}})
    wrong("an array or a number expected, got string", "a", {b = "x"})
    wrong("nested too deeply", ("("):rep(300) .. "a" .. (")"):rep(300))
    wrong("nested too deeply", ("a-("):rep(60) .. "a" .. (")"):rep(60))
    wrong("too long", "a" .. ("+a"):rep(300))
  end)
end)
