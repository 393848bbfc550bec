// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The bones and joints, drawn through the body, and which of them is meant by a place.
import * as THREE from "three";

const plain = 0x37474f;
const chosen = 0xef6c00;
const white = 0xffffff;

export class Bones {
  constructor(scene) {
    this.group = new THREE.Group();
    this.list = [];
    scene.add(this.group);
  }

  // A slim double cone from head to tail for every bone.
  setBones(list, size) {
    this.group.clear();
    this.list = list;
    this.width = 0.012 * size;
    for (const bone of list) {
      const material = new THREE.MeshBasicMaterial({ color: plain, transparent: true, opacity: 0.75,
        depthTest: false });
      const body = new THREE.Mesh(new THREE.OctahedronGeometry(1), material);
      body.renderOrder = 1;
      body.name = bone.name;
      this.group.add(body);
    }
    this.rings = [];
  }

  // A white ball with a rim for every joint.
  ball() {
    const make = (width, colour, order) => {
      const mesh = new THREE.Mesh(new THREE.SphereGeometry(width * this.width, 16, 12),
        new THREE.MeshBasicMaterial({ color: colour, depthTest: false, transparent: true }));
      mesh.renderOrder = order;
      return mesh;
    };
    const rim = make(0.72, plain, 3);
    rim.add(make(0.5, white, 4));
    this.group.add(rim);
    return rim;
  }

  place(joints) {
    this.joints = joints.map((j) => new THREE.Vector3(...j));
    while (this.rings.length < joints.length) this.rings.push(this.ball());
    for (const [i, ring] of this.rings.entries()) ring.position.copy(this.joints[i]);
    const along = new THREE.Vector3();
    for (const [i, bone] of this.list.entries()) {
      const [from, to] = [this.joints[bone.head], this.joints[bone.tail]];
      const body = this.group.children[i];
      along.subVectors(to, from);
      const length = along.length() || 1e-9;
      body.position.addVectors(from, to).multiplyScalar(0.5);
      body.quaternion.setFromUnitVectors(new THREE.Vector3(1, 0, 0), along.divideScalar(length));
      const width = Math.min(this.width, 0.2 * length);
      body.scale.set(length / 2, width, width);
    }
  }

  // The chosen bone, or the chosen joint where one is (else -1).
  choose(bone, joint) {
    for (const i of this.list.keys())
      this.group.children[i].material.color.setHex(i === bone && joint < 0 ? chosen : plain);
    for (const [i, ring] of this.rings.entries()) ring.material.color.setHex(i === joint ? chosen : plain);
  }

  // The joint within a few pixels of a place on the screen, else -1.
  nearJoint(pixel, toScreen, most = 9) {
    const distances = this.joints.map((j) => pixel.distanceTo(toScreen(j)));
    const least = Math.min(...distances);
    return least < most ? distances.indexOf(least) : -1;
  }

  // The bone drawn within a few pixels of a place on the screen, else -1.
  near(pixel, toScreen, most = 10) {
    let best = -1;
    let least = most;
    for (const [i, bone] of this.list.entries()) {
      const a = toScreen(this.joints[bone.head]);
      const b = toScreen(this.joints[bone.tail]);
      const d = b.clone().sub(a);
      const t = Math.min(1, Math.max(0, pixel.clone().sub(a).dot(d) / (d.lengthSq() || 1)));
      const distance = pixel.distanceTo(a.addScaledVector(d, t));
      if (distance < least) {
        least = distance;
        best = i;
      }
    }
    return best;
  }

  // The bone nearest to a point of the body.
  nearest(point) {
    let best = -1;
    let least = Infinity;
    const foot = new THREE.Vector3();
    for (const [i, bone] of this.list.entries()) {
      const line = new THREE.Line3(this.joints[bone.head], this.joints[bone.tail]);
      const distance = line.closestPointToPoint(point, true, foot).distanceTo(point);
      if (distance < least) {
        least = distance;
        best = i;
      }
    }
    return best;
  }
}
