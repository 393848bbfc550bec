-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Options that several benchmarks have, as rules of lua/barwright/command/arguments.lua.
local options = {}

options.only = {name = "only", value = "NAME", what = "only what has this name"}
options.containing = {name = "only", value = "TEXT", what = "only bodies whose name contains this text"}
options.unseen = {name = "unseen", type = "flag",
  what = "the parts of scripts/worst_case/unseen_parts.lua instead, which the methods were not developed on"}
options.models = {name = "models", value = "DIR", type = "folder",
  what = "a folder with the surfaces that the script names"}

--- The number of elements that a mesh is asked for.
function options.elements(default)
  return {name = "elements", value = "N", type = "integer", default = default, min = 1,
    what = "number of elements that a mesh is asked for"}
end

--- Several of them, with commas between.
function options.each_of_elements(default)
  return {name = "elements", value = "N,N,...", type = "integer", list = true, default = default, min = 1,
    what = "numbers of elements that meshes are asked for"}
end

return options
