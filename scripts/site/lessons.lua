-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Each lesson and design study of examples/ as a page: what its head says, how to run it, the whole program.
local escape = require "barwright.html".escape
local markdown = require "markdown"
local read_file = require "barwright.read_file"

local lessons = {}

--- What a lesson's source says of itself: {number, title, run, text, source}.
function lessons.read(path)
  local source = assert(read_file(path))
  local number, title = source:match "\n%-%- Lesson (%d+): ([^\n]*)\n"
  title = title or source:match "\n%-%- Study: ([^\n]*)\n"
  if not title then return nil, path .. ": its head has no line '-- Lesson N: title' or '-- Study: title'" end
  local head, words, run = source:match "^(.-)\n[^-]", {}, nil
  for line in head:gmatch "[^\n]+" do
    local text = line:match "^%-%- ?(.*)$" or ""
    if text:match "^  build/barwright" then
      run = run or text:match "^%s*(.*)"
    elseif not text:match "^SPDX" and not text:match "^Lesson" and not text:match "^Study:" then
      words[#words + 1] = text
    end
  end
  title = title:gsub("%.$", ""):gsub("^%l", string.upper)
  return {number = tonumber(number), title = title, run = run, text = table.concat(words, "\n"),
    source = source:sub(#head + 2), path = path}
end

--- Its page as HTML.
function lessons.html(lesson, pictures)
  local out = {("<h1>%s%s</h1>"):format(lesson.number and lesson.number .. ". " or "",
    escape(lesson.title))}
  out[#out + 1] = (markdown.html(lesson.text, function(target) return target end))
  if lesson.run then
    out[#out + 1] = ("<pre><code>%s</code></pre>"):format(escape(lesson.run))
  end
  local up = ("../"):rep(select(2, lesson.page.address:gsub("/", "")))
  for _, picture in ipairs(pictures or {}) do
    out[#out + 1] = ('<p><img src="%s%s" alt="%s" loading="lazy"></p>'):format(up, picture.file,
      escape(picture.caption))
  end
  out[#out + 1] = ('<pre class="lua"><code>%s</code></pre>'):format(markdown.lua(lesson.source))
  return table.concat(out, "\n")
end

return lessons
