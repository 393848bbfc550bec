-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Results as JUnit XML, as continuous integration reads it: a suite for each file, a case for each
-- scenario; expectations that were not met are failures, all else that went wrong is an error.
local tap = require "barwright.scenario.tap"
local text = require "barwright.text"

local junit = {}

local escape = text.xml

local function seconds(x)
  return ("%.3f"):format(x or 0)
end

local function detail(result)
  local lines = {}
  for _, entry in ipairs(result.entries) do
    if entry.kind == "expectation" and not entry.good then
      lines[#lines + 1] = tap.placed(result, entry.message, entry.line)
    end
  end
  if result.message then lines[#lines + 1] = tap.placed(result, result.message) end
  if result.trace then lines[#lines + 1] = result.trace end
  return lines
end

local function case(result, out)
  out[#out + 1] = ('    <testcase classname="%s" name="%s" file="%s" line="%d" time="%s">'):format(
    escape((result.file:gsub("%.lua$", ""):gsub("/", "."))), escape(result.title), escape(result.file),
    result.line or 1, seconds(result.seconds_run))
  if result.status == "skipped" then
    out[#out + 1] = ('      <skipped message="%s"/>'):format(escape(result.message or ""))
  elseif result.status ~= "passed" then
    local lines = detail(result)
    local tag = result.status == "failed" and "failure" or "error"
    out[#out + 1] = ('      <%s type="%s" message="%s">%s</%s>'):format(tag, result.status,
      escape(lines[1] or ""), escape(table.concat(lines, "\n")), tag)
  end
  if result.output then
    out[#out + 1] = ("      <system-out>%s</system-out>"):format(escape(result.output))
  end
  out[#out + 1] = "    </testcase>"
end

-- How many of what, and how long.
local function counts(results)
  local c = {tests = #results, failures = 0, errors = 0, skipped = 0, time = 0}
  for _, result in ipairs(results) do
    if result.status == "failed" then c.failures = c.failures + 1
    elseif result.status == "skipped" then c.skipped = c.skipped + 1
    elseif result.status ~= "passed" then c.errors = c.errors + 1 end
    c.time = c.time + (result.seconds_run or 0)
  end
  return ('tests="%d" failures="%d" errors="%d" skipped="%d" time="%s"'):format(c.tests, c.failures, c.errors,
    c.skipped, seconds(c.time))
end

--- The document.
function junit.document(results)
  local suites, order = {}, {}
  for _, result in ipairs(results) do
    if not suites[result.file] then
      suites[result.file] = {}
      order[#order + 1] = result.file
    end
    table.insert(suites[result.file], result)
  end
  local out = {'<?xml version="1.0" encoding="UTF-8"?>',
    ('<testsuites name="barwright" %s>'):format(counts(results))}
  for _, file in ipairs(order) do
    out[#out + 1] = ('  <testsuite name="%s" %s>'):format(escape(file), counts(suites[file]))
    for _, result in ipairs(suites[file]) do case(result, out) end
    out[#out + 1] = "  </testsuite>"
  end
  out[#out + 1] = "</testsuites>\n"
  return table.concat(out, "\n")
end

return junit
