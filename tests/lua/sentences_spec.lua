-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- scripts/check_sentences counts prose only, and names long sentences by file and line. Every page keeps to its
-- aim.
local check = require "check"

local page = [[
# A heading of five words

One two three. Four `a long piece of code` [link text](of/a/long address.md) $x = y$ end!

```sh
code that does not count. at all.
```

| a table | does not count. |
|---|---|
- item without a stop
- ]] .. ("word "):rep(20) .. "\n  " .. ("word "):rep(21) .. "stop.\n"

describe("sentences", function()
  it("are counted without code, tables, formulas and list markers", function()
    local path = check.folder() .. "/page.md"
    check.write(path, page)
    local status, out, complaint = check.run("scripts/check_sentences --long " .. path)
    assert.message(complaint).equal(0, status)
    -- 3, 5 (Four, code, link, text, end), 4 and 42 words
    local count, mean, largest, aim, over = out:match "page%.md +(%d+) +([%d.]+) +(%d+) +(%d+) +(%d+)"
    assert.same({"4", "13.5", "42", "20", "1"}, {count, mean, largest, aim, over}, out)
    assert.truthy(out:find("page.md:12: 42 words: word", 1, true), out)
  end)

  it("have at most 40 words on every page, and a mean within the aim of the page", function()
    local status, out, complaint = check.run "scripts/check_sentences --long"
    assert.message(complaint).equal(0, status)
    local pages, failed = 0, {}
    for line in out:gmatch "[^\n]+" do
      local name, mean, aim, over = line:match "^(%S+%.md) +%d+ +([%d.]+) +%d+ +(%d+) +(%d+)$"
      if name then
        pages = pages + 1
        if tonumber(mean) > tonumber(aim) or over ~= "0" then failed[#failed + 1] = line end
      elseif line:find "^%S+%.md:%d+: " then
        failed[#failed + 1] = line
      end
    end
    assert.is_true(pages > 40, out)
    assert.equal("", table.concat(failed, "\n"))
  end)
end)
