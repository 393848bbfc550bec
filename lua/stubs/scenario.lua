---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Scenarios
--
-- Requirements as scripts, run by `barwright test FILE` (docs/howto_scenarios.md). A file is loaded to see what it states; each
-- scenario is called later, in a process of its own.

---Stating scenarios; only in a file that `barwright test` loads, elsewhere it raises.
---@class bw.ScenarioModule
---@overload fun(title: string, options: bw.ScenarioOptions|fun(t: bw.Test), work?: fun(t: bw.Test))
local scenario_module = {}

---States a scenario: a requirement. A title that is used twice raises.
---```lua
---bw.scenario("a ball has its volume", {tags = {"geometry"}, seconds = 60}, function()
---  local ball = bw.surface.sphere {radius = 0.01, subdivisions = 5}
---  local exact = 4 / 3 * math.pi * 0.01 ^ 3
---  bw.scenario.expect(ball.volume, "volume", "m3"):near(exact, {relative = 0.01, source = "4/3 pi r^3"})
---end)
---```
---@param title string one line
---@param options bw.ScenarioOptions|fun(t: bw.Test) how it runs; may be left out, then `work` is the second argument
---@param work? fun(t: bw.Test) what is done and expected
function scenario_module:__call(title, options, work) end

---How a scenario runs.
---@class bw.ScenarioOptions
---@field tags? string[] words of letters, digits, _ - and . to choose scenarios by. Default: none
---@field skip? boolean|string do not run it; the reason. Default: false
---@field about? string sentences for reports and manuals. Default: none
---@field seconds? number (s) the longest time it may take, above 0. Default: that of `barwright test`
---@field memory? number (bytes) the most memory it may take, above 0. Default: that of `barwright test`

---Sets title and text of the file, for reports and manuals.
---```lua
---bw.scenario.about {title = "Surfaces by formula", text = "Volumes and areas against closed forms."}
---bw.scenario("a box has its area", function()
---  bw.scenario.expect(bw.surface.box({max = {1, 1, 1}}).area, "area", "m2"):near(6, {relative = 1e-12})
---end)
---```
---@param about bw.ScenarioAbout title and text
function scenario_module.about(about) end

---Title and text of a file.
---@class bw.ScenarioAbout
---@field title string one line
---@field text? string sentences. Default: none

---A figure that is to be judged, inside of a scenario. It may be all that a call returned: where that is nil and a message, the
---expectation fails with the message.
---```lua
---bw.scenario("a missing file is refused", function()
---  bw.scenario.expect(bw.surface.read "missing.stl"):fails_with "io"
---end)
---```
---@param figure any a number, an array, a list, modes, a function, or what a call returned
---@param what? string what the figure is
---@param unit? string its unit
---@return bw.Expectation expectation to say what must hold
function scenario_module.expect(figure, what, unit) end

---What must hold of a figure. A failed expectation is recorded, and the scenario goes on; `t:require` of what it returns ends it.
---```lua
---bw.scenario("a cantilever bends", function(t)
---  local mesh = bw.mesh.box {max = {0.1, 0.01, 0.01}, cells = {20, 2, 2}, order = 2}
---  local part = bw.model({mesh = mesh, material = bw.material.steel}):fix(mesh.boundary:below("x", 0))
---  local static = t:require(part:load({on = mesh.boundary:above("x", 0.1), force = {0, 0, -10}}):solve())
---  bw.scenario.expect(-1e6 * static.displacement:column(3):min(), "deflection", "um"):between(18, 20)
---end)
---```
---@class bw.Expectation
local Expectation = {}

---What reports print beside an expectation.
---@class bw.ExpectationOptions
---@field source? string where the expected value comes from. Default: none
---@field how? string how it was found. Default: none

---The figure is at most a bound.
---@param bound number (any) the bound
---@param options? bw.ExpectationOptions source
---@return boolean good whether it holds
---@return string? message
function Expectation:below(bound, options) end

---The figure is at least a bound.
---@param bound number (any) the bound
---@param options? bw.ExpectationOptions source
---@return boolean good whether it holds
---@return string? message
function Expectation:above(bound, options) end

---The figure is between two bounds, or one of them.
---@param min number (any) the lower bound
---@param max number (any) the upper bound
---@param options? bw.ExpectationOptions source
---@return boolean good whether it holds
---@return string? message
function Expectation:between(min, max, options) end

---The figure differs from a reference by at most `absolute`, or `relative` times the size of the reference, whichever is more. Of
---arrays and lists every value, relative to the largest one of the reference. Without a tolerance it raises.
---@param reference number|bw.Array|number[]|number[][] (any, n × c) the reference
---@param options bw.ExpectationNearOptions the tolerance
---@return boolean good whether it holds
---@return string? message
function Expectation:near(reference, options) end

---The tolerance of a comparison; at least one of the two.
---@class bw.ExpectationNearOptions: bw.ExpectationOptions
---@field relative? number (-) difference over the reference, 0 or more. Default: none
---@field absolute? number (any) difference, 0 or more. Default: none

---The figure is exactly this: numbers to the last bit, texts, truth values, tables of these.
---@param other any the value
---@param options? bw.ExpectationOptions source
---@return boolean good whether it holds
---@return string? message
function Expectation:equals(other, options) end

---The figure is neither nil nor false.
---@param options? bw.ExpectationOptions source
---@return boolean good whether it holds
---@return string? message
function Expectation:is_true(options) end

---A function, or what a call returned, fails: with a status and a text in its message, or by raising an error.
---@param status? bw.Status|bw.ExpectedFailure the status, or all that is expected. Default: any
---@param message? string a text in the message. Default: any
---@param options? bw.ExpectationOptions source
---@return boolean good whether it holds
---@return string? message
function Expectation:fails_with(status, message, options) end

---How a call must fail.
---@class bw.ExpectedFailure: bw.ExpectationOptions
---@field status? bw.Status of the details. Default: any
---@field message? string a text in the message. Default: any
---@field raises? string a text in the error that is raised. Default: nothing is raised

---The figure, modes, are the same as others, whatever their signs, and whatever the order and the mix of those whose frequencies are
---nearly equal. Other figures raise.
---@param other bw.Modes the others
---@param options? bw.ExpectationSameModesOptions the tolerances
---@return boolean good whether it holds
---@return string? message
function Expectation:same_modes(other, options) end

---The tolerances of modes.
---@class bw.ExpectationSameModesOptions: bw.ExpectationOptions
---@field relative? number (-) difference of frequencies, 0 or more. Default: 1e-6
---@field degenerate? number (-) frequencies that are nearer to each other than this belong to one group, 0 or more. Default: 1e-4
---@field shapes? number|false (-) sine of the angle between the spaces that a group's shapes span; false: not compared. Default: 1e-3
---@field last? boolean compare the shapes of the last group, which may be cut. Default: true

---The figure is what was measured before, which is kept in baselines/FILE/NAME.json beside the scenario file and written by
---`barwright test --update`: a number, a text, an array, a table of these, a static solution, or modes.
---@param name string of letters, digits, _ - . and spaces; once in a scenario
---@param options? bw.ExpectationMatchesBaselineOptions the tolerances
---@return boolean good whether it holds
---@return string? message
function Expectation:matches_baseline(name, options) end

---The tolerances beside a baseline.
---@class bw.ExpectationMatchesBaselineOptions: bw.ExpectationNearOptions
---@field degenerate? number (-) of modes, as of `bw.ExpectationSameModesOptions`. Default: 1e-4
---@field shapes? number (-) of modes, as of `bw.ExpectationSameModesOptions`. Default: 1e-3
---@field last? boolean of modes, as of `bw.ExpectationSameModesOptions`. Default: true

---What a scenario's function is given.
---```lua
---bw.scenario("a surface comes back from its file", function(t)
---  local path = t.folder .. "/box.stl"
---  t:require(bw.surface.box({max = {1, 1, 1}}):write(path))
---  local surface = t:require(bw.surface.read(path))
---  bw.scenario.expect(surface.volume, "volume", "m3"):near(1, {relative = 1e-6})
---end)
---```
---@class bw.Test
---@field folder string a scratch folder, removed at the end
local Test = {}

---Goes on with values only: where the first is nil or false the scenario ends here as failed, with the message. It also takes what
---an expectation returns.
---@param value any what must be there
---@param message? string the message where it is not
---@return any value the first value; the others follow
function Test:require(value, message) end

---Ends the scenario without a verdict: what it needs is not there.
---@param reason string why
function Test:skip(reason) end

---Adds a sentence for reports and manuals.
---@param text string with places as of string.format
---@param ... any the values
function Test:note(text, ...) end

---Adds a table for reports and manuals.
---@param table bw.ReportTable heads and rows
function Test:table(table) end

---A table of a report.
---@class bw.ReportTable
---@field heads string[] of the columns
---@field rows any[][] lists of cells
---@field text? string a sentence below. Default: none

---Draws an object into the output folder where the scenario fails.
---@param object any with a method `picture`, a figure of `bw.plot`, or a function of a path
---@param options? table<string, any> those of the picture; of modes `mode`, the number; `caption`
function Test:picture_of(object, options) end
