// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Forces on a surface as arrows, whose tips touch it and follow it.
import * as THREE from "three";

const red = new THREE.MeshStandardMaterial({ color: 0xc62828, roughness: 0.6 });
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

function arrow(force, length, size) {
  const head = Math.min(0.35 * length, 0.05 * size);
  const group = new THREE.Group();
  const cone = new THREE.Mesh(new THREE.ConeGeometry(0.38 * head, head, 24), red);
  cone.position.y = -head / 2;
  const shaft = new THREE.Mesh(new THREE.CylinderGeometry(0.13 * head, 0.13 * head, length - head, 16), red);
  shaft.position.y = -(length + head) / 2;
  group.add(cone, shaft);
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

  // Forces {at, force} on a body of a size whose points lie so when the forces are first shown.
  show(list, points, size) {
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
      one.userData = { at, point: nearest(this.rest, at) };
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
