-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Several files of one study become one: parts that ran on several machines, or an older file. A trial
-- is its key, so nothing is doubled; where two files have different numbers for one key, that is reported.
local core = require "barwright.core"
local options = require "barwright.options"
local store = require "barwright.study.store"

local merge = {}

local rules = {continue = {type = "boolean", default = false}}

local meta = {__name = "merged"}
function meta.__tostring(self)
  local lines = {("%s: %d trials taken from %d files, %d were there already"):format(self.file, self.taken,
    self.files, self.duplicates)}
  for i = 1, math.min(#self.conflicts, 10) do
    local c = self.conflicts[i]
    lines[#lines + 1] = ("trial %d: %s is %s, but %s in %s"):format(c.number, c.name, tostring(c.kept),
      tostring(c.other), c.file)
  end
  if #self.conflicts > 10 then lines[#lines + 1] = ("and %d more conflicts"):format(#self.conflicts - 10) end
  return table.concat(lines, "\n")
end

-- Scripts that made the results of a file, by their SHA-256.
local function scripts_of(file)
  local rows, message, details = file.db:rows "SELECT sha256 FROM scripts"
  if not rows then return nil, message, details end
  local out = {}
  for _, row in ipairs(rows) do out[row.sha256] = true end
  return out
end

local function compare(self, out, mine, other, path)
  for _, m in ipairs(self.problem.measures) do
    local a, b = mine.results[m.name], other.results[m.name]
    if a ~= b then
      out.conflicts[#out.conflicts + 1] = {number = mine.number, key = mine.key, name = m.name, kept = a,
        other = b, file = path}
      return
    end
  end
  out.duplicates = out.duplicates + 1
end

-- What of a file's trials is new here: to be added, and to be finished.
local function sort_out(self, out, known, list, path)
  local add, finish = {}, {}
  for _, record in ipairs(list) do
    local mine = known.by_key[record.key]
    if not mine then
      if known.by_number[record.number] then
        record.number = known.next
      end
      known.next = math.max(known.next, record.number + 1)
      known.by_key[record.key], known.by_number[record.number] = record, record
      add[#add + 1] = record
      if record.status ~= "asked" then out.taken = out.taken + 1 end
    elseif record.status ~= "asked" then
      if mine.status == "done" and record.status == "done" then
        compare(self, out, mine, record, path)
      elseif mine.status == "asked" or record.status == "done" then
        record.number = mine.number
        known.by_key[record.key], known.by_number[record.number] = record, record
        finish[#finish + 1] = record
        out.taken = out.taken + 1
      else
        out.duplicates = out.duplicates + 1
      end
    end
  end
  return add, finish
end

local function take_file(self, target, known, out, path, opts)
  local there, cause = io.open(path, "rb")
  if not there then return nil, cause, {status = "io", file = path} end
  there:close()
  local source <close>, message, details = store.open(self, path, {read_only = true})
  if not source then return nil, message, details end
  local scripts, why, more = scripts_of(source)
  if not scripts then return nil, why, more end
  for sha in pairs(scripts) do
    if not known.scripts[sha] and not opts.continue then
      return nil, ("%s: its trials were run with another text of the script. If their results still hold, give "
        .. "continue = true (--continue)"):format(path), {status = "different", file = path}
    end
  end
  local list
  list, message, details = source:load()
  if not list then return nil, message, details end
  local add, finish = sort_out(self, out, known, list, path)
  local ok
  ok, message, details = target:take(add)
  for _, record in ipairs(finish) do
    if not ok then break end
    ok, message, details = target:finish(record)
  end
  if not ok then return nil, store.explain(self.file, message, details) end
  return true
end

--- Into the study's own file. {taken, duplicates, conflicts = {{number, key, name, kept, other, file}}}.
--- Of a trial that has two different results the one that was there first is kept.
function merge.into(self, files, given)
  local opts = options.read("study:merge", given, rules)
  if type(files) == "string" then files = {files} end
  if type(files) ~= "table" or #files == 0 then
    core.raise("study:merge: a list of files expected, got "
      .. (type(files) == "table" and "none" or core.got(files)))
  end
  for i, path in ipairs(files) do
    if type(path) ~= "string" then
      core.raise(("study:merge: file %d: a path expected, got %s"):format(i, core.got(path)))
    end
  end
  local lock <close>, message, details = core.lock(self.file .. ".lock", 0)
  if not lock then
    if details.limit == "lock" then
      message = ("%s: this study is being run by %s"):format(self.file, details.holder)
      details.status = "busy"
    end
    return nil, message, details
  end
  local target <close>, why, more = store.open(self, self.file, {continue = opts.continue})
  if not target then return nil, why, more end
  local list
  list, message, details = target:load()
  if not list then return nil, message, details end
  local known = {by_key = {}, by_number = {}, next = 1}
  for _, record in ipairs(list) do
    known.by_key[record.key], known.by_number[record.number] = record, record
    known.next = math.max(known.next, record.number + 1)
  end
  known.scripts, message, details = scripts_of(target)
  if not known.scripts then return nil, message, details end
  local out = setmetatable({file = self.file, files = #files, taken = 0, duplicates = 0, conflicts = {}}, meta)
  for _, path in ipairs(files) do
    local ok
    ok, message, details = take_file(self, target, known, out, path, opts)
    if not ok then return nil, message, details end
  end
  return out
end

return merge
