-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The progress of work over several meshes as one: which mesh of how many, and a fraction of the whole that never
-- goes back. What a mesh takes is known from those before it: the time grows with the number of elements.
local core = require "barwright.core"

local mesh_progress = {}
mesh_progress.__index = mesh_progress

-- Of the time predicted, a mesh that is not done has taken at most this fraction; likewise the whole.
local MAX = 0.95

-- Seconds that so many elements will take; nil before a mesh is done.
local function expected(self, elements)
  return self.done_elements > 0 and self.done_seconds * elements / self.done_elements or nil
end

local function fraction_of(self)
  local mesh = expected(self, self.elements)
  if not mesh then return 0 end
  local spent = math.min(core.seconds() - self.start, MAX * mesh)
  local whole = self.done_seconds + mesh + expected(self, self.planned)
  self.shown = math.max(self.shown, math.min(MAX, (self.done_seconds + spent) / whole))
  return self.shown
end

local function finish_mesh(self)
  if not self.elements then return end
  self.done_seconds = self.done_seconds + core.seconds() - self.start
  self.done_elements = self.done_elements + self.elements
end

--- A mesh of so many elements begins; `planned`: the numbers of elements of those that follow for sure; open:
--- others may follow, of which one is expected.
function mesh_progress:mesh(elements, planned, open)
  finish_mesh(self)
  self.start, self.elements, self.planned = core.seconds(), elements, 0
  for _, count in ipairs(planned) do self.planned = self.planned + count end
  if open then self.planned = self.planned + (planned[#planned] or elements) end
  self.count = self.count + 1
  self.name = ("%s; %s %d of %s%d"):format(self.work, self.part, self.count,
    self.max and "at most " or open and "at least " or "", self.count + #planned)
end

--- From here on the progress is that of the work, until the object is closed. `part` is what it names in place
--- of meshes; `max`: fewer than those that are planned may follow.
function mesh_progress.open(work, part, max)
  local self = setmetatable({work = work, part = part or "mesh", max = max, count = 0, shown = 0,
    done_seconds = 0, done_elements = 0}, mesh_progress)
  self.before = core.progress(function(stage, fraction)
    if self.elements then stage, fraction = ("%s, %s"):format(self.name, stage), fraction_of(self) end
    if self.before then return self.before(stage, fraction) end
    core.report_progress(stage, fraction)
  end)
  return self
end

function mesh_progress:close()
  core.progress(self.before)
end
mesh_progress.__close = mesh_progress.close

return mesh_progress
