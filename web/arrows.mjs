// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Forces on a surface as arrows, which touch it and follow it: those that push end there, those that pull start there.
import * as THREE from "three";

const red = new THREE.MeshStandardMaterial({ color: 0xc62828, roughness: 0.6 });
// Behind the body an arrow shows faintly.
const faint = new THREE.MeshBasicMaterial({ color: 0xc62828, transparent: true, opacity: 0.3, depthTest: false });
const upwards = new THREE.Vector3(0, 1, 0);

function nearest(points, at) {
  let best = 0;
  let least = Infinity;
  for (let i = 0; i < points.length; i += 3) {
    const d = (points[i] - at[0]) ** 2 + (points[i + 1] - at[1]) ** 2 + (points[i + 2] - at[2]) ** 2;
    if (d < least) {
      least = d;
      best = i;
    }
  }
  return best;
}

// Whether forces at points of a surface pull: along its normal there.
function pulls(points, triangles, at, force) {
  const [a, b, c, normal, sum] = Array.from({ length: 5 }, () => new THREE.Vector3());
  for (let t = 0; t < triangles.length; t += 3) {
    const [p, q, r] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    if (p !== at && q !== at && r !== at) continue;
    a.fromArray(points, p);
    b.fromArray(points, q);
    c.fromArray(points, r);
    sum.add(normal.crossVectors(b.sub(a), c.sub(a)));
  }
  return sum.dot(force) > 0;
}

// An arrow along a force whose tip is the origin of its group, `size` of the body it stands at.
export function arrow(force, length, size, materials = [red, faint]) {
  const head = Math.min(0.35 * length, 0.05 * size);
  const group = new THREE.Group();
  const cone = new THREE.Mesh(new THREE.ConeGeometry(0.38 * head, head, 24), materials[0]);
  cone.position.y = -head / 2;
  const shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.13 * head, 0.13 * head, length - head, 16), materials[0]);
  shaft.position.y = -(length + head) / 2;
  for (const part of [cone, shaft]) {
    const ghost = part.clone();
    ghost.material = materials[1];
    group.add(part, ghost);
  }
  group.quaternion.setFromUnitVectors(upwards, force.clone().normalize());
  return group;
}

export class Arrows {
  constructor(scene) {
    this.group = new THREE.Group();
    this.shown = "";
    scene.add(this.group);
  }

  get count() {
    return this.group.children.length;
  }

  // Where each arrow starts and ends.
  get ends() {
    return this.group.children.map((one) => {
      const tip = new THREE.Vector3(0, one.userData.pulled, 0).applyQuaternion(one.quaternion).add(one.position);
      const tail = tip.clone().addScaledVector(
        new THREE.Vector3(0, 1, 0).applyQuaternion(one.quaternion), -one.userData.length);
      return [tail.toArray(), tip.toArray()];
    });
  }

  // Forces {at, force} on a body of a size whose points lie so when the forces are first shown.
  show(list, points, triangles, size) {
    const text = JSON.stringify(list);
    if (text === this.shown) return;
    this.shown = text;
    this.group.clear();
    this.rest = Float32Array.from(points);
    const largest = Math.max(0, ...list.map((a) => Math.hypot(...a.force)));
    for (const { at, force } of list) {
      const vector = new THREE.Vector3(...force);
      const length = (size * 0.18 * vector.length()) / largest;
      if (!(length > 0)) continue;
      const one = arrow(vector, length, size);
      const point = nearest(this.rest, at);
      const pulled = pulls(this.rest, triangles, point, vector) ? length : 0;
      one.children.forEach((part) => (part.position.y += pulled));
      one.userData = { at, point, length, pulled };
      this.group.add(one);
    }
  }

  // Where the points are now.
  place(points) {
    for (const one of this.group.children) {
      const { at, point } = one.userData;
      one.position.set(...at.map((x, k) => x + points[point + k] - this.rest[point + k]));
    }
  }
}
