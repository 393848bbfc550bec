-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Live views: a page on this machine's loopback address where a person picks a bone of an edit session
-- and drags it, or a handle of an outline (bw.responsive). A controller (live_controller, live_plane_controller)
-- does the work; this file makes the server and keeps it going until Ctrl-C.
local beside = require "barwright.beside"
local core = require "barwright.core"
local edit = require "barwright.edit"
local html = require "barwright.html"
local kinds = require "barwright.live_plane_kinds"
local live_controller = require "barwright.live_controller"
local live_plane_controller = require "barwright.live_plane_controller"
local options = require "barwright.options"

local live = {}

local function with(more)
  local all = {
    port = {type = "integer", default = 0, min = 0, max = 65535},
    title = {type = "string"},
    name = {type = "string"}, -- of the files that are exported
    von_mises = {type = "number", above = 0}, -- the limit shown; of a session left out: the material's strength
    saved = {type = "string"}, -- where the edits go, to be shown
    ready = {type = "function"}, -- called with the address
  }
  for key, rule in pairs(more) do all[key] = rule end
  return all
end

local session_rules = with {
  solve = {type = "table"}, -- options of session:solve
  worst = {type = "table"}, -- options of bw.worst_case, for the worst load
  ties = {type = "table"}, -- lists of names of bones that change alike in the optimisation
}

local outline_rules = with {
  script = {type = "string"}, -- what makes the object, as seen from the file of edits
  lines = {type = "table"}, -- edits that are made first
  pace = {type = "integer", min = 1, max = 1000}, -- steps of time in a frame
  paused = {type = "boolean"},
  goal = {type = "outline"}, -- drawn in red: a shape to be met
}

-- In place of the page where it was not bundled. Everything else of the session goes on.
local missing = html.document {title = "The page is not there", width = 36, body = [[
<p>The live view's page is bundled by <code>scripts/setup</code> where Node (the packages nodejs and npm)
is installed. It was not when barwright was built, which has everything else.</p>
<p>Install them, run <code>scripts/setup</code> again, and start <code>barwright live</code> again: the
session goes on with the edits that it has. Until then it can be edited by Lua scripts
(<code>bw.edit</code>).</p>
]]}

--- The page `name` ("live", "plane"), or a message in its place. As for the report: beside this file
--- when installed, else in the tree that was built.
function live.serve_page(server, name)
  name = name or "live"
  local page, script = beside.find(name .. ".html"), beside.find(name .. ".js")
  local style = beside.find(name == "workbench" and "workbench.css" or "live.css")
  if not (page and script and style) then
    server:serve("", "text/html; charset=utf-8", missing)
    return
  end
  -- the page's policy allows styles in the page only
  page = page:gsub("/%* %w+%.css %*/", function() return style end)
  server:serve("", "text/html; charset=utf-8", page)
  server:serve(name .. ".js", "text/javascript; charset=utf-8", script)
end

-- Waits for something to happen, then takes all that is there: what came while the engine worked.
-- False after Ctrl-C.
local function take(server, seconds)
  local client, kind, text = server:receive(seconds)
  if not client and kind then return false end
  local events = {}
  while client do
    events[#events + 1] = {client, kind, text}
    client, kind, text = server:receive(0)
  end
  return events
end

local function serve(controller, server)
  while not core.interrupted() do
    local events = take(server, controller.wait and controller:wait() or 3600)
    if not events then return end
    controller:handle(events)
    if controller.idle then controller:idle() end
  end
end

-- The pages are informed before the connections end.
local function part_with(controller, server)
  controller:finish()
  for client in pairs(controller.clients) do server:disconnect(client, 1001, "the session has ended") end
  local until_ = core.seconds() + 1
  while server.client_count > 0 and core.seconds() < until_ do server:receive(0.02) end
end

-- A controller of what is served, and its page.
local function controller_for(served, server, opts)
  local about = {title = opts.title, name = opts.name, limit = opts.von_mises, saved = opts.saved}
  if kinds.of(served) then
    about.script, about.lines, about.pace, about.paused = opts.script, opts.lines, opts.pace, opts.paused
    about.goal = opts.goal
    local controller, message, details = live_plane_controller.new(served, server, about)
    return controller, controller and "plane" or message, details
  end
  about.solve, about.worst, about.ties = opts.solve, opts.worst, opts.ties
  local controller, message, details = live_controller.new(served, server, about)
  return controller, controller and "live" or message, details
end

--- Serves a controller until Ctrl-C: `begin(server)` makes it, or returns nil, message, details. `page` names
--- the page's files, `ready(address)` is called when the page can be opened.
--- `upload_bytes`: the longest file that the page may send, or nil for none.
function live.serve(port, page, begin, ready, upload_bytes)
  local server, message, details = core.live_server {port = port, upload_bytes = upload_bytes}
  if not server then return nil, message, details end
  live.serve_page(server, page)
  local controller
  -- Ctrl-C while Lua works is an error.
  local ok, why = pcall(function()
    if ready then ready(server.address) end
    controller, message, details = begin(server)
    if controller then serve(controller, server) end
  end)
  if controller and (ok or core.interrupted()) then pcall(part_with, controller, server) end
  server:close()
  if not ok and not core.interrupted() then error(why, 0) end
  if ok and not controller then return nil, message, details end
  return true
end

--- Serves a session, or an object of bw.responsive, until Ctrl-C. Options: port, title, name,
--- von_mises, saved, ready; of sessions also solve, worst, ties; of objects pace, paused, goal, script, lines.
function live.run(served, given)
  if not kinds.of(served) and getmetatable(served) ~= edit.class then
    options.object("live", "served", served, "session or object of bw.responsive")
  end
  local opts = options.read("live", given, kinds.of(served) and outline_rules or session_rules)
  local server, message, details = core.live_server {port = opts.port}
  if not server then return nil, message, details end
  local controller
  controller, message, details = controller_for(served, server, opts)
  if not controller then
    server:close()
    return nil, message, details
  end
  live.serve_page(server, message)
  -- Ctrl-C while Lua works is an error; the edits are in the journal by then.
  local ok, why = pcall(function()
    if opts.ready then opts.ready(server.address) end
    serve(controller, server)
  end)
  if ok or core.interrupted() then pcall(part_with, controller, server) end
  server:close()
  if not ok and not core.interrupted() then error(why, 0) end
  return served
end

return live
