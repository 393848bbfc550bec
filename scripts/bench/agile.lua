-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Edit sessions beside tables 2 and 3 of the paper agile, on scenes of its sizes (scripts/agile). In
-- one run and on one machine: what an edit of one bone costs, and what the same shape costs from
-- scratch: the stiffness from all elements, CHOLMOD's numeric factorisation and one solve, in the same
-- order and in the one that METIS gives for a single solution. The paper's seconds are those of its own
-- machine (4 cores, MKL).
local root = arg[0]:match "^(.*)/bench/[^/]*$" or "scripts"
package.path = root .. "/bench/?.lua;" .. root .. "/agile/?.lua;" .. package.path
local bw = require "barwright"
local scenes = require "scenes"
local script = require "barwright.command.script"
-- Of the tests' build, beside the engine that runs.
local core = assert(package.searchpath("barwright.core", package.cpath))
package.cpath = core:gsub("lua/barwright/core%.so$", "tests/?.so") .. ";" .. package.cpath
local cholmod = require "cholmod"

-- Table 2: all entries directly, by subdomains all, by subdomains local (ms), solve (s). Table 3: s.
local paper = {
  opener = {direct = 387, all = 103, update = 50, solve = 1.11, optimise = 20.78},
  bird = {direct = 634, all = 199, update = 23, solve = 2.93, optimise = 77.89},
  horse = {direct = 170, all = 121, update = 28.6, solve = 0.41, optimise = 9.55},
  dinosaur = {direct = 338, all = 155, update = 31.8, solve = 0.91, optimise = 18.89},
  earphone = {direct = 458, all = 119, update = 20.9, solve = 1.38, optimise = 52.90},
}

local opts = script.read {
  summary = "edits of one bone beside the same shape from scratch, on scenes of the sizes of the paper agile",
  options = {
    script.option.out,
    {name = "scenes", value = "NAME,...", list = true, one_of = scenes.names, default = scenes.names,
      what = "which scenes"},
    {name = "bones", value = "N", type = "integer", min = 1, what = "edits of so many bones alone (default: all)"},
    {name = "elements", value = "N", type = "integer", min = 1, what = "elements (default: the paper's)"},
    {name = "no-optimise", type = "flag", what = "leave out the scaling optimisation of table 3"},
  },
}

local results = opts.out and assert(bw.results.open(opts.out, {script = "scripts/bench/agile.lua",
  options = {scenes = opts.scenes, bones = opts.bones, optimise = not opts.no_optimise}}))

local function median(list)
  table.sort(list)
  return #list == 0 and 0 / 0
    or #list % 2 == 1 and list[#list // 2 + 1] or (list[#list // 2] + list[#list // 2 + 1]) / 2
end

-- One edit up to the von Mises stress at every node.
local function timed(session, edit)
  local start = bw.seconds()
  local ok, message = edit(session)
  if not ok then return nil, message end
  local result = assert(session:solve())
  local max = result.von_mises:max()
  local reused = result.reused
  return {seconds = bw.seconds() - start, seconds_stiffness = reused.seconds_stiffness,
    seconds_factor = reused.seconds_factor, seconds_solve = reused.seconds_solve,
    factor_reused = reused.factor_reused,
    solver = reused.solver, preconditioner = reused.preconditioner, iterations = reused.iterations,
    precision = reused.precision,
    refinements = reused.refinements, max = max,
    relaxed = reused.mesh ~= "posed"}
end

local function back(session)
  assert(session:undo())
  assert(session:solve())
end

local rows = bw.json.list {}
local columns = "%-9s %6d %7d | %5.1f %5.1f %5.1f %5.1f | %6.2f %6.2f %6.2f | %6.2f %5.1f %5.1f | %5.0f %5.0f"
print [[
            tets   nodes | stiffness, ms             | CHOLMOD, s: in order |  an edit, s: ratio | memory, MB
                         | direct  all  local (paper) | ours  METIS  (paper) | median ours METIS | factor updates]]
local ratios, own_ratios = {}, {}
for _, name in ipairs(opts.scenes) do
  local scene = scenes.make(name, {elements = opts.elements})
  local session = assert(bw.edit(scene.part, scene.session))
  local row = {scene = name, elements = scene.mesh.element_count, nodes = scene.mesh.node_count,
    subdomains = session.subdomains.count}
  local start = bw.seconds()
  local first = assert(session:solve())
  first.von_mises:max()
  row.seconds_begin, row.max_von_mises_pa = bw.seconds() - start, first.von_mises:max()
  row.elements_blended = 0
  for _, subdomain in ipairs(session.subdomains) do
    if subdomain.type == "F" then row.elements_blended = row.elements_blended + subdomain.elements end
  end
  local bones = {}
  for _, bone in ipairs(scene.skeleton.bone_names) do
    if #bones < (opts.bones or math.huge) and session:bone(bone).subdomain then bones[#bones + 1] = bone end
  end

  -- All subdomains by their polynomials, what the paper calls DD assemble, first number: the body turned
  -- as a whole, so that none is gathered from coordinates.
  local all = {}
  for _, bone in ipairs(scene.skeleton.bone_names) do
    if not scene.skeleton:bone(bone).parent then
      all[bone] = {rotation = {axis = {0.3, 0.5, 0.8}, degrees = 1}}
    end
  end
  local everything
  for _ = 1, 4 do -- the shortest of four, as of stiffness directly
    local once = timed(session, function(s) return s:pose(all) end)
    local better = once and (not everything or once.seconds_stiffness < everything.seconds_stiffness)
    if better then everything = once end
    if once then back(session) end
  end

  -- from scratch (CHOLMOD alone), twice: before the edits and after them
  local function scratch()
    local system = assert(session:synchronise())
    local once, own = cholmod.baseline(system), cholmod.baseline(system, true)
    return {stiffness = math.min(once.stiffness, own.stiffness), factor = once.factor, solve = once.solve,
      total = once.factor + once.solve, own_factor = own.factor, own_solve = own.solve,
      own_total = own.factor + own.solve, flops = once.flops, own_flops = own.flops}
  end
  local base = scratch()

  -- one bone at a time
  local edits = bw.json.list {}
  for _, bone in ipairs(bones) do
    local kinds = {
      {"scaled", function(s) return s:bone(bone):scale {1, 1.03, 1.03} end},
      {"turned", function(s) return s:bone(bone):rotate {axis = {0.3, 0.5, 0.8}, degrees = 1} end},
    }
    for _, kind in ipairs(kinds) do
      local row_of, message = timed(session, kind[2])
      if row_of then
        row_of.bone, row_of.edit = bone, kind[1]
        edits[#edits + 1] = row_of
        back(session)
      else
        print(("  %s, %s %s: %s"):format(name, bone, kind[1], message))
      end
    end
  end
  local again = scratch()
  for key, value in pairs(again) do base[key] = math.min(base[key], value) end

  local seconds, stiffness = {}, {}
  for _, edit in ipairs(edits) do
    seconds[#seconds + 1], stiffness[#stiffness + 1] = edit.seconds, edit.seconds_stiffness
    ratios[#ratios + 1] = base.total / edit.seconds
    own_ratios[#own_ratios + 1] = base.own_total / edit.seconds
  end
  local system = assert(session:synchronise())
  local factor, updates, coefficients = system:memory()
  row.seconds_direct, row.seconds_all = base.stiffness, everything and everything.seconds_stiffness
  row.seconds_local, row.seconds_edit = median(stiffness), median(seconds)
  row.seconds_cholmod_factor, row.seconds_cholmod_solve = base.factor, base.solve
  row.ratio_of_seconds = base.total / row.seconds_edit
  row.ratio_of_seconds_metis_order = base.own_total / row.seconds_edit
  row.seconds_cholmod_metis_order_factor = base.own_factor
  row.seconds_cholmod_metis_order_solve = base.own_solve
  row.flops, row.flops_metis_order = base.flops, base.own_flops
  row.bytes_factor, row.bytes_updates, row.bytes_coefficients = factor, updates, coefficients
  row.edits = edits
  local p = paper[name]
  print(columns:format(name, row.elements, row.nodes, 1e3 * row.seconds_direct,
    1e3 * (row.seconds_all or 0 / 0), 1e3 * row.seconds_local, p.update, base.factor + base.solve,
    base.own_total, p.solve, row.seconds_edit, row.ratio_of_seconds, row.ratio_of_seconds_metis_order,
    factor / 1e6, updates / 1e6))
  print(("          %.0f %% of the elements blended (paper %.0f %%)"):format(
    100 * row.elements_blended / row.elements, 100 * scene.paper.blended / scene.paper.elements))
  if not opts.no_optimise then
    start = bw.seconds()
    local processor = os.clock()
    local report, message, details = session:optimise {von_mises = scenes.threshold, move_supports = true,
      ties = scene.ties}
    row.seconds_optimise, row.optimise_met = bw.seconds() - start, report ~= nil
    row.seconds_optimise_processor = os.clock() - processor
    report = report or details and details.best
    row.optimise_steps = report and report.iterations
    row.optimise_unknowns = report and report.unknowns
    row.optimise_constrained = report and report.constrained
    row.optimise_factorisations = report and report.factorisations
    row.optimise_max_von_mises_pa = report and report.von_mises
    print(("          optimised in %.2f s (paper %.2f s, %.1f times), %.2f to %.2f MPa%s"):format(
      row.seconds_optimise, p.optimise, p.optimise / row.seconds_optimise, row.max_von_mises_pa / 1e6,
      (report and report.von_mises or 0 / 0) / 1e6, row.optimise_met and "" or ": " .. message))
    print(("          %d steps, %.2f factorisations, %.1f s of processor time"):format(
      row.optimise_steps or 0, row.optimise_factorisations or 0, row.seconds_optimise_processor))
  end
  row.paper = p
  rows[#rows + 1] = row
  session:close()
  collectgarbage()
end
print(("median over all edits: %.1f times faster than CHOLMOD from scratch in the same order, "
  .. "%.1f times than in METIS's; peak memory %.2f GB"):format(median(ratios), median(own_ratios),
  (bw.results.peak_memory() or 0) / 1e9))
if results then
  assert(results:write {threads = bw.threads(), scenes = bw.json.list(rows),
    median_ratio_of_seconds = median(ratios), median_ratio_of_seconds_metis_order = median(own_ratios),
    peak_memory_bytes = bw.results.peak_memory()})
end
