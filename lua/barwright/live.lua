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
  worst = {type = "table"}, -- options of bw.worst_case, for the worst load
  ties = {type = "table"}, -- lists of names of bones that change alike in the optimisation
  saved = {type = "string"}, -- where the edits go, to be shown
  ready = {type = "function"}, -- called with the address
}

-- In place of the page where it was not bundled. Everything else of the session goes on.
local missing = [[
<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>barwright</title><link rel="icon" href="data:,">
<style>body { font: 16px/1.5 system-ui, sans-serif; max-width: 34em; margin: 4em auto; }</style></head>
<body><h1>The page is not there</h1>
<p>The live view's page is bundled by <code>scripts/setup</code> where Node (the packages nodejs and npm)
is installed. It was not when barwright was built, which has everything else.</p>
<p>Install them, run <code>scripts/setup</code> again, and start <code>barwright live</code> again: the
session goes on with the edits that it has. Until then it can be edited by Lua scripts
(<code>bw.edit</code>).</p></body></html>
]]

--- The page, or what is said in its place. As for the report: beside this file when installed, else in
--- the tree that was built.
function live.serve_page(server)
  local html, script = beside.find "live.html", beside.find "live.js"
  server:serve("", "text/html; charset=utf-8", html and script and html or missing)
  if html and script then server:serve("live.js", "text/javascript; charset=utf-8", script) end
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

--- Serves a session until Ctrl-C. Options: port, title, name, solve, von_mises, worst, ties, saved,
--- ready.
function live.run(session, given)
  local wish = options.read("live", given, rules)
  local server, message, details = core.live_server {port = wish.port}
  if not server then return nil, message, details end
  local desk
  desk, message, details = live_desk.new(session, server, {title = wish.title, name = wish.name,
    solve = wish.solve, limit = wish.von_mises, saved = wish.saved, worst = wish.worst,
    ties = wish.ties})
  if not desk then
    server:close()
    return nil, message, details
  end
  live.serve_page(server)
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
