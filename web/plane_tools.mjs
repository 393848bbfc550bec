// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// What the mouse does to the outline: drags of handles, pulls between pins, and edits of one click or one
// press. Where nothing is hit, the view is panned.
import { Drag, rounded } from "./live_drag.mjs";

export class Tools {
  constructor(plane, outline, send, say) {
    this.plane = plane;
    this.outline = outline;
    this.send = send;
    this.say = say;
    this.drag = new Drag(send);
    this.tool = "drag";
    this.size = 1;
    this.radius = 0; // of holes; m
    this.reach = 0; // of a pull along the curve; 0: up to the pins
    this.enabled = false;
    this.press = null;
    const { canvas } = plane;
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.up(event));
    canvas.addEventListener("pointercancel", () => this.cancel());
    for (const kind of ["pointerdown", "pointermove", "pointerup"]) canvas.addEventListener(kind, plane.touch);
  }

  setTool(tool) {
    if (this.press) return;
    this.tool = tool;
    this.outline.hover = null;
  }

  get digits() {
    return Math.max(0, 5 - Math.floor(Math.log10(this.size)));
  }

  metres(x, y) {
    return this.plane.toWorld(x, y).map((v) => rounded(v, this.digits));
  }

  down(event) {
    if (event.button !== 0 || !event.isPrimary || !this.outline.points) return;
    this.drag.end(); // whose button was let go where nobody saw it
    const [x, y] = [event.offsetX, event.offsetY];
    const hit = this.outline.hit(x, y, this.tool, event.shiftKey);
    this.plane.canvas.setPointerCapture(event.pointerId);
    this.press = { x, y, last: [x, y], hit, from: this.plane.toWorld(x, y), moved: false, what: "pan" };
    if (!this.enabled) return;
    if (this.tool === "drag" && hit) this.beginDrag(hit);
    else if (this.tool === "pull" && hit?.vertex) this.press.what = "pull";
    else if (this.tool === "hole") this.press.what = "hole";
    else if (["add", "remove", "smooth"].includes(this.tool) && hit) this.press.what = "click";
    if (hit?.edge) this.outline.edge = hit.edge - 1;
    else if (hit?.vertex) this.outline.edge = hit.vertex - 1;
  }

  beginDrag(hit, more = {}) {
    const { vertex, edge, control, loop } = hit;
    const handle = vertex ? { vertex } : control ? { edge, control } : edge ? { edge } : { loop };
    if (this.drag.begin({ handle, ...more })) this.press.what = "drag";
  }

  move(event) {
    if (!event.isPrimary) return;
    const [x, y] = [event.offsetX, event.offsetY];
    const press = this.press;
    if (!press) {
      this.outline.hover = this.tool === "hole" ? null : this.outline.hit(x, y, this.tool, event.shiftKey);
      this.plane.canvas.style.cursor = this.tool === "hole" ? "crosshair" : this.outline.hover ? "pointer" : "default";
      return;
    }
    press.moved = press.moved || Math.hypot(x - press.x, y - press.y) > 3;
    if (press.what === "pull" && press.moved)
      this.beginDrag(press.hit, { pins: [...this.outline.pins].filter((v) => v !== press.hit.vertex),
        ...(this.reach > 0 ? { reach: rounded(this.reach, this.digits) } : {}) });
    if (press.what === "drag") {
      const to = this.plane.toWorld(x, y);
      this.drag.move({ by: to.map((v, k) => rounded(v - press.from[k], this.digits)) });
    } else if (press.what === "hole") press.radius = Math.hypot(x - press.x, y - press.y) / this.plane.scale;
    else if (press.what === "pan") this.plane.pan(x - press.last[0], y - press.last[1]);
    press.last = [x, y];
  }

  up() {
    const press = this.press;
    this.press = null;
    if (!press) return;
    if (press.what === "drag") this.drag.end();
    else if (press.what === "pull") this.togglePin(press.hit.vertex);
    else if (press.what === "hole") {
      const radius = press.moved ? press.radius : this.radius;
      this.edit({ kind: "hole", at: this.metres(press.x, press.y), radius: rounded(radius, this.digits) });
    } else if (press.what === "click" && !press.moved) this.click(press.hit);
  }

  togglePin(vertex) {
    const { pins } = this.outline;
    if (!pins.delete(vertex)) pins.add(vertex);
  }

  click(hit) {
    const loop = hit.loop || this.outline.loops[hit.loopIndex]?.name;
    if (this.tool === "smooth") this.edit({ kind: "smooth", loop });
    else if (this.tool === "add" && hit.edge) this.edit({ kind: "split", edge: hit.edge, t: rounded(Math.min(0.95, Math.max(0.05, hit.t)), 4) });
    else if (this.tool === "remove" && hit.vertex) this.edit({ kind: "join", vertex: hit.vertex });
    else if (this.tool === "remove" && hit.loop) this.edit({ kind: "remove", loop });
    else this.say(this.tool === "add" ? "click an edge" : "click a vertex, or into a hole", true);
  }

  edit(edit) {
    this.send({ type: "edit", edit });
  }

  cancel() {
    this.press = null;
    this.drag.cancel();
  }

  // The drag is over, and nothing more is sent.
  drop() {
    this.press = null;
    this.drag.drop();
  }

  draw(pen) {
    if (this.press?.what !== "hole" || !this.press.radius) return;
    pen.beginPath();
    pen.arc(this.press.x, this.press.y, this.press.radius * this.plane.scale, 0, 2 * Math.PI);
    pen.strokeStyle = "#1565c0";
    pen.lineWidth = 2;
    pen.stroke();
  }
}
