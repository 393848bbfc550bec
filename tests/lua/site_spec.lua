-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- The documentation's site: every page has its place, every link leads somewhere.
package.path = "scripts/site/?.lua;" .. package.path
local check = require "check"

describe("site", function()
  it("is made whole: no page left out, no link to nowhere", function()
    if not os.execute "command -v cmark-gfm >/dev/null 2>&1" then return pending "cmark-gfm is not installed" end
    local folder = os.tmpname()
    os.remove(folder)
    local pipe = assert(io.popen(("build/barwright scripts/site/run.lua --out '%s' 2>&1"):format(folder)))
    local said = pipe:read "a"
    local ok = pipe:close()
    assert.is_true(ok, said)
    assert.truthy(said:find("0 problems", 1, true), said)
    local index = check.read(folder .. "/index.html")
    assert.truthy(index:find('<a href="docs/tutorial.html"', 1, true))
    assert.falsy(index:find("@%u+@"))
    local search = check.read(folder .. "/search.js")
    assert.truthy(search:find("Weak regions", 1, true) or search:find("weak regions", 1, true))
    assert.truthy(search:find("comes on top", 1, true), "search has whole sections")
    local theory = check.read(folder .. "/docs/theory/data_driven.html")
    assert.truthy(theory:find('<div class="formula"><math display="block">', 1, true))
    assert.falsy(theory:find("<pre><code>", 1, true))
    assert.truthy(theory:find("<msub><mi>J</mi><mi>i</mi></msub>", 1, true))
    local lesson = check.read(folder .. "/examples/01_where_will_it_break.html")
    assert.truthy(lesson:find('<span class="word">local</span>', 1, true))
    os.execute(("rm -rf '%s'"):format(folder))
  end)

  it("sets formulas as MathML", function()
    local formula = require "formula"
    local function set(text) return (formula.mathml(text):gsub("</?mrow>", ""):gsub("</?math>", "")) end
    assert.equal("<mfrac><mi>a</mi><mo>+</mo><mi>b</mi><mn>2</mn></mfrac>", set "(a + b) / 2")
    assert.equal("<msup><mi>x</mi><mi>n</mi><mo>−</mo><mn>1</mn></msup>", set "x^(n - 1)")
    assert.equal("<msub><mi>K</mi><mi>a</mi><mi>b</mi></msub><mo>=</mo><mi>λ</mi>", set "K_ab = lambda")
    assert.equal("<munder><mo>∑</mo><mi>e</mi></munder>", set "Σ_e")
    assert.equal("<msqrt><mn>2</mn><mi>π</mi></msqrt>", set "√(2π)")
    assert.truthy(set("1 / s(n)² such that x"):find("<mtext>such</mtext>", 1, true))
    local html, message = formula.mathml "a § b"
    assert.is_nil(html)
    assert.truthy(message:find("'§' is not known", 1, true))
    assert.is_nil((formula.mathml "(a + b"))
    assert.equal("<p>sum <math><msub><mi>w</mi><mrow><mi>i</mi><mi>j</mi></mrow></msub></math> of "
      .. "<code>w_i</code></p>", formula.inline "<p>sum w_ij of <code>w_i</code></p>")
  end)

  it("finds formulas in running text", function()
    local formula = require "formula"
    -- Each formula as its bare text in brackets.
    local function found(text)
      return (formula.inline(text):gsub("<math>(.-)</math>", function(html)
        return "[" .. html:gsub("<[^>]*>", "") .. "]"
      end))
    end
    assert.equal("so [Ku=f], and a force [F] on [∂Ω].", found "so K u = f, and a force F on ∂Ω.")
    assert.equal("the mean [r(x)=t+ω×x] of (14), 5 mm", found "the mean r(x) = t + ω × x of (14), 5 mm")
    assert.equal("[0≤p≤pmax], where", found "0 ≤ p &lt;= p_max, where")
    assert.equal("[RTRT] and 10⁻³ of 5 m² are [−12sθ1]", (found "R T Rᵀ and 10⁻³ of 5 m² are −½ s_θ1"))
    assert.equal("A body in C; [2μ+λ] of I; 3 N and a lot", found "A body in C; 2 μ + λ of I; 3 N and a lot")
    assert.equal("<a>see K u = f</a> <code>K u</code>", found "<a>see K u = f</a> <code>K u</code>")
  end)

  it("colours Lua without changing it", function()
    local colour = require "colour"
    local source = "" ..
      'local a = [==[ x ]] ]==] -- "no text"\nb = \'it\\\'s\' .. 0x1F '
      .. '+ 1e-3 --[[ two\nlines ]] return a'
    local html = colour.lua(source, function(text) return text end)
    assert.equal(source, (html:gsub('<span class="%a+">', ""):gsub("</span>", "")))
    assert.truthy(html:find('<span class="text">[==[ x ]] ]==]</span>', 1, true))
    assert.truthy(html:find('<span class="comment">-- "no text"</span>', 1, true))
    assert.truthy(html:find('<span class="text">\'it\\\'s\'</span>', 1, true))
    assert.truthy(html:find('<span class="number">1e-3</span>', 1, true))
    assert.truthy(html:find('<span class="comment">--[[ two\nlines ]]</span>', 1, true))
  end)

  it("tells a link that leads nowhere", function()
    local links = require "links"
    assert.equal("docs/live.md", links.joined("docs/theory/", "../live.md"))
    local folder = os.tmpname()
    os.remove(folder)
    assert(os.execute("mkdir " .. folder))
    local file = assert(io.open(folder .. "/a.html", "w"))
    file:write '<h1 id="here"></h1> <a href="#here"></a> <a href="#there"></a> <a href="b.html"></a>'
    file:close()
    local problems = links.check(folder, {{source = "a.md", address = "a.html", there = true}})
    os.execute("rm -rf " .. folder)
    assert.equal(2, #problems)
    assert.truthy(problems[1]:find "no such section")
    assert.truthy(problems[2]:find "not there")
  end)
end)
