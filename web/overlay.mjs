// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// What lies over the report's view: the directions of the axes, and a place with its text, which follows the body.
import * as THREE from "three";

const SVG = "http://www.w3.org/2000/svg";
const COLOURS = ["#b3261e", "#1b7f3b", "#1a5fb4"];

function element(name, attributes, parent) {
  const out = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) out.setAttribute(key, value);
  parent.appendChild(out);
  return out;
}

function nearest(points, at) {
  let best = 0;
  let least = Infinity;
  for (let i = 0; i < points.length; i += 3) {
    const d = (points[i] - at[0]) ** 2 + (points[i + 1] - at[1]) ** 2 + (points[i + 2] - at[2]) ** 2;
    if (d < least) [least, best] = [d, i];
  }
  return best;
}

export class Overlay {
  // callout: {at, text}, or nothing; rest: the points of the surface.
  constructor(view, camera, callout, rest) {
    this.view = view;
    this.camera = camera;
    this.triad = element("svg", { id: "triad", viewBox: "-36 -36 72 72", "aria-hidden": "true" }, view);
    this.axes = ["x", "y", "z"].map((name, k) => {
      const line = element("line", { x1: 0, y1: 0, stroke: COLOURS[k] }, this.triad);
      const text = element("text", { fill: COLOURS[k] }, this.triad);
      text.textContent = name;
      return { line, text, k };
    });
    if (!callout) return;
    this.leader = element("svg", { id: "leader", "aria-hidden": "true" }, view);
    this.line = element("line", {}, this.leader);
    this.ring = element("circle", { r: 7 }, this.leader);
    this.label = document.createElement("div");
    this.label.id = "callout";
    this.label.textContent = callout.text;
    view.appendChild(this.label);
    this.point = nearest(rest, callout.at);
  }

  place(points) {
    const turned = this.camera.quaternion.clone().invert();
    for (const { line, text, k } of this.axes) {
      const axis = new THREE.Vector3().setComponent(k, 1).applyQuaternion(turned);
      line.setAttribute("x2", 24 * axis.x);
      line.setAttribute("y2", -24 * axis.y);
      text.setAttribute("x", 31 * axis.x);
      text.setAttribute("y", -31 * axis.y);
    }
    if (!this.label) return;
    const at = new THREE.Vector3().fromArray(points, this.point).project(this.camera);
    const { clientWidth: width, clientHeight: height } = this.view;
    const [x, y] = [((at.x + 1) / 2) * width, ((1 - at.y) / 2) * height];
    const hidden = at.z > 1 || x < 0 || y < 0 || x > width || y > height;
    this.label.hidden = hidden;
    this.leader.style.display = hidden ? "none" : "";
    const { offsetWidth, offsetHeight } = this.label;
    // Towards the upper corner that is farther from the place.
    const left = x > width / 2 ? 10 : width - offsetWidth - 10;
    this.label.style.transform = `translate(${left}px, 10px)`;
    for (const [name, value] of Object.entries({ x1: left + (x > width / 2 ? offsetWidth : 0),
      y1: 10 + offsetHeight / 2, x2: x, y2: y })) this.line.setAttribute(name, value);
    this.ring.setAttribute("cx", x);
    this.ring.setAttribute("cy", y);
  }
}
