-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- One HTML page: every table of the papers with ours beside what is printed, what was smaller, where and by
-- what it was computed.
local html = require "barwright.html"
local numbers = require "barwright.scenario.numbers"

local page = {}
local escape = html.escape

local STYLE <const> = [[
p { max-width: 48rem } tr:nth-child(even) td { background: var(--stripe) }
.last th:last-child, .last td:last-child { text-align: left }
]]

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
  if ratio >= 1 then return {("%s times %s"):format(numbers.show(ratio, 3), words), class = "good"} end
  local other = {smaller = "larger", less = "more", more = "less"}
  return {("%s times %s"):format(numbers.show(1 / ratio, 3), other[words]), class = "bad"}
end

local function add_table(about, out)
  out[#out + 1] = ("<h3>%s. %s</h3>"):format(escape(about.place), escape(about.title))
  if about.note then out[#out + 1] = ("<p>%s</p>"):format(escape(about.note)) end
  local rows = {}
  for i, row in ipairs(about.rows) do
    local ours = row.ours or row.ours_timed
    rows[i] = {row.what, figure(row.printed, row.unit), ours and figure(ours, row.unit) or "", beside(row),
      {row.note or row.why or "", class = "soft"}}
  end
  out[#out + 1] = html.table({"", "printed", "ours", "beside it", ""}, rows, "numbers last")
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
  local out = {
    ("<p>Every number of ours was computed by a script of this project and read from the result that it wrote. "
      .. "<code>scripts/reproduce --%s</code>, barwright %s%s, %s. %d of %d parts are done; they took %.3g "
      .. "minutes.</p>"):format(run.scale, escape(manifest.version), type(manifest.commit) == "string"
      and " at " .. escape(manifest.commit) or "", escape(os.date "%Y-%m-%d"), done, #run.parts, total / 60),
    ("<p>%s.</p>"):format(escape(machine(manifest)))}
  local smaller = {}
  for _, part in ipairs(run.parts) do
    if part.smaller and not smaller[part.smaller] then
      smaller[part.smaller] = true
      smaller[#smaller + 1] = part.smaller
    end
  end
  if #smaller > 0 then
    out[#out + 1] = "<p>Smaller than in the papers, or left out:</p>" .. html.list(smaller)
  end
  for _, paper in ipairs(run.papers) do
    out[#out + 1] = ("<h2>%s</h2><p><small>%s.</small> %s</p>"):format(escape(paper.key), escape(paper.cite),
      escape(paper.about))
    for _, about in ipairs(run.tables) do
      if about.paper == paper.key then add_table(about, out) end
    end
  end
  local rows = {}
  for i, part in ipairs(run.parts) do
    rows[i] = {part.name, part.seconds and ("%.1f"):format(part.seconds) or "",
      part.seconds_processor and ("%.1f"):format(part.seconds_processor) or "",
      {part.status .. (part.message and ": " .. part.message or ""),
        class = part.status == "done" and "good" or "bad"},
      "barwright " .. table.concat(part.words, " ")}
  end
  out[#out + 1] = "<h2>Parts</h2>" .. html.table({"part", "seconds", "of the processor", "", "command"}, rows,
    "numbers last")
  return html.document {title = "Ours beside what the papers print", body = table.concat(out, "\n"), style = STYLE}
end

return page
