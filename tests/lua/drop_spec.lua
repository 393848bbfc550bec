-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Drops in time: what a script sees of them. The physics is in tests/engine/drop.
local bw = require "barwright"

local function box(order)
  local mesh = bw.mesh.box {max = {0.03, 0.02, 0.01}, cells = {3, 2, 1}, order = order or 1}
  return bw.model {mesh = mesh, material = bw.material.pla}
end

describe("drop", function()
  it("gives impacts, a balance of energy and the stress where it peaks", function()
    local part = box(2)
    local drop = assert(part:drop {height = 0.5, down = {-1, -2, -3}, spin = {10, 0, 0}, impacts = 2,
      samples = 20})
    assert.equal(2, #drop.impacts)
    assert.is_true(drop.impacts[2].time > drop.impacts[1].time + drop.impacts[1].duration)
    assert.near(math.sqrt(2 * 9.80665 * 0.5), drop.speed, 1e-12)
    local sum = bw.array.map("a + b + c + d", {a = drop.motion_energy, b = drop.vibration_energy,
      c = drop.strain_energy, d = drop.potential_energy})
    assert.is_true(sum:map("abs(a - e)", {e = drop.initial_energy}):max() <= 1.001e-3 * drop.initial_energy)
    assert.is_true(drop.energy_error < 1e-3)
    assert.near(drop.peak.stress, drop.max_principal[drop.peak.element], 0)
    assert.near(drop.peak.stress, drop.sample_stresses:max(), 0)
    assert.near(drop.peak.stress, drop.max_principal:max(), 0)
    local text = tostring(drop)
    for _, words in ipairs {"2 impacts", "error unknown", "no friction", "no damping", "kept to"} do
      assert.truthy(text:find(words, 1, true), words)
    end
    assert.near(0, drop.impacts[1].place[1], 1e-12)
  end)

  it("takes modes of a former drop and gives the same bits", function()
    local part = box()
    local first = assert(part:drop {down = {-1, -2, -3}})
    local second = assert(part:drop {down = {-1, -2, -3}, modes = first.modes})
    assert.equal(first.peak.stress, second.peak.stress)
    assert.equal(first.solves, second.solves)
  end)

  it("writes its history, fields and a picture", function()
    local drop = assert(box():drop {down = {-1, -2, -3}, samples = 5})
    local csv, vtu, png = os.tmpname(), os.tmpname() .. ".vtu", os.tmpname() .. ".png"
    assert(drop:write_history(csv))
    local lines = 0
    for line in io.lines(csv) do
      if lines == 0 then assert.truthy(line:find("time_s,force_N", 1, true)) end
      lines = lines + 1
    end
    assert.equal(#drop.times + 1, lines)
    assert(drop:write(vtu))
    assert(drop:picture(png, {width = 64, height = 64}))
    for _, path in ipairs {csv, vtu, png} do os.remove(path) end
  end)

  it("refuses what it does not know, in one sentence", function()
    local part = box()
    local bare = assert(part:drop {down = {-1, -2, -3}, samples = 0})
    assert.is_nil(bare.peak)
    assert.error_matches(function() bare:write "/tmp/x.vtu" end, "no stress")
    assert.error_matches(function() part:drop {height = -1} end, "negative")
    assert.error_matches(function() part:drop {onto = 3} end, "onto")
    local drop, message = part:drop {onto = bw.rigid.sphere {centre = {0, 0, -1}, radius = 1}}
    assert.is_nil(drop)
    assert.truthy(message:find "bw.rigid.plane")
    part:fix(part.mesh.boundary:below("x", 0))
    assert.error_matches(function() part:drop() end, "neither supports nor loads")
  end)

  it("at random gives each place a probability with the error of its sampling", function()
    local part = box()
    local drops = assert(bw.random_drops(part, {drops = 12, height = 3, spin = 2, samples = 5}))
    local low, high = drops:interval()
    local p, least, most = drops:failures()
    assert.equal(12, #drops.peaks)
    assert.is_true(drops.exceedance:max() <= p and least < p and p <= most)
    assert.equal(0, low:min())
    assert.is_true(low:map("b - a", {b = drops.exceedance}):min() >= -1e-15)
    assert.is_true(high:map("a - b", {b = drops.exceedance}):min() >= -1e-15)
    -- Wilson's upper end where nothing was seen: z^2 / (n + z^2)
    assert.near(3.841459 / 15.841459, high:min(), 1e-5)
    assert.near(1, drops:correlation(drops.mean_peak), 1e-12)
    assert.truthy(tostring(drops):find("95 %", 1, true))
    local again = assert(bw.random_drops(part, {drops = 12, height = 3, spin = 2, samples = 5,
      modes = drops.modes}))
    for i = 1, 12 do assert.equal(drops.peaks[i], again.peaks[i]) end
  end)

  it("at random refuses a part whose strength is not known", function()
    local soft = bw.material.isotropic {young = 1e9, poisson = 0.3, density = 1000}
    local part = bw.model {mesh = bw.mesh.box {max = {0.02, 0.02, 0.02}, cells = {1, 1, 1}}, material = soft}
    assert.error_matches(function() bw.random_drops(part, {drops = 2}) end, "strength")
  end)
end)
