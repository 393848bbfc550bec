-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Results as one HTML file: what failed first, with its pictures, then every scenario with its figures.
local core = require "barwright.core"
local files = require "barwright.scenario.files"
local numbers = require "barwright.scenario.numbers"
local tap = require "barwright.scenario.tap"
local text = require "barwright.scenario.text"

local page = {}
local escape = text.html

local STYLE = [[
:root { color-scheme: light dark; --ink: #1c2430; --soft: #596579; --line: #dde2ea; --paper: #fff;
  --good: #176b3a; --bad: #a3341c; --calm: #7a5b00 }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e9f1; --soft: #9aa7bb; --line: #333c4a; --paper: #151a21;
  --good: #67c08b; --bad: #f08a6e; --calm: #d8b95a } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 76rem;
  margin: 2rem auto; padding: 0 1rem }
h1 { margin-bottom: .2rem } h2 { margin: 2.4rem 0 .4rem } details { margin: .3rem 0 }
summary { cursor: pointer } .passed { color: var(--good) } .skipped { color: var(--calm) }
.failed, .error, .time, .memory, .crashed { color: var(--bad) } small, .soft { color: var(--soft) }
.status { display: inline-block; min-width: 5.2rem; font-weight: 600 }
.scroll { overflow-x: auto } table { border-collapse: collapse; margin: .5rem 0 1rem; width: 100% }
td:first-child { white-space: nowrap }
th, td { text-align: left; padding: .2rem .7rem .2rem 0; border-bottom: 1px solid var(--line); vertical-align: top;
  font-variant-numeric: tabular-nums } pre { overflow-x: auto; font-size: .85rem; border: 1px solid var(--line);
  padding: .5rem; border-radius: 6px; white-space: pre-wrap } figure { margin: 1rem 0 }
img { max-width: 100%; border: 1px solid var(--line); border-radius: 6px; background: #fff }
]]

local kinds = {png = "image/png", svg = "image/svg+xml"}

local function picture(entry, folder)
  local bytes = folder and files.read(folder .. "/" .. entry.file)
  if not bytes then return "" end
  return ('<figure><img alt="%s" src="data:%s;base64,%s"><figcaption class="soft">%s</figcaption></figure>')
    :format(escape(entry.caption), kinds[entry.file:match "%.(%l+)$"] or "image/png", core.base64(bytes),
    escape(entry.caption))
end

local function cells(tag, list)
  local out = {}
  for i, cell in ipairs(list) do out[i] = ("<%s>%s</%s>"):format(tag, escape(tostring(cell)), tag) end
  return "<tr>" .. table.concat(out) .. "</tr>"
end

local function figures(result, out)
  local rows = {}
  for _, entry in ipairs(result.entries) do
    if entry.kind == "expectation" then
      local figure = numbers.show(entry.figure)
      rows[#rows + 1] = ('<tr><td class="%s">%s</td><td>%s</td><td>%s</td><td>%s</td><td>%s</td>'
        .. '<td class="soft">%s</td></tr>'):format(entry.good and "passed" or "failed",
        entry.good and "met" or "not met",
        escape(entry.quantity or entry.form), escape(figure == "nil" and "" or figure .. (entry.unit and " "
        .. entry.unit or "")), escape(entry.reference ~= nil and numbers.show(entry.reference) or ""),
        escape(entry.allowed or ""), escape(entry.source or entry.how or ""))
    end
  end
  if #rows == 0 then return end
  out[#out + 1] = '<div class="scroll"><table>' .. cells("th", {"", "quantity", "figure", "reference", "allowed",
    "source"}) .. table.concat(rows) .. "</table></div>"
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
  if result.about then out[#out + 1] = ("<p>%s</p>"):format(escape(result.about)) end
  if result.status == "skipped" and result.message then
    out[#out + 1] = ("<p class=\"skipped\">%s</p>"):format(escape(result.message))
  end
  faults(result, out)
  for _, entry in ipairs(result.entries) do
    if entry.kind == "picture" then out[#out + 1] = picture(entry, folder) end
    if entry.kind == "note" then out[#out + 1] = ("<p>%s</p>"):format(escape(entry.text)) end
  end
  figures(result, out)
  for _, entry in ipairs(result.entries) do
    if entry.kind == "table" then
      if entry.text then out[#out + 1] = ("<p>%s</p>"):format(escape(entry.text)) end
      out[#out + 1] = '<div class="scroll"><table>' .. cells("th", entry.heads)
      for _, row in ipairs(entry.rows) do out[#out + 1] = cells("td", row) end
      out[#out + 1] = "</table></div>"
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
  local out = {'<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" '
    .. 'content="width=device-width"><title>Scenarios</title><style>', STYLE, "</style></head><body>",
    "<h1>Scenarios</h1>", ('<p><span class="passed">%d passed</span>, <span class="%s">%d failed</span>, '
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
    if file.text then out[#out + 1] = ("<p>%s</p>"):format(escape(file.text)) end
    for _, result in ipairs(run.scenarios) do
      if result.file == file.file and not is_bad(result) then out[#out + 1] = one(result, folder, false) end
    end
  end
  out[#out + 1] = "</body></html>\n"
  return table.concat(out, "\n")
end

return page
