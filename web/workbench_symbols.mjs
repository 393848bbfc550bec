// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Supports and loads as symbols on the part: cones of supports, arrows that push, an arc with a head that turns.
import * as THREE from "three";
import { arrow } from "./arrows.mjs";

const colours = { fix: 0x00796b, force: 0xc62828, pressure: 0xad3b00, moment: 0x6a1b9a, gravity: 0x455a64, draft: 0x1565c0 };
const upwards = new THREE.Vector3(0, 1, 0);

const materials = Object.fromEntries(Object.entries(colours).map(([kind, color]) => [kind,
  [new THREE.MeshStandardMaterial({ color, roughness: 0.6 }),
    new THREE.MeshBasicMaterial({ color, transparent: true, opacity: 0.25, depthTest: false })]]));

// Up to `most` triangles of faces that lie far from each other.
export function spread(surface, faces, most) {
  const all = faces.flatMap((f) => surface.trianglesOfFaces.get(f) || []);
  const step = Math.max(1, Math.floor(all.length / 300));
  const candidates = all.filter((_, i) => i % step === 0).map((t) => {
    const at = new THREE.Vector3();
    for (let k = 0; k < 3; k++) at.add(new THREE.Vector3().fromArray(surface.positions, 3 * surface.triangles[3 * t + k]));
    return { at: at.divideScalar(3), normal: new THREE.Vector3().fromArray(surface.facets, 3 * t).normalize(), gap: Infinity };
  });
  const chosen = [];
  while (chosen.length < most && candidates.length) {
    const best = candidates.reduce((a, b) => (b.gap > a.gap ? b : a));
    if (best.gap === 0) break;
    chosen.push(best);
    for (const one of candidates) one.gap = Math.min(one.gap, one.at.distanceTo(best.at));
  }
  return chosen;
}

function cone(place, size) {
  const [solid, faint] = materials.fix;
  const group = new THREE.Group();
  const height = 0.035 * size;
  const mesh = new THREE.Mesh(new THREE.ConeGeometry(0.4 * height, height, 20), solid);
  mesh.position.y = -height / 2;
  const ghost = mesh.clone();
  ghost.material = faint;
  group.add(mesh, ghost);
  group.quaternion.setFromUnitVectors(upwards, place.normal.clone().negate());
  group.position.copy(place.at);
  return group;
}

function turn(axis, at, size, pair) {
  const group = new THREE.Group();
  const radius = 0.07 * size;
  const width = 0.006 * size;
  const arc = new THREE.Mesh(new THREE.TorusGeometry(radius, width, 10, 48, 1.6 * Math.PI), pair[0]);
  const head = new THREE.Mesh(new THREE.ConeGeometry(2.6 * width, 7 * width, 20), pair[0]);
  const angle = 1.6 * Math.PI;
  head.position.set(radius * Math.cos(angle), radius * Math.sin(angle), 0);
  head.rotation.z = angle;
  for (const part of [arc, head]) {
    const ghost = part.clone();
    ghost.material = pair[1];
    group.add(part, ghost);
  }
  group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), axis.clone().normalize());
  group.position.copy(at);
  return group;
}

// A load's arrow: its tip on the part, or its tail where it pulls.
function force(place, vector, length, size, pair) {
  const one = arrow(vector, length, size, pair);
  one.position.copy(place.at);
  if (place.normal.dot(vector) > 0.1 * vector.length()) one.position.addScaledVector(vector.clone().normalize(), length);
  return one;
}

function places(surface, condition, most) {
  const faces = condition.faces || [];
  const each = Math.max(1, Math.floor(most / Math.max(1, faces.length)));
  return faces.flatMap((f) => spread(surface, [f - 1], each));
}

export class Symbols {
  constructor(scene) {
    this.group = new THREE.Group();
    scene.add(this.group);
  }

  get count() {
    return this.group.children.length;
  }

  clear() {
    this.group.traverse((one) => one.geometry?.dispose());
    this.group.clear();
  }

  // Conditions {kind, faces, vector, draft} on a surface in a box of a size.
  show(conditions, surface, box, size) {
    this.clear();
    for (const condition of conditions) {
      const { kind } = condition;
      const pair = condition.draft ? materials.draft : materials[kind] || materials.force;
      const vector = new THREE.Vector3(...(condition.vector || [0, 0, 0]));
      if (kind === "fix")
        for (const place of places(surface, condition, 12)) this.group.add(cone(place, size));
      else if (kind === "pressure")
        for (const place of places(surface, condition, 9)) {
          const inward = place.normal.clone().multiplyScalar(condition.value < 0 ? 1 : -1);
          this.group.add(force(place, inward, 0.09 * size, size, pair));
        }
      else if (kind === "gravity") {
        const top = box.getCenter(new THREE.Vector3());
        if (vector.lengthSq() > 0)
          this.group.add(force({ at: top, normal: vector.clone() }, vector, 0.16 * size, size, pair));
      } else if (vector.lengthSq() > 0)
        for (const face of condition.faces || []) {
          const at = this.centre(surface, face - 1);
          if (!at) continue;
          this.group.add(kind === "moment" ? turn(vector, at.at, size, pair) : force(at, vector, 0.2 * size, size, pair));
        }
    }
  }

  // The middle of a face's triangles where one of them contains it, else the nearest middle of one; the normal there.
  centre(surface, face) {
    const list = surface.trianglesOfFaces.get(face);
    if (!list) return null;
    const middle = new THREE.Vector3();
    const normal = new THREE.Vector3();
    let area = 0;
    const of = (t) => {
      const at = new THREE.Vector3();
      for (let k = 0; k < 3; k++) at.add(new THREE.Vector3().fromArray(surface.positions, 3 * surface.triangles[3 * t + k]));
      return at.divideScalar(3);
    };
    for (const t of list) {
      const n = new THREE.Vector3().fromArray(surface.facets, 3 * t);
      const weight = n.length();
      middle.addScaledVector(of(t), weight);
      normal.add(n);
      area += weight;
    }
    middle.divideScalar(area || 1);
    const flat = normal.length() > 0.999 * area;
    const inside = (t) => {
      const corners = [0, 1, 2].map((k) => new THREE.Vector3().fromArray(surface.positions, 3 * surface.triangles[3 * t + k]));
      return THREE.Triangle.containsPoint(middle, ...corners);
    };
    if (flat && list.some(inside)) return { at: middle, normal: normal.normalize() };
    let best = { gap: Infinity };
    for (const t of list) {
      const gap = of(t).distanceTo(middle);
      if (gap < best.gap) best = { gap, at: of(t), normal: new THREE.Vector3().fromArray(surface.facets, 3 * t).normalize() };
    }
    return best;
  }
}
