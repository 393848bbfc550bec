-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A controller of a live view with a table in place of its server, for tests: windows are lists of messages.
local bw = require "barwright"

--- A talk with `controller.new(object, server, about)`: talk.server.got[client] = messages in order; `read` makes
--- a message of bytes (it gets the server too). nil and why where there is no controller.
return function(controller_module, object, about, read)
  local server = {got = {}, files = {}, waiting = {}, blocks = {}}
  function server:send(client, bytes, options)
    local message
    if options and options.binary then
      message = read(bytes, self)
    else
      assert(utf8.len(bytes))
      message = assert(bw.json.decode(bytes))
    end
    self.got[client] = self.got[client] or {}
    table.insert(self.got[client], message)
    return true
  end
  function server:serve(path, _, bytes) self.files[path] = bytes end
  function server:receive() return table.unpack(table.remove(self.waiting, 1) or {}) end
  local controller, why = controller_module.new(object, server, about or {})
  if not controller then return nil, why end
  local talk = {controller = controller, server = server, object = object}
  -- Handles messages of a window; gives the last answer and all of them.
  function talk.say(client, ...)
    server.got[client] = {}
    local events = {}
    for i, message in ipairs {...} do
      events[i] = {client, "message", type(message) == "table" and bw.json.encode(message) or message}
    end
    controller:handle(events)
    local got = server.got[client]
    return got[#got], got
  end
  function talk.open(client)
    server.got[client] = {}
    controller:handle {{client, "open", ""}}
    return server.got[client]
  end
  function talk.close(client) controller:handle {{client, "close", ""}} end
  return talk
end
