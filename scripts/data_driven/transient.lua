-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- A scene released from its loaded shape: fine and coarse side by side as an animation, with its energies.
local bw = require "barwright"
local compare = require "compare"

local transient = {}

local function energies(m)
  return {time_s = m.time, kinetic_j = m.kinetic, strain_j = m.strain, potential_j = m.potential,
    dissipated_j = m.dissipated}
end

-- The transient dynamics of a solid released from the shape of a solution, with its supports and without loads.
local function released(opts, fine, solution, by)
  local free, message, details = bw.solid {grid = fine.grid, materials = fine.materials}
  if not free then return nil, message, details end
  opts.fixed(free)
  if by then
    free, message, details = free:coarsen(by, 1)
    if not free then return nil, message, details end
  end
  local jacobi = bw.solver.pcg {preconditioner = bw.solver.jacobi()}
  local moving
  moving, message, details = free:transient {scheme = "implicit_euler", step = opts.step, iterations = 1,
    displacement = solution.displacement, solver = not by and jacobi or nil}
  return moving, message, details, free
end

--- Goes `opts.steps` steps of `opts.step` seconds with the linearly implicit scheme, and draws
--- transient.png into a folder. solutions: {{title =, by = library, "naive" or nil: fine, solution =}, ...}.
--- Returns what goes into result.json; nil, message, details.
function transient.run(out, opts, fine, solutions)
  local parts = {}
  for i, each in ipairs(solutions) do
    local moving, message, details, solid = released(opts, fine, each.solution, each.by)
    if not moving then return nil, message, details end
    parts[i] = {title = each.title, moving = moving, solid = solid, seconds = 0}
  end
  local box = fine.grid.box
  local view = {{}, {}}
  for k = 1, 3 do
    local margin = 0.12 * (box.max[2] - box.min[2])
    view[1][k], view[2][k] = box.min[k] - margin, box.max[k] + margin
  end
  local names, rows, max = {}, bw.json.list {}, 0
  for _, each in ipairs(solutions) do max = math.max(max, each.solution.movement:max()) end
  local function draw(frame)
    local panels = {}
    for i, part in ipairs(parts) do
      local u = part.moving.displacement
      panels[i] = {title = part.title, grid = part.solid.grid, displacement = u,
        values = u:map "sqrt(a.x*a.x + a.y*a.y + a.z*a.z)"}
    end
    names[#names + 1] = ("%s/frame_%03d.png"):format(out, frame)
    return bw.grid.picture(names[#names], panels, {direction = opts.direction, up = {0, 0, 1}, width = 380,
      height = 380, columns = #panels, unit = "movement, mm", scale = 1e3, min = 0, max = max,
      view = view})
  end
  local function remove()
    for _, name in ipairs(names) do os.remove(name) end
  end
  rows[1] = energies(parts[#parts].moving)
  local drawn, message, details = draw(0)
  for step = 1, opts.steps do
    if not drawn then break end
    for _, part in ipairs(parts) do
      local spent
      spent, drawn, message, details = compare.timed(part.moving.step, part.moving)
      part.seconds = part.seconds + spent.processor
      if not drawn then break end
    end
    if drawn and step % opts.each == 0 then
      drawn, message, details = draw(step)
      rows[#rows + 1] = energies(parts[#parts].moving)
    end
  end
  if drawn then
    drawn, message, details = bw.animation(out .. "/transient.png", names, {seconds = opts.each * opts.step * 4})
  end
  remove()
  local result = {words = opts.words, step_s = opts.step, steps = opts.steps, energies = rows,
    of = parts[#parts].title, solids = bw.json.list {}}
  for i, part in ipairs(parts) do
    result.solids[i] = {title = part.title, elements = part.solid.element_count,
      seconds_per_step = part.seconds / opts.steps}
    part.moving:close()
  end
  if not drawn then return nil, message, details end
  return result
end

return transient
