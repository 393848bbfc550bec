-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes the documentation's site from README, docs/ and examples/: one folder that opens from disk or from any
-- web server.
local root = arg[0]:match "^(.*)/scripts/site/[^/]*$" or "."
package.path = root .. "/scripts/site/?.lua;" .. package.path
local bw = require "barwright"
local contents = require "contents"
local core = require "barwright.core"
local escape = require "barwright.html".escape
local files = require "barwright.scenario.files"
local gallery = require "gallery"
local lessons = require "lessons"
local links = require "links"
local markdown = require "markdown"
local read_file = require "barwright.read_file"
local script = require "barwright.command.script"

local opts = script.read {
  summary = "the documentation as a site",
  about = "Makes one folder, which opens from disk or from any web server, from README, docs/ and examples/.\n\n"
    .. "Exit status: 0 made; 1 a page is left out, a link leads nowhere or a formula cannot be set; 2 misuse.",
  options = {
    {name = "out", value = "FOLDER", type = "folder", default = "out/site", what = "where the site goes"},
    {name = "gallery", type = "flag", what = "run the lessons first, and show what they draw"},
  },
}

local function read(path) return assert(read_file(path)) end

-- Beside its target and renamed: an older site stays whole until the new page is.
local function write(path, text)
  assert(core.write_file(path, text))
end

local quoted = files.quoted

local function list(pattern)
  local out, pipe = {}, assert(io.popen("cd " .. quoted(root) .. " && ls " .. pattern))
  for line in pipe:lines() do out[#out + 1] = line end
  pipe:close()
  return out
end

assert(os.execute("mkdir -p " .. quoted(opts.out)))
assert(os.execute(("cd %s && mkdir -p docs/theory docs/notes docs/reference docs/images examples/studies source")
  :format(quoted(opts.out))))
local problems = {}

-- ---- which pages there are ---------------------------------------------------------------------
local pages, by_source = {}, {}
local function add(source, title, address)
  local page = {source = source, title = title, address = address}
  pages[#pages + 1] = page
  by_source[source] = page
  return page
end
for _, group in ipairs(contents) do
  for _, entry in ipairs(group.pages) do
    local source = entry[1]
    add(source, entry[2], source == "README.md" and "index.html" or source:match "^%a+$" and source .. ".html"
      or (source:gsub("%.md$", ".html")))
    local below = {}
    for _, other in ipairs(entry.below and list(entry.below) or {}) do
      if other ~= source then
        local title = read(root .. "/" .. other):match "^# ([^\n]*)"
        below[#below + 1] = add(other, title, (other:gsub("%.md$", ".html")))
      end
    end
    table.sort(below, function(a, b) return a.title < b.title end)
    by_source[source].below = below
  end
end
for _, source in ipairs(list "docs/*.md docs/theory/*.md docs/notes/*.md") do
  if not by_source[source] then
    problems[#problems + 1] = source .. ": stands in no group of scripts/site/contents.lua"
  end
end
local all_lessons = {}
for _, source in ipairs(list "examples/*.lua examples/studies/*.lua") do
  local lesson, message = lessons.read(root .. "/" .. source)
  if lesson then
    lesson.page = add(source, lesson.title, (source:gsub("%.lua$", ".html")))
    lesson.page.hidden = true
    all_lessons[#all_lessons + 1] = lesson
  else
    problems[#problems + 1] = message
  end
end
-- Lessons by their numbers, then studies by their titles.
table.sort(all_lessons, function(a, b)
  if a.number and b.number then return a.number < b.number end
  if a.number or b.number then return a.number ~= nil end
  return a.title < b.title
end)

-- ---- what each page says -----------------------------------------------------------------------
local pictures = gallery.make(root, opts.out, opts.gallery, all_lessons)
local template = read(root .. "/scripts/site/page.html")
local version, commit = bw.version()
local sections = bw.json.list {}

local function up(address) return ("../"):rep(select(2, address:gsub("/", ""))) end

local function add_to(out, page, other, class)
  if not other.there then return end
  out[#out + 1] = ('<li%s><a href="%s%s"%s>%s</a></li>'):format(class or "", up(page.address), other.address,
    other == page and ' aria-current="page"' or "", escape(other.title))
end

local function navigation(page)
  local out = {}
  for _, group in ipairs(contents) do
    out[#out + 1] = "<h2>" .. group.title .. "</h2><ul>"
    for _, entry in ipairs(group.pages) do
      local other = by_source[entry[1]]
      add_to(out, page, other)
      -- Pages below another one are listed while the reader is among them.
      local among = other == page
      for _, one in ipairs(other.below) do among = among or one == page end
      for _, one in ipairs(among and other.below or {}) do add_to(out, page, one, ' class="deep"') end
    end
    out[#out + 1] = "</ul>"
  end
  return table.concat(out)
end

local function section_list(page)
  local out = {}
  for _, heading in ipairs(page.headings or {}) do
    if heading.level == 2 or heading.level == 3 and #page.headings < 60 then
      out[#out + 1] = ('<li%s><a href="#%s">%s</a></li>'):format(heading.level == 3 and ' class="deep"' or "",
        heading.name, escape(heading.text))
    end
  end
  return #out > 1 and "<ul>" .. table.concat(out) .. "</ul>" or ""
end

-- For the search: the whole text under each heading.
local function index(page)
  local heading, name = page.title, nil
  local function add_section(html)
    local text = markdown.plain(html:gsub('<a class="anchor".-</a>', "")):gsub("%s+", " ")
    if #text > 1 then
      sections[#sections + 1] = {page = page.title, heading = heading,
        address = page.address .. (name and "#" .. name or ""), text = text}
    end
  end
  local at = 1
  for from, id, words, after in page.html:gmatch '()<h%d id="([^"]*)">(.-)</h%d>()' do
    add_section(page.html:sub(at, from - 1))
    heading, name, at = markdown.plain(words:gsub("<a class.*", "")):gsub("%s+$", ""), id, after
  end
  add_section(page.html:sub(at))
end

local shown = {} -- files that pages lead to and that have no page
for _, page in ipairs(pages) do
  local text = page.source:match "%.md$" and read_file(root .. "/" .. page.source)
  if text then
    page.there = true
    local wrong
    page.html, page.headings, wrong = markdown.html(text, links.from(page, by_source, shown),
      page.source:match "^docs/theory/" ~= nil)
    assert(page.html, page.headings)
    for _, message in ipairs(wrong) do problems[#problems + 1] = page.source .. ": " .. message end
  elseif page.source == "gallery" then
    page.there, page.html = true, gallery.html(pictures, by_source)
  elseif page.source == "lessons" then
    local rows = {"<h1>Lessons</h1><p>Each is one short program that the tests run.</p><ol>"}
    local studies = {'</ol><h2 id="studies">Design studies</h2><p>Each is complete, under 120 lines, and '
      .. "ends in a report.</p><ul>"}
    for _, lesson in ipairs(all_lessons) do
      local to = lesson.number and rows or studies
      to[#to + 1] = ('<li%s><a href="%s">%s</a></li>'):format(
        lesson.number and (' value="%d"'):format(lesson.number) or "", lesson.page.address,
        escape(lesson.title))
    end
    page.there, page.html = true, table.concat(rows, "\n") .. table.concat(studies, "\n") .. "</ul>"
  elseif page.source:match "%.md$" then
    problems[#problems + 1] = page.source .. ": named in scripts/site/contents.lua, but not there"
  end
end
for _, lesson in ipairs(all_lessons) do
  lesson.page.there = true
  lesson.page.html = lessons.html(lesson, pictures[lesson.path])
end

for source in pairs(shown) do
  local path = root .. "/" .. source
  local text = read_file(path) or files.kind(path) == "folder" and table.concat(list(quoted(source)), "\n")
  if text then
    local page = add(source, source, "source/" .. source:gsub("/", "_") .. ".html")
    page.there = true
    page.html = ("<h1>%s</h1><pre><code>%s</code></pre>"):format(source,
      (source:match "%.lua$" and markdown.lua or escape)(text))
  end
end

local function fill(values)
  return (template:gsub("@(%u+)@", function(name) return values[name] end))
end
for _, page in ipairs(pages) do
  if page.there then
    index(page)
    write(opts.out .. "/" .. page.address, fill {TITLE = escape(page.title), ROOT = up(page.address),
      VERSION = version .. (commit ~= "" and ", " .. commit or ""), PAGES = navigation(page), BODY = page.html,
      SECTIONS = section_list(page)})
  end
end
for _, name in ipairs {"site.css", "site.js"} do
  write(opts.out .. "/" .. name, read(root .. "/scripts/site/" .. name))
end
write(opts.out .. "/search.js", "const sections = " .. bw.json.encode(sections) .. ";\n")

-- ---- do all links lead somewhere? --------------------------------------------------------------
for _, problem in ipairs(links.check(opts.out, pages)) do problems[#problems + 1] = problem end
for _, problem in ipairs(problems) do io.stderr:write("site: ", problem, "\n") end
print(("%d pages in %s, %d pictures, %d problems"):format(#pages, opts.out, #pictures, #problems))
os.exit(#problems == 0 and 0 or 1, true)
