-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What a study's file remembers of its study, and the tables that follow from it.
local core = require "barwright.core"
local json = require "barwright.json"

local definition = {}

local function quote(name)
  return '"' .. name:gsub('"', '""') .. '"'
end

--- Columns named as the items are; SQL does not tell E from e, so the second becomes e_2.
function definition.columns_of(items)
  local columns, taken = {}, {number = true}
  for i, item in ipairs(items) do
    local name, k = item.name, 1
    while taken[name:lower()] do
      k = k + 1
      name = ("%s_%d"):format(item.name, k)
    end
    taken[name:lower()] = true
    columns[i] = name
  end
  return columns
end

--- Name, seed, variables and measures as plain data: what a file and a study must agree in.
function definition.of(study)
  local out = {name = study.name, seed = study.seed, variables = json.list {}, measures = json.list {}}
  for i, v in ipairs(study.problem.variables) do
    local item = {name = v.name, kind = v.kind, unit = v.unit}
    if v.kind == "choice" then
      item.of = json.list {}
      for k, value in ipairs(v.of) do item.of[k] = value end
    else
      item.min, item.max, item.scale = v.min, v.max, v.scale
      item.distribution = v.distribution and v.distribution.text
    end
    out.variables[i] = item
  end
  out.correlations = study.problem.correlations and study.problem.correlations.text
  for i, m in ipairs(study.problem.measures) do
    out.measures[i] = {name = m.name, unit = m.unit, optional = m.optional or nil}
  end
  return out
end

--- Statements with their parameters that write a definition into empty tables.
function definition.rows(about)
  local text, out = json.encode(about), {}
  for name, value in pairs {name = about.name, seed = tostring(about.seed), definition = text,
    definition_sha256 = core.sha256_of(text)} do
    out[#out + 1] = {"INSERT INTO study VALUES (?, ?)", name, value}
  end
  local columns = definition.columns_of(about.variables)
  for i, v in ipairs(about.variables) do
    out[#out + 1] = table.pack("INSERT INTO variables VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)", i, v.name, columns[i],
      v.kind, v.unit, v.min, v.max, v.kind == "real" and v.scale or nil, v.of and json.encode(v.of) or nil)
  end
  columns = definition.columns_of(about.measures)
  for i, m in ipairs(about.measures) do
    out[#out + 1] = table.pack("INSERT INTO measures VALUES (?, ?, ?, ?)", i, m.name, columns[i], m.unit)
  end
  return out
end

--- The constraints as text.
function definition.constraints_of(study)
  local out = json.list {}
  for i, c in ipairs(study.problem.constraints) do out[i] = {name = c.name, min = c.min, max = c.max} end
  return json.encode(out)
end

local function describe(item, field)
  local value = item and item[field]
  return value == nil and "none" or type(value) == "table" and json.encode(value) or tostring(value)
end

--- The first thing in which two definitions differ, as a sentence; nil where they do not.
function definition.first_difference(old, new)
  if old.name ~= new.name then return ("its study is '%s', not '%s'"):format(old.name, new.name) end
  if old.seed ~= new.seed then return ("its seed is %s, not %s"):format(old.seed, new.seed) end
  if old.correlations ~= new.correlations then
    return ("its correlations are %s, not %s"):format(old.correlations or "none", new.correlations or "none")
  end
  for _, list in ipairs {"variables", "measures"} do
    local what = list:sub(1, -2)
    for i = 1, math.max(#old[list], #new[list]) do
      local a, b = old[list][i], new[list][i]
      if not a then return ("%s '%s' is not in it"):format(what, b.name) end
      if not b then return ("its %s '%s' is gone"):format(what, a.name) end
      for _, field in ipairs {"name", "kind", "unit", "min", "max", "scale", "of", "distribution",
        "optional"} do
        local was, is = describe(a, field), describe(b, field)
        if was ~= is then
          if field == "name" then return ("its %s %d is '%s', not '%s'"):format(what, i, was, is) end
          return ("%s '%s': %s was %s, is %s"):format(what, a.name, field, was, is)
        end
      end
    end
  end
end

local function column_list(columns, rule)
  local out = {}
  for i, name in ipairs(columns) do out[i] = quote(name) .. (rule or "") end
  return #out > 0 and ", " .. table.concat(out, ", ") or ""
end

--- The statements that make the tables of a file with this definition; without one the tables `points` and
--- `results` have no columns but the number. Their order is a part of the format: salvage knows by it where in a
--- file each table begins. plain: those of a file without checksums.
function definition.schema(about, plain)
  local points = definition.columns_of(about and about.variables or {})
  local results = definition.columns_of(about and about.measures or {})
  local shown = {}
  for _, name in ipairs(points) do
    shown[#shown + 1] = (", p.%s AS %s"):format(quote(name), quote(name))
  end
  for _, name in ipairs(results) do
    shown[#shown + 1] = (", r.%s AS %s"):format(quote(name), quote(name))
  end
  return {
    "CREATE TABLE study (name TEXT PRIMARY KEY, value TEXT NOT NULL)",
    "CREATE TABLE variables (position INTEGER PRIMARY KEY, name TEXT, column_name TEXT, kind TEXT, unit TEXT,"
      .. " min, max, scale TEXT, choices TEXT)",
    "CREATE TABLE measures (position INTEGER PRIMARY KEY, name TEXT, column_name TEXT, unit TEXT)",
    "CREATE TABLE scripts (number INTEGER PRIMARY KEY, sha256 TEXT UNIQUE, path TEXT, text TEXT,"
      .. " constraints TEXT)",
    "CREATE TABLE manifests (number INTEGER PRIMARY KEY, manifest TEXT UNIQUE)",
    "CREATE TABLE trials (number INTEGER PRIMARY KEY, key TEXT NOT NULL UNIQUE, seed INTEGER NOT NULL,"
      .. " status TEXT NOT NULL, message TEXT, seconds REAL, processor_seconds REAL, peak_bytes INTEGER,"
      .. " attempts INTEGER NOT NULL DEFAULT 0, gradients TEXT, script INTEGER, manifest INTEGER"
      .. (plain and ")" or ", checksum INTEGER)"),
    ("CREATE TABLE points (number INTEGER PRIMARY KEY%s)"):format(column_list(points)),
    ("CREATE TABLE results (number INTEGER PRIMARY KEY%s)"):format(column_list(results)),
    ("CREATE VIEW overview AS SELECT t.number, t.key, t.seed, t.status, t.message, t.seconds, t.peak_bytes%s"
      .. " FROM trials t JOIN points p ON p.number = t.number LEFT JOIN results r ON r.number = t.number")
      :format(table.concat(shown)),
  }
end

--- The statement of each table, by its name, as SQLite's list of tables has it.
function definition.tables(about, plain)
  local out = {}
  for _, statement in ipairs(definition.schema(about, plain)) do
    local name = statement:match "^CREATE TABLE (%w+)"
    if name then out[name] = statement end
  end
  return out
end

return definition
