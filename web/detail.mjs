// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Level of detail: a large surface is drawn with fewer triangles while it moves and at first, and whole when it
// rests. The coarse triangles use points of the surface itself, so that colours and deformations need nothing more.
import * as THREE from "three";
import { coarsen } from "./coarsen.mjs";

// Draws a body of a stage coarse while the camera moves or `hold(true)` says that the body does, and until the first
// pictures are there.
export class Detail {
  constructor(stage, body) {
    this.stage = stage;
    this.body = body;
    this.whole = body.geometry.index;
    const coarse = coarsen(body.geometry.getAttribute("position").array, this.whole.array);
    this.coarse = coarse === this.whole.array ? null : new THREE.BufferAttribute(coarse, 1);
    this.full = body.material;
    this.plain = new THREE.MeshLambertMaterial({ vertexColors: true, flatShading: true, side: THREE.DoubleSide });
    this.reasons = new Set(); // to draw it coarse
    if (!this.coarse) return;
    stage.onTurning((on) => this.set("turning", on));
    this.set("first", true);
    setTimeout(() => this.set("first", false), 300);
  }

  get triangles() {
    return this.body.geometry.index.count / 3;
  }

  set(reason, on) {
    if (!this.coarse) return;
    if (on) this.reasons.add(reason);
    else this.reasons.delete(reason);
    const index = this.reasons.size ? this.coarse : this.whole;
    if (index === this.body.geometry.index) return;
    this.draw(index);
    this.stage.touch();
  }

  // The coarse body has a material that costs less for each pixel, too.
  draw(index) {
    this.body.geometry.setIndex(index);
    this.body.material = index === this.whole ? this.full : this.plain;
  }

  hold(on) {
    this.set("held", on);
  }

  // Milliseconds of a picture, the mean of some, with all triangles or with the coarse ones.
  cost(whole, pictures) {
    const { renderer, scene, camera } = this.stage;
    const pixel = new Uint8Array(4);
    const gl = renderer.getContext();
    const kept = this.body.geometry.index;
    const one = () => {
      renderer.render(scene, camera);
      gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel); // waits until it is drawn
    };
    this.draw(whole ? this.whole : this.coarse || this.whole);
    one();
    const since = performance.now();
    for (let i = 0; i < pictures; i++) one();
    const spent = (performance.now() - since) / pictures;
    this.draw(kept);
    return spent;
  }
}
