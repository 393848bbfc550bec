// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The plane's live view in headless Chromium: outlines dragged with the mouse, what follows them, the
// tools, time that goes on, sound, files.
import fs from "node:fs";
import path from "node:path";
import { execFileSync } from "node:child_process";
import { begin, difference, serve } from "./live_driver.mjs";

// A view of a script of tests/lua/live_plane, and what the mouse does in it.
async function view(all, name, file = `tests/lua/live_plane/${name}.lua`) {
  const drive = await begin({ ...all, session: file });
  const page = await drive.open();
  const place = async (what, ...given) => {
    const [x, y] = await page.evaluate(([w, g]) => window.barwright[w](...g), [what, given]);
    const box = await page.locator("#over").boundingBox();
    return [x + box.x, y + box.y];
  };
  // Takes what is at a place and pulls it by pixels; leaves the button down.
  async function grab([x, y], dx, dy, steps = 12) {
    await page.mouse.move(x, y, { steps: 2 });
    await page.mouse.down();
    await page.mouse.move(x + dx, y + dy, { steps });
  }
  async function drag(from, dx, dy, steps) {
    const before = await drive.state(page);
    await grab(from, dx, dy, steps);
    await page.mouse.up();
    await drive.until(page, (edits) => window.barwright.state().edits === edits + 1 && !window.barwright.state().drag,
      before.edits);
    return [before, await drive.state(page)];
  }
  const state = () => drive.state(page);
  const until = (what, argument) => drive.until(page, what, argument);
  const picture = (title) => drive.picture(page, `plane_${name}_${title}`);
  return { ...drive, drive: drive.state, page, place, grab, drag, state, until, picture };
}

const levels = /^(none|relocation|reconnecting|reconstruction)$/;

async function steady(all) {
  const { test, assert } = all;
  const v = await view(all, "steady");
  const { page } = v;

  await test("the plane's view opens without errors and shows the largest stress", async () => {
    assert(v.problems.length === 0, v.problems.join("; "));
    const now = await v.state();
    assert(now.maximum > 1e7 && now.maximum < 2e7, `${now.maximum} Pa`);
    assert((await page.textContent("#maximum")).startsWith((now.maximum / 1e6).toPrecision(4)), "readout");
    assert(Math.abs(now.area - (0.02 - Math.PI * 4e-4)) < 1e-6, `area ${now.area}`);
    await v.picture("start");
  });

  await test("the field is drawn in colours", async () => {
    const fraction = await page.evaluate(() => {
      const source = document.querySelector("#view canvas");
      const pen = Object.assign(document.createElement("canvas"), { width: source.width, height: source.height }).getContext("2d");
      pen.drawImage(source, 0, 0);
      const pixels = pen.getImageData(0, 0, source.width, source.height).data;
      let coloured = 0;
      for (let i = 0; i < pixels.length; i += 4)
        if (Math.max(pixels[i], pixels[i + 1], pixels[i + 2]) - Math.min(pixels[i], pixels[i + 1], pixels[i + 2]) > 30) coloured++;
      return coloured / (pixels.length / 4);
    });
    assert(fraction > 0.15, `${fraction} of the view is coloured`);
  });

  await test("a hole dragged with the mouse takes mesh and stress along, level and rate are shown", async () => {
    const [before, after] = await v.drag(await v.place("place", 0.06, 0.05), 160, 10, 40);
    assert(before.maximum !== after.maximum, "the stress stayed");
    assert(Math.abs(after.area - before.area) < 1e-9, "the area of a hole that is moved stays");
    assert(levels.test(after.level), after.level);
    const { relocation = 0, reconnecting = 0, reconstruction = 0 } = after.levels;
    assert(relocation + reconnecting + reconstruction > 0, JSON.stringify(after.levels));
    assert(/object:drag\(\{loop = "hole"\}/.test(after.script[0]), after.script[0]);
    const moved = after.points[8] - before.points[8];
    assert(moved > 0.02 && moved < 0.1, `the hole moved by ${moved} m`);
    assert(/^(\d+|–)$/.test(await page.textContent("#fps")), `${await page.textContent("#fps")} frames a second`);
    console.log(`# drag of the hole: ${await page.textContent("#fps")} frames a second, ${JSON.stringify(after.levels)}`);
    await v.picture("dragged");
  });

  await test("undo and redo come back to the same shape", async () => {
    const after = await v.state();
    await page.click("#undo");
    await v.until(() => window.barwright.state().edits === 0);
    assert(difference((await v.state()).points, after.points) > 0.02, "undo left the shape");
    await page.keyboard.press("Control+Shift+z");
    await v.until(() => window.barwright.state().edits === 1);
    assert(difference((await v.state()).points, after.points) === 0, "redo makes another shape");
  });

  await test("vertices, edges, control points and whole loops are dragged", async () => {
    const [before, corner] = await v.drag(await v.place("vertex", 3), 20, -15);
    assert(corner.area > before.area, "the corner was pulled out");
    const [, edge] = await v.drag(await v.place("edge", 3), 0, -20);
    assert(edge.area > corner.area, "the edge was pulled out");
    await page.check("#controls");
    const [, control] = await v.drag(await v.place("control", 6, 1), 6, -12);
    assert(control.area !== edge.area, "the curve stayed");
    assert(/control = 1, edge = 6/.test(control.script.at(-1)), control.script.at(-1));
    await page.uncheck("#controls");
    await page.keyboard.down("Shift");
    const [, whole] = await v.drag(await v.place("edge", 4), -15, 0);
    await page.keyboard.up("Shift");
    assert(/loop = "outline"/.test(whole.script.at(-1)) && Math.abs(whole.area - control.area) < 1e-8, "the whole loop");
    await v.picture("edges");
  });

  await test("a drag that folds the outline is refused in a sentence, and the last good shape stays", async () => {
    const before = await v.state();
    await v.grab(await v.place("vertex", 2), -30, 0, 4);
    await v.until((n) => window.barwright.state().states > n, before.states);
    const [x, y] = await v.place("vertex", 4);
    await page.mouse.move(x - 300, y - 60, { steps: 3 });
    await v.until((n) => window.barwright.state().refused > n, before.refused);
    assert(/cross|touch|inverted|outside|lies? in/.test((await v.state()).said), (await v.state()).said);
    await v.picture("refused");
    await page.mouse.up();
    await v.until((n) => window.barwright.state().edits === n + 1 && !window.barwright.state().drag, before.edits);
    await page.click("#undo");
    await v.until((n) => window.barwright.state().edits === n, before.edits);
    assert(difference((await v.state()).points, before.points) === 0, "undo after a refusal");
  });

  await test("Escape cancels a drag", async () => {
    const before = await v.state();
    await v.grab(await v.place("edge", 2), 40, 0);
    await v.until(() => window.barwright.state().drag);
    await page.keyboard.press("Escape");
    await v.until(() => !window.barwright.state().drag);
    await page.mouse.up();
    const after = await v.state();
    assert(after.edits === before.edits && difference(after.points, before.points) === 0, "it stayed");
  });

  await test("holes are made and removed, vertices added, loops smoothed, curves pulled between pins", async () => {
    const before = await v.state();
    await page.click("[data-tool=hole]");
    const [, holed] = await v.drag(await v.place("place", 0.16, 0.05), 25, 0, 4);
    assert(holed.loops.length === 3 && holed.area < before.area, "no hole");
    await v.picture("hole");
    await page.click("[data-tool=add]");
    await page.mouse.click(...(await v.place("edge", 3)));
    await v.until((n) => window.barwright.state().edits === n + 2, before.edits);
    await page.click("[data-tool=pull]");
    for (const pin of [3, 5]) await page.mouse.click(...(await v.place("vertex", pin)));
    assert((await v.state()).pins.join() === "3,5", `pins ${(await v.state()).pins}`);
    const [, pulled] = await v.drag(await v.place("vertex", 4), 0, -25);
    assert(/outline:pull\(4/.test(pulled.script.at(-1)) && /pins = \{3, 5\}/.test(pulled.script.at(-1)), pulled.script.at(-1));
    await v.picture("pulled");
    await page.click("[data-tool=smooth]");
    await page.mouse.click(...(await v.place("edge", 6)));
    await v.until((n) => window.barwright.state().edits === n + 4, before.edits);
    await page.click("[data-tool=remove]");
    await page.mouse.click(...(await v.place("place", 0.16, 0.05)));
    await v.until(() => window.barwright.state().loops.length === 2);
    await page.click("[data-tool=drag]");
  });

  const other = await v.open();
  await test("a second window follows, looks at a field of its own, and shows who drags", async () => {
    await other.selectOption("#field", "displacement");
    await v.until(() => window.barwright.state().fields.displacement);
    assert((await v.state()).field === "von_mises", "the first window's field");
    await v.grab(await v.place("edge", 2), 15, 0);
    await v.until(() => window.barwright.state().drag);
    const refused = await other.evaluate(() => window.barwright.state().refused);
    await other.evaluate(() => window.barwright.send({ type: "begin", seq: 1, handle: { edge: 1 } }));
    for (const since = Date.now(); Date.now() - since < 120000; await other.waitForTimeout(30))
      if ((await other.evaluate(() => window.barwright.state().refused)) > refused) break;
    assert(/another window/.test(await other.textContent("#said")), await other.textContent("#said"));
    await page.mouse.up();
    await v.until(() => !window.barwright.state().drag);
  });

  await test("a window closed in the midst of a drag ends it", async () => {
    const { edits } = await v.state();
    await other.evaluate(() => {
      window.barwright.send({ type: "begin", seq: 1, handle: { vertex: 1 } });
      window.barwright.send({ type: "move", seq: 2, by: [-0.001, -0.001] });
    });
    await v.until(() => window.barwright.state().drag);
    await other.close();
    await v.until((n) => !window.barwright.state().drag && window.barwright.state().edits === n + 1, edits);
  });

  await test("nonsense is answered and changes nothing", async () => {
    const before = await v.state();
    for (const [message, said] of [[{ type: "begin", seq: 1, handle: { vertex: 999 } }, "whole number from 1"],
      [{ type: "edit", edit: { kind: "melt" } }, "of kind smooth"], [{ type: "tune", target: "C5" }, "no tone"]]) {
      await page.evaluate((m) => window.barwright.send(m), message);
      await v.until((text) => window.barwright.state().said.includes(text), said);
    }
    assert((await v.state()).edits === before.edits, "it changed");
  });

  await test("SVG and DXF are what is shown, and the kept edits make it again", async () => {
    const last = await v.state();
    for (const format of ["svg", "dxf"]) {
      const [file] = await Promise.all([page.waitForEvent("download"), page.click(`#${format}`)]);
      assert(file.suggestedFilename() === `steady.${format}`, file.suggestedFilename());
      const to = path.join(all.folder, `shape.${format}`);
      await file.saveAs(to);
      const text = execFileSync(path.join(all.root, "build/barwright"), ["-e",
        `print(assert(bw.outline.read("${to}")).area)`], { cwd: all.root });
      assert(Math.abs(Number(text) / last.area - 1) < 1e-4, `${format}: ${text} against ${last.area}`);
    }
    const [script] = await Promise.all([page.waitForEvent("download"), page.click("#lua")]);
    await script.saveAs(path.join(all.folder, "script.lua"));
    v.server.child.kill("SIGINT");
    const code = await v.server.ended;
    assert(code === 130 || code === 0, `ended with ${code}: ${v.server.text()}`);
    await v.until(() => document.getElementById("lost").textContent.includes("ended"));
    const kept = fs.readFileSync(v.server.edits, "utf8");
    assert(kept === fs.readFileSync(path.join(all.folder, "script.lua"), "utf8"), "two scripts");
    const text = execFileSync(path.join(all.root, "build/barwright"), ["-e",
      `for _, p in ipairs(dofile("${v.server.edits}").outline.points:totable()) do print(p[1], p[2]) end`], { cwd: all.root });
    const numbers = text.toString().trim().split(/\s+/).map((x) => Math.fround(Number(x)));
    const off = difference(last.points, numbers);
    assert(numbers.length === last.points.length && off < 1e-7, `off by ${off} m`);
    assert(v.problems.length === 0, v.problems.join("; "));
  });

  await test("a view that is begun again goes on where it was, and undoes what was done before", async () => {
    const last = await v.state();
    for (const file of [v.server.edits, v.server.edits.replace(".edits", "")]) {
      const again = serve(all.root, file);
      const later = await v.open(await again.address);
      const now = await v.drive(later);
      assert(now.edits === last.edits && difference(now.points, last.points) === 0, `${now.edits} edits: ${again.text()}`);
      await later.click("#undo");
      for (const since = Date.now(); (await v.drive(later)).edits === last.edits && Date.now() - since < 120000;) await later.waitForTimeout(30);
      assert((await v.drive(later)).edits === last.edits - 1, "no undo");
      await later.click("#redo");
      for (const since = Date.now(); (await v.drive(later)).edits < last.edits && Date.now() - since < 120000;) await later.waitForTimeout(30);
      await later.close();
      again.child.kill("SIGINT");
      await again.ended;
    }
  });
  await v.end();
}

async function vibration(all) {
  const { test, assert } = all;
  const v = await view(all, "vibration");
  await test("time goes on by itself, through drags, and pauses", async () => {
    const first = await v.state();
    await v.until((t) => window.barwright.state().time > t + 0.1, first.time);
    const [before, after] = await v.drag(await v.place("place", 0.05, 0.145), 0, 60, 30);
    assert(after.time > before.time && after.time > 0.1, "the drag stopped the time");
    assert(Math.abs(after.area - before.area) < 1e-9 && after.points[9] !== before.points[9], "the window moved");
    await v.picture("transient");
    console.log(`# transient: ${await v.page.textContent("#fps")} frames a second, ${JSON.stringify(after.levels)}`);
    await v.page.click("#pause");
    await v.until(() => !window.barwright.state().running);
    const { time } = await v.state();
    await v.page.waitForTimeout(300);
    assert((await v.state()).time === time, "it went on");
    const [, paused] = await v.drag(await v.place("edge", 2), 12, 0);
    assert(paused.time === time, "a drag while paused lets no time pass");
    await v.page.fill("#pace", "5");
    await v.page.press("#pace", "Enter");
    await v.page.click("#pause");
    await v.until((t) => window.barwright.state().time > t + 0.1, time);
    assert(v.problems.length === 0, v.problems.join("; "));
  });
  await v.end();
}

async function cantilever(all) {
  const { test, assert } = all;
  const v = await view(all, "cantilever");
  await test("a soft beam is drawn as it sags, and longer ones sag more", async () => {
    assert((await v.state()).goal > 16, "the goal is not there");
    const sag = async () => (await v.page.textContent("#results")).match(/([\d.]+) mm/)[1];
    const before = Number(await sag());
    await v.picture("start");
    await v.drag(await v.place("edge", 2), 60, 0, 20);
    const after = Number(await sag());
    assert(after > 1.1 * before, `${before} mm, then ${after} mm`);
    await v.picture("longer");
    assert(v.problems.length === 0, v.problems.join("; "));
  });
  await v.end();
}

async function bar(all) {
  const { test, assert } = all;
  const v = await view(all, "bar");
  const { page } = v;
  await test("a bar shows its pitch, nodal lines and where to support it", async () => {
    const now = await v.state();
    assert(now.frequency > 500 && now.frequency < 550 && now.note === "C5", `${now.frequency} Hz, ${now.note}`);
    assert(now.lines > 20 && now.holes.length === 2, `${now.lines} numbers of lines`);
    assert(Math.abs(now.holes[0][0] / 0.2 - 0.224) < 0.01, `supported at ${now.holes[0][0] / 0.2} of the length`);
    await v.picture("start");
  });

  await test("a click starts the sound of a stroke", async () => {
    assert(!(await v.state()).sound.running, "no sound before a click");
    await page.click("#strike");
    await v.until(() => window.barwright.state().sound.running && window.barwright.state().sound.loudest > 1e-3);
    const { sound, frequency } = await v.state();
    assert(sound.strokes === 1 && sound.sounding.length === 3, `${sound.sounding}`);
    assert(Math.abs(sound.sounding[0] / frequency - 1) < 1e-6, `${sound.sounding[0]} Hz`);
  });

  await test("while it is dragged, the tone follows if switched on, and a stroke ends the drag", async () => {
    await page.check("#beep");
    const before = await v.state();
    const [x, y] = await v.place("edge", 6);
    await v.grab([x, y], 40, 0, 20);
    await v.until(() => window.barwright.state().sound.following && window.barwright.state().drag);
    const during = await v.state();
    assert(Math.abs(during.sound.followed / during.frequency - 1) < 1e-6, `${during.sound.followed} Hz`);
    await page.mouse.up();
    await v.until(() => !window.barwright.state().drag && !window.barwright.state().sound.following);
    const after = await v.state();
    assert(after.frequency !== before.frequency, `${before.frequency} Hz, then ${after.frequency}`);
    assert(after.sound.strokes === 2, `${after.sound.strokes} strokes`);
    await v.picture("dragged");
  });

  await test("its mode swings where it is drawn deformed", async () => {
    const pixels = () => page.evaluate(() => document.querySelector("#view canvas").toDataURL());
    await page.$eval("#deflection", (input) => {
      input.value = 0.5;
      input.dispatchEvent(new Event("input"));
    });
    const first = await pixels();
    for (const since = Date.now(); first === (await pixels());) {
      assert(Date.now() - since < 120000, "it stands still");
      await page.waitForTimeout(30);
    }
    await v.picture("swings");
    await page.$eval("#deflection", (input) => {
      input.value = 0;
      input.dispatchEvent(new Event("input"));
    });
  });

  await test("it is tuned to a note", async () => {
    const { edits } = await v.state();
    await page.fill("#target", "D5");
    await page.click("#tune");
    await v.until((n) => window.barwright.state().edits === n + 1 && !window.barwright.state().busy, edits);
    const now = await v.state();
    assert(now.note === "D5" && Math.abs(now.cents) < 10, `${now.frequency} Hz`);
    assert(/tuned to 587\.33 Hz/.test(now.said), now.said);
    assert(now.script.at(-1) === 'assert(object:tune("D5"))', now.script.at(-1));
    await v.picture("tuned");
    await page.click("#undo");
    await v.until((n) => window.barwright.state().edits === n, edits);
    assert(v.problems.length === 0, v.problems.join("; "));
  });

  await test("vertices that are pinned stay where they are while it is tuned", async () => {
    const { edits, frequency } = await v.state();
    const target = Number((frequency * 1.03).toFixed(1)); // farther off the bar is stretched first, pins or not
    const places = () => Promise.all([1, 2, 3, 4, 5, 6, 7, 8].map((vertex) => v.place("vertex", vertex)));
    const before = await places();
    await page.click("[data-tool=pull]");
    for (const pin of [2, 1]) await page.mouse.click(...before[pin - 1]);
    assert((await v.state()).pins.join() === "2,1", `pins ${(await v.state()).pins}`);
    await page.fill("#target", `${target} Hz`);
    await page.click("#tune");
    await v.until((n) => window.barwright.state().edits === n + 1 && !window.barwright.state().busy, edits);
    const now = await v.state();
    assert(Math.abs(now.frequency / target - 1) < 5e-3, `${now.frequency} Hz, not ${target}`);
    assert(now.script.at(-1) === `assert(object:tune(${target}, {pins = {1, 2}}))`, now.script.at(-1));
    const moved = (await places()).map((p, i) => Math.hypot(p[0] - before[i][0], p[1] - before[i][1]));
    assert(moved[0] < 0.01 && moved[1] < 0.01, `the pinned moved by ${moved.slice(0, 2)} pixels`);
    assert(Math.max(...moved) > 1, `nothing moved by more than ${Math.max(...moved)} pixels`);
    await v.picture("pinned");
    await page.click("#undo");
    await v.until((n) => window.barwright.state().edits === n, edits);
    assert(v.problems.length === 0, v.problems.join("; "));
  });
  await v.end();
}

async function bridge(all) {
  const { test, assert } = all;
  const v = await view(all, "bridge", "scripts/bridge/session.lua");
  await test("a bridge is pulled and bored, its feet stay, and it says whether it passes", async () => {
    assert((await v.page.textContent("#title")) === "Bridge", await v.page.textContent("#title"));
    assert(/passes|fails/.test(await v.page.textContent("#results")), await v.page.textContent("#results"));
    const first = await v.state();
    assert(first.limit === 30e6, `limit ${first.limit}`);
    const low = (points) => Math.min(...points.filter((_, i) => i % 2));
    await v.page.click("[data-tool=pull]");
    const points = first.points.length / 2;
    let top = 0; // a vertex half way up the slope
    for (let i = 0; i < points; i++)
      if (first.points[2 * i] > 0.045 && first.points[2 * i] < 0.055 && first.points[2 * i + 1] > 0.05) top = i + 1;
    assert(top > 0, "no vertex on the slope");
    const [, pulled] = await v.drag(await v.place("place", first.points[2 * top - 2], first.points[2 * top - 1]), 6, -14);
    assert(pulled.area > first.area && /reach = /.test(pulled.script.at(-1)), pulled.script.at(-1));
    assert(low(pulled.points) === low(first.points), "the feet stay");
    await v.page.click("[data-tool=hole]");
    const [, bored] = await v.drag(await v.place("place", 0.03, 0.033), 14, 0, 4);
    assert(bored.area < pulled.area && bored.loops.length === 2, "no hole");
    assert(bored.level === "reconstruction", bored.level);
    await v.picture("bored");
    // A hole in the mirror image is one in the half that is designed: no region is asked for.
    const half = (await v.state()).edits;
    await v.page.click("#undo");
    await v.until((n) => window.barwright.state().edits === n - 1, half);
    const [, image] = await v.drag(await v.place("place", -0.03, 0.033), 14, 0, 4);
    assert(image.refused === bored.refused && !/region/.test(image.said), image.said);
    assert(image.loops.length === 2 && Math.abs(image.area / bored.area - 1) < 1e-3, `area ${image.area}, right half ${bored.area}`);
    await v.picture("bored_image");
    assert(v.problems.length === 0, v.problems.join("; "));
  });
  await v.end();
}

async function flows(all) {
  const { test, assert } = all;
  for (const [name, from, field] of [["flow", [0.6, 0.5], "speed"], ["kettle", null, "temperature"]]) {
    const v = await view(all, name);
    await test(`${name}: it goes on while its shape is dragged, with arrows`, async () => {
      await v.until(() => window.barwright.state().time > 0.1 && window.barwright.state().arrows > 20);
      await v.page.selectOption("#field", field);
      await v.until((key) => window.barwright.state().fields[key], field);
      const [before, after] = await v.drag(await (from ? v.place("place", ...from) : v.place("edge", 3)), 10, 25, 12);
      assert(after.time > before.time, "the drag stopped the time");
      assert(difference(before.points, after.points) > 0.01, "the shape stayed");
      await v.page.waitForTimeout(500);
      await v.picture("dragged");
      console.log(`# ${name}: ${await v.page.textContent("#fps")} frames a second, ${JSON.stringify(after.levels)}`);
      assert(!after.failure && v.problems.length === 0, `${after.failure} ${v.problems.join("; ")}`);
    });
    if (name === "flow") await test("flow: the red message of a refused drag goes away with undo", async () => {
      const before = await v.state();
      await v.grab(await v.place("place", ...from), 0, 30, 4);
      await v.until((n) => window.barwright.state().states > n + 2, before.states);
      const box = await v.page.locator("#over").boundingBox();
      await v.page.mouse.move(box.x + box.width / 2, box.y + 2, { steps: 3 }); // out of the channel
      await v.until((n) => window.barwright.state().refused > n, before.refused);
      assert(await v.page.evaluate(() => document.getElementById("said").classList.contains("bad")), "no red message");
      await v.page.mouse.up();
      await v.until(() => !window.barwright.state().drag);
      await v.page.click("#undo");
      await v.until(() => {
        const said = document.getElementById("said");
        return !said.textContent || !said.classList.contains("bad");
      });
    });
    await v.end();
  }
}

const parts = { steady, vibration, cantilever, bar, bridge, flows };

// BARWRIGHT_PLANE names the parts wanted.
export async function plane(all) {
  const wanted = process.env.BARWRIGHT_PLANE?.split(" ") || Object.keys(parts);
  for (const name of wanted) await parts[name](all);
}
