-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Results as a manual in Markdown: a section for each file, in it one for each scenario, with its figures
-- beside their references and what is allowed.
local numbers = require "barwright.scenario.numbers"

local manual = {}

-- One line, nothing that ends a cell.
local function cell(value)
  return (tostring(value):gsub("%s+", " "):gsub("|", "\\|"))
end

local function row(out, list)
  for i, value in ipairs(list) do list[i] = cell(value) end
  out[#out + 1] = "| " .. table.concat(list, " | ") .. " |"
end

local function heads(out, list)
  row(out, list)
  out[#out + 1] = "|" .. ("---|"):rep(#list)
end

local function figure(entry)
  local text = entry.figure == nil and "" or numbers.show(entry.figure)
  return text .. (entry.good and "" or " **outside**")
end

local function expectations(result, out)
  local list, beside = {}, false
  for _, entry in ipairs(result.entries) do
    if entry.kind == "expectation" then
      list[#list + 1] = entry
      beside = beside or type(entry.reference) == "number"
    end
  end
  if #list == 0 then return end
  heads(out, beside and {"quantity", "reference", "barwright", "difference", "allowed", "source"}
    or {"quantity", "figure", "allowed", "how"})
  for _, entry in ipairs(list) do
    local unit = entry.unit and entry.unit ~= "" and ", " .. entry.unit or ""
    local quantity = (entry.quantity or entry.form) .. unit
    local source = entry.source and entry.how and entry.source .. "; " .. entry.how or entry.source or entry.how
      or ""
    if beside then
      row(out, {quantity, type(entry.reference) == "number" and numbers.show(entry.reference) or "", figure(entry),
        type(entry.difference) == "number" and ("%+.3g %%"):format(100 * entry.difference) or "",
        entry.allowed:gsub("^within ", ""), source})
    else
      row(out, {quantity, figure(entry), entry.allowed, source})
    end
  end
  out[#out + 1] = ""
end

local function section(result, out)
  out[#out + 1] = "### " .. result.title
  out[#out + 1] = ""
  if result.about then
    out[#out + 1] = result.about
    out[#out + 1] = ""
  end
  for _, entry in ipairs(result.entries) do
    if entry.kind == "note" then
      out[#out + 1] = entry.text
      out[#out + 1] = ""
    end
  end
  if result.status == "skipped" then
    out[#out + 1] = ("Skipped%s."):format(result.message and ": " .. cell(result.message) or "")
    out[#out + 1] = ""
  elseif result.message then
    out[#out + 1] = ("**%s**: %s"):format(result.status, cell(result.message))
    out[#out + 1] = ""
  end
  expectations(result, out)
  for _, entry in ipairs(result.entries) do
    if entry.kind == "table" then
      if entry.text then
        out[#out + 1] = entry.text
        out[#out + 1] = ""
      end
      heads(out, entry.heads)
      for _, cells in ipairs(entry.rows) do row(out, cells) end
      out[#out + 1] = ""
    end
  end
end

local function made(list)
  local out = {}
  for _, one in ipairs(list) do
    local version = ("%s%s"):format(one.version, type(one.commit) == "string" and " at " .. one.commit or "")
    if not out[version] then
      out[version] = true
      out[#out + 1] = version
    end
  end
  return table.concat(out, " and ")
end

--- The manual of a run {scenarios, files}; `manifests` of the runs that it was put together from.
function manual.document(run, command, manifests)
  local count, met = 0, 0
  for _, result in ipairs(run.scenarios) do
    for _, entry in ipairs(result.entries) do
      if entry.kind == "expectation" then
        count, met = count + 1, met + (entry.good and 1 or 0)
      end
    end
  end
  local out = {"# Verification manual", "", ("Made by `%s`%s"):format(command, #manifests > 1
    and " and from results of earlier runs" or ""),
    ("with barwright %s; do not edit. Every figure was computed by a scenario;"):format(made(manifests)),
    ("%d of %d are within what is allowed."):format(met, count), ""}
  for _, file in ipairs(run.files) do
    out[#out + 1] = "## " .. (file.title or file.file)
    out[#out + 1] = ""
    if file.text then
      out[#out + 1] = file.text
      out[#out + 1] = ""
    end
    for _, result in ipairs(run.scenarios) do
      if result.file == file.file then section(result, out) end
    end
  end
  while out[#out] == "" do out[#out] = nil end
  return table.concat(out, "\n") .. "\n"
end

return manual
