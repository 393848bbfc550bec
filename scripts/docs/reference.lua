-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes docs/reference from the annotation stubs: a page for each file of lua/stubs, and index.md.
local root = (arg and arg[0] or ""):match "^(.*)/scripts/docs/[^/]*$" or "."
package.path = root .. "/scripts/docs/?.lua;" .. package.path
local gaps = require "gaps"
local script = require "barwright.command.script"
local stubs = require "stubs"

local opts = script.read {
  summary = "docs/reference from the annotation stubs: a page for each file of lua/stubs, and index.md",
  arguments = {{name = "out", type = "folder", optional = true, default = root .. "/docs/reference",
    what = "the folder of the pages"}},
}

-- Every file of lua/stubs has its place in the index.
local groups = {
  {"Basics", "barwright array json results"},
  {"Geometry", "surface shapes mesh selection picture canvas"},
  {"Parts", "material model solver static contact heat deposition stress modes buckling nonlinear harmonic "
    .. "response_spectrum fatigue transient drop eigensolver system sparse_matrix operator singular"},
  {"Where a part breaks", "worst_case worst_buckling breaking_force strengthen drop_test brute_force worst_loads "
    .. "lp"},
  {"Edit sessions", "edit optimise skeleton subdomains incremental_system live workbench"},
  {"The plane", "outline plane responsive sheet bridge metallophone flow"},
  {"Solids on grids", "grid solid metamaterial"},
  {"Studies and tests", "study scenario plot distributed"},
}

local all = stubs.read(root .. "/lua/stubs")

local function slug(text) return (text:lower():gsub("[^%w%s_-]", ""):gsub("%s", "-")) end

-- The heading of a class, an alias or a module.
local function title(one)
  local class = all.by_name[one.name]
  local spoken, is_module
  if class then spoken, is_module = stubs.spoken(all, class) end
  return is_module and spoken or (one.name:gsub("^bw%.", ""))
end

-- Where a class or an alias is explained: name -> "file.md#part".
local place = {}
for _, file in ipairs(all.files) do
  for _, list in ipairs {file.classes, file.aliases} do
    for _, one in ipairs(list) do
      place[one.name] = place[one.name] or ("%s.md#%s"):format(file.name, slug(title(one)))
    end
  end
end

-- A type as code, each alternative with a link to the class that it names.
local function type_of(kind, optional)
  local out = {}
  for i, one in ipairs(gaps.alternatives(kind)) do
    local name = one:match "bw%.[%w]+"
    local code = "`" .. one .. "`"
    out[i] = name and place[name] and ("[%s](%s)"):format(code, place[name]) or code
  end
  local text = table.concat(out, " or ")
  if kind:match "%?$" then text = text .. " or `nil`" end
  return text .. (optional and ", optional" or "")
end

-- Documents that the stubs name become links.
local function linked(text)
  local out, code = {}, false
  for line in (text .. "\n"):gmatch "(.-)\n" do
    if line:match "^```" then code = not code end
    out[#out + 1] = code and line or line:gsub("docs/([%w_/]+)%.md", "[%1](../%1.md)")
  end
  return table.concat(out, "\n")
end

local function value(one)
  local name = one.name and ("`%s` "):format(one.name) or ""
  local text = one.text ~= "" and ": " .. linked(one.text) or ""
  return ("%s(%s)%s"):format(name, type_of(one.type, one.optional), text)
end

local function add_function(out, class, f)
  local spoken = stubs.spoken(all, class)
  local name = f.name == "__call" and "" or (f.colon and ":" or ".") .. f.name
  out[#out + 1] = ("### `%s%s(%s)`\n"):format(spoken, name, f.arguments)
  if f.text ~= "" then out[#out + 1] = linked(f.text) .. "\n" end
  for _, p in ipairs(f.params) do out[#out + 1] = "- " .. value(p) end
  for _, r in ipairs(f.returns) do out[#out + 1] = "- returns " .. value(r) end
  if #f.params + #f.returns > 0 then out[#out + 1] = "" end
end

local function page(file)
  local out = {("# %s\n"):format(file.title), linked(file.head) .. "\n",
    ("[All pages of the reference](index.md). Made from `lua/stubs/%s.lua`.\n"):format(file.name)}
  for _, alias in ipairs(file.aliases) do
    out[#out + 1] = ("## %s\n\n%s\n"):format(title(alias), linked(alias.text))
  end
  for _, class in ipairs(file.classes) do
    local continued = class.name == "bw" and #class.fields == 0
    out[#out + 1] = ("## %s\n"):format(continued and "Functions" or title(class))
    if class.text ~= "" then out[#out + 1] = linked(class.text) .. "\n" end
    if class.parent then
      out[#out + 1] = ("It has the fields of [`%s`](%s), and:\n"):format(class.parent, place[class.parent])
    end
    for _, field in ipairs(class.fields) do out[#out + 1] = "- " .. value(field) end
    if #class.fields > 0 then out[#out + 1] = "" end
    for _, f in ipairs(class.functions) do add_function(out, class, f) end
  end
  return (table.concat(out, "\n"):gsub("\n\n\n+", "\n\n"):gsub("\n*$", "\n"))
end

-- What stands on a page, for the index: modules' functions and classes with functions.
local function listed(file)
  local out = {}
  for _, class in ipairs(file.classes) do
    local spoken, is_module = stubs.spoken(all, class)
    if is_module then
      for _, f in ipairs(class.functions) do
        local name = spoken .. (f.name == "__call" and "" or (f.colon and ":" or ".") .. f.name)
        out[#out + 1] = ("[`%s`](%s.md#%s)"):format(name, file.name, slug(name .. "(" .. f.arguments .. ")"))
      end
    elseif #class.functions > 0 then
      out[#out + 1] = ("[%s](%s.md#%s)"):format(title(class), file.name, slug(title(class)))
    end
  end
  return table.concat(out, ", ")
end

local function index()
  local out = {"# API reference\n", linked(all.files[1].head) .. "\n"}
  local by_name = {}
  for _, file in ipairs(all.files) do by_name[file.name] = file end
  for _, group in ipairs(groups) do
    out[#out + 1] = ("## %s\n"):format(group[1])
    for name in group[2]:gmatch "%S+" do
      local file = by_name[name] or error("docs: no file lua/stubs/" .. name .. ".lua", 0)
      local first = file.head:match "^(.-%.)%f[%s\0]" or file.head
      first = linked((first:gsub("\n", " ")))
      out[#out + 1] = ("- [%s](%s.md): %s %s"):format(file.title, name, first, listed(file))
      by_name[name] = nil
    end
    out[#out + 1] = ""
  end
  local left_out = next(by_name)
  if left_out then error(("docs: lua/stubs/%s.lua stands in no group of reference.lua"):format(left_out), 0) end
  return (table.concat(out, "\n"):gsub("\n*$", "\n"))
end

local folder = opts.out
local quoted = "'" .. folder:gsub("'", "'\\''") .. "'"
assert(os.execute(("mkdir -p %s && rm -f %s/*.md"):format(quoted, quoted)))
local function write(name, text)
  local file = assert(io.open(("%s/%s.md"):format(folder, name), "wb"))
  file:write(text)
  file:close()
end
write("index", index())
for _, file in ipairs(all.files) do write(file.name, page(file)) end
