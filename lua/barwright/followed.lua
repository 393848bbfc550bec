-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the bodies share that follow an outline while it is dragged (sheets, plates, flows). Each is an
-- engine object `body` with its mover, and the frame that was last.
--
-- An object holds its last good state: a drag that the outline, the mesh or the solution refuses
-- returns nil, message, details, and everything is as it was before.
local core = require "barwright.core"
local members = require "barwright.members"
local options = require "barwright.options"
local new_frame = require "barwright.frame"

local raise = core.raise

local followed = {}

-- ---- options that all have -----------------------------------------------------------------------

local rules = {
  outline = {type = "outline", needed = true},
  elements = {type = "integer", least = 1},
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

--- How fine a mesh is, is said by a number of elements or by their size.
function followed.one_size(where, wish)
  if wish.size ~= nil and wish.elements ~= nil then
    raise(("%s: options 'elements' and 'size' both say how fine the mesh is: give one of them"):format(where))
  end
end

--- The options of the mesh; a size that is a formula in x and y or a function of them goes to the end of
--- the list of conditions, which keeps values that change from place to place.
function followed.mesh(where, wish, list)
  local size, kind = wish.size, type(wish.size)
  followed.one_size(where, wish)
  if kind == "string" or kind == "function" then
    list[#list + 1] = {kind = "size", value = size}
    size = nil
  elseif size ~= nil and not (kind == "number" and size > 0 and size < math.huge) then
    raise(("%s: option 'size': a number above 0, a formula in x and y, or a function of them expected")
      :format(where))
  end
  return {order = wish.order, size = size, elements = wish.elements}
end

--- An object of the class around an engine body; `class.start` solves for the first time.
function followed.object(class, wish, body, message, details)
  if not body then return nil, message, details end
  local self = setmetatable({body = body, wish = wish, last = new_frame()}, class)
  if class.start then
    local fine
    fine, message, details = class.start(self)
    if not fine then return nil, message, details end
  end
  return self
end

-- ---- classes -------------------------------------------------------------------------------------

local properties = {
  outline = function(self) return rawget(self, "body").outline end,
  reused = function(self) return rawget(self, "last") end,
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
    raise(("%s: '%s' cannot be set: what an analysis is made of is given when it is made"):format(what,
      tostring(name)))
  end
  class.__name = "barwright." .. what
  function class:__tostring()
    local elements, nodes = self.body:counts()
    return ("%s: %d triangles, %d nodes; %s"):format(what, elements, nodes, tostring(self.last))
  end
  return class
end

-- Whether a method was called with its object: object:drag(...), not object.drag(...).
local function check_self(where, self)
  if type(self) ~= "table" or not rawget(self, "body") then
    raise(("%s: an analysis expected, got %s: call it as analysis:%s(...)"):format(where, type(self), where))
  end
end

--- `report` is the last frame, where all went well.
function followed.now_is(self, report, fine, message, details)
  if not fine then return nil, message, details end
  rawset(self, "last", report)
  return self
end

--- A frame: mesh and body go over to an outline, the class's `finish` solves. What fails is taken back:
--- by the function that the class's `keep` gave before, else by going back and solving again.
function followed.become(self, outline)
  check_self("become", self)
  options.object("become", "outline", outline, "outline")
  local body, finish = self.body, getmetatable(self).finish
  local before, report = body.outline, new_frame()
  local keep = getmetatable(self).keep
  local restore = keep and keep(self)
  local fine, message, details = body:follow(report, outline)
  if fine and finish then
    fine, message, details = finish(self, report)
    if not fine then
      local back = new_frame()
      local returned, why
      if restore then
        returned, why = restore()
      else
        returned, why = body:follow(back, before)
        if returned then returned, why = finish(self, back) end
      end
      if not returned then
        message = ("%s; and the state before could not be restored: %s"):format(message, why)
      end
    end
  end
  return followed.now_is(self, report, fine, message, details)
end

--- A function that brings the object back to how it is now, bit for bit; nil where its class keeps no states,
--- since solving again leads there.
function followed.kept(self)
  local keep = type(self) == "table" and rawget(self, "body") and getmetatable(self).keep
  local restore = keep and keep(self)
  if not restore then return nil end
  return function() return followed.now_is(self, new_frame(), restore()) end
end

--- A frame with a handle of the outline moved by {dx, dy}.
function followed.drag(self, handle, by)
  check_self("drag", self)
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
  local report, last = new_frame(), self.last
  report.pattern, report.solution = true, true
  if last.solves == 0 and last.level ~= "none" then
    for key, value in pairs(last) do report[key] = value end
  end
  local fine, message, details = advance(report)
  return followed.now_is(self, report, fine, message, details)
end

--- The class's `finish` again on the shape as it is.
function followed.solve(self)
  local report = new_frame()
  return followed.now_is(self, report, getmetatable(self).finish(self, report))
end

return followed
