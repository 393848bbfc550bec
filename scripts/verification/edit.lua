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
local manual = require "manual"

io.stdout:setvbuf "line"
local wish = require "arguments" {full = true, only = "value", scene = "value", json = true,
  models = "value", out = "value"}
wish.models = wish.models or (os.getenv "BARWRIGHT_SHARED" or "../shared") .. "/models"
if wish.json then wish.json = bw.threads(1) end
local out, only = wish.out or "docs/verification_edit.md", wish.only

local page = manual.new("Edit sessions", ("Made by `build/barwright scripts/verification/edit.lua%s`. Theory: "
  .. "[edit.md](theory/edit.md)."):format(wish.full and " --full" or ""))
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
for _, named in ipairs(parts) do page:section(named[1], named[2], wish) end
os.exit(page:finish(not only and out or nil) and 0 or 1, true)
