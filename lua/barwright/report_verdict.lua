-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The head of a page: the verdict in large words, what it is about, and what to do.
local html = require "barwright.html"

local report_verdict = {}

-- What verdicts are in words, and the class of their colour: green, amber or red.
local known = {holds = {"It holds", "good"}, breaks = {"It breaks", "bad"},
  exceeds = {"It exceeds its limit", "bad"},
  buckles = {"It buckles", "bad"}, unsure = {"Not certain", "open"}, sound = {"It is sound", "good"},
  faulty = {"It has faults", "bad"}, computed = {"Computed", "plain"}}

--- The class of a verdict's colour: "good", "bad", "open" or "plain".
function report_verdict.class(verdict)
  return known[verdict] and known[verdict][2] or "plain"
end

--- HTML of {verdict =, headline = text, facts = {{name, text}, ...}, advice = {texts}}; facts without a text are
--- left out. Empty where there is none.
function report_verdict.html(about)
  if not about then return "" end
  local escape, lines = html.escape, {}
  local word = known[about.verdict] or known.computed
  lines[1] = ('<section class="verdict %s">'):format(word[2])
  lines[2] = ('<p class="word">%s</p>'):format(escape(about.word or word[1]))
  if about.headline then lines[#lines + 1] = ('<p class="headline">%s</p>'):format(escape(about.headline)) end
  lines[#lines + 1] = '<dl class="facts">'
  for _, fact in ipairs(about.facts or {}) do
    if fact[2] then
      lines[#lines + 1] = ("<div><dt>%s</dt><dd>%s</dd></div>"):format(escape(fact[1]), escape(fact[2]))
    end
  end
  lines[#lines + 1] = "</dl>"
  for _, text in ipairs(about.advice or {}) do
    lines[#lines + 1] = ('<p class="advice">%s</p>'):format(escape(text))
  end
  lines[#lines + 1] = "</section>\n"
  return table.concat(lines, "\n")
end

return report_verdict
