// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// What is aimed at is in the picture: random boxes, directions and shapes of the view, by three's own projection.
import path from "node:path";

// Numbers from 0 to 1, the same ones in every run.
function randomly(seed) {
  let state = seed >>> 0;
  return () => ((state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 4294967296);
}

export async function fit({ root, test, assert }) {
  const THREE = await import(path.join(root, "web/node_modules/three/build/three.module.js"));
  const { fitDistance, LEAST } = await import(path.join(root, "web/fit.mjs"));

  await test("a box of any shape is wholly in a view of any shape, from every direction, and fills it", () => {
    const random = randomly(20);
    const camera = new THREE.PerspectiveCamera(35, 1, 1e-9, 1e9);
    camera.up.set(0, 0, 1);
    let least = 1;
    for (let trial = 0; trial < 20000; trial++) {
      const sizes = [0, 1, 2].map(() => (random() < 0.1 ? 0 : 10 ** (6 * random() - 4)));
      if (Math.max(...sizes) === 0) continue;
      const from = trial % 20 === 0 ? [0, 0, trial % 40 ? 1 : -1] : [random() - 0.5, random() - 0.5, random() - 0.5];
      camera.aspect = 10 ** (2 * random() - 1);
      camera.updateProjectionMatrix();
      const distance = fitDistance(sizes, from, [0, 0, 1], camera.fov, camera.aspect);
      camera.position.set(...from).normalize().multiplyScalar(distance);
      camera.lookAt(0, 0, 0);
      camera.updateMatrixWorld();
      let most = 0;
      for (let k = 0; k < 28; k++) {
        const at = sizes.map((size, i) => size * (k < 8 ? ((k >> i) & 1) - 0.5 : random() - 0.5));
        const place = new THREE.Vector3(...at).project(camera);
        const off = Math.max(Math.abs(place.x), Math.abs(place.y));
        assert(off <= 1 && place.z < 1, `a box ${sizes} from ${from} at ${camera.aspect}: ${place.toArray()}`);
        most = Math.max(most, off);
      }
      if (distance > 1.001 * LEAST * Math.hypot(...sizes)) least = Math.min(least, most);
    }
    assert(least > 0.9, `a box takes only ${least} of the picture`);
  });
}
