-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
local bw = require "barwright"
local check = require "check"

local quoted, script = check.quoted, check.script

-- Starts the program on a script, interrupts it as soon as the script has written the file "ready"
-- (and `times` times in all), returns exit status, output, errors and the folder.
local function interrupted(text, times)
  local folder = check.folder()
  check.write(folder .. "/script.lua", text)
  local command = ([[cd %s && { BARWRIGHT_QUIET=1 '%s' script.lua >out 2>err & pid=$!; n=0
    while [ ! -e ready ] && [ $n -lt 2400 ]; do sleep 0.05; n=$((n+1)); done
    for i in $(seq %d); do sleep 0.2; kill -INT $pid; done; wait $pid; }]]):format(folder,
    check.program:match "^/" and check.program or os.getenv "PWD" .. "/" .. check.program, times or 1)
  local _, _, status = os.execute(command)
  return status, check.read(folder .. "/out"), check.read(folder .. "/err"), folder
end

describe("the program", function()
  it("tells its version and the libraries it stands on", function()
    local status, out = check.run "--version"
    assert.equal(0, status)
    assert.truthy(out:find("barwright " .. bw.version(), 1, true))
    assert.truthy(out:find "OpenBLAS")
    assert.truthy(out:find "Lua 5.4")
    status, out = check.run "--help"
    assert.equal(0, status)
    assert.truthy(out:find "usage: barwright")
  end)

  it("runs statements and scripts with arguments", function()
    local status, out = check.run "-e 'print(bw.material.steel.young)'"
    assert.equal(0, status)
    assert.equal("210000000000.0\n", out)
    status, out = check.run(script "print(arg[0]:match '[^/]*$', arg[1], arg[2], ..., #arg)" .. " a 'b c'")
    assert.equal(0, status)
    assert.equal("script.lua\ta\tb c\ta\t2\n", out)
  end)

  it("ends with a status that tells", function()
    local status, _, err = check.run "-e 'error \"oh dear\"'"
    assert.equal(1, status)
    assert.truthy(err:find "oh dear" and err:find "traceback")
    status, _, err = check.run "-e 'x ='"
    assert.equal(1, status)
    assert.truthy(err:find "near <eof>")
    assert.equal(7, (check.run(script "os.exit(7)")))
    status, _, err = check.run "--verison"
    assert.equal(2, status)
    assert.truthy(err:find("did you mean '--version'", 1, true))
    assert.equal(3, (check.run "no/such/script.lua"))
  end)

  it("is a prompt", function()
    local input = check.folder() .. "/input"
    check.write(input, "1 + 1\nfor i = 1, 2 do\nprint('i', i)\nend\nx = 5\nx * 2, 'two'\nerror 'oops'\n"
      .. "nil, 'why'\nbw.material.stel\nlocal s <close> = bw.surface.sphere{radius=1}\n'end'\n=\n")
    local status, out, err = check.run("", input)
    assert.equal(0, status)
    assert.equal("2\ni\t1\ni\t2\n10\ttwo\nnil\twhy\nend\n", out)
    assert.truthy(err:find "oops")
    assert.truthy(err:find "prompt:1: there is no material 'stel': did you mean 'steel'")
  end)

  it("works under a collector that runs at every allocation", function()
    local status, out, err = check.run("--gc-stress " .. script [[
      local bw = require "barwright"
      local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 0.1, 0.1}, cells = {6, 1, 1}}
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      local tip = mesh.boundary:above(1, 1) | mesh.boundary:near({1, 0, 0}, 0.01)
      part:fix(mesh.boundary:below(1, 0)):load {on = tip, force = {0, 0, -1}}
      local static = assert(part:solve())
      local modes = assert(part:modes {count = 2})
      local a = static.von_mises:gather(mesh.boundary.nodes):map("a * 2 + b", {b = 1}):sorted()
      part:clear_supports()
      local worst = assert(bw.worst_case(part, {force = 1, pressure = 1e6, modes = 2, regions = 1}))
      assert(worst:displacement())
      assert(#worst:arrows() > 0 and tostring(worst) and tostring(part) and tostring(modes))
      local surface = bw.surface.implicit(function(x, y, z) return x * x + y * y + z * z - 0.5 end,
        {min = {-1, -1, -1}, max = {1, 1, 1}, cells = 4})
      assert(surface:check().sound and surface:check() and #bw.json.encode(worst.regions) > 10)
      local solid, log = assert(bw.mesh.fill(bw.surface.sphere {radius = 0.1, subdivisions = 1}))
      assert(tostring(log) and solid:locate {0, 0, 0} and #solid:quality() == 0)
      local path = os.tmpname()
      assert(surface:write(path .. ".ply") and bw.surface.read(path .. ".ply"))
      assert(static:write(path .. ".vtu") and bw.mesh.read(path .. ".vtu"))
      assert(worst:write(path .. ".vtu") and worst:report(path .. ".html", {modes = 1, loads = 1}))
      assert(worst:picture(path .. ".png", {width = 120, height = 90}))
      for _, ending in ipairs {"", ".ply", ".vtu", ".html", ".png"} do os.remove(path .. ending) end
      assert(bw.brute_force(part, {force = 1, pressure = 1e6, elements = 3}):compare(worst).ratio > 0)
      assert(bw.drop_test(part, {drops = 3}):correlation(worst))
      print(a:max() > 0 and "survived")
    ]])
    assert.equal("", err)
    assert.equal("survived\n", out)
    assert.equal(0, status)
  end)
end)

describe("an interrupt", function()
  it("ends a script that computes in Lua", function()
    local status, _, err = interrupted "io.open('ready', 'w'):close() while true do end"
    assert.equal(130, status)
    assert.truthy(err:find "interrupted")
  end)

  it("stops the engine, and the script keeps what is done", function()
    local status, out, _, folder = interrupted [[
      local bw = require "barwright"
      local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {26, 26, 26}}
      local part = bw.model {mesh = mesh, material = bw.material.steel}
      local message, details = true
      bw.progress(function() if message == true then message = nil io.open('ready', 'w'):close() end end)
      local worst
      worst, message, details = bw.worst_case(part, {force = 20, pressure = 1e5, modes = 200})
      print(worst, details and details.status, bw.interrupted())
      assert(mesh:write "kept.vtu")
    ]]
    assert.equal(130, status)
    assert.equal("nil\tcancelled\ttrue\n", out)
    assert.truthy(io.open(folder .. "/kept.vtu"))
    for name in io.popen("ls " .. folder):lines() do assert.is_nil(name:find "partial") end
  end)

  it("ends the replay of edits as an interruption, not as a fault of theirs", function()
    local status, out = interrupted [[
      local bw = require "barwright"
      local file <close> = io.open("edits.lua", "w")
      file:write("io.open('ready', 'w'):close() while true do end\n"):flush()
      local session, message, details = bw.edit.load "edits.lua"
      print(session, message, details.status)
    ]]
    assert.equal(130, status)
    assert.equal("nil\tedits.lua was interrupted while it was replayed: line 1: interrupted\tcancelled\n", out)
  end)

  it("ends a script that goes on regardless, the second time", function()
    local status = interrupted([[
      io.open('ready', 'w'):close()
      while true do pcall(function() while true do end end) end
    ]], 3)
    assert.equal(130, status)
  end)
end)

describe("a signal to end", function()
  it("leaves no half-written file", function()
    local folder = check.folder()
    check.write(folder .. "/script.lua", [[
      local bw = require "barwright"
      local mesh = bw.mesh.box {min = {0, 0, 0}, max = {1, 1, 1}, cells = {30, 30, 30}}
      io.open('ready', 'w'):close()
      while true do mesh:write "big.vtu" end
    ]])
    os.execute(([[cd %s && { BARWRIGHT_QUIET=1 '%s' script.lua & pid=$!; n=0
      while [ ! -e ready ] && [ $n -lt 2400 ]; do sleep 0.05; n=$((n+1)); done
      sleep 0.3; kill -TERM $pid; wait $pid; } 2>/dev/null]]):format(folder,
      check.program:match "^/" and check.program or os.getenv "PWD" .. "/" .. check.program))
    for name in io.popen("ls " .. folder):lines() do assert.is_nil(name:find "partial", name) end
  end)
end)

describe("progress", function()
  it("comes with stages and fractions, and can stop the work", function()
    local mesh = check.beam({20, 4, 4})
    local part = bw.model {mesh = mesh, material = bw.material.pla}
    local stages, calls = {}, 0
    bw.progress(function(stage, fraction)
      assert(fraction >= 0 and fraction <= 1)
      stages[stage] = true
      calls = calls + 1
    end)
    assert(bw.worst_case(part, {force = 1, pressure = 1e6, modes = 3, regions = 2}))
    assert.truthy(calls > 3)
    assert.truthy(next(stages))
    bw.progress(function() return false end)
    check.fails("cancelled", "", bw.worst_case(part, {force = 1, pressure = 1e6, modes = 4}))
    bw.progress(function() error "in the callback" end)
    check.raises("in the callback", bw.worst_case, part, {force = 1, pressure = 1e6, modes = 5})
    bw.progress(function() return bw.threads(1) end)
    check.raises("busy", bw.worst_case, part, {force = 1, pressure = 1e6, modes = 5})
    bw.progress(nil)
    assert(bw.worst_case(part, {force = 1, pressure = 1e6, modes = 2}))
    check.raises("", bw.progress, 5)
  end)
end)

describe("scripts/worst_case/run.lua", function()
  local run = quoted(check.root .. "/scripts/worst_case/run.lua") .. " "

  it("answers for a surface", function()
    local folder = check.folder()
    local path = folder .. "/rod.stl"
    assert(bw.surface.cylinder {axis = {0, 0, 0.1}, radius = 0.01, segments = 24}:write(path))
    local status, out, err = check.run(run .. path
      .. " --elements 1500 --modes 4 --regions 2 --out " .. folder .. "/out")
    assert.equal("", err)
    assert.equal(0, status)
    assert.truthy(out:find "MPa at %(")
    assert.truthy(out:find("On this mesh that is [%d.]+ %% of the strength of pla; error unknown: one mesh"), out)
    assert.is_nil(out:find("holds", 1, true))
    local result = assert(bw.json.decode(check.read(folder .. "/out/result.json")))
    for _, key in ipairs {"elements", "nodes", "surface_moved_m", "max_principal_pa", "utilisation",
      "seconds_repair", "seconds_remesh", "seconds_fill", "seconds_assemble", "seconds_factor",
      "seconds_modes", "seconds_regions", "seconds_linear_programs", "seconds_total", "peak_memory_bytes",
      "force_n"} do
      assert.equal("number", type(result[key]), key)
    end
    assert.is_false(result.repaired)
    assert.is_true(result.finished)
    check.near(1500, result.elements, 0.2)
    assert.equal(3, #result.max_principal_at_m)
    for _, region in ipairs(result.regions) do
      assert.truthy((region.origin == "mode" and region.mode and region.rank) or region.target)
      assert.truthy(region.volume_fraction and region.seconds)
      assert.truthy(region.max_principal_pa <= result.max_principal_pa)
    end
    for _, name in ipairs {"weakness.png", "worst_load.png", "worst.vtu", "report.html", "manifest.json"} do
      assert.truthy(#check.read(folder .. "/out/" .. name) > 100, name)
    end
    local manifest = assert(bw.json.decode(check.read(folder .. "/out/manifest.json")))
    assert.equal(path, manifest.inputs[1].file)
    assert.equal(4, manifest.options.modes)
    assert.same({}, {manifest.options.model, manifest.options.out})
  end)

  it("takes a mesh as it is, and lowers a force that the surface cannot take", function()
    local folder = check.folder()
    assert(check.beam({8, 2, 2}):scale(0.02):write(folder .. "/beam.vtu"))
    local status, out = check.run(run .. folder
      .. "/beam.vtu --modes 3 --regions 1 --material zp150 --out " .. folder .. "/out")
    assert.equal(0, status)
    assert.truthy(out:find "force is lowered")
    local result = assert(bw.json.decode(check.read(folder .. "/out/result.json")))
    assert.equal(192, result.elements)
    assert.is_true(result.force_lowered)
    check.near(0.05 * 2e5 * result.area_m2, result.force_n, 1e-9)
  end)

  it("takes supports, forbidden places, a contact, friction and hands", function()
    local folder = check.folder()
    assert(check.beam({8, 2, 2}):scale(0.02):write(folder .. "/beam.vtu"))
    local status, out, err = check.run(run .. folder .. "/beam.vtu --modes 3 --regions 1 --force 2"
      .. " --contact 2e-5m2"
      .. " --fix min:x --forbid max:z --forbid=max:y --friction 0.3 --friction-facets 4 --hands 1 --hand 1cm2"
      .. " --certify 0.05 --out " .. folder .. "/out")
    assert.equal("", err)
    assert.equal(0, status)
    assert.truthy(out:find("friction 0.3, the cone by 4 facets (29 % narrower at most)", 1, true))
    local result = assert(bw.json.decode(check.read(folder .. "/out/result.json")))
    check.near(1e5, result.pressure_pa, 1e-12)
    check.near(1 - math.sqrt(0.5), result.friction_error, 1e-12)
    assert.truthy(result.supported_area_m2 > 0 and result.forbidden_area_m2 > result.supported_area_m2)
    assert.truthy(result.upper_bound_pa >= result.max_principal_pa)
    check.near(result.gap, result.upper_bound_pa / result.max_principal_pa - 1, 1e-9)
    local code, _, said = check.run(run .. folder .. "/beam.vtu --fix lwo:z --out " .. folder .. "/out")
    assert.equal(2, code)
    assert.truthy(said:find("is no place", 1, true))
    code, _, said = check.run(run .. folder .. "/beam.vtu --pressure 1 --contact 1m2 --out x")
    assert.equal(2, code)
    assert.truthy(said:find("say the same", 1, true))
  end)

  it("refuses with status 2 and one sentence", function()
    local folder = check.folder()
    check.write(folder .. "/bad.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n")
    for arguments, text in pairs {
      [folder .. "/bad.stl --out " .. folder .. "/o"] = "bad.stl",
      [folder .. "/missing.stl --out " .. folder .. "/o"] = "missing.stl",
      [folder .. "/bad.stl"] = "--out DIR is missing",
      ["--out " .. folder .. "/o"] = "MODEL is missing",
      ["x.stl --elemnts 5 --out " .. folder .. "/o"] = "did you mean --elements",
      ["x.stl --elements many --out " .. folder .. "/o"] = "a whole number from 1 up to 100000000 expected",
      [folder .. "/bad.stl --material stel --out " .. folder .. "/o"] = "did you mean 'steel'",
    } do
      local status, _, err = check.run(run .. arguments)
      assert.equal(2, status, arguments .. ": " .. err)
      assert.truthy(err:find(text, 1, true), err)
      assert.equal(1, select(2, err:gsub("\n", "")), err)
    end
  end)
end)
