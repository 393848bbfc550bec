-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
local acting = require "acting"

return require "flow_kind"("thermal", {"velocity", "pressure", "temperature", "time"}, {diffusivity = 0.1,
  expansion = 1e-3, gravity = {0, -9.81}, conditions = {right = {x = 0, y = 0, temperature = 0},
    left = {x = 0.1, y = 0, temperature = acting.function_of_load}}})
