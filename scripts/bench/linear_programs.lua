-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Worst-load linear programs of growing size by each solver, in one run: seconds and iterations of a program, with
-- and without friction, and what the engine chooses.
local bw = require "barwright"
local folder = arg[0]:match "^(.*)/" or "."
package.path = folder .. "/?.lua;" .. package.path
local options = require "options"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "linear programs of worst loads by each solver",
  about = "Bodies are plates of n x n x 2 boxes and, with --models, a surface that nobody made for it. The "
    .. "pressure is limited so that a load presses on 5 % of the surface.",
  options = {script.option.out, options.models,
    {name = "programs", value = "COUNT", type = "integer", default = 6, min = 1, what = "objectives of each size"},
    {name = "friction", value = "NUMBER", type = "number", default = 0.3, min = 0, max = 100,
      what = "coefficient of friction of the second table"},
    {name = "max-columns", value = "COUNT", type = "integer", default = 60000,
      what = "with friction: GLPK is left out above so many columns"}},
}
local results = opts.out and assert(script.results(opts.out, opts, {script = "scripts/bench/linear_programs.lua"}))

local PRESSED, FORCE, FACETS = 0.05, 20, 6
local solvers = {bw.lp.dual_simplex {}, bw.lp.glpk {}}

local bodies = {}
for _, n in ipairs {6, 20, 40, 80, 160} do
  bodies[#bodies + 1] = {name = ("plate %d"):format(n), mesh = function()
    return bw.mesh.box {max = {0.1, 0.1, 0.2 / n}, cells = {n, n, 2}}
  end}
end
if opts.models then
  bodies[#bodies + 1] = {name = "fertility", mesh = function()
    return assert(bw.mesh.fill(assert(bw.surface.read(opts.models .. "/fertility.off")), {elements = 60000,
      tolerance = 0.1}))
  end}
end

-- Work of the pressures on smooth fields, far from rigid.
local function objective(basis, mesh, i)
  local nodes, rows, first = mesh.nodes:totable(), {}, mesh.nodes:column(1)
  local size = first:max() - first:min()
  for k, node in ipairs(nodes) do
    local x, y, z = node[1] / size, node[2] / size, node[3] / size
    rows[k] = {math.sin(7 * x + i) * math.cos(5 * y - i), z * z - 0.3 * i * x * y, math.cos(4 * x * (1 + z) + i)}
  end
  return basis:gradient(bw.array.new(rows))
end

local function median(list)
  table.sort(list)
  return list[(#list + 1) // 2]
end

-- A row for each body: the median seconds of a program by each solver, and iterations.
local function measure(body, friction)
  local mesh = body.mesh()
  local system = assert(bw.model({mesh = mesh, material = bw.material.pla}):system())
  local basis = assert(bw.pressure_basis(mesh, {friction = friction,
    friction_facets = friction > 0 and FACETS or nil}))
  local limits = {force = FORCE, pressure = FORCE / (PRESSED * mesh.boundary.area)}
  local row = {body = body.name, columns = basis.count}
  local values = {}
  for k, solver in ipairs {"auto", solvers[1], solvers[2]} do
    local name = k == 1 and "auto" or solver.name
    local seconds, iterations = {}, 0
    if not (name == "glpk" and friction > 0 and basis.count > opts.max_columns) then
      for i = 1, opts.programs do
        limits.lp = solver
        local p, value, report = basis:maximise(system, objective(basis, mesh, i), limits)
        if not p then error(value, 0) end
        values[i] = values[i] or value
        if math.abs(value - values[i]) > 1e-7 * math.abs(values[i]) then
          error(("%s of %s: %.12g in place of %.12g"):format(name, body.name, value, values[i]), 0)
        end
        seconds[i], iterations = report.seconds, iterations + (report.iterations or 0)
        if k == 1 then
          row.chosen, row.predicted, row.rival = report.backend, report.predicted_cost, report.rival_cost
        end
      end
      row[name], row[name .. "_iterations"] = median(seconds), iterations / opts.programs
    end
  end
  return row
end

local function ms(seconds) return seconds and ("%.2f"):format(1e3 * seconds) or "-" end

local tables = {}
for _, friction in ipairs {0, opts.friction} do
  print(friction == 0 and "without friction" or ("with friction %g, %d facets"):format(friction, FACETS))
  print("| body | columns | dual_simplex, ms (iterations) | glpk, ms (iterations) | predicted, ms | chosen |")
  print "|---|---|---|---|---|---|"
  local rows = {}
  for i, body in ipairs(bodies) do
    local row = measure(body, friction)
    rows[i] = row
    local iterations = row.glpk_iterations and ("%.0f"):format(row.glpk_iterations) or "-"
    print(("| %s | %d | %s (%.0f) | %s (%s) | %s, %s | %s |"):format(row.body, row.columns,
      ms(row.dual_simplex), row.dual_simplex_iterations, ms(row.glpk), iterations,
      ms(row.predicted), ms(row.rival), row.chosen))
  end
  tables[#tables + 1] = {friction = friction, rows = rows}
end
if results then assert(results:write {benchmark = "linear_programs", tables = bw.json.list(tables)}) end
