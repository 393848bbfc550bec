// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// Handles over the view: one that pulls a face along its normal, one that turns the direction of a load.
import * as THREE from "three";
import { element } from "./workbench_triad.mjs";

export class Handles {
  constructor(svg, view) {
    this.svg = svg;
    this.view = view;
    this.list = {};
  }

  // A handle `name` {at, direction, length (of the arrow, m), colour, move(handle, x, y), end(handle, cancelled)}, or null.
  set(name, handle) {
    if (this.dragged === name) return;
    this.list[name]?.group.remove();
    delete this.list[name];
    if (handle) {
      const line = element("line", { stroke: handle.colour });
      const circle = element("circle", { r: 10, fill: handle.colour });
      const text = element("text", { "text-anchor": "middle" });
      handle.group = element("g", {}, line, circle, text);
      Object.assign(handle, { line, circle, text });
      circle.addEventListener("pointerdown", (event) => this.begin(name, handle, event));
      this.svg.append(handle.group);
      this.list[name] = handle;
      this.place();
    }
    this.view.stage.touch();
  }

  begin(name, handle, event) {
    event.preventDefault();
    event.stopPropagation();
    handle.circle.setPointerCapture(event.pointerId);
    this.dragged = name;
    const box = this.view.canvas.getBoundingClientRect();
    const [tx, ty] = this.tip(handle);
    const offset = [tx + box.left - event.clientX, ty + box.top - event.clientY];
    const move = (e) => handle.move(handle, e.clientX + offset[0], e.clientY + offset[1]);
    const stop = (cancelled) => {
      handle.circle.removeEventListener("pointermove", move);
      window.removeEventListener("keydown", key, true);
      this.dragged = null;
      handle.end(handle, cancelled);
    };
    const key = (e) => {
      if (e.key !== "Escape" || !this.dragged) return;
      e.stopPropagation();
      stop(true);
    };
    handle.circle.addEventListener("pointermove", move);
    handle.circle.addEventListener("pointerup", () => this.dragged && stop(false), { once: true });
    handle.circle.addEventListener("pointercancel", () => this.dragged && stop(true), { once: true });
    window.addEventListener("keydown", key, true);
  }

  get box() {
    return this.view.canvas.getBoundingClientRect();
  }

  end(handle) {
    return handle.at.clone().addScaledVector(handle.direction, handle.length);
  }

  tip(handle) {
    const [x, y] = this.view.toWindow(this.end(handle).toArray());
    return [x - this.box.left, y - this.box.top];
  }

  place() {
    for (const handle of Object.values(this.list)) {
      const [ax, ay] = this.view.toWindow(handle.at.toArray());
      const [x, y] = this.tip(handle);
      handle.line.setAttribute("x1", ax - this.box.left);
      handle.line.setAttribute("y1", ay - this.box.top);
      handle.line.setAttribute("x2", x);
      handle.line.setAttribute("y2", y);
      handle.circle.setAttribute("cx", x);
      handle.circle.setAttribute("cy", y);
      handle.text.setAttribute("x", x);
      handle.text.setAttribute("y", y - 17);
      handle.text.textContent = handle.words || "";
    }
  }

  // How far along the line of a handle the pointer is.
  along(handle, x, y) {
    const ray = this.view.ray(x, y);
    const d = handle.direction;
    const b = d.dot(ray.direction);
    const w = ray.origin.clone().sub(handle.at);
    const denominator = 1 - b * b;
    return denominator < 1e-4 ? handle.length : (w.dot(d) - b * w.dot(ray.direction)) / denominator;
  }

  // The direction from a handle's place to the pointer, on a ball of the handle's length.
  around(handle, x, y) {
    const ray = this.view.ray(x, y);
    const ball = new THREE.Sphere(handle.at, handle.length);
    const hit = ray.intersectSphere(ball, new THREE.Vector3()) || ray.closestPointToPoint(handle.at, new THREE.Vector3());
    return hit.sub(handle.at).normalize();
  }
}
