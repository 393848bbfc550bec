-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the kinds share whose outline is dragged: outlines, drags, what is kept and returned to, what is seen.
local bw = require "barwright"
local followed = require "barwright.followed"

local kinds = {}

local function uniform(min, max) return min + (max - min) * math.random() end
kinds.uniform = uniform

-- ---- outlines, most of which serve ----------------------------------------------------------------

local function rectangle(width, height, tags)
  return bw.outline.rectangle {width = width, height = height, tags = tags or {left = 4, right = 2}}
end

function kinds.first() return assert(rectangle(2, 1)) end

local others = {
  function() return rectangle(uniform(1.5, 2.5), uniform(0.7, 1.3)) end,
  function() return rectangle(2, 1) end,
  -- the same tags in another order
  function() return rectangle(uniform(1.8, 2.2), 1, {right = 2, left = 4, top = 3}) end,
  function()
    return bw.outline {points = {{0, 0}, {2, 0}, {2, 1}, {1, uniform(0.8, 1.4)}, {0, 1}},
      tags = {left = 5, right = 2}}
  end,
  function()
    return bw.outline {points = {{0, 0}, {2, 0}, {2, 1}, {0, 1}}, tags = {left = 4, right = 2},
      holes = {bw.outline.circle {centre = {uniform(0.5, 1.5), uniform(0.3, 0.7)}, radius = uniform(0.05, 0.4),
        name = "hole"}}}
  end,
  -- what no condition finds its tag on
  function() return bw.outline.circle {centre = {0, 0}, radius = uniform(0.1, 1)} end,
  function() return rectangle(2, 1, {left = 4}) end,
  function() return rectangle(2, 1, {}) end,
  -- thin, tiny, huge, far
  function() return rectangle(2, 10 ^ uniform(-1.3, -0.5)) end,
  function() return rectangle(2e-6, 1e-6) end,
  function() return rectangle(2e8, 1e8) end,
  function()
    return bw.outline {points = {{1e6, 0}, {1e6 + 2, 0}, {1e6 + 2, 1}, {1e6, 1}}, tags = {left = 4, right = 2}}
  end,
  function(now) return now:scaled(uniform(0.8, 1.2)) end,
  -- loops that cross
  function() return bw.outline {points = {{0, 0}, {2, 1}, {2, 0}, {0, 1}}, tags = {left = 4, right = 2}} end,
}

-- Slivers cost millions of elements: what filling makes of them is looked at elsewhere.
local function fair(outline, message)
  if outline and outline.area < 0.01 * outline.perimeter ^ 2 then return nil, "a sliver" end
  return outline, message
end

local function other(outline) return fair(others[math.random(#others)](outline)) end

local function way(size)
  local max = math.random() < 0.7 and 0.08 or math.random() < 0.5 and 0.5 or 3
  return {uniform(-max, max) * size, uniform(-max, max) * size}
end

local function handle(outline)
  local at = math.random(3)
  if at == 1 then return {vertex = math.random(outline.edge_count)} end
  if at == 2 then return {edge = math.random(outline.edge_count)} end
  local loops = outline.loops
  local loop = loops[math.random(#loops)]
  return loop.name and loop.name ~= "" and {loop = loop.name} or {vertex = 1}
end
kinds.way, kinds.handle, kinds.other = way, handle, other

--- The outline with a handle of it moved; nil and why where that is none.
function kinds.dragged(outline)
  return fair(outline:moved(handle(outline), way(math.sqrt(outline.area))))
end

-- ---- a subject -----------------------------------------------------------------------------------

-- What can be compared of a value, bit for bit.
local function text_of(value)
  if type(value) == "number" then return ("%a"):format(value) end
  if type(value) == "userdata" then return value:tostring "<f8" end
  return tostring(value)
end
kinds.text_of = text_of

local function fields(object, names)
  local parts = {}
  for _, name in ipairs {"points", "elements", table.unpack(names)} do
    parts[#parts + 1] = text_of(object[name])
  end
  parts[#parts + 1] = text_of(object.outline.points)
  return table.concat(parts, "|")
end

--- A kind of followed objects. `about`: make, fields, moves (more operations), asks (functions of the object whose
--- answers must not change either).
function kinds.new(about)
  local kind = {}

  function kind.make() return {object = assert(about.make()), kept = {}} end

  function kind.seen(subject)
    local object = subject.object
    local parts = {fields(object, about.fields), tostring(object.reused)}
    for _, ask in ipairs(about.asks or {}) do
      local answers = table.pack(pcall(ask, object))
      for i = 1, answers.n do parts[#parts + 1] = text_of(answers[i]) end
    end
    return table.concat(parts, "|")
  end

  function kind.check(subject)
    local expected = subject.expected
    subject.expected = nil
    subject.object.body:check()
    if expected and fields(subject.object, about.fields) ~= expected then
      error "what was kept is not what came back"
    end
  end

  -- Twice, and what is closed refuses whatever is asked of it.
  function kind.close(subject)
    local object = subject.object
    object.body:close()
    object.body:close()
    for _, ask in ipairs {function() return object:drag({vertex = 1}, {0.1, 0}) end,
      function() return object:become(kinds.first()) end, function() return object.points end,
      function() return object.body:check() end} do
      if pcall(ask) then error "a closed object answers" end
    end
  end

  kind.operations = {
    drag = {5, function(subject)
      local outline, message = kinds.dragged(subject.object.outline)
      if not outline then return nil, message end
      return subject.object:become(outline)
    end},
    -- as a hand does it, no farther than any filling can follow
    nudge = {2, function(subject)
      local object = subject.object
      return object:drag(handle(object.outline), way(0.05 * math.sqrt(object.outline.area)))
    end},
    become = {3, function(subject)
      local outline, message = other(subject.object.outline)
      if not outline then return nil, message end
      return subject.object:become(outline)
    end},
    -- without the solution that belongs there
    follow = {0.5, function(subject)
      local outline, message = other(subject.object.outline)
      if not outline then return nil, message end
      return subject.object.body:follow({level = "none"}, outline)
    end},
    misuse = {0.5, function(subject)
      local wrong = {nil, 1, "x", {}, subject.object.body}
      return subject.object:become(wrong[math.random(5)])
    end},
    keep = {1, function(subject)
      local back = followed.saved(subject.object)
      if not back then return nil, "time goes on" end
      subject.kept[#subject.kept + 1] = {back = back, fields = fields(subject.object, about.fields)}
      if #subject.kept > 4 then table.remove(subject.kept, 1) end
      return true
    end},
    ["return"] = {1, function(subject)
      local kept = subject.kept[math.random(math.max(1, #subject.kept))]
      if not kept then return nil, "nothing is kept" end
      subject.expected = kept.fields
      return kept.back()
    end},
    collect = {0.2, function() return collectgarbage() and true end},
  }
  for name, operation in pairs(about.moves or {}) do kind.operations[name] = operation end
  return kind
end

return kinds
