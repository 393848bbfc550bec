// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The handles on the chosen bone or joint. The stresses of a move are not waited for: the session gives
// them up for the next.
import * as THREE from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import { Drag, rounded } from "./live_drag.mjs";

const least = 0.2;
const most = 5;

export class Handles {
  // send(message): whether it went out. orbit: switched off while a handle is dragged.
  constructor(stage, send) {
    this.stage = stage;
    this.drag = new Drag(send);
    this.mode = "rotate";
    this.proxy = new THREE.Object3D();
    stage.scene.add(this.proxy);
    this.controls = new TransformControls(stage.camera, stage.renderer.domElement);
    this.controls.setSize(0.9);
    stage.scene.add(this.controls.getHelper());
    this.controls.addEventListener("dragging-changed", (event) => {
      stage.controls.enabled = !event.value;
      if (event.value) this.begin();
      else this.end();
    });
    this.controls.addEventListener("objectChange", () => this.moved());
    this.setMode("rotate");
  }

  get dragging() {
    return this.drag.going;
  }

  get waiting() {
    return this.drag.waiting;
  }

  // What a drag does: a joint can be pulled to a place only.
  get act() {
    return this.bone?.joint ? "reach" : this.mode;
  }

  setMode(mode) {
    if (this.dragging) return;
    this.mode = mode;
    this.place();
  }

  // The bone {name, head, tail, axes} as it stands, or a joint {joint: its name, tail: its place,
  // axes}, or nothing; the size of the body.
  setBone(bone, size) {
    this.bone = bone;
    this.size = size;
    if (!this.dragging) this.place();
  }

  place() {
    if (!this.bone) return this.controls.detach();
    const { head, tail, axes } = this.bone;
    this.controls.setMode(this.act === "reach" ? "translate" : this.act);
    this.controls.setSpace(this.act === "rotate" ? "local" : "world");
    this.proxy.position.copy(this.act === "reach" ? tail : head);
    this.proxy.scale.set(1, 1, 1);
    const [x, y, z] = [0, 3, 6].map((i) => new THREE.Vector3(axes[i], axes[i + 1], axes[i + 2]));
    this.proxy.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(x, y, z));
    this.proxy.updateMatrixWorld();
    if (this.controls.object !== this.proxy) this.controls.attach(this.proxy);
  }

  begin() {
    this.start = { position: this.proxy.position.clone(), turn: this.proxy.quaternion.clone().invert() };
    this.drag.begin(this.bone.joint ? { joint: this.bone.joint } : { bone: this.bone.name });
  }

  change() {
    const digits = Math.max(0, 5 - Math.floor(Math.log10(this.size)));
    const metres = (x) => rounded(x, digits);
    const by = this.proxy.position.clone().sub(this.start.position);
    if (this.act === "reach") return { reach: this.proxy.position.toArray().map(metres) };
    if (this.act === "translate") return { translate: by.toArray().map(metres) };
    if (this.act === "scale")
      return { scale: this.proxy.scale.toArray().map((s) => rounded(Math.min(most, Math.max(least, s)), 3)) };
    const turn = this.proxy.quaternion.clone().multiply(this.start.turn).normalize();
    if (turn.w < 0) turn.set(-turn.x, -turn.y, -turn.z, -turn.w);
    const sine = Math.hypot(turn.x, turn.y, turn.z);
    if (sine < 1e-9) return { rotate: { axis: [1, 0, 0], degrees: 0 } };
    return { rotate: { axis: [turn.x, turn.y, turn.z].map((x) => rounded(x / sine, 5)),
      degrees: rounded(THREE.MathUtils.radToDeg(2 * Math.atan2(sine, turn.w)), 2) } };
  }

  moved() {
    if (this.dragging) this.drag.move({ change: this.change() });
  }

  handled(seq) {
    this.drag.handled(seq);
  }

  end() {
    this.drag.end();
  }

  // Takes the drag back.
  cancel() {
    if (!this.dragging) return;
    this.drag.cancel();
    this.release();
  }

  // The drag is over, and nothing more is sent: it was refused, or the connection was lost.
  drop() {
    this.drag.drop();
    this.release();
  }

  release() {
    this.controls.pointerUp({ button: 0 });
    this.place();
  }

  // Where a handle is, as a place in space: for whoever drives the page by script.
  at(axis) {
    const { camera } = this.stage;
    const reach = this.proxy.position.distanceTo(camera.position) *
      1.9 * Math.tan((Math.PI * camera.fov) / 360) * this.controls.size / 4;
    const local = this.act === "rotate" || this.act === "scale";
    const direction = (name) => {
      const v = new THREE.Vector3(+(name === "X"), +(name === "Y"), +(name === "Z"));
      return local ? v.applyQuaternion(this.proxy.quaternion) : v;
    };
    if (this.act === "reach" && axis === "XYZ") return this.proxy.position.clone();
    if (this.act === "rotate") {
      const others = ["X", "Y", "Z"].filter((name) => name !== axis).map(direction);
      return this.proxy.position.clone().addScaledVector(others[0], (0.5 * reach) / Math.SQRT2)
        .addScaledVector(others[1], (0.5 * reach) / Math.SQRT2);
    }
    return this.proxy.position.clone().addScaledVector(direction(axis), 0.45 * reach);
  }
}
