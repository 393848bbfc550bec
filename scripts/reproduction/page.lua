-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- One HTML page: every table of the papers with ours beside what is printed, what was smaller, where and by
-- what it was computed.
local numbers = require "barwright.scenario.numbers"
local text = require "barwright.scenario.text"

local page = {}
local escape = text.html

local STYLE = [[
:root { color-scheme: light dark; --ink: #1c2430; --soft: #596579; --line: #dde2ea; --paper: #fff;
  --good: #176b3a; --bad: #a3341c; --stripe: #f5f7fa }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e9f1; --soft: #9aa7bb; --line: #333c4a; --paper: #151a21;
  --good: #67c08b; --bad: #f08a6e; --stripe: #1b222c } }
body { font: 16px/1.55 system-ui, sans-serif; color: var(--ink); background: var(--paper); max-width: 68rem;
  margin: 2rem auto; padding: 0 1rem }
h1 { margin-bottom: .3rem } h2 { margin: 2.6rem 0 .3rem } h3 { margin: 1.8rem 0 .3rem }
p { max-width: 48rem } small, .soft { color: var(--soft) } .good { color: var(--good) } .bad { color: var(--bad) }
.scroll { overflow-x: auto } table { border-collapse: collapse; width: 100%; margin: .6rem 0 }
th, td { padding: .22rem .8rem .22rem 0; border-bottom: 1px solid var(--line); text-align: right;
  font-variant-numeric: tabular-nums }
th:first-child, td:first-child, td:last-child, th:last-child { text-align: left }
tr:nth-child(even) td { background: var(--stripe) } code { font-size: .85em }
]]

local function cells(tag, list)
  local out = {}
  for i, cell in ipairs(list) do
    local class = type(cell) == "table" and cell.class
    out[i] = ("<%s%s>%s</%s>"):format(tag, class and (' class="%s"'):format(class) or "",
      escape(type(cell) == "table" and cell.text or cell), tag)
  end
  return "<tr>" .. table.concat(out) .. "</tr>"
end

local function figure(value, unit)
  return numbers.show(value, 4) .. (unit and " " .. unit or "")
end

-- How ours stands beside what is printed.
local function beside(row)
  local ours = row.ours or row.ours_timed
  if not ours or not row.want then return "" end
  if row.want == "near" then return ("%+.2g %%"):format(100 * (ours / row.printed - 1)) end
  local ratio = row.want == "less" and row.printed / ours or ours / row.printed
  local words = row.unit == nil and "smaller" or row.want == "less" and "less" or "more"
  if ratio >= 1 then return {text = ("%s times %s"):format(numbers.show(ratio, 3), words), class = "good"} end
  local other = {smaller = "larger", less = "more", more = "less"}
  return {text = ("%s times %s"):format(numbers.show(1 / ratio, 3), other[words]), class = "bad"}
end

local function add_table(about, out)
  out[#out + 1] = ("<h3>%s. %s</h3>"):format(escape(about.place), escape(about.title))
  if about.note then out[#out + 1] = ("<p>%s</p>"):format(escape(about.note)) end
  out[#out + 1] = '<div class="scroll"><table>' .. cells("th", {"", "printed", "ours", "beside it", ""})
  for _, row in ipairs(about.rows) do
    local ours = row.ours or row.ours_timed
    out[#out + 1] = cells("td", {row.what, figure(row.printed, row.unit),
      ours and figure(ours, row.unit) or "", beside(row),
      {text = row.note or row.why or "", class = "soft"}})
  end
  out[#out + 1] = "</table></div>"
end

local function machine(manifest)
  local m = manifest.machine
  return ("%s, %d processors, %.0f GB, %s; %d threads"):format(m.processor or "unknown processor",
    m.processors or 0, (m.memory_bytes or 0) / 1e9, m.system or "unknown system", manifest.threads)
end

--- The page of {scale, parts, tables, papers, manifest}.
function page.document(run)
  local manifest = run.manifest
  local total, done = 0, 0
  for _, part in ipairs(run.parts) do
    total = total + (part.seconds or 0)
    done = done + (part.status == "done" and 1 or 0)
  end
  local out = {'<!doctype html><html lang="en"><head><meta charset="utf-8"><meta name="viewport" '
    .. 'content="width=device-width"><title>Ours beside what the papers print</title><style>', STYLE,
    "</style></head><body><h1>Ours beside what the papers print</h1>",
    ("<p>Every number of ours was computed by a script of this project and read from the result that it wrote. "
      .. "<code>scripts/reproduce --%s</code>, barwright %s%s, %s. %d of %d parts are done; they took %.3g "
      .. "minutes.</p>"):format(run.scale, escape(manifest.version), type(manifest.commit) == "string"
      and " at " .. escape(manifest.commit) or "", escape(os.date "%Y-%m-%d"), done, #run.parts, total / 60),
    ("<p>%s.</p>"):format(escape(machine(manifest)))}
  local smaller = {}
  for _, part in ipairs(run.parts) do
    if part.smaller and not smaller[part.smaller] then
      smaller[part.smaller] = true
      smaller[#smaller + 1] = ("<li>%s</li>"):format(escape(part.smaller))
    end
  end
  if #smaller > 0 then
    out[#out + 1] = "<p>Smaller than in the papers, or left out:</p><ul>" .. table.concat(smaller) .. "</ul>"
  end
  for _, paper in ipairs(run.papers) do
    out[#out + 1] = ("<h2>%s</h2><p><small>%s.</small> %s</p>"):format(escape(paper.key), escape(paper.cite),
      escape(paper.about))
    for _, about in ipairs(run.tables) do
      if about.paper == paper.key then add_table(about, out) end
    end
  end
  out[#out + 1] = '<h2>Parts</h2><div class="scroll"><table>'
    .. cells("th", {"part", "seconds", "of the processor", "", "command"})
  for _, part in ipairs(run.parts) do
    out[#out + 1] = cells("td", {part.name, part.seconds and ("%.1f"):format(part.seconds) or "",
      part.seconds_processor and ("%.1f"):format(part.seconds_processor) or "",
      {text = part.status .. (part.message and ": " .. part.message or ""),
        class = part.status == "done" and "good" or "bad"}, "barwright " .. table.concat(part.words, " ")})
  end
  out[#out + 1] = "</table></div></body></html>\n"
  return table.concat(out, "\n")
end

return page
