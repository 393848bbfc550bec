-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The stress that a failure criterion looks at, with its name: of rows of stress tensors.
local core = require "barwright.core"

local measures = {
  principal = {name = "largest principal stress", of = core.max_principal},
  von_mises = {name = "von Mises stress", of = core.von_mises},
}

--- {name =, of = function(stress)} of "von_mises" or "principal"; the latter by default.
return function(failure)
  return measures[failure or "principal"]
end
