// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Opens reports in headless Chromium and uses them: turns the model, moves the sliders, plays a
// mode, clicks a row. Prints "ok NAME" or "not ok NAME", as the test command counts them.
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { accessible } from "./accessible.mjs";
import { detail } from "./detail.mjs";
import { fit } from "./fit.mjs";
import { live } from "./live.mjs";
import { liveMore } from "./live_more.mjs";
import { plane } from "./plane.mjs";
import { site } from "./site.mjs";
import { study } from "./study.mjs";
import { workbench } from "./workbench.mjs";
import { workbenchTasks } from "./workbench_tasks.mjs";

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const { chromium } = await import(path.join(root, "web/node_modules/playwright-core/index.mjs"));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), "barwright-pages-"));
let failures = 0;

async function test(name, body) {
  try {
    await body();
    console.log(`ok ${name}`);
  } catch (error) {
    failures++;
    console.log(`not ok ${name}`);
    console.log(`  ${error.stack}`);
  }
}

function assert(condition, message) {
  if (!condition) throw new Error(message);
}

// Waits until a condition holds; the bound is for a machine that is busy.
async function until(condition, message) {
  for (const since = Date.now(); !(await condition()); await page.waitForTimeout(30))
    assert(Date.now() - since < 120000, message);
}

execFileSync(path.join(root, "build/barwright"), [path.join(root, "tests/pages/report.lua"), folder], {
  cwd: root,
  stdio: ["ignore", "inherit", "inherit"],
});

const browser = await chromium.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-gpu", "--use-gl=angle", "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});
const context = await browser.newContext({ viewport: { width: 1280, height: 900 } });
context.setDefaultTimeout(120000);
const page = await context.newPage();
const problems = [];
const requests = [];
page.on("pageerror", (error) => problems.push(error.message));
page.on("console", (line) => line.type() === "error" && problems.push(line.text()));
page.on("request", (request) => requests.push(request.url()));

const state = () => page.evaluate(() => window.barwright.state());
const distance = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));
const slide = (id, value) =>
  page.$eval(`#${id}`, (input, v) => {
    input.value = v;
    input.dispatchEvent(new Event("input"));
  }, value);

await page.goto(`file://${folder}/report.html`);
await page.waitForFunction(() => window.barwright);

await test("the report opens from disk without network or errors", async () => {
  assert(requests.every((url) => url.startsWith("file:") || url.startsWith("data:") || url.startsWith("blob:")),
    `asked for ${requests}`);
  assert(problems.length === 0, problems.join("; "));
  const now = await state();
  assert(now.triangles > 100, `${now.triangles} triangles`);
});

await test("the view shows the body in colours", async () => {
  const colours = await page.evaluate(() => {
    const source = document.querySelector("#view canvas");
    const copy = document.createElement("canvas");
    copy.width = source.width;
    copy.height = source.height;
    const pen = copy.getContext("2d");
    pen.drawImage(source, 0, 0);
    const pixels = pen.getImageData(0, 0, copy.width, copy.height).data;
    const seen = new Set();
    let body = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      const [r, g, b] = pixels.slice(i, i + 3);
      if (Math.max(r, g, b) - Math.min(r, g, b) > 30) body++;
      seen.add((r >> 4) * 256 + (g >> 4) * 16 + (b >> 4));
    }
    return { fraction: body / (pixels.length / 4), count: seen.size };
  });
  assert(colours.fraction > 0.02, `only ${colours.fraction} of the view is coloured`);
  assert(colours.count > 20, `only ${colours.count} colours`);
});

await test("dragging turns the model", async () => {
  const before = await state();
  const box = await page.locator("#view canvas").boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.mouse.down();
  await page.mouse.move(box.x + box.width / 2 + 180, box.y + box.height / 2 + 40, { steps: 6 });
  await page.mouse.up();
  const radius = Math.hypot(...before.camera);
  await until(async () => distance(before.camera, (await state()).camera) > 0.2 * radius, "the camera did not move");
});

await test("the deformation slider moves the shape", async () => {
  await slide("scale", 0);
  const rest = await state();
  await slide("scale", 2);
  const deformed = await state();
  assert(distance(rest.first, deformed.first) > 0, "the first point stayed");
});

await test("the field selector and the colour range recolour", async () => {
  const label = async () => page.textContent("#high");
  const before = await label();
  await slide("range", 0.5);
  const after = await label();
  assert(before !== after, `the end of the bar stayed ${before}`);
  const options = await page.$$eval("#field option", (all) => all.length);
  assert(options >= 2, `${options} fields`);
  await page.selectOption("#field", String(options - 1));
  assert((await state()).field === options - 1, "the field did not change");
});

await test("a mode swings and stops", async () => {
  const mode = await page.$$eval("#motion option", (all) => all.findIndex((o) => /mode/i.test(o.textContent) && /Hz/.test(o.textContent)));
  assert(mode >= 0, "no mode is listed");
  await page.selectOption("#motion", String(mode));
  const first = await state();
  assert(first.playing, "a mode should play");
  await until(async () => first.phase !== (await state()).phase, "the phase stands still");
  await page.click("#play");
  assert(!(await state()).playing, "Pause does not pause");
});

await test("a row of the table shows its load with arrows", async () => {
  await page.click('tr[data-motion="0"]');
  const now = await state();
  assert(now.motion === 0, `motion ${now.motion}`);
  assert(now.arrows >= 2, `${now.arrows} arrows: a balanced load needs two or more`);
});

await test("the largest ten rows come first, in order of stress, and the keyboard chooses them", async () => {
  const stress = await page.$$eval("table.ranked tbody tr", (rows) => rows.map((row) => {
    const [value, unit] = row.cells[2].textContent.split(" ");
    return Number(value) * { Pa: 1, kPa: 1e3, MPa: 1e6, GPa: 1e9 }[unit];
  }));
  assert(stress.length > 1 && stress.slice(1).every((s, i) => s <= stress[i]), `not in order: ${stress}`);
  const visible = () => page.$$eval("table.ranked tbody tr", (rows) => rows.filter((row) => !row.hidden).length);
  assert((await visible()) === Math.min(10, stress.length), `${await visible()} rows are shown`);
  if (stress.length > 10) {
    await page.click("#more");
    assert((await visible()) === stress.length, "not all rows are shown");
  }
  await page.focus('tr[data-motion="0"]');
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  assert((await state()).motion === 1, `motion ${(await state()).motion}`);
  const before = await state();
  await page.focus("#view");
  await page.keyboard.press("ArrowLeft");
  await until(async () => distance(before.camera, (await state()).camera) > 0.01 * Math.hypot(...before.camera),
    "the arrow key does not turn the view");
});

await test("the head has the verdict; colours go up to the strength, the largest displacement is 4 %", async () => {
  const first = (await page.textContent(".verdict .word")).trim();
  assert(first.length > 3, "no verdict");
  await page.click('tr[data-motion="0"]');
  await slide("scale", 1);
  const now = await state();
  const drawn = now.shown * now.largest;
  const diagonal = Math.hypot(0.1, 0.02, 0.01);
  assert(Math.abs(drawn / diagonal - 0.04) < 1e-4, `drawn ${drawn} of ${diagonal}`);
  await page.keyboard.press("t");
  await page.focus("#view");
  await page.keyboard.press("t");
  assert(Math.abs((await state()).shown - 1) < 1e-6, `T shows × ${(await state()).shown}`);
  await slide("range", 1);
  await page.selectOption("#field", "0");
  assert((await page.textContent("#high")).endsWith("53.00"), await page.textContent("#high"));
  await page.selectOption("#top", "own");
  assert(!(await page.textContent("#high")).endsWith("53.00"), "the range stays that of the strength");
});

await test("arrows that pull start on the body, those that push end there, and both follow it", async () => {
  await page.goto(`file://${folder}/pulled.html`);
  await page.waitForFunction(() => window.barwright);
  await slide("scale", 0);
  const [pull, ...push] = (await state()).arrowEnds;
  assert(Math.abs(pull[0][0] - 0.1) < 1e-6 && pull[1][0] > 0.11, `pulls from ${pull[0]} to ${pull[1]}`);
  assert(push.length > 0, "no pressure");
  for (const [tail, tip] of push)
    assert(Math.abs(tip[2] - 0.01) < 1e-6 && tail[2] > 0.01, `presses from ${tail} to ${tip}`);
  await slide("scale", 1);
  const moved = (await state()).arrowEnds[0];
  assert(distance(pull[0], moved[0]) > 0.003, `the arrow stays at ${moved[0]}`);
  assert(problems.length === 0, problems.join("; "));
});

await test("the report of a session shows the shape as it was drawn, in its true size", async () => {
  await page.goto(`file://${folder}/session.html`);
  await page.waitForFunction(() => window.barwright);
  const drawn = await page.$$eval("#motion option", (all) => all.findIndex((o) => /as it was drawn/.test(o.textContent)));
  assert(drawn >= 0, "it is not listed");
  await page.selectOption("#motion", String(drawn));
  await slide("scale", 0);
  const edited = await state();
  await slide("scale", 1);
  const before = await state();
  const moved = distance(edited.first, before.first);
  assert(Math.abs(moved - Math.hypot(0.005, 0.0025)) < 1e-6, `the first corner moved by ${moved}`);
  assert(/scale\{1\.5, 1\.5, 1\.5\}/.test(await page.textContent("body")), "the edit is not listed");
  assert(problems.length === 0, problems.join("; "));
});

await test("a motion in time plays, stops, shows any instant with its time, and its true scale", async () => {
  await page.goto(`file://${folder}/motion.html`);
  await page.waitForFunction(() => window.barwright);
  const first = await state();
  assert(first.playing, "a motion should play");
  await until(async () => first.frame !== (await state()).frame, "the frame stands still");
  await page.click("#play");
  const stopped = (await state()).frame;
  await page.waitForTimeout(300);
  assert(!(await state()).playing && (await state()).frame === stopped, "Pause does not pause");
  await page.click("#play");
  await until(async () => (await state()).frame !== stopped, "Play does not go on");
  await slide("time", 39);
  const last = await state();
  assert(!last.playing && last.frame === 39, `frame ${last.frame}`);
  assert(/^10\.00 of 10\.00 ms$/.test(await page.textContent("#timetext")), await page.textContent("#timetext"));
  const high = await page.textContent("#high");
  if (process.env.BARWRIGHT_PICTURES)
    await page.screenshot({ path: path.join(process.env.BARWRIGHT_PICTURES, "motion.png") });
  await page.click("#true");
  assert((await page.textContent("#scaletext")) === "× 1.000", await page.textContent("#scaletext"));
  await slide("time", 0);
  assert(/^0\.000 of/.test(await page.textContent("#timetext")), await page.textContent("#timetext"));
  assert((await page.textContent("#high")) === high, "the range of colours changes in time");
  assert(problems.length === 0, problems.join("; "));
});

await test("without WebGL the view says so, and the answer is there", async () => {
  const plain = await context.newPage();
  await plain.addInitScript(() => { HTMLCanvasElement.prototype.getContext = () => null; });
  await plain.goto(`file://${folder}/report.html`);
  const view = await plain.textContent("#view");
  assert(view === "The 3D view needs WebGL, which this browser does not offer.", view);
  assert((await plain.textContent(".answer")).length > 20, "no answer");
  await plain.close();
});

await test("the page of a vibration swings through both parts of the deflection, and its modes by their rows", async () => {
  await page.goto(`file://${folder}/respond.html`);
  await page.waitForFunction(() => window.barwright);
  assert((await state()).playing, "the deflection should swing");
  await until(async () => Math.abs((await state()).behind) > 0.3, "the phase stands still");
  await page.click("#play");
  const largest = await state();
  assert(largest.phase === 1 && largest.behind === 0, `stops at ${largest.phase}, ${largest.behind}`);
  assert(!(await page.isDisabled("#true")), "a deflection has a true scale");
  assert((await page.$$("figure > svg")).length === 2, "two plots");
  await page.click("tr[data-motion]:nth-child(2)");
  const mode = await page.$eval("#motion", (select) => select.selectedOptions[0].textContent);
  assert(/^mode 2: /.test(mode), mode);
  assert(problems.length === 0, problems.join("; "));
  if (process.env.BARWRIGHT_PICTURES)
    await page.screenshot({ path: path.join(process.env.BARWRIGHT_PICTURES, "respond.png"), fullPage: true });
});

await test("the page of a warm part shows its temperature, and no controls of motions", async () => {
  await page.goto(`file://${folder}/warm.html`);
  await page.waitForFunction(() => window.barwright);
  assert((await page.textContent("#unit")) === "C", await page.textContent("#unit"));
  assert(Math.abs(Number(await page.textContent("#high")) - 80) < 0.1, await page.textContent("#high"));
  for (const id of ["shape", "deformation", "play", "true"])
    assert(!(await page.isVisible(`#${id}`)), `${id} is there`);
  assert(/Balance of heat/.test(await page.textContent("body")), "no balance");
  assert(problems.length === 0, problems.join("; "));
  if (process.env.BARWRIGHT_PICTURES)
    await page.screenshot({ path: path.join(process.env.BARWRIGHT_PICTURES, "warm.png"), fullPage: true });
});

await fit({ root, test, assert });
await detail({ browser, root, folder, test, assert, pictures: process.env.BARWRIGHT_PICTURES });
// With BARWRIGHT_PICTURES=FOLDER pictures of the live view are left there, to be looked at.
await study({ browser, root, folder, test, assert, pictures: process.env.BARWRIGHT_PICTURES });
await site({ browser, root, folder, test, assert, pictures: process.env.BARWRIGHT_PICTURES });
await accessible({ browser, root, folder, test, assert, pictures: process.env.BARWRIGHT_PICTURES });
await liveMore({ browser, root, folder, test, assert, pictures: process.env.BARWRIGHT_PICTURES });
await workbench({ browser, root, folder, test, assert, pictures: process.env.BARWRIGHT_PICTURES });
await workbenchTasks({ browser, root, folder, test, assert, pictures: process.env.BARWRIGHT_PICTURES });
await live({ browser, root, folder, test, assert, pictures: process.env.BARWRIGHT_PICTURES });
await plane({ browser, root, folder, test, assert, pictures: process.env.BARWRIGHT_PICTURES });

await browser.close();
fs.rmSync(folder, { recursive: true });
process.exit(failures ? 1 : 0);
