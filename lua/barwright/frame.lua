-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What one frame of an analysis that follows an outline reused and what it cost.

local reuse_meta = {}

--- One line: level, what was reused, iterations.
function reuse_meta:__tostring()
  local parts = {}
  if self.level == "none" then
    parts[1] = "mesh"
  elseif self.level ~= "reconstruction" then
    parts[1] = "nodes"
  end
  if self.pattern then parts[#parts + 1] = "pattern" end
  if self.factor and self.factorisations == 0 then parts[#parts + 1] = "factor" end
  if self.solution then parts[#parts + 1] = "solution" end
  return ("%s%s; reused %s; %d factorisation%s, %d iteration%s"):format(self.level,
    self.flips > 0 and (" (%d flips)"):format(self.flips) or "",
    #parts > 0 and table.concat(parts, ", ") or "nothing",
    self.factorisations, self.factorisations == 1 and "" or "s",
    self.iterations, self.iterations == 1 and "" or "s")
end

return function()
  return setmetatable({level = "none", flips = 0, solves = 0, factorisations = 0, iterations = 0},
    reuse_meta)
end

