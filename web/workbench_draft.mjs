// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// A load before it is added, or while it is changed: its form, and its arrow in the view, whose end can be dragged.
import * as THREE from "three";
import { unitOf } from "./workbench_lists.mjs";

const names = { force: "Force", pressure: "Pressure", moment: "Moment", gravity: "Acceleration" };
const first = { force: 20, pressure: 0.1, moment: 1, gravity: 9.81 };
const axis = (word) => new THREE.Vector3().setComponent("xyz".indexOf(word[1]), word[0] === "-" ? -1 : 1);

export class Draft {
  constructor(context) {
    Object.assign(this, context);
    this.kind = null;
    const { byId } = this;
    for (const button of document.querySelectorAll("[data-act]"))
      button.addEventListener("click", () => this.start(button.dataset.act));
    byId("dismiss").addEventListener("click", () => this.close());
    byId("form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.add();
    });
    byId("value").addEventListener("input", () => this.show());
    byId("direction").addEventListener("change", () => {
      this.own = byId("direction").value === "own" ? this.vector() : null;
      this.show();
    });
    for (const id of ["dx", "dy", "dz"])
      byId(id).addEventListener("input", () => {
        const own = new THREE.Vector3(...["dx", "dy", "dz"].map((k) => Number(byId(k).value) || 0));
        if (own.lengthSq() === 0) return;
        this.own = own.normalize();
        byId("direction").value = "own";
        this.show(true);
      });
  }

  get open() {
    return this.kind !== null;
  }

  // Whether a condition of the state is being changed, so that the draft is shown in its place.
  changes(condition) {
    return this.open && this.condition === condition.index;
  }

  start(kind) {
    if (kind === "fix" || kind === "slide")
      return this.send("fix", { faces: this.numbers(), kind: kind === "fix" ? "all" : "normal" }) && this.finish();
    if (this.kind === kind && this.condition === null) return this.close();
    this.condition = null;
    this.faces = null;
    this.own = null;
    this.openForm(kind, first[kind], kind === "gravity" ? "-z" : "in");
  }

  change(condition) {
    this.condition = condition.index;
    this.faces = condition.faces;
    this.own = condition.vector && new THREE.Vector3(...condition.vector).normalize();
    const value = condition.value ?? Math.hypot(...(condition.vector || [0]));
    if (condition.faces) this.choose(condition.faces);
    this.openForm(condition.kind, condition.kind === "pressure" ? value / 1e6 : value, "own");
  }

  // A form that is open, and the same opened again.
  kept() {
    return this.open ? { kind: this.kind, condition: this.condition, value: this.byId("value").value,
      direction: this.byId("direction").value, own: this.own && this.own.toArray() } : null;
  }

  restore(kept) {
    if (!kept) return;
    this.condition = kept.condition;
    this.own = kept.own && new THREE.Vector3(...kept.own);
    this.openForm(kept.kind, kept.value, kept.direction);
  }

  openForm(kind, value, direction) {
    const { byId } = this;
    this.kind = kind;
    byId("form").hidden = false;
    byId("value-name").textContent = names[kind];
    byId("value-unit").textContent = unitOf[kind];
    byId("value").value = Number(Number(value).toPrecision(6));
    byId("direction").value = direction;
    for (const id of ["direction-label", "vector", "drag-hint"]) byId(id).hidden = kind === "pressure";
    byId("add").textContent = this.condition === null ? "Add" : "Change";
    this.mark();
    this.show();
    byId("value").focus();
    byId("value").select();
  }

  mark() {
    for (const button of document.querySelectorAll("[data-act][aria-expanded]"))
      button.setAttribute("aria-expanded", String(this.kind === button.dataset.act));
  }

  close() {
    if (!this.open) return;
    const button = document.querySelector(`[data-act=${this.kind}]`);
    const within = this.byId("form").contains(document.activeElement);
    this.kind = this.condition = null;
    this.byId("form").hidden = true;
    this.mark();
    this.handles.set("direction", null);
    this.symbols();
    if (within && !button.disabled) button.focus();
  }

  // What was chosen has got its support or load.
  finish() {
    this.close();
    this.choose([]);
  }

  place() {
    const face = [...this.chosen()][0];
    return face === undefined || !this.view.surface ? null : this.view.symbols.centre(this.view.surface, face);
  }

  // The direction of the load, of length 1.
  vector() {
    const word = this.byId("direction").value;
    if (word === "own" && this.own) return this.own.clone();
    if (word === "in" || word === "out") {
      const normal = this.place()?.normal.clone() || new THREE.Vector3(0, 0, 1);
      return word === "in" ? normal.negate() : normal;
    }
    return word === "own" ? new THREE.Vector3(0, 0, -1) : axis(word);
  }

  conditions() {
    if (!this.open || (this.kind !== "gravity" && this.chosen().size === 0)) return [];
    return [{ kind: this.kind, faces: this.numbers(), vector: this.vector().toArray(), value: Number(this.byId("value").value), draft: true }];
  }

  facesChanged() {
    if (this.open && !this.handles.dragged) this.show();
  }

  show(typed = false) {
    if (!this.open) return;
    const direction = this.vector();
    if (!typed) for (const [k, id] of ["dx", "dy", "dz"].entries()) this.byId(id).value = Number(direction.getComponent(k).toFixed(3)) + 0;
    this.symbols();
    this.byId("add").disabled = this.kind !== "gravity" && this.chosen().size === 0;
    const place = this.kind === "gravity" ? { at: this.view.rest.getCenter(new THREE.Vector3()), normal: direction } : this.place();
    if (this.kind === "pressure" || !place) return this.handles.set("direction", null);
    // The tail of an arrow that pushes lies outside, and so does the tip of one that pulls.
    const pulls = this.kind === "moment" || place.normal.dot(direction) > 0.1;
    this.handles.set("direction", { at: place.at, direction: direction.clone().multiplyScalar(pulls ? 1 : -1), colour: "#1565c0",
      length: 0.24 * this.view.size, words: `${this.byId("value").value} ${unitOf[this.kind]}`,
      move: (handle, x, y) => {
        handle.direction = this.handles.around(handle, x, y);
        this.own = handle.direction.clone().multiplyScalar(pulls ? 1 : -1);
        this.byId("direction").value = "own";
        for (const [k, id] of ["dx", "dy", "dz"].entries()) this.byId(id).value = Number(this.own.getComponent(k).toFixed(3)) + 0;
        this.symbols();
      },
      end: () => this.show() });
  }

  add() {
    const value = Number(this.byId("value").value);
    if (!(Math.abs(value) > 0)) return this.say(`Give the ${names[this.kind].toLowerCase()} in ${unitOf[this.kind]}, not 0.`, true);
    const vector = this.vector().multiplyScalar(value).toArray().map((x) => Number(x.toPrecision(6)) + 0);
    const fields = { force: { force: vector }, pressure: { pressure: value * 1e6 }, moment: { moment: vector },
      gravity: { acceleration: vector } }[this.kind];
    const where = this.kind === "gravity" ? {} : { faces: this.numbers() };
    const sent = this.condition === null
      ? this.send(this.kind === "force" ? "load" : this.kind, { ...where, ...fields })
      : this.send("change", { condition: this.condition, ...where, ...fields });
    if (sent) this.finish();
  }
}
