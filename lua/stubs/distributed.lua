---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Several processes
--
-- The processes that `mpirun` started: solving on all of them, and byte strings between them. `require "barwright.distributed"`
-- gives the module; it raises where barwright was built without MPI. docs/howto_cluster.md has more.

---The processes of one run, called ranks. A solver with the backend "petsc" loads this by itself; `barwright --mpi` calls `start`.
---```lua
---local distributed = require "barwright.distributed"
---assert(distributed.ready())
---print(distributed.rank(), distributed.size()) -- 0 1
---```
---@class bw.Distributed
local Distributed = {}

---Joins the other ranks. It returns on rank 0 alone; the others work for the solutions of rank 0 and end with it.
---
---Errors: unsupported (MPI could not be started, or this is a forked job); the message alone.
---@return integer? size (count) of ranks
---@return string? message
function Distributed.start() end

---Joins the other ranks on each of them, for programs whose ranks talk by `send` and `receive`.
---
---Errors: unsupported (MPI could not be started, or this is a forked job).
---@return integer? rank (index from 0) of this process
---@return integer|string size (count) of ranks, or the message
---@return bw.Details? details
function Distributed.join() end

---Makes a world of one where no ranks were joined. Under mpirun it is refused without `start` or `join`.
---
---Errors: unsupported (MPI could not be started, mpirun started several processes, or this is a forked job).
---@return integer? rank (index from 0) of this process
---@return integer|string size (count) of ranks, or the message
---@return bw.Details? details
function Distributed.ready() end

---This process.
---@return integer rank (index from 0) of this process
function Distributed.rank() end

---How many processes there are.
---@return integer size (count) of ranks
function Distributed.size() end

---Sends a byte string to another rank.
---
---Errors: limit (more than 2147483647 bytes), invalid (no such rank, or another tag), io (rank 0 has left).
---@param rank integer (index from 0) the receiver
---@param tag integer (-) what it is about. Range: 0 to 1000
---@param bytes string what is sent
---@return boolean? sent true
---@return string? message
---@return bw.Details? details
function Distributed.send(rank, tag, bytes) end

---The next byte string from any rank; nil alone where none came in time.
---
---Errors: io (rank 0 has left), cancelled (Ctrl-C).
---@param seconds? number (s) how long it waits; negative: as long as it takes. Default: -1
---@return integer? rank (index from 0) the sender
---@return integer|string|nil tag (-) what it is about, or the message
---@return string|bw.Details|nil bytes what was sent, or the details
function Distributed.receive(seconds) end

---Ends all ranks at once, with a sentence on standard error.
---@param message string the sentence
function Distributed.abort(message) end

---Versions of MPI, PETSc and SLEPc, a line each.
---
---Errors: unsupported (MPI could not be started).
---@return string? versions the lines
---@return string? message
---@return bw.Details? details
function Distributed.versions() end
