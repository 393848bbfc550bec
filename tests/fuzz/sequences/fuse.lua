-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Functions for conditions and places that raise once so many calls of them were made.
local fuse = {}

local left = math.huge

--- Each call of a function from now on counts.
function fuse.light(calls) left = calls end

function fuse.out() left = math.huge end

--- A function of whatever that returns `value()`.
function fuse.around(value)
  return function(...)
    left = left - 1
    if left < 0 then error("the fuse has burnt", 0) end
    return value(...)
  end
end

return fuse
