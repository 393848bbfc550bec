-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- scripts/reproduce at a tiny scale: parts run, are kept, fail alone; what stands beside printed numbers
-- comes from their results.
local check = require "check"
local json = require "barwright.json"
package.path = check.root .. "/scripts/reproduction/?.lua;" .. package.path
local parts = require "parts"
local printed = require "printed"

local function reproduce(words)
  return check.run(("%s/scripts/reproduction/run.lua %s"):format(check.root, words))
end

local function result_of(folder)
  return json.decode(check.read(folder .. "/tiny/result.json"))
end

local function row_of(result, what)
  for _, about in ipairs(result.tables) do
    for _, row in ipairs(about.rows) do
      if row.what == what then return row end
    end
  end
end

describe("scripts/reproduce", function()
  it("runs parts once, and what changed again", function()
    local folder = check.folder()
    local status, out, err = reproduce(("--tiny --only brute --out %s"):format(folder))
    assert.equal(0, status, out .. err)
    assert.truthy(out:find("worst_case_brute_force     done", 1, true), out)
    assert.truthy(out:find("not asked for", 1, true), out)
    local result = result_of(folder)
    local row = assert(row_of(result, "2723 tetrahedra: brute force"))
    local own = json.decode(check.read(folder .. "/tiny/worst_case_brute_force/result.json"))
    assert.equal(own.rows[1].seconds_brute_force, row.ours_timed)
    assert.equal(681.367, row.printed)
    assert.is_nil(row.want) -- smaller than the printed one: not compared
    assert.equal("not in this run", row_of(result, "2869 tetrahedra: brute force").why)
    assert.equal("not asked for", row_of(result, "relocation").why)
    assert.equal("not run at this scale", row_of(result, "2723 tetrahedra").why)
    local page = check.read(folder .. "/tiny/index.html")
    for _, part in ipairs {"681.4 s", "three tenths", "Parts", json.decode(check.read(folder
      .. "/tiny/manifest.json")).version} do
      assert.truthy(page:find(part, 1, true), part)
    end
    assert.falsy(page:find "https?://")
    -- again: kept
    status, out = reproduce(("--tiny --only brute --out %s"):format(folder))
    assert.equal(0, status)
    assert.truthy(out:find("worst_case_brute_force     kept", 1, true), out)
    local _
    _, out = reproduce(("--tiny --only brute --again --out %s"):format(folder))
    assert.truthy(out:find("worst_case_brute_force     done", 1, true), out)
    -- of another commit: run again
    local path = folder .. "/tiny/worst_case_brute_force/part.json"
    check.write(path, (check.read(path):gsub('"key": "', '"key": "older ')))
    _, out = reproduce(("--tiny --only brute --out %s"):format(folder))
    assert.truthy(out:find("worst_case_brute_force     done", 1, true), out)
    -- another part: what was there before stays in the page
    status, out = reproduce(("--tiny --only cantilever --out %s"):format(folder))
    assert.equal(0, status, out)
    result = result_of(folder)
    assert.equal("number", type(row_of(result, "2723 tetrahedra: brute force").ours_timed))
    assert.equal("number", type(row_of(result, "cantilever: with reuse").ours_timed))
  end)

  it("refuses what it does not know", function()
    local status, _, err = reproduce "--quik"
    assert.equal(2, status)
    assert.truthy(err:find("did you mean --quick?", 1, true), err)
    assert.equal(2, (reproduce("--tiny --only nothing --out " .. check.folder())))
    local out
    status, out = reproduce "--full --list"
    assert.equal(0, status)
    assert.truthy(out:find("data_driven_fibers", 1, true))
  end)

  it("has a part for every number that is to be had, at the full scale", function()
    local known = {}
    for _, part in ipairs(parts.of "full") do
      assert.is_nil(part.smaller, part.name)
      known[part.name] = true
    end
    local count = 0
    for _, about in ipairs(printed.tables) do
      for _, row in ipairs(about.rows) do
        assert.equal("number", type(row.printed), row.what)
        if row.part then assert.truthy(known[row.part], row.part) end
        count = count + 1
      end
    end
    assert.truthy(count > 200, count)
    for _, scale in ipairs(parts.scales) do
      local before = {}
      for _, part in ipairs(parts.of(scale)) do
        assert.is_nil(before[part.name])
        assert.truthy(not part.after or before[part.after])
        before[part.name] = true
      end
    end
  end)
end)
