-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Frames of a motion as XDMF, read by meshio where it is installed.
local bw = require "barwright"

describe("frames of a recording", function()
  local mesh = bw.mesh.box {max = {1, 0.1, 0.1}, cells = {4, 1, 1}}
  local part = bw.model {mesh = mesh, material = bw.material.steel}
  part:fix(mesh.boundary:below("x", 0)):gravity {0, 0, -9.81}
  local path = os.tmpname()
  os.remove(path)
  path = path .. ".xdmf"

  it("are written as XDMF, with the same numbers in meshio", function()
    local recording = assert(assert(part:transient {step = 1e-4}):run {time = 0.002, frames = 4, stress_every = 5})
    assert(recording:write(path))
    local program = ([[
import meshio
with meshio.xdmf.TimeSeriesReader(%q) as r:
  p, c = r.read_points_cells()
  print(r.num_steps, len(p), len(c[0].data), p[:, 0].max())
  for k in range(r.num_steps):
    t, d, e = r.read_data(k)
    print(repr(t), repr(float(d["displacement"][:, 2].min())), repr(float(d["von_mises"].max())))
]]):format(path)
    local script = assert(io.open(path .. ".py", "w"))
    script:write(program)
    script:close()
    local pipe = assert(io.popen("/usr/bin/python3 -W ignore " .. path .. ".py 2>/dev/null"))
    local text = pipe:read "a"
    pipe:close()
    os.remove(path .. ".py")
    if text == "" and not os.execute "/usr/bin/python3 -c 'import meshio' 2>/dev/null" then
      return pending "meshio is not installed"
    end
    local lines, frames = {}, recording.frames
    for line in text:gmatch "[^\n]+" do lines[#lines + 1] = line end
    assert.equal(("%d 20 36 1.0"):format(#frames.displacement), lines[1])
    for i, displacement in ipairs(frames.displacement) do
      local time, least, most = lines[i + 1]:match "(%S+) (%S+) (%S+)"
      assert.equal(frames.time[i], tonumber(time))
      assert.equal(displacement:column(3):min(), tonumber(least))
      assert.equal(frames.von_mises[i]:max(), tonumber(most))
    end
  end)

  it("must be there", function()
    local recording = assert(assert(part:transient {step = 1e-4}):run {time = 1e-3})
    local ok, message = pcall(recording.write, recording, path)
    assert.is_false(ok)
    assert.truthy(message:find "give run frames")
    os.remove(path)
  end)
end)
