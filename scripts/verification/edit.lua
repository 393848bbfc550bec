-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Verifies edit sessions and writes a part of the verification manual; exits with 1 when a figure is
-- not within what is allowed.
--   build/barwright scripts/verification/edit.lua [--full] [--only TEXT] [--scene NAME]
--       [--models FOLDER] [--out FILE]
-- --full: 500 sequences of edits, scenes with the paper's numbers of elements. --only: parts whose
-- name holds the text; nothing is written then. --scene: one of scripts/agile instead of all; with
-- --json its rows go to standard output, on one thread.
-- --models: a folder of closed surfaces to find skeletons in.
local bw = require "barwright"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. folder .. "/../agile/?.lua;" .. package.path

io.stdout:setvbuf "line"
local wish = {models = os.getenv "BARWRIGHT_SHARED" or "../shared"}
wish.models = wish.models .. "/models"
local out, only = "docs/verification_edit.md", nil
for i, a in ipairs(arg) do
  if a == "--full" then wish.full = true end
  if a == "--only" then only = arg[i + 1] end
  if a == "--scene" then wish.scene = arg[i + 1] end
  if a == "--json" then wish.json = bw.threads(1) end
  if a == "--models" then wish.models = arg[i + 1] end
  if a == "--out" then out = arg[i + 1] end
end

local lines, count, failed = {}, 0, 0
local function write(...) lines[#lines + 1] = (...):format(select(2, ...)) end

local function number(x)
  if math.type(x) == "integer" then return tostring(x) end
  return ("%.3g"):format(x)
end

-- A row: {quantity, figure, "at most" | "at least", bound, how}.
local function show_row(part, row)
  local quantity, figure, word, bound, how = table.unpack(row, 1, 5)
  local good = word == "at most" and figure <= bound or word == "at least" and figure >= bound
  local allowed = word .. " " .. number(bound)
  count, failed = count + 1, failed + (good and 0 or 1)
  write("| %s | %s%s | %s | %s |", quantity, number(figure), good and "" or " **outside**", allowed, how or "")
  print(("%s %s: %s (%s; %s)"):format(good and "ok" or "OUTSIDE", quantity, number(figure), allowed,
    how or part))
end

local function show_table(heads, rows)
  write("| %s |", table.concat(heads, " | "))
  write("|%s", ("---|"):rep(#heads))
  for _, row in ipairs(rows) do
    write("| %s |", table.concat(row, " | "))
    print("   " .. table.concat(row, ", "))
  end
  write ""
end

write "## Edit sessions"
write ""
write("Made by `build/barwright scripts/verification/edit.lua%s`. Theory: [edit.md](theory/edit.md).",
  wish.full and " --full" or "")
write ""
local parts = {}
for _, name in ipairs {"equations", "calculix", "slopes", "optimum", "mending", "skeletons"} do
  local part = (not only or name:find(only, 1, true)) and require("edit_" .. name)
  if part then
    parts[#parts + 1] = {name, part}
    if part.begin then part.begin(wish) end
  end
end
if wish.json then
  for _, named in ipairs(parts) do print("rows " .. bw.json.encode((named[2].run(wish)))) end
  os.exit(0, true)
end
for _, named in ipairs(parts) do
  local name, part = named[1], named[2]
  local start = bw.seconds()
  local rows, tables = part.run(wish)
  print(("   %s took %.0f s"):format(name, bw.seconds() - start))
  if rows then
    write("### %s", part.title)
    write ""
    write("%s", part.text)
    write ""
    if #rows > 0 then
      write "| quantity | figure | allowed | how |"
      write "|---|---|---|---|"
      for _, row in ipairs(rows) do show_row(part.title, row) end
      write ""
    end
    for _, t in ipairs(tables or {}) do
      if t.text then write("%s\n", t.text) end
      show_table(t.heads, t.rows)
    end
  end
end

print(("%d of %d within what is allowed"):format(count - failed, count))
if not only then
  local file = assert(io.open(out .. ".partial", "w"))
  file:write(table.concat(lines, "\n"), "\n")
  file:close()
  assert(os.rename(out .. ".partial", out))
  print("wrote " .. out)
end
os.exit(failed == 0 and 0 or 1, true)
