// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The live view in headless Chromium: handles dragged with the mouse, undo, a second window, a window
// that is closed in the midst of a drag, the exports, the saved script.
import { execFileSync } from "node:child_process";
import path from "node:path";
import { begin, difference } from "./live_driver.mjs";

export async function live({ browser, root, folder, test, assert, pictures }) {
  const drive = await begin({ browser, root, folder, pictures, session: "tests/lua/live_session.lua" });
  const { server, context, problems, address, open, state, until, picture, grab, drag, pick } = drive;

  const page = await open();

  await test("the live view opens without errors and shows the largest stress", async () => {
    assert(problems.length === 0, problems.join("; "));
    const now = await state(page);
    assert(now.maximum > 3e7 && now.maximum < 6e7, `${now.maximum} Pa`);
    assert(now.error > 0.01 && now.error < 0.5, `error ${now.error}`);
    assert((await page.textContent("#maximum")).startsWith((now.maximum / 1e6).toPrecision(4)), "readout");
    await picture(page, "live_start");
  });

  await test("a click on the part picks the bone", async () => {
    await pick(page, "nose");
    await pick(page, "arm");
    await page.keyboard.press("]");
    assert((await state(page)).bone === "nose", "the key ] goes on");
    await page.keyboard.press("[");
  });

  await test("dragging a scale handle thickens the part and lowers the stress; undo brings it back", async () => {
    await page.keyboard.press("s");
    await picture(page, "live_scale");
    const [before, after] = await drag(page, "Z", 0, -30);
    assert(after.maximum < 0.95 * before.maximum, `${before.maximum} Pa, then ${after.maximum}`);
    assert(difference(before.box, after.box) > 5e-4, `the outline stayed: ${before.box}, ${after.box}`);
    await picture(page, "live_scaled");
    await page.click("#undo");
    await until(page, () => window.barwright.state().edits === 0);
    const back = await state(page);
    assert(difference(back.positions, before.positions) === 0, "undo left another shape");
    assert(Math.abs(back.maximum / before.maximum - 1) < 1e-6, `${back.maximum} Pa after undo`);
    await page.keyboard.press("Control+Shift+z");
    await until(page, () => window.barwright.state().edits === 1);
    assert(difference((await state(page)).positions, after.positions) === 0, "redo makes another shape");
  });

  await test("a bone is rotated, moved and reached for with the mouse", async () => {
    await pick(page, "nose");
    await page.keyboard.press("r");
    const [, rotated] = await drag(page, "Y", 25, 25);
    await picture(page, "live_turned");
    await page.click("[data-mode=translate]");
    const [, moved] = await drag(page, "X", 15, 8);
    assert(difference(rotated.positions, moved.positions) > 1e-4, "the part stayed");
    await page.click("[data-mode=reach]");
    const [, reached] = await drag(page, "XYZ", -10, -25);
    assert(difference(moved.positions, reached.positions) > 1e-4, "the part stayed");
    assert(reached.edits === 4, `${reached.edits} edits: every drag is one`);
    await picture(page, "live_reached");
  });

  const other = await open();
  await test("a second window follows, and shows who drags", async () => {
    assert((await state(other)).edits === 4, "it begins with the present state");
    await page.keyboard.press("s");
    await grab(page, "Z", 0, -15);
    await until(other, () => window.barwright.state().drag);
    const [a, b] = [await state(page), await state(other)];
    assert(b.drag.client === a.me, "the drag of the first");
    await other.keyboard.press("Control+z");
    assert((await state(other)).edits === 4, "no undo in the midst of a drag");
    await page.keyboard.press("Escape");
    await until(other, () => !window.barwright.state().drag);
    assert((await state(other)).edits === 4, "Escape takes the drag back");
    await page.mouse.up();
  });

  await test("a window closed in the midst of a drag ends it", async () => {
    const third = await open();
    await pick(third, "arm");
    await third.keyboard.press("s");
    await grab(third, "Y", 15, 6);
    await until(page, () => window.barwright.state().drag);
    await third.close();
    await until(page, () => !window.barwright.state().drag);
    assert((await state(page)).edits === 5, "what was dragged stays");
    await drag(page, "Z", 0, -10);
  });

  await test("a lost connection shows, and comes back", async () => {
    const lost = await context.newPage();
    const routes = [];
    await lost.routeWebSocket(/socket$/, (route) => {
      route.connectToServer();
      routes.push(route);
    });
    await lost.goto(address);
    await until(lost, () => window.barwright?.state().revision > 0);
    await routes[0].close({ code: 1011, reason: "for the test" });
    await until(lost, () => !document.getElementById("lost").hidden);
    assert(/connection is lost/.test(await lost.textContent("#lost")), "it does not say so");
    await until(lost, () => window.barwright.state().connected && document.getElementById("lost").hidden);
    await page.keyboard.press("Control+z");
    const { edits } = await state(page);
    await until(lost, (n) => window.barwright.state().edits === n - 1, edits);
    await page.keyboard.press("Control+Shift+z");
    await until(lost, (n) => window.barwright.state().edits === n, edits);
    await lost.close();
  });

  await test("nonsense is answered and changes nothing", async () => {
    const before = await state(page);
    await page.evaluate(() => window.barwright.send({ type: "edit", bone: "tail", change: { scale: [1, 1, 1] } }));
    await until(page, () => window.barwright.state().said.includes("name of a bone"));
    await page.evaluate(() => window.barwright.send({ type: "edit", bone: "nose",
      change: { rotate: { axis: [0, 1, 0], degrees: -170 } } }));
    await until(page, () => window.barwright.state().said.includes("folds the part over itself"));
    await picture(page, "live_refused");
    const after = await state(page);
    assert(after.edits === before.edits && difference(after.positions, before.positions) === 0, "it changed");
  });

  await test("the optimiser brings the stress under the limit", async () => {
    const { maximum } = await state(page);
    const limit = ((0.8 * maximum) / 1e6).toFixed(2);
    await page.fill("#limit", limit);
    await page.click("#optimise");
    await until(page, () => window.barwright.state().said.includes("would move support 1"));
    await until(page, () => !window.barwright.state().busy);
    await page.check("#move_supports");
    await page.click("#optimise");
    await until(page, (most) => window.barwright.state().maximum <= most * 1.0001e6 && !window.barwright.state().busy,
      Number(limit));
    await picture(page, "live_optimised");
  });

  await test("the exported STL is the closed surface of the design, as near to what is shown as is said", async () => {
    const [file] = await Promise.all([page.waitForEvent("download"), page.click("#stl")]);
    assert(file.suggestedFilename() === "hook.stl", file.suggestedFilename());
    const stl = path.join(folder, "out.stl");
    await file.saveAs(stl);
    const text = execFileSync(path.join(root, "build/barwright"), ["-e",
      `local s = assert(bw.surface.read("${stl}")) print(s:check().sound, s.box.min[1], s.box.max[3])`], { cwd: root });
    const [sound, low, high] = text.toString().trim().split(/\s+/);
    const { box } = await state(page);
    assert(sound === "true", `not sound: ${text}`);
    const { said } = await state(page);
    const [, size, unit] = said.match(/; ([\d.e-]+) (mm|um|nm) from the boundary of the mesh at most/) || [];
    const deviation = size * { mm: 1e-3, um: 1e-6, nm: 1e-9 }[unit];
    assert(deviation > 0 && deviation < 1e-3, said);
    for (const [exported, shown] of [[low, box[0]], [high, box[5]]])
      assert(Math.abs(exported - shown) <= 1.01 * deviation, `${text} against ${box}: ${said}`);
  });

  await test("Ctrl-C ends it, the pages say so, and the saved script replays to the same shape", async () => {
    const last = await state(page);
    server.child.kill("SIGINT");
    const code = await server.ended;
    assert(code === 130, `ended with ${code}: ${server.text()}`);
    await until(page, () => document.getElementById("lost").textContent.includes("ended"));
    const text = execFileSync(path.join(root, "build/barwright"), ["-e",
      `local s = assert(bw.edit.load("${server.edits}")) local p = s.mesh:surface().points
       print(#s.edits) for _, row in ipairs(p:totable()) do print(row[1], row[2], row[3]) end`], { cwd: root });
    const [edits, ...numbers] = text.toString().trim().split(/\s+/).map(Number);
    assert(edits === last.edits, `${edits} edits, ${last.edits} shown`);
    assert(numbers.length === last.positions.length, "another surface");
    const off = difference(last.positions, numbers.map(Math.fround));
    assert(off === 0, `off by ${off} m`);
    assert(problems.length === 0, problems.join("; "));
  });

  await context.close();
  server.child.kill("SIGKILL");
}
