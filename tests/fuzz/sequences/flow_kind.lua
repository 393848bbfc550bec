-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Flows, with heat or without, in time or steady.
local acting = require "acting"
local bw = require "barwright"
local followed_kinds = require "followed_kinds"
local fuse = require "fuse"

local function signals(object)
  local names, parts = {}, {}
  for name in pairs(object.signals) do names[#names + 1] = name end
  table.sort(names)
  for _, name in ipairs(names) do parts[#parts + 1] = name .. table.concat(object.signals[name], " ") end
  return table.concat(parts, "|")
end

return function(class, fields, more)
  return followed_kinds.new {
    make = function()
      acting.load = 1
      local options = {outline = followed_kinds.first(), viscosity = 0.1, elements = math.random(8, 40),
        step = 0.1, steady = math.random() < 0.4, ale = math.random() < 0.5, bdf = math.random(2),
        conditions = {left = {x = acting.function_of_load, y = 0}}}
      for key, value in pairs(more) do options[key] = value end
      return bw.responsive[class](options)
    end,
    fields = fields,
    asks = {signals, function(object) return object:force "left" end,
      function(object) return object:at(0.5, 0.4) end},
    moves = {
      load = {1, acting.change},
      step = {4, function(subject) return subject.object:step(math.random(4)) end},
      settle = {1, function(subject) return subject.object:settle() end},
      record = {0.5, function(subject)
        return subject.object:record("speed", fuse.around(function(object) return (object:at(1, 0.5)) end))
      end},
      ["record nothing"] = {0.2, function(subject) return subject.object:record "speed" end},
      ["record what is no number"] = {0.2, function(subject)
        return subject.object:record("wrong", function() return "x" end)
      end},
      ["stop recording it"] = {0.4, function(subject) return subject.object:record "wrong" end},
      ["drag while recording"] = {0.3, function(subject)
        return subject.object:record("drags", fuse.around(function(object)
          object:drag({vertex = 2}, {0.01, 0})
          return object.time
        end))
      end},
      ["stop dragging"] = {0.3, function(subject) return subject.object:record "drags" end},
      pace = {0.3, function(subject) return subject.object:pace(10 ^ followed_kinds.uniform(-3, 0)) end},
    },
  }
end
