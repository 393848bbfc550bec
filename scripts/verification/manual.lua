-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A part of the verification manual: sections of rows {quantity, figure, "at most" | "at least", bound, how}
-- and of plain tables, printed as they come, written at the end.
local bw = require "barwright"

local manual = {}
manual.__index = manual

--- `title` of the page, `about`: what made it.
function manual.new(title, about)
  local self = setmetatable({lines = {}, count = 0, failed = 0}, manual)
  self:write("## %s\n\n%s\n", title, about)
  return self
end

function manual:write(...)
  self.lines[#self.lines + 1] = (...):format(select(2, ...))
end

local function number(x)
  if math.type(x) == "integer" then return tostring(x) end
  return ("%.4g"):format(x)
end

function manual:row(part, row)
  local quantity, figure, word, bound, how = table.unpack(row, 1, 5)
  local good = word == "at most" and figure <= bound or word == "at least" and figure >= bound
  local allowed = word .. " " .. number(bound)
  self.count, self.failed = self.count + 1, self.failed + (good and 0 or 1)
  self:write("| %s | %s%s | %s | %s |", quantity, number(figure), good and "" or " **outside**",
    allowed, how or "")
  print(("%s %s: %s (%s; %s)"):format(good and "ok" or "OUTSIDE", quantity, number(figure), allowed, how or part))
end

function manual:table(heads, rows)
  self:write("| %s |", table.concat(heads, " | "))
  self:write("|%s", ("---|"):rep(#heads))
  for _, row in ipairs(rows) do
    self:write("| %s |", table.concat(row, " | "))
    print("   " .. table.concat(row, ", "))
  end
  self:write ""
end

--- A part {title, text, run}: run(wish) returns rows and tables {text, heads, rows}.
function manual:section(name, part, wish)
  local start = bw.seconds()
  local rows, tables = part.run(wish)
  print(("   %s took %.0f s"):format(name, bw.seconds() - start))
  if not rows then return end
  self:write("### %s\n\n%s\n", part.title, part.text)
  if #rows > 0 then
    self:write "| quantity | figure | allowed | how |"
    self:write "|---|---|---|---|"
    for _, row in ipairs(rows) do self:row(part.title, row) end
    self:write ""
  end
  for _, t in ipairs(tables or {}) do
    if t.text then self:write("%s\n", t.text) end
    self:table(t.heads, t.rows)
  end
end

--- Says how many were good; writes the page, unless `out` is nil. True where all were.
function manual:finish(out)
  print(("%d of %d within what is allowed"):format(self.count - self.failed, self.count))
  if out then
    local file = assert(io.open(out .. ".partial", "w"))
    file:write(table.concat(self.lines, "\n"), "\n")
    file:close()
    assert(os.rename(out .. ".partial", out))
    print("wrote " .. out)
  end
  return self.failed == 0
end

return manual
