// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The creases of a surface as thin lines that follow it: edges whose facets differ by over 30 degrees.
import * as THREE from "three";

const SHARP = Math.cos(Math.PI / 6);

function normal(points, a, b, c) {
  const [ux, uy, uz] = [0, 1, 2].map((k) => points[3 * b + k] - points[3 * a + k]);
  const [vx, vy, vz] = [0, 1, 2].map((k) => points[3 * c + k] - points[3 * a + k]);
  const n = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
  const length = Math.hypot(...n) || 1;
  return n.map((x) => x / length);
}

// The ends of the creases, two points each.
export function creasesOf(points, triangles) {
  const first = new Map();
  const ends = [];
  const count = points.length / 3;
  for (let t = 0; t < triangles.length; t += 3) {
    const corner = triangles.subarray(t, t + 3);
    const n = normal(points, ...corner);
    for (let i = 0; i < 3; i++) {
      const p = Math.min(corner[i], corner[(i + 1) % 3]);
      const q = Math.max(corner[i], corner[(i + 1) % 3]);
      const key = p * count + q;
      const other = first.get(key);
      if (!other) first.set(key, n);
      else if (n[0] * other[0] + n[1] * other[1] + n[2] * other[2] < SHARP) ends.push(p, q);
    }
  }
  return ends;
}

export class Creases {
  // Over a geometry whose positions move; `rest`: where they are at first.
  constructor(scene, geometry, rest, triangles) {
    const ends = creasesOf(rest, triangles);
    this.count = ends.length / 2;
    const own = new THREE.BufferGeometry();
    own.setAttribute("position", geometry.getAttribute("position"));
    own.setIndex(new THREE.BufferAttribute(new Uint32Array(ends), 1));
    this.lines = new THREE.LineSegments(own, new THREE.LineBasicMaterial({ color: 0x1d2733 }));
    this.lines.frustumCulled = false;
    scene.add(this.lines);
  }
}
