-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Several processes under MPI: large solves by PETSc and SLEPc, and byte strings between ranks. Nothing
-- of it is loaded before this file is required; a solver with the backend "petsc" requires it by itself.
--
--   mpirun -n 4 barwright --mpi script.lua
--
-- runs the script on rank 0; the other ranks wait until it solves something. With the stock interpreter
-- the script begins with  require("barwright.distributed").start().
local distributed = {}

local found, mpi = pcall(require, "barwright.mpi")
if not found then
  local why = tostring(mpi)
  why = why:find("module 'barwright.mpi' not found", 1, true) and "it was built without them" or why
  error(("this barwright has no MPI, PETSc and SLEPc: %s. On Debian 12, scripts/setup --mpi installs them "
    .. "(openmpi-bin, libopenmpi-dev, libpetsc-real-dev, libslepc-real-dev) and builds again"):format(why), 0)
end

--- Join the other processes that mpirun started. On rank 0 it returns the number of ranks; on the others
--- it does not return: they work for rank 0 until it ends, and end then.
function distributed.start()
  local rank, size = mpi.start(true)
  if not rank then return nil, size end
  if rank > 0 then
    mpi.serve()
    os.exit(0, true)
  end
  return size
end

--- Join without serving: this rank (from 0) and the number of ranks. For programs whose ranks talk by
--- send and receive.
function distributed.join() return mpi.start(true) end

--- For solves with an option `with`: a world of one, where none was joined.
function distributed.ready() return mpi.start(false) end

distributed.rank = mpi.rank
distributed.size = mpi.size
distributed.send = mpi.send
distributed.receive = mpi.receive
distributed.abort = mpi.abort
distributed.versions = mpi.versions

return distributed
