-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The pages of `barwright buckle`: a view of the part under its load and in its buckling shapes, and the sentences
-- that the command says.
local bw = require "barwright"
local body_page = require "barwright.body_page"
local shown = require "barwright.shown"

local buckle_page = {}

local words = {holds = "It does not buckle", buckles = "It buckles", unsure = "Not certain"}

--- The head of a page: factor, the smallest in size or nil, its relative error, `facts` of the command before the
--- others, about = {searched =, counted =, used = stress over strength at the factor or nil, now = under the load
--- itself or nil, asked = what is multiplied, found = what limits the answer, or nil}.
function buckle_page.head(verdict, factor, estimated, facts, about)
  local size = factor and math.abs(factor)
  local headline
  if size then
    local interval = shown.interval(size, size * math.max(0, 1 - estimated), size, "")
    headline = ("It buckles at %s times %s%s."):format(interval:gsub(" +%(", " ("):gsub(" +%)", ")"), about.asked,
      factor < 0 and ", reversed" or "")
  else
    headline = ("No load factor was found up to %s times %s."):format(shown.number(about.searched), about.asked)
  end
  local list = {table.unpack(facts)}
  list[#list + 1] = {"Stress at that load", about.used and shown.percent(about.used)
    .. " of the strength, error unknown"}
  list[#list + 1] = {"Factors", about.counted and "counted: none is missing"
    or "not counted: a smaller one may be missing"}
  list[#list + 1] = {"Assumption", "linear theory: perfect shape and supports, loads that keep their directions"}
  local advice = {}
  if size and size * (1 - estimated) <= 1 then
    advice[1] = ("It carries %s of %s without buckling; a thicker or shorter part carries more."):format(
      shown.percent(math.max(0, size * (1 - estimated))), factor < 0 and "the reversed load" or about.asked)
  end
  if about.used and about.used > 1 then
    advice[#advice + 1] = "The material may fail before it buckles: `barwright statics` answers that."
  elseif about.now and about.now > 1 then
    advice[#advice + 1] = "The material may fail under the load itself: `barwright statics` answers that."
  end
  advice[#advice + 1] = "Real parts are not perfect and buckle earlier; thin shells at a fraction of this."
  if about.found then advice[#advice + 1] = about.found end
  return {verdict = verdict, word = words[verdict], headline = headline, facts = list, advice = advice}
end

--- Writes a page. head: of report_verdict.lua; load: {name, unit, values over nodes, scale, displacement, arrows
--- or nil} of the part under it;
--- picture: of a file name, where the view cannot be shown.
function buckle_page.write(path, title, head, buckling, load, sentences, picture)
  local moves = {}
  for i = 1, buckling.count do
    local name = ("buckling shape %d: load factor %s"):format(i, shown.number(buckling.factors[i]))
    moves[i] = {name = name, kind = "mode", values = buckling:shape(i)}
  end
  moves[buckling.count + 1] = {name = "under the load", kind = "load", values = load.displacement, field = 0,
    arrows = load.arrows}
  return body_page.write(path, buckling.mesh, {title = title, verdict = head,
    answer = table.concat(sentences, "\n"),
    fields = {{name = load.name, unit = load.unit, values = load.values, scale = load.scale}},
    displacements = moves,
    picture = picture, manifest = {load_factors = bw.json.list(buckling.factors:totable())}})
end

return buckle_page
