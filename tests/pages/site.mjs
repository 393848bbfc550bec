// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The documentation as a site, in headless Chromium: opened from disk, read, searched.
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";

export async function site({ browser, root, folder, test, assert, pictures }) {
  const out = path.join(folder, "site");
  execFileSync(path.join(root, "build/barwright"), [path.join(root, "scripts/site/run.lua"), "--out", out], { cwd: root });
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  const problems = [], requests = [];
  page.on("pageerror", (error) => problems.push(error.message));
  page.on("console", (line) => line.type() === "error" && problems.push(line.text()));
  page.on("request", (request) => requests.push(request.url()));
  const files = fs.readdirSync(out, { recursive: true }).filter((name) => name.endsWith(".html"));

  await test("no page of the site has errors, uses the network or needs scrolling for its code", async () => {
    const wide = [];
    for (const name of files) {
      await page.goto(`file://${out}/${name}`);
      wide.push(...await page.evaluate((name) => [...document.querySelectorAll("pre")]
        .filter((block) => block.scrollWidth > block.clientWidth + 1)
        .map((block) => `${name}: ${block.textContent.slice(0, 60)}`), name));
    }
    assert(files.length > 50, `${files.length} pages`);
    assert(problems.length === 0, problems.join("; "));
    assert(requests.every((url) => url.startsWith("file://")), requests.filter((url) => !url.startsWith("file://")));
    assert(wide.length === 0, wide.join("\n"));
  });

  await test("the site sets formulas as mathematics, and lists tutorials first", async () => {
    await page.goto(`file://${out}/docs/theory/worst_case.html`);
    const heights = await page.evaluate(() => [...document.querySelectorAll(".formula math")]
      .map((math) => math.getBoundingClientRect().height));
    assert(heights.length > 20 && heights.every((height) => height > 8), `${heights}`);
    // A fraction is higher than a line of text only where the browser knows MathML.
    assert(await page.evaluate(() => [...document.querySelectorAll(".formula mfrac")]
      .some((part) => part.getBoundingClientRect().height > 24)), "fractions are set in one line");
    const title = await page.locator("#pages h2, #pages h3, #pages strong").first().textContent();
    assert(/tutorials/i.test(title), title);
    if (pictures) await page.screenshot({ path: `${pictures}/site.png` });
  });

  await test("the search of the site finds words of whole pages and leads to their section", async () => {
    await page.goto(`file://${out}/index.html`);
    await page.fill("#search", "comes on top scatter");
    const first = page.locator("#found a").first();
    assert(/Validity/.test(await first.textContent()), await first.textContent());
    await first.click();
    assert(/validity\.html#/.test(page.url()), page.url());
    await page.fill("#search", "xyzzy");
    await page.locator("#found", { hasText: "No section" }).waitFor();
  });

  await test("the search of the site answers words that were typed before its script ran", async () => {
    await page.route("**/site.js", async (route) => {
      await page.fill("#search", "xyzzy");
      await route.continue();
    });
    await page.goto(`file://${out}/index.html`);
    await page.locator("#found", { hasText: "No section" }).waitFor();
    await page.unroute("**/site.js");
  });
  await page.close();
}
