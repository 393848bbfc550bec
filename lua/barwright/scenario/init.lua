-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Scenarios: scripts that state requirements, run by `barwright test`. A file is loaded to see what it
-- states; each scenario is a function that is called later, in a process of its own.
local core = require "barwright.core"
local files = require "barwright.scenario.files"
local options = require "barwright.options"

local raise = core.raise

local scenario = {}

local rules = {
  tags = {type = "any"}, -- see checked_tags
  skip = {type = "any"}, -- false, true or why
  about = {type = "string"},
  seconds = {type = "number", above = 0},
  memory = {type = "number", above = 0},
}

local function checked_tags(tags)
  local function fail(got)
    raise("scenario: option 'tags': a list of words of letters, digits, '_', '-' and '.', such as {\"slow\"}, "
      .. "expected, got " .. got)
  end
  if type(tags) ~= "table" then fail(core.got(tags)) end
  for key, tag in pairs(tags) do
    if math.type(key) ~= "integer" then fail("the key " .. core.got(key)) end
    if type(tag) ~= "string" or not tag:match "^[%w_.-]+$" then fail(core.got(tag)) end
  end
  return tags
end

--- Title and text of the file, for reports and manuals.
function scenario.about(given)
  local collection = files.loading or raise("scenario.about: only in a scenario file, which `barwright test` "
    .. "loads")
  local opts = options.read("scenario.about", given, {title = {type = "string", needed = true},
    text = {type = "string"}})
  collection.title, collection.text = opts.title, opts.text
end

local function state(title, given, work)
  local collection = files.loading or raise("scenario: only in a scenario file, outside of other scenarios; run "
    .. "it by `barwright test FILE`")
  if work == nil and type(given) == "function" then given, work = nil, given end
  if type(title) ~= "string" or not title:find "%S" then
    raise("scenario: a title expected, got " .. core.got(title))
  end
  if title:find "[%c]" then raise("scenario: a title of one line expected, got " .. core.got(title)) end
  if type(work) ~= "function" then
    raise(("scenario '%s': a function expected, got %s"):format(title, core.got(work)))
  end
  local opts = options.read("scenario", given, rules)
  if opts.skip ~= nil and type(opts.skip) ~= "boolean" and type(opts.skip) ~= "string" then
    raise(("scenario '%s': option 'skip': false, true or the reason expected, got %s"):format(title,
      core.got(opts.skip)))
  end
  local line = debug.getinfo(3, "l").currentline
  if collection.titles[title] then
    raise(("scenario '%s': there is one of that title in line %d"):format(title, collection.titles[title]))
  end
  collection.titles[title] = line
  collection.list[#collection.list + 1] = {title = title, line = line, work = work,
    tags = checked_tags(opts.tags or {}), skip = opts.skip or nil, about = opts.about, seconds = opts.seconds,
    bytes = opts.memory}
end

--- Inside a scenario: `expect(figure, "what", "unit"):below(5)` and its relatives.
function scenario.expect(...)
  return require "barwright.scenario.expect".of(...)
end

return setmetatable(scenario, {
  __call = function(_, title, given, work) state(title, given, work) end,
  __tostring = function() return "barwright.scenario" end,
  __index = function(_, name)
    raise(("bw.scenario has no '%s': %s"):format(tostring(name),
      core.suggestion(tostring(name), {"expect", "about"})))
  end,
})
