-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The same study under MPI, in the jobs of a Slurm script, under Slurm, and here: the same trials.
local bw = require "barwright"
local check = require "check"

local STUDY = check.root .. "/tests/lua/distributed/study.lua"

local function absolute(path)
  return path:match "^/" and path or os.getenv "PWD" .. "/" .. path
end
local PROGRAM = absolute(check.program)

-- Exit status and output, both streams.
local function run(command)
  local pipe = assert(io.popen(("{ export BARWRIGHT_QUIET=1; %s; } 2>&1"):format(command)))
  local text = pipe:read "a"
  local _, _, status = pipe:close()
  return status, text
end

local function there(program)
  return (os.execute(("PATH=$PATH:/usr/sbin command -v %s >/dev/null 2>&1"):format(program)))
end

local function study_in(folder)
  return assert(loadfile(STUDY))():use_file(folder .. "/cluster.study")
end

-- What of the trials must not depend on where they ran, by key.
local function essence(study)
  local out = {}
  for _, trial in ipairs(assert(study:trials())) do
    out[#out + 1] = ("%s %s %d %.17g %d %s"):format(trial.key, trial.status, trial.seed, trial.point.x,
      trial.point.n, trial.results and ("%.17g %.17g"):format(trial.results.y, trial.results.r) or "none")
  end
  table.sort(out)
  return table.concat(out, "\n")
end

local expected
setup(function()
  local study = study_in(check.folder())
  local trials = assert(study:run {workers = 2})
  local counts = trials:counts()
  assert(counts.done > 15 and counts.failed > 0 and counts.crashed > 0)
  expected = essence(study)
end)

local GROWING = [[
local bw = require "barwright"
return bw.study {name = "grow", variables = {{name = "x", min = 0, max = 1}},
  measures = {{name = "y"}}, objectives = {{name = "y", goal = "min"}},
  design = {"minimise", method = "cobyla", evaluations = 25},
  run = function(point) return {y = (point.x - 0.3) ^ 2} end}]]

local MPIRUN = "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 timeout 600 mpirun --oversubscribe "
  .. "-n %d " .. PROGRAM
local built = io.open(check.root .. "/build/lua/barwright/mpi.so", "rb")
if built then built:close() end
local missing = not built and "barwright was built without MPI (scripts/setup --mpi)"
  or not there "mpirun" and "there is no mpirun"

describe("a study under MPI", function()
  if missing then return pending(missing) end

  it("has the trials that it has here", function()
    local folder = check.folder()
    local status, text = run((MPIRUN .. " study run %s --mpi --file %s/cluster.study"):format(3, STUDY, folder))
    assert.equal(0, status, text)
    assert.equal(expected, essence(study_in(folder)))
    assert.equal(1, select(2, text:gsub("30 trials of study cluster", "")), text)
    -- Again: nothing is run.
    local before = check.read(folder .. "/cluster.study")
    status, text = run((MPIRUN .. " study run %s --mpi --file %s/cluster.study"):format(3, STUDY, folder))
    assert.equal(0, status, text)
    assert.equal(#before, #check.read(folder .. "/cluster.study"))
  end)

  it("is run by designs that grow", function()
    local folder = check.folder()
    check.write(folder .. "/grow.lua", GROWING)
    local status, text = run(("cd %s && " .. MPIRUN .. " study run grow.lua --mpi"):format(folder, 2))
    assert.equal(0, status, text)
    status, text = run(("cd %s && %s study run grow.lua"):format(folder, PROGRAM))
    assert.equal(0, status, text)
    assert.truthy(text:find "minimum y: trial", text)
  end)

  it("ends with a sentence where it cannot be run", function()
    local folder = check.folder()
    local status, text = run((MPIRUN .. " study run %s --mpi --file %s/cluster.study"):format(1, STUDY, folder))
    assert.equal(2, status)
    assert.truthy(text:find("there is no other rank", 1, true), text)
    -- Rank 1 sees another script.
    for i, count in ipairs {5, 6} do
      check.write(("%s/%d.lua"):format(folder, i), check.read(STUDY):gsub("30", tostring(count)))
    end
    status, text = run(("cd %s && " .. MPIRUN .. " study run 1.lua --mpi : -n 1 %s study run 2.lua --mpi")
      :format(folder, 1, PROGRAM))
    assert.truthy(status ~= 0)
    assert.truthy(text:find("rank 1 has loaded another study", 1, true), text)
    -- The file cannot be written: the workers go home.
    status, text = run((MPIRUN .. " study run %s --mpi --file /nowhere/at/all.study"):format(2, STUDY))
    assert.truthy(status ~= 0)
    assert.truthy(text:find("/nowhere/at/all.study", 1, true), text)
  end)

  it("goes on after one of its ranks was killed", function()
    local folder = check.folder()
    -- The first time, one trial kills the rank that started it.
    check.write(folder .. "/killer.lua", (check.read(STUDY):gsub("run = function%(point, trial%)", [[%0
      if trial.number == 17 and not io.open "killed" then
        io.open("killed", "w"):close()
        os.execute "kill -9 $(cut -d' ' -f4 /proc/$PPID/stat)"
      end]])))
    local status, text = run(("cd %s && " .. MPIRUN .. " study run killer.lua --mpi"):format(folder, 3))
    assert.truthy(status ~= 0, text)
    local left = #assert(study_in(folder):trials())
    assert.truthy(left < 30, left)
    status, text = run(("cd %s && " .. MPIRUN .. " study run killer.lua --mpi"):format(folder, 3))
    assert.equal(0, status, text)
    assert.equal(expected, essence(study_in(folder)))
  end)
end)

-- A folder with the study and its job script.
local function job_script(options)
  local folder = check.folder()
  check.write(folder .. "/study.lua", check.read(STUDY))
  local status, text = run(("cd %s && %s study slurm study.lua --jobs 4 %s"):format(folder, PROGRAM,
    options or ""))
  assert.equal(0, status, text)
  return folder, folder .. "/cluster.sbatch"
end

describe("a job script for Slurm", function()
  it("runs its parts and merges them", function()
    local folder, script = job_script "--time 1:00:00 --mem 4G --partition short --account nobody --cpus 2"
    local text = check.read(script)
    for _, line in ipairs {"--array=1-4", "--time=1:00:00", "--mem=4G", "--partition=short", "--account=nobody",
      "--cpus-per-task=2", "--job-name=cluster"} do
      assert.truthy(text:find("\n#SBATCH " .. line .. "\n", 1, true), line)
    end
    -- As Slurm would: each job has its number in the environment, and starts in some other folder.
    for i = 4, 1, -1 do
      local status, said = run(("cd / && SLURM_ARRAY_TASK_ID=%d SLURM_CPUS_PER_TASK=2 bash %s"):format(i, script))
      assert.equal(0, status, said)
    end
    local status, said = run(("cd / && bash %s merge"):format(script))
    assert.equal(0, status, said)
    assert.equal(expected, essence(study_in(folder)))
    status, said = run(("cd / && bash %s merge && bash %s run 2"):format(script, script))
    assert.equal(0, status, said)
    assert.equal(expected, essence(study_in(folder)))
    status, said = run(("bash %s"):format(script))
    assert.truthy(status ~= 0)
    assert.truthy(said:find("submit", 1, true), said)
  end)

  it("is refused for designs that grow", function()
    local folder = check.folder()
    check.write(folder .. "/grow.lua", GROWING)
    local status, text = run(("cd %s && %s study slurm grow.lua --jobs 4"):format(folder, PROGRAM))
    assert.equal(2, status)
    assert.truthy(text:find("depends on results", 1, true), text)
  end)

  it("is obeyed by Slurm", function()
    if not (there "slurmctld" and there "slurmd" and there "munged" and there "sbatch") then
      return pending "there is no Slurm (slurmctld, slurmd, slurm-client, munge)"
    end
    local cluster = check.folder() .. "/slurm"
    local starter = ("%s/tests/lua/distributed/slurm"):format(check.root)
    local status, text = run(("%s start %s"):format(starter, cluster))
    local stop <close> = setmetatable({}, {__close = function() run(("%s stop %s"):format(starter, cluster)) end})
    assert(stop)
    assert.equal(0, status, text)
    local folder, script = job_script "--time 5"
    local slurm = ("export SLURM_CONF=%s/slurm.conf; "):format(cluster)
    status, text = run(slurm .. "bash " .. script .. " submit")
    assert.equal(0, status, text)
    assert.truthy(text:find "^array %d+, merge %d+", text)
    run(slurm .. "for i in $(seq 3000); do [ -z \"$(squeue -h)\" ] && break; sleep 0.2; done")
    assert.equal(expected, essence(study_in(folder)))
    assert.truthy(check.read(folder .. "/cluster.parts/merge.log"):find "30 trials taken from 4 files")
  end)
end)

describe("without MPI", function()
  it("a study says what is missing", function()
    local status, text = run(("%s -e \"package.preload['barwright.mpi'] = function() error 'none' end\" "
      .. "study run %s --mpi"):format(PROGRAM, STUDY))
    assert.equal(3, status)
    assert.truthy(text:find("scripts/setup --mpi", 1, true), text)
    assert.truthy(bw)
  end)
end)
