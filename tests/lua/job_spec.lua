-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Lua functions in child processes.
local bw = require "barwright"
local core = require "barwright.core"
local check = require "check"

local function ended(job)
  assert.equal(1, core.wait({job}, 60))
  return job
end

describe("a job", function()
  it("sends a string of any bytes", function()
    local bytes = "a\0b\n\255" .. ("x"):rep(300000)
    local job = ended(core.job(function() return bytes end, {name = "bytes"}))
    assert.equal(bytes, job:result())
    assert.equal(bytes, job:result())
    assert.equal("done", job.state)
    assert.equal("bytes", job.name)
    assert.truthy(job.seconds > 0 and job.processor_seconds >= 0 and job.peak_bytes > 1e6)
    assert.equal("", ended(core.job(function() return "" end)):result())
  end)

  it("leaves the starter as it was", function()
    local seen = 1
    local job = core.job(function()
      seen = 2
      return tostring(seen)
    end)
    assert.equal("2", ended(job):result())
    assert.equal(1, seen)
  end)

  it("can use the engine, with one thread, after the starter's threads were at work", function()
    local threads = bw.threads()
    bw.threads(4)
    local mesh = check.beam {20, 4, 4}
    local function solved()
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      part:fix(mesh.boundary:below(1, 0))
      part:load {on = mesh.boundary:above(1, 1), force = {0, 0, -100}}
      return ("%.17g"):format(assert(part:solve()).von_mises:max())
    end
    local here = solved()
    for _ = 1, 3 do
      local job = ended(core.job(function()
        assert(bw.threads() == 1)
        return solved()
      end, {seconds = 600}))
      assert.equal(here, assert(job:result()))
    end
    assert.equal(here, solved())
    assert.equal(4, bw.threads())
    bw.threads(threads)
  end)

  it("reports how it failed", function()
    local function fails(work, status, text, options)
      local job = ended(core.job(work, options))
      local value, message, details = job:result()
      check.fails(status, text, value, message, details)
      assert.equal(status, job.state)
      return details
    end
    fails(function() return nil, "the mesh was too coarse" end, "failed", "the mesh was too coarse")
    local details = fails(function() return nil, "no", {status = "geometry", facet = 7, file = "a.stl"} end,
      "failed", "no")
    assert.equal("geometry", details.cause)
    assert.equal(7, details.facet)
    assert.equal("a.stl", details.file)
    fails(function() error "went wrong" end, "failed", "job_spec.lua:")
    fails(function() error {1} end, "failed", "table")
    fails(function() return 5 end, "failed", "must return a string")
    fails(function() end, "failed", "must return a string")
    details = fails(function() assert(bw.surface.read "no such file.stl") end, "failed", "no such file.stl")
    assert.equal("io", details.cause)
    details = fails(function() while true do end end, "limit", "0.2 seconds", {seconds = 0.2})
    assert.equal("time", details.limit)
    details = fails(function() while true do end end, "limit", "of computing", {processor_seconds = 0.1})
    assert.equal("time", details.limit)
    details = fails(function()
      local all = {}
      for i = 1, 1e9 do all[i] = ("x"):rep(1e6) .. i end
      return all[1]
    end, "limit", "200 MB", {bytes = 2e8})
    assert.equal("memory", details.limit)
    details = fails(function() assert(core.job(1)) end, "failed", "function expected")
    assert.is_nil(details.limit)
    details = fails(function() os.exit(4) end, "crashed", "exit code 4")
    assert.equal(4, details.exit)
    details = fails(function() os.execute "kill -SEGV $PPID" end, "crashed", "trial 3 crashed with signal 11",
      {name = "trial 3"})
    assert.equal(11, details.signal)
  end)

  it("runs out of the memory it may use in the engine too", function()
    local job = ended(core.job(function()
      local all = {}
      for i = 1, 1000 do all[i] = bw.array.zeros(1e6, 1) end
      return tostring(#all)
    end, {bytes = 3e8}))
    local value, message, details = job:result()
    check.fails("limit", "300 MB", value, message, details)
  end)

  it("writes to its own file, and to nothing else", function()
    local folder = check.folder()
    local path = folder .. "/output.txt"
    local kept = assert(io.open(folder .. "/kept.txt", "w"))
    kept:write "once\n"
    local job = ended(core.job(function()
      print "printed"
      io.stderr:write "said\n"
      local own = assert(io.open(folder .. "/own.txt", "w"))
      own:write "not closed"
      error "and failed"
    end, {output = path}))
    kept:close()
    assert.is_nil(job:result())
    local text = check.read(path)
    for _, piece in ipairs {"printed", "said", "and failed", "stack traceback"} do
      assert.truthy(text:find(piece, 1, true), piece)
    end
    assert.equal("once\n", check.read(folder .. "/kept.txt"))
    assert.equal("not closed", check.read(folder .. "/own.txt"))
    check.fails("io", "no such folder", core.job(function() return "" end, {output = "no such folder/x"}))
  end)

  it("can be many, in any order", function()
    local jobs, numbers, sum = {}, {}, 0
    for i = 1, 30 do
      jobs[i] = core.job(function() return tostring(i * i) end)
      numbers[i] = i
    end
    while #jobs > 0 do
      local at = assert(core.wait(jobs))
      assert.equal(tostring(numbers[at] ^ 2 // 1 | 0), jobs[at]:result())
      sum = sum + numbers[at]
      table.remove(jobs, at)
      table.remove(numbers, at)
    end
    assert.equal(465, sum)
  end)

  it("is waited for as long as asked", function()
    local job = core.job(function() os.execute "sleep 100" return "" end, {name = "sleeper"})
    assert.is_nil(core.wait({job}, 0.05))
    assert.is_nil(core.wait({job}, 0))
    assert.is_nil(core.wait({}, 100))
    check.raises("is running", job.result, job)
    assert.is_nil(job.peak_bytes)
    assert.equal("running", job.state)
    assert.truthy(tostring(job):find("sleeper, running", 1, true))
    job:cancel()
    check.fails("cancelled", "sleeper was cancelled", job:result())
    assert.equal(1, core.wait {job})
    local other <close> = core.job(function() os.execute "sleep 100" return "" end)
    assert.equal("running", other.state)
  end)

  it("reports how far it is", function()
    local job = core.job(function()
      core.report_progress("counting", 0.25)
      os.execute "sleep 100"
      return ""
    end)
    for _ = 1, 2400 do
      core.wait({job}, 0.05)
      if job.stage ~= "" then break end
    end
    assert.equal("counting", job.stage)
    assert.equal(0.25, job.fraction)
    job:close()
  end)

  it("is not waited for by a job, and can have jobs of its own", function()
    local elder = core.job(function() os.execute "sleep 100" return "" end, {name = "elder"})
    local job = ended(core.job(function()
      local ok, message = pcall(core.wait, {elder}, 0)
      assert(not ok and message:find "another process")
      elder:cancel()
      collectgarbage()
      return ended(core.job(function() return "grandchild" end)):result()
    end))
    assert.equal("grandchild", assert(job:result()))
    assert.equal("running", elder.state)
    assert.is_nil(core.wait({elder}, 0))
    elder:close()
  end)

  it("is started with what it needs", function()
    check.raises("function expected", core.job, 1)
    check.raises("did you mean 'seconds'", core.job, function() end, {second = 1})
    check.raises("limits of at least 0 expected", core.job, function() end, {seconds = -1})
    check.raises("a string expected", core.job, function() end, {name = 7})
    check.raises("open jobs", core.wait, {7})
  end)

  it("leaves nothing behind", function()
    -- Not by a child process: popen closes its own end of the pipe at any time after the child has begun.
    local function files() return #assert(core.list_folder "/proc/self/fd") end
    collectgarbage()
    collectgarbage()
    local before = files()
    local _, blocks = core.external()
    for i = 1, 200 do
      local job = ended(core.job(function() return tostring(i) end))
      assert.equal(tostring(i), job:result())
      job:close()
    end
    collectgarbage()
    collectgarbage()
    assert.truthy(files() <= before) -- less where the collector closed an earlier one
    assert.truthy(select(2, core.external()) <= blocks)
  end)

  -- The signal comes while the starter waits: once its shell is gone (so that os.execute has come back) and it
  -- sleeps.
  it("ends with Ctrl-C when the starter decides so", function()
    local folder = check.folder()
    check.write(folder .. "/s.lua", [[
      local core = require "barwright.core"
      local job = core.job(function() os.execute "sleep 100" return "" end)
      os.execute [=[(while kill -0 $$; do sleep 0.01; done
        until grep -q 'State:.S' /proc/$PPID/status; do :; done; kill -INT $PPID) 2>/dev/null &]=]
      local at, message = core.wait({job})
      print(at, message, job.state)
    ]])
    local status, out = check.run(folder .. "/s.lua")
    assert.equal(130, status)
    assert.equal("nil\tcancelled\trunning\n", out)
  end)
end)
