-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The page of `barwright heat`: a view of the temperature, the balance of heat, and the sentences that the command
-- says.
local body_page = require "barwright.body_page"
local core = require "barwright.core"
local html = require "barwright.html"

local heat_page = {}

local ZERO_CELSIUS <const> = 273.15 -- K

-- What goes in by each condition, and its sum, as HTML.
local function balance(gained)
  local rows, sum = {}, 0
  for i, each in ipairs(gained) do
    rows[i] = {each.kind, each.place, core.quantity(each.heat_w, "W"), ("%.2g W"):format(each.estimated_error_w)}
    sum = sum + each.heat_w
  end
  rows[#rows + 1] = {"sum, which the equations leave", "", ("%.2g W"):format(sum), ""}
  return "<h2>Balance of heat</h2>\n"
    .. html.table({"condition", "at", "heat into the part", "estimated error"}, rows)
end

local words = {holds = "It stays below the limit", exceeds = "It exceeds the limit"}

local function celsius(kelvin) return ("%.4g C"):format(kelvin - ZERO_CELSIUS) end

--- The head of a page. about: {verdict =, highest =, lowest =, estimated =, limit = or nil (K), at =, facts =}.
function heat_page.head(about)
  local low, high = about.highest - about.estimated, about.highest + about.estimated
  local interval = ("%s (%s to %s)"):format(celsius(about.highest), celsius(low), celsius(high))
  local facts = {{"Limit", about.limit and celsius(about.limit)},
    {"Margin", about.limit and (high <= about.limit and ("%.3g K at least"):format(about.limit - high)
      or ("it may exceed the limit by %.3g K"):format(high - about.limit))},
    {"Warmest at", core.point(about.at)}, {"Lowest", celsius(about.lowest)}}
  table.move(about.facts, 1, #about.facts, #facts + 1, facts)
  facts[#facts + 1] = {"Assumption", "steady state; no radiation between surfaces"}
  local advice = {}
  if about.verdict == "unsure" then advice[1] = "More --elements make the error smaller." end
  if about.verdict == "exceeds" then
    advice[1] = "Cool a larger place, conduct the heat by more material, or put in less power."
  end
  return {verdict = about.verdict, word = words[about.verdict] or about.verdict == "computed"
    and celsius(about.highest) or nil, headline = ("The highest temperature is %s."):format(interval),
    facts = facts, advice = advice}
end

--- Writes a page. about: {name = of the part, words = of the verdict or nil, answer, estimated = error (K),
--- gained = heat of each condition as in the JSON, manifest, head}.
function heat_page.write(solution, path, about)
  local highest = solution.temperature:max()
  local title = ("%s: highest temperature %.4g C ± %.2g K%s"):format(about.name, highest - ZERO_CELSIUS,
    about.estimated, about.words and "; " .. about.words or "")
  return body_page.write(path, solution.mesh, {title = title, verdict = about.head,
    answer = about.answer, fields = {
    {name = "temperature", unit = "C", values = solution.temperature - ZERO_CELSIUS},
    {name = "heat flux", unit = "W/m2", values = solution.flux:map "norm(a)"}},
    body = balance(about.gained), manifest = about.manifest, view = function(surface, nodes)
      return core.picture_direction(surface, nil, {values = solution.temperature:gather(nodes)})
    end, picture = function(name) return solution:picture(name, {title = title}) end})
end

return heat_page
