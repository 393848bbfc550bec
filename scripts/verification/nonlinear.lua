-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Verifies nonlinear solids and writes a part of the verification manual; exits with 1 when a figure is
-- not within what is allowed.
--   build/barwright scripts/verification/nonlinear.lua [--full] [--only TEXT] [--out FILE]
-- --full: finer grids and more of them. --only: parts whose name holds the text; nothing is written then.
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. package.path
local manual = require "manual"

io.stdout:setvbuf "line"
local wish = require "arguments" {full = true, only = "value", out = "value"}

local page = manual.new("Nonlinear solids", ("Made by `build/barwright scripts/verification/nonlinear.lua%s`. "
  .. "Theory: [data_driven.md](theory/data_driven.md). Tables with references come from the engine's tests, "
  .. "which check more than can be a row. Grids are the only meshes of nonlinear solids: bodies with other sides "
  .. "lie in cells that count by the part inside."):format(wish.full and " --full" or ""))
for _, name in ipairs {"engine", "bars", "contact", "motion"} do
  if not wish.only or name:find(wish.only, 1, true) then
    local parts = require("nonlinear_" .. name)
    for _, part in ipairs(parts) do page:section(name, part, wish) end
  end
end
os.exit(page:finish(not wish.only and (wish.out or "docs/verification_nonlinear.md") or nil) and 0 or 1, true)
