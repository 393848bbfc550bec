-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The live view of an edit session: a page on this machine's loopback address where a person picks a
-- bone and drags it. The desk (live_desk) does the work; this file makes the server and keeps it
-- going until Ctrl-C.
local beside = require "barwright.beside"
local core = require "barwright.core"
local live_desk = require "barwright.live_desk"
local options = require "barwright.options"

local live = {}

local rules = {
  port = {type = "integer", default = 0, least = 0, most = 65535},
  title = {type = "string"},
  name = {type = "string"}, -- of the files that are exported
  solve = {type = "table"}, -- options of session:solve
  von_mises = {type = "number", above = 0}, -- the limit shown; left out: the material's strength
  saved = {type = "string"}, -- where the edits go, to be shown
  ready = {type = "function"}, -- called with the address
}

-- As for the report: beside this file when installed, else in the tree that was built.
local function page()
  local html = beside.find "live.html"
  local script = beside.find "live.js"
  if html and script then return html, script end
  return nil, "the live view's page is not there: it is bundled by scripts/setup where nodejs and npm "
    .. "are installed; install them and run scripts/setup again", {status = "unsupported"}
end

-- Waits for something to happen, then takes all that is there: what came while the engine worked.
-- False after Ctrl-C.
local function take(server)
  local client, kind, text = server:receive(3600)
  if not client and kind then return false end
  local events = {}
  while client do
    events[#events + 1] = {client, kind, text}
    client, kind, text = server:receive(0)
  end
  return events
end

local function serve(desk, server)
  while not core.interrupted() do
    local events = take(server)
    if not events then return end
    desk:handle(events)
  end
end

-- The pages are told before the connections end.
local function part_with(desk, server)
  desk:finish()
  for client in pairs(desk.clients) do server:disconnect(client, 1001, "the session has ended") end
  local until_ = core.seconds() + 1
  while server.client_count > 0 and core.seconds() < until_ do server:receive(0.02) end
end

--- Serves a session until Ctrl-C. Options: port, title, name, solve, von_mises, saved, ready.
function live.run(session, given)
  local wish = options.read("live", given, rules)
  local html, script, details = page()
  if not html then return nil, script, details end
  local server, message
  server, message, details = core.live_server {port = wish.port}
  if not server then return nil, message, details end
  local desk
  desk, message, details = live_desk.new(session, server, {title = wish.title, name = wish.name,
    solve = wish.solve, limit = wish.von_mises, saved = wish.saved})
  if not desk then
    server:close()
    return nil, message, details
  end
  server:serve("", "text/html; charset=utf-8", html)
  server:serve("live.js", "text/javascript; charset=utf-8", script)
  -- Ctrl-C while Lua works is an error; the edits are in the journal by then.
  local fine, why = pcall(function()
    if wish.ready then wish.ready(server.address) end
    serve(desk, server)
  end)
  if fine or core.interrupted() then pcall(part_with, desk, server) end
  server:close()
  if not fine and not core.interrupted() then error(why, 0) end
  return session
end

return live
