-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- HTML pages: escaped text, tables, embedded pictures, templates, and the frame and style that pages share.
local core = require "barwright.core"
local clean = require "barwright.text".clean
local read_file = require "barwright.read_file"

local html = {}

local signs = {["&"] = "&amp;", ["<"] = "&lt;", [">"] = "&gt;", ['"'] = "&quot;", ["'"] = "&#39;"}

--- A value as text of a page or of an attribute in quotes.
function html.escape(value)
  return (clean(tostring(value)):gsub("[&<>\"']", signs))
end

local escape = html.escape

--- The attributes that stand under the names of a table, in the order of their names: ' class="good"'.
function html.attributes(of)
  local names, out = {}, {}
  for name in pairs(of) do
    if type(name) == "string" then names[#names + 1] = name end
  end
  table.sort(names)
  for i, name in ipairs(names) do out[i] = (' %s="%s"'):format(name, escape(of[name])) end
  return table.concat(out)
end

-- One line of a table: cells, and the attributes of the line.
local function row_of(cells, tag)
  local out = {("<tr%s>"):format(html.attributes(cells))}
  for _, cell in ipairs(cells) do
    local attributes, value = "", cell
    if type(cell) == "table" then attributes, value = html.attributes(cell), cell[1] end
    out[#out + 1] = ("<%s%s>%s</%s>"):format(tag, attributes, escape(value), tag:match "^%a+")
  end
  return table.concat(out) .. "</tr>"
end

--- A table that scrolls by itself where it is too wide. `head` (nil: none): the texts of the columns. Rows are
--- lists of cells; a cell is a value, or {value, class = "good"} with attributes; fields with names of a row are
--- its attributes. Classes of tables: "numbers" (columns but the first to the right).
function html.table(head, rows, class)
  local out = {('<div class="scroll" tabindex="0"><table%s>'):format(html.attributes {class = class})}
  if head then out[2] = "<thead>" .. row_of(head, 'th scope="col"') .. "</thead>" end
  out[#out + 1] = "<tbody>"
  for _, row in ipairs(rows) do out[#out + 1] = row_of(row, "td") end
  out[#out + 1] = "</tbody></table></div>\n"
  return table.concat(out, "\n")
end

--- A list of escaped texts; nothing where there are none.
function html.list(texts)
  if #texts == 0 then return "" end
  local out = {}
  for i, text in ipairs(texts) do out[i] = "<li>" .. escape(text) .. "</li>" end
  return "<ul>" .. table.concat(out) .. "</ul>\n"
end

local kinds = {png = "image/png", svg = "image/svg+xml", gif = "image/gif"}

--- An <img> that contains the picture in the file; an empty text where there is no such file.
function html.image(path, alternative)
  local bytes = read_file(path)
  if not bytes then return "" end
  return ('<img alt="%s" src="data:%s;base64,%s">'):format(escape(alternative),
    kinds[path:match "%.(%l+)$"] or "image/png", core.base64(bytes))
end

--- The same with its caption below.
function html.figure(path, caption)
  local image = html.image(path, caption)
  if image == "" then return "" end
  return ("<figure>%s<figcaption>%s</figcaption></figure>\n"):format(image, escape(caption))
end

-- Text between signs of Markdown in a line that is escaped already.
local function inline(line)
  local codes = {}
  line = line:gsub("`([^`]+)`", function(code)
    codes[#codes + 1] = "<code>" .. code .. "</code>"
    return ("\1%d\1"):format(#codes)
  end)
  line = line:gsub("%[([^%]\n]+)%]%((https?://[^%s%)]+)%)", '<a href="%2">%1</a>')
  line = line:gsub("%[([^%]\n]+)%]%([^%s%)]+%)", "%1") -- what stands beside the page's sources
  line = line:gsub("%*%*([^*]+)%*%*", "<strong>%1</strong>"):gsub("(%s)%*([^%s*][^*]*)%*", "%1<em>%2</em>")
  return (line:gsub("\1(%d+)\1", function(i) return codes[tonumber(i)] end))
end

--- Text with Markdown as HTML: paragraphs, lists of "- ", `code`, **strong**, links to addresses of the web.
function html.prose(text)
  local out = {}
  for block in (escape(text):gsub("\n%s*\n", "\0") .. "\0"):gmatch "([^%z]*)%z" do
    local words, items = {}, {}
    for line in block:gmatch "[^\n]+" do
      local item = line:match "^%s*[-*] (.*)"
      if item then items[#items + 1] = item
      elseif #items > 0 then items[#items] = items[#items] .. " " .. line:gsub("^%s+", "")
      else words[#words + 1] = line:gsub("^%s*#+%s*", "") end
    end
    if #words > 0 then out[#out + 1] = "<p>" .. inline(table.concat(words, "\n")) .. "</p>" end
    if #items > 0 then
      for i, item in ipairs(items) do items[i] = "<li>" .. inline(item) .. "</li>" end
      out[#out + 1] = "<ul>" .. table.concat(items) .. "</ul>"
    end
  end
  return table.concat(out, "\n")
end

--- A template with {{name}} replaced by parts.name.
function html.fill(template, parts)
  return (template:gsub("{{(%l+)}}", function(name) return parts[name] end))
end

--- Text inside of a <script>, which must not end it.
function html.in_script(text)
  return (text:gsub("</", "<\\/"))
end

local STYLE <const> = [[
:root { color-scheme: light dark; --ink: #1c2430; --soft: #596579; --line: #dde2ea; --paper: #fff;
  --good: #176b3a; --bad: #a3341c; --calm: #7a5b00; --stripe: #f5f7fa }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e9f1; --soft: #9aa7bb; --line: #333c4a; --paper: #151a21;
  --good: #67c08b; --bad: #f08a6e; --calm: #d8b95a; --stripe: #1b222c } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper); margin: 2rem auto;
  padding: 0 1rem }
h1 { margin-bottom: .3rem } h2 { margin: 2.4rem 0 .4rem } h3 { margin: 1.8rem 0 .3rem }
small, figcaption, .soft { color: var(--soft) } .good { color: var(--good) } .bad { color: var(--bad) }
.scroll { overflow-x: auto } table { border-collapse: collapse; width: 100%; margin: .6rem 0 1rem }
th, td { text-align: left; padding: .22rem .8rem .22rem 0; border-bottom: 1px solid var(--line);
  vertical-align: top; font-variant-numeric: tabular-nums }
th { vertical-align: bottom } tr.first td { border-top: 2px solid var(--line) }
.numbers th + th, .numbers td + td { text-align: right }
figure { margin: 1rem 0 }
img { max-width: 100%; border: 1px solid var(--line); border-radius: 6px; background: #fff }
pre { overflow-x: auto; font-size: .85rem; border: 1px solid var(--line); padding: .5rem; border-radius: 6px;
  white-space: pre-wrap } code { font-size: .85em }
]]

--- A whole page: {title, body (HTML), width (rem; default 68), style (more rules of CSS)}. Its heading is the
--- title.
function html.document(page)
  local title = escape(page.title)
  return table.concat {'<!doctype html>\n<html lang="en"><head><meta charset="utf-8">',
    '<meta name="viewport" content="width=device-width, initial-scale=1"><link rel="icon" href="data:,">\n<title>',
    title, "</title><style>\n", STYLE, ("body { max-width: %grem }\n"):format(page.width or 68), page.style or "",
    "</style></head>\n<body><main><h1>", title, "</h1>\n", page.body, "</main></body></html>\n"}
end

return html
