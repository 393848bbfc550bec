// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The coloured field: triangles of the mesh whose nodes have colours, deformed by the displacements as
// far as is asked, with the mesh's lines if wanted; arrows of a vector field.
import * as THREE from "three";
import { makeBody, paint } from "./stage.mjs";

// Six-node triangles are drawn as four each.
const parts = { 3: [[0, 1, 2]], 6: [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]] };

function trianglesOf(elements, corners) {
  const list = parts[corners];
  const out = new Uint32Array((elements.length / corners) * list.length * 3);
  let n = 0;
  for (let e = 0; e < elements.length; e += corners)
    for (const part of list) for (const k of part) out[n++] = elements[e + k];
  return out;
}

function edgesOf(elements, corners) {
  const quadratic = corners === 6;
  const out = [];
  const seen = new Set();
  for (let e = 0; e < elements.length; e += corners)
    for (let k = 0; k < 3; k++) {
      const [a, b] = [elements[e + k], elements[e + ((k + 1) % 3)]];
      const key = a < b ? a * 4194304 + b : b * 4194304 + a;
      if (seen.has(key)) continue;
      seen.add(key);
      if (quadratic) out.push(a, elements[e + 3 + k], elements[e + 3 + k], b);
      else out.push(a, b);
    }
  return new Uint32Array(out);
}

export class Field {
  constructor(plane) {
    this.plane = plane;
    this.body = null;
    this.lines = null;
    this.image = null; // the left half, where only the right one is computed
    this.showLines = false;
  }

  // {elements, corners, nodes}; with its image at x = 0 if wanted
  setMesh(mesh, mirror) {
    for (const old of [this.body, this.image, this.lines])
      if (old) {
        this.plane.scene.remove(old);
        old.geometry.dispose();
        old.material.dispose();
      }
    this.body = makeBody(new Float32Array(3 * mesh.nodes), trianglesOf(mesh.elements, mesh.corners),
      new THREE.MeshBasicMaterial({ vertexColors: true, side: THREE.DoubleSide }));
    this.body.frustumCulled = false;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", this.body.geometry.getAttribute("position"));
    geometry.setIndex(new THREE.BufferAttribute(edgesOf(mesh.elements, mesh.corners), 1));
    this.lines = new THREE.LineSegments(geometry,
      new THREE.LineBasicMaterial({ color: 0x1d2733, transparent: true, opacity: 0.25 }));
    this.lines.frustumCulled = false;
    this.lines.renderOrder = 1;
    this.plane.scene.add(this.body, this.lines);
    this.image = mirror ? new THREE.Mesh(this.body.geometry, this.body.material) : null;
    if (!mirror) return;
    this.image.scale.x = -1;
    this.image.frustumCulled = false;
    this.plane.scene.add(this.image);
  }

  // Nodes at x, y; deformed by `factor` times displacements x, y, or, where there is one number a node, by
  // that number upwards, as a view from the side shows a deflection out of the plane.
  place(positions, deform, factor) {
    const array = this.body.geometry.getAttribute("position").array;
    const nodes = positions.length / 2;
    const rows = deform && factor !== 0 ? deform.length / nodes : 0;
    for (let i = 0; i < nodes; i++) {
      array[3 * i] = positions[2 * i] + (rows === 2 ? factor * deform[2 * i] : 0);
      array[3 * i + 1] = positions[2 * i + 1] +
        (rows === 2 ? factor * deform[2 * i + 1] : rows === 1 ? factor * deform[i] : 0);
    }
    this.body.geometry.getAttribute("position").needsUpdate = true;
    this.lines.visible = this.showLines;
  }

  // x, y, z of the nodes as they are drawn.
  drawn() {
    return this.body?.geometry.getAttribute("position").array;
  }

  paint(values, low, high, colour) {
    paint(this.body, values, low, high, colour);
  }

  // Arrows at some of the nodes, no closer than so many pixels; the longest is as long as that.
  arrows(pen, positions, vectors, spacing = 22) {
    let most = 0;
    for (let i = 0; i < vectors.length; i += 2) most = Math.max(most, Math.hypot(vectors[i], vectors[i + 1]));
    if (!(most > 0)) return 0;
    const taken = new Set();
    let count = 0;
    pen.beginPath();
    for (let i = 0; i < vectors.length; i += 2) {
      const [x, y] = this.plane.toScreen(positions[i], positions[i + 1]);
      if (x < 0 || y < 0 || x > this.plane.width || y > this.plane.height) continue;
      const cell = Math.floor(x / spacing) * 100000 + Math.floor(y / spacing);
      if (taken.has(cell)) continue;
      taken.add(cell);
      const u = (vectors[i] / most) * spacing * 1.4;
      const v = (-vectors[i + 1] / most) * spacing * 1.4;
      const length = Math.hypot(u, v);
      if (length < 1.5) continue;
      count++;
      pen.moveTo(x, y);
      pen.lineTo(x + u, y + v);
      const head = Math.min(5, 0.4 * length);
      for (const side of [0.45, -0.45]) {
        const angle = Math.atan2(v, u) + Math.PI + side;
        pen.moveTo(x + u, y + v);
        pen.lineTo(x + u + head * Math.cos(angle), y + v + head * Math.sin(angle));
      }
    }
    pen.strokeStyle = "#1d2733cc";
    pen.lineWidth = 1;
    pen.stroke();
    return count;
  }
}

export const largest = (rows, nodes) => {
  const columns = rows.length / nodes;
  let most = 0;
  for (let i = 0; i < rows.length; i += columns)
    most = Math.max(most, columns === 2 ? Math.hypot(rows[i], rows[i + 1]) : Math.abs(rows[i]));
  return most;
};
