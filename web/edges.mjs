// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Lines over a surface as tubes, which follow it: edges where the stress has no finite value.
import * as THREE from "three";

const violet = new THREE.MeshBasicMaterial({ color: 0x6014d6 });
const upwards = new THREE.Vector3(0, 1, 0);

function nearest(points, x, y, z) {
  let best = 0;
  let least = Infinity;
  for (let i = 0; i < points.length; i += 3) {
    const d = (points[i] - x) ** 2 + (points[i + 1] - y) ** 2 + (points[i + 2] - z) ** 2;
    if (d < least) {
      least = d;
      best = i;
    }
  }
  return best;
}

export class Edges {
  // Lists of points on a surface of a size whose points lie so at rest.
  constructor(scene, lines, rest, size) {
    this.rest = rest;
    this.group = new THREE.Group();
    this.pieces = [];
    const tube = new THREE.CylinderGeometry(0.003 * size, 0.003 * size, 1, 8);
    for (const line of lines) {
      const ends = line.map(([x, y, z]) => ({ at: new THREE.Vector3(x, y, z), point: nearest(rest, x, y, z) }));
      for (let i = 1; i < ends.length; i++) {
        const mesh = new THREE.Mesh(tube, violet);
        this.pieces.push({ mesh, from: ends[i - 1], to: ends[i] });
        this.group.add(mesh);
      }
    }
    this.place(rest);
    scene.add(this.group);
  }

  get count() {
    return this.pieces.length;
  }

  moved({ at, point }, points) {
    return new THREE.Vector3(
      at.x + points[point] - this.rest[point],
      at.y + points[point + 1] - this.rest[point + 1],
      at.z + points[point + 2] - this.rest[point + 2],
    );
  }

  // Where the points are now.
  place(points) {
    for (const { mesh, from, to } of this.pieces) {
      const a = this.moved(from, points);
      const along = this.moved(to, points).sub(a);
      const length = along.length();
      mesh.position.copy(a).addScaledVector(along, 0.5);
      mesh.scale.set(1, length, 1);
      if (length > 0) mesh.quaternion.setFromUnitVectors(upwards, along.divideScalar(length));
    }
  }
}
