// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The axes in a corner of the view, which turn with the camera; each is a button that looks along it.
import * as THREE from "three";

const colours = ["#c62828", "#2e7d32", "#1565c0"];

export function element(name, attributes = {}, ...children) {
  const one = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) one.setAttribute(key, value);
  one.append(...children);
  return one;
}

export class Triad {
  // look(direction): asked for by a click or a key.
  constructor(svg, look) {
    this.axes = ["X", "Y", "Z"].map((name, k) => {
      const line = element("line", { stroke: colours[k] });
      const circle = element("circle", { r: 9, fill: colours[k] });
      const text = element("text", {}, name);
      const group = element("g", { role: "button", tabindex: 0, "aria-label": `Look along ${name}` }, line, circle, text);
      const go = (event) => look([0, 1, 2].map((i) => (i === k ? (event.shiftKey ? -1 : 1) : i === 1 && k === 2 ? -0.001 : 0)));
      group.addEventListener("click", go);
      group.addEventListener("keydown", (event) => {
        if (event.key !== "Enter" && event.key !== " ") return;
        event.preventDefault();
        go(event);
      });
      svg.append(group);
      return { group, line, circle, text, direction: new THREE.Vector3().setComponent(k, 1) };
    });
    this.svg = svg;
  }

  place(camera) {
    const inverse = camera.quaternion.clone().invert();
    for (const axis of this.axes) {
      const p = axis.direction.clone().applyQuaternion(inverse).multiplyScalar(28);
      axis.line.setAttribute("x2", p.x);
      axis.line.setAttribute("y2", -p.y);
      for (const one of [axis.circle, axis.text]) one.setAttribute("transform", `translate(${p.x} ${-p.y})`);
    }
  }
}
