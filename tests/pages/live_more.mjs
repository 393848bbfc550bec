// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The live view in headless Chromium: joints pulled with the mouse, how far bones may turn then, bones
// that are tied, the worst load, a drag that outruns the solver, the message in place of the page.
import { begin, difference } from "./live_driver.mjs";

const along = (a, b) => {
  const d = b.map((x, k) => x - a[k]);
  const length = Math.hypot(...d);
  return d.map((x) => x / length);
};

export async function liveMore({ browser, root, folder, test, assert, pictures }) {
  const drive = await begin({ browser, root, folder, pictures, session: "tests/lua/live_session.lua" });
  const { problems, state, until, picture, drag, pick } = drive;
  const page = await drive.open();
  const pickJoint = async (name) => {
    const [x, y] = await page.evaluate((j) => window.barwright.ball(j), name);
    await page.mouse.click(x, y);
    await until(page, (j) => window.barwright.state().joint === j, name);
  };
  // The cosine of the angle between the two bones.
  const bend = ({ joints }) => {
    const [a, b] = [along(joints.wall, joints.bend), along(joints.bend, joints.tip)];
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  };

  await test("a joint is picked and pulled with the mouse, and bones turn to get there", async () => {
    await pickJoint("tip");
    assert((await page.$$eval("#joints button.on", (on) => on.map((b) => b.textContent))).join() === "tip", "the list");
    await picture(page, "live_joint");
    const [before, after] = await drag(page, "XYZ", -25, -15);
    const moved = after.joints.tip.map((x, k) => x - before.joints.tip[k]);
    assert(Math.hypot(...moved) > 1e-3, `the joint moved by ${moved}`);
    const [x, y] = await page.evaluate(() => window.barwright.ball("tip"));
    assert(Number.isFinite(x + y), "the joint is on the screen");
    assert(difference(before.positions, after.positions) > 1e-3, "the part stayed");
    assert(/reach/.test(await page.textContent("#script li:last-child")), "the edit is no reach");
    await picture(page, "live_joint_pulled");
  });

  await test("the root takes everything along", async () => {
    await pickJoint("wall");
    const [before, after] = await drag(page, "Z", 0, -20);
    for (const name of ["wall", "bend", "tip"]) {
      const by = after.joints[name].map((x, k) => x - before.joints[name][k]);
      assert(by[2] > 1e-4 && Math.abs(by[0]) + Math.abs(by[1]) < 1e-7, `${name} moved by ${by}`);
    }
    await page.keyboard.press("Control+z");
    await until(page, () => window.barwright.state().edits === 1);
  });

  await test("a bone turns no farther than it may when a joint is pulled", async () => {
    await page.click("#reset");
    await until(page, () => window.barwright.state().edits === 2);
    await pick(page, "nose");
    await page.click("#joint-limits summary");
    await page.fill("#swing", "2");
    await page.keyboard.press("Tab");
    await until(page, () => window.barwright.state().joint_limits[1]?.swing === 2);
    await page.fill("#twist_min", "-5");
    await page.fill("#twist_max", "10");
    await page.keyboard.press("Tab");
    await until(page, () => window.barwright.state().joint_limits[1]?.twist?.join() === "-5,10");
    await picture(page, "live_bend");
    await pickJoint("tip");
    const [before, after] = await drag(page, "XYZ", -40, -20);
    const angle = (Math.abs(Math.acos(bend(after)) - Math.acos(bend(before))) * 180) / Math.PI;
    assert(angle < 2.001, `the nose rotated by ${angle} degrees`);
    assert(difference(before.joints.tip, after.joints.tip) > 1e-3, "the joint stayed");
    await page.fill("#swing", "");
    await page.fill("#twist_min", "");
    await page.fill("#twist_max", "");
    await page.keyboard.press("Tab");
    await until(page, () => window.barwright.state().joint_limits[1] === null);
    await page.click("#reset");
    await until(page, () => !document.getElementById("reset").disabled && window.barwright.state().joints.bend[2] === 0);
  });

  await test("tied bones are thickened alike", async () => {
    await pick(page, "arm");
    await page.selectOption("#tie", "nose");
    await until(page, () => window.barwright.state().ties.length === 1);
    const { maximum } = await state(page);
    await page.fill("#limit", ((0.8 * maximum) / 1e6).toFixed(2));
    await page.check("#move_supports");
    await page.click("#optimise");
    await until(page, (most) => window.barwright.state().maximum <= most && !window.barwright.state().busy,
      0.801 * maximum);
    const { factors } = await state(page);
    assert(factors[0][1] > 1.001, `factors ${JSON.stringify(factors)}`);
    assert(difference(factors[0], factors[1]) < 1e-9, `factors ${JSON.stringify(factors)}`);
    await picture(page, "live_tied");
    await page.click("#ties button");
    await until(page, () => window.barwright.state().ties.length === 0);
  });

  await test("the worst load is found, shown, and marked as that of an earlier shape after an edit", async () => {
    const own = await state(page);
    await page.evaluate(() => {
      window.heard = []; // what is said, and whose stresses are shown then
      new MutationObserver(() => window.heard.push([window.barwright.state().said, window.barwright.state().loads.kind]))
        .observe(document.getElementById("said"), { childList: true, characterData: true, subtree: true });
    });
    await page.selectOption("#loads", "worst");
    await until(page, () => window.barwright.state().loads.kind === "worst" && !window.barwright.state().busy);
    const worst = await state(page);
    const outcome = (await page.evaluate(() => window.heard)).filter(([said]) => said.startsWith("the worst load of"));
    assert(outcome.length > 0 && outcome.every(([, kind]) => kind === "worst"), JSON.stringify(outcome));
    assert(worst.arrows >= 2, `${worst.arrows} arrows: a balanced load needs two or more`);
    assert(Math.abs(worst.maximum / own.maximum - 1) > 0.1, `${own.maximum} Pa, then ${worst.maximum}`);
    assert(!worst.loads.outdated && (await page.isHidden("#again")), "it is new");
    await picture(page, "live_worst");
    await pick(page, "nose");
    await page.keyboard.press("s");
    const [, edited] = await drag(page, "Z", 0, -25);
    assert(edited.loads.outdated && (await page.isVisible("#again")), "it is of an earlier shape");
    await page.click("#again");
    await until(page, () => !window.barwright.state().loads.outdated && !window.barwright.state().busy);
    await page.selectOption("#loads", "own");
    await until(page, () => window.barwright.state().loads.kind === "own");
    const back = await state(page);
    assert(back.arrows === 0, `${back.arrows} arrows`);
    await page.keyboard.press("Control+z");
    await until(page, (edits) => window.barwright.state().edits === edits - 1, back.edits);
    assert(Math.abs((await state(page)).maximum / own.maximum - 1) < 1e-6, "other stresses than before");
    assert(problems.length === 0, problems.join("; "));
  });
  await drive.end();

  const heavy = await begin({ browser, root, folder, pictures, session: "tests/pages/live_heavy.lua" });
  await test("a drag that outruns the solver shows every shape at once and ends where the hand ends", async () => {
    const window_ = await heavy.open();
    await window_.keyboard.press("s");
    const before = await heavy.state(window_);
    const [x, y] = await heavy.grab(window_, "Z", 0, -6);
    for (let k = 1; k <= 30; k++) {
      await window_.mouse.move(x, y - k);
      await window_.waitForTimeout(40);
    }
    const rested = Date.now();
    await heavy.until(window_, () => window.barwright.state().underWay === 0);
    const lag = (Date.now() - rested) / 1000;
    const moving = await heavy.state(window_);
    const [shapes, states] = [moving.shapes - before.shapes, moving.states - before.states];
    await window_.mouse.up();
    const up = Date.now();
    await heavy.until(window_, (edits) => {
      const now = window.barwright.state();
      return now.edits === edits + 1 && !now.drag;
    }, before.edits);
    const wait = (Date.now() - up) / 1000;
    const after = await heavy.state(window_);
    const solve = Math.max(moving.seconds, after.seconds);
    console.log(`  ${shapes} shapes and ${states} stresses while it was dragged; a solve takes ${solve.toFixed(2)} s, the ` +
      `last shape came ${lag.toFixed(2)} s after the hand rested, the last stresses ${wait.toFixed(2)} s after it let go`);
    // of moves that wait only the newest is done: how many, depends on the machine
    assert(shapes + states >= 1, `${shapes} shapes, ${states} stresses`);
    assert(difference(moving.positions, after.positions) < 1e-6, "it ended elsewhere");
    assert(after.maximum < before.maximum, "a thicker part carries more");
    await heavy.picture(window_, "live_heavy");
  });
  await heavy.end();

  const bare = await begin({ browser, root, folder, pictures, session: "tests/lua/live_session.lua",
    before: 'local b = require "barwright.beside" local f = b.find ' +
      'function b.find(name) return name ~= "live.js" and f(name) or nil end' });
  await test("where the page was not bundled, a message says what to do", async () => {
    const window_ = await bare.open();
    const text = await window_.textContent("body");
    assert(/nodejs and npm/.test(text) && /scripts\/setup/.test(text), text);
    assert(bare.problems.length === 0, bare.problems.join("; "));
    await bare.picture(window_, "live_missing");
  });
  await bare.end();
}
