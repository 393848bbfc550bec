---@meta _
-- SPDX-License-Identifier: MIT
-- Copyright (c) 2026 the barwright authors
--
-- Scenarios
--
-- Requirements as scripts, run by `barwright test`.

---Stating scenarios in a file that `barwright test` runs.
---@class bw.ScenarioModule
---@overload fun(title: string, options: bw.ScenarioOptions|fun(t: bw.Test), work?: fun(t: bw.Test))
local scenario_module = {}

---States a scenario: a requirement that `barwright test` checks. Only in a scenario file.
---@param title string
---@param options bw.ScenarioOptions|fun(t: bw.Test) may be left out: then `work` comes second
---@param work? fun(t: bw.Test)
function scenario_module:__call(title, options, work) end

---@class bw.ScenarioOptions
---@field tags? string[]
---@field skip? boolean|string
---@field about? string
---@field seconds? number
---@field memory? number

---Title and text of the file, for reports and manuals.
---@param about bw.ScenarioAbout
function scenario_module.about(about) end

---@class bw.ScenarioAbout
---@field title string
---@field text string

---A figure to be judged, with what it is and its unit; or whatever a call returned: where that is nil
---and a message, the expectation fails with the message.
---@param figure any
---@param what? string
---@param unit? string
---@return bw.Expectation
function scenario_module.expect(figure, what, unit) end

---What must hold of a figure. A failed expectation is kept and the scenario goes on; `t:require` of what
---it returns stops there. Every form takes {source = "...", how = "..."} for reports.
---@class bw.Expectation
local Expectation = {}

---At most the bound.
---@param bound number
---@param options? bw.ExpectationOptions
---@return boolean good
---@return string? message
function Expectation:below(bound, options) end

---@class bw.ExpectationOptions
---@field source? string
---@field how? string

---At least the bound.
---@param bound number
---@param options? bw.ExpectationOptions
---@return boolean good
---@return string? message
function Expectation:above(bound, options) end

---From low to high.
---@param low number
---@param high number
---@param options? bw.ExpectationOptions
---@return boolean good
---@return string? message
function Expectation:between(low, high, options) end

---Within `absolute` of the reference, or `relative` of its size, whichever is more; of arrays and lists
---every value, relative to the largest.
---@param reference number|bw.Array|table
---@param options bw.ExpectationNearOptions
---@return boolean good
---@return string? message
function Expectation:near(reference, options) end

---@class bw.ExpectationNearOptions
---@field relative number
---@field absolute number
---@field source string
---@field how string

---Exactly this: numbers to the last bit, texts, truth values, tables of these.
---@param other any
---@param options? bw.ExpectationOptions
---@return boolean good
---@return string? message
function Expectation:equals(other, options) end

---Neither nil nor false.
---@param options? bw.ExpectationOptions
---@return boolean good
---@return string? message
function Expectation:is_true(options) end

---Of a function, or of what a call returned: it must fail, with a status word and a text in its message;
---{raises = "text"}: by raising an error.
---@param status? string|bw.ExpectedFailure
---@param message? string
---@param options? bw.ExpectationOptions
---@return boolean good
---@return string? message
function Expectation:fails_with(status, message, options) end

---@class bw.ExpectedFailure
---@field status string
---@field message string
---@field raises string
---@field source string
---@field how string

---The same modes as others, whatever their signs and whatever the order and the mix of those whose
---frequencies are nearer than `degenerate` (1e-4): frequencies within `relative` (1e-6), of each such group
---the space that it spans within `shapes` (1e-3, the sine of an angle; false: not compared); `last = false`
---leaves the shapes of the last group out, which may be cut.
---@param other bw.Modes
---@param options? bw.ExpectationSameModesOptions
---@return boolean good
---@return string? message
function Expectation:same_modes(other, options) end

---@class bw.ExpectationSameModesOptions
---@field relative? number
---@field degenerate? number
---@field shapes? number|false
---@field last? boolean
---@field source? string
---@field how? string

---What was measured before, kept in baselines/FILE/NAME.json beside the scenario file and written by
---`barwright test --update`: numbers, texts, arrays, tables of these, a static result, modes.
---@param name string
---@param options? bw.ExpectationMatchesBaselineOptions
---@return boolean good
---@return string? message
function Expectation:matches_baseline(name, options) end

---@class bw.ExpectationMatchesBaselineOptions
---@field relative? number
---@field absolute? number
---@field degenerate? number
---@field shapes? number
---@field last? boolean
---@field source? string
---@field how? string

---What a scenario's function is given.
---@class bw.Test
---@field folder string a scratch folder, removed at the end
local Test = {}

---The values, where the first is there; else the scenario ends here as failed, with the message. Also
---takes what an expectation returns.
---@param value any
---@param message? string
---@return any ...
function Test:require(value, message) end

---Ends the scenario without judging it: what it needs is not there.
---@param reason string
function Test:skip(reason) end

---A sentence for reports and manuals, with values as string.format has them.
---@param text string
---@param ... any
function Test:note(text, ...) end

---A plain table for reports and manuals.
---@param table bw.ReportTable
function Test:table(table) end

---@class bw.ReportTable
---@field heads string[]
---@field rows any[][]
---@field text string

---Drawn into the output folder when the scenario fails: an object with a picture (of modes the one that
---{mode = n} names), a figure of bw.plot, or a function of a path.
---@param object any
---@param options? table those of the picture; caption
function Test:picture_of(object, options) end
