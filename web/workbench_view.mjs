// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The workbench's view: the part with its faces, edges, symbols and results, the camera, and what lies under the pointer.
import * as THREE from "three";
import { colourMap } from "./colour.mjs";
import { makeStage } from "./stage.mjs";
import { Surface } from "./workbench_surface.mjs";
import { Symbols } from "./workbench_symbols.mjs";
import { Tree } from "./workbench_tree.mjs";

const none = 0xffffffff;
const linear = (hex) => new THREE.Color(hex).toArray();
const plain = linear(0xb9c5d1);
const chosen = linear(0x1976d2);
const pointed = linear(0x7fb6ea);
const locked = linear(0x8d8fa8);
const mix = (a, b, f) => [0, 1, 2].map((k) => a[k] * (1 - f) + b[k] * f);

// 1, 2 or 5 times a power of ten, at most x.
export function roundDown(x) {
  const power = 10 ** Math.floor(Math.log10(x));
  return ([5, 2, 1].find((f) => f * power <= x * (1 + 1e-9)) || 1) * power;
}

export class View {
  // frame(): called before each picture.
  constructor(element, frame) {
    this.stage = makeStage(element, frame, { onDemand: true });
    this.stage.renderer.localClippingEnabled = true;
    this.canvas = this.stage.renderer.domElement;
    this.selected = new Set();
    this.locked = new Set();
    this.hovered = -1;
    this.factor = 0;
    this.coloured = false;
    this.symbols = new Symbols(this.stage.scene);
    this.marker = new THREE.Mesh(new THREE.SphereGeometry(1, 20, 14),
      new THREE.MeshBasicMaterial({ color: 0xc62828, depthTest: false, transparent: true, opacity: 0.9 }));
    this.marker.renderOrder = 3;
    this.marker.visible = false;
    this.stage.scene.add(this.marker);
    this.plane = new THREE.Plane();
    this.parts = new THREE.Group();
    this.stage.scene.add(this.parts);
    this.stage.start();
  }

  setDark(dark) {
    this.stage.scene.background.set(dark ? 0x12171d : 0xf2f5f8);
    if (this.lines) this.lines.material.color.set(dark ? 0x06090c : 0x2a3642);
    this.stage.touch();
  }

  // A scene from the session. Whether its shape is another one than before.
  setScene(scene) {
    const first = !this.surface || scene.kind === "file"; // another part has come
    this.scene = scene;
    this.colour = colourMap(scene.colours || [[33, 72, 160], [74, 160, 201], [240, 220, 120], [200, 60, 40]]);
    this.tree = null;
    this.surface = new Surface(scene.positions, scene.triangles, scene.faces);
    for (const part of [...this.parts.children]) part.geometry.dispose();
    this.parts.clear();
    const { triangles } = scene;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * triangles.length), 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(this.surface.cornerNormals(), 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(new Uint16Array(3 * triangles.length), 3, true));
    const clippingPlanes = this.cut ? [this.plane] : [];
    this.material = new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.62, metalness: 0.05, clippingPlanes,
      polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
    this.inside = new THREE.MeshBasicMaterial({ color: 0xd9a441, side: THREE.BackSide, clippingPlanes });
    this.body = new THREE.Mesh(geometry, this.material);
    this.back = new THREE.Mesh(geometry, this.inside);
    this.back.visible = !!this.cut;
    const edges = new THREE.BufferGeometry();
    edges.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * this.surface.edges.length), 3));
    const visible = this.lines ? this.lines.visible : true;
    this.lines = new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: 0x2a3642, clippingPlanes }));
    this.lines.visible = visible;
    this.parts.add(this.body, this.back, this.lines);
    this.largest = 0;
    const u = scene.displacement;
    for (let i = 0; u && i < u.length; i += 3) this.largest = Math.max(this.largest, Math.hypot(u[i], u[i + 1], u[i + 2]));
    this.rest = new THREE.Box3().setFromArray(scene.positions);
    const before = this.size;
    this.size = this.rest.getSize(new THREE.Vector3()).length() || 1;
    const resized = this.size > 2 * before || 2 * this.size < before; // the file is read in another unit
    this.range = this.rangeOf(scene.von_mises);
    this.deform();
    this.recolour();
    if (first || resized) this.fit();
  }

  rangeOf(values) {
    if (!values) return null;
    let high = 0;
    for (const v of values) if (Number.isFinite(v) && v > high) high = v;
    return [0, high || 1];
  }

  // Places of the points as they are shown: deformed `factor` times.
  shown(point) {
    const { positions, displacement: u } = this.scene;
    const f = u ? this.factor : 0;
    return [0, 1, 2].map((k) => positions[3 * point + k] + (f ? f * u[3 * point + k] : 0));
  }

  // The factor that shows the largest displacement as a twentieth of the part.
  get sensible() {
    return this.largest > 0 ? Math.max(1, roundDown((0.05 * this.size) / this.largest)) : 0;
  }

  deform(factor = this.factor) {
    this.factor = factor;
    if (!this.scene) return;
    const { positions, triangles, displacement: u } = this.scene;
    const f = u ? factor : 0;
    this.places = f ? Float32Array.from(positions, (x, i) => x + f * u[i]) : positions;
    const copy = (attribute, indices) => {
      const out = attribute.array;
      for (let i = 0; i < indices.length; i++)
        for (let k = 0; k < 3; k++) out[3 * i + k] = this.places[3 * indices[i] + k];
      attribute.needsUpdate = true;
    };
    copy(this.body.geometry.getAttribute("position"), triangles);
    copy(this.lines.geometry.getAttribute("position"), this.surface.edges);
    this.body.geometry.computeBoundingSphere();
    this.lines.geometry.computeBoundingSphere();
    this.tree = null;
    this.stage.touch();
  }

  // ---- colours --------------------------------------------------------------------------------------

  tintOf(face) {
    if (this.selected.has(face)) return [chosen, this.coloured ? 0.55 : 0.85];
    if (face === this.hovered) return [pointed, this.coloured ? 0.5 : 0.9];
    if (this.locked.has(face)) return [locked, this.coloured ? 0 : 0.8];
    return [plain, 0];
  }

  // Colours all triangles, or those of a face.
  recolour(face) {
    if (!this.scene) return;
    const { triangles, faces, von_mises: stress } = this.scene;
    const attribute = this.body.geometry.getAttribute("color");
    const list = face === undefined ? null : this.surface.trianglesOfFaces.get(face) || [];
    const count = list ? list.length : faces.length;
    const colours = this.coloured && stress;
    const cache = this.rowOfColours();
    let [low, high] = [Infinity, -1];
    for (let n = 0; n < count; n++) {
      const t = list ? list[n] : n;
      const [tint, share] = this.tintOf(faces[t]);
      for (let k = 0; k < 3; k++) {
        let base = plain;
        if (colours) {
          const v = stress[triangles[3 * t + k]];
          base = Number.isFinite(v) ? cache[Math.max(0, Math.min(255, Math.round((255 * v) / this.range[1])))] : [0.3, 0.3, 0.3];
        }
        const rgb = share ? mix(base, tint, share) : base;
        const at = 9 * t + 3 * k;
        for (let c = 0; c < 3; c++) attribute.array[at + c] = 65535 * rgb[c];
      }
      if (t < low) low = t;
      if (t > high) high = t;
    }
    if (list && high >= 0 && this.uploaded === this.body.uuid) attribute.addUpdateRange(9 * low, 9 * (high - low + 1));
    else attribute.clearUpdateRanges();
    this.uploaded = this.body.uuid;
    attribute.needsUpdate = true;
    this.stage.touch();
  }

  rowOfColours() {
    return Array.from({ length: 256 }, (_, i) => {
      const [r, g, b] = this.colour(i / 255);
      return new THREE.Color().setRGB(r / 255, g / 255, b / 255, THREE.SRGBColorSpace).toArray();
    });
  }

  hover(face) {
    if (face === this.hovered) return;
    const old = this.hovered;
    this.hovered = face;
    for (const one of [old, face]) if (one >= 0) this.recolour(one);
  }

  setSelected(faces) {
    const changed = [...new Set([...this.selected, ...faces])].filter((f) => this.selected.has(f) !== faces.has(f));
    this.selected = new Set(faces);
    if (changed.length > 3) this.recolour();
    else for (const face of changed) this.recolour(face);
  }

  // ---- camera ------------------------------------------------------------------------------------------

  box() {
    return new THREE.Box3().setFromArray(this.places);
  }

  // Of the box, in the window.
  corners() {
    const { min, max } = this.box();
    return [0, 1, 2, 3, 4, 5, 6, 7].map((k) =>
      this.toWindow([0, 1, 2].map((i) => (k & (1 << i) ? max : min).getComponent(i))));
  }

  // Shows all, from where the camera is or from a direction.
  fit(from) {
    if (!this.scene) return;
    const { camera, controls } = this.stage;
    const away = from || (this.aimed ? camera.position.clone().sub(controls.target).toArray() : [1, -1.4, 0.8]);
    this.aimed = true;
    this.stage.aim(this.box(), away);
    // What the toolbar would cover is seen from farther away; in a low window no more than that.
    const { top, height } = this.canvas.getBoundingClientRect();
    const { bottom } = document.getElementById("tools").getBoundingClientRect();
    if (Math.min(...this.corners().map(([, y]) => y)) < bottom)
      this.stage.aim(this.box(), away, 1.06 / Math.max(0.7, 1 - (2 * (bottom - top)) / height));
    this.stage.touch();
  }

  // Where the camera is and what it looks at, and the same put back.
  camera() {
    const { camera, controls } = this.stage;
    return [camera.position.toArray(), controls.target.toArray(), camera.near, camera.far];
  }

  look(from) {
    if (!from) return;
    const { camera, controls } = this.stage;
    camera.position.fromArray(from[0]);
    controls.target.fromArray(from[1]);
    [camera.near, camera.far] = from.slice(2);
    camera.updateProjectionMatrix();
    controls.update();
    this.aimed = true;
    this.stage.touch();
  }

  zoom(factor) {
    const { camera, controls } = this.stage;
    camera.position.sub(controls.target).multiplyScalar(factor).add(controls.target);
    this.stage.touch();
  }

  // Turns the camera about what it looks at, in radians.
  turn(across, up) {
    const { camera, controls } = this.stage;
    const place = new THREE.Spherical();
    const toY = new THREE.Quaternion().setFromUnitVectors(camera.up, new THREE.Vector3(0, 1, 0));
    const offset = camera.position.clone().sub(controls.target).applyQuaternion(toY);
    place.setFromVector3(offset);
    place.theta += across;
    place.phi = Math.min(Math.PI - 0.01, Math.max(0.01, place.phi + up));
    camera.position.copy(controls.target).add(offset.setFromSpherical(place).applyQuaternion(toY.invert()));
    this.stage.touch();
  }

  // ---- pointer -------------------------------------------------------------------------------------------

  ray(x, y) {
    const box = this.canvas.getBoundingClientRect();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(((x - box.left) / box.width) * 2 - 1, 1 - ((y - box.top) / box.height) * 2),
      this.stage.camera);
    return ray.ray;
  }

  // What lies at a place of the window: {face, point, weights, triangle}, or null.
  pick(x, y) {
    if (!this.scene) return null;
    this.tree ||= new Tree(this.places, this.scene.triangles);
    const { origin, direction } = this.ray(x, y);
    const visible = (p) => !this.cut || this.plane.distanceToPoint(new THREE.Vector3(...p)) >= 0;
    const hit = this.tree.hit(origin.toArray(), direction.toArray(), visible);
    if (!hit) return null;
    const face = this.scene.faces[hit.triangle];
    const corners = [0, 1, 2].map((k) => this.scene.triangles[3 * hit.triangle + k]);
    const at = (values, size, k) => corners.reduce((sum, p, i) => sum + hit.weights[i] * values[size * p + k], 0);
    return { ...hit, face: face === none ? -1 : face, rest: [0, 1, 2].map((k) => at(this.scene.positions, 3, k)),
      von_mises: this.scene.von_mises && at(this.scene.von_mises, 1, 0),
      displacement: this.scene.displacement && [0, 1, 2].map((k) => at(this.scene.displacement, 3, k)) };
  }

  // The place of the window where a point is seen.
  toWindow(point) {
    const box = this.canvas.getBoundingClientRect();
    this.stage.camera.updateMatrixWorld();
    const p = new THREE.Vector3(...point).project(this.stage.camera);
    return [box.left + ((p.x + 1) / 2) * box.width, box.top + ((1 - p.y) / 2) * box.height];
  }

  // Faces that lie wholly within a rectangle of the window.
  facesWithin(left, top, right, bottom) {
    const within = new Uint8Array(this.places.length / 3);
    for (let p = 0; p < within.length; p++) {
      const [x, y] = this.toWindow([this.places[3 * p], this.places[3 * p + 1], this.places[3 * p + 2]]);
      within[p] = x >= left && x <= right && y >= top && y <= bottom ? 1 : 0;
    }
    const { triangles } = this.scene;
    return [...this.surface.trianglesOfFaces].filter(([face, list]) => face !== none && list.every((t) =>
      within[triangles[3 * t]] && within[triangles[3 * t + 1]] && within[triangles[3 * t + 2]])).map(([face]) => face);
  }

  // The outward normal of the triangle whose middle is nearest to a point.
  outwards(point) {
    const { positions, triangles } = this.scene;
    let [best, min] = [0, Infinity];
    for (let t = 0; t < triangles.length / 3; t++) {
      let away = 0;
      for (let k = 0; k < 3; k++)
        away += ((positions[3 * triangles[3 * t] + k] + positions[3 * triangles[3 * t + 1] + k] +
          positions[3 * triangles[3 * t + 2] + k]) / 3 - point[k]) ** 2;
      if (away < min) [best, min] = [t, away];
    }
    return new THREE.Vector3().fromArray(this.surface.facets, 3 * best).normalize().toArray();
  }

  // Planes {x, y, z, d}, x X + y Y + z Z >= d, of a rectangle of the window, and the direction to the viewer.
  planes(left, top, right, bottom) {
    const corners = [[left, top], [right, top], [right, bottom], [left, bottom]].map((corner) => this.ray(...corner));
    const ahead = (ray) => ray.origin.clone().addScaledVector(ray.direction, this.size);
    const middle = ahead(this.ray((left + right) / 2, (top + bottom) / 2));
    const planes = corners.map((ray, i) => {
      const a = ray.origin;
      const normal = ahead(ray).sub(a).cross(ahead(corners[(i + 1) % 4]).sub(a)).normalize();
      if (normal.dot(middle) < normal.dot(a)) normal.negate();
      return [...normal.toArray(), normal.dot(a)];
    });
    return { planes, towards: this.ray((left + right) / 2, (top + bottom) / 2).direction.clone().negate().toArray() };
  }

  // ---- section plane ----------------------------------------------------------------------------------------

  // Cuts away what lies beyond a share (0 to 1) of the part along an axis (0 to 2), or nothing.
  section(axis, share, flip) {
    this.cut = axis >= 0;
    if (this.cut && this.scene) {
      const normal = new THREE.Vector3();
      normal.setComponent(axis, flip ? 1 : -1);
      const [low, high] = [this.rest.min.getComponent(axis), this.rest.max.getComponent(axis)];
      this.plane.normal.copy(normal);
      this.plane.constant = (flip ? -1 : 1) * (low + share * (high - low));
    }
    if (this.back) this.back.visible = this.cut;
    for (const part of this.parts.children) {
      part.material.clippingPlanes = this.cut ? [this.plane] : [];
      part.material.needsUpdate = true;
    }
    this.stage.touch();
  }
}
