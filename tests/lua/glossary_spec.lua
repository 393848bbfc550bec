-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The glossary: every concept once, in order, and under the names that the API has.
local check = require "check"
package.path = check.root .. "/scripts/docs/?.lua;" .. package.path
local stubs = require "stubs"

local text = check.read(check.root .. "/docs/glossary.md"):match "\n| term |.-\n\n"

-- The cells of a row; `\|` is no border.
local function cells(row)
  local list = {}
  for cell in row:gsub("\\|", "\1"):gsub("^|%s*", ""):gmatch "(.-)%s*|%s*" do list[#list + 1] = cell end
  return list
end

local rows = {}
for line in text:gmatch "[^\n]+" do rows[#rows + 1] = line:sub(1, 1) == "|" and cells(line) or nil end
local columns = table.remove(rows, 1)
table.remove(rows, 1)

-- Everything that a stub, a public header or a command declares.
local function names_of_the_api()
  local names = {}
  local all = stubs.read(check.root .. "/lua/stubs")
  for _, file in ipairs(all.files) do
    for _, class in ipairs(file.classes) do
      names[class.name] = true
      local spoken = stubs.spoken(all, class)
      local short = class.name:match "[^.]*$"
      for _, field in ipairs(class.fields) do
        names[field.name] = true
        names[spoken .. "." .. field.name] = true
        for word in field.type:gmatch '"[^"]*"' do names[word] = true end
      end
      for _, f in ipairs(class.functions) do
        for _, owner in ipairs {spoken, short, class.name} do
          names[owner .. (f.colon and ":" or ".") .. f.name] = true
          if f.name == "__call" then names[owner] = true end
        end
      end
    end
  end
  local pipe = assert(io.popen(("cat '%s'/engine/include/barwright/*.h"):format(check.root)))
  for name in pipe:read("a"):gmatch "bw_[%w_]+" do names[name] = true end
  pipe:close()
  pipe = assert(io.popen(("ls '%s'/lua/barwright/command; cat '%s'/lua/barwright/command/*.lua"):format(check.root,
    check.root)))
  local sources = pipe:read "a"
  pipe:close()
  for command in sources:gmatch "([%w_]+)%.lua" do names[command] = true end
  for option in sources:gmatch '[%[{ ]"?([%l_]+)"?%]? ?= ?{' do names["--" .. option:gsub("_", "-")] = true end
  for option in sources:gmatch 'name = "([%l-]+)"' do names["--" .. option] = true end
  return names
end

describe("the glossary", function()
  it("has one row for each term, in order, with meaning and source", function()
    assert.same({"term", "meaning", "symbol", "unit", "in the API", "source"}, columns)
    assert.is_true(#rows > 150)
    for i, row in ipairs(rows) do
      assert.equal(#columns, #row, row[1])
      assert.truthy(row[2] ~= "" and row[5] ~= "" and row[6] ~= "", row[1] .. ": an empty cell")
      if i > 1 then
        local before, term = rows[i - 1][1]:lower(), row[1]:lower()
        assert.is_true(before < term, ("'%s' stands behind '%s'"):format(row[1], rows[i - 1][1]))
      end
    end
  end)

  it("names what the API has", function()
    local names, wrong = names_of_the_api(), {}
    for _, row in ipairs(rows) do
      for name in row[5]:gmatch "`([^`]+)`" do
        if not names[name] then wrong[#wrong + 1] = row[1] .. ": " .. name end
      end
    end
    assert.same({}, wrong)
  end)
end)

describe("stages of progress", function()
  it("are nouns or present participles", function()
    local verbs = {"fill", "order", "factor", "assemble", "iterate", "load", "solve", "refine", "search", "tune",
      "thicken", "remesh", "refill"}
    local bare, count = {}, 0
    for _, verb in ipairs(verbs) do bare[verb] = true end
    local list <close> = assert(io.popen(("grep -rhE 'bw_progress\\(|report_progress\\(' "
      .. "'%s/engine' '%s/lua'"):format(check.root, check.root)))
    for line in list:lines() do
      for stage in line:gmatch '"([^"]+)"' do
        count = count + 1
        assert.is_nil(bare[stage], line)
      end
    end
    assert.is_true(count > 30)
  end)
end)
