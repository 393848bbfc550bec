-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What may not be called with just anything, each with its reason.
local special = {}

-- Arguments that are changed before the call.
special.arguments = {
  -- Serves until Ctrl-C: it is given nothing that it could serve.
  ["bw.live"] = function(list)
    if type(list[1]) ~= "number" and type(list[1]) ~= "string" then list[1] = "nothing to serve" end
  end,
  -- Waits as long as it is asked to, and the program's Ctrl-C ends it: no longer than it takes to look.
  ["LiveServer:receive"] = function(list)
    if type(list[1]) ~= "string" then list[1] = list[1] == list[1] and type(list[1]) == "number"
      and list[1] < 0 and list[1] or 0 end
  end,
}

-- May take as long as its limit: a short one.
special.arguments["Surface:wrap"] = function(list)
  if type(list[1]) == "table" and not getmetatable(list[1]) then list[1].time_limit = 2 end
end

-- Error values that are no texts and part of what is documented: Test:require and Test:skip leave the scenario.
special.raises = {[""] = true}

return special
