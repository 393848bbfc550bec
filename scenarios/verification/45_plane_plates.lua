-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Free thin plates beside published frequencies and nodal lines.
local bw = require "barwright"
local engine = require "engine"
local tools = require "tools"

local scenario, expect = bw.scenario, bw.scenario.expect

scenario.about {title = "Vibrating plates",
  text = [[Free thin plates by the equations of Reissner and Mindlin beside published frequencies and nodal
lines.]]}

local THICKNESS, YOUNG, DENSITY = 1e-3, 70e9, 2700
local function material(poisson) return tools.elastic(YOUNG, poisson, DENSITY) end

-- omega a^2 sqrt(rho h / D)
local function parameter(frequency, length, poisson)
  local d = YOUNG * THICKNESS ^ 3 / (12 * (1 - poisson ^ 2))
  return 2 * math.pi * frequency * length ^ 2 * math.sqrt(DENSITY * THICKNESS / d)
end

-- Bessel functions J_n and I_n by their series.
local function bessel(n, x, sign)
  local term, sum = 1, 0
  for k = 1, n do term = term * x / 2 / k end
  for k = 1, 60 do
    sum = sum + term
    term = sign * term * (x / 2) ^ 2 / (k * (k + n))
  end
  return sum
end

-- The lowest lambda = omega a^2 sqrt(rho h / D) above `from` of a free circular plate with n nodal
-- diameters: no moment M and no force V at its edge for w = A J_n(k r) + C I_n(k r), cos n theta.
local function circular(n, nu, from)
  local function determinant(k)
    local function edge(sign)
      local f = function(r) return bessel(n, k * r, sign) end
      local w = f(1)
      local slope = n / 1 * w + (sign < 0 and -k * bessel(n + 1, k, -1) or k * bessel(n + 1, k, 1))
      -- the Laplacian of J_n(k r) is -k^2 J_n, of I_n k^2 I_n
      local second = sign * k * k * w - slope + n * n * w
      local moment = second + nu * (slope - n * n * w)
      local force = sign * k * k * slope - (1 - nu) * n * n * (slope - w)
      -- V = d/dr lap w + (1 - nu)/r^2 d^2/dtheta^2 (dw/dr - w/r)
      return moment, force
    end
    local mj, vj = edge(-1)
    local mi, vi = edge(1)
    return mj * vi - mi * vj
  end
  local k, step = math.sqrt(from), 0.05
  while determinant(k) * determinant(k + step) > 0 do k = k + step end
  return tools.root(determinant, k, k + step) ^ 2
end

-- The largest distance of a nodal line's end from the place it should be at.
local function farthest(lines, distance)
  local max = 0
  for _, l in ipairs(lines:totable()) do
    max = math.max(max, distance(l[1], l[2]), distance(l[3], l[4]))
  end
  return max
end

scenario("Leissa, free square plate", {about = "A thousandth as thick as wide. Leissa's values are upper bounds; "
  .. "the limits, on which finer calculations agree, lie up to 1 % below."}, function()
  local bar = assert(bw.responsive.metallophone {outline = assert(bw.outline.rectangle {width = 1, height = 1}),
    material = material(0.3), thickness = THICKNESS, modes = 5, elements = 800})
  local leissa = {13.489, 19.789, 24.432, 35.024, 35.024}
  for i, limit in ipairs {13.468, 19.596, 24.270, 34.801, 34.801} do
    local found = parameter(bar.frequencies[i], 1, 0.3)
    expect(found, ("lambda_%d, limit"):format(i)):near(limit, {relative = 0.0005, source = "Ritz, many terms"})
    expect(found, ("lambda_%d"):format(i)):near(leissa[i], {relative = 0.011, source = "Leissa 1973"})
  end
  -- the lowest mode twists: at rest on the two centre lines; near the centre, where they cross, it hardly
  -- moves at all
  local off = farthest(bar.nodal_lines, function(x, y)
    if (x - 0.5) ^ 2 + (y - 0.5) ^ 2 < 0.1 ^ 2 then return 0 end
    return math.min(math.abs(x - 0.5), math.abs(y - 0.5))
  end)
  expect(off, "nodal lines of the lowest mode off the centre lines / side")
    :below(2e-3, {source = "symmetry"})
end)

scenario("Free circular plate", function()
  local nu = 0.33
  local bar = assert(bw.responsive.metallophone {outline = assert(bw.outline.circle {radius = 1}),
    material = material(nu), thickness = THICKNESS, modes = 6, elements = 800})
  local two, none, three = circular(2, nu, 1), circular(0, nu, 1), circular(3, nu, 1)
  for i, mode in ipairs {{two, 2, 0}, {two, 2, 0}, {none, 0, 1}, {three, 3, 0}, {three, 3, 0}} do
    expect(parameter(bar.frequencies[i], 1, nu), ("lambda_%d: %d nodal diameters, %d circles"):format(i,
      mode[2], mode[3]))
      :near(mode[1], {relative = 0.0005, source = "Bessel functions, Kirchhoff"})
  end
  expect(two, "the two diameters, Leissa"):near(5.253, {relative = 0.002, source = "Leissa 1969, nu = 0.33"})
  expect(none, "one circle, Leissa"):near(9.084, {relative = 0.002, source = "Leissa 1969, nu = 0.33"})
end)

scenario("Slender bar", function()
  local bar = assert(bw.responsive.metallophone {outline = assert(bw.outline.rectangle {width = 1,
    height = 0.02}), material = material(0.3), thickness = THICKNESS, modes = 2, elements = 400})
  for i, beta in ipairs {4.730040744862704, 7.853204624095838} do
    expect(bar.frequencies[i], ("bending %d"):format(i), "Hz")
      :near(beta ^ 2 / (2 * math.pi) * math.sqrt(YOUNG * THICKNESS ^ 2 / (12 * DENSITY)),
        {relative = 0.002, source = "Euler-Bernoulli"})
  end
  expect(farthest(bar.nodal_lines, function(x) return math.abs(math.min(x, 1 - x) - 0.22416) end),
    "nodal lines / length: farthest from 0.2242 of the length")
    :below(2e-3, {source = "Euler-Bernoulli"})
  local holes = assert(bar:holes())
  expect(holes[1][1], "first place to support it, x / length")
    :near(0.22416, {relative = 0.005, source = "Euler-Bernoulli"})
  expect(holes[2][1], "second place to support it, x / length")
    :near(1 - 0.22416, {relative = 0.002, source = "Euler-Bernoulli"})
end)

scenario("Modes beside ARPACK", {tags = {"slow"}, about = "The four lowest frequencies of random curved plates, "
  .. "some holed, isotropic and orthotropic, 1 and 4 mm thick, before and after a pull at the rim, within 1e-8 of "
  .. "what ARPACK finds for the same matrices on a factor by UMFPACK."}, function(t)
  engine.run(t, "responsive_test_plate_arpack")
end)
