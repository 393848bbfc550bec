-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What can be called, read or written, from the stubs: whatever they name is fuzzed.
-- An entry: {name, kind, class, member, params = {{name, type}}}; kind "function" (of a module), "call" (of a
-- module), "method", "field", "assignment", "unknown" (field), "operator".
local stubs = require "stubs"
local types = require "types"

local entries = {}

--- Left out, with the reason; the run prints both.
entries.left_out = {
  ["bw.Distributed"] = "needs mpirun, and abort ends the process: tests/lua/distributed",
}

-- Lua's operators on an object, with another value `b` where they take one.
entries.operators = {
  add = function(a, b) return a + b end, sub = function(a, b) return a - b end,
  mul = function(a, b) return a * b end, div = function(a, b) return a / b end,
  mod = function(a, b) return a % b end, pow = function(a, b) return a ^ b end,
  idiv = function(a, b) return a // b end, band = function(a, b) return a & b end,
  bor = function(a, b) return a | b end, bxor = function(a, b) return a ~ b end,
  shl = function(a, b) return a << b end, shr = function(a, b) return a >> b end,
  concat = function(a, b) return a .. b end, eq = function(a, b) return a == b end,
  lt = function(a, b) return a < b end, le = function(a, b) return a <= b end,
  reversed_sub = function(a, b) return b - a end, reversed_pow = function(a, b) return b ^ a end,
  unm = function(a) return -a end, bnot = function(a) return ~a end, len = function(a) return #a end,
  tostring = function(a) return tostring(a) end,
  call = function(a, b, c) return a(b, c) end,
  index = function(a, b) return a[b] end,
  pairs = function(a)
    local n = 0
    for _ in pairs(a) do
      n = n + 1
      if n > 50 then break end
    end
  end,
  ipairs = function(a)
    for i in ipairs(a) do
      if i > 50 then break end
    end
  end,
  to_be_closed = function(a) local _ <close> = a end,
}

local any = types.parse "any"

local function of_function(f)
  local params = {}
  for _, param in ipairs(f.params) do
    if param.name ~= "..." then
      params[#params + 1] = {name = param.name, optional = param.optional, type = types.parse(param.type)}
    end
  end
  return params
end

-- The class of the first result, where it is one.
local function returned(f)
  return f.returns[1] and f.returns[1].type:match "^(bw%.%w+)"
end

-- Where a script finds each module: class -> path, from the fields of "bw".
local function paths(by_name)
  local path = {bw = {"bw"}}
  for _, field in ipairs(by_name.bw.fields) do
    if field.type:match "Module$" and by_name[field.type] then path[field.type] = {"bw", field.name} end
  end
  return path
end

--- The list of entries of the stubs in a folder, and their classes by name.
function entries.of(folder)
  local all = stubs.read(folder)
  local list, by_name = {}, all.by_name
  local path = paths(by_name)
  local function add(entry) list[#list + 1] = entry end
  for _, class in ipairs(all.classes) do
    local module, short = path[class.name], class.name:gsub("^bw%.", "")
    local objects = not module and #class.functions > 0 and not entries.left_out[class.name]
    if module then
      local where = table.concat(module, ".")
      for _, f in ipairs(class.functions) do
        if f.name == "__call" then
          add {name = where .. "()", kind = "call", path = module, params = of_function(f)}
        else
          add {name = where .. "." .. f.name, kind = "function", path = module, member = f.name,
            params = of_function(f), returns = returned(f)}
        end
      end
      add {name = where .. "[?]", kind = "unknown", path = module, params = {{name = "key", type = any}}}
    elseif objects or entries.objects[class.name] then
      for _, f in ipairs(class.functions) do
        if f.name ~= "__call" then -- the operator "call" tries that
          add {name = short .. ":" .. f.name, kind = "method", class = class.name, member = f.name,
            params = of_function(f), returns = returned(f)}
        end
      end
      for _, field in ipairs(class.fields) do
        add {name = short .. "." .. field.name, kind = "field", class = class.name, member = field.name,
          params = {}}
        add {name = short .. "." .. field.name .. "=", kind = "assignment", class = class.name,
          member = field.name, params = {{name = "value", type = any}}}
      end
      add {name = short .. "[?]", kind = "unknown", class = class.name, params = {{name = "key", type = any}}}
      for operator in pairs(entries.operators) do
        add {name = short .. "#" .. operator, kind = "operator", class = class.name, member = operator,
          params = {{name = "other", type = any}}}
      end
    end
  end
  table.sort(list, function(a, b) return a.name < b.name end)
  return list, by_name
end

--- Classes without methods whose fields are read all the same.
entries.objects = {["bw.ReuseStatistics"] = true, ["bw.Optimisation"] = true}

return entries
