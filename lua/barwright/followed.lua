-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What sheets, plates and flows that follow an outline have in common. Each is an engine object `body` with its
-- mesh motion, and the reuse statistics of the last frame.
--
-- An object holds its last good state: what the outline, the mesh or the solution refuses returns nil,
-- message, details, and everything is as it was before. So it is where a function of the script raises.
local core = require "barwright.core"
local members = require "barwright.members"
local options = require "barwright.options"
local new_frame = require "barwright.frame"

local raise = core.raise

local followed = {}

-- ---- options that all have -----------------------------------------------------------------------

local rules = {
  outline = {type = "outline", needed = true},
  elements = {type = "integer", min = 1},
  size = {type = "any"},
  follow = {type = "table", default = {}},
}

--- The rules of a class: its own and those that all have.
function followed.with(more)
  local all = {}
  for key, rule in pairs(rules) do all[key] = rule end
  for key, rule in pairs(more) do all[key] = rule end
  return all
end

--- Rules with those of what solves linear equations on a lagged factor.
function followed.solved(more)
  more.solver, more.max_lag = {type = "solver", auto = true}, {type = "integer", min = 0}
  return more
end

--- The options of the linear equations, as the engine's body takes them.
function followed.linear(self)
  return {solver = self.opts.solver, max_lag = self.opts.max_lag}
end

--- A mesh has a wanted number of elements or a wanted size of them.
function followed.one_size(where, opts)
  if opts.size ~= nil and opts.elements ~= nil then
    raise(("%s: options 'elements' and 'size' both set the size of the elements: give one of them"):format(where))
  end
end

--- The options of the mesh; a size that is a formula in x and y or a function of them goes to the end of
--- the list of conditions, which keeps values that change from place to place.
function followed.mesh(where, opts, list)
  local size, kind = opts.size, type(opts.size)
  followed.one_size(where, opts)
  if kind == "string" or kind == "function" then
    list[#list + 1] = {kind = "size", value = size}
    size = nil
  elseif size ~= nil and not (kind == "number" and size > 0 and size < math.huge) then
    raise(("%s: option 'size': a number above 0, a formula in x and y, or a function of them expected, got %s")
      :format(where, core.got(size)))
  end
  return {order = opts.order, size = size, elements = opts.elements}
end

--- An object of the class around an engine body; `class.start` solves for the first time.
function followed.object(class, opts, body, message, details)
  if not body then return nil, message, details end
  local self = setmetatable({body = body, opts = opts, last = new_frame()}, class)
  if class.start then
    local ok
    ok, message, details = class.start(self)
    if not ok then return nil, message, details end
  end
  return self
end

-- ---- classes -------------------------------------------------------------------------------------

local properties = {
  outline = function(self) return rawget(self, "body").outline end,
  reused = function(self) return rawget(self, "last") end,
  report = function(self) return rawget(self, "last").report end,
  element_count = function(self) return (rawget(self, "body"):counts()) end,
  node_count = function(self) return (select(2, rawget(self, "body"):counts())) end,
}
for _, name in ipairs {"points", "elements"} do
  properties[name] = function(self) return rawget(self, "body")[name] end
end

--- A class whose objects print as `what`, with properties of the engine's body by their names, and
--- others as functions.
function followed.class(what, names, more)
  local class, own = {}, {}
  for name, property in pairs(properties) do own[name] = property end
  for name, property in pairs(more or {}) do own[name] = property end
  for _, name in ipairs(names) do
    own[name] = function(self) return rawget(self, "body")[name] end
  end
  class.__index = members(what, class, own)
  function class.__newindex(_, name)
    raise(("%s: '%s' cannot be set: fields are read only, options are given when the analysis is made")
      :format(what, tostring(name)))
  end
  class.__name = "barwright." .. what
  function class:__tostring()
    local elements, nodes = self.body:counts()
    local report = self.report
    return ("%s: %d triangles, %d nodes; %s%s"):format(what, elements, nodes, tostring(self.last),
      report and "; " .. tostring(report) or "")
  end
  return class
end

-- What an object is at; the end of the scope returns to it where what was tried is not `committed`.
local undo = {}

function undo:__close()
  if not self.committed then
    assert(self.object.body:restore(self.state))
    rawset(self.object, "last", self.last)
    if self.restore then self.restore() end
  end
  self.state:close()
end

--- Does `change()` whole or not at all: where it returns nil or raises, the object is as it was, with what
--- its class holds beside the engine's body (`keep` gives the function that restores it).
function followed.attempt(self, change)
  local class = getmetatable(self)
  local before <close> = setmetatable({object = self, last = self.last, state = self.body:save(),
    restore = class.keep and class.keep(self)}, undo)
  local result, message, details = change()
  if not result then return nil, message, details end
  before.committed = true
  return result
end

--- The same for a frame, `change(report)`, which then is the last.
function followed.whole(self, change)
  return followed.attempt(self, function()
    local report = new_frame()
    local ok, message, details = change(report)
    if not ok then return nil, message, details end
    rawset(self, "last", report)
    return self
  end)
end

--- A frame: mesh and body go over to an outline, the class's `finish` solves.
function followed.become(self, outline)
  options.object("become", "outline", outline, "outline")
  local finish = getmetatable(self).finish
  return followed.whole(self, function(report)
    local ok, message, details = self.body:follow(report, outline)
    if ok and finish then return finish(self, report) end
    return ok, message, details
  end)
end

--- A function that brings the object back to how it is now, bit for bit; nil where time goes on.
function followed.saved(self)
  if type(self) ~= "table" or not rawget(self, "body") then return nil end
  local marches = getmetatable(self).marches
  if marches and marches(self) then return nil end
  local body = self.body
  local state = body:save()
  return function()
    assert(body:restore(state))
    rawset(self, "last", new_frame())
    return self
  end
end

--- A frame with a handle of the outline moved by {dx, dy}.
function followed.drag(self, handle, by)
  if type(handle) ~= "table" or type(by) ~= "table" then
    raise(("drag: a handle like {vertex = 1} or {loop = \"hole\"} and {dx, dy} expected, got %s and %s")
      :format(type(handle), type(by)))
  end
  local moved, message, details = self.body.outline:moved(handle, by)
  if not moved then return nil, message, details end
  return followed.become(self, moved)
end

--- Steps in time, `advance` of the report, are a frame; together with the drags before them, where no
--- step was between.
function followed.step(self, advance)
  local last = self.last
  return followed.whole(self, function(report)
    report.pattern, report.solution = true, true
    if last.solves == 0 and last.level ~= "none" then
      for key, value in pairs(last) do report[key] = value end
    end
    return advance(report)
  end)
end

--- The class's `finish` again on the shape as it is.
function followed.solve(self)
  return followed.whole(self, function(report) return getmetatable(self).finish(self, report) end)
end

return followed
