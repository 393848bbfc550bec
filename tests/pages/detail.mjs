// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Level of detail: what a coarse surface is, and that a large body is drawn with it only while it turns.
import { execFileSync } from "node:child_process";
import path from "node:path";

// A box of n x n squares a side, of two triangles each, whose sides share points.
function box(n, sizes) {
  const points = [];
  const triangles = [];
  const numbers = new Map();
  const point = (at) => {
    const key = at.join();
    if (!numbers.has(key)) {
      numbers.set(key, numbers.size);
      points.push(...at.map((x, k) => (x / n) * sizes[k]));
    }
    return numbers.get(key);
  };
  for (let axis = 0; axis < 3; axis++)
    for (const side of [0, n])
      for (let i = 0; i < n; i++)
        for (let j = 0; j < n; j++) {
          const [a, b, c, d] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(([u, v]) => {
            const at = [0, 0, 0];
            [at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]] = [side, u, v];
            return point(at);
          });
          triangles.push(...(side ? [a, b, c, a, c, d] : [a, c, b, a, d, c]));
        }
  return [Float32Array.from(points), Uint32Array.from(triangles)];
}

function volume(p, triangles) {
  let sum = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => p.subarray(3 * triangles[t + k], 3 * triangles[t + k] + 3));
    sum += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return sum / 6;
}

export async function detail({ browser, root, folder, test, assert, pictures }) {
  const { coarsen, MOST } = await import(path.join(root, "web/coarsen.mjs"));
  const { Pace } = await import(path.join(root, "web/pace.mjs"));

  await test("pictures of a moving view lose pixels until 30 come a second, and no more, and get them back", () => {
    const pace = new Pace();
    let now = 0;
    // The interval of a display with 60 pictures a second, where a picture with all pixels takes a time.
    const turn = (whole, pictures) => {
      const seen = [];
      for (let i = 0; i < pictures; i++) {
        const share = pace.share;
        now += Math.max(1, Math.ceil((whole * share * share) / 16.7)) * 16.7;
        pace.picture(now);
        seen.push(share);
      }
      return seen.slice(-16);
    };
    for (const whole of [5, 300, 30, 70, 150, 5]) {
      const shares = turn(whole, 80);
      const fewest = Math.min(...shares);
      const interval = Math.max(16.7, whole * fewest * fewest);
      assert(shares.every((share) => share === fewest), `${whole} ms: the sharpness changes on and on, ${shares}`);
      assert(interval <= 34 || fewest === 0.4, `${whole} ms: ${interval} ms between pictures`);
      assert(fewest === 1 || (whole * fewest * fewest) / 0.64 > 16.7, `${whole} ms: ${fewest} is less than needed`);
    }
    assert(pace.share === 1, "all pixels are back");
    now += 5000;
    assert(pace.picture(now) === 1, "a pause is no slow picture");
  });

  await test("a coarse surface keeps corners, volume and both sides of a thin plate, with few triangles", () => {
    for (const sizes of [[1, 1, 1], [1, 1, 0.002], [1, 0.1, 0.02]]) {
      const [points, triangles] = box(120, sizes);
      const coarse = coarsen(points, triangles);
      const count = coarse.length / 3;
      assert(count <= MOST && count > MOST / 4, `${count} triangles of ${triangles.length / 3}`);
      const off = Math.abs(volume(points, coarse) / volume(points, triangles) - 1);
      assert(off < 0.02, `the volume of ${sizes} changes by ${off}`);
      const used = new Set(Array.from(coarse, (i) => points.subarray(3 * i, 3 * i + 3).join()));
      for (let k = 0; k < 8; k++) {
        const corner = Float32Array.from(sizes, (size, i) => ((k >> i) & 1 ? size : 0)).join();
        assert(used.has(corner), `the corner ${corner} is lost`);
      }
    }
    const [points, triangles] = box(10, [1, 1, 1]);
    assert(coarsen(points, triangles) === triangles, "a small surface is drawn whole");
  });

  // 384,000 elements of ten nodes, whose fields are formulas.
  execFileSync(path.join(root, "build/barwright"), [path.join(root, "tests/pages/detail.lua"), `${folder}/large.html`],
    { cwd: root });
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 } });
  page.setDefaultTimeout(120000);
  const drawn = () => page.evaluate(() => window.barwright.state().drawn);
  const until = async (condition) => {
    for (const since = Date.now(); !(await condition()); await page.waitForTimeout(30))
      assert(Date.now() - since < 120000, `in vain: ${condition}`);
  };

  await test("a body of 384,000 elements is drawn coarse while it turns, whole when it rests, for a part of the time", async () => {
    await page.goto(`file://${folder}/large.html`);
    await page.waitForFunction(() => window.barwright);
    const { triangles } = await page.evaluate(() => window.barwright.state());
    await until(async () => (await page.evaluate(() => window.barwright.state().sharpness)) === 1);
    assert(triangles > 70000, `${triangles} triangles`);
    await until(async () => (await drawn()) === triangles);
    const box = await page.locator("#view canvas").boundingBox();
    await page.mouse.move(box.x + 300, box.y + 300);
    await page.mouse.down();
    await page.mouse.move(box.x + 380, box.y + 320, { steps: 4 });
    assert((await drawn()) <= MOST, `${await drawn()} triangles while it turns`);
    if (pictures) await page.screenshot({ path: path.join(pictures, "detail_turning.png") });
    await page.mouse.up();
    await until(async () => (await drawn()) === triangles);
    const sharpness = await page.evaluate(() => window.barwright.state().sharpness);
    assert(sharpness === 1, `a picture at rest has ${sharpness} of its pixels along a side`);
    if (pictures) await page.screenshot({ path: path.join(pictures, "detail_resting.png") });
    const costs = await page.evaluate(() => [0, 1, 2].map(() =>
      [window.barwright.cost(true, 3), window.barwright.cost(false, 3)]));
    const [whole, coarse] = [0, 1].map((k) => Math.min(...costs.map((pair) => pair[k])));
    console.log(`# a picture of ${triangles} triangles takes ${whole.toFixed(0)} ms whole, ${coarse.toFixed(0)} ms coarse`);
    assert(coarse < 0.7 * whole, `${coarse} ms coarse, ${whole} ms whole`);
  });
  await page.close();
}
