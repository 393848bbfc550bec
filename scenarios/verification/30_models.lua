-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The worst-case analysis of every file of a folder of models, good ones and others.
local bw = require "barwright"
local project = require "project"

local scenario, expect = bw.scenario, bw.scenario.expect
local ELEMENTS <const> = 30000

scenario.about {title = "Real models", text = ("`scripts/worst_case/run.lua` on the models of a folder; %d "
  .. "elements are asked for; files without units are taken as millimetres; PLA; 15 modes, 5 regions each; 20 N "
  .. "(less where the surface is small) and 0.2 MPa."):format(ELEMENTS)}

local function read(path)
  local file = io.open(path, "rb")
  if not file then return nil end
  local text = file:read "a"
  file:close()
  return text
end

-- {name, status, result, complaint}
local function analyse(t, folder, name)
  local out = t.folder .. "/out"
  local _, _, status = os.execute(("BARWRIGHT_QUIET=1 '%s/build/barwright' '%s/scripts/worst_case/run.lua' "
    .. "'%s/%s' --elements %d --out '%s' >'%s.out' 2>'%s.err' </dev/null"):format(project.root, project.root,
    folder, name, ELEMENTS, out, out, out))
  local text = status == 0 and read(out .. "/result.json")
  local complaint = (read(out .. ".err") or ""):gsub("%s+", " "):gsub("^worst_case: ", ""):gsub(" $", "")
  os.execute(("rm -rf '%s' '%s.out' '%s.err'"):format(out, out, out))
  return {name = name, status = status, result = text and bw.json.decode(text),
    complaint = (complaint:gsub(folder:gsub("%p", "%%%0") .. "/", ""))}
end

local function is_other(name)
  return name:match "^bad_" or name:match "^ok_"
end

local function stress(r)
  return ("%.3g MPa at (%.3g, %.3g, %.3g) mm"):format(r.max_principal_pa / 1e6,
    r.max_principal_at_m[1] * 1e3, r.max_principal_at_m[2] * 1e3, r.max_principal_at_m[3] * 1e3)
end

scenario("Sound models", {tags = {"slow", "models"}, seconds = 3600}, function(t)
  local folder, names = project.models(t)
  local rows = {}
  for _, name in ipairs(names) do
    if not is_other(name) then
      local one = analyse(t, folder, name)
      local r = one.result
      expect(one.status, name .. ": exit status"):equals(0, {how = one.complaint})
      if r then
        local square = 0
        for k = 1, 3 do square = square + (r.box_high_m[k] - r.box_low_m[k]) ^ 2 end
        local moved = r.surface_moved_m / math.sqrt(square)
        expect(moved, name .. ": largest move of the surface over the diagonal"):below(0.01)
        expect(r.elements, name .. ": elements"):near(ELEMENTS, {relative = 0.2})
        rows[#rows + 1] = {name, r.elements, r.repaired and "yes" or "no", ("%.2g"):format(moved), stress(r)}
      end
    end
  end
  t:table {heads = {"file", "elements", "repaired", "moved, of the box", "weakest place"}, rows = rows}
end)

scenario("Difficult, broken or oddly written models", {tags = {"slow", "models"}, seconds = 3600,
  about = "They are repaired with a statement, or refused in one sentence."}, function(t)
  local folder, names = project.models(t)
  local rows, answered, refused, otherwise = {}, 0, 0, 0
  for _, name in ipairs(names) do
    if is_other(name) then
      local one = analyse(t, folder, name)
      local r = one.result
      if r then
        answered = answered + 1
        local steps = {}
        for _, step in ipairs(r.surface_steps or r.steps or {}) do steps[#steps + 1] = step.name end
        rows[#rows + 1] = {name, 0, ("%d elements, %s%s; %s"):format(r.elements,
          r.repaired and "repaired" or "as it is",
          #steps > 0 and (" (" .. table.concat(steps, ", ") .. ")") or "", stress(r))}
      else
        rows[#rows + 1] = {name, one.status, one.complaint}
        if one.status == 2 and #one.complaint > 0 then refused = refused + 1 else otherwise = otherwise + 1 end
      end
    end
  end
  expect(otherwise, "models neither answered nor refused"):below(0,
    {how = ("%d answered, %d refused"):format(answered, refused)})
  t:table {heads = {"file", "exit status", "what came of it"}, rows = rows}
end)
