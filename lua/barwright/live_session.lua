-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the controllers of the live views share: talking with windows, long work during which messages still
-- arrive, newest moves first, files to be downloaded.
--
-- A controller has `server`, `clients` (set), `later` (what arrived while the engine worked), `drag` or nil
-- (with its `client`), and `on_progress` while windows are informed of progress.
local core = require "barwright.core"
local json = require "barwright.json"
local live_check = require "barwright.live_check"
local read_file = require "barwright.read_file"

local shared = {}

-- ---- reports -------------------------------------------------------------------------------------

--- A browser closes a socket on text that is not UTF-8; names of bones come from files.
function shared.notify(self, client, message)
  local text = json.encode(message)
  self.server:send(client, utf8.len(text) and text or (text:gsub("[\128-\255]", "?")))
end

function shared.notify_all(self, message)
  for client in pairs(self.clients) do shared.notify(self, client, message) end
end

function shared.refuse(self, client, message, why)
  shared.notify(self, client, {type = "refused", request = message.type, seq = message.seq, message = why})
end

function shared.send_all(self, bytes, key)
  for client in pairs(self.clients) do
    self.server:send(client, bytes, {binary = true, replace = key})
  end
end

--- While the engine works: what arrives is kept for later. `gives_up(client, kind, text)` is asked of
-- each; the work is given up once it was true.
function shared.meanwhile(self, gives_up, work, ...)
  local going = true
  local before = core.progress(function(stage, fraction)
    while #self.later < 1000 do
      local client, kind, text = self.server:receive(0)
      if not client then break end
      local wanted, keep = gives_up(client, kind, text)
      if wanted then going = false end
      if not wanted or keep then self.later[#self.later + 1] = {client, kind, text} end
    end
    if self.on_progress then self.on_progress(stage, fraction) end
    return going
  end)
  local results = table.pack(pcall(work, ...))
  core.progress(before)
  if not results[1] then error(results[2], 0) end
  return table.unpack(results, 2, results.n)
end

--- Long work that every page is informed of, and any may stop: the results of `work`.
function shared.with_progress(self, what, work, ...)
  local shown = -1
  shared.notify_all(self, {type = "progress", stage = what, fraction = 0})
  self.on_progress = function(stage, fraction)
    local now = core.seconds()
    if now - shown < 0.2 then return end
    shown = now
    shared.notify_all(self, {type = "progress", stage = stage, fraction = fraction})
  end
  local results = table.pack(pcall(shared.meanwhile, self, function(_, kind, text)
    return kind == "message" and live_check.is(text, "stop")
  end, work, ...))
  self.on_progress = nil
  if not results[1] then return nil, tostring(results[2]) end
  return table.unpack(results, 2, results.n)
end

function shared.stopped(details)
  return details and details.status == "cancelled"
end

-- ---- drags ---------------------------------------------------------------------------------------

--- The drag of a window; a window without one gets a refusal.
function shared.own_drag(self, client, message)
  if self.drag and self.drag.client == client then return self.drag end
  shared.refuse(self, client, message, "no drag of this window is going on")
end

--- Whether nothing is dragged; otherwise the window gets a refusal with what is dragged, `self:dragged()`.
function shared.no_drag(self, client, message)
  if not self.drag then return true end
  shared.refuse(self, client, message, self:dragged() .. " is being dragged")
end

--- Whether a window may begin a drag.
function shared.may_begin(self, client, message)
  if not self.drag then return true end
  shared.refuse(self, client, message, ("%s is being dragged in %s window"):format(self:dragged(),
    self.drag.client == client and "this" or "another"))
end

--- A window is closed, which ends its drag: `finish` keeps what went well and tells the others.
function shared.leave(self, client, finish)
  self.clients[client] = nil
  if self.drag and self.drag.client == client then
    shared.protected(self, client, {type = "end"}, finish)
  end
end

-- ---- files ---------------------------------------------------------------------------------------

--- What a function writes to a path, as text.
function shared.written(ending, write)
  local folder <close>, message = core.temporary_folder()
  if not folder then return nil, message end
  local path = folder.path .. "/written" .. ending
  local ok, why = write(path)
  if not ok then return nil, why end
  return read_file(path)
end

-- ---- what arrives --------------------------------------------------------------------------------

--- Runs a handler. What neither a check nor the session caught is reported too; the session is then as
-- the last whole edit left it (which `self:settle()` does for a controller that drags the thing itself).
function shared.protected(self, client, message, handler)
  local ok, result, why = pcall(handler, self, client, message)
  if ok and (result ~= nil or not why) then return end
  if self.drag and self.drag.client == client then self.drag = nil end
  if self.settle then self:settle() end
  shared.refuse(self, client, message, tostring(ok and why or result))
end

-- Events with their messages read; of moves of one window in a row only the newest counts, and that
-- which the end of the drag follows is not solved.
local function read_all(self, events, how)
  local out, last = {}, nil
  for _, event in ipairs(events) do
    local client, kind, text = event[1], event[2], event[3]
    local entry = {client = client, kind = kind, text = kind == "upload" and text or nil}
    if kind == "message" then
      entry.message, entry.why = how.read(text, self)
    end
    if last and entry.message and last.message and entry.message.type == "move"
      and last.message.type == "move" and last.client == client then
      last.message = entry.message
    else
      if last and last.client == client and last.message and entry.message
        and last.message.type == "move" and entry.message.type == "end" then
        last.message.ends = true
      end
      out[#out + 1], last = entry, entry
    end
  end
  return out
end

--- Handles what arrived: {client, "open" | "message" | "close", text}, ... `how` = {read = of a text,
--- open, close = of a client, handlers = by type of message}
function shared.handle(self, events, how)
  for _, entry in ipairs(read_all(self, events, how)) do
    if entry.kind == "open" then
      how.open(self, entry.client)
    elseif entry.kind == "upload" then
      how.upload(self, entry.text)
    elseif entry.kind == "close" then
      how.close(self, entry.client)
    elseif entry.message then
      shared.protected(self, entry.client, entry.message, how.handlers[entry.message.type])
    else
      shared.notify(self, entry.client, {type = "error", message = entry.why})
    end
    if core.interrupted() then return end
  end
  if #self.later > 0 then
    local later = self.later
    self.later = {}
    shared.handle(self, later, how)
  end
end

return shared
