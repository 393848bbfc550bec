-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Links of the sources as links of the site. A file without a page of its own (a script, a list of packages)
-- gets one that shows it.
local read_file = require "barwright.read_file"

local links = {}

local function folder_of(path) return path:match "^(.*/)" or "" end

-- "docs/theory/" and "../live.md" -> "docs/live.md"
local function joined(folder, target)
  local parts = {}
  for part in (folder .. target):gmatch "[^/]+" do
    if part == ".." then
      parts[#parts] = nil
    elseif part ~= "." then
      parts[#parts + 1] = part
    end
  end
  return table.concat(parts, "/")
end
links.joined = joined

local function up(address) return ("../"):rep(select(2, address:gsub("/", ""))) end

--- What turns a link of `page`'s source into one of its HTML. `shown`: the set of files to be shown as they are.
function links.from(page, by_source, shown)
  return function(target)
    if target:match "^%a+:" or target:match "^#" then return target end
    local path, part = target:match "^([^#]*)(.*)$"
    local source = joined(folder_of(page.source), path)
    local other = by_source[source]
    if other then return up(page.address) .. other.address .. part end
    if source:match "^docs/images/" then return up(page.address) .. source end
    if source == "examples" then return up(page.address) .. "lessons.html" end
    if source == "examples/studies" then return up(page.address) .. "lessons.html#studies" end
    if source == "docs/theory" then return up(page.address) .. "docs/theory/worst_case.html" end
    shown[source] = true
    return up(page.address) .. "source/" .. source:gsub("/", "_") .. ".html"
  end
end

--- Sentences about links of the pages in `folder` that lead nowhere.
function links.check(folder, pages)
  local problems, names = {}, {}
  local function anchors(address)
    if names[address] == nil then
      local text = read_file(folder .. "/" .. address)
      names[address] = false
      if text then
        names[address] = {}
        for id in text:gmatch ' id="([^"]*)"' do names[address][id] = true end
      end
    end
    return names[address]
  end
  for _, page in ipairs(pages) do
    local html = page.there and read_file(folder .. "/" .. page.address)
    for target in (html or ""):gmatch '[ ][hs]r[ec]f?="([^"]*)"' do
      if not target:match "^%a+:" then
        local path, part = target:match "^([^#]*)#?(.*)$"
        local address = path == "" and page.address or joined(folder_of(page.address), path)
        local there = anchors(address)
        if not there then
          problems[#problems + 1] = ("%s: link to %s, which is not there"):format(page.source, target)
        elseif part ~= "" and not there[part] then
          problems[#problems + 1] = ("%s: link to %s: no such section"):format(page.source, target)
        end
      end
    end
  end
  return problems
end

return links
