-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- Formulas of the theory pages as MathML. Their sources are plain text: `K_ab = Σ w B_aᵀ D B_b`, `(a + b) / 2`,
-- `x^(n - 1)`, Greek letters as such or by name, words between formulas. A code block without a language in
-- docs/theory is a formula; in running text those words are set that can only be one. `run.lua` reports each
-- formula with a sign that is not known here.
local formula = {}

local greek = {alpha = "α", beta = "β", gamma = "γ", delta = "δ", eta = "η", theta = "θ", kappa = "κ",
  lambda = "λ", mu = "μ", nu = "ν", xi = "ξ", pi = "π", rho = "ρ", sigma = "σ", tau = "τ", phi = "φ",
  chi = "χ", omega = "ω", Gamma = "Γ"}
local functions = {}
for name in ("sin cos tan cot ln log exp det tr diag cof sym clamp sign min max div mean LP"):gmatch "%a+" do
  functions[name] = true
end
local by_name = {sum = "∑", int = "∫", grad = "∇", lap = "Δ"}
local big = {["Σ"] = "∑", ["∑"] = "∑", ["∫"] = "∫"}
local superscripts = {["⁰"] = "0", ["¹"] = "1", ["²"] = "2", ["³"] = "3", ["⁴"] = "4", ["⁵"] = "5", ["⁶"] = "6",
  ["⁷"] = "7", ["⁸"] = "8", ["⁹"] = "9", ["⁻"] = "−", ["⁺"] = "+", ["ᵀ"] = "T", ["ⁿ"] = "n"}
local subscripts = {["₀"] = "0", ["₁"] = "1", ["₂"] = "2", ["₃"] = "3", ["₄"] = "4", ["₅"] = "5", ["₆"] = "6",
  ["₇"] = "7", ["₈"] = "8", ["₉"] = "9", ["ₖ"] = "k", ["ᵢ"] = "i", ["ⱼ"] = "j",
  ["ₘ"] = "m", ["ₙ"] = "n", ["₊"] = "+"}
local composed = {["Ñ"] = {"N", "~"}, ["ũ"] = {"u", "~"}, ["ṽ"] = {"v", "~"}, ["û"] = {"u", "^"},
  ["ê"] = {"e", "^"}}
local accents = {["\u{303}"] = "~", ["\u{304}"] = "¯", ["\u{302}"] = "^"}
local operators, relations = {}, {}
for sign in ("+ − ± × · ⊗ : = ≈ ≠ ≤ ≥ < > ~ → ↦ ∈ , ; . …"):gmatch "%S+" do operators[sign] = sign end
operators["-"] = "−"
for sign in ("+ − - ± = ≈ ≠ ≤ ≥ < > ~ → ↦ ∈ , ;"):gmatch "%S+" do relations[sign] = true end
local letters = {}
for letter in ("α β γ δ ε ζ η θ κ λ μ ν ξ π ρ σ τ φ χ ψ ω Γ Δ Θ Λ Ξ Π Φ Ψ Ω ℓ"):gmatch "%S+" do
  letters[letter] = true
end
local upright = {max = true, min = true, last = true, pin = true, before = true, after = true, Ic = true}

local function tag(name, text) return "<" .. name .. ">" .. text .. "</" .. name .. ">" end

local function row(html) return tag("mrow", html) end

-- Signs of a text, with words, numbers and runs of spaces as one each.
local function signs_of(text)
  local signs, at = {}, 1
  text = text:gsub("%+=", "←"):gsub("<=", "≤"):gsub(">=", "≥"):gsub("%->", "→")
  while at <= #text do
    local space = text:match("^%s+", at)
    local sign = space or text:match("^%a+", at) or text:match("^%d+%.?%d*", at)
      or text:match("^[\1-\127\194-\244][\128-\191]*", at)
    if not sign then return nil, "it is not UTF-8" end
    if sign:match "^%d" and sign:sub(-1) == "." then sign = sign:sub(1, -2) end
    -- neo-Hookean, step's: one word
    if sign:match "^%a%a" then
      sign = text:match("^%a%a+%-%a%a+", at) or text:match("^%a%a%a+'%a+", at) or sign
    end
    signs[#signs + 1] = sign
    at = at + #sign
  end
  return signs
end

local reader = {}
reader.__index = reader

function reader:peek(ahead) return self.signs[self.at + (ahead or 0)] end

function reader:take()
  local sign = self.signs[self.at]
  self.at = self.at + 1
  return sign
end

-- "ij" below a letter: letters of their own; known words stay words.
local function script_html(text)
  local out, at = {}, 1
  while at <= #text do
    local word = text:match("^%a+", at)
    local sign = word or text:match("^%d+", at) or text:match("^[\1-\127\194-\244][\128-\191]*", at)
    if word and upright[word] then
      out[#out + 1] = tag("mi", word)
    elseif word and greek[word] then
      out[#out + 1] = tag("mi", greek[word])
    elseif word then
      out[#out + 1] = word == "T" and '<mi mathvariant="normal">T</mi>' or word:gsub("%a", "<mi>%0</mi>")
    elseif sign:match "^%d" then
      out[#out + 1] = tag("mn", sign)
    else
      out[#out + 1] = tag(letters[sign] and "mi" or "mo", sign == "-" and "−" or sign)
    end
    at = at + #sign
  end
  return #out == 1 and out[1]:match "^<m[ino][^>]*>[^<]*</m[ino]>$" or row(table.concat(out))
end

-- What stands behind ^ or _.
function reader:script()
  local sign = self:peek()
  if sign == "(" or sign == "{" then
    self:take()
    return row(self:row(sign == "(" and ")" or "}"))
  end
  local text = self:take() or ""
  if (text == "-" or text == "−") and self:peek() then text = text .. self:take() end
  -- letters and digits, and M_pq,ik
  while true do
    local next_sign = self:peek()
    if next_sign and (text:match "%w$" or letters[text]) and next_sign:match "^%w" then
      text = text .. self:take()
    elseif next_sign == "," and (self:peek(1) or ""):match "^%w" then
      text = text .. self:take() .. self:take()
    else
      break
    end
  end
  if text == "½" then return "<mfrac><mn>1</mn><mn>2</mn></mfrac>" end
  return script_html(text)
end

-- Scripts behind a factor: html.
function reader:scripted(base, is_big)
  local below, above, primes = nil, nil, ""
  while true do
    local sign = self:peek()
    if not sign then break end
    if sign == "_" then
      self:take()
      below = self:script()
    elseif sign == "^" then
      self:take()
      above = (above or "") .. self:script()
    elseif subscripts[sign] or superscripts[sign] then
      local set, text = subscripts[sign] and subscripts or superscripts, ""
      while set[self:peek()] do text = text .. set[self:take()] end
      if set == subscripts then below = script_html(text) else above = (above or "") .. script_html(text) end
    elseif sign == "'" or sign == "′" or sign == "″" then
      primes = primes .. tag("mo", self:take() == "″" and "″" or "′")
    elseif sign == "*" and not (self:peek(1) or " "):match "^%w" then
      self:take()
      primes = primes .. tag("mo", "∗")
    elseif sign == "!" then
      self:take()
      base = row(base .. tag("mo", "!"))
    else
      break
    end
  end
  if primes ~= "" then above = primes .. (above or "") end
  above = above and row(above)
  local under = is_big and below
  local kind = under and (above and "munderover" or "munder")
    or below and (above and "msubsup" or "msub") or above and "msup"
  return kind and tag(kind, base .. (below or "") .. (above or "")) or base
end

local closing = {["("] = ")", ["["] = "]", ["{"] = "}", ["|"] = "|", ["‖"] = "‖"}

-- One factor: {html =, inner = what brackets enclose, kind = "factor" | "operator" | "big" | "function" | "text"}.
function reader:factor()
  local sign = self:take()
  if closing[sign] then
    local fence = sign == "|" or sign == "‖"
    local before = self.bar
    if fence then self.bar = sign end
    local inner = self:row(closing[sign])
    self.bar = before
    local html = row(tag("mo", sign) .. inner .. tag("mo", closing[sign]))
    local full = self:scripted(html)
    return {html = full, inner = full == html and sign == "(" and inner or nil, kind = "factor"}
  elseif sign == "√" or sign == "sqrt" then
    if self:peek() ~= "(" then
      return {html = self:scripted(tag("msqrt", self:factor().html)), kind = "factor"}
    end
    self:take()
    return {html = self:scripted(tag("msqrt", self:row ")")), kind = "factor"}
  elseif sign == "½" then
    return {html = "<mfrac><mn>1</mn><mn>2</mn></mfrac>", kind = "factor"}
  elseif sign == "←" then
    return {html = tag("mo", "+") .. tag("mo", "="), kind = "operator", sign = "="}
  elseif big[sign] or by_name[sign] and #sign == 3 and sign ~= "lap" then
    local symbol = big[sign] or by_name[sign]
    return {html = self:scripted(tag("mo", symbol), symbol == "∑"), kind = "big"}
  elseif operators[sign] then
    return {html = tag("mo", sign == "." and self.spaced_dot and "·" or operators[sign]), kind = "operator",
      sign = sign}
  elseif sign == "∂" or sign == "∇" or sign == "Δ" or by_name[sign] then
    return {html = self:scripted(tag("mo", by_name[sign] or sign)), kind = "prefix"}
  elseif sign:match "^%d" then
    return {html = self:scripted(tag("mn", sign)), kind = "factor"}
  elseif letters[sign] or greek[sign] or sign:match "^%a$" or composed[sign] then
    local letter = composed[sign] and composed[sign][1] or greek[sign] or sign
    local accent = composed[sign] and composed[sign][2] or accents[self:peek()]
    if accents[self:peek()] then self:take() end
    local html = tag("mi", letter)
    if accent then html = ('<mover accent="true">%s<mo>%s</mo></mover>'):format(html, accent) end
    return {html = self:scripted(html), kind = "factor"}
  elseif functions[sign] then
    return {html = self:scripted(tag("mi", sign), sign == "max" or sign == "min"), kind = "function"}
  elseif sign:match "^d%a$" then
    return {html = row(tag("mi", "d") .. self:scripted(tag("mi", sign:sub(2)))), kind = "factor"}
  elseif sign:match "^%a%a" then
    return {html = self:scripted(tag("mtext", sign)), kind = "text"}
  end
  error {formula = ("the sign '%s' is not known"):format(sign)}
end

-- From factors and slashes to fractions. With spaces around it a slash divides the whole product before it.
local function fractions(parts)
  local out = {}
  local k = 1
  while k <= #parts do
    local part = parts[k]
    if part.slash then
      local first = #out
      if first == 0 or not parts[k + 1] then error {formula = "a slash has nothing to divide"} end
      if part.spaced then
        while first > 1 and out[first - 1].kind ~= "text" and out[first - 1].kind ~= "big"
          and not (out[first - 1].kind == "operator" and relations[out[first - 1].sign]) and not out[first].wide do
          first = first - 1
        end
      else
        while first > 1 and not out[first].loose and out[first - 1].kind ~= "operator"
          and out[first - 1].kind ~= "big" and out[first - 1].kind ~= "text" do
          first = first - 1
        end
      end
      local above = {}
      for n = first, #out do above[#above + 1] = out[n].html end
      local loose, wide = out[first].loose, out[first].wide
      local one = #above == 1 and out[first].inner
      for n = #out, first, -1 do out[n] = nil end
      local below = {}
      local last = k + 1
      while true do
        below[#below + 1] = parts[last].html
        local following = parts[last + 1]
        if parts[last].kind == "function" or parts[last].kind == "prefix" or following and not following.loose
          and not following.slash and following.kind ~= "operator" then
          last = last + 1
          if not parts[last] then error {formula = "a slash has nothing to divide by"} end
        else
          break
        end
      end
      local under = #below == 1 and parts[k + 1].inner
      out[#out + 1] = {kind = "factor", loose = loose, wide = wide, html = tag("mfrac",
        row(one or table.concat(above)) .. row(under or table.concat(below)))}
      k = last + 1
    else
      out[#out + 1] = part
      k = k + 1
    end
  end
  return out
end

-- Up to the sign `stop`, which is taken; to the end without one.
function reader:row(stop)
  local parts, loose, wide = {}, true, false
  while true do
    local sign = self:peek()
    if not sign then
      if stop then error {formula = ("'%s' is missing"):format(stop)} end
      break
    end
    if sign == stop then
      self:take()
      break
    elseif sign:match "^%s" then
      self:take()
      loose, wide = true, #sign > 1
    elseif sign == "/" then
      self:take()
      parts[#parts + 1] = {slash = true, spaced = loose}
      loose, wide = false, false
    else
      self.spaced_dot = loose and (self:peek(1) or "x"):match "^%s" ~= nil
      local part = self:factor()
      part.loose, part.wide = loose, wide
      parts[#parts + 1] = part
      loose, wide = false, false
    end
  end
  local html = {}
  local done = fractions(parts)
  for k, part in ipairs(done) do
    if part.wide and k > 1 then html[#html + 1] = '<mspace width="1.5em"/>' end
    local before = done[k - 1]
    if part.loose and not part.wide and before
      and (part.kind == "text" and before.kind ~= "big" or before.kind == "text" or before.kind == "function") then
      html[#html + 1] = '<mspace width="0.3em"/>'
    elseif part.loose and before and part.kind == "function" and before.kind == "factor" then
      html[#html + 1] = '<mspace width="0.2em"/>'
    elseif part.loose and not part.wide and before and part.kind ~= "operator" and before.kind ~= "operator" then
      html[#html + 1] = '<mspace width="0.12em"/>'
    end
    html[#html + 1] = part.html
  end
  return table.concat(html)
end

--- MathML of one formula; nil and a sentence where it holds what is not known.
function formula.mathml(text, display)
  local signs, message = signs_of(text)
  if not signs then return nil, message end
  local own = setmetatable({signs = signs, at = 1}, reader)
  local ok, result = pcall(own.row, own)
  if not ok then
    if type(result) ~= "table" then error(result, 0) end
    return nil, result.formula
  end
  return ("<math%s>%s</math>"):format(display and ' display="block"' or "", result)
end

-- Running text: which words are formulas. A word is one where each of its letters stands alone, is of an index or
-- a power, or belongs to a function; `of`, `is` and `5 mm` are not.
local between = {} -- signs between two operands
for sign in ("+ - − ± × · ⊗ : = ≈ ≠ ≤ ≥ < > / → ↦ ∈ ∝ <= >="):gmatch "%S+" do between[sign] = true end
local prose = {a = true, A = true, I = true, C = true} -- words of English, and a language
local verbal = {mean = true, sign = true, log = true, min = true, max = true, clamp = true} -- words, and functions
local units = {m = true, N = true, s = true, J = true, K = true, W = true, g = true}

-- Whether a word without its punctuation is an operand, or a part of one in brackets.
local function operand(word)
  if not word:find "[%w\128-\255]" or word:find '["#&]' then return false end
  if word:find "\226\128[\147\148\156\157]" then return false end -- dashes and quotes
  if word:find "^%(%d+%a?%)$" then return false end -- the number of an equation
  local bare = word:gsub("[_^]{[^}]*}", ""):gsub("[_^]%-?[%w,]+", "")
  if verbal[bare] then return false end
  for run in bare:gmatch "%a+" do
    local known = #run == 1 or functions[run] or greek[run] or run:match "^d%a$" or run == "sqrt"
    if not known then return false end
  end
  return signs_of(bare) ~= nil
end

local function balance(word)
  local open = 0
  for sign in word:gmatch "[%(%)%[%]]" do open = open + ((sign == "(" or sign == "[") and 1 or -1) end
  return open
end

-- Whether a word has a sign that only formulas have: an index, a power, an integral, a root or a derivative.
-- Powers of ten and units such as m² are no formulas.
local marks = {}
for sign in ("√ ∂ ∇ ‖ ′ ″ ½ − ·"):gmatch "%S+" do marks[sign] = true end
local function marked(word)
  for sign in word:gmatch "[\194-\244][\128-\191]*" do
    if subscripts[sign] or big[sign] or accents[sign] or composed[sign] or marks[sign] then return true end
    if superscripts[sign] and sign ~= "²" and sign ~= "³" and word:find "%a" then return true end
  end
  return false
end

local function decoded(text) return (text:gsub("&lt;", "<"):gsub("&gt;", ">")) end

-- Words of a text as {text, space = before it, core = without punctuation, tail = that punctuation}.
local function words_of(text)
  local words = {}
  for space, word in text:gmatch "(%s*)(%S+)" do
    local plain = decoded(word)
    local core, tail = plain:match "^(.-)([%.,;:]*)$"
    if core == "" then core, tail = plain, "" end
    words[#words + 1] = {text = word, space = space, core = core, tail = tail}
  end
  return words
end

-- The last word of the formula that begins with word k, or nil; and whether the formula is worth setting.
local function extent(words, k)
  local last, open, telling, n = nil, 0, false, k
  local expects = true -- an operand, after an operator
  while words[n] do
    local core, tail = words[n].core, words[n].tail
    local sign_follows = words[n + 1] and between[words[n + 1].core]
    if between[core] and tail == "" then
      if n == k and core ~= "-" and core ~= "±" then return nil end
      telling, expects = true, true
    elseif big[core] or operand(core) then
      if prose[core] and not sign_follows and (n == k or not expects and open == 0) then break end
      open = open + balance(core)
      if open < 0 then break end
      if core:find "[_^|=+/]" or core:find "%a%(" or big[core] or marked(core) then telling = true end
      if open == 0 and not big[core] then last = n end
      if open == 0 and tail ~= "" then break end
      expects = false
    else
      break
    end
    n = n + 1
  end
  return last, telling
end

-- MathML of words k to last; nil where that is no formula.
local function set_words(words, k, last)
  local parts = {}
  for n = k, last do parts[#parts + 1] = words[n].core .. (n < last and words[n].tail or "") end
  local text = table.concat(parts, " ")
  if not text:find "%a" and not text:find "[\206-\207]" then return nil end
  local unit = last > k and units[parts[#parts]] and parts[#parts - 1]:match "^%d[%d%.]*$"
  if unit then text = table.concat(parts, " ", 1, #parts - 1) end
  local html = formula.mathml(text)
  return html and html .. (unit and " " .. parts[#parts] or "")
end

local function inline_text(text)
  local words, out, k = words_of(text), {}, 1
  while words[k] do
    local word = words[k]
    local html
    local last, telling = extent(words, k)
    if last then
      -- a letter on its own, but not the unit behind a number
      local alone = last == k and word.core:match "^%a$" or letters[word.core]
      local number = words[k - 1] and words[k - 1].core:match "^[%d%.]+$"
      if telling or alone and not number then html = set_words(words, k, last) end
    end
    if html then
      out[#out + 1] = word.space .. html .. words[last].tail
      k = last + 1
    else
      out[#out + 1] = word.space .. word.text
      k = k + 1
    end
  end
  return table.concat(out) .. text:match "%s*$"
end

--- HTML of a theory page's running text: formulas such as K u = f, w_ij, R^T and single letters as MathML.
function formula.inline(html)
  local inside = nil -- the element whose text stays as it is
  return (html:gsub("(<?)([^<>]*)(>?)", function(open, text, close)
    if open == "<" and close == ">" then
      local slash, name = text:match "^(/?)(%a+%d?)"
      if inside then
        if slash == "/" and name == inside then inside = nil end
      elseif slash == "" and (name == "pre" or name == "code" or name == "math" or name == "a" or name == "h1"
        or name == "h2" or name == "h3") then
        inside = name
      end
    elseif not inside and text:find "%S" then
      return open .. inline_text(text) .. close
    end
  end))
end

--- A block of formulas: each line one row, whose parts (three spaces apart) wrap in narrow windows.
function formula.block(text)
  local lines = {}
  for line in text:gmatch "[^\n]+" do
    local parts = {}
    for part in (line .. "   "):gmatch "(.-)   +" do
      if part:find "%S" then
        local html, message = formula.mathml(part:match "^%s*(.-)%s*$", true)
        if not html then return nil, ("formula '%s': %s"):format(part, message) end
        parts[#parts + 1] = html
      end
    end
    lines[#lines + 1] = '<div class="formula">' .. table.concat(parts) .. "</div>"
  end
  return table.concat(lines, "\n")
end

return formula
