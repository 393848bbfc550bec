// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The creases of a surface as thin lines that follow it: edges whose facets differ by over 30 degrees.
import * as THREE from "three";

const SHARP = Math.cos(Math.PI / 6);

// The unit normals of triangles, one after another.
function normalsOf(points, triangles) {
  const out = new Float32Array(triangles.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const [ux, uy, uz] = [points[b] - points[a], points[b + 1] - points[a + 1], points[b + 2] - points[a + 2]];
    const [vx, vy, vz] = [points[c] - points[a], points[c + 1] - points[a + 1], points[c + 2] - points[a + 2]];
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    const length = Math.hypot(x, y, z) || 1;
    out[t] = x / length;
    out[t + 1] = y / length;
    out[t + 2] = z / length;
  }
  return out;
}

// The ends of the creases, two points each.
export function creasesOf(points, triangles) {
  const normals = normalsOf(points, triangles);
  const first = new Map(); // of each edge: where the normal of the first triangle lies that has it
  const ends = [];
  const count = points.length / 3;
  for (let t = 0; t < triangles.length; t += 3)
    for (let i = 0; i < 3; i++) {
      const [from, to] = [triangles[t + i], triangles[t + ((i + 1) % 3)]];
      const [p, q] = [Math.min(from, to), Math.max(from, to)];
      const key = p * count + q;
      const other = first.get(key);
      if (other === undefined) first.set(key, t);
      else {
        first.delete(key);
        const cosine = normals[t] * normals[other] + normals[t + 1] * normals[other + 1] + normals[t + 2] * normals[other + 2];
        if (cosine < SHARP) ends.push(p, q);
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
