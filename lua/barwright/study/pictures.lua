-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The pictures that trials left in their folders, and what stands below them.
local core = require "barwright.core"
local numbers = require "barwright.plot.numbers"
local says = require "barwright.study.plot_data"

local pictures = {}

local function exists(path)
  local file = io.open(path, "rb")
  if file then file:close() end
  return file ~= nil
end

-- The PNG files of a folder, by name.
local function pictures_in(folder)
  local out = {}
  for _, part in ipairs(core.list_folder and core.list_folder(folder) or {}) do
    if not part.folder and part.name:lower():match "%.png$" then out[#out + 1] = part.name end
  end
  table.sort(out)
  return out
end

--- The picture of a trial: of the name given, else picture.png, else the first PNG file of its folder; nil.
function pictures.one(trial, name)
  local folder = trial.folder
  if type(folder) ~= "string" then return nil end
  if name then return exists(folder .. "/" .. name) and folder .. "/" .. name or nil end
  if exists(folder .. "/picture.png") then return folder .. "/picture.png" end
  local first = pictures_in(folder)[1]
  return first and folder .. "/" .. first
end

-- The point and the first objective in two lines.
local function caption_of(problem, trial)
  local point = {}
  for _, v in ipairs(problem.variables) do
    local value = trial.point and trial.point[v.name]
    if value ~= nil then -- a name stays with its value
      local text = ("%s %s"):format(v.name, numbers.quantity(value, v.unit))
      point[#point + 1] = (text:gsub(" ", "\u{a0}"))
    end
  end
  local found = {}
  for _, list in ipairs {problem.objectives or {}, problem.measures} do
    for _, item in ipairs(list) do
      local measure = says.find(problem.measures, item.name)
      local value = trial.results and trial.results[item.name]
      if value and not found[item.name] and #found < 2 then
        found[item.name] = true
        found[#found + 1] = ("%s %s"):format(item.name, numbers.quantity(value, measure and measure.unit))
      end
    end
  end
  return ("%s: %s\n%s"):format(tostring(trial.number), #found > 0 and table.concat(found, ", ")
    or tostring(trial.status), table.concat(point, ", "))
end

--- Pictures for a contact sheet: those of the best or the front first, `most` of them.
function pictures.of(trials, name, max)
  local chosen, order, seen = {}, {}, {}
  for _, i in ipairs(says.chosen(trials)) do
    chosen[i] = true
    order[#order + 1] = i
  end
  for i = 1, #trials do
    if not chosen[i] then order[#order + 1] = i end
  end
  for _, i in ipairs(order) do
    local path = #seen < max and pictures.one(trials[i], name)
    if path then
      seen[#seen + 1] = {path = path, caption = caption_of(trials.problem, trials[i]), chosen = chosen[i]}
    end
  end
  return seen
end

return pictures
