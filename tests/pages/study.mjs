// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// A study's report in headless Chromium: opened from disk, sorted, searched, printed.
import { execFileSync } from "node:child_process";
import path from "node:path";

export async function study({ browser, root, folder, test, assert, pictures }) {
  execFileSync(path.join(root, "build/barwright"), [path.join(root, "tests/pages/study.lua"), folder], { cwd: root });
  const page = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  const problems = [];
  const requests = [];
  page.on("pageerror", (error) => problems.push(error.message));
  page.on("console", (line) => line.type() === "error" && problems.push(line.text()));
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(`file://${folder}/study.html`);
  const table = page.locator("#trials ~ .scroll table");
  const column = (n) => table.locator(`tbody tr:not([hidden]) td:nth-child(${n})`).allTextContents();

  await test("a study's report opens from disk without network or errors", async () => {
    assert(problems.length === 0, problems.join("; "));
    assert(requests.length === 1, `asked for ${requests}`);
    assert(await page.locator("figure > svg").count() === 5, "front, two histories, matrix, coordinates");
    if (pictures) await page.screenshot({ path: `${pictures}/study.png`, fullPage: true });
  });

  await test("its plots lie within the page, texts within their plots", async () => {
    const outside = await page.evaluate(() => [...document.querySelectorAll("figure > svg")].flatMap((svg) => {
      const frame = svg.getBoundingClientRect();
      return [...svg.querySelectorAll("text")].filter((text) => {
        const box = text.getBoundingClientRect();
        return box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 1 || box.bottom > frame.bottom + 1;
      }).map((text) => text.textContent);
    }));
    assert(outside.length === 0, `outside: ${outside}`);
    assert(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "the page is too wide");
  });

  await test("its table of trials sorts by numbers, what is missing last", async () => {
    await table.locator("th button", { hasText: "mass" }).click();
    const up = (await column(5)).filter((text) => text !== "").map(parseFloat);
    assert(up.length === 111 && up.every((x, i) => i === 0 || x >= up[i - 1]), `${up}`);
    assert((await column(5)).slice(-9).every((text) => text === ""), "missing last");
    await table.locator("th button", { hasText: "mass" }).click();
    assert(parseFloat((await column(5))[0]) === up.at(-1), "downwards");
    assert(await table.locator("th[aria-sort=descending]").count() === 1, "aria-sort");
  });

  await test("its table of trials can be searched", async () => {
    await page.fill("#filter", "crosses itself");
    assert((await column(1)).length === 7, "seven failed");
    assert((await page.textContent("#shown")) === "7 of 120", "count");
    await page.fill("#filter", "");
    assert((await column(1)).length === 120, "all again");
  });

  await test("it prints whole tables", async () => {
    await page.emulateMedia({ media: "print" });
    const cut = await page.evaluate(() => [...document.querySelectorAll(".scroll")].some((box) => box.scrollHeight > box.clientHeight + 1));
    assert(!cut, "a table is cut");
    await page.emulateMedia({ media: "screen" });
  });
  await page.close();
}
