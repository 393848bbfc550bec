-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Results as one HTML file: what failed first, with its pictures, then every scenario with its figures.
local html = require "barwright.html"
local numbers = require "barwright.scenario.numbers"
local tap = require "barwright.scenario.tap"

local page = {}
local escape = html.escape

local STYLE <const> = [[
details { margin: .3rem 0 } summary { cursor: pointer } .passed { color: var(--good) }
.skipped { color: var(--calm) } .failed, .error, .time, .memory, .crashed { color: var(--bad) }
.status { display: inline-block; min-width: 5.2rem; font-weight: 600 } td:first-child { white-space: nowrap }
]]

local function figures(result, out)
  local rows = {}
  for _, entry in ipairs(result.entries) do
    if entry.kind == "expectation" then
      local figure = numbers.show(entry.figure)
      rows[#rows + 1] = {{entry.good and "met" or "not met", class = entry.good and "passed" or "failed"},
        entry.quantity or entry.form, figure == "nil" and "" or figure .. (entry.unit and " " .. entry.unit or ""),
        entry.reference ~= nil and numbers.show(entry.reference) or "", entry.allowed or "",
        {entry.source or entry.how or "", class = "soft"}}
    end
  end
  if #rows == 0 then return end
  out[#out + 1] = html.table({"result", "quantity", "figure", "reference", "allowed", "source"}, rows)
end

local function faults(result, out)
  local list = {}
  for _, entry in ipairs(result.entries) do
    if entry.kind == "expectation" and not entry.good then
      list[#list + 1] = ("<li>%s <small>%s</small></li>"):format(escape(entry.message),
        escape(tap.place(result, entry.line)))
    end
  end
  if result.message and result.status ~= "skipped" then
    local placed = tap.placed(result, result.message) == result.message
    list[#list + 1] = ("<li>%s <small>%s</small></li>"):format(escape(result.message),
      placed and "" or escape(tap.place(result)))
  end
  if #list > 0 then out[#out + 1] = "<ul>" .. table.concat(list) .. "</ul>" end
  if result.trace then out[#out + 1] = "<pre>" .. escape(result.trace) .. "</pre>" end
end

local function one(result, folder, open)
  local out = {("<details%s><summary><span class=\"status %s\">%s</span> %s <small>%s%s</small></summary>"):format(
    open and " open" or "", result.status, result.status, escape(result.title),
    escape(tap.place(result, result.line)), result.seconds_run and (", %.3g s"):format(result.seconds_run) or "")}
  if result.about then out[#out + 1] = html.prose(result.about) end
  if result.status == "skipped" and result.message then
    out[#out + 1] = ("<p class=\"skipped\">%s</p>"):format(escape(result.message))
  end
  faults(result, out)
  for _, entry in ipairs(result.entries) do
    if entry.kind == "picture" and folder then
      out[#out + 1] = html.figure(folder .. "/" .. entry.file, entry.caption)
    end
    if entry.kind == "note" then out[#out + 1] = html.prose(entry.text) end
  end
  figures(result, out)
  for _, entry in ipairs(result.entries) do
    if entry.kind == "table" then
      if entry.text then out[#out + 1] = html.prose(entry.text) end
      out[#out + 1] = html.table(entry.heads, entry.rows)
    end
  end
  if result.output then
    out[#out + 1] = ("<details><summary>what it printed</summary><pre>%s</pre></details>"):format(
      escape(result.output))
  end
  out[#out + 1] = "</details>"
  return table.concat(out, "\n")
end

local function is_bad(result)
  return result.status ~= "passed" and result.status ~= "skipped"
end

--- The page of a run: {scenarios, files = {{file, title, text}}, passed, failed, skipped}; `folder` has
--- the pictures.
function page.document(run, manifest, folder)
  local out = {('<p><span class="passed">%d passed</span>, <span class="%s">%d failed</span>, '
      .. "%d skipped. <small>barwright %s%s</small></p>"):format(run.passed, run.failed > 0 and "failed" or "soft",
      run.failed, run.skipped, escape(manifest.version),
      type(manifest.commit) == "string" and " (" .. escape(manifest.commit) .. ")" or "")}
  if run.failed > 0 then
    out[#out + 1] = "<h2>What failed</h2>"
    for _, result in ipairs(run.scenarios) do
      if is_bad(result) then out[#out + 1] = one(result, folder, true) end
    end
  end
  for _, file in ipairs(run.files) do
    out[#out + 1] = ("<h2>%s</h2>"):format(escape(file.title or file.file))
    if file.title then out[#out + 1] = ("<small>%s</small>"):format(escape(file.file)) end
    if file.text then out[#out + 1] = html.prose(file.text) end
    for _, result in ipairs(run.scenarios) do
      if result.file == file.file and not is_bad(result) then out[#out + 1] = one(result, folder, false) end
    end
  end
  return html.document {title = "Scenarios", body = table.concat(out, "\n"), width = 76, style = STYLE}
end

return page
