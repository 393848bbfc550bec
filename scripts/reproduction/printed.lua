-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What the papers print, and where ours is to be found. A table is {paper, place, title, note, rows}; a row
-- is {what, unit, printed, part, pick, want, timed}: `pick` takes ours out of the result.json of a part (nil:
-- it is not there), `want` says how the two are compared: "less" (seconds), "more" (frames per second),
-- "near" (the same is to come out), or nil (a count of another body or of another method); `timed`: the clock
-- decides it.
local printed = {}

printed.papers = {
  {key = "agile", cite = "Xie, Xu, Yang, Guo, Zhou 2015", about = "Scenes by formula of the paper's numbers of "
    .. "tetrahedra and bones stand for its models, which are not to be had."},
  {key = "responsive", cite = "Umetani, Takayama, Mitani, Igarashi", about = "The drag of the paper's figure 2; "
    .. "its computer had a processor of 2.5 GHz."},
  {key = "worst-case", cite = "Zhou, Panetta, Zorin 2013", about = "Bodies by formula of the paper's numbers of "
    .. "tetrahedra."},
  {key = "data-driven", cite = "Chen, Levin, Sueda, Matusik 2015", about = "Scenes of the paper's grids; its "
    .. "loads, layouts and figures are not to be had, so that errors are those of other bodies. Seconds are the "
    .. "processor's; the paper's are one thread's of 2.5 GHz."},
}

local tables = {}
local clock = {s = true, ms = true, minutes = true, ["frames/s"] = true} -- units of what the clock decides

local function new(paper, place, title, note)
  local made = {paper = paper, place = place, title = title, note = note, rows = {}}
  tables[#tables + 1] = made
  return function(row)
    row.timed = row.timed or clock[row.unit] or false
    made.rows[#made.rows + 1] = row
  end
end

-- ---- agile -----------------------------------------------------------------------------------------------

local agile = { -- tables 1, 2 (s, s, ms, ms, ms, s) and 3 (MPa, -, -, -, s)
  {"opener", 38729, {3.48, 0.35, 387, 103, 50, 1.11}, {89.95, 2, 3, 6, 20.78}},
  {"bird", 58911, {5.46, 0.49, 634, 199, 23, 2.93}, {164.86, 4, 4, 10, 77.89}},
  {"horse", 15869, {1.47, 0.08, 170, 121, 28.6, 0.41}, {91.40, 4, 3, 6, 9.55}},
  {"dinosaur", 31409, {3.15, 0.23, 338, 155, 31.8, 0.91}, {110.62, 3, 2, 6, 18.89}},
  {"earphone", 42944, {3.82, 0.41, 458, 119, 20.9, 1.38}, {87.83, 8, 7, 9, 52.90}},
}

local function scene_of(result)
  return result.scenes and result.scenes[1]
end

local function scaled(key, factor)
  return function(result)
    local scene = scene_of(result)
    return scene and type(scene[key]) == "number" and scene[key] * (factor or 1) or nil
  end
end

local function median(list)
  table.sort(list)
  local n = #list
  if n == 0 then return nil end
  return n % 2 == 1 and list[n // 2 + 1] or (list[n // 2] + list[n // 2 + 1]) / 2
end

local function edit_solve(result)
  local list = {}
  for i, edit in ipairs(scene_of(result).edits) do list[i] = edit.seconds_factor + edit.seconds_solve end
  return median(list)
end

local add = new("agile", "Table 2", "What an edit costs", "Ours: the median of edits that scale or turn one "
  .. "bone; quadratic tetrahedra as in the paper. The begin of a session is all that is done before the first "
  .. "edit, the first solution with it.")
for _, line in ipairs(agile) do
  local name, elements, t = table.unpack(line)
  local part = "agile_" .. name
  add {what = name .. ": tetrahedra", printed = elements, part = part, pick = scaled "elements"}
  add {what = name .. ": sparse structure and polynomials (ours: begin of a session)", unit = "s",
    printed = t[1] + t[2], part = part, pick = scaled "seconds_begin", want = "less"}
  add {what = name .. ": stiffness from coordinates", unit = "ms", printed = t[3], part = part,
    pick = scaled("seconds_direct", 1e3), want = "less"}
  add {what = name .. ": stiffness by subdomains, all", unit = "ms", printed = t[4], part = part,
    pick = scaled("seconds_all", 1e3), want = "less"}
  add {what = name .. ": stiffness by subdomains, after an edit", unit = "ms", printed = t[5], part = part,
    pick = scaled("seconds_local", 1e3), want = "less"}
  add {what = name .. ": solution after an edit", unit = "s", printed = t[6], part = part, pick = edit_solve,
    want = "less"}
end

add = new("agile", "Table 3", "Scaling optimisation to 55 MPa", "Stresses before are those of our scenes. The "
  .. "paper's subdomains that are optimised are beside our unknowns (two a subdomain, ties taken together).")
for _, line in ipairs(agile) do
  local name, part, t = line[1], "agile_" .. line[1], line[4]
  add {what = name .. ": largest stress before", unit = "MPa", printed = t[1], part = part,
    pick = scaled("max_von_mises_pa", 1e-6)}
  add {what = name .. ": largest stress after", unit = "MPa", printed = 55, part = part,
    pick = scaled("optimise_max_von_mises_pa", 1e-6), want = "near"}
  add {what = name .. ": subdomains optimised (ours: unknowns)", printed = t[2], part = part,
    pick = scaled "optimise_unknowns"}
  add {what = name .. ": constrained nodes", printed = t[3], part = part, pick = scaled "optimise_constrained"}
  add {what = name .. ": iterations", printed = t[4], part = part, pick = scaled "optimise_steps"}
  add {what = name .. ": time", unit = "s", printed = t[5], part = part, pick = scaled "seconds_optimise",
    want = "less"}
end

-- ---- responsive ------------------------------------------------------------------------------------------

local function run_of(result, rebuilt)
  for _, run in ipairs(result.runs) do
    if run.rebuilt == rebuilt then return run end
  end
end

add = new("responsive", "Table 2", "How often each level of reuse ran in 159 frames", "Ours: of the cantilever. "
  .. "What is not counted needed nothing but moving nodes.")
for _, level in ipairs {{"relocation", 117}, {"reconnecting", 39}, {"reconstruction", 3}} do
  add {what = level[1], unit = "frames", printed = level[2], part = "responsive_cantilever",
    pick = function(result)
    local run = run_of(result, false)
    return run and (run.levels[level[1]] and run.levels[level[1]].count or 0)
  end}
end

add = new("responsive", "Table 3", "Frames per second", "The mean over the drag, by the clock.")
for _, line in ipairs {{"vibration", 1962, 105.0, 41.8}, {"cantilever", 990, 37.6, 7.1}, {"flow", 1971, 30.0,
  18.2},
  {"thermal", 1938, 21.3, 14.3}} do
  local name, part = line[1], "responsive_" .. line[1]
  local words = {flow = "fluid", thermal = "thermal fluid"}
  local spoken = words[name] or name
  add {what = spoken .. ": triangles", printed = line[2], part = part,
    pick = function(result) return run_of(result, false).elements end}
  add {what = spoken .. ": with reuse", unit = "frames/s", printed = line[3], part = part, want = "more",
    pick = function(result) return run_of(result, false).mean_per_second end}
  add {what = spoken .. ": without", unit = "frames/s", printed = line[4], part = part, want = "more",
    pick = function(result) return run_of(result, true).mean_per_second end}
end

add = new("responsive", "Table 4", "A metallophone", "The paper's simulated frequencies beside those that our "
  .. "bars are tuned to; its measured and adjusted ones are of bars of metal, which we have not made.")
local bars = {{"C5", 523, 525, 506, 523}, {"D5", 587, 588, 604, 587}, {"E5", 659, 661, 621, 659},
  {"F5", 698, 699, 698, 698}, {"G5", 783, 786, 787, 783}, {"A5", 880, 880, 860, 881}, {"B5", 987, 989, 993, 987}}
for _, bar in ipairs(bars) do
  local function of(key)
    return function(result)
      for _, one in ipairs(result.bars) do
        if one.note == bar[1] then return one[key] end
      end
    end
  end
  add {what = bar[1] .. ": target", unit = "Hz", printed = bar[2], part = "metallophone", pick = of "target_hz",
    want = "near"}
  add {what = bar[1] .. ": simulated", unit = "Hz", printed = bar[3], part = "metallophone",
    pick = of "simulated_hz",
    want = "near"}
  add {what = bar[1] .. ": measured", unit = "Hz", printed = bar[4]}
  add {what = bar[1] .. ": adjusted", unit = "Hz", printed = bar[5]}
end

-- ---- worst-case ------------------------------------------------------------------------------------------

add = new("worst-case", "section 5", "The whole analysis", "Ours: from the mesh on, with 15 modes and 5 regions "
  .. "of each, of a foal by formula.")
for _, line in ipairs {{2723, 0.028}, {42900, 0.308}, {70356, 0.382}, {155383, 2.566}, {322398, 9.601},
  {414894, 4.490}} do
  add {what = ("%d tetrahedra"):format(line[1]), unit = "minutes", printed = line[2], part = "worst_case_pipeline",
    want = "less", pick = function(result)
      for _, row in ipairs(result.rows) do
        if row.wanted == line[1] then return row.seconds_total / 60, ("%d tetrahedra"):format(row.elements) end
      end
    end}
end

add = new("worst-case", "Table 1", "Brute force and weak regions", "Five of the paper's eight sizes have a body "
  .. "of ours.")
for _, line in ipairs {{2723, 681.367, 1.089}, {2869, 793.362, 1.087}, {2904, 894.610, 0.641},
  {5332, 2120.361, 1.171}, {11020, 11029.721, 2.729}, {12853, 11334.362, 1.694}, {14163, 27775.900, 3.373},
  {16008, 19917.838, 1.892}} do
  local function of(pick)
    return function(result)
      for _, row in ipairs(result.rows) do
        if row.elements_paper == line[1] then
          return pick(row), ("%s, %d tetrahedra"):format(row.model, row.elements)
        end
      end
    end
  end
  local size = ("%d tetrahedra: "):format(line[1])
  add {what = size .. "brute force", unit = "s", printed = line[2], part = "worst_case_brute_force", want = "less",
    pick = of(function(row) return row.seconds_brute_force end)}
  add {what = size .. "weak regions", unit = "s", printed = line[3], part = "worst_case_brute_force",
    want = "less",
    pick = of(function(row) return row.seconds_weak_regions end)}
  add {what = size .. "times faster", printed = line[2] / line[3], part = "worst_case_brute_force", timed = true,
    pick = of(function(row) return row.seconds_brute_force / row.seconds_weak_regions end)}
end

-- ---- data-driven -----------------------------------------------------------------------------------------

local function level_of(result, level)
  local method = level == 0 and "fine" or "lookup"
  for _, row in ipairs(result.rows) do
    if row.level == level and row.method == method and not row.failed then return row end
  end
end

local function of_level(level, pick)
  return function(result)
    local row = level_of(result, level)
    if row then return pick(row), ("%d elements"):format(row.elements) end
  end
end

local examples = { -- relative speed, seconds an iteration, iterations, error, by level from 0
  {"pushing", {1.0, 1.010, 5}, {11.5, 0.087, 5, 8.91e-4}, {31.4, 0.032, 5, 1.36e-2}},
  {"bending", {1.0, 0.270, 28}, {12.6, 0.028, 22, 5.60e-2}, {22.7, 0.015, 22, 8.88e-2}},
  {"twisting", {1.0, 0.300, 16}, {15.2, 0.031, 10, 1.56e-2}, {20.7, 0.019, 12, 3.28e-2}},
  {"buckling", {1.0, 8.85, 32}, {50.1, 0.28, 20, 7.24e-3}, {331.8, 0.12, 7, 3.14e-2}},
  {"fibers", {1.0, 193.85, 17}, {51.2, 4.95, 13, 2.94e-2}, {489.5, 0.96, 7, 4.26e-2}},
  {"bridge", {1.0, 43.44, 14}, {8.4, 4.88, 15, 4.39e-3}},
  {"bridge_arch", {1.0, 54.99, 3}, {8.1, 7.84, 3, 3.68e-4}},
  {"george", {1.0, 52.19, 23}, {16.4, 3.49, 21, 2.86e-2}},
  {"george_bone", {1.0, 41.35, 12}, {13.2, 2.70, 14, 2.99e-2}},
}

add = new("data-driven", "Table 1", "Coarsening by lookup", "Relative speed is that over one's own fine grid: "
  .. "ours is many times faster than the paper's, so that less is left to gain. Errors are mean distances of "
  .. "nodes over the longest side.")
for _, example in ipairs(examples) do
  local name = example[1]
  local part = "data_driven_" .. name
  for level = 0, #example - 2 do
    local line = example[level + 2]
    local where = ("%s (%d): "):format(name:gsub("_", " "), level)
    add {what = where .. "an iteration", unit = "s", printed = line[2], part = part, want = "less",
      pick = of_level(level, function(row) return row.seconds_per_iteration end)}
    add {what = where .. "iterations", printed = line[3], part = part,
      pick = of_level(level, function(row) return row.iterations end)}
    if level > 0 then
      add {what = where .. "relative speed", printed = line[1], part = part, timed = true,
        pick = of_level(level, function(row) return row.speed_up end)}
      add {what = where .. "error", printed = line[4], part = part, want = "less",
        pick = of_level(level, function(row) return row.error end)}
    end
  end
end

add = new("data-driven", "Table 2", "Seconds of an iteration spent on quadrature")
for _, line in ipairs {{"bending", 0, 0.11}, {"bending", 1, 0.015}, {"bending", 2, 0.014}, {"buckling", 0, 1.0},
  {"buckling", 1, 0.11}, {"buckling", 2, 0.10}, {"fibers", 0, 10.0}, {"fibers", 1, 1.0}, {"fibers", 2, 0.68}} do
  add {what = ("%s (%d)"):format(line[1], line[2]), unit = "s", printed = line[3],
    part = "data_driven_" .. line[1],
    want = "less", pick = of_level(line[2],
      function(row) return row.quadrature_fraction * row.seconds_per_iteration end)}
end

printed.tables = tables
return printed
