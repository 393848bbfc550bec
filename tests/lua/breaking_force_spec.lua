-- The breaking force: beam theory, linearity, the interval and its verdicts, wrong input.
local bw = require "barwright"
local check = require "check"
local core = require "barwright.core"
package.path = check.root .. "/scripts/bench/?.lua;" .. check.root .. "/scripts/worst_case/?.lua;" .. package.path
local impacts_of = require "impacts"
local full = os.getenv "BARWRIGHT_FULL" == "1"

local beam = {elements = 4800, modes = 6, regions = 2}

local function breaking(body, given)
  local options = {material = bw.material.pla}
  for key, value in pairs(beam) do options[key] = value end
  for key, value in pairs(given or {}) do options[key] = value end
  options.max_elements = options.max_elements or options.elements
  return bw.breaking_force(body, options)
end

local bar = assert(bw.surface.box {min = {0, 0, 0}, max = {0.1, 0.01, 0.01}})

describe("the breaking force", function()
  it("of a bar is that of three-point bending, and its interval contains it", function()
    local found = assert(breaking(bar))
    -- F in the middle, F / 2 at each end: sigma = 3 F L / (2 b h^2). Contacts of 1 cm2 shorten the span: the force
    -- on 10 mm of the middle and of the ends leaves arms of 42.5 mm.
    local stiffest = 53e6 * 2 * 0.01 ^ 3 / (3 * 0.1)
    assert.is_true(found.force > 0.9 * stiffest and found.force < 1.6 * stiffest, tostring(found))
    assert.is_true(found.low < found.force and found.force < found.high)
    check.near(math.max(found.high / found.force - 1, 1 - found.low / found.force), found.estimated_error, 1e-12)
    check.near(0.05, found.at[1], 0.3) -- in the middle third
    assert.equal("holds", found:verdict(0.99 * found.low))
    assert.equal("unsure", found:verdict(found.force))
    assert.equal("breaks", found:verdict(1.01 * found.high))
    assert.is_true(#found.history >= 3)
    assert.truthy(tostring(found):find "^breaks at")
    found:close()
  end)

  it("ends once the verdict is certain, with an interval that contains what further meshes find", function()
    local all = assert(breaking(bar, {elements = 600}))
    assert.is_true(#all.history > 3)
    for _, factor in ipairs {0.02, 50} do
      local force = factor * all.force
      local found = assert(breaking(bar, {elements = 600, decide = true, force = force}))
      assert.equal(3, #found.history)
      assert.equal(all:verdict(force), found:verdict(force))
      assert.is_true(found.low < all.force and all.force < found.high, tostring(found))
    end
    -- Three meshes do not decide about a force within the interval.
    local near = assert(breaking(bar, {elements = 600, decide = true, force = all.force}))
    assert.equal(#all.history, #near.history)
  end)

  it("does not depend on the reference force, and grows with strength and scale", function()
    local mesh = assert(bw.mesh.fill(bar, {elements = 600, order = 2}))
    local one = assert(breaking(mesh))
    check.near(one.force, assert(breaking(mesh, {force = 2000})).force, 1e-6)
    local strong = bw.material.isotropic {young = 3.6e9, poisson = 0.36, strength = 106e6}
    check.near(2 * one.force, assert(breaking(mesh, {material = strong})).force, 1e-9)
    assert.equal(1, #one.history)
    assert.is_true(one.estimated_error >= 0.3)
    -- A smaller contact breaks at a smaller force.
    assert.is_true(assert(breaking(mesh, {contact = 2e-5})).force < one.force)
  end)

  it("has an interval that contains what the tolerance of its solver may change", function()
    local mesh = assert(bw.mesh.fill(bar, {elements = 600, order = 2}))
    local exact = assert(breaking(mesh))
    local loose = assert(breaking(mesh, {solver = bw.solver.pcg {tolerance = 1e-3}}))
    local error = loose.worst.solve_error
    assert.is_true(error > 1e-3)
    check.near(loose.force / loose.low, exact.force / exact.low + error, 1e-6)
    assert.is_true(loose.high / loose.force > exact.high / exact.force + error)
  end)

  it("is refined at the edge of a support, where the nearest node of the next mesh may lie within it", function()
    local box = assert(bw.surface.box {min = {-0.01, -0.01, 0}, max = {0.052, 0.01, 0.022}})
    local found = assert(breaking(box, {elements = 4000, fix = function(mesh)
      return mesh.boundary:below(1, -0.01)
    end}))
    assert.is_true(#found.history > 1)
    check.near(-0.01, found.at[1], 1e-6)
  end)

  it("is refined where the body is weakest, and agrees from a coarse and a fine start", function()
    -- A stub on a plate: the edge between them is re-entrant.
    local stub = assert(bw.surface.implicit(function(x, y, z)
      local plate = math.max(math.abs(x) - 0.02, math.abs(y) - 0.02, math.abs(z) - 0.003)
      return math.min(plate, math.max(math.abs(x) - 0.004, math.abs(y) - 0.004, math.abs(z - 0.01) - 0.01))
    end, {min = {-0.03, -0.03, -0.01}, max = {0.03, 0.03, 0.03}, cells = 48}))
    local coarse, fine = assert(breaking(stub, {elements = 500, max_elements = 2000})),
      assert(breaking(stub, {elements = 2500}))
    for _, found in ipairs {coarse, fine} do
      assert.is_true(found.history[#found.history].refined, tostring(found))
    end
    check.near(fine.force, coarse.force, 0.25)
    assert.is_true(coarse.low < fine.force and fine.force < coarse.high,
      tostring(coarse) .. "\n" .. tostring(fine))
  end)

  it("has ties at the two equal necks of a symmetric bar, from one refinement to the next", function()
    local body = assert(bw.surface.implicit(function(x, y, z)
      local plate = math.max(math.abs(x) - 0.03, math.abs(y) - 0.008, math.abs(z) - 0.004)
      return math.max(plate, 0.0055 - math.sqrt((math.abs(x) - 0.012) ^ 2 + (math.abs(y) - 0.008) ^ 2))
    end, {min = {-0.032, -0.01, -0.006}, max = {0.032, 0.01, 0.006}, cells = 24}))
    local found = assert(breaking(body, {elements = 300, modes = 4, regions = 1}))
    -- The weakest place at each neck, as a fraction of the weakest one of all.
    local function shares(places)
      local left, right = 0, 0
      for _, place in ipairs(places) do
        assert.is_true(math.abs(math.abs(place.at[1]) - 0.012) < 0.004)
        local fraction = place.utilisation / places[1].utilisation
        if place.at[1] < 0 then left = math.max(left, fraction) else right = math.max(right, fraction) end
      end
      return left, right
    end
    assert.is_true(#found.history >= 3)
    for k = 2, #found.history do -- the first mesh has no short edges
      local left, right = shares(found.history[k].places)
      assert.is_true(math.min(left, right) > 1 - found.estimated_error, ("mesh %d: %g %g"):format(k, left, right))
    end
    local other
    for _, tie in ipairs(found.ties) do other = other or tie.at[1] * found.at[1] < 0 and tie end
    assert.truthy(other)
    check.near(found.force, 1 / other.utilisation, found.estimated_error)
  end)

  it("is uncertain where the mesh is not of the part", function()
    local thick = assert(bw.surface.box {min = {0, 0, 0}, max = {0.04, 0.01, 0.012}})
    local fill = core.mesh.fill
    core.mesh.fill = function(_, ask) return fill(thick, ask) end -- luacheck: ignore
    local ok, found = pcall(breaking, assert(bw.surface.box {min = {0, 0, 0}, max = {0.04, 0.01, 0.01}}),
      {elements = 300})
    core.mesh.fill = fill -- luacheck: ignore
    assert.is_true(ok, found)
    assert.is_true(found.estimated_error > 0.15, tostring(found))
  end)

  it("bounds places that no mesh has refined by the growth that was measured", function()
    local weak_places = require "barwright.weak_places"
    local function place(x, utilisation, refined, settled)
      return {at = {x, 0, 0}, utilisation = utilisation, refined = refined, settled = settled or refined}
    end
    -- The first mesh does not count; from the second to the third, three places are refined and grow.
    local levels = {{utilisation = 1, places = {place(1, 1), place(2, 0.1)}},
      {utilisation = 1, places = {place(0, 1, true), place(1, 0.8), place(2, 0.7), place(3, 0.7), place(4, 0.7)}},
      {utilisation = 1, places = {place(0, 1, true), place(1.01, 0.88, true), place(2, 0.84, true),
        place(3, 0.7, true), place(4, 0.9), place(5, 0.8)}}}
    check.near(1.2, weak_places.growth(levels, 0.1), 1e-12)
    local open, factor = weak_places.unsettled(levels, 0.1)
    check.near(1.2, factor, 1e-12)
    assert.same({levels[3].places[5]}, open) -- 1.2 * 0.8 is less than the largest
    levels[3].places[3].refined = false -- two places are too few
    check.near(1 / 0.6, weak_places.growth(levels, 0.1), 1e-12)
    levels[3].places[3].refined, levels[3].places[3].utilisation = true, 0.7 -- 1.1 is taken for 1.15
    check.near(1.15, weak_places.growth(levels, 0.1), 1e-12)
    assert.equal(4, #weak_places.settled(levels) - 1)
  end)

  it("is less than the forces of random drops", function()
    local mesh = assert(bw.mesh.fill(bar, {elements = 600, order = 2}))
    local found <close> = assert(breaking(mesh))
    local impacts = impacts_of(found, {drops = 24, seed = 1})
    assert.equal(24, #impacts)
    assert.is_true(impacts.with_inertia.min >= found.low and impacts.with_inertia.below == 0)
    -- An impact on 10 mm in the middle bends by P (90 mm) / 8, the worst load by F (42.5 mm) / 2. Slanted pushes
    -- press more than their resultant.
    local min = impacts.force.min / found.force
    assert.is_true(min > 1.8 and min < 2.2, min)
    check.near(0.05, impacts[1].at[1], 0.3)
    -- With the end's contact 0.45 l from the centre, a bar is accelerated by (1 + 5.4 x / l) P / m.
    local max = 0
    for _, impact in ipairs(impacts) do max = math.max(max, impact.with_inertia / impact.force) end
    check.near((1 + (3.7 ^ 2 + 1.7 ^ 2) / 10.8) / 2, max, 5e-3)
    -- The centres of the four sides are ties.
    local bent = 0
    for _, impact in ipairs(impacts) do bent = bent + (math.abs(impact.at[1] - 0.05) < 0.006 and 1 or 0) end
    assert.is_true(impacts.predicted > 0 and impacts.predicted <= bent / #impacts)
  end)

  it("decides nothing on a handful of elements", function()
    local ball = assert(bw.surface.sphere {centre = {0, 0, 0}, radius = 0.02, subdivisions = 4})
    local few = assert(bw.mesh.fill(ball, {elements = 4}))
    local found = assert(breaking(few))
    assert.is_true(found.estimated_error >= 1, tostring(found))
    assert.equal("unsure", found:verdict(1e-3 * found.force))
    assert.equal(0, found.low)
  end)

  -- The breaking force where the fillings whose numbers `is_wrapped` accepts log a wrap, and how many there were.
  local function wrapping(is_wrapped)
    local fill, count = core.mesh.fill, 0
    core.mesh.fill = function(...)
      count = count + 1
      local mesh, log = fill(...)
      if is_wrapped(count) then
        log.steps[#log.steps + 1] = {name = "wrap", count = 1, moved = 0, text = "as if it was wrapped"}
      end
      return mesh, log
    end
    local ok, found, message = pcall(breaking, bar, {elements = 300})
    core.mesh.fill = fill
    assert(ok, found)
    return assert(found, message), count
  end

  it("decides nothing where a sound surface had to be wrapped", function()
    local wrapped = wrapping(function() return true end)
    assert.equal(0, wrapped.low)
    assert.equal("unsure", wrapped:verdict(1e-3 * wrapped.force))
    for _, level in ipairs(wrapped.history) do assert.is_true(level.wrapped) end
  end)

  it("fills with other numbers where a sound surface had to be wrapped", function()
    local plain, meshes = wrapping(function() return false end)
    assert.equal(#plain.history, meshes)
    local once, fillings = wrapping(function(number) return number == 2 end)
    assert.equal(#once.history + 1, fillings)
    assert.equal("holds", once:verdict(0.1 * once.force))
    check.near(once.force, plain.force, 0.15)
  end)

  it("looks at no wrapped mesh beside meshes of the part", function()
    local first = wrapping(function(number) return number <= 3 end)
    local last = wrapping(function(number) return number > 1 end)
    for _, found in ipairs {first, last} do
      for _, level in ipairs(found.history) do assert.is_false(level.wrapped) end
    end
    assert.equal("holds", first:verdict(0.1 * first.force))
    assert.equal(1, #last.history)
  end)

  it("is that of the part where points lie in planes exactly", function()
    if not full then return pending "only with BARWRIGHT_FULL=1" end
    local surface = require "bodies" {unseen = true, only = "vented case"}[1].surface()
    local coarse = assert(breaking(surface, {elements = 2500}))
    local finer = assert(breaking(surface, {elements = 5000}))
    for _, level in ipairs(coarse.history) do assert.is_false(level.wrapped) end
    check.near(finer.force, coarse.force, 0.1)
  end)

  it("judges metals by von Mises against yield", function()
    local mesh = assert(bw.mesh.fill(bar, {elements = 300, order = 2}))
    assert.equal("von_mises", assert(breaking(mesh, {material = bw.material.steel})).failure)
    assert.equal("principal", assert(breaking(mesh)).failure)
    local principal = assert(breaking(mesh, {material = bw.material.steel, failure = "principal"}))
    assert.equal("principal", principal.failure)
  end)

  it("averages over half the critical distance of the material where that is asked for", function()
    local mesh = assert(bw.mesh.fill(bar, {elements = 300, order = 2}))
    local found = assert(breaking(mesh, {material = bw.material.abs, length = "critical"}))
    assert.equal(0.5 * bw.material.abs.critical_distance, found.length)
    local same = assert(breaking(mesh, {material = bw.material.abs, length = found.length}))
    assert.equal(found.force, same.force)
    check.fails("unsupported", "the fracture toughness of pla is not known: give a length in m, or a material",
      breaking(mesh, {length = "critical"}))
    -- twice the 21.8 mm of steel in a bar of 10 mm
    check.fails("unsupported", "does not fit into a part that is 10 mm thick",
      breaking(mesh, {material = bw.material.steel, length = "critical"}))
    check.raises("a length in m above 0 or 'critical' expected, got string 'long'", breaking, mesh,
      {length = "long"})
    check.raises("a length in m above 0 or 'critical' expected, got 0", breaking, mesh, {length = 0})
    check.raises("a length in m above 0 or 'critical' expected, got", breaking, mesh, {length = 0 / 0})
    check.raises("a length in m above 0 or 'critical' expected, got table", breaking, mesh, {length = {}})
  end)

  it("leaves room for what a coarse background hides in a thin wall", function()
    local thickness = 0.8e-3
    local plate = assert(bw.surface.box {min = {0, 0, 0}, max = {0.06, 0.06, thickness}})
    local found = assert(breaking(plate, {elements = 400, max_elements = 400}))
    local longer = found.background / thickness - 1
    assert.is_true(longer > 4, longer)
    assert.is_true(1 - found.low / found.force > 1 - 1 / (1 + 0.02 * longer), tostring(found))
  end)

  it("names what is wrong", function()
    check.raises("option 'material': a material expected", bw.breaking_force, bar)
    check.raises("a surface or a mesh expected, got table", breaking, {})
    check.raises("did you mean 'contact'", breaking, bar, {contct = 1})
    local layered = bw.material.orthotropic {young = {2e9, 1.8e9, 0.9e9}, poisson = {0.35, 0.3, 0.3},
      shear = {0.7e9, 0.4e9, 0.4e9}, strength = {5e7, 5e7, 2e7}}
    check.raises("'von_mises' needs one strength", breaking, bar, {material = layered, failure = "von_mises"})
    local nothing, message = breaking(bar, {material = bw.material.isotropic {young = 1e9, poisson = 0.3}})
    assert.is_nil(nothing)
    assert.equal("the strength of the material is not known", message)
  end)
end)

describe("a search that is extended", function()
  -- A comb with a long tooth: the loads of the search bend this one.
  local radius = 2e-3
  local block = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.066, 0.006, 0.03}, cells = {22, 2, 10}})
  local centroid = block.nodes:gather(block.elements:column(1))
  for corner = 2, 4 do centroid = centroid + block.nodes:gather(block.elements:column(corner)) end
  local comb = assert(block:subset((centroid / 4):map(
    "a.z < 0.006 or a.x - 0.012 * floor(a.x / 0.012) < 0.006 and (a.x < 0.012 or a.z < 0.012)"))):with_order(2)
  local part = bw.model {mesh = comb, material = bw.material.pla}

  -- The largest utilisation at every node under loads.
  local function largest(worst, loads)
    local max
    for i = 1, loads.peaks.row_count do
      local force = worst.basis:force(loads.pressures[i])
      local u = assert(worst.system:solve(force))
      local stress = assert(bw.surface_stress(comb, part.material, u, force))
      local used = part.material:utilisation(assert(bw.surface_mean(comb, stress, radius, worst.system)))
      max = max and bw.array.map("max(a, b)", {a = max, b = used}) or used
    end
    return max
  end

  it("has loads for all patches that reach a utilisation, and keeps those it had", function()
    local worst <close> = assert(bw.worst_case(part, {force = 5, pressure = 2e5, modes = 2, regions = 1,
      length = radius}))
    local limit, count = 0.15 * worst.places[1].utilisation, #worst.regions
    local before, first = largest(worst, worst.loads), worst.pressures:rows(1, count):copy()
    assert.equal(worst, worst:extend(limit))
    assert.is_true(#worst.regions > count)
    assert.equal(first:tostring "<f8", worst.pressures:rows(1, count):tostring "<f8")
    local after = largest(worst, worst.loads)
    -- Linear programs for patches that are chosen here, in three directions.
    local nodes, rows, boundary = {}, {}, comb.boundary.nodes
    for k = 1, boundary.row_count, 38 do
      for component = 1, 3 do
        local row = {0, 0, 0, 0, 0, 0}
        row[component] = 1
        nodes[#nodes + 1], rows[#rows + 1] = boundary[k], row
      end
    end
    local regions = assert(core.patch_regions(worst.system, radius, nodes, core.array.new(rows)))
    local own = largest(worst, assert(core.worst_loads(worst.system, worst.basis, regions, {one_sign = true,
      force = 5, pressure = 2e5})))
    local min, former = 1, 1
    for k = 1, #nodes, 3 do
      local node = nodes[k]
      if own[node] > limit then
        min, former = math.min(min, after[node] / own[node]), math.min(former, before[node] / own[node])
      end
    end
    assert.is_true(min > 0.65, ("%.3f"):format(min))
    assert.is_true(former < 0.55, ("the search alone: %.3f"):format(former))
    check.raises("utilisation: a number above 0 expected", worst.extend, worst, 0)
    check.raises("with the option 'length' expected", function()
      local other <close> = assert(bw.worst_case(part, {force = 5, pressure = 2e5, modes = 2, regions = 1}))
      other:extend(1)
    end)
  end)
end)
