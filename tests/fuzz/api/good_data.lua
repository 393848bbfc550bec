-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Good arguments (see good.lua) of files, scenarios, drawings, plots and studies.
local bw = require "barwright"
local good = require "good_lists"

local add, alike, path = good.add, good.alike, good.path

-- ---- files --------------------------------------------------------------------------------------

add {
  ["bw.json.encode"] = function(_, r) return r:one_of {{a = 1, b = {1, 2, {c = "x"}}}, {1, 2}, "text",
    bw.json.list {}, bw.json.null}, "  " end,
  ["bw.json.decode"] = function(_, r) return r:one_of {'{"a": [1, 2.5e3, null, true, "x\\u00e9"]}', "[]", "1",
    '"\\ud83d\\ude00"', "[1,"} end,
  ["bw.json.list"] = function() return {1, 2} end,
  ["bw.results.open"] = function() return "out.results", {script = "good.lua", inputs = {"good.stl"},
    options = {a = 1}, seed = 1} end,
  ["Results:path"] = function() return "x.vtu" end,
  ["Results:write"] = function() return {mass_kg = 1, list = {1, 2}} end,
  ["bw.threads"] = function(_, r) return r:integer(3) end,
}

-- ---- scenarios ----------------------------------------------------------------------------------

alike("Expectation:below Expectation:above", function() return 4 end)
add {
  ["Expectation:between"] = function() return 1, 9 end,
  ["Expectation:near"] = function(p, r) return r:one_of {5, {5}, p.Array}, {relative = 0.1} end,
  ["Expectation:equals"] = function(_, r) return r:one_of {5, "x", {1}} end,
  ["Expectation:fails_with"] = function(_, r) return r:one_of {"io", {raises = "x"}, {status = "io"}},
    "failed" end,
  ["Expectation:same_modes"] = function(p) return p.Modes, {relative = 1e-3, shapes = 0.1} end,
  ["Expectation:matches_baseline"] = function() return "name", {relative = 1e-3} end,
  ["Test:require"] = function() return 5, "a message" end,
  ["Test:skip"] = function() return "why" end,
  ["Test:note"] = function() return "text %d %s", 5, "x" end,
  ["Test:table"] = function() return {heads = {"a", "b"}, rows = {{1, 2}, {"x"}}, text = "t"} end,
  ["Test:picture_of"] = function(p) return p.Static, {caption = "c"} end,
  ["bw.scenario.about"] = function() return {title = "t", text = "x"} end,
  ["bw.scenario.expect"] = function() return 5, "force", "N" end,
  ["bw.scenario()"] = function() return "title", {tags = {"slow"}}, function() end end,
}

-- ---- drawings and plots -------------------------------------------------------------------------

local pen = {fill = "#aabbcc", stroke = "#11223344", width = 2, dash = {3, 2}, round = true}
local columns = {{name = "a", unit = "m", values = {1, 2, 3}}, {name = "b", values = {"x", "y", "x"}, of = {"x",
  "y"}}}
alike("Canvas:line Canvas:polygon", function(p, r) return r:one_of {{{0, 0}, {10, 10}, {20, 0}}, {0, 0, 5, 5, 9,
  0}, p.Outline.points}, pen end)
alike("bw.plot.scatter_matrix bw.plot.parallel_coordinates", function() return {columns = columns, values = {1,
  2, 3}, value = "v", chosen = {1}} end)
alike("bw.plot.lines bw.plot.scatter", function() return {series = {{name = "s", x = {1, 2, 3}, y = {1, 4, 9}}},
  x = {label = "x", unit = "m",
  scale = "log"}, y = "y", marks = {{x = 2, name = "m"}}, notes = {"n"}, legend = true, title = "t"} end)
add {
  ["bw.canvas"] = function() return 100, 80, {name = "c"} end,
  ["Canvas:rectangle"] = function() return 1, 2, 30, 20, pen, 3 end,
  ["Canvas:markers"] = function(_, r) return r:one_of {"disc", "square", "diamond", "triangle", "triangle_down",
    "cross", "plus"}, 5, {{1, 2}, {3, 4}}, pen,
    {"a", "b"} end,
  ["Canvas:text"] = function() return "text", 10, 10, {size = 12, align = 0.5, angle = 30, colour = "#000000",
    bold = true, halo = true} end,
  ["Canvas:text_width"] = function() return "text", 12, true end,
  ["Canvas:enter"] = function() return 1, 2, 30, 20, {0, 0, 10, 10} end,
  ["Canvas:image"] = function() return "good.png", 1, 2, 30, 20 end,
  ["Canvas:pixels"] = function() return ("abc"):rep(6), 3, 1, 2, 30, 20 end,
  ["Canvas:write"] = function(_, r) return path {"svg", "png"} (r), {scale = 1, outlines = r:chance(0.5)} end,
  ["Canvas:svg"] = function() return {outlines = true} end,
  ["bw.plot.bars"] = function() return {names = {"a", "b"}, series = {{name = "s", values = {1, -2},
    low = {0, -3}, high = {2, -1}}}, value = "v", horizontal = true} end,
  ["bw.plot.history"] = function() return {values = {3, 2, 4, 1}, goal = "min", failed = {false, true, false,
    false}, label = "l", scale = "log"} end,
  ["bw.plot.pareto"] = function() return {objectives = {{name = "a", values = {1, 2}}, {name = "b", values = {2,
    1}, goal = "max"}}, front = {1}} end,
  ["bw.plot.sensitivity"] = function(_, r) return r:one_of {{names = {"a", "b"}, first = {0.2, 0.5},
    total = {0.3, 0.6}},
    {names = {"a", "b"}, mu_star = {1, 2}, sigma = {0.1, 0.2}}, {names = {"a"}, low = {1}, high = {2},
      base = 1.5}} end,
  ["bw.plot.convergence"] = function() return {series = {{name = "s", x = {1, 0.5, 0.25}, y = {1, 0.25, 0.06},
    slope = 2, last = 2}}} end,
  ["bw.plot.contact_sheet"] = function(p) return {pictures = {{path = "good.png", caption = "a"},
    {figure = p.Figure, chosen = true}}, cell = 100} end,
  ["Figure:write"] = function(_, r) return path {"svg", "png"} (r), {text = "paths", scale = 1} end,
  ["Figure:svg"] = function() return {text = "text"} end,
  ["Figure:place"] = function() return 1, 2 end,
}

-- ---- studies ------------------------------------------------------------------------------------

add {
  ["bw.study()"] = function(_, r) return {name = "x", file = "out.study", variables = {{name = "a", min = 0,
    max = 1},
      {name = "n", kind = "integer", min = 1, max = 3}}, measures = {{name = "m", unit = "kg"}},
        objectives = {{name = "m"}},
    constraints = {{name = "m", max = 1}}, design = {r:one_of(bw.study.designs()), count = 4},
      run = function(p) return {m = p.a} end,
    what = "w", cache = {folder = "out.cache", bytes = 1e6}} end,
  ["bw.study.salvage"] = function() return "good.study", "out.saved" end,
  ["bw.study.hypervolume"] = function() return {{1, 2}, {2, 1}}, {3, 3} end,
  ["Study:run"] = function(_, r) return {workers = 1, seconds = 5, evaluations = r:integer(3)} end,
  ["Study:csv"] = function() return "out.csv" end,
  ["Study:merge"] = function() return {"good.study"}, {continue = true} end,
  ["Study:trial"] = function(_, r) return r:one_of {1, {height = 0.05, holes = 1, stiff = "a"}},
    {inside = r:chance(0.8), seconds = 5} end,
  ["Study:cached"] = function(p, r) return r:one_of {"what", {a = 1}}, function() return r:one_of {5, {1, 2},
    "x", p.Array, p.Mesh} end, {files = {"good.stl"}} end,
  ["Study:use_file"] = function() return "out.study" end,
  ["Trial:random"] = function() return 1, 5 end,
  ["Trial:normal"] = function() return 0, 1 end,
  ["Trial:cached"] = function() return "what", function() return 5 end end,
  ["Trials:column"] = function(_, r) return r:one_of {"mass", "height", "thickness"}, {all = true} end,
  ["Trials:where"] = function(_, r) return r:one_of {"done", "failed", function(t) return t.number > 1 end} end,
  ["Trials:best"] = function() return "mass" end,
  ["Trials:csv"] = function() return "out.csv" end,
  ["Trials:plot"] = function(_, r) return r:one_of {"history", "convergence", "pareto", "scatter",
    "scatter_matrix", "parallel_coordinates",
    "sensitivity", "contact_sheet"}, {title = "t"} end,
  ["Trials:report"] = function() return "out.html", {title = "t", rows = 3} end,
}
