-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Heat from scripts: histories and chosen errors in time, thermal stress from a computed field, misuse.
local bw = require "barwright"
local check = require "check"

local function bar(material, order)
  local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {20, 1, 1}, order = order or 2}
  return bw.heat {mesh = mesh, material = material}, mesh
end

local metal = bw.material.isotropic {young = 70e9, poisson = 0.3, density = 7200, conductivity = 35,
  heat_capacity = 440.5}

local function at(solution, x)
  local value, least = nil, math.huge
  local nodes = solution.mesh.nodes
  for i = 1, #nodes do
    local distance = math.abs(nodes[i][1] - x) + nodes[i][2] + nodes[i][3]
    if distance < least then value, least = solution.temperature[i], distance end
  end
  return value
end

describe("heat", function()
  it("NAFEMS T3 with a history and a chosen error", function()
    local heat, mesh = bar(metal)
    heat:prescribe(mesh.boundary:below("x", 0), 0):prescribe(mesh.boundary:above("x", 0.1), 0)
    local function history(time) return 100 * math.sin(math.pi * time / 40) end
    local before = math.huge
    for _, tolerance in ipairs {0.05, 0.002} do
      local transient = assert(heat:set(2, 0):transient {initial = 0, scheme = "bdf2"})
      local now = assert(transient:run {time = 32, step = 0.1, tolerance = tolerance, histories = {[2] = history}})
      check.near(32, now.time, 1e-9)
      check.near(36.60, at(now, 0.08), tolerance > 0.01 and 0.01 or 0.003)
      assert.is_true(math.abs(now.imbalance) <= 1e-9 * math.abs(now.stored))
      local lengths = transient.steps
      assert.is_true(before == math.huge or lengths > before)
      before = lengths
    end
  end)

  it("rows of a history are linear between and constant outside", function()
    local heat, mesh = bar(metal, 1)
    heat:load {on = mesh.boundary:below("x", 0), heat_flux = 0}
    local transient = assert(heat:transient {initial = 300, scheme = "crank_nicolson"})
    local heats = {}
    assert(transient:run {time = 4, step = 1, histories = {{{1, 100}, {3, 300}}},
      each = function(now) heats[#heats + 1] = now.heat_in[1] / 1e-4 end})
    for i, expected in ipairs {100, 200, 250, 300} do check.near(expected, heats[i], 1e-6) end
  end)

  it("regions conduct by their own materials: two layers between two temperatures", function()
    local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 1, 1}, order = 2}
      :split({min = {0.06, -1, -1}, max = {1, 1, 1}}, "cover")
    local plain
    for _, region in ipairs(mesh.regions) do
      if region.name ~= "cover" then plain = region.name end
    end
    local cover = bw.material.isotropic {young = 1e9, poisson = 0.3, conductivity = 5}
    local heat = bw.heat {mesh = mesh, materials = {[plain] = metal, cover = cover}}
    heat:prescribe(mesh.boundary:below("x", 0), 400):prescribe(mesh.boundary:above("x", 0.1), 300)
    local solution = assert(heat:solve())
    local flux = 100 / (0.06 / 35 + 0.04 / 5)
    check.near(400 - flux * 0.06 / 35, at(solution, 0.06), 1e-9)
    check.near(flux * 1e-4, solution.heat_in[1], 1e-9)
    check.raises("'material' or option 'materials' expected, not both",
      bw.heat, {mesh = mesh, material = metal, materials = {cover = cover}})
    check.raises("there is no region 'covr': did you mean 'cover'?", bw.heat,
      {mesh = mesh, materials = {covr = cover}})
  end)

  it("contact resists heat: layers in series, by all solvers and in time", function()
    for order = 1, 2 do
      local joined = bw.mesh.box {max = {0.1, 0.01, 0.02}, cells = {10, 2, 3}, order = order}
        :split({min = {0.06, -1, -1}, max = {1, 1, 1}}, "cover")
      local mesh = joined:separated "cover"
      assert.equal(2, mesh.component_count)
      assert.equal(joined.node_count + (order == 1 and 12 or 35), mesh.node_count)
      check.near(joined.volume, mesh.volume, 1e-18)
      local cover = bw.material.isotropic {young = 1e9, poisson = 0.3, conductivity = 5, density = 1000,
        heat_capacity = 500}
      local heat = bw.heat {mesh = mesh, materials = {rest = metal, cover = cover}}
      local low, high = mesh.boundary:below("x", 0), mesh.boundary:above("x", 0.1)
      heat:prescribe(low, 400):load {on = high, convection = {coefficient = 100, temperature = 300}}
      heat:load {on = mesh.boundary:region "rest",
        contact = {with = mesh.boundary:region "cover", conductance = 200}}
      assert.matches("contact 200 W/%(m2 K%) on 2 cm2", tostring(heat))
      -- areas and resistances in series
      local flux = 100 / (0.06 / 35 + 1 / 200 + 0.04 / 5 + 1 / 100)
      local ways = {bw.solver.cholesky(), bw.solver.pcg {preconditioner = bw.solver.jacobi(), tolerance = 1e-12}}
      if order == 2 then
        ways[3] = bw.solver.pcg {preconditioner = bw.solver.two_level(), tolerance = 1e-12}
      end
      for _, way in ipairs(ways) do
        local solution = assert(heat:solve {solver = way})
        local near, far = -math.huge, math.huge -- the sides of the jump
        for i, x in ipairs(mesh.nodes:totable()) do
          if math.abs(x[1] - 0.06) < 1e-9 then
            near, far = math.max(near, solution.temperature[i]), math.min(far, solution.temperature[i])
          end
        end
        check.near(400 - flux * 0.06 / 35, near, 1e-6)
        check.near(flux / 200, near - far, 1e-6)
        check.near(-flux * 2e-4, solution.heat_in[3], 1e-8) -- out of the first side
        assert.is_true(math.abs(solution.imbalance) < 1e-8)
        assert.is_true(solution:error_estimate() < 1e-6)
      end
      local transient = assert(heat:transient {initial = 300, scheme = "bdf2"})
      local now = assert(transient:run {time = 1e5, step = 1e3})
      check.near(-flux * 2e-4, now.heat_in[3], 1e-6)
      check.raises("condition 3 is contact, which has no value", heat.set, heat, 3, 1)
    end
  end)

  it("contact takes heat from body to body, and is refused where nothing touches", function()
    local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {10, 1, 1}, order = 2}
      :split({min = {0.06, -1, -1}, max = {1, 1, 1}}, "cover")
    local function body(separated)
      return bw.heat {mesh = separated, material = metal}, separated.boundary
    end
    local heat, boundary = body(mesh:separated "cover")
    heat:prescribe(boundary:below("x", 0), 300)
    check.fails("unconstrained", "body 2 of 2 has no steady temperature", heat:solve())
    local contact = {with = boundary:region "rest", conductance = 50}
    local high = boundary:above("x", 0.1)
    assert(heat:load {on = boundary:region "cover", contact = contact}:load {on = high, power = 1})
    local solution = assert(heat:solve())
    check.near(1 / (50 * 1e-4) + 300 + 0.1 / 35 / 1e-4, solution.temperature:max(), 1e-6)
    check.near(-1, solution.heat_in[2], 1e-9)
    check.fails("geometry", "do not touch: they are 0.04 m apart", heat:load {on = high, contact = contact})
    check.raises("join the regions instead", heat.load, heat, {on = boundary:region "cover",
      contact = {with = boundary:region "rest", conductance = 1e20}})
    check.raises("on both sides of contact", heat.load, heat, {on = boundary, contact = contact})
    heat, boundary = body(mesh) -- one body, whose regions share their nodes
    contact.with = boundary:region "rest"
    local cover = boundary:region "cover"
    check.raises("no node in common", heat.load, heat, {on = cover, contact = contact})
    check.raises("must be above 0", heat.load, heat, {on = boundary, contact = {with = boundary, conductance = 0}})
    check.raises("'with'", heat.load, heat, {on = boundary, contact = {conductance = 1}})
    check.raises("'conductance'", heat.load, heat, {on = boundary, contact = {with = boundary}})
    check.raises("'gap': a number above 0", heat.load, heat, {on = cover,
      contact = {with = cover, conductance = 1, gap = 0}})
    check.raises("option 'b'", heat.bond, heat, {a = cover})
    local separated = mesh:separated "cover"
    assert.equal(separated.node_count, separated:separated("cover").node_count)
  end)

  it("a bond of separated regions gives what one mesh gives, and contact needs no matching nodes", function()
    local joined = bw.mesh.box({max = {1, 1, 1}, cells = {2, 2, 2}, order = 2})
      :split({min = {0.5, -1, -1}, max = {2, 2, 2}}, "cover")
    local mesh = joined:separated "cover"
    local function solution(of, join)
      local heat = bw.heat {mesh = of, material = metal}
      heat:prescribe(of.boundary:below("x", 0), 300):load {source = 2e3}
      heat:load {on = of.boundary:above("y", 1), convection = {coefficient = 20, temperature = 280}}
      join(heat, of.boundary)
      return assert(heat:solve()), heat
    end
    local one = solution(joined, function() end)
    local other, heat = solution(mesh, function(body, boundary)
      body:bond {a = boundary:region "cover", b = boundary:region "rest"}
    end)
    check.near(one.temperature:max(), other.temperature:max(), 1e-9)
    check.near(one.heat_in[1], other.heat_in[1], 1e-8)
    assert.is_true(math.abs(other.heat_in[4]) > 1)
    assert.matches("bond on 1 m2 of 4 m2", tostring(heat))
    check.raises("condition 4 is a bond, which has no value", heat.set, heat, 4, 1)
    local nodes, moved = mesh.nodes:totable(), false
    for _, i in ipairs(mesh.boundary:region("cover").nodes:totable()) do
      local p = nodes[i]
      if p[1] == 0.5 and p[2] == 0 and p[3] == 0 then p[2], moved = 1e-4, true end
    end
    assert.is_true(moved)
    local shifted = mesh:moved(bw.array.new(nodes))
    local function contact(body, boundary)
      body:load {on = boundary:region "rest", contact = {with = boundary:region "cover", conductance = 50}}
    end
    local matching, nearly = solution(mesh, contact), solution(shifted, contact)
    check.near(matching.temperature:max(), nearly.temperature:max(), 1e-3)
    check.near(matching.heat_in[4], nearly.heat_in[4], 1e-2)
  end)

  it("contact that hardly resists is none, where three jagged regions meet", function()
    for order = 1, 2 do
      local joined = bw.mesh.box {max = {1, 1.1, 0.9}, cells = {4, 5, 4}, order = order}
        :split("x + 0.3 * sin(9 * y) - 0.2 * z < 0.4", "left"):split("y + 0.4 * x - 0.3 * z > 0.8", "top")
      local mesh = joined:separated("left"):separated "top"
      assert.equal(joined.element_count, mesh.element_count)
      assert.equal(#joined.regions, mesh.component_count)
      local function solution(of)
        local heat = bw.heat {mesh = of, material = metal}
        heat:prescribe(of.boundary:below("x", 0), 300):load {source = 2e4}
        heat:load {on = of.boundary:above("y", 1.1), convection = {coefficient = 20, temperature = 280}}
        local area = 0
        if of == mesh then
          local side = {}
          for i, region in ipairs(of.regions) do side[i] = of.boundary:region(region.name) end
          for _, pair in ipairs {{1, 2}, {1, 3}, {2, 3}} do
            heat:load {on = side[pair[1]], contact = {with = side[pair[2]], conductance = 1e10}}
            area = area + joined:interface(of.regions[pair[1]].name, of.regions[pair[2]].name).area
          end
          local stated = 0
          for number, unit in tostring(heat):gmatch "contact [^\n]* on ([%d.]+) (c?m2)" do
            stated = stated + number * (unit == "m2" and 1 or 1e-4)
          end
          check.near(area, stated, 1e-3 * area)
        end
        return assert(heat:solve {solver = bw.solver.cholesky()})
      end
      local one, other = solution(joined), solution(mesh)
      -- 17 kW through about 1 m2 have a jump of 2e-6 K there
      check.near(one.temperature:max(), other.temperature:max(), 2e-8)
      check.near(one.temperature:min(), other.temperature:min(), 2e-8)
      check.near(one.heat_in[1], other.heat_in[1], 3e-8)
      -- temperatures from 512 K on are rounded to 1e-13 K, which is 1e-3 W over 1e10 W/K; 2e-4 W is what remains
      assert.is_true(other.temperature:max() > 512 and math.abs(other.imbalance) < 1e-3)
    end
  end)

  it("two levels need as many iterations at any conductance of a waving contact", function()
    local mesh = bw.mesh.box({max = {1, 1.1, 0.9}, cells = {6, 6, 6}, order = 2})
      :split("x + 0.3 * sin(9 * y) - 0.2 * z < 0.4", "left"):separated "left"
    for _, conductance in ipairs {1, 1e4, 1e8} do
      local heat = bw.heat {mesh = mesh, material = metal}
      heat:prescribe(mesh.boundary:below("x", 0), 300):load {source = 2e4}
      heat:load {on = mesh.boundary:above("y", 1.1), convection = {coefficient = 20, temperature = 280}}
      heat:load {on = mesh.boundary:region "left",
        contact = {with = mesh.boundary:region "rest", conductance = conductance}}
      local direct = assert(heat:solve {solver = bw.solver.cholesky()})
      local by = assert(heat:solve {solver = bw.solver.pcg {preconditioner = bw.solver.two_level()}})
      assert.is_true(by.report.iterations <= 60, by.report.iterations)
      assert.is_true((by.temperature - direct.temperature):map("abs(a)"):max() < 1e-4)
    end
  end)

  it("estimates the error of the highest temperature: a cube with a source, and bent boxes", function()
    local function ratio(solution, exact)
      return solution.highest_error / math.abs(exact - solution.highest)
    end
    for order = 1, 2 do
      for _, n in ipairs {4, 5, 8} do
        local mesh = bw.mesh.box {max = {1, 1, 1}, cells = {n, n, n}, order = order}
        local heat = bw.heat {mesh = mesh, material = metal}
        heat:prescribe(mesh.boundary, 0):load {source = 35}
        local r = ratio(assert(heat:solve {error = true}), 0.0562128) -- the series of the cube
        assert.is_true(r > 0.6 and r < 2.5, r)
      end
    end
    local seed = 1
    local function random()
      seed = (seed * 1103515245 + 12345) % 2147483648
      return seed / 2147483648 * 2 - 1
    end
    for _ = 1, 4 do
      local c = {}
      for i = 1, 18 do c[i] = 0.12 * random() end
      local function solve(order, n)
        local box = bw.mesh.box {max = {1, 1, 1}, cells = {n, n, n}, order = order}
        local nodes = box.nodes:totable()
        for _, p in ipairs(nodes) do
          local x, y, z = p[1], p[2], p[3]
          p[1] = x + c[1] * math.sin(3 * y) + c[2] * z * z + c[3] * x * y
          p[2] = y + c[4] * math.sin(3 * x) + c[5] * x * z + c[6] * y * y
          p[3] = 0.6 * z + c[7] * math.cos(2 * x) + c[8] * x * y + c[9] * y
        end
        local mesh = box:moved(bw.array.new(nodes))
        local heat = bw.heat {mesh = mesh, material = metal}
        heat:load {source = 1e3 * (1 + c[12])}
        heat:load {on = mesh.boundary, convection = {coefficient = 500 * (1 + c[13]), temperature = 20}}
        return assert(heat:solve {error = true})
      end
      local fine = solve(2, 9)
      for order = 1, 2 do
        local coarse = solve(order, order == 1 and 5 or 3)
        local e, estimate = math.abs(fine.highest - coarse.highest), coarse.highest_error
        assert.is_true(estimate > 0.5 * e, estimate / e)
        -- the parts of the true error of tet10 may cancel: it warms up by 1.2 K
        assert.is_true(estimate < (order == 1 and 2.5 * e or 0.012), estimate)
      end
    end
  end)

  it("a prescribed highest temperature has no error, also through a bond", function()
    local mesh = bw.mesh.box({max = {0.1, 0.01, 0.01}, cells = {10, 1, 1}, order = 2})
      :split({min = {0.06, -1, -1}, max = {1, 1, 1}}, "cover"):separated "cover"
    local function body(high)
      local heat, boundary = bw.heat {mesh = mesh, material = metal}, mesh.boundary
      heat:bond {a = boundary:region "cover", b = boundary:region "rest"}
      heat:prescribe(boundary:below("x", 0), 300)
      return high(heat, boundary:above("x", 0.1))
    end
    for _, high in ipairs {function(heat, on) return heat:prescribe(on, 400) end,
      function(heat, on) return heat:load {on = on, heat_flux = 35000} end} do
      local heat = body(high)
      local solution = assert(heat:solve {error = true})
      check.near(400, solution.highest, 1e-9)
      check.near(0.1, mesh.nodes[solution.highest_node][1], 1e-12)
      assert.is_true(solution.highest_error < 1e-7) -- linear: elements are exact
      assert.matches("the highest with an estimated error of", tostring(solution))
      assert.is_nil(assert(heat:solve()).highest_error)
      assert.matches("error not estimated", tostring(heat:solve()))
    end
  end)

  it("a tolerance that no step reaches is a failure, not misuse", function()
    local heat, mesh = bar(metal, 1)
    heat:prescribe(mesh.boundary:below("x", 0), 300)
    local transient = assert(heat:transient {initial = 300})
    local now, message, details = transient:run {time = 1, step = 0.5, tolerance = 1e-9,
      histories = {function(time) return time < 0.3 and 300 or 400 end}}
    assert.is_nil(now)
    assert.matches("the step fell to", message)
    assert.equal("convergence", details.status)
  end)

  it("a run to a hair's breadth behind the present time succeeds", function()
    local heat, mesh = bar(metal, 1)
    heat:prescribe(mesh.boundary:below("x", 0), 400)
    local transient = assert(heat:transient {initial = 300, scheme = "bdf2"})
    assert(transient:run {time = 10, step = 0.5})
    local now = assert(transient:run {time = 10 * (1 + 2e-10), step = 0.5, tolerance = 1e3})
    check.near(10, now.time, 1e-8)
  end)

  it("thermal stress of a computed field: a bar between walls", function()
    local heat, mesh = bar(metal)
    heat:prescribe(mesh.boundary:below("x", 0), 300):prescribe(mesh.boundary:above("x", 0.1), 400)
    local solution = assert(heat:solve())
    local part = bw.model {mesh = mesh, material = metal}
    part:slide(mesh.boundary:below("x", 0), {1, 0, 0}):slide(mesh.boundary:above("x", 0.1), {1, 0, 0})
    part:temperature(solution.temperature - 300, 20e-6)
    local static = assert(part:solve())
    -- the mean change of 50 K is prevented: -E alpha dT on the walls
    check.near(70e9 * 20e-6 * 50 * 1e-4, static:reaction_on(mesh.boundary:below("x", 0))[1], 1e-3)
  end)

  it("materials", function()
    check.near(53.3, bw.material.steel.conductivity, 0)
    check.near(896, bw.material.aluminium.heat_capacity, 0)
    assert.is_true(bw.material.abs.conductivity == nil)
    local wood = bw.material.orthotropic {young = {11e9, 0.9e9, 0.5e9}, poisson_t = {0.3, 0.02, 0.03},
      conductivity = {0.3, 0.15, 0.1}}
    check.near(0.1, wood.conductivity[3], 1e-15)
  end)

  it("misuse", function()
    local heat, mesh = bar(metal)
    check.raises("has no conductivity", bw.heat, {mesh = mesh, material = bw.material.abs})
    check.raises("one of the options", heat.load, heat, {})
    check.raises("condition: there is none, got 1", heat.set, bw.heat {mesh = mesh, material = metal}, 1, 2)
    check.raises("times must ascend", function()
      assert(heat:transient {initial = 0}):run {time = 1, step = 1, histories = {{{1, 2}, {1, 3}}}}
    end)
    check.fails("unconstrained", "no steady temperature", heat:solve())
    local parts = bw.mesh.box({max = {2, 1, 1}, cells = {2, 1, 1}}):split("x > 1", "cover"):separated "cover"
    local cover, rest = parts.boundary:region "cover", parts.boundary:region "rest"
    local bonded = bw.heat {mesh = parts, material = metal}
    bonded:bond {a = cover, b = rest}
    assert.matches("nodes, 1 condition\n", tostring(bonded))
    check.fails("unconstrained", "no steady temperature", bonded:prescribe(cover, 300):solve()) -- it follows none
    check.fails("unsupported", "is estimated of steady states", heat:transient {initial = 0, error = true})
    heat:prescribe(mesh.boundary, 300)
    check.raises("a table of options expected, got", heat:solve().picture, heat:solve(), "a.png", 3)
  end)
end)

describe("barwright heat", function()
  local folder = check.folder()
  local path = folder .. "bar.msh"
  setup(function()
    assert(bw.mesh.box({max = {0.1, 0.01, 0.01}, cells = {10, 1, 1}, order = 2}):write(path))
  end)

  local function answer(words)
    local status, out, err = check.run("heat --json --conductivity 50 " .. words .. " " .. path)
    return status, status < 2 and bw.json.decode(out) or out, err
  end

  it("finds temperatures of units of their own, and judges them", function()
    -- 2 W through 0.1 m of 1 cm2: 40 K above the cold end
    local status, object = answer "--temperature below:x:0=20C --power above:x:100mm=2"
    assert.equal(0, status)
    assert.equal("computed", object.verdict)
    check.near(293.15 + 40, object.value, 1e-6)
    check.near(-2, object.heat_in[1].heat_w, 1e-9)
    check.near(0.1, object.at_m[1], 1e-12)
    for limit, expected in pairs {["61C"] = "holds", ["330K"] = "exceeds"} do
      status, object = answer("--temperature below:x:0=20C --power above:x:100mm=2 --limit " .. limit)
      assert.equal(expected == "holds" and 0 or 1, status)
      assert.equal(expected, object.verdict)
    end
  end)

  it("takes convection, radiation and a power in the volume", function()
    local status, object = answer "--volume-power 4.2 --convection all=10,20C --radiation all=1,293.15K"
    assert.equal(0, status)
    -- nearly uniform: 4.2 W from 42 cm2 is 1000 W/m2
    local T = object.value
    check.near(1000, 10 * (T - 293.15) + 5.670374419e-8 * (T ^ 4 - 293.15 ^ 4), 20)
    check.near(-4.2, object.heat_in[1].heat_w + object.heat_in[2].heat_w, 1e-6)
    assert.is_true(object.estimated_error_k > 0 and object.estimated_error_k < 1)
  end)

  it("prints sentences, writes files", function()
    local status, out = check.run(("heat %s --material steel --temperature min:x=80C --convection all=10,20C "
      .. "--picture %sh.png --vtu %sh.vtu --report %sh.html"):format(path, folder, folder, folder))
    assert.equal(0, status)
    assert.truthy(out:find("353.15 K (80 C)", 1, true), out)
    assert.truthy(out:find("the conductivity is 53.3 W/(m K), that of steel", 1, true), out)
    assert.truthy(out:find("error of the flux", 1, true), out)
    assert.truthy(out:find("h.png", 1, true))
    local page = check.read(folder .. "h.html")
    for _, text in ipairs {"highest temperature 80 C", "Balance of heat", "<td>convection</td><td>all</td>",
      out:match "The temperature is highest[^\n]*", '"name":"temperature"', '"unit":"C"', "heat flux"} do
      assert.truthy(page:find(text, 1, true), text)
    end
  end)

  it("is sure only within the error of the places, which facets do not fill", function()
    local found = {}
    for i, n in ipairs {10, 20, 40} do
      local plate = folder .. "plate.msh"
      assert(bw.mesh.box({min = {-0.05, -0.05, 0}, max = {0.05, 0.05, 0.02}, cells = {n, n, 2}, order = 2})
        :write(plate))
      local _, out = check.run("heat --json --conductivity 5 --power near:5mm,5mm,20mm:19mm=10 "
        .. "--convection all=50,293K --limit 326K " .. plate)
      found[i] = bw.json.decode(out)
    end
    local last = found[3].value
    for i = 1, 2 do
      assert.is_true(math.abs(found[i].value - last) < found[i].estimated_error_k, i)
      assert.is_true(found[i].place_error_k > found[i + 1].place_error_k)
    end
    assert.is_true(found[1].value > 326 and last < 326)
    assert.is_true(found[1].estimated_error_k > 1.5 * found[1].place_error_k)
    assert.equal("unsure", found[1].verdict)
  end)

  it("gives an error of each number, and none of a flux that is rounding", function()
    local _, object = answer "--volume-power 4.2 --temperature below:x:0=300K --convection all=10,20C"
    assert.equal("volume-power", object.heat_in[3].kind)
    check.near(4.2, object.heat_in[3].heat_w, 1e-9)
    for _, row in ipairs(object.heat_in) do assert.is_true(row.estimated_error_w >= 0) end
    assert.is_true(object.heat_in[2].estimated_error_w > 1e-6)
    assert.equal(50, object.conductivity)
    assert.is_true(object.flux_error > 0)
    _, object = answer "--temperature below:x:0=20C --convection all=10,20C"
    assert.is_nil(object.flux_error)
  end)

  it("refuses what cannot be", function()
    for words, expected in pairs {
      ["--power min:x=2"] = "no temperature is given",
      ["--temperature min:x=warm"] = "a temperature such as 293K or 20C expected, got 'warm'",
      ["--temperature min:x=-300C"] = "'-300C' is below absolute zero",
      ["--convection min:x=10,-1K"] = "'-1K' is below absolute zero",
      ["--temperature min:x=20"] = "'20' has no unit: write 20C or 20K",
      ["--convection min:x=10"] = "two numbers, COEFFICIENT,TEMPERATURE, expected",
      ["--convection min:x=-2,300K"] = "option --convection: coefficient is -2",
      ["--radiation min:x=2,300K"] = "option --radiation: emissivity is 2"} do
      local status, _, err = check.run(("heat --conductivity 50 %s %s"):format(words, path))
      assert.equal(2, status)
      assert.truthy(err:find(expected, 1, true), err)
    end
    local status, _, err = check.run("heat --material abs --temperature min:x=300K " .. path)
    assert.equal(2, status)
    assert.truthy(err:find("the conductivity of abs is not known", 1, true), err)
  end)
end)
