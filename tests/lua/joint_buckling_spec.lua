-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Load factors of models whose remote points are loaded: columns under a rigid lever in closed form, a stiff body
-- in the lever's place, and moments, which are refused where they have no symmetric stiffness.
local bw = require "barwright"
local check = require "check"

local YOUNG = 2e11
local straight = bw.material.isotropic {young = YOUNG, poisson = 0, density = 1000}

--- A bar along x, fixed at x = 0.
local function bar(cells, max)
  local mesh = bw.mesh.box {max = max, cells = cells, order = 2}
  local part = bw.model {mesh = mesh, material = straight}
  return part:fix(mesh.boundary:below("x", 0)), mesh.boundary:above("x", max[1])
end

--- The first zero of f between a and b.
local function zero(f, a, b)
  local positive = f(a) > 0
  for _ = 1, 100 do
    local middle = (a + b) / 2
    if (f(middle) > 0) == positive then a = middle else b = middle end
  end
  return (a + b) / 2
end

describe("buckling under remote points", function()
  it("has the column with a rigid lever in closed form", function()
    local L, h, w = 1, 0.02, 0.03
    local stiffness = YOUNG * w * h ^ 3 / 12
    for _, kind in ipairs {"rigid", "distributed"} do
      for _, a in ipairs {0, 0.3, 1, -0.5} do
        local part, tip = bar({20, 1, 1}, {L, h, w})
        part:couple {on = tip, kind = kind, at = {L + a, h / 2, w / 2}, force = {-1, 0, 0}}
        local factor = assert(assert(part:solve()):buckling {count = 1}).factors[1]
        -- the point is at w(L) + a w'(L); a point behind the tip buckles the column when it is pulled first
        local function pushed(k) return math.cos(k * L) - a * k * math.sin(k * L) end
        local function pulled(k) return 1 + a * k + (1 - a * k) * math.exp(-2 * k * L) end
        local k = a >= 0 and zero(pushed, 1e-3, math.pi / 2) or zero(pulled, 1e-3, 9)
        local load = stiffness * k * k * (a >= 0 and 1 or -1)
        check.near(load / (1 + 1.2 * load / (YOUNG / 2 * h * w)), factor, 3e-4)
      end
    end
  end)

  -- The stress of a stiff body is in the matrix of the initial stress; the lever's stiffness takes its place.
  it("agrees with a stiff body in the place of the lever, under oblique forces", function()
    local size, cells = {1, 0.01, 0.1}, 10
    for _, force in ipairs {{0, 0, -1}, {-1, 0, -0.3}, {0.2, 1e-3, 1}} do
      local long = bw.mesh.box {max = {1.3, size[2], size[3]}, cells = {13, 1, 1}, order = 2}
      local mesh = assert(long:split({min = {1, -1, -1}, max = {2, 1, 1}}, "lever"))
      local stiff = bw.material.isotropic {young = 1e3 * YOUNG, poisson = 0, density = 1000}
      local whole = bw.model {mesh = mesh, materials = {rest = straight, lever = stiff}}
      whole:fix(mesh.boundary:below("x", 0))
      whole:couple {on = mesh.boundary:above("x", 1.3), kind = "rigid", at = {1.3, size[2] / 2, size[3] / 2},
        force = force}
      local expected = assert(assert(whole:solve()):buckling {count = 1}).factors[1]
      for _, kind in ipairs {"rigid", "distributed"} do
        local part, tip = bar({cells, 1, 1}, size)
        part:couple {on = tip, kind = kind, at = {1.3, size[2] / 2, size[3] / 2}, force = force}
        local found = assert(assert(part:solve()):buckling {count = 1}).factors[1]
        check.near(math.abs(expected), math.abs(found), kind == "rigid" and 5e-4 or 5e-3)
      end
    end
  end)

  it("refuses moments about which a point can turn freely, and takes others", function()
    local part, tip = bar({10, 1, 1}, {1, 0.02, 0.03})
    part:couple {on = tip, kind = "rigid", moment = {0, 1, 0}}
    check.fails("unsupported", "is not symmetric", assert(part:solve()):buckling {count = 1})
    part:clear_couplings():couple {on = tip, kind = "rigid", moment = {0, 1, 0}, displacement = {false, 0, false},
      rotation = {0, false, 0}}
    assert(assert(part:solve()):buckling {count = 1})
  end)
end)
