-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What `scripts/reproduce` runs at which scale. A part is {name, words (of the program; OUT stands for the
-- part's folder, LIBRARY for the library of materials), result (where in OUT it is), seconds (limit),
-- smaller (what is smaller than in the paper, a sentence), after (a part that must be done before)}.
local parts = {scales = {"quick", "full", "tiny"}}

local hour = 3600

local function agile(list, scale)
  for _, scene in ipairs(scale == "tiny" and {"horse"} or {"opener", "bird", "horse", "dinosaur", "earphone"}) do
    local words = {"scripts/bench/agile.lua", "--scenes", scene, "--out", "OUT"}
    local smaller
    if scale == "quick" then
      table.move({"--bones", "3"}, 1, 2, #words + 1, words)
      smaller = "three bones of each scene are edited, not all"
    elseif scale == "tiny" then
      table.move({"--bones", "1", "--elements", "3000"}, 1, 4, #words + 1, words)
      smaller = "one scene, of 3,000 tetrahedra, one bone of it"
    end
    list[#list + 1] = {name = "agile_" .. scene, words = words, smaller = smaller, seconds = hour}
  end
end

local function responsive(list, scale)
  local tiny = scale == "tiny"
  for _, name in ipairs(tiny and {"cantilever"} or {"vibration", "cantilever", "flow", "thermal"}) do
    list[#list + 1] = {name = "responsive_" .. name, seconds = hour, words = {"scripts/bench/responsive.lua",
      "--only",
      name, "--paper", "--frames", tiny and "12" or "159", "--out", "OUT"},
      smaller = tiny and "one application, 12 frames" or nil}
  end
  list[#list + 1] = {name = "metallophone", seconds = hour, words = {"scripts/metallophone/run.lua", "--notes",
    tiny and "C5" or "C5,D5,E5,F5,G5,A5,B5", "--elements", tiny and "150" or "300", "--out", "OUT"},
    smaller = tiny and "one bar, of 150 triangles" or nil}
end

local function worst_case(list, scale)
  if scale ~= "tiny" then
    local words = {"scripts/bench/worst_case.lua", "--out", "OUT"}
    local smaller
    if scale == "quick" then
      table.move({"--sizes", "2723,42900,70356"}, 1, 2, #words + 1, words)
      smaller = "the whole analysis up to 70,356 tetrahedra"
    end
    list[#list + 1] = {name = "worst_case_pipeline", words = words, smaller = smaller, seconds = 2 * hour}
  end
  local words = {"scripts/bench/brute_force.lua", "--out", "OUT"}
  local smaller
  if scale == "quick" then
    table.move({"--bodies", "3"}, 1, 2, #words + 1, words)
    smaller = "brute force on the three smallest bodies"
  elseif scale == "tiny" then
    table.move({"--bodies", "1", "--elements", "0.3"}, 1, 4, #words + 1, words)
    smaller = "brute force on one body with three tenths of its tetrahedra"
  end
  list[#list + 1] = {name = "worst_case_brute_force", words = words, smaller = smaller, seconds = 4 * hour}
end

local function data_driven(list, scale)
  if scale == "tiny" then
    list[#list + 1] = {name = "data_driven_pushing", result = "pushing/result.json", seconds = hour,
      words = {"scripts/data_driven/run.lua", "--scene", "pushing", "--methods", "naive", "--no-transient",
        "--out", "OUT"}, smaller = "one scene, and no lookup"}
    return
  end
  local quick = scale == "quick"
  list[#list + 1] = {name = "data_driven_library", seconds = 12 * hour, words = {
    "scripts/data_driven/build.lua", "--levels", quick and "1" or "2", "--directions", quick and "20" or "500",
    "--magnitudes", quick and "3" or "5", "--out", "OUT"}, smaller = quick
    and "a library of one level, each block loaded along 20 directions by 3 magnitudes (the default: 500 by 5)"
    or nil}
  local scenes = quick and {"pushing", "bending", "twisting", "buckling", "george_bone"}
    or {"pushing", "bending", "twisting", "buckling", "fibers", "bridge", "bridge_arch", "george", "george_bone"}
  for i, scene in ipairs(scenes) do
    list[#list + 1] = {name = "data_driven_" .. scene, after = "data_driven_library", result = scene
      .. "/result.json", seconds = 6 * hour, words = {"scripts/data_driven/run.lua", "--scene", scene, "--methods",
      "lookup", "--no-transient", "--library", "LIBRARY", "--out", "OUT"}, smaller = quick and i == 1
      and "five of nine scenes" or nil}
  end
end

--- The parts of a scale, in the order in which they run. `shrunk`: bodies themselves are smaller than the
--- printed ones, so that nothing can be said of the two side by side.
function parts.of(scale)
  local list = {}
  worst_case(list, scale)
  responsive(list, scale)
  agile(list, scale)
  data_driven(list, scale)
  if scale == "tiny" then
    for _, part in ipairs(list) do part.shrunk = true end
  end
  return list
end

return parts
