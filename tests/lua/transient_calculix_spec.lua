-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Modal superposition beside *MODAL DYNAMIC of CalculiX (ccx) on the same elements: displacements agree to 1e-6 of
-- the largest. What the modes leave out is not compared: CalculiX has no static part of it. The mass of its C3D10
-- is of lower order: meshes of 8 and 16 cells have a difference of 1.4e-5 and 1.2e-6. Skipped without ccx.
local bw = require "barwright"

local RATIO, COUNT = 0.03, 4

--- Displacements (node_count x 3) after each increment by ccx, of a load whose factor has these rows.
local function by_calculix(part, rows, step, until_time)
  local stem = os.tmpname()
  assert(part:write_inp(stem .. ".inp"))
  local file = assert(io.open(stem .. ".inp"))
  local deck = file:read "a"
  file:close()
  local model, loads = deck:match "^(.-)%*STEP.-%*CLOAD\n(.-)%*NODE PRINT"
  local out = {model .. "*AMPLITUDE, NAME=HISTORY"}
  for _, row in ipairs(rows) do out[#out + 1] = ("%.12g, %.12g"):format(row[1], row[2]) end
  out[#out + 1] = ("*STEP\n*FREQUENCY, STORAGE=YES\n%d\n*END STEP"):format(COUNT)
  out[#out + 1] = ("*STEP, INC=100000\n*MODAL DYNAMIC\n%.12g, %.12g"):format(step, until_time)
  out[#out + 1] = ("*MODAL DAMPING\n1, %d, %g"):format(COUNT, RATIO)
  out[#out + 1] = "*CLOAD, AMPLITUDE=HISTORY\n" .. loads .. "*NODE PRINT, NSET=NALL\nU\n*END STEP\n"
  file = assert(io.open(stem .. ".inp", "w"))
  file:write(table.concat(out, "\n"))
  file:close()
  os.execute(("cd /tmp && OMP_NUM_THREADS=1 ccx -i '%s' > '%s.log' 2>&1"):format(stem, stem))
  local states, state = {}, nil
  for line in assert(io.open(stem .. ".dat")):lines() do
    if line:find "displacements" then
      state = {time = tonumber(line:match "time%s+(%S+)")}
      states[#states + 1] = state
    end
    local node, x, y, z = line:match "^%s+(%d+)%s+(%-?%d%.%S+)%s+(%-?%d%.%S+)%s+(%-?%d%.%S+)%s*$"
    if node and state then state[tonumber(node)] = {tonumber(x), tonumber(y), tonumber(z)} end
  end
  os.execute(("rm -f '%s' '%s'.*"):format(stem, stem))
  return states
end

describe("motion in time beside CalculiX", function()
  if not os.execute "command -v ccx >/dev/null 2>&1" then return end

  it("has the displacements of *MODAL DYNAMIC", function()
    local mesh = bw.mesh.box {max = {1, 0.1, 0.08}, cells = {24, 3, 3}, order = 2}
    local part = bw.model {mesh = mesh, material = bw.material.steel}
    part:fix(mesh.boundary:below("x", 0))
    part:load {on = mesh.boundary:above("x", 1), force = {300, 500, -1000}}
    local modes = assert(part:modes {count = COUNT, tolerance = 1e-12})
    local period = 1 / modes.frequencies[1]
    local step, last = period / 50, 3 * period
    local rows = {{0, 0}, {0.2 * period, 1}, {0.5 * period, 0.6}, {period, -0.7}, {1.2 * period, 0},
      {last, 0.3}}
    local states = by_calculix(part, rows, step, last)
    assert.is_true(#states >= 150)
    local static = assert(part:solve()).displacement
    -- what the modes leave out follows a load at once, also at time 0
    local rest = assert(part:transient {step = step, modes = modes, loads = {1}}).displacement
    local transient = assert(part:transient {step = step, modes = modes, loads = {rows},
      damping = {ratio = RATIO}})
    local largest, off = 0, 0
    for _, state in ipairs(states) do
      assert(transient:step())
      assert.is_true(math.abs(state.time - transient.time) < 1e-6 * last)
      local factor = 0
      for i = 2, #rows do
        local a, b = rows[i - 1], rows[i]
        if transient.time > a[1] and transient.time <= b[1] + 1e-9 * last then
          factor = a[2] + (b[2] - a[2]) * (transient.time - a[1]) / (b[1] - a[1])
        end
      end
      local ours = transient.displacement - rest * factor
      for i = 1, mesh.node_count do
        for k = 1, 3 do
          largest = math.max(largest, math.abs(state[i][k]))
          off = math.max(off, math.abs(state[i][k] - ours(i, k)))
        end
      end
    end
    assert.is_true(largest > 0.5 * static:norm() / math.sqrt(mesh.node_count))
    assert.is_true(off < 1e-6 * largest)
  end)
end)
