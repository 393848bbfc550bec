-- Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
-- What HTML pages are made of: nothing that a text contains becomes markup.
local check = require "check"
local html = require "barwright.html"

describe("an HTML page", function()
  it("escapes texts and keeps whole characters only", function()
    assert.equal("&lt;a b=&quot;c&quot; d=&#39;e&#39;&gt; &amp; \u{e9}\u{FFFD}",
      html.escape "<a b=\"c\" d='e'> & \u{e9}\xC3")
    assert.equal("3.5", html.escape(3.5))
    assert.equal(' class="a&quot;b" data-sort="2"', html.attributes {["data-sort"] = 2, class = 'a"b', "a cell"})
  end)

  it("makes tables of cells with attributes", function()
    assert.equal('<div class="scroll" tabindex="0"><table class="numbers">\n<thead><tr><th scope="col">a&amp;b'
      .. '</th></tr></thead>\n<tbody>\n<tr class="first"><td>1</td><td class="bad">&lt;2&gt;</td></tr>\n'
      .. "</tbody></table></div>\n",
      html.table({"a&b"}, {{class = "first", 1, {"<2>", class = "bad"}}}, "numbers"))
    assert.is_nil(html.table(nil, {{1}}):find("thead", 1, true))
    assert.equal("", html.list {})
    assert.equal("<ul><li>&lt;</li></ul>\n", html.list {"<"})
  end)

  it("embeds pictures, and leaves out those that are missing", function()
    local folder = check.folder()
    check.write(folder .. "/one.svg", "abc")
    assert.equal('<figure><img alt="a &lt;b&gt;" src="data:image/svg+xml;base64,YWJj"><figcaption>a &lt;b&gt;'
      .. "</figcaption></figure>\n", html.figure(folder .. "/one.svg", "a <b>"))
    assert.equal("", html.figure(folder .. "/two.svg", "nothing"))
  end)

  it("fills templates, and ends no script early", function()
    assert.equal("<%1> & {{b}}", html.fill("<{{a}}> & {{b}}", {a = "%1"}))
    assert.equal([[a <\/script>]], html.in_script "a </script>")
  end)

  it("sets Markdown, and keeps what is none", function()
    assert.equal("<p>The sum <code>a*b*c</code> is <strong>bold</strong>, 2*3 &lt; 7</p>",
      html.prose "The sum `a*b*c` is **bold**, 2*3 < 7")
    assert.equal('<p>x</p>\n<ul><li>one more</li><li><a href="https://a.b/c_d">two</a></li></ul>',
      html.prose "x\n\n- one\n  more\n- [two](https://a.b/c_d)")
  end)

  it("stands in one frame with one heading", function()
    local page = html.document {title = "A & B", body = "<p>x</p>", width = 50, style = "p { color: red }\n"}
    assert.equal(1, page:find("<!doctype html>\n<html lang=\"en\">", 1, true))
    assert.truthy(page:find("<title>A &amp; B</title>", 1, true))
    assert.truthy(page:find("<h1>A &amp; B</h1>\n<p>x</p></main></body></html>\n", 1, true))
    assert.truthy(page:find("max-width: 50rem", 1, true))
    assert.is_nil(page:find "https?://")
  end)
end)
