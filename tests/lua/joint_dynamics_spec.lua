-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Harmonic response, random vibration and response spectra of joined models: a body cut in two, closed forms of
-- rods and bodies on springs, and CalculiX (ccx) on the same elements where it is there.
local bw = require "barwright"
local check = require "check"
local beam = require "cut_beam"
local tied_beam = require "tied_beam"

local PI = math.pi

--- A rod along x without lateral contraction, fixed at x = 0, of density `density`.
local function rod(density, cells)
  local mesh = bw.mesh.box {max = {1, 0.1, 0.1}, cells = cells or {12, 1, 1}, order = 2}
  local part = bw.model {mesh = mesh,
    material = bw.material.isotropic {young = 2e11, poisson = 0, density = density}}
  part:fix(mesh.boundary:below("x", 0))
  return part, mesh.boundary:above("x", 1)
end

describe("dynamics of joined models", function()
  it("answer a body cut in two and bonded as the whole", function()
    local found = {}
    for i, cut in ipairs {false, true} do
      local part, tip = beam(cut, {4, 2, 1})
      local shaken = assert(part:load {on = tip, force = {0, 30, 100}}:harmonic {
        frequencies = {0, 20, 41, 60, 300, 1000}, damping = {ratio = 0.02, loss = 0.01}, base = {0, 1, 9}})
      local random = assert(shaken:random {psd = {{10, 1}, {900, 1}}})
      part:clear_loads()
      local spectrum = assert(part:response_spectrum {points = {{1, 2}, {100, 10}, {500, 4}},
        direction = {0, 0.2, 1}})
      local curve = assert(shaken:curve {at = {1, 0, 0}})
      found[i] = {curve = curve, random = random, spectrum = spectrum,
        places = part.mesh.nodes:totable(), mises = random.von_mises:max(), most = spectrum.von_mises:max()}
    end
    local whole, cut = table.unpack(found)
    check.same(whole.curve.real, cut.curve.real, 1e-9)
    check.same(whole.curve.imaginary, cut.curve.imaginary, 1e-9)
    check.near(whole.mises, cut.mises, 1e-8)
    check.near(whole.most, cut.most, 1e-8)
    check.near(whole.random.displacement:max(), cut.random.displacement:max(), 1e-8)
    for k = 1, 3 do
      assert.is_true(math.abs(whole.spectrum.base_force[k] - cut.spectrum.base_force[k])
        < 1e-8 * whole.spectrum.base_force[3])
    end
    check.near(whole.spectrum.mass, cut.spectrum.mass, 1e-12)
  end)

  it("have the response of a rod with a mass at its end in closed form", function()
    local area, young, density, mass, force = 0.01, 2e11, 7800, 50, 1000
    local function expected(f, at)
      local w = 2 * PI * f
      local k = w * math.sqrt(density / young)
      return force * math.sin(k * at) / (young * area * k * math.cos(k) - mass * w * w * math.sin(k))
    end
    local list = {100, 400, 700, 1500, 2500}
    for _, how in ipairs {"attached", "rigid", "distributed"} do
      local part, tip = rod(density, {40, 1, 1})
      if how == "attached" then
        part:attach {on = tip, mass = mass}:load {on = tip, force = {force, 0, 0}}
      else
        part:couple {on = tip, kind = how, mass = mass, force = {force, 0, 0}}
      end
      local shaken = assert(part:harmonic {frequencies = list})
      local curve = assert(shaken:curve(how == "attached" and {at = {1, 0, 0}} or {coupling = 1}))
      local middle = assert(shaken:curve {at = {0.5, 0, 0}})
      for i, f in ipairs(list) do
        assert.is_true(math.abs(expected(f, 1) - curve.real(i, 1)) < 1e-5 * force / (young * area))
        assert.is_true(math.abs(expected(f, 0.5) - middle.real(i, 1)) < 1e-5 * force / (young * area))
      end
    end
  end)

  it("keep their remote points when the part changes", function()
    local part, tip = rod(7800)
    part:couple {on = tip, at = {1, 0.05, 0.3}, mass = 5, force = {0, 0, 100}}
    local response, psd = assert(part:harmonic {range = {1, 500}, damping = {ratio = 0.02}}), {{1, 1}, {500, 1}}
    local spectrum = assert(part:response_spectrum {points = {{1, 1}, {500, 2}}, direction = {0, 0, 1}})
    local function motions()
      local curve, rms = response:curve {coupling = 1, frequencies = {10}}, response:random {psd = psd}
      return {curve.at[3], curve.real(1, 3), curve.rotation.real(1, 2), #rms.couplings,
        rms.couplings[1].displacement[3], #spectrum.couplings, spectrum.couplings[1].displacement[3]}
    end
    local before = motions()
    assert.is_true(before[5] > 0 and before[7] > 0)
    part:clear_couplings():couple {on = tip, at = {2, 0, 0}}
    part:couple {on = tip, at = {3, 0, 0}, kind = "distributed"}
    assert.same(before, motions())
    part:clear_couplings()
    assert.same(before, motions())
    check.raises("coupling: a number from 1 to 1 expected, got 2", response.curve, response, {coupling = 2})
    local plain = assert(part:load({on = tip, force = {1, 0, 0}}):harmonic {frequencies = {1}})
    check.raises("coupling: there is none, got 1", plain.curve, plain, {coupling = 1})
  end)

  it("move a mass with inertia on a lever as a body on the springs that its point has", function()
    local mass, inertia = 20, {0.3, 0.5, 0.7}
    for _, kind in ipairs {"rigid", "distributed"} do
      local function point(load, moment, loaded)
        -- lighter, and rounding moves the point more than the mass of the rod does
        local part, tip = rod(3e-3, {6, 1, 1})
        part:couple {on = tip, kind = kind, at = {1.2, 0.05, 0.2}, force = load, moment = moment,
          spring = {0, 3e5, 0}, rotational_spring = {2e4, 0, 0},
          mass = loaded and mass or 0, inertia = loaded and inertia or nil}
        return part
      end
      -- the flexibility of the point, column by column
      local flexibility = {}
      for k = 1, 6 do
        local unit = {0, 0, 0, 0, 0, 0}
        unit[k] = 1
        local turned = point({unit[1], unit[2], unit[3]}, {unit[4], unit[5], unit[6]}, true)
        local q = assert(turned:solve()).couplings[1]
        for c = 1, 6 do
          flexibility[c] = flexibility[c] or {}
          flexibility[c][k] = c <= 3 and q.displacement[c] or q.rotation[c - 3]
        end
      end
      local m = {mass, mass, mass, inertia[1], inertia[2], inertia[3]}
      local load = {10, -20, 30, 2, 3, -4}
      local list = {3, 25, 90, 300, 900}
      local shaken = assert(point({10, -20, 30}, {2, 3, -4}, true):harmonic {frequencies = list})
      local curve = assert(shaken:curve {coupling = 1})
      for i, f in ipairs(list) do
        -- (1 - w^2 F M) q = F p by elimination
        local w2, a = (2 * PI * f) ^ 2, {}
        for r = 1, 6 do
          a[r] = {}
          local right = 0
          for c = 1, 6 do
            a[r][c] = (r == c and 1 or 0) - w2 * flexibility[r][c] * m[c]
            right = right + flexibility[r][c] * load[c]
          end
          a[r][7] = right
        end
        for p = 1, 6 do
          local best = p
          for r = p + 1, 6 do if math.abs(a[r][p]) > math.abs(a[best][p]) then best = r end end
          a[p], a[best] = a[best], a[p]
          for r = 1, 6 do
            local factor = r ~= p and a[r][p] / a[p][p] or 0
            for c = p, 7 do a[r][c] = a[r][c] - factor * a[p][c] end
          end
        end
        for c = 1, 6 do
          local own = c <= 3 and curve.real(i, c) or curve.rotation.real(i, c - 3)
          local size = 0
          for b = c <= 3 and 1 or 4, c <= 3 and 3 or 6 do size = math.max(size, math.abs(a[b][7] / a[b][b])) end
          local off = math.abs(own - a[c][7] / a[c][c])
          assert.is_true(off < 1e-5 * size, ("%s %g Hz %d: %g of %g"):format(kind, f, c, off, size))
        end
      end
    end
  end)

  it("shake a mass on a light rod as Miles and a spectrum have it", function()
    local mass, ratio = 100, 0.05
    for _, kind in ipairs {"rigid", "distributed"} do
      local part, tip = rod(3e-3, {4, 1, 1})
      part:couple {on = tip, kind = kind, mass = mass}
      local w = math.sqrt(2e11 * 0.01 / mass)
      local f, last = w / (2 * PI), 40 * w / (2 * PI)
      local shaken = assert(part:harmonic {range = {0, last}, base = {1, 0, 0}, damping = {ratio = ratio}})
      local random = assert(shaken:random {psd = {{0, 2}, {last, 2}}})
      local square = 2 / (8 * ratio * w ^ 3) - 2 / (3 * (2 * PI) ^ 4 * last ^ 3)
      check.near(math.sqrt(square), random.couplings[1].displacement[1], 1e-6)
      assert.is_true(random.couplings[1].rotation[2] < 1e-6 * random.couplings[1].displacement[1])
      local spectrum = assert(part:response_spectrum {points = {{0.01 * f, 3}, {100 * f, 3}},
        direction = {2, 0, 0}, damping = ratio})
      check.near(3 / w ^ 2, spectrum.couplings[1].displacement[1], 1e-5)
      check.near(3 * mass, spectrum.base_force[1], 1e-5)
      check.near(mass, spectrum.mass, 1e-6)
      check.near(mass, spectrum.effective_masses:max(), 1e-5)
    end
  end)

  it("lose energy in regions and none in springs", function()
    local bar = rod(3e-3, {6, 1, 1}).mesh
    local mesh = assert(bar:split({min = {-1, -1, -1}, max = {0.5, 1, 1}}, "root"))
    local k, s, m, loss = 2e9, 1e9, 50, 0.2
    for _, kind in ipairs {"rigid", "distributed"} do
      local part = bw.model {mesh = mesh,
        material = bw.material.isotropic {young = 2e11, poisson = 0, density = 3e-3}}
      part:fix(mesh.boundary:below("x", 0)):couple {on = mesh.boundary:above("x", 1), kind = kind,
        force = {1000, 0, 0}, mass = m, spring = {s, 0, 0}}
      local list = {0, 500, 1200, 1240, 2000}
      local shaken = assert(part:harmonic {frequencies = list, damping = {loss = {root = loss}}})
      local curve = assert(shaken:curve {coupling = 1})
      for i, f in ipairs(list) do
        -- two springs 2 k and 2 k (1 + i loss) one behind the other, and s beside them
        local below = 4 + loss * loss
        local re, im = 2 * k * (2 + loss * loss) / below + s - (2 * PI * f) ^ 2 * m, 2 * k * loss / below
        local square = re * re + im * im
        local off = math.sqrt((1000 * re / square - curve.real(i, 1)) ^ 2
          + (1000 * im / square + curve.imaginary(i, 1)) ^ 2)
        assert.is_true(off < 5e-6 * 1000 / math.sqrt(square), ("%s %g Hz: %g"):format(kind, f, off))
      end
    end
  end)

  if os.execute "command -v ccx >/dev/null 2>&1" then
    -- light: CalculiX integrates the mass of elements with fewer points
    it("have the response that CalculiX has of a tied beam with a mass on a lever", function()
      local part, tip = beam(true, {6, 2, 1}, bw.material.isotropic {young = 2e11, poisson = 0.3, density = 1})
      local at, modes, ratio, list = {1.1, 0.05, 0.1}, 20, 0.02, {15, 60}
      local point, turn = tied_beam(part, tip, at, 5, ([[
*STEP
*FREQUENCY, STORAGE=YES
%d
*END STEP
*STEP
*STEADY STATE DYNAMICS
%g, %g, 2
*MODAL DAMPING
1, %d, %g
*CLOAD
POINT_NODE, 2, 20.
POINT_NODE, 3, 100.
*NODE PRINT, NSET=POINT
U
*NODE PRINT, NSET=TURN
U
*END STEP
]]):format(modes, list[1], list[2], modes, ratio))
      part:couple {on = tip, kind = "rigid", at = at, mass = 5, force = {0, 20, 100}}
      local curve = assert(assert(part:harmonic {frequencies = list, damping = {ratio = ratio}, modes = modes,
        residual_vectors = 0}):curve {coupling = 1})
      for i, f in ipairs(list) do
        for _, of in ipairs {{point, curve}, {turn, curve.rotation}} do
          local found = {}
          for _, row in ipairs(of[1]) do if math.abs(row.time - f) < 1e-3 then found[#found + 1] = row end end
          for part_of, values in ipairs {of[2].real, of[2].imaginary} do
            local largest = of[2].amplitude:rows(i, i):max()
            for c = 1, 3 do
              local off = values(i, c) - found[part_of][c]
              assert.is_true(math.abs(off) < 1e-6 * largest, ("%g Hz: %g of %g"):format(f, off, largest))
            end
          end
        end
      end
    end)
  end

  it("print remote points, and refuse what they do not know", function()
    local part, tip = rod(7800, {4, 1, 1})
    part:couple {on = tip, kind = "rigid", mass = 3, force = {1, 0, 0}}
    local shaken = assert(part:harmonic {range = {0, 500}, damping = {ratio = 0.02}})
    local curve = assert(shaken:curve {coupling = 1})
    assert.truthy(tostring(curve):find("displacement of the remote point of coupling 1", 1, true))
    assert.truthy(tostring(curve.rotation):find("rotation of the remote point of coupling 1", 1, true))
    assert.truthy(tostring(curve.rotation):find(" rad at ", 1, true), tostring(curve.rotation))
    check.raises("coupling", function() shaken:curve {coupling = 2} end)
    check.raises("either 'at'", function() shaken:curve {} end)
    part:clear_couplings():couple {on = tip, displacement = {1e-3, false, false}}
    check.fails("unsupported", "prescribed motion that is not zero",
      part:harmonic {range = {0, 5}, base = {1, 0, 0}})
    part:clear_couplings():clear_supports():attach {on = tip, mass = 1}
    check.fails("unconstrained", "rigid-body mode", part:harmonic {range = {0, 5}, base = {1, 0, 0}})
  end)
end)
