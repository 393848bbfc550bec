-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Wrong and awkward input to scripts/worst_case/run.lua: it answers (0), refuses in one sentence that
-- names the place (2), or says that it could not finish (3), and leaves no part of a file behind.
local bw = require "barwright"
local check = require "check"

local run = check.root .. "/scripts/worst_case/run.lua"

local quoted = check.quoted

local function files_of(folder)
  local list = {}
  local pipe = assert(io.popen("ls -A " .. quoted(folder) .. " 2>/dev/null"))
  for name in pipe:lines() do list[#list + 1] = name end
  pipe:close()
  return list
end

-- Exit status, errors, folder of results, output. Nothing here hangs.
local function worst(model, options, before, given)
  local folder = check.folder()
  local out = given or folder .. "/out"
  local _, _, status = os.execute(("%s BARWRIGHT_QUIET=1 timeout -k 5 600 %s %s %s --out %s %s"
    .. " >%s/output 2>%s/errors </dev/null"):format(before or "", quoted(check.program), quoted(run),
    quoted(model), quoted(out), options or "", folder, folder))
  return status, check.read(folder .. "/errors"), out, check.read(folder .. "/output")
end

local function refused(text, model, options)
  local status, errors, out = worst(model, options)
  assert.equal(2, status, errors)
  assert.truthy(errors:find(text, 1, true), errors)
  assert.equal(1, select(2, errors:gsub("\n", "\n")), errors)
  assert.same({}, files_of(out))
end

local small = "--elements 300 --modes 2 --regions 1"

local function answered(model, options)
  local status, errors, out, output = worst(model, options or small)
  assert.equal(0, status, errors)
  assert.equal("", errors)
  assert.same({"manifest.json", "report.html", "result.json", "weakness.png", "worst.vtu",
    "worst_load.png"}, files_of(out))
  assert.truthy(bw.json.decode(check.read(out .. "/result.json")).finished)
  return output
end

local corner = {[0] = "0 0 0", "1 0 0", "0 1 0", "1 1 0", "0 0 1", "1 0 1", "0 1 1", "1 1 1"}
local facet = {"0 2 3", "0 3 1", "4 5 7", "4 7 6", "0 1 5", "0 5 4", "2 6 7", "2 7 3", "0 4 6",
  "0 6 2", "1 3 7", "1 7 5"}

-- Cubes, each {x, y, z, edge}, as an OFF file.
local function cubes(list, name)
  local lines = {"OFF", ("%d %d 0"):format(8 * #list, 12 * #list)}
  for _, c in ipairs(list) do
    for i = 0, 7 do
      local x, y, z = corner[i]:match "(%d) (%d) (%d)"
      lines[#lines + 1] = ("%.17g %.17g %.17g"):format(c[1] + x * c[4], c[2] + y * c[4],
        c[3] + z * c[4])
    end
  end
  for n = 0, #list - 1 do
    for _, f in ipairs(facet) do
      lines[#lines + 1] = "3 " .. f:gsub("%d", function(i) return ("%d"):format(i + 8 * n) end)
    end
  end
  local path = check.folder() .. "/" .. (name or "cubes.off")
  check.write(path, table.concat(lines, "\n") .. "\n")
  return path
end

local function file(name, text)
  local path = check.folder() .. "/" .. name
  check.write(path, text)
  return path
end

describe("wrong input", function()
  it("that is no file, or has no end, is refused at once", function()
    refused("/dev/zero: cannot be read: it is not a regular file", "/dev/zero")
    refused("it is a directory", check.folder())
    refused("No such file", "/nowhere/x.stl")
    refused("MODEL: a value expected", "")
    local pipe = check.folder() .. "/pipe.stl"
    assert(os.execute("mkfifo " .. quoted(pipe)))
    refused("it is not a regular file", pipe)
  end)

  it("of another kind is refused with what was found", function()
    refused("gzip", file("packed.stl", "\x1f\x8b\x08\0\0\0\0\0"))
    refused("found '<html>404", file("page.stl", "<html>404</html>\n"))
    refused("PNG picture", file("photo.stl", "\x89PNG\r\n\x1a\n" .. ("\xff"):rep(500)))
    refused("1 hexahedra", file("hexahedron.msh", "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n"
      .. "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n$EndNodes\n"
      .. "$Elements\n1\n1 5 0 1 2 3 4 5 6 7 8\n$EndElements\n"))
  end)

  it("of impossible sizes is refused with the file's name", function()
    refused("huge.off: the bounding box of the surface", cubes({{0, 0, 0, 1e200}}, "huge.off"))
    refused("tiny.off: a surface of 12 facets in a box", cubes({{0, 0, 0, 1e-200}}, "tiny.off"))
  end)

  it("in the options is refused before the model is touched", function()
    local cube = cubes {{0, 0, 0, 10}}
    for options, text in pairs {
      ["--elements 0"] = "--elements: a whole number from 1", ["--elements -5"] = "got '-5'",
      ["--elements abc"] = "got 'abc'", ["--elements 1e12"] = "got '1e12'",
      ["--elements"] = "option --elements: a value is missing",
      ["--modes 5000"] = "from 1 up to 500", ["--modes 2.5"] = "got '2.5'",
      ["--force -1"] = "--force: a number of N above 0", ["--pressure 0"] = "--pressure: a number of Pa above 0",
      ["--pressure nan"] = "got 'nan'", ["--fraction 2"] = "up to 1", ["--threads 1000"] = "up to 64",
      ["--order 3"] = "one of 1, 2 expected", ["--elemnts 5"] = "did you mean --elements",
      ["--material unobtainium"] = "--material: 'unobtainium' is not known",
      ["--unit parsec"] = "--unit: 'parsec' is not known", ["second.stl"] = "one argument too many",
    } do
      refused(text, cube, options)
    end
    local status, errors = worst(cube, small, nil, "/proc/nothing")
    assert.equal(2, status)
    assert.truthy(errors:find("/proc/nothing: cannot be made as a folder", 1, true), errors)
    local help, output = check.run(quoted(run) .. " --help")
    assert.equal(0, help)
    assert.truthy(output:find("--elements N", 1, true))
  end)
end)

describe("awkward input", function()
  it("is answered, whatever the name of the file", function()
    answered(cubes({{0, 0, 0, 10}}, "it's a \"näme\" <b>&.off"))
  end)

  it("may be a body stressed evenly", function()
    answered(cubes {{0, 0, 0, 10}}, "--elements=16 --modes 4 --regions 2")
  end)

  it("may be far away, or several bodies", function()
    answered(cubes {{1e7, 1e7, 1e7, 10}})
    local output = answered(cubes {{0, 0, 0, 10}, {30, 0, 0, 10}})
    assert.truthy(output:find("mm from (0, 0, 0) mm, 2 bodies\n", 1, true), output)
  end)

  it("may touch along an edge, at a corner, or lack a facet", function()
    answered(cubes {{0, 0, 0, 10}, {10, 10, 0, 10}})
    answered(cubes {{0, 0, 0, 10}, {10, 10, 10, 10}})
    local path = cubes {{0, 0, 0, 10}}
    local text = check.read(path):gsub("8 12 0", "8 11 0"):gsub("[^\n]*\n$", "")
    check.write(path, text)
    answered(path)
  end)
end)
