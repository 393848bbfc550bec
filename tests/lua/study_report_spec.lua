-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Plots and reports of a study's trials.
local bw = require "barwright"
local check = require "check"
local make = require "study_trials"
local plots = require "barwright.study.plots"
local report = require "barwright.study.report"
local says = require "barwright.study.plot_data"

local min_mass = {{name = "mass", goal = "min"}}
local two_goals = {{name = "mass", goal = "min"}, {name = "stiffness", goal = "max"}}

local function count_of(text, part)
  return select(2, text:gsub(part, ""))
end

-- The best by hand.
local function best_of(trials)
  local best
  for _, trial in ipairs(trials) do
    local r = trial.results
    if r and r.stress <= 55e6 and (not best or r.mass < best.results.mass) then best = trial end
  end
  return best
end

describe("trials:plot", function()
  it("knows names, units and goals", function()
    local trials = make(min_mass, 60)
    local best = best_of(trials)
    assert.same({best.number}, says.chosen(trials))
    local svg = assert(plots.plot(trials, "history"):svg())
    assert.truthy(svg:find("mass, g", 1, true))
    assert.truthy(svg:find("no result (4)", 1, true))
    assert.truthy(svg:find(("trial %d: thickness "):format(best.number), 1, true))
    svg = assert(plots.plot(trials, "history", {measure = "stiffness", goal = "max", scale = "log"}):svg())
    assert.truthy(svg:find("stiffness, ", 1, true))
    for _, kind in ipairs {"scatter_matrix", "parallel_coordinates"} do
      svg = assert(plots.plot(trials, kind, {colour = "stress"}):svg())
      assert.truthy(svg:find("zp150", 1, true))
      assert.truthy(svg:find("stress, MPa", 1, true))
    end
    svg = assert(plots.plot(trials, "scatter", {x = "thickness", y = "stress", colour = "mass"}):svg())
    assert.truthy(svg:find("thickness, mm", 1, true))
  end)

  it("finds the front of several goals", function()
    local trials = make(two_goals, 80)
    local front = says.chosen(trials)
    assert.truthy(#front > 2)
    for _, i in ipairs(front) do
      local a = trials[i].results
      for _, other in ipairs(trials) do
        local b = says.keeps(trials.problem, other) and other.results
        assert.falsy(b and b.mass < a.mass and b.stiffness > a.stiffness)
      end
    end
    local svg = assert(plots.plot(trials, "pareto"):svg())
    assert.truthy(svg:find(("front (%d)"):format(#front), 1, true))
    assert.truthy(svg:find("better →", 1, true))
  end)

  it("shows what a design says of the measures", function()
    local trials = make(min_mass, 10)
    trials.summary = {indices = {mass = {{name = "thickness", first = 0.7, total = 0.8,
      first_interval = {0.6, 0.8}, total_interval = {0.7, 0.9}}, {name = "holes", first = 0.2, total = 0.2}}}}
    assert.truthy(plots.plot(trials, "sensitivity"):svg():find("fraction of the variance of mass", 1, true))
    trials.summary = {effects = {stress = {{name = "thickness", mu_star = 1e7, sigma = 2e6,
      mu_star_interval = {8e6, 1.2e7}}, {name = "holes", count = 0}}}}
    local plane = plots.plot(trials, "sensitivity", {measure = "stress"})
    assert.truthy(plane:svg():find("σ: their scatter, MPa", 1, true))
    trials.summary = {base = {thickness = 2e-3, holes = 2}, ranges = {mass = {
      {name = "thickness", values = {1e-3, 2e-3, 3e-3}, results = {0.02, 0.03, 0.04}},
      {name = "holes", values = {0, 2, 4}, results = {0.04, 0.03, 0.02}}, {name = "material", values = {},
        results = {}}}}}
    assert.truthy(plots.plot(trials, "sensitivity"):svg():find("at its minimum", 1, true))
    trials.summary = {}
    check.raises("sobol_indices, morris or one_at_a_time", plots.plot, trials, "sensitivity")
  end)

  it("shows how a search came closer", function()
    local y = {5, 3, 4, 1, 2}
    local function trials_of(goals)
      local trials = make(goals, 5)
      for i = 1, 5 do
        trials[i].results = {mass = y[i], stiffness = i, stress = i == 2 and 9e9 or 1}
      end
      return trials
    end
    -- 5, then 1 (3 misses the constraint): a gap of 4, and none
    local svg = plots.plot(trials_of(min_mass), "convergence"):svg()
    assert.truthy(svg:find("mass: best so far, from the best, kg", 1, true))
    assert.truthy(svg:find("best: 1 kg", 1, true))
    -- costs (5, -1), (4, -3), (1, -4), (2, -5) below the worst (5, -1): 0, 2, 12, 15
    local figure = plots.plot(trials_of(two_goals), "convergence")
    svg = figure:svg()
    for i, volume in pairs {[1] = 0, [3] = 2 / 15, [4] = 12 / 15, [5] = 1} do
      local px, py = figure:place(i, volume)
      local found = false
      for x, v in svg:gmatch '<circle cx="([%d.]+)" cy="([%d.]+)"' do
        found = found or math.abs(tonumber(x) - px) < 0.02 and math.abs(tonumber(v) - py) < 0.02
      end
      assert.truthy(found, ("trial %d"):format(i))
    end
    check.raises("one to three objectives", plots.plot, make({}, 3), "convergence")
    local holes = trials_of(two_goals)
    for i = 1, 5 do holes[i].results[i % 2 == 0 and "mass" or "stiffness"] = nil end
    assert(plots.plot(holes, "convergence"):svg())
    assert(plots.plot(holes, "pareto"):svg())
  end)

  it("names what it does not know", function()
    local trials = make(min_mass, 3)
    check.raises("no kind 'pareto_front': one of contact_sheet, ", plots.plot, trials, "pareto_front")
    check.raises("'thicknes' is no variable and no measure: did you mean 'thickness'", plots.plot, trials,
      "scatter", {x = "thicknes", y = "mass"})
    check.raises("unknown option 'color': did you mean 'colour'", plots.plot, trials, "scatter_matrix",
      {color = "mass"})
    check.raises("two or more objectives", plots.plot, trials, "pareto")
    check.raises("'thickness' is a variable", plots.plot, trials, "history", {measure = "thickness"})
  end)

  it("draws no trials, one, and those that all failed", function()
    for _, count in ipairs {0, 1, 2} do
      for _, goals in ipairs {min_mass, two_goals, {}} do
        local trials = make(goals, count)
        if count == 2 then
          for _, trial in ipairs(trials) do trial.status, trial.results = "failed", nil end
        end
        for _, kind in ipairs {"history", "scatter_matrix", "parallel_coordinates", "contact_sheet"} do
          assert(plots.plot(trials, kind):svg())
        end
        if #goals > 0 then assert(plots.plot(trials, "convergence"):svg()) end
        if #goals == 2 then assert(plots.plot(trials, "pareto"):svg()) end
      end
    end
  end)
end)

describe("trials:report", function()
  local folder = check.folder()

  it("holds everything, and asks nobody for anything", function()
    local trials = make(min_mass, 100, folder)
    local best = best_of(trials)
    for _, i in ipairs {1, 2, best.number} do
      os.execute(("mkdir -p '%s/%d'"):format(folder, i))
      assert(bw.plot.lines {series = {{y = {1, i}}}}:write(("%s/%d/picture.png"):format(folder, i), {scale = 1}))
    end
    assert(report.write(trials, folder .. "/study.html", {text = "a <text>"}))
    local html = check.read(folder .. "/study.html")
    assert.is_nil(html:find("{{", 1, true))
    assert.is_nil(html:gsub('xmlns="http://www.w3.org/2000/svg"', ""):find("https?://"))
    assert.is_nil(html:find("<eye>", 1, true))
    assert.truthy(html:find("Study hook &amp; &lt;eye&gt;", 1, true))
    assert.truthy(html:find("a &lt;text&gt;", 1, true))
    assert.truthy(html:find(("Best: trial %d: "):format(best.number), 1, true))
    assert.truthy(html:find("failed: the &lt;surface&gt; crosses itself &amp; has holes</td>", 1, true))
    assert.truthy(html:find("17, 34, 51, 68, 85", 1, true))
    assert.truthy(html:find("latin_hypercube, count 100", 1, true))
    assert.truthy(html:find("at most 55 MPa", 1, true))
    assert.equal(3, count_of(html, "<image "))
    assert.equal(4, count_of(html, "<figcaption>")) -- history, matrix, coordinates, pictures
    assert.equal(100, count_of(html, "<tr class=\"[%l]*\">"))
    assert.equal(0, count_of(html, "could not be drawn"))
    -- the same trials, the same page
    assert(report.write(trials, folder .. "/again.html", {text = "a <text>"}))
    assert.equal(html, check.read(folder .. "/again.html"))
  end)

  it("can be made of any trials", function()
    for _, count in ipairs {0, 1, 17} do
      for _, goals in ipairs {min_mass, two_goals, {}} do
        local trials = make(goals, count)
        assert(report.write(trials, folder .. "/some.html"))
        local html = check.read(folder .. "/some.html")
        assert.equal(0, count_of(html, "could not be drawn"))
        assert.equal(count == 0, html:find("There are no trials yet", 1, true) ~= nil)
      end
    end
    check.fails("io", "nowhere", report.write(make({}, 1), "/nowhere/some.html"))
    check.raises("did you mean 'pictures'", report.write, make({}, 1), folder .. "/x.html", {pictres = 1})
  end)
end)
