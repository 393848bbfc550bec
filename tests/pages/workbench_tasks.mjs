// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Twelve tasks of a maker in the workbench, with a real mouse, on parts that are generated here: from an STL, a 3MF,
// a STEP and an SVG file to a verdict, to a stronger part, to a file for the slicer. Each counts its clicks, typed
// values and time, which must be those of the table in docs/workbench_tasks.md; the time may be longer. What it
// exported is read back by the engine. No Lua is typed.
import { execFileSync, spawn } from "node:child_process";
import fs from "node:fs";
import path from "node:path";

// Parts in a folder. What OpenCASCADE writes is there only where barwright was built with it.
const parts = (folder) => `local bw = require "barwright"
  local folder = ${JSON.stringify(folder)}
  local function write(name, surface, options) assert(assert(surface):write(folder .. name, options)) end
  local function bored(part, x, y, radius)
    return assert(part:difference(assert(bw.surface.cylinder {base = {x, y, -0.01}, axis = {0, 0, 0.05}, radius = radius})))
  end
  write("shelf.stl", bw.surface.box {max = {0.08, 0.02, 0.006}})
  write("weak.stl", bw.surface.box {max = {0.08, 0.02, 0.003}})
  write("inches.stl", bw.surface.box {max = {0.1016, 0.0254, 0.0127}}, {unit = "m"})
  write("plate.3mf", bored(bored(bw.surface.box {max = {0.06, 0.03, 0.005}}, 0.045, 0.015, 0.005), 0.015, 0.015, 0.004))
  write("twin.3mf", bored(bored(bw.surface.box {max = {0.06, 0.03, 0.005}}, 0.045, 0.015, 0.004), 0.015, 0.015, 0.004))
  local lever = bw.surface.box {max = {0.07, 0.02, 0.006}} -- with a neck in the middle
  for _, y in ipairs {-0.01, 0.014} do
    lever = assert(lever:difference(bw.surface.box {min = {0.03, y, -0.01}, max = {0.045, y + 0.016, 0.02}}))
  end
  write("lever.3mf", lever)
  write("pebble.stl", bw.surface.implicit("x^2 + 2 * y^2 + 3 * z^2 + x * y / 2 - 4e-4",
    {min = {-0.03, -0.03, -0.03}, max = {0.03, 0.03, 0.03}, cells = 20}))
  assert(assert(bw.outline.rectangle {width = 0.06, height = 0.02}):write(folder .. "sign.svg"))`;

// The rows of the table in the documentation: {clicks, typed, seconds} of each task.
function documented(root) {
  const row = /^\| (\d+) \|.*\| (\d+) \| (\d+) \| (\d+) \|$/;
  const text = fs.readFileSync(path.join(root, "docs/workbench_tasks.md"), "utf8");
  const rows = text.split("\n").map((line) => line.match(row)).filter(Boolean);
  return Object.fromEntries(rows.map(([, task, ...numbers]) => {
    const [clicks, typed, seconds] = numbers.map(Number);
    return [task, { clicks, typed, seconds }];
  }));
}

// A task may take so many times as long as the table says, and so many seconds more: the machine may be busy.
const TIMES = 10;
const MORE = 60;

export async function workbenchTasks({ browser, root, folder, test, assert, pictures }) {
  const own = `${fs.mkdtempSync(path.join(folder, "tasks-"))}/`;
  const engine = (script) => execFileSync(path.join(root, "build/barwright"), ["-e", script],
    { cwd: root, encoding: "utf8", env: { ...process.env, BARWRIGHT_QUIET: "1" } });
  engine(parts(own));
  const maker = path.join(root, "build/tests/make_shapes");
  const cad = fs.existsSync(maker);
  if (cad) execFileSync(maker, [own], { stdio: "ignore" });

  const server = spawn(path.join(root, "build/barwright"), ["open", "--no-open"], { cwd: root,
    env: { ...process.env, BARWRIGHT_QUIET: "1" } });
  let out = "";
  for (const stream of [server.stdout, server.stderr]) stream.on("data", (text) => (out += text));
  const context = await browser.newContext({ viewport: { width: 1280, height: 900 }, acceptDownloads: true });
  context.setDefaultTimeout(60000);
  const page = await context.newPage();
  const problems = [];
  page.on("pageerror", (error) => problems.push(error.message));
  page.on("console", (line) => line.type() === "error" && problems.push(line.text()));

  // ---- what a person does, counted ------------------------------------------------------------------------------

  let clicks = 0;
  let typed = 0;
  const state = () => page.evaluate(() => window.barwright.state());
  // page.waitForFunction evaluates text inside the page, which the page's policy forbids.
  async function until(holds, what) {
    for (const since = Date.now(); Date.now() - since < 300000; await page.waitForTimeout(30)) {
      const now = await state();
      if (holds(now)) return now;
    }
    throw new Error(`in vain: ${what}; ${JSON.stringify({ ...(await state()), script: 0, faces: 0 })}`);
  }
  const click = async (selector, options) => {
    clicks++;
    await page.click(selector, options);
  };
  const type = async (selector, value) => {
    typed++;
    await page.fill(selector, String(value));
  };
  // A list is opened and an entry clicked. Headless browsers draw no list: the entry is chosen for the mouse.
  const choose = async (selector, value) => {
    clicks += 2;
    await page.selectOption(selector, value);
  };
  const unfold = (id) => page.evaluate((i) => document.getElementById(i).open, id).then((open) => open || click(`#${id} > summary`));
  const done = async (what, action) => {
    const { revision } = await state();
    await action();
    return until((now) => now.revision > revision && !now.busy && !now.waiting, what);
  };
  async function drop(name) {
    clicks++; // a file is dropped
    await page.setInputFiles("#upload", own + name);
    await until((now) => now.file === name && now.faces.length > 0 && !now.busy, `${name} opens`);
  }
  // The largest face of a kind that looks in a direction.
  async function find(kind, direction, nth = 0) {
    const { faces } = await state();
    const fits = (f) => f.kind === kind && (!direction || f.normal.reduce((sum, x, k) => sum + x * direction[k], 0) > 0.99);
    return faces.filter(fits).sort((a, b) => b.area - a.area)[nth].index;
  }
  // Clicks a face in the view; the part is turned first where the face is not seen.
  async function pick(face, towards, add) {
    if (towards) {
      clicks++; // the part is turned
      await page.evaluate((d) => window.barwright.view.fit(d), towards);
    }
    const place = await page.evaluate((n) => window.barwright.place(n), face);
    assert(place, `face ${face} is not seen`);
    clicks++;
    if (add) await page.keyboard.down("Shift");
    await page.mouse.move(...place);
    await page.mouse.click(...place);
    if (add) await page.keyboard.up("Shift");
    const { chosen } = await state();
    assert(chosen.includes(face), `face ${face} was clicked, chosen: ${chosen}`);
  }
  const fix = () => done("fix", () => click("[data-act=fix]"));
  async function push(value, direction, kind = "force") {
    await click(`[data-act=${kind}]`);
    if (direction) await choose("#direction", direction);
    await type("#value", value);
    await done(kind, () => click("#add"));
  }
  const material = (name) => done("material", () => choose("#material", name));
  async function answer(accuracy = "coarse") {
    if ((await page.inputValue("#accuracy")) !== accuracy) await choose("#accuracy", accuracy);
    return (await done("answer", () => click("#answer"))).answer;
  }
  // Exports the part and reads it back: its volume (m3).
  async function exported(format) {
    clicks += 2;
    const [file] = await Promise.all([page.waitForEvent("download"), page.selectOption("#export", format)]);
    const to = `${own}out.${format}`;
    await file.saveAs(to);
    return Number(engine(`local s = assert(require "barwright".surface.read(${JSON.stringify(to)}))
      assert(s:check().sound) print(("%.12g"):format(s.volume))`));
  }
  const near = (got, expected, tolerance, what) => assert(Math.abs(got / expected - 1) <= tolerance,
    `${what}: ${expected} expected, got ${got}`);

  // Each task begins as the first one does: what was unfolded is folded, and the accuracy is the default.
  let unfolded;
  async function begin() {
    await page.selectOption("#accuracy", "default");
    unfolded ??= await page.$$eval("details", (list) => list.map((one) => one.open));
    await page.$$eval("details", (list, open) => list.forEach((one, i) => (one.open = open[i])), unfolded);
  }

  const table = documented(root);
  let number = 0;
  async function task(name, body) {
    number++;
    const label = `task ${number}: ${name}`;
    await test(label, async () => {
      await begin();
      [clicks, typed] = [0, 0];
      const since = Date.now();
      await body();
      const seconds = (Date.now() - since) / 1000;
      console.log(`  ${label}: ${clicks} clicks, ${typed} values typed, ${seconds.toFixed(1)} s`);
      if (pictures) await page.screenshot({ path: path.join(pictures, `task_${number}.png`) });
      assert(problems.length === 0, problems.splice(0).join("; "));
      const row = table[number];
      assert(row, "docs/workbench_tasks.md has no row for this task");
      assert(row.clicks === clicks && row.typed === typed,
        `docs/workbench_tasks.md has ${row.clicks} clicks and ${row.typed} values, not ${clicks} and ${typed}`);
      assert(seconds <= TIMES * row.seconds + MORE,
        `${seconds} s, where docs/workbench_tasks.md has ${row.seconds} s`);
    });
  }

  for (const since = Date.now(); !/http:\/\/\S+/.test(out); await new Promise((go) => setTimeout(go, 30)))
    if (Date.now() - since > 60000 || server.exitCode !== null) throw new Error(`barwright open: ${out}`);
  await page.goto(out.match(/http:\/\/\S+/)[0]);
  await until((now) => now.connected, "the page connects");

  // A beam of `length` along x, held on the left, is pushed down on the right with a force.
  async function cantilever(force) {
    await pick(await find("plane", [-1, 0, 0]), [-1, -1.2, 0.8]);
    await fix();
    await pick(await find("plane", [1, 0, 0]), [1, -1.2, 0.8]);
    await push(force, "-z");
  }

  // ---- the tasks ------------------------------------------------------------------------------------------------

  await task("STL to a verdict", async () => {
    await drop("shelf.stl");
    await cantilever(20);
    await material("pla");
    const found = await answer("default");
    assert(found.verdict === "holds" && found.colour === "green", found.sentence);
    const bending = (6 * 20 * 0.08) / (0.02 * 0.006 ** 2) / 53e6; // of a beam: 6 F L / (b h^2), over the strength of PLA
    assert(found.utilisation > 0.8 * bending && found.utilisation < 1.7 * bending, `${found.utilisation}, beam ${bending}`);
    assert(found.low < found.utilisation && found.utilisation < found.high && found.frequency > 0, "no interval");
    assert((await page.getAttribute("#verdict", "data-colour")) === "green", "the verdict is not green");
  });

  await task("STL to a stronger part", async () => {
    await drop("weak.stl");
    await cantilever(20);
    const before = await answer();
    assert(before.verdict !== "holds", before.sentence);
    const { mass } = await state();
    await pick(await find("plane", [0, 0, 1]));
    await unfold("edit");
    await type("#distance", 4);
    const after = await done("push", () => click("#push"));
    near(after.mass / mass, 7 / 3, 1e-6, "mass");
    assert((await answer()).verdict === "holds", "the thicker shelf does not hold");
  });

  await task("STL to a file for the slicer, a face pulled with the mouse", async () => {
    await drop("shelf.stl");
    await pick(await find("plane", [0, 0, 1]), [0.6, -1.4, 0.9]);
    await unfold("edit");
    const handle = await page.locator("#handles circle").first().boundingBox();
    const from = [handle.x + handle.width / 2, handle.y + handle.height / 2];
    clicks++;
    await page.mouse.move(...from);
    await page.mouse.down();
    await page.mouse.move(from[0], from[1] - 40, { steps: 5 });
    const pulled = await done("pull", () => page.mouse.up());
    assert(pulled.size[2] > 0.0065, `pulled to ${pulled.size[2]}`);
    near(await exported("3mf"), 0.08 * 0.02 * pulled.size[2], 1e-5, "volume");
  });

  await task("STL in another unit: it is asked for", async () => {
    await drop("inches.stl");
    assert(await page.isVisible("#units"), "the unit is not asked for");
    assert(await page.isDisabled("#answer"), "an answer before the unit is known");
    await done("unit", () => click("#unit-choices button:text-is('Metres')"));
    near((await state()).size[0], 0.1016, 1e-6, "length");
    const outside = () => page.evaluate(() => {
      const box = document.querySelector("#view > canvas").getBoundingClientRect();
      return window.barwright.corners().filter(([x, y]) => x < box.left || x > box.right || y < box.top || y > box.bottom).length;
    });
    assert((await outside()) === 0, "the part that became larger is not fitted into the view");
    await done("undo", () => page.click("#undo"));
    assert(/^Undone: the unit metres/.test((await state()).said), (await state()).said);
    assert((await page.isVisible("#units")) && (await outside()) === 0, "the unit is not asked for again");
    await done("redo", () => page.click("#redo"));
    near((await state()).size[0], 0.1016, 1e-6, "length again");
    await cantilever(50);
    assert((await answer()).verdict === "holds", "it does not hold");
  });

  await task("3MF to a verdict: pressure on a plate with two holes", async () => {
    await drop("plate.3mf");
    await pick(await find("cylinder"), [0.2, -0.9, 1.4]);
    await pick(await find("cylinder", null, 1), null, true);
    await fix();
    await pick(await find("plane", [0, 0, 1]));
    await push(0.05, null, "pressure");
    await click("#own > summary"); // a plastic of which the data sheet is at hand
    for (const [id, value] of [["young", 2.1], ["poisson", 0.38], ["strength", 48], ["density", 1270]]) await type(`#own-${id}`, value);
    await done("own values", () => click("#own-form button"));
    near((await state()).mass, 1270 * 0.005 * (0.06 * 0.03 - Math.PI * (0.005 ** 2 + 0.004 ** 2)), 2e-3, "mass");
    const found = await answer();
    near(found.load, 0.05e6 * (0.06 * 0.03 - Math.PI * (0.005 ** 2 + 0.004 ** 2)), 0.01, "load"); // the holes are polygons
    assert(["holds", "unsure", "breaks"].includes(found.verdict) && found.force > 0, found.sentence);
  });

  await task("3MF to a file for the slicer: a hole for a larger bolt", async () => {
    await drop("plate.3mf");
    await pick(await find("cylinder", null, 1), [0.2, -0.9, 1.4]);
    await unfold("edit");
    await type("#radius", 6);
    const { mass } = await state();
    const after = await done("radius", () => click("#set-radius"));
    assert(after.mass < mass, "the mass did not fall");
    near(await exported("stl"), 0.06 * 0.03 * 0.005 - Math.PI * (0.005 ** 2 + 0.006 ** 2) * 0.005, 2e-3, "volume");
  });

  await task("3MF to a stronger part: both sides alike, locked holes", async () => {
    await drop("twin.3mf");
    await unfold("edit");
    await done("symmetry", () => choose("#symmetry", "x"));
    await pick(await find("cylinder"), [0.9, -0.9, 1.2]);
    await pick(await find("cylinder", null, 1), null, true);
    await done("lock", () => click("#lock"));
    await click("#clear");
    await pick(await find("plane", [1, 0, 0]));
    await type("#distance", 2);
    const after = await done("push", () => click("#push"));
    near(after.size[0], 0.064, 1e-6, "length"); // 2 mm on either side
    assert(after.faces.filter((f) => f.locked).length === 2, "the holes are not locked");
    near(await exported("3mf"), (0.064 * 0.03 - 2 * Math.PI * 0.004 ** 2) * 0.005, 2e-3, "volume");
  });

  await task("3MF to a stronger part: advice is applied, undone, and optimised", async () => {
    await drop("lever.3mf");
    await cantilever(12);
    const before = await answer();
    await unfold("advise");
    const advised = await done("advice", () => click("#advice"));
    assert((await page.locator("#advices li").count()) > 0, `no advice: ${advised.said}`);
    await done("apply", () => click("#advices button"));
    const after = await answer();
    assert(after.utilisation < before.utilisation, `${before.utilisation}, then ${after.utilisation}`);
    await done("undo", () => click("#undo"));
    await type("#target", Number((1.1 / before.high).toPrecision(3))); // a tenth more than it carries for sure
    await done("optimise", () => click("#optimise"));
    assert(/fell from/.test(await page.textContent("#note")), await page.textContent("#note"));
    assert((await answer()).utilisation < before.utilisation, "optimising did not help");
    assert((await exported("3mf")) > 0.07 * 0.02 * 0.006 - 0.015 * 0.012 * 0.006, "the volume did not grow");
  });

  await task("a sculpted STL to a verdict: patches where it is held and pushed", async () => {
    await drop("pebble.stl");
    const patch = async (towards) => {
      clicks++;
      await page.evaluate((d) => window.barwright.view.fit(d), towards);
      const box = await page.locator("#view > canvas").boundingBox();
      await click("#patch");
      clicks++;
      await done("patch", () => page.mouse.click(box.x + box.width / 2, box.y + box.height / 2));
      await click("#patch");
    };
    const count = (await state()).faces.length;
    await patch([-1, -0.1, 0.1]);
    const [left] = (await state()).chosen;
    assert((await state()).faces.length === count + 1 && left === count + 1, "no face was made");
    await fix();
    await patch([1, -0.1, 0.1]);
    await push(200, "-z");
    const found = await answer();
    assert(found.force > 0 && found.load > 199, found.sentence);
  });

  await task("STL without loads: the force that breaks it, and where", async () => {
    await drop("shelf.stl");
    await material("pla");
    await type("#must-carry", 30);
    const found = await answer();
    assert(found.kind === "worst" && found.force_low < found.force && found.force < found.force_high, found.sentence);
    assert(["green", "amber", "red"].includes(await page.getAttribute("#verdict", "data-colour")), "no colour");
    assert(/breaks at/.test(await page.textContent("#verdict-words")), await page.textContent("#verdict-words"));
    assert(await page.isVisible("#legend"), "weak places are not coloured");
    await click("#place");
  });

  await task("SVG to a verdict: a sheet of steel under its own weight", async () => {
    await drop("sign.svg");
    assert(await page.isVisible("#thickness-form"), "the thickness is not asked for");
    await type("#thickness", 2);
    await done("thickness", () => click("#thickness-form button"));
    near((await state()).size[2], 0.002, 1e-6, "thickness");
    await material("steel");
    await pick(await find("plane", [-1, 0, 0]), [-1, -1.2, 0.8]);
    await fix();
    await click("[data-act=gravity]");
    await done("gravity", () => click("#add"));
    const found = await answer();
    assert(found.verdict === "holds", found.sentence);
    const density = (await state()).mass / (0.06 * 0.02 * 0.002);
    const bending = (3 * density * 9.81 * 0.06 ** 2) / 0.002; // of a cantilever: 3 rho g L^2 / h
    near(found.max_stress, bending, 0.35, "stress");
  });

  if (cad) await task("STEP to a verdict, a stronger part and a file for the slicer", async () => {
    await drop("box_MM.step");
    near((await state()).size.reduce((a, b) => a * b, 1), 24000e-9, 1e-6, "volume");
    await pick(await find("plane", [0, 0, -1]), [0.8, -1.2, -0.7]);
    await fix();
    await pick(await find("plane", [0, 0, 1]), [0.8, -1.2, 0.7]);
    await push(100, "+x");
    await material("abs");
    const before = await answer();
    await pick(await find("plane", [1, 0, 0]));
    await unfold("edit");
    await type("#distance", 3);
    await done("push", () => click("#push"));
    assert((await answer()).utilisation < before.utilisation, "it is not stronger");
    const { size } = await state();
    near(await exported("3mf"), size[0] * size[1] * size[2], 1e-6, "volume");
  });

  await test("each row of the table of tasks is played", async () => {
    const rows = Object.keys(table).length;
    assert(rows === (cad ? number : number + 1), `${rows} rows, ${number} tasks`);
  });

  await context.close();
  server.kill("SIGKILL");
}
