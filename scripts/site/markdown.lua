-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Markdown to HTML by cmark-gfm, with what a site needs beside it: a name for each heading, links to other
-- pages and to sources, formulas as MathML, colours for code.
local colour = require "colour"
local core = require "barwright.core"
local escape = require "barwright.html".escape
local formula = require "formula"

local markdown = {}

local quoted = require "barwright.scenario.files".quoted

local function plain(html)
  return (html:gsub("<[^>]*>", ""):gsub("&lt;", "<"):gsub("&gt;", ">"):gsub("&quot;", '"'):gsub("&amp;", "&"))
end
markdown.plain = plain

-- The name that others who show Markdown give a heading: small letters, hyphens for spaces, no other signs.
local function slug(text, taken)
  local name = text:lower():gsub("[^%w%s_\128-\255-]", ""):gsub("%s", "-")
  if taken[name] then
    taken[name] = taken[name] + 1
    name = name .. "-" .. taken[name]
  else
    taken[name] = 0
  end
  return name
end

--- The HTML of a Markdown text: html, headings {level, name, text}. `link(target)` says where a link leads to.
--- `formulas`: code blocks without a language are formulas; what is wrong with them follows as a third result.
function markdown.html(text, link, formulas)
  local folder <close> = assert(core.temporary_folder())
  local name = folder.path .. "/text.md"
  assert(core.write_file(name, text))
  local pipe = assert(io.popen("cmark-gfm --unsafe -e table -e autolink -e strikethrough " .. quoted(name)))
  local html = pipe:read "a"
  local ok = pipe:close()
  if not ok then return nil, "cmark-gfm failed: is the Debian package cmark-gfm installed?" end
  local headings, taken = {}, {}
  html = html:gsub("<h(%d)>(.-)</h%d>", function(level, inner)
    local words = plain(inner)
    local id = slug(words, taken)
    headings[#headings + 1] = {level = tonumber(level), name = id, text = words}
    return ('<h%s id="%s">%s <a class="anchor" href="#%s" aria-label="link to this section">#</a></h%s>'):format(
      level, id, inner, id, level)
  end)
  html = html:gsub('(<%a+[^>]- ?)(%a+)="([^"]*)"', function(before, attribute, target)
    if attribute ~= "href" and attribute ~= "src" then return nil end
    return ('%s%s="%s"'):format(before, attribute, link(target, attribute))
  end)
  local wrong = {}
  if formulas then
    html = formula.inline(html:gsub("<pre><code>(.-)</code></pre>", function(code)
      local block, message = formula.block(plain(code))
      wrong[#wrong + 1] = message
      return block
    end))
  end
  html = html:gsub('<pre><code class="language%-(%a+)">(.-)</code></pre>', function(language, code)
    local coloured = language == "lua" and markdown.lua(plain(code)) or code
    return ('<pre class="%s"><code>%s</code></pre>'):format(language, coloured)
  end)
  html = html:gsub("<table>(.-)</table>", '<div class="scroll"><table>%1</table></div>')
  return html, headings, wrong
end

--- Lua with its words, texts, numbers and comments marked.
function markdown.lua(source)
  return colour.lua(source, escape)
end

return markdown
