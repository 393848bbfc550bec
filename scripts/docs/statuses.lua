-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Which statuses the functions of the engine can return, from their sources: those that a function, or what it
-- mentions, passes to bw_fail, returns or assigns. Two answers frame the truth: `near` follows only functions of
-- the same file (all of them are possible), `far` follows every function (some of them may not be).
local read_file = require "barwright.read_file"

local statuses = {}

-- C text without comments and strings.
local function bare(text)
  return (text:gsub("/%*.-%*/", " "):gsub("//[^\n]*", " "):gsub('"[^"\n]*"', '""'))
end

-- The definitions of a file: a name with brackets at the left margin's declaration, and a body that ends at "\n}".
local function definitions(text, path, all)
  for head, body in ("\n" .. text):gmatch "\n([%a_][^\n;{}#][^;{}#]-%))%s*(%b{})" do
    local name = head:match "([%w_]+)%s*%b()$" -- macros may stand before it
    if name then
      local own = head:find "%f[%w_]static%f[^%w_]" ~= nil
      local one = {path = path, own = own, raises = {}, calls = {}, members = {}}
      for statement in body:gmatch "[^;{}]+" do
        local fails = statement:find "bwi?_fail" or statement:find "%f[%w_]return%f[^%w_]"
          or statement:find "status%s*=[^=]"
        if fails then
          for word in statement:gsub("[!=]=%s*BW_[A-Z]+", ""):gmatch "%f[%w_]BW_[A-Z]+%f[^%w_]" do
            one.raises[word] = true
          end
        end
      end
      for word in body:gmatch "%f[%w_][%l_][%w_]+" do one.calls[word] = true end
      for word in body:gmatch "%->([%l_][%w_]+)%s*%(" do one.members[word] = true end
      all[name] = all[name] or {}
      table.insert(all[name], one)
    end
  end
end

-- The tables of functions of a file, as `static const format formats[] = {...};`. Who mentions one may call each.
local function tables(text, path, all)
  for head, body in ("\n" .. text):gmatch "\nstatic ([^\n;{}()#=]-)%s*=%s*(%b{})%s*;" do
    local name = head:gsub("%b[]", ""):match "([%w_]+)%s*$"
    local one = {path = path, own = true, raises = {}, calls = {}, members = {}}
    for word in body:gmatch "%f[%w_][%l_][%w_]+" do one.calls[word] = true end
    if name then
      all[name] = all[name] or {}
      table.insert(all[name], one)
    end
  end
end

-- What a name means in a file: its own function, else a shared one.
local function meant(all, name, path)
  local shared
  for _, one in ipairs(all[name] or {}) do
    if one.path == path then return one end
    if not one.own then shared = shared or one end
  end
  return shared
end

--- Reads the sources of a folder.
function statuses.read(folder)
  local all = {}
  local listing = assert(io.popen(("find '%s' -name '*.c' -o -name '*.cpp' | LC_ALL=C sort"):format(folder)))
  for path in listing:lines() do
    local text = bare(assert(read_file(path)))
    definitions(text, path, all)
    tables(text, path, all)
  end
  listing:close()
  return all
end

--- The statuses of a public function as a set; nil where it is not defined in the sources.
function statuses.of(all, name, near)
  local first = meant(all, name, nil)
  if not first then return nil end
  local seen, stack, found = {[first] = true}, {first}, {}
  while #stack > 0 do
    local one = table.remove(stack)
    for word in pairs(one.raises) do found[word] = true end
    local function follow(next_one)
      if next_one and not seen[next_one] and (not near or next_one.path == first.path) then
        seen[next_one] = true
        stack[#stack + 1] = next_one
      end
    end
    for word in pairs(one.calls) do follow(meant(all, word, one.path)) end
    for word in pairs(one.members) do -- through a table of functions: any of that name
      for _, next_one in ipairs(all[word] or {}) do follow(next_one) end
    end
  end
  return found
end

return statuses
