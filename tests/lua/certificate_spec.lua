-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Certificates of the worst case's upper bound (docs/theory/worst_case.md, section 14): what they prove, for each
-- kind of load, and that wrong ones are rejected.
local bw = require "barwright"
local check = require "check"

local box = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.01}, cells = {5, 2, 1}})

local function part_on(mesh, fixed, material)
  local part = bw.model {mesh = mesh, material = material or bw.material.pla}
  if fixed then part:fix(mesh.boundary:below(1, 0)) end
  return part
end

local read, write = check.read, check.write

local path = os.tmpname()

local function certified(part, more)
  local opts = {force = 5, pressure = 2e5, modes = 2, regions = 2, targets = 4, certify = 0.02, certificate = path}
  for key, value in pairs(more or {}) do opts[key] = value end
  return assert(bw.worst_case(part, opts))
end

-- What is left when the text is changed once.
local function changed(text, pattern, by)
  local now, count = text:gsub(pattern, by, 1)
  assert.equal(1, count)
  return bw.check_certificate(write(path, now))
end

describe("a certificate", function()
  teardown(function() os.remove(path) end)

  it("proves the bound for every kind of load", function()
    local slid = part_on(box)
    slid:slide(box.boundary:below(1, 0))
    slid:slide(box.boundary:below(3, 0), {0, 0, 1})
    local wood = bw.material.orthotropic {young = {12e9, 0.9e9, 0.5e9}, poisson = {0.3, 0.02, 0.35},
      shear = {0.1e9, 0.7e9, 0.8e9}, axes = {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}}
    local quadratic = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.1, 0.02, 0.01}, cells = {3, 1, 1}, order = 2})
    local top = box.boundary:facing {0, 0, 1}
    local cases = {
      free = {part_on(box)}, fixed = {part_on(box, true)}, slid = {slid}, wood = {part_on(box, true, wood)},
      quadratic = {part_on(quadratic)}, force_is_max = {part_on(box), {force_is_max = true}},
      friction = {part_on(box), {friction = 0.4, friction_facets = 3}},
      forbidden = {part_on(box, true), {forbidden = top}}, hands = {part_on(box, true), {hands = 1}},
    }
    for name, case in pairs(cases) do
      local worst = certified(case[1], case[2])
      local proof = assert(bw.check_certificate(path))
      check.near(worst.upper_bound, proof.upper_bound, 1e-6, name)
      check.near(worst.max_principal, proof.reached, 1e-9, name)
      assert.is_true(proof.gap >= 0 and proof.gap >= worst.gap - 1e-6 and proof.gap <= worst.gap + 1e-5, name)
      assert.equal(case[1].mesh.element_count, proof.elements)
      -- What the linear solves may be off by is in the bound, and small.
      assert.is_true(proof.solve_error > 0 and proof.solve_error < 1e-6 * proof.upper_bound, name)
    end
  end)

  it("is rejected where anything of it is changed", function()
    certified(part_on(box))
    local text = read(path)
    assert(bw.check_certificate(path))
    local function rejected(what, pattern, by)
      check.fails("rejected", what, changed(text, pattern, by))
    end
    -- A multiplier, a leaf's claim, the bound itself.
    local function moved(by) -- a multiplier, or the exponent of all of a vector
      return function(head, number) return head .. ("%d"):format(math.tointeger(number) + by) end
    end
    rejected("its multipliers prove", "(\n%d+ all %S+ %S+ )(%-?%d+)", moved(9000))
    rejected("its multipliers prove", "(\nleaves .*\n%d+ %d%.[0-3]* %S+ )(%-?%d+)", moved(8))
    rejected("its multipliers prove", "(\n%d+ all )%d", "%19")
    rejected("its leaves prove", "upper_bound (%S+)", function(u) return "upper_bound " .. u * 0.99 end)
    -- A leaf less, and one twice.
    local count = math.tointeger(tonumber(text:match "\nleaves (%d+)\n"))
    local function counted(by) return (text:gsub("\nleaves %d+\n", ("\nleaves %d\n"):format(count + by))) end
    check.fails("rejected", "cover 0 of 10 faces", bw.check_certificate(write(path,
      (counted(-1):gsub("\n%d+ all [^\n]*", "", 1)))))
    check.fails("rejected", "of 10 faces of the half sphere", bw.check_certificate(write(path,
      (counted(-1):gsub("(\nleaves .*)\n%d+ %d%.[^\n]*", "%1", 1)))))
    check.fails("rejected", "twice", bw.check_certificate(write(path,
      (counted(1):gsub("(\nleaves .*)(\n%d+ %d%.[^\n]*)", "%1%2%2", 1)))))
    -- The load: larger, pulling, out of balance; the stress that it reaches; what the loads are.
    local first = text:match "\npressures %d+ %d+\n(%d+ %S+)\n"
    local place, value = first:match "(%d+) (%S+)"
    local function load(with) return function() return "\n" .. place .. " " .. with .. "\n" end end
    local pattern = "\n" .. first:gsub("%p", "%%%0") .. "\n"
    rejected("more than 200000", pattern, load(3e5))
    rejected("pulls", pattern, load(-value))
    rejected("amounts to", pattern, load(value * 0.9))
    rejected("less than", "\nreached (%S+)", function(r) return "\nreached " .. r * 1.01 end)
    rejected("amounts to", "\nloads 5 ", "\nloads 6 ")
    rejected("rigid-body modes stated", "\nsupports 0", "\nsupports 1\nfixed 1 1 1\nfacets 1 1\nnodes 0")
    rejected("the mesh", "\nelements (%d+)\n(%d+) %d+", "\nelements %1\n%2 %2")
  end)

  it("is refused where it is not whole", function()
    certified(part_on(box))
    local text = read(path)
    check.fails("format", "line 1: 'barwright certificate 2' expected",
      bw.check_certificate(write(path, "solid\n")))
    check.fails("format", "the file ends here", bw.check_certificate(write(path, text:sub(1, -200))))
    check.fails("format", "finite number expected, got 'nan'", changed(text, "upper_bound %S+", "upper_bound nan"))
    check.fails("format", "a cell such as all or 3.021", changed(text, "\n(%d+) all", "\n%1 none"))
    check.fails("format", "expected", changed(text, "(\n%d+ all [^\n]*) %S+\n", "%1\n"))
    check.fails("format", "isotropic or orthotropic", changed(text, "isotropic", "magic"))
    check.fails("io", "No such file", bw.check_certificate(path .. ".none"))
    -- Whatever is cut off or put in, the file is refused, never an error of the program.
    for i = 1, 40 do
      local at = #text * i // 41
      local nothing, message, details = bw.check_certificate(write(path,
        text:sub(1, at) .. (i % 2 == 0 and "x" or "") .. text:sub(at + 30)))
      assert.is_nil(nothing)
      assert.is_truthy(details.status == "format" or details.status == "rejected", message)
    end
  end)

  it("is checked with progress, and the check can be stopped", function()
    certified(part_on(box))
    local stages = {}
    local before = bw.progress(function(stage, fraction)
      stages[stage] = math.max(stages[stage] or 0, fraction)
    end)
    assert(bw.check_certificate(path))
    bw.progress(function(stage) return stage ~= "certificate" end)
    local result, message, details = bw.check_certificate(path)
    bw.progress(before)
    assert.equal(1, stages.certificate)
    check.fails("cancelled", "", result, message, details)
  end)

  it("is checked by a script", function()
    certified(part_on(box))
    local run = check.root .. "/scripts/worst_case/check_certificate.lua "
    local status, out = check.run(run .. path)
    assert.equal(0, status)
    assert.truthy(out:find "A load reaches [%d.]+ Pa in element %d+" and out:find "No load exceeds [%d.]+ Pa")
    write(path, (read(path):gsub("\nreached (%S+)", function(r) return "\nreached " .. r * 2 end)))
    local _, err
    status, _, err = check.run(run .. path)
    assert.equal(1, status)
    assert.truthy(err:find("rejected: the load stresses element", 1, true))
    status, _, err = check.run(run .. check.root .. "/README.md")
    assert.equal(2, status)
    assert.truthy(err:find("this is no certificate", 1, true))
    assert.equal(2, (check.run(run)))
  end)

  it("belongs to certify, and is reported to be impossible before the work", function()
    check.raises("'certificate' is a file that proves", bw.worst_case, part_on(box), {certificate = path})
    check.fails("io", "folder", bw.worst_case(part_on(box), {certify = 0.1, certificate = "/tmp"}))
    assert.is_nil((bw.check_certificate "/tmp"))
  end)
end)
