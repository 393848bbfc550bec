-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Verifies flow and heat and writes a part of the verification manual; exits with 1 when a figure is not
-- within what is allowed.
--   build/barwright scripts/verification/flow.lua [--full] [--only TEXT] [--out FILE]
-- --full: finer elements and steps for the shed vortices, 10,000 random drags. --only: parts whose name
-- holds the text; nothing is written then.
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. package.path
local manual = require "manual"

io.stdout:setvbuf "line"
local wish = require "arguments" {full = true, only = "value", out = "value"}
local out, only = wish.out or "docs/verification_flow.md", wish.only

local page = manual.new("Flow and heat", ("Made by `build/barwright scripts/verification/flow.lua%s`. Theory: "
  .. "[responsive.md](theory/responsive.md)."):format(wish.full and " --full" or ""))
for _, name in ipairs {"squares", "cylinder", "drags"} do
  if not only or name:find(only, 1, true) then page:section(name, require("flow_" .. name), wish) end
end
os.exit(page:finish(not only and out or nil) and 0 or 1, true)
