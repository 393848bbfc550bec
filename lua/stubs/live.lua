---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Live view
--
-- Sessions and outlines in a browser.

---@class bw
local bw = {}

---The live view: serves a session, or an object of bw.responsive, as a page on this machine until Ctrl-C.
---See docs/live.md. `solve`, `worst` and `ties` are for sessions; `pace` (steps of time in a frame) and
---`paused` for what goes on in time; `goal` (a shape to be met, drawn in red), `script` (what makes the object, named from the file `saved`) and
---`lines` (edits made first) for objects of bw.responsive.
---@param served bw.Session|bw.SteadySheet|bw.BentSheet|bw.ShakenSheet|bw.Metallophone|bw.Flow|bw.ThermalFlow
---@param options? bw.LiveOptions
---@return table?
---@return string? message
---@return bw.Details? details
function bw.live(served, options) end

---@class bw.LiveOptions
---@field port? integer
---@field title? string
---@field name? string
---@field solve? table
---@field von_mises? number
---@field worst? bw.WorstCaseOptions
---@field ties? string[][]
---@field saved? string
---@field ready? fun(address: string)
---@field pace? integer
---@field paused? boolean
---@field goal? bw.Outline
---@field script? string
---@field lines? string[]

---The server of the live view (`require "barwright.core".live_server`): answers to this machine alone,
---below a path of 128 random bits, and only to the origin it serves. WebSockets at `address .. "socket"`.
---@class bw.LiveServer
---@field port integer
---@field token string
---@field address string to open in a browser; who knows it can edit
---@field client_count integer open WebSockets
local LiveServer = {}

---What a path below the address answers from now on.
---@param path string "" for the page itself
---@param mime string
---@param bytes string
---@param download? string the name under which browsers save it
---@return bw.LiveServer
function LiveServer:serve(path, mime, bytes, download) end

---Queues a message; never waits for the client. With `replace`, in place of an unsent one of that key.
---@param client integer
---@param bytes string
---@param options? bw.LiveServerSendOptions
---@return boolean sent false when that client is gone
function LiveServer:send(client, bytes, options) end

---@class bw.LiveServerSendOptions
---@field binary? boolean
---@field replace? string

---The next thing that came, waiting up to so many seconds: nothing when none did; nil, message,
---details after Ctrl-C. Inside a progress function it does not wait.
---@param seconds? number
---@return integer? client
---@return string? kind "open", "message", "close"
---@return string|table? text
function LiveServer:receive(seconds) end

---Ends a client's connection.
---@param client integer
---@param code? integer of RFC 6455, default 1000
---@param reason? string
function LiveServer:disconnect(client, code, reason) end

function LiveServer:close() end
