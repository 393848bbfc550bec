// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Accessibility of all kinds of pages by axe-core, in light and dark; the view by keyboard and by touch.
import { spawnSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import { serve } from "./live_driver.mjs";

const words = (found) => found.map((one) => `${one.id} (${one.impact}): ${one.help}\n${one.nodes.slice(0, 4)
  .map((node) => `    ${node.target}: ${node.html.slice(0, 160)} ${node.failureSummary.split("\n").slice(1, 2)}`).join("\n")}`).join("\n");

export async function accessible({ browser, root, folder, test, assert, pictures }) {
  const source = fs.readFileSync(path.join(root, "web/node_modules/axe-core/axe.min.js"), "utf8");
  const own = fs.mkdtempSync(path.join(folder, "axe-"));
  const run = (...given) => spawnSync(path.join(root, "build/barwright"), given, { cwd: root, encoding: "utf8" });
  const look = async (context, name, url, ready) => {
    const page = await context.newPage();
    page.setDefaultTimeout(120000);
    await page.goto(url);
    if (ready) await page.waitForFunction(ready);
    await page.evaluate(source);
    const { violations } = await page.evaluate(() => globalThis.axe.run(document));
    const dark = await page.evaluate(() => globalThis.matchMedia("(prefers-color-scheme: dark)").matches);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
    if (pictures) await page.screenshot({ path: path.join(pictures, `axe_${name}_${dark ? "dark" : "light"}.png`) });
    await page.close();
    return [violations.length ? `${name}${dark ? ", dark" : ""}: ${words(violations)}` : "",
      wide > 1 ? `${name} is ${wide} pixels wider than the window` : ""].filter((text) => text).join("\n");
  };

  const bar = path.join(folder, "bar.msh");
  const made = [
    ["drop", ["drop", bar, "--material", "pla", "--height", "1m", "--down", "0,0,-1", "--report", `${own}/drop.html`]],
    ["buckle", ["buckle", bar, "--material", "pla", "--fix", "min:x", "--force", "max:x=-10,0,0", "--report", `${own}/buckle.html`]],
    ["scenarios", ["test", "scenarios/verification/10_statics.lua", "--out", `${own}/scenarios`]],
  ];
  const pages = ["report", "session", "pulled", "motion", "respond", "warm"].map((name) => [name, `${folder}/${name}.html`]);
  for (const [name, given] of made) {
    const { stdout, stderr } = run(...given);
    const file = [`${own}/${name}.html`, `${own}/${name}/index.html`].find((one) => fs.existsSync(one));
    if (file) pages.push([name, file]);
    else console.log(`# ${name}: ${stderr || stdout}`.slice(0, 400));
  }
  for (const [name, file] of [["study", "study.html"], ["site", "site/index.html"]])
    if (fs.existsSync(path.join(folder, file))) pages.push([name, path.join(folder, file)]);

  for (const colorScheme of ["light", "dark"]) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, bypassCSP: true, colorScheme });
    await test(`axe finds nothing on pages from files, ${colorScheme}`, async () => {
      const faults = [];
      for (const [name, file] of pages) faults.push(await look(context, name, `file://${file}`));
      const said = faults.filter((text) => text).join("\n");
      assert(said === "", said);
    });
    await context.close();
  }

  for (const [name, file] of [["live", "tests/lua/live_session.lua"], ["plate", "tests/lua/live_plane/steady.lua"],
    ["bar", "tests/lua/live_plane/bar.lua"], ["flow", "tests/lua/live_plane/flow.lua"]]) {
    if (!fs.existsSync(path.join(root, file))) continue;
    const copy = path.join(own, `${name}.lua`);
    fs.copyFileSync(path.join(root, file), copy);
    const server = serve(root, copy);
    const address = await server.address;
    await test(`axe finds nothing on the live page of ${name}, light, dark and on a phone`, async () => {
      for (const [colorScheme, width, height] of [["light", 1280, 860], ["dark", 820, 1180], ["dark", 390, 844]]) {
        const context = await browser.newContext({ viewport: { width, height }, bypassCSP: true, colorScheme });
        const fault = await look(context, `${name}${width}`, address, () => window.barwright?.state().revision > 0);
        await context.close();
        assert(fault === "", fault);
      }
    });
    server.child.kill("SIGKILL");
  }

  await test("the view of a report is turned and zoomed by keyboard and by touch, on a phone", async () => {
    const context = await browser.newContext({ viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true });
    const page = await context.newPage();
    page.setDefaultTimeout(120000);
    await page.goto(`file://${folder}/report.html`);
    await page.waitForFunction(() => window.barwright);
    const camera = async () => (await page.evaluate(() => window.barwright.state())).camera;
    const far = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));
    const canvas = page.locator("#view canvas");
    await canvas.focus();
    const first = await camera();
    await page.keyboard.press("ArrowLeft");
    const turned = await camera();
    assert(far(first, turned) > 0.01 * Math.hypot(...first), "ArrowLeft does not turn it");
    await page.keyboard.press("-");
    assert(far(turned, await camera()) > 0.1 * Math.hypot(...first), "- does not zoom");
    await page.keyboard.press("Home");
    assert(far(first, await camera()) < 1e-6, "Home does not show all of it");
    const box = await canvas.boundingBox();
    const session = await context.newCDPSession(page);
    const touch = (type, x, y) => session.send("Input.dispatchTouchEvent",
      { type, touchPoints: type === "touchEnd" ? [] : [{ x, y }] });
    const [x, y] = [box.x + 100, Math.min(box.y + 80, 800)];
    await touch("touchStart", x, y);
    for (let k = 1; k < 8; k++) await touch("touchMove", x + 12 * k, y + 2 * k);
    await touch("touchEnd");
    assert(far(first, await camera()) > 0.05 * Math.hypot(...first), "a finger does not turn it");
    if (pictures) await page.screenshot({ path: path.join(pictures, "report_phone.png"), fullPage: true });
    await context.close();
  });
}
