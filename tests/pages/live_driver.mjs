// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// A live view to be tested: its server, and windows that are used with the mouse.
import { spawn } from "node:child_process";
import fs from "node:fs";
import path from "node:path";

export const difference = (a, b) => Math.max(...a.map((x, i) => Math.abs(x - b[i])));

// Starts `barwright live` on a file; gives its address and a way to end it.
export function serve(root, file, before) {
  const run = before
    ? ["-e", `${before} require("barwright.command").run("live", "${file}", "--no-open")`]
    : ["live", file, "--no-open"];
  const child = spawn(path.join(root, "build/barwright"), run, {
    cwd: root,
    env: { ...process.env, BARWRIGHT_QUIET: "1" },
  });
  let out = "";
  let err = "";
  child.stderr.on("data", (text) => (err += text));
  const ended = new Promise((resolve) => child.on("exit", (code) => resolve(code)));
  const address = new Promise((resolve, reject) => {
    child.stdout.on("data", (text) => {
      out += text;
      const found = out.match(/http:\/\/\S+/);
      if (found) resolve(found[0]);
    });
    ended.then((code) => reject(new Error(`ended with ${code}: ${out}${err}`)));
  });
  address.catch(() => {});
  return { child, address, ended, text: () => out + err, edits: file.replace(/\.lua$/, ".edits.lua") };
}

// The same on a copy of a session's file.
function start(root, folder, session, before) {
  const name = path.basename(session) === "live_session.lua" ? "hook.lua" : path.basename(session);
  const file = path.join(folder, name);
  fs.copyFileSync(path.join(root, session), file);
  return serve(root, file, before);
}

// A server on a session's file, in a folder of its own, and a browser's windows on it. `before`: Lua to
// be run before the server begins.
export async function begin({ browser, root, folder, pictures, session, before }) {
  const own = fs.mkdtempSync(path.join(folder, "live-"));
  const server = start(root, own, session, before);
  const address = await server.address;
  const context = await browser.newContext({ viewport: { width: 1280, height: 860 }, acceptDownloads: true });
  const problems = [];

  async function open(at = address) {
    const page = await context.newPage();
    page.on("pageerror", (error) => problems.push(error.message));
    page.on("console", (line) => line.type() === "error" && problems.push(line.text()));
    await page.goto(at);
    if (!before) await until(page, () => window.barwright?.state().revision > 0);
    return page;
  }
  const state = (page) => page.evaluate(() => window.barwright.state());
  // page.waitForFunction evaluates text inside the page, which the page's policy forbids.
  async function until(page, what, argument) {
    for (const since = Date.now(); Date.now() - since < 120000; await page.waitForTimeout(30))
      if (await page.evaluate(what, argument)) return;
    throw new Error(`in vain: ${what} with ${argument}; ${JSON.stringify({ ...(await state(page)), positions: 0, points: 0 })}`);
  }
  const picture = (page, name) => pictures && page.screenshot({ path: path.join(pictures, `${name}.png`) });

  // Takes a handle of what is chosen with the mouse and pulls it; leaves the button down.
  async function grab(page, axis, dx, dy) {
    const [x, y] = await page.evaluate((a) => window.barwright.handle(a), axis);
    await page.mouse.move(x - 3, y - 3);
    await page.mouse.move(x, y, { steps: 3 });
    await page.mouse.down();
    await page.mouse.move(x + dx, y + dy, { steps: 8 });
    return [x + dx, y + dy];
  }
  async function drag(page, axis, dx, dy) {
    const old = await state(page);
    await grab(page, axis, dx, dy);
    await page.mouse.up();
    await until(page, (edits) => {
      const now = window.barwright.state();
      return now.edits === edits + 1 && !now.drag;
    }, old.edits);
    return [old, await state(page)];
  }
  const pick = async (page, bone) => {
    const [x, y] = await page.evaluate((b) => window.barwright.place(b), bone);
    await page.mouse.click(x, y);
    await until(page, (b) => window.barwright.state().bone === b, bone);
  };
  const end = async () => {
    await context.close();
    server.child.kill("SIGKILL");
  };
  return { server, context, problems, address, open, state, until, picture, grab, drag, pick, end };
}
