-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Makes docs/reference.md from the annotation stubs.
--   build/barwright scripts/docs/reference.lua [OUT.md]
local root = (arg and arg[0] or ""):match "^(.*)/scripts/docs/[^/]*$" or "."
package.path = root .. "/scripts/docs/?.lua;" .. package.path
local stubs = require "stubs"

local function read(path)
  local file = assert(io.open(path, "rb"))
  local text = file:read "a"
  file:close()
  return text
end

-- How a class is called in a script.
local spoken = {
  ["bw"] = "bw", ["bw.ArrayModule"] = "bw.array", ["bw.SurfaceModule"] = "bw.surface",
  ["bw.MeshModule"] = "bw.mesh", ["bw.MaterialModule"] = "bw.material", ["bw.JsonModule"] = "bw.json",
  ["bw.ResultsModule"] = "bw.results", ["bw.OutlineModule"] = "bw.outline",
  ["bw.ResponsiveModule"] = "bw.responsive", ["bw.GridModule"] = "bw.grid",
  ["bw.PlotModule"] = "bw.plot",
}

local function title(class)
  return spoken[class.name] or class.name:gsub("^bw%.", "")
end

local function lower(class)
  return (title(class):gsub("(%l)(%u)", "%1_%2"):lower())
end

local function cell(text)
  return (text:gsub("|", "\\|"))
end

local function add_functions(out, class)
  for _, f in ipairs(class.functions) do
    local call = ("%s%s%s(%s)"):format(spoken[class.name] or lower(class), f.colon and ":" or ".",
      f.name, f.arguments)
    out[#out + 1] = ("### `%s`\n"):format(call)
    if f.text ~= "" then out[#out + 1] = f.text .. "\n" end
    for _, p in ipairs(f.params) do
      local kind, remark = stubs.split(p.type)
      out[#out + 1] = ("- `%s`: `%s`%s"):format(p.name, kind, remark ~= "" and ", " .. remark or "")
    end
    for _, r in ipairs(f.returns) do
      local kind, remark = stubs.split(r)
      out[#out + 1] = ("- returns `%s`%s"):format(kind, remark ~= "" and " " .. remark or "")
    end
    if #f.params + #f.returns > 0 then out[#out + 1] = "" end
  end
end

local function render(parsed)
  local out = {"# API reference\n",
    "Made from `lua/stubs/barwright.lua` by `scripts/docs/reference.lua`; change the stubs.\n",
    table.concat(parsed.head, "\n\n", 3) .. "\n"}
  for _, class in ipairs(parsed.classes) do
    if #class.fields + #class.functions > 0 then
      out[#out + 1] = ("## %s\n"):format(title(class))
      local text = class.text ~= "" and class.text or class.about:gsub("^%l", string.upper)
      if text ~= "" then out[#out + 1] = text .. "\n" end
      if #class.fields > 0 then
        out[#out + 1] = "| field | type | |\n|---|---|---|"
        for _, field in ipairs(class.fields) do
          local kind, remark = stubs.split(field.type)
          out[#out + 1] = ("| `%s` | `%s` | %s |"):format(field.name, cell(kind), cell(remark))
        end
        out[#out + 1] = ""
      end
      add_functions(out, class)
    end
  end
  return (table.concat(out, "\n"):gsub("\n\n\n+", "\n\n"):gsub("\n*$", "\n"))
end

local text = render(stubs.parse(read(root .. "/lua/stubs/barwright.lua")))
local path = arg[1] or root .. "/docs/reference.md"
local file = assert(io.open(path, "wb"))
file:write(text)
file:close()
