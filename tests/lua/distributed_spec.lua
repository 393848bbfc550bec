-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Several processes, started by mpirun. Skipped where barwright was built without MPI.
local check = require "check"

-- Open MPI refuses to run as root and to start more ranks than processors without options that allow it.
local MPIRUN = "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 BARWRIGHT_QUIET=1 BARWRIGHT_THREADS=1 "
  .. "LUA_PATH='" .. check.root .. "/tests/lua/?.lua;;' timeout %d mpirun --oversubscribe --bind-to none -n %d "

local built = io.open(check.root .. "/build/lua/barwright/mpi.so", "rb")
local mpirun = os.execute "command -v mpirun >/dev/null 2>&1"
local missing = not built and "barwright was built without MPI (scripts/setup --mpi)"
  or not mpirun and "there is no mpirun"
if built then built:close() end

-- Exit status and output, both streams.
local function run(ranks, seconds, command)
  local pipe = assert(io.popen(MPIRUN:format(seconds, ranks) .. command .. " 2>&1"))
  local text = pipe:read "a"
  local _, _, status = pipe:close()
  return status, text
end

if missing then
  describe("several ranks", function() pending(missing) end)
  return
end

local CASES = {"static tet4 cg", "static tet10 cg", "static tet4 cholesky", "static tet10 cholesky",
  "rotated supports tet4 cg", "rotated supports tet10 cg", "rotated supports tet4 cholesky",
  "rotated supports tet10 cholesky", "free tet4 cg", "free tet10 cg", "free tet4 cholesky", "free tet10 cholesky",
  "orthotropic material", "B-bar elements", "curved elements", "many rows",
  "few iterations",
  "modes tet4", "modes tet10", "free modes tet4", "free modes tet10", "modes by conjugate gradients",
  "rotated modes", "worst case cg", "worst case cholesky", "breaking force", "many right-hand sides",
  "results by pieces", "results that cannot be written", "the error in energy",
  "failures come back, and work goes on", "a body that is nearly a mechanism is refused",
  "misuse", "a forked job has no ranks", "the same numbers again"}

for _, ranks in ipairs {2, 1} do
  describe(("%d rank%s"):format(ranks, ranks > 1 and "s" or ""), function()
    local status, text
    setup(function()
      local command = ("%s --mpi %s/tests/lua/distributed/cases.lua"):format(check.program, check.root)
      status, text = run(ranks, 300, command)
    end)
    for _, name in ipairs(CASES) do
      it("agree with the engine: " .. name, function()
        local said = text:match("case " .. name:gsub("%p", "%%%0") .. ": ([^\n]*)")
        if said ~= "ok" then -- exit status 124: ended by the bound of time
          error(said or ("exit status %d after\n%s"):format(status, text))
        end
      end)
    end
  end)
end

describe("ranks", function()
  it("run the script once, and end with it", function()
    local status, text = run(3, 600, check.program .. " --mpi "
      .. check.script "print(require('barwright.distributed').size()) os.exit(3)")
    assert.equal(3, status)
    assert.equal("3\n", text:match "^[^\n]*\n")
  end)

  it("are refused without --mpi", function()
    local _, text = run(2, 600, check.program .. " " .. check.script [[
      local bw = require "barwright"
      local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {1, 1, 1}}
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      local solver = bw.solver.cholesky {backend = "petsc"}
      print(select(2, part:fix(mesh.boundary:below(1, 0)):solve {solver = solver}))]])
    local count = select(2, text:gsub("mpirun started 2 processes, and each runs this script by itself", ""))
    assert.equal(2, count)
  end)

  it("end when one of them dies", function()
    local status = run(2, 600, check.program .. " " .. check.script [[
      local d = require "barwright.distributed"
      local rank = d.join()
      if rank == 1 then os.execute "kill -9 $PPID" end
      d.receive(3600)]])
    assert.truthy(status ~= 0 and status ~= 124) -- 124: ended by the bound of time
  end)

  it("send each other strings of bytes", function()
    local _, text = run(3, 600, check.program .. " " .. check.script [[
      local d = require "barwright.distributed"
      local rank = d.join()
      if rank == 0 then
        for r = 1, 2 do d.send(r, 7, ("x"):rep(r * 100000) .. "\0end") end
        for _ = 1, 2 do
          local from, tag, bytes = d.receive(30)
          print(from, tag, bytes)
        end
        print(d.receive(0.01))
        print((select(2, d.send(3, 1, ""))))
      else
        local from, tag, bytes = d.receive(30)
        if rank == 2 then d.receive(0.2) end
        d.send(0, rank, from .. " " .. tag .. " " .. #bytes .. " " .. bytes:sub(-3))
      end]])
    assert.equal("1\t1\t0 7 100004 end\n2\t2\t0 7 200004 end\nnil\n"
      .. "rank 3 is not another rank: there are 3, numbered from 0\n", text)
  end)

  it("work with the stock interpreter", function()
    local _, text = run(2, 600, ("env LUA_PATH='%s/build/lua/?.lua;%s/build/lua/?/init.lua;;' "
      .. "LUA_CPATH='%s/build/lua/?.so;;' lua5.4 "):format(check.root, check.root, check.root) .. check.script [[
      print(require("barwright.distributed").start())
      local bw = require "barwright"
      local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {2, 2, 2}}
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      part:fix(mesh.boundary:below(1, 0)):load {on = mesh.boundary:above(1, 1), force = {1, 0, 0}}
      print(assert(part:solve {solver = bw.solver.cholesky {backend = "petsc"}}).report.ranks)]])
    assert.equal("2\n2\n", text)
  end)
end)

describe("the command worst", function()
  it("solves on one process and on several", function()
    local path, numbers = check.folder() .. "/bar.vtu", {}
    assert(check.beam({6, 2, 2}, 2):write(path))
    local words = (" worst %s --force 10N --modes 2 --regions 1 --elements 200 --json --solver "):format(path)
    for _, command in ipairs {check.program .. words .. "multifrontal", check.program .. words .. "petsc",
      MPIRUN:format(600, 2) .. check.program .. " --mpi" .. words .. "petsc"} do
      local text = io.popen("BARWRIGHT_QUIET=1 " .. command .. " 2>/dev/null"):read "a"
      numbers[#numbers + 1] = tonumber(text:match '"breaking_force_n": ([%d.e+-]+)') or error(text)
    end
    for k = 2, 3 do check.near(numbers[1], numbers[k], 1e-6) end
  end)
end)

describe("MPI", function()
  it("is loaded only when asked for", function()
    local _, out = check.run(check.script [[
      local bw = require "barwright"
      local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {1, 1, 1}}
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      assert(part:fix(mesh.boundary:below(1, 0)):solve())
      for line in io.lines "/proc/self/maps" do
        if line:find "libmpi" or line:find "petsc" then print(line) end
      end]])
    assert.equal("", out)
  end)
end)
