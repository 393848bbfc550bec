-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edit sessions of the paper agile from one command: a scene, or a model of one's own with a skeleton
-- that is extracted; its edits are replayed one by one, each solved, and then the limbs are scaled
-- until the part is strong enough.
local folder = arg[0]:match "^(.*)/[^/]*$" or "."
package.path = folder .. "/?.lua;" .. package.path
local bw = require "barwright"
local command_model = require "barwright.command.model"
local models = require "models"
local page = require "page"
local scenes = require "scenes"
local script = require "barwright.command.script"

local MET, NOT_MET = 0, 3

local function read_arguments()
  local names = table.move(scenes.names, 1, #scenes.names, 2, {"all"})
  local opts = script.read {
    summary = "edit sessions of the paper agile",
    about = "Replays the edits of a scene, or of a MODEL with an extracted skeleton, solves after each, and then "
      .. "scales the limbs until the part is strong enough. A MODEL stands on its lowest part and is pushed "
      .. "sideways at the end of a limb.\n\n"
      .. "DIR gets result.json, manifest.json, report.html, pictures, the edits as a script, and the shape as "
      .. "STL; with `--scene all`, a folder for each scene.\n\n"
      .. "Exit status: 0 the part ends below the limit (or --no-optimise); 2 the input was refused; 3 it does "
      .. "not; 130 interrupted. What ends early keeps what is done: result.json says \"finished\": false and why.",
    arguments = {{name = "model", type = "file", optional = true, what = "a surface: STL, OBJ, OFF or PLY"}},
    options = {script.option.needed_out,
      {name = "scene", value = "NAME", one_of = names, what = "instead of a MODEL"},
      {name = "elements", value = "N", type = "integer", min = 1,
        what = "number of elements (default: the scene's)"},
      {name = "order", value = "N", type = "integer", min = 1, max = 2, default = 2, what = "order of elements"},
      {name = "limit", value = "STRESS", type = "number", unit = "Pa", default = scenes.threshold, above = 0,
        what = "von Mises stress that the part must stay below"},
      {name = "no-optimise", type = "flag", what = "replay the edits alone"},
      script.option.threads,
      {name = "bones", value = "N", type = "integer", min = 1, what = "bones of the skeleton, of a MODEL"},
      {name = "force", value = "FORCE", type = "number", unit = "N", above = 0, what = "force, of a MODEL"},
      command_model.unit_option,
      {name = "material", value = "NAME", one_of = bw.material.names(),
        what = "of `barwright materials`, of a MODEL"},
    },
  }
  if (opts.model ~= nil) == (opts.scene ~= nil) then script.refuse "either --scene NAME or a MODEL expected" end
  return opts, opts.model
end

-- The shape as it is, not as it bends, coloured by stress; with `max` the colours end there.
local function picture(session, static, path, max)
  assert(session.mesh:picture(path, {values = static.von_mises, unit = "von Mises stress, MPa",
    scale = 1e-6, min = 0, max = max, direction = {1, -1.3, 0.7}, up = {0, 0, 1}, width = 900,
    height = 700, edges = false}))
end

-- Reused, as it goes into result.json.
local function reused_of(result)
  local reuse = result.reused
  return {words = tostring(reuse), subdomains = reuse.subdomains, subdomains_changed = reuse.subdomains_changed,
    solver = reuse.solver, preconditioner = reuse.preconditioner, factor_reused = reuse.factor_reused,
    iterations = reuse.iterations}
end

-- Solve the session as it is; a row for the list of edits.
local function solved(session, what)
  local start = bw.seconds()
  local result, message, details = session:solve()
  if not result then return nil, message, details end
  local von_mises = result.von_mises
  local row = {edit = what, seconds_solve = bw.seconds() - start, max_von_mises_pa = von_mises:max(),
    reused = reused_of(result)}
  return row, result
end

local function subdomain_counts(subdomains)
  local count = {R = 0, F = 0, elements_R = 0, elements_F = 0}
  for _, subdomain in ipairs(subdomains) do
    count[subdomain.type] = count[subdomain.type] + 1
    count["elements_" .. subdomain.type] = count["elements_" .. subdomain.type] + subdomain.elements
  end
  return {type_r = count.R, type_f = count.F, elements_r = count.elements_R,
    elements_f = count.elements_F}
end

local function warnings_into(list)
  for _, warning in ipairs(bw.warnings()) do list[#list + 1] = warning end
end

-- The edits, one by one; into `result` and the folder of `results`. Returns nil, message, details when
-- one cannot be solved.
local function replay(session, scene, result, results)
  warnings_into(result.remarks)
  result.subdomains = subdomain_counts(session.subdomains)
  print(("  %d bones, %d subdomains of type R with %d elements, %d of type F with %d"):format(
    result.bones, result.subdomains.type_r, result.subdomains.elements_r, result.subdomains.type_f,
    result.subdomains.elements_f))

  local function take(row, static)
    result.edits[#result.edits + 1] = row
    print(("  %-28s %8.2f MPa  %6.2f s  %s"):format(row.edit, row.max_von_mises_pa / 1e6,
      row.seconds_solve, row.reused.words))
    return static
  end
  local row, static, why = solved(session, "as given")
  if not row then return nil, static, why end
  take(row, static)
  picture(session, static, results:path "rest.png")
  for _, edit in ipairs(scene.edits) do
    local clock = bw.seconds()
    local ok, message = edit[2](session)
    local seconds = bw.seconds() - clock
    if bw.interrupted() then return nil, "interrupted", {status = "cancelled"} end
    if ok then
      row, static, why = solved(session, edit[1])
      if not row then return nil, static, why end
      row.seconds_edit = seconds
      take(row, static)
    else -- a refused edit leaves the session as it was
      result.edits[#result.edits + 1] = {edit = edit[1], refused = message, seconds_edit = seconds}
      print(("  %-28s refused: %s"):format(edit[1], message))
    end
  end
  warnings_into(result.remarks)
  local message, details
  static, message, details = session:solve()
  if not static then return nil, message, details end
  result.before_max_von_mises_pa, result.before_error = static.von_mises:max(), static:error_estimate()
  picture(session, static, results:path "before.png")
  assert(assert(session:surface()):write(results:path "before.stl"))
  return true
end

-- Scaled until it carries its loads, or as near to that as it gets.
local function strengthen(session, scene, result, results)
  local report, message, details = session:optimise {von_mises = result.limit_pa, move_supports = true,
    ties = scene.ties}
  local met = report ~= nil
  report = report or details and details.best
  if not report then return nil, message, details end
  result.optimisation = {met = met, message = not met and message or nil,
    max_von_mises_pa = report.von_mises, steps = report.iterations, unknowns = report.unknowns,
    constrained_nodes = report.constrained, mean_move_m = report.mean_move, factors = report.factors,
    seconds = report.seconds, solves = report.solves, factorisations = report.factorisations,
    adjoints = report.adjoints}
  print("  " .. tostring(report):gsub("\n", "\n  "))
  if not met then
    print("  " .. message)
    local changes = {} -- the best point is shown all the same
    for name, factors in pairs(report.factors) do changes[name] = {scale = factors} end
    if next(changes) then session:pose(changes) end
  end
  local static
  static, message, details = session:solve()
  if not static then return nil, message, details end
  result.after_max_von_mises_pa, result.after_error = static.von_mises:max(), static:error_estimate()
  picture(session, static, results:path "after.png", result.before_max_von_mises_pa)
  assert(assert(session:surface()):write(results:path "after.stl"))
  result.met = met
  return true
end

-- Everything about one scene; returns its result, or nil, message, details with what was done kept.
local function run(scene, opts, out)
  local start = bw.seconds()
  local results, message, details = script.results(out, opts, {script = "scripts/agile/run.lua",
    inputs = scene.inputs, seed = bw.json.null})
  if not results then return nil, message, details end
  local mesh = scene.mesh
  local result = {scene = scene.name, finished = false, elements = mesh.element_count,
    nodes = mesh.node_count, limit_pa = opts.limit,
    seconds_mesh = scene.seconds_mesh, bones = scene.skeleton.bone_count, edits = bw.json.list {},
    remarks = bw.json.list {}, paper = scene.paper and {elements = scene.paper.elements,
      bones = scene.paper.bones, max_von_mises_pa = scene.paper.von_mises}}
  print(("%s: %s"):format(scene.name, mesh))

  local session
  local function work()
    local done, why, how
    local clock = bw.seconds()
    session, why, how = bw.edit(scene.part, scene.session)
    if not session then return nil, why, how end
    result.seconds_session = bw.seconds() - clock
    done, why, how = replay(session, scene, result, results)
    if done and not opts.no_optimise then done, why, how = strengthen(session, scene, result, results) end
    return done, why, how
  end
  local ok, done
  ok, done, message, details = xpcall(work, debug.traceback)
  if not ok then message, details = done, {} end
  if bw.interrupted() then message, details = "interrupted", {status = "cancelled"} end
  result.finished = ok and done ~= nil and not bw.interrupted()
  if not result.finished then result.message, result.status = message, details.status end
  warnings_into(result.remarks)
  if session then assert(session:save(results:path "edits.lua")) end
  result.seconds_total = bw.seconds() - start
  result.peak_memory_bytes = bw.results.peak_memory()
  assert(results:write(result))
  if not result.finished then return nil, message, details end
  assert(page.write(results:path "report.html", scene, result, results))
  session:close()
  return result
end

local function main()
  local opts, model = read_arguments()
  local names = model and {model} or opts.scene == "all" and scenes.names or {opts.scene}
  local status = MET
  for _, name in ipairs(names) do
    local scene, message
    local start = bw.seconds()
    if model then
      scene, message = models.make(model, opts)
    else
      scene = scenes.make(name, {elements = opts.elements, order = opts.order})
    end
    if not scene then script.refuse(message) end
    scene.seconds_mesh = bw.seconds() - start
    local out = #names > 1 and opts.out .. "/" .. name or opts.out
    local result, details
    result, message, details = run(scene, opts, out)
    if not result then script.fail(NOT_MET, message, details) end
    if result.met == false then status = NOT_MET end
  end
  return status
end

script.run(main, NOT_MET)
