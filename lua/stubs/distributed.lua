---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Several processes
--
-- Processes that `mpirun` started.

---require "barwright.distributed": the processes that mpirun started. Raises where barwright was built
---without MPI. A solve with `with = "petsc"` loads it by itself; `barwright --mpi` calls start.
---@class bw.Distributed
local Distributed = {}

---Join the others. On rank 0 it returns the number of ranks; on the others it does not return: they work
---for the solves of rank 0 and end with it.
---@return integer? size
---@return string? message
function Distributed.start() end

---Join without serving, for programs whose ranks talk by send and receive.
---@return integer? rank from 0
---@return integer|string size or a message
function Distributed.join() end

---A world of one where none was joined; refused under mpirun without start.
---@return integer? rank
---@return integer|string size or a message
function Distributed.ready() end

---@return integer rank from 0
function Distributed.rank() end

---@return integer size
function Distributed.size() end

---@param rank integer
---@param tag integer 0 to 1000
---@param bytes string
---@return boolean?
---@return string? message
---@return bw.Details? details
function Distributed.send(rank, tag, bytes) end

---The next string from any rank; nil when none came in time (negative: wait as long as it takes).
---@param seconds number
---@return integer? rank
---@return integer|string? tag or a message
---@return string? bytes
function Distributed.receive(seconds) end

---End all ranks now, with a sentence on standard error.
---@param message string
function Distributed.abort(message) end

---Versions of MPI, PETSc and SLEPc, a line each.
---@return string?
function Distributed.versions() end
