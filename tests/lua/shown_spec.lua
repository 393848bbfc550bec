-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Values with their intervals, in sentences: also those without an upper bound, as the workbench answers where the
-- error is as large as the stress.
local bw = require "barwright"
local judge = require "barwright.workbench.judge"
local shown = require "barwright.shown"

describe("an interval", function()
  it("has the unit of its value", function()
    assert.equal("25.8 N (21.3 to 30.9 N)", shown.interval(25.8, 21.3, 30.9, "N"))
    assert.equal("120 kN (80 to 200 kN)", shown.interval(120e3, 80e3, 200e3, "N"))
    assert.equal("25.8 N (0 to 30.9 N)", shown.interval(25.8, 0, 30.9, "N"))
  end)

  it("says what is known without an upper bound", function()
    assert.equal("25.8 N (at least 21.3 N)", shown.interval(25.8, 21.3, nil, "N"))
    assert.equal("25.8 N (at least 21.3 N)", shown.interval(25.8, 21.3, math.huge, "N"))
    assert.equal("25.8 N (error unknown)", shown.interval(25.8, 0, nil, "N"))
  end)

  it("is open where the error of an answer is as large as its stress", function()
    local path = os.tmpname() .. ".stl"
    assert(bw.surface.box {max = {0.05, 0.02, 0.02}}:write(path))
    local bench = assert(bw.workbench.open(path))
    os.remove(path)
    -- a bar that is squeezed: no place of it is singular
    assert(bench:load {faces = {1}, force = {0, 0, 10}})
    local opposite = 2
    for i, face in ipairs(bench:current().body.faces) do
      if face.normal[3] * bench:current().body.faces[1].normal[3] < -0.99 then opposite = i end
    end
    assert(bench:load {faces = {opposite}, force = {0, 0, -10}})
    local entry = bench:current()
    local answer = assert(judge.statics(entry.body, entry.material, entry.conditions, 300,
      {elements = 1, stress = 1, used_mean = 1e-9}))
    assert.equal("unsure", answer.verdict)
    assert.is_nil(answer.force_high)
    assert.is_true(answer.force_low > 0 and answer.force_low < answer.force)
    assert.truthy(answer.sentence:find("N (at least ", 1, true), answer.sentence)
    assert.is_nil(bw.json.decode(bw.json.encode(answer)).force_high)
  end)
end)
