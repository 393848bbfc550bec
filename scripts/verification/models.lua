-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Runs the worst-case analysis on every file of a folder of models and writes two tables, of the good
-- files and of the others, as a part of the verification manual.
--   build/barwright scripts/verification/models.lua FOLDER [--elements 30000] [--out docs/models.md]
local bw = require "barwright"

local folder = assert(arg[1], "usage: models.lua FOLDER [--elements N] [--out FILE]")
local elements, out = 30000, "docs/verification_models.md"
for i, a in ipairs(arg) do
  if a == "--elements" then elements = tonumber(arg[i + 1]) end
  if a == "--out" then out = arg[i + 1] end
end

local formats = {stl = true, obj = true, ply = true, off = true, msh = true, vtu = true}
local files = {}
local list = assert(io.popen(("ls '%s'"):format(folder)))
for name in list:lines() do
  if formats[name:match "%.(%a+)$" or ""] then files[#files + 1] = name end
end
list:close()

local function read(path)
  local file = io.open(path, "rb")
  if not file then return nil end
  local text = file:read "a"
  file:close()
  return text
end

local scratch = os.tmpname()
os.remove(scratch)
local good, others = {}, {}
for _, name in ipairs(files) do
  local start = bw.seconds()
  local _, _, code = os.execute(
    ("BARWRIGHT_QUIET=1 build/barwright scripts/worst_case/run.lua '%s/%s' --elements %d " ..
      "--out '%s' >'%s.out' 2>'%s.err' </dev/null"):format(folder, name, elements, scratch, scratch, scratch))
  local seconds = bw.seconds() - start
  local text = code == 0 and read(scratch .. "/result.json")
  local result = text and bw.json.decode(text)
  local complaint = (read(scratch .. ".err") or ""):gsub("%s+", " "):gsub("^worst_case: ", "")
  complaint = complaint:gsub(folder:gsub("%p", "%%%0") .. "/", "")
  local row = {name = name, code = code, seconds = seconds, result = result, complaint = complaint}
  local bucket = (name:match "^bad_" or name:match "^ok_") and others or good
  bucket[#bucket + 1] = row
  print(name, code, ("%.1f s"):format(seconds), complaint)
  os.execute(("rm -rf '%s' '%s.out' '%s.err'"):format(scratch, scratch, scratch))
end

local lines = {}
local function write(...) lines[#lines + 1] = (...):format(select(2, ...)) end
local function stress(r)
  return ("%.3g MPa at (%.3g, %.3g, %.3g) mm"):format(r.max_principal_pa / 1e6,
    r.max_principal_at_m[1] * 1e3, r.max_principal_at_m[2] * 1e3, r.max_principal_at_m[3] * 1e3)
end
local function filling(r)
  return (r.seconds_fill or 0) + (r.seconds_remesh or 0) + (r.seconds_repair or 0)
end

write "## Real models"
write ""
write("Made by `build/barwright scripts/verification/models.lua FOLDER`; %d elements were asked for;", elements)
write "files without units taken as millimetres; PLA; 15 modes, 5 regions each; 20 N (less where the"
write "surface is small) and 0.2 MPa."
write ""
write "| file | elements | repaired | moved, of the box | weakest place | seconds | of which filling |"
write "|---|---|---|---|---|---|---|"
for _, row in ipairs(good) do
  local r = row.result
  if r then
    local d = 0
    for k = 1, 3 do d = d + (r.box_high_m[k] - r.box_low_m[k]) ^ 2 end
    write("| %s | %d | %s | %.2g | %s | %.1f | %.1f |", row.name, r.elements,
      r.repaired and "yes" or "no", r.surface_moved_m / math.sqrt(d), stress(r), row.seconds, filling(r))
  else
    write("| %s | | | | exit status %d: %s | %.1f | |", row.name, row.code, row.complaint, row.seconds)
  end
end
write ""
write "Difficult, broken or oddly written files: repaired with a statement, or refused in one sentence."
write ""
write "| file | status | what came of it |"
write "|---|---|---|"
for _, row in ipairs(others) do
  local r = row.result
  if r then
    local steps = {}
    for _, step in ipairs(r.surface_steps or r.steps or {}) do steps[#steps + 1] = step.name end
    write("| %s | 0 | %d elements, %s%s; %s |", row.name, r.elements,
      r.repaired and "repaired" or "as it is",
      #steps > 0 and (" (" .. table.concat(steps, ", ") .. ")") or "", stress(r))
  else
    write("| %s | %d | %s |", row.name, row.code, (row.complaint:gsub("|", "\\|")))
  end
end
write ""
local file = assert(io.open(out .. ".partial", "w"))
file:write(table.concat(lines, "\n"), "\n")
file:close()
assert(os.rename(out .. ".partial", out))
