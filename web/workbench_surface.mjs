// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// What the workbench derives from a surface of triangles with a face for each: normals that are smooth within a face,
// the edges between faces, and which faces meet.

const none = 0xffffffff;
const smooth = Math.cos((40 * Math.PI) / 180);

// The triangles at each point: those of point p are list[first[p]] to list[first[p + 1] - 1].
function trianglesAtPoints(triangles, points) {
  const first = new Uint32Array(points + 1);
  for (let i = 0; i < triangles.length; i++) first[triangles[i] + 1]++;
  for (let p = 0; p < points; p++) first[p + 1] += first[p];
  const next = first.slice(0, points);
  const list = new Uint32Array(triangles.length);
  for (let i = 0; i < triangles.length; i++) list[next[triangles[i]]++] = (i / 3) | 0;
  return { first, list };
}

// Normals of triangles, of the length of twice their area.
export function facetNormals(positions, triangles) {
  const out = new Float32Array(triangles.length);
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = [3 * triangles[i], 3 * triangles[i + 1], 3 * triangles[i + 2]];
    const [ux, uy, uz] = [positions[b] - positions[a], positions[b + 1] - positions[a + 1], positions[b + 2] - positions[a + 2]];
    const [vx, vy, vz] = [positions[c] - positions[a], positions[c + 1] - positions[a + 1], positions[c + 2] - positions[a + 2]];
    out[i] = uy * vz - uz * vy;
    out[i + 1] = uz * vx - ux * vz;
    out[i + 2] = ux * vy - uy * vx;
  }
  return out;
}

export class Surface {
  constructor(positions, triangles, faces) {
    this.positions = positions;
    this.triangles = triangles;
    this.faces = faces;
    this.facets = facetNormals(positions, triangles);
    this.at = trianglesAtPoints(triangles, positions.length / 3);
    this.findEdges();
  }

  // A normal for each corner of each triangle: the mean over triangles of its face that lie nearly as it does.
  cornerNormals() {
    const { triangles, faces, facets, at } = this;
    const out = new Float32Array(3 * triangles.length);
    for (let i = 0; i < triangles.length; i++) {
      const t = (i / 3) | 0;
      const [nx, ny, nz] = [facets[3 * t], facets[3 * t + 1], facets[3 * t + 2]];
      const length = Math.hypot(nx, ny, nz) || 1;
      let [x, y, z] = [0, 0, 0];
      for (let k = at.first[triangles[i]]; k < at.first[triangles[i] + 1]; k++) {
        const o = 3 * at.list[k];
        if (faces[o / 3] !== faces[t]) continue;
        const [ox, oy, oz] = [facets[o], facets[o + 1], facets[o + 2]];
        if (nx * ox + ny * oy + nz * oz < smooth * length * Math.hypot(ox, oy, oz)) continue;
        x += ox;
        y += oy;
        z += oz;
      }
      const sum = Math.hypot(x, y, z) || 1;
      out[3 * i] = x / sum;
      out[3 * i + 1] = y / sum;
      out[3 * i + 2] = z / sum;
    }
    return out;
  }

  // Pairs of points between different faces, and the faces that meet there.
  findEdges() {
    const { triangles, faces, at } = this;
    const edges = [];
    this.neighbours = new Map();
    const meet = (a, b) => {
      if (a === none || b === none) return;
      if (!this.neighbours.has(a)) this.neighbours.set(a, new Set());
      this.neighbours.get(a).add(b);
    };
    for (let t = 0; t < faces.length; t++)
      for (let k = 0; k < 3; k++) {
        const [a, b] = [triangles[3 * t + k], triangles[3 * t + ((k + 1) % 3)]];
        if (a > b) continue;
        for (let i = at.first[a]; i < at.first[a + 1]; i++) {
          const o = at.list[i];
          if (faces[o] === faces[t]) continue;
          if (triangles[3 * o] !== b && triangles[3 * o + 1] !== b && triangles[3 * o + 2] !== b) continue;
          edges.push(a, b);
          meet(faces[t], faces[o]);
          meet(faces[o], faces[t]);
        }
      }
    this.edges = Uint32Array.from(edges);
  }

  // The triangles of each face.
  get trianglesOfFaces() {
    if (this.lists) return this.lists;
    this.lists = new Map();
    for (let t = 0; t < this.faces.length; t++) {
      if (!this.lists.has(this.faces[t])) this.lists.set(this.faces[t], []);
      this.lists.get(this.faces[t]).push(t);
    }
    return this.lists;
  }
}
