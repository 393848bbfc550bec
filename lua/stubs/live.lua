---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Live view
--
-- Edit sessions and objects of `bw.responsive` in a browser (docs/live.md).

---@class bw
local bw = {}

---Serves an edit session, or an object of `bw.responsive`, as a page on this machine until Ctrl-C.
---
---Errors: io (the port cannot be opened), unsupported (a sandbox does not allow a server).
---```lua
---local outline = assert(bw.outline.rectangle {width = 0.2, height = 0.05})
---local sheet = assert(bw.responsive.steady {outline = outline, material = bw.material.pla, thickness = 4e-3,
---  conditions = {boundary = "fixed"}})
---assert(bw.live(sheet, {title = "A plate", ready = print})) -- prints the address; ends with Ctrl-C
---```
---@param served bw.Session|bw.SteadySheet|bw.LargeDeflectionSheet|bw.TransientSheet|bw.Bridge|bw.Metallophone|bw.Flow|bw.ThermalFlow what is edited
---@param options? bw.LiveOptions what the page shows
---@return bw.Session|bw.SteadySheet|bw.LargeDeflectionSheet|bw.TransientSheet|bw.Bridge|bw.Metallophone|bw.Flow|bw.ThermalFlow|nil served the same object, as it was edited
---@return string? message
---@return bw.Details? details
function bw.live(served, options) end

---What a live view shows. Some options are for edit sessions alone, some for objects of `bw.responsive`; the others raise.
---@class bw.LiveOptions
---@field port? integer (-) of this machine. Range: 0 to 65535. Default: 0, any that is free
---@field title? string of the page. Default: chosen
---@field name? string of files that are exported. Default: chosen
---@field von_mises? number (Pa) the limit that is shown, above 0. Default: of a session the strength of the material
---@field saved? string the file that the edits go to, to be shown. Default: none
---@field ready? fun(address: string) called with the address when the page is there. Default: none
---@field solve? bw.SessionSolveOptions of a session: how it is solved
---@field worst? bw.WorstCaseOptions of a session: how the worst load is searched for
---@field ties? string[][] of a session: lists of bones that the optimisation changes alike
---@field pace? integer (count) of an object in time: steps of time in a frame. Range: 1 to 1000. Default: 1
---@field paused? boolean of an object in time: begin paused. Default: false
---@field goal? bw.Outline of an object: a shape to be met, drawn in red. Default: none
---@field script? string of an object: what makes it, named from the file `saved`. Default: none
---@field lines? string[] of an object: edits that are made first. Default: none

---The server of the live view, `require("barwright.core").live_server()`. It answers to this machine alone, below a path of 128
---random bits, and only to the origin that it serves. WebSockets connect to `address .. "socket"`.
---```lua
---local server = assert(require("barwright.core").live_server())
---server:serve("", "text/plain", "hello")
---print(server.port, server.client_count)
---server:close()
---```
---@class bw.LiveServer
---@field port integer (-) on this machine
---@field token string the random part of the address
---@field address string to open in a browser; who knows it can edit
---@field client_count integer (count) of open WebSockets
local LiveServer = {}

---Sets what a path below the address answers.
---@param path string "" for the page itself
---@param mime string its type, such as "text/html; charset=utf-8"
---@param bytes string the content
---@param download? string the name under which browsers save it. Default: they show it
---@return bw.LiveServer self
function LiveServer:serve(path, mime, bytes, download) end

---Queues a message for a client. It never waits for the client.
---@param client integer (-) as `receive` gives it
---@param bytes string the message
---@param options? bw.LiveServerSendOptions its form
---@return boolean sent false where the client is gone
function LiveServer:send(client, bytes, options) end

---The form of a message.
---@class bw.LiveServerSendOptions
---@field binary? boolean bytes instead of text. Default: false
---@field replace? string in place of a message of the same key that is not sent yet. Default: none

---The next thing that came; nil alone where nothing came in time. Inside of a progress function it does not wait.
---
---Errors: cancelled (Ctrl-C).
---@param seconds? number (s) how long it waits. Range: 0 to 1e6. Default: 0
---@return integer? client (-) who it came from
---@return string? kind "open", "message", "close" or "upload"; or the message of an error
---@return string|bw.Details|nil text the message that came; or the details of an error
function LiveServer:receive(seconds) end

---Ends a client's connection.
---@param client integer (-) as `receive` gives it
---@param code? integer (-) of RFC 6455. Default: 1000
---@param reason? string in words. Default: none
function LiveServer:disconnect(client, code, reason) end

---Ends the server at once.
function LiveServer:close() end
