// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The workbench in headless Chromium: a part is opened, held, pushed, judged and changed with a real mouse and with the
// keyboard alone, against the engine; what needs no engine goes against a session of fixed numbers (workbench_mock.mjs).
import { execFileSync, spawn } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import { Mock } from "./workbench_mock.mjs";

const state = (page) => page.evaluate(() => window.barwright.state());

// page.waitForFunction evaluates text inside the page, which the page's policy forbids.
async function until(page, what, argument) {
  for (const since = Date.now(); Date.now() - since < 120000; await page.waitForTimeout(30))
    if (await page.evaluate(what, argument)) return;
  throw new Error(`in vain: ${what} with ${argument}; ${JSON.stringify({ ...(await state(page)), script: 0, faces: 0 })}`);
}

async function clickFace(page, number, options) {
  const place = await page.evaluate((n) => window.barwright.place(n), number);
  if (!place) throw new Error(`face ${number} is not seen`);
  await page.mouse.move(...place);
  if (options?.shift) await page.keyboard.down("Shift");
  await page.mouse.click(...place);
  if (options?.shift) await page.keyboard.up("Shift");
}

// The number of the face whose outward normal is nearest to a direction.
const facing = async (page, direction) => {
  const { faces } = await state(page);
  const along = (f) => (f.normal ? f.normal.reduce((sum, x, k) => sum + x * direction[k], 0) : -1);
  return faces.filter((f) => along(f) > 0.99).sort((a, b) => b.area - a.area)[0].index;
};

async function serve(root, file) {
  const child = spawn(path.join(root, "build/barwright"), ["open", file, "--no-open"],
    { cwd: root, env: { ...process.env, BARWRIGHT_QUIET: "1" } });
  let out = "";
  for (const stream of [child.stdout, child.stderr]) stream.on("data", (text) => (out += text));
  const ended = new Promise((resolve) => child.on("exit", resolve));
  for (const since = Date.now(); Date.now() - since < 60000; await new Promise((go) => setTimeout(go, 30))) {
    const found = out.match(/http:\/\/\S+/);
    if (found) return { child, ended, address: found[0], text: () => out };
    if (child.exitCode !== null) break;
  }
  throw new Error(`barwright open: ${out}`);
}

async function axe(page, root, assert) {
  await page.addScriptTag({ path: path.join(root, "web/node_modules/axe-core/axe.min.js") }).catch(async () => {
    await page.evaluate(fs.readFileSync(path.join(root, "web/node_modules/axe-core/axe.min.js"), "utf8"));
  });
  const { violations } = await page.evaluate(() => window.axe.run(document));
  assert(violations.length === 0, violations.map((v) => `${v.id}: ${v.help}: ${v.nodes.map((n) => n.target).join(" ")}`).join("\n  "));
}

async function withEngine({ browser, root, folder, test, assert, pictures }) {
  const own = fs.mkdtempSync(path.join(folder, "workbench-"));
  const file = path.join(own, "beam.stl");
  execFileSync(path.join(root, "build/barwright"), ["-e", `local bw = require "barwright"
    local mesh = assert(bw.mesh.box {min = {0, 0, 0}, max = {0.08, 0.02, 0.01}, cells = {8, 2, 1}})
    assert(mesh:surface():write("${file}"))`], { cwd: root });
  const server = await serve(root, file);
  const context = await browser.newContext({ viewport: { width: 1280, height: 860 }, acceptDownloads: true });
  const problems = [];
  const open = async () => {
    const page = await context.newPage();
    page.on("pageerror", (error) => problems.push(error.message));
    page.on("console", (line) => line.type() === "error" && problems.push(line.text()));
    await page.goto(server.address);
    await until(page, () => window.barwright?.state().faces?.length > 0);
    return page;
  };
  const picture = (page, name) => pictures && page.screenshot({ path: path.join(pictures, `${name}.png`) });
  const page = await open();

  await test("the workbench opens a part and says what it is", async () => {
    assert((await page.textContent("#size")) === "80 × 20 × 10 mm", await page.textContent("#size"));
    assert((await state(page)).faces.length === 6, "a box has six faces");
    await picture(page, "workbench_start");
  });

  await test("a face is picked in the view and fixed, another is pushed with 20 N", async () => {
    await page.evaluate(() => window.barwright.view.fit([-1, -1.4, 0.8]));
    const root_ = await facing(page, [-1, 0, 0]);
    await clickFace(page, root_);
    assert((await state(page)).chosen.join() === String(root_), `chosen: ${(await state(page)).chosen}`);
    await page.click("[data-act=fix]");
    await until(page, () => window.barwright.state().conditions.length === 1);
    await page.evaluate(() => window.barwright.view.fit([1, -1.4, 0.8]));
    const end = await facing(page, [1, 0, 0]);
    await clickFace(page, end);
    await page.click("[data-act=force]");
    await page.selectOption("#direction", "-z");
    await page.fill("#value", "20");
    await picture(page, "workbench_push");
    await page.click("#add");
    await until(page, () => window.barwright.state().conditions.length === 2);
    const [, load] = (await state(page)).conditions;
    assert((await state(page)).symbols >= 5, "supports and loads are drawn");
    assert(load.vector[2] === -20 && load.vector[0] === 0 && load.faces.join() === String(end), JSON.stringify(load));
  });

  await test("with PLA the answer is a verdict near beam theory", async () => {
    await page.selectOption("#material", "pla");
    await until(page, () => window.barwright.state().material === "pla" || /pla/i.test(window.barwright.state().material));
    await page.click("#answer");
    await until(page, () => window.barwright.state().answer?.verdict && !window.barwright.state().busy);
    const now = await state(page);
    assert(now.verdict === now.answer.colour && now.verdict !== "none", now.verdict);
    // F L^3 / (3 E I) = 20 * 0.08^3 / (3 * 2.3e9 * 0.02 * 0.01^3 / 12), with shear a few per cent more
    const bend = 20 * 0.08 ** 3 / (3 * (await page.evaluate(() => window.barwright.young())) * 0.02 * 0.01 ** 3 / 12);
    const moved = await page.evaluate(() => window.barwright.view.largest);
    assert(Math.abs(moved / bend - 1) < 0.08, `moves ${moved} m, beam theory ${bend} m`);
    assert(now.factor > 1, "the deformation is exaggerated");
    assert((await page.textContent("#times")).startsWith("× "), "the factor is printed");
    await picture(page, "workbench_answer");
    await page.click("#true");
    assert((await state(page)).factor === 1 && (await page.textContent("#times")) === "true size", "true scale");
  });

  await test("a face is pushed by 1 mm, the mass follows, and undo takes it back", async () => {
    const before = await state(page);
    await page.evaluate(() => window.barwright.view.fit([1, -1.4, 0.8]));
    await clickFace(page, await facing(page, [0, 0, 1]));
    await page.click("#edit summary");
    await page.fill("#distance", "1");
    await page.click("#push");
    await until(page, (z) => Math.abs(window.barwright.state().size[2] - z - 0.001) < 1e-7, before.size[2]);
    const after = await state(page);
    assert(Math.abs(after.mass / before.mass - 1.1) < 1e-4, `${before.mass} kg, then ${after.mass} kg`);
    await canvasFocus(page);
    await page.keyboard.press("Control+z");
    await until(page, (z) => Math.abs(window.barwright.state().size[2] - z) < 1e-7, before.size[2]);
    await page.keyboard.press("Control+Shift+z");
    await until(page, (z) => Math.abs(window.barwright.state().size[2] - z - 0.001) < 1e-7, before.size[2]);
  });

  await test("a second window and a reload show the same", async () => {
    const other = await open();
    const [a, b] = [await state(page), await state(other)];
    assert(a.script.join() === b.script.join() && b.conditions.length === 2, "another session");
    await page.keyboard.press("Control+z");
    await until(other, () => Math.abs(window.barwright.state().size[2] - 0.01) < 1e-7);
    await other.close();
    await page.reload();
    await until(page, () => window.barwright?.state().conditions?.length === 2);
  });

  await test("the script is saved and the part is exported", async () => {
    await page.click("#save");
    await until(page, () => window.barwright.state().saved);
    const [stl] = await Promise.all([page.waitForEvent("download"), page.selectOption("#export", "stl")]);
    const out = path.join(own, "out.stl");
    await stl.saveAs(out);
    assert(fs.statSync(out).size > 84, "an empty file");
    assert(problems.length === 0, problems.join("; "));
  });

  await context.close();
  server.child.kill("SIGKILL");
}

const canvasFocus = (page) => page.evaluate(() => document.querySelector("#view > canvas").focus());

async function withoutEngine({ browser, root, test, assert, pictures }) {
  const problems = [];
  async function begin(options = {}) {
    const context = await browser.newContext({ viewport: { width: 1280, height: 860 }, acceptDownloads: true, ...options });
    const mock = new Mock();
    const page = await context.newPage();
    page.on("pageerror", (error) => problems.push(error.message));
    page.on("console", (line) => line.type() === "error" && problems.push(line.text()));
    const address = await mock.serve(context, root);
    await page.goto(address);
    await until(page, () => window.barwright?.state().triangles > 0 && window.barwright.state().faces);
    return { context, mock, page };
  }
  // Presses Tab until an element has the focus.
  async function tabTo(page, selector) {
    for (let i = 0; i < 120; i++) {
      if (await page.evaluate((s) => document.activeElement?.matches(s), selector)) return;
      await page.keyboard.press("Tab");
    }
    throw new Error(`Tab does not reach ${selector}`);
  }

  await test("the workbench is used with the keyboard alone", async () => {
    const { context, mock, page } = await begin();
    await tabTo(page, "#faces input[value='5']");
    await page.keyboard.press("Space");
    await tabTo(page, "[data-act=fix]");
    await page.keyboard.press("Enter");
    await until(page, () => window.barwright.state().conditions.length === 1);
    await tabTo(page, "#faces input[value='2']");
    await page.keyboard.press("Space");
    await tabTo(page, "[data-act=force]");
    await page.keyboard.press("Enter");
    await page.keyboard.type("20");
    await page.keyboard.press("Enter");
    await until(page, () => window.barwright.state().conditions.length === 2);
    await tabTo(page, "#material");
    await page.keyboard.type("pla");
    await until(page, () => window.barwright.state().material === "pla");
    await tabTo(page, "#answer");
    await page.keyboard.press("Enter");
    await until(page, () => window.barwright.state().verdict === "green");
    const load = mock.received.find((m) => m.do === "load");
    assert(load.faces[0] === 3 && load.force.join() === "-20,0,0", JSON.stringify(load));
    await context.close();
  });

  for (const colorScheme of ["light", "dark"])
    await test(`axe finds no violation on the workbench, ${colorScheme}`, async () => {
      const { context, mock, page } = await begin({ colorScheme, bypassCSP: true });
      await clickFace(page, 1);
      await page.click("[data-act=force]");
      for (const details of await page.$$("aside > details:not([open]) > summary")) await details.click();
      await page.click("#cut");
      await axe(page, root, assert);
      await page.click("#add");
      await page.selectOption("#material", "pla");
      await page.click("#advice");
      await page.click("#answer");
      await until(page, () => window.barwright.state().verdict === "green");
      for (const colour of ["green", "amber", "red"]) {
        mock.now.answer.colour = colour;
        mock.tell();
        await until(page, (c) => window.barwright.state().verdict === c, colour);
        await axe(page, root, assert);
      }
      await context.close();
    });

  await test("fit never clips, neither tall nor wide windows", async () => {
    const { context, mock, page } = await begin();
    for (const [width, height] of [[1280, 860], [390, 844], [1600, 500], [700, 1200]]) {
      await page.setViewportSize({ width, height });
      await page.waitForTimeout(100);
      for (const from of [[1, -1.4, 0.8], [0, -0.001, 1], [1, 0, 0], [0, -1, 0]]) {
        const out = await page.evaluate((d) => {
          window.barwright.view.fit(d);
          const box = document.querySelector("#view > canvas").getBoundingClientRect();
          return window.barwright.corners().filter(([x, y]) => x < box.left || x > box.right || y < box.top || y > box.bottom);
        }, from);
        assert(out.length === 0, `${width} × ${height} from ${from}: ${JSON.stringify(out)}`);
      }
    }
    // The toolbar covers no tip of a tall part.
    await page.setViewportSize({ width: 1280, height: 860 });
    mock.now.height = 0.2;
    mock.tell(undefined, true);
    await until(page, () => window.barwright.state().size[2] === 0.2);
    for (const from of [[1, -1.4, 0.8], [1, 0, 0]]) {
      const [tip, bar] = await page.evaluate((d) => {
        window.barwright.view.fit(d);
        return [Math.min(...window.barwright.corners().map(([, y]) => y)),
          document.getElementById("tools").getBoundingClientRect().bottom];
      }, from);
      assert(tip >= bar && tip < bar + 60, `from ${from} the tip is at ${tip}, the toolbar ends at ${bar}`);
    }
    await context.close();
  });

  await test("box select, grow, lock and a refusal that undo clears", async () => {
    const { context, mock, page } = await begin();
    await page.click("#box");
    const box = await page.locator("#view > canvas").boundingBox();
    await page.mouse.move(box.x + 5, box.y + 60);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width - 5, box.y + box.height - 5, { steps: 4 });
    await page.mouse.up();
    assert((await state(page)).chosen.length === 7, `${(await state(page)).chosen} of 7`);
    await page.keyboard.press("Escape");
    await clickFace(page, 3);
    await page.click("#grow");
    assert((await state(page)).chosen.join() === "1,2,3,5,6", `grown: ${(await state(page)).chosen}`);
    await clickFace(page, 1);
    await page.click("#lock");
    await until(page, () => window.barwright.state().faces[0].locked);
    await page.click("#edit summary");
    await page.click("#push");
    await until(page, () => /locked/.test(window.barwright.state().said));
    await page.click("#undo");
    await until(page, () => !window.barwright.state().said);
    assert(!mock.now.locked.length, "undo did not unlock");
    await context.close();
  });

  await test("a reload keeps what was chosen, looked at and typed; the other window stays as it is", async () => {
    const { context, page } = await begin();
    const other = await context.newPage();
    await other.goto(page.url());
    await until(other, () => window.barwright?.state().faces?.length > 0);
    await page.evaluate(() => window.barwright.view.fit([-1, -0.4, 0.3]));
    await clickFace(page, await facing(page, [-1, 0, 0]));
    await page.keyboard.press("+");
    await page.click("#edit summary");
    await page.fill("#distance", "2.5");
    await page.fill("#offset", "0.7");
    await page.fill("#must-carry", "12");
    await page.click("#cut");
    await page.selectOption("#axis", "1");
    await page.click("#edges");
    await page.click("[data-act=force]");
    await page.fill("#value", "33");
    await page.selectOption("#direction", "+y");
    const look = (one) => one.evaluate(() => ({ chosen: window.barwright.state().chosen, camera: window.barwright.view.camera(),
      cut: [window.barwright.view.cut, ...window.barwright.view.plane.normal.toArray(), window.barwright.view.plane.constant],
      lines: window.barwright.view.lines.visible, draft: window.barwright.state().draft,
      typed: ["distance", "offset", "must-carry", "value", "direction", "axis"].map((id) => document.getElementById(id).value),
      open: [...document.querySelectorAll("aside details")].map((one) => one.open) }));
    const [before, others] = [await look(page), await look(other)];
    assert(before.chosen.length === 1 && before.cut[0] && !before.lines && before.draft === "force", JSON.stringify(before));
    await page.reload();
    await until(page, () => window.barwright?.state().draft === "force");
    const after = await look(page);
    const close = (a, b) => a.flat().every((x, i) => Math.abs(x - b.flat()[i]) < 1e-9);
    assert(close(before.camera, after.camera), `the camera moved: ${JSON.stringify([before.camera, after.camera])}`);
    assert(JSON.stringify({ ...before, camera: 0 }) === JSON.stringify({ ...after, camera: 0 }), JSON.stringify([before, after]));
    if (pictures) await page.screenshot({ path: path.join(pictures, "workbench_reload.png") });
    await page.click("#add");
    await until(other, () => window.barwright.state().conditions.length === 1);
    assert(JSON.stringify(others) === JSON.stringify(await look(other)), "the other window changed its choice or view");
    // Another window's action leaves alone what is typed here.
    await clickFace(page, 7).catch(() => page.click("#faces input[value='6']"));
    await page.fill("#radius", "9");
    await page.focus("#distance");
    await other.evaluate(() => window.barwright.send("gravity", { acceleration: [0, 0, -9.81] }));
    await until(page, () => window.barwright.state().conditions.length === 2);
    assert((await page.inputValue("#radius")) === "9", `the radius that was typed became ${await page.inputValue("#radius")}`);
    await context.close();
  });

  await test("a second reload, before the session has answered the first, keeps what was typed", async () => {
    const { context, mock, page } = await begin();
    await page.click("#faces input[value='2']");
    await page.click("[data-act=force]");
    await page.fill("#value", "33");
    await page.click("#edges");
    mock.picture = () => JSON.stringify(mock.state()); // a session that says nothing
    mock.state = () => ({ type: "later" });
    await page.reload();
    await until(page, () => window.barwright?.state().connected);
    assert((await page.inputValue("#value")) !== "33", "the page was restored without a state");
    delete mock.picture;
    delete mock.state;
    await page.reload();
    await until(page, () => window.barwright?.state().draft === "force");
    assert((await page.inputValue("#value")) === "33", `33 became ${await page.inputValue("#value")}`);
    assert((await state(page)).chosen.join() === "3", `chosen: ${(await state(page)).chosen}`);
    assert((await page.getAttribute("#edges", "aria-pressed")) === "false", "the edges are drawn again");
    await context.close();
  });

  await test("the interval of an answer is printed, and which of its bounds is not known", async () => {
    const { context, mock, page } = await begin();
    const base = { verdict: "none", colour: "amber", sentence: "See below.", force: 25.8, utilisation: 0.4 };
    for (const [bounds, force, share] of [
      [{ force_low: 21.3, force_high: 30.9, low: 0.3, high: 0.5 }, "25.8 N (21.3 N to 30.9 N)", "40 % (30 % to 50 %)"],
      [{ force_low: 21.3, low: 0.3 }, "25.8 N (at least 21.3 N)", "40 % (at least 30 %)"],
      [{ force_low: 0, force_high: null, low: 0.3, high: null }, "25.8 N (error unknown)", "40 % (at least 30 %)"],
      [{}, "25.8 N (error unknown)", "40 % (error unknown)"]]) {
      mock.now.answer = { ...base, ...bounds };
      mock.tell();
      await until(page, (text) => document.getElementById("verdict-more").textContent === text, `breaks at ${force}`);
      const shown = await page.$$eval("#numbers dd", (all) => all.map((one) => one.textContent));
      assert(shown.join("; ") === `${share}; ${force}`, shown.join("; "));
    }
    await context.close();
  });

  await test("nothing moves while a part is opened, picked, loaded, answered and edited", async () => {
    const { context, mock, page } = await begin();
    await page.evaluate(() => {
      window.shifts = [];
      const name = (node) => (node?.nodeType === 1 ? node : node?.parentElement)?.id || node?.nodeName || "?";
      new PerformanceObserver((list) => {
        for (const entry of list.getEntries())
          if (!entry.hadRecentInput) window.shifts.push([entry.value, ...entry.sources.map((one) => name(one.node))]);
      }).observe({ type: "layout-shift", buffered: true });
    });
    mock.delay = 700; // what comes within 500 ms of a click is not counted
    const settle = () => page.waitForTimeout(900);
    await page.setInputFiles("#upload", { name: "a_bracket_with_a_name_of_some_length_v12_final.stl", mimeType: "model/stl", buffer: Buffer.from("solid") });
    await settle();
    await clickFace(page, 3);
    await page.click("[data-act=fix]");
    await settle();
    await page.click("#faces input[value='3']");
    await page.click("[data-act=force]");
    await page.click("#add");
    await settle();
    await page.selectOption("#material", "steel");
    await settle();
    await page.click("#answer");
    await settle();
    mock.now.answer = { ...mock.now.answer, colour: "amber", verdict: "unsure", sentence: "Too close to decide: stress over strength " +
      "98.4 % (71.2 to 126 %). It breaks at 20.3 N (15.9 to 28.1 N) of all loads together, where the arm meets the plate." };
    mock.tell();
    await page.evaluate(() => document.querySelector("#edit summary").click());
    await settle();
    await page.click("#faces input[value='0']");
    await page.click("#push");
    await settle();
    for (const socket of mock.sockets) socket.send(JSON.stringify({ type: "refused", id: 0, message: "This push is too far: the surface " +
      "would cross itself at (12.5, 3.25, 8) mm. Take a smaller distance, or push the face beside it first, and then this one." }));
    await settle();
    await page.click("#undo");
    await settle();
    const shifts = await page.evaluate(() => window.shifts);
    const total = shifts.reduce((sum, [value]) => sum + value, 0);
    console.log(`  cumulative layout shift: ${total.toFixed(4)}`);
    assert(total < 0.02, `cumulative layout shift ${total}: ${JSON.stringify(shifts)}`);
    if (pictures) await page.screenshot({ path: path.join(pictures, "workbench_shift.png") });
    await context.close();
  });

  await test("handles: a face is pulled with the mouse, a load turned", async () => {
    const { context, mock, page } = await begin();
    await clickFace(page, 1);
    await page.click("#edit summary");
    const drag = async (dx, dy) => {
      const at = await page.locator("#handles circle").first().boundingBox();
      await page.mouse.move(at.x + at.width / 2, at.y + at.height / 2);
      await page.mouse.down();
      await page.mouse.move(at.x + at.width / 2 + dx, at.y + at.height / 2 + dy, { steps: 6 });
      if (pictures && dy < 0) await page.screenshot({ path: path.join(pictures, "workbench_pull.png") });
      await page.mouse.up();
    };
    await drag(0, -40);
    await until(page, () => window.barwright.state().undo);
    const push = mock.received.find((m) => m.do === "push");
    assert(push.faces.join() === "1" && push.distance > 1e-3 && push.distance < 0.02, JSON.stringify(push));
    await page.click("#edit summary");
    await until(page, () => !document.querySelector("#handles circle"));
    await page.click("[data-act=force]");
    await drag(90, 10);
    await page.click("#add");
    await until(page, () => window.barwright.state().conditions.length === 1);
    const { force } = mock.received.find((m) => m.do === "load");
    assert(Math.abs(Math.hypot(...force) - 20) < 1e-3 && Math.hypot(force[0], force[1]) > 3, JSON.stringify(force));
    await context.close();
  });

  await test("an upload, the unit that is asked for, and layouts without a strip", async () => {
    const { context, mock, page } = await begin();
    mock.implausible = true;
    await page.setInputFiles("#upload", { name: "hook.stl", mimeType: "model/stl", buffer: Buffer.from("solid") });
    await until(page, () => !document.getElementById("units").hidden);
    assert(await page.isDisabled("#answer"), "no answer before the unit is known");
    await page.click("#unit-choices button");
    assert(mock.received.some((m) => m.do === "unit" && m.unit === "mm"), "the unit was not sent");
    for (const [width, height] of [[390, 844], [820, 1180], [1280, 860]]) {
      await page.setViewportSize({ width, height });
      const off = await page.evaluate(() => [document.documentElement.scrollWidth - innerWidth,
        innerHeight - document.querySelector("aside").getBoundingClientRect().bottom]);
      assert(Math.abs(off[0]) < 1 && Math.abs(off[1]) < 1, `${width} × ${height}: ${off}`);
    }
    assert(problems.length === 0, problems.join("; "));
    await context.close();
  });
}

export async function workbench(drive) {
  await withoutEngine(drive);
  await withEngine(drive);
}
