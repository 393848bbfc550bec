-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- How lists of good arguments are made, and what they share.
local bw = require "barwright"

local good = {list = {}}

-- Names with a function each.
function good.add(list)
  for name, make in pairs(list) do good.list[name] = make end
end

-- Several names with the same arguments.
function good.alike(names, make)
  for name in names:gmatch "%S+" do good.list[name] = make end
end

function good.random_mask(n, r)
  local mask = {}
  for i = 1, n do mask[i] = r:chance(0.5) and 1 or 0 end
  return bw.array.new(mask, "u8")
end

function good.vector(r)
  return {r:uniform(), r:uniform(), r:uniform()}
end

function good.pair(r)
  return {r:uniform(), r:uniform() / 2}
end

-- "out." with one of the endings.
function good.path(endings)
  return function(r) return "out." .. r:one_of(endings) end
end

return good
