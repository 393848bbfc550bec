// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// The outline with its handles: drawing, and what lies under the mouse. Points are numbered from 0 here
// and in the blocks of the protocol, handles from 1.

import { ink } from "./theme.mjs";

const blue = "#1565c0";

export class Outline {
  constructor(plane) {
    this.plane = plane;
    this.allControls = false;
    this.hover = null; // a hit
    this.edge = -1; // whose control points are shown
    this.pins = new Set(); // vertices, from 1
  }

  // loops {name, first, count, region, parent}, segments five numbers each
  setScene(scene) {
    this.loops = scene.loops;
    this.tags = scene.tags;
    this.segments = [];
    for (let i = 0; i < scene.segments.length; i += 5) {
      const [start, c1, c2, end, tag] = scene.segments.slice(i, i + 5);
      this.segments.push({ start: start - 1, control: c1 > 0 ? [c1 - 1, c2 - 1] : null, end: end - 1, tag: tag - 1 });
    }
    this.loops.forEach((loop, l) => {
      for (let s = loop.first - 1; s < loop.first - 1 + loop.count; s++) this.segments[s].loop = l;
    });
    this.pins = new Set([...this.pins].filter((v) => v <= this.segments.length));
    if (this.edge >= this.segments.length) this.edge = -1;
    this.hover = null;
    this.points = null;
  }

  at(point) {
    return this.plane.toScreen(this.points[2 * point], this.points[2 * point + 1]);
  }

  world(point) {
    return [this.points[2 * point], this.points[2 * point + 1]];
  }

  // Pixels of points along a segment.
  along(segment, parts = 16) {
    const a = this.at(segment.start);
    const d = this.at(segment.end);
    if (!segment.control) return [a, d];
    const [b, c] = segment.control.map((p) => this.at(p));
    return Array.from({ length: parts + 1 }, (_, i) => {
      const t = i / parts;
      const s = 1 - t;
      return [0, 1].map((k) => s * s * s * a[k] + 3 * s * s * t * b[k] + 3 * s * t * t * c[k] + t * t * t * d[k]);
    });
  }

  trace(pen, loop) {
    for (let s = loop.first - 1; s < loop.first - 1 + loop.count; s++) {
      const segment = this.segments[s];
      if (s === loop.first - 1) pen.moveTo(...this.at(segment.start));
      if (segment.control) pen.bezierCurveTo(...segment.control.flatMap((p) => this.at(p)), ...this.at(segment.end));
      else pen.lineTo(...this.at(segment.end));
    }
    pen.closePath();
  }

  controlsShown(s) {
    if (this.allControls) return true;
    if (this.edge < 0) return false;
    const near = this.segments[this.edge];
    const segment = this.segments[s];
    return s === this.edge || segment.end === near.start || segment.start === near.end;
  }

  draw(pen, tool) {
    if (!this.points) return;
    pen.lineWidth = 1.5;
    pen.strokeStyle = ink();
    pen.beginPath();
    for (const loop of this.loops) this.trace(pen, loop);
    pen.stroke();
    const lit = this.hover;
    if (lit && (lit.edge || lit.loop)) {
      pen.beginPath();
      if (lit.edge && !lit.wholeLoop) {
        this.along(this.segments[lit.edge - 1]).forEach((p, i) => (i ? pen.lineTo(...p) : pen.moveTo(...p)));
      } else this.trace(pen, this.loops[lit.loopIndex]);
      pen.lineWidth = 3.5;
      pen.strokeStyle = blue;
      pen.stroke();
    }
    pen.lineWidth = 1;
    this.segments.forEach((segment, s) => {
      if (segment.control && this.controlsShown(s) && tool === "drag") {
        pen.strokeStyle = "#5b6875";
        [[segment.start, segment.control[0]], [segment.end, segment.control[1]]].forEach(([v, c], k) => {
          pen.beginPath();
          pen.moveTo(...this.at(v));
          pen.lineTo(...this.at(c));
          pen.stroke();
          pen.beginPath();
          pen.arc(...this.at(c), 4, 0, 2 * Math.PI);
          const on = lit && lit.control === k + 1 && lit.edge === s + 1;
          pen.fillStyle = on ? blue : "#fff";
          pen.fill();
          pen.stroke();
        });
      }
      const [x, y] = this.at(segment.start);
      const pinned = this.pins.has(s + 1);
      pen.fillStyle = pinned ? "#c62828" : lit && lit.vertex === s + 1 ? blue : "#fff";
      pen.strokeStyle = ink();
      pen.beginPath();
      if (pinned) pen.arc(x, y, 5, 0, 2 * Math.PI);
      else pen.rect(x - 3.5, y - 3.5, 7, 7);
      pen.fill();
      pen.stroke();
    });
  }

  // The innermost loop around a place of the screen, -1: none.
  inside(x, y) {
    let best = -1;
    let least = Infinity;
    this.loops.forEach((loop, l) => {
      const ring = [];
      for (let s = loop.first - 1; s < loop.first - 1 + loop.count; s++) ring.push(...this.along(this.segments[s]).slice(0, -1));
      let odd = false;
      let area = 0;
      for (let i = 0, j = ring.length - 1; i < ring.length; j = i++) {
        const [a, b] = [ring[i], ring[j]];
        area += a[0] * b[1] - a[1] * b[0];
        if (a[1] > y !== b[1] > y && x < ((b[0] - a[0]) * (y - a[1])) / (b[1] - a[1]) + a[0]) odd = !odd;
      }
      if (odd && Math.abs(area) < least) {
        least = Math.abs(area);
        best = l;
      }
    });
    return best;
  }

  // What lies at a place of the screen: {vertex}, {edge, t}, {edge, control}, {loop, loopIndex}, or null.
  hit(x, y, tool, whole) {
    if (!this.points) return null;
    const reach = (p, most) => Math.hypot(this.at(p)[0] - x, this.at(p)[1] - y) <= most;
    let found = null;
    if (tool === "drag" && !whole)
      this.segments.forEach((segment, s) => {
        if (!segment.control || !this.controlsShown(s)) return;
        segment.control.forEach((c, k) => {
          if (reach(c, 7)) found = { edge: s + 1, control: k + 1 };
        });
      });
    if (found) return found;
    if (!whole)
      this.segments.forEach((segment, s) => {
        if (!found && reach(segment.start, 8)) found = { vertex: s + 1, loopIndex: segment.loop };
      });
    if (found) return found;
    let least = 6;
    this.segments.forEach((segment, s) => {
      const line = this.along(segment);
      for (let i = 0; i + 1 < line.length; i++) {
        const [a, b] = [line[i], line[i + 1]];
        const d = [b[0] - a[0], b[1] - a[1]];
        const t = Math.min(1, Math.max(0, ((x - a[0]) * d[0] + (y - a[1]) * d[1]) / (d[0] ** 2 + d[1] ** 2 || 1)));
        const off = Math.hypot(x - a[0] - t * d[0], y - a[1] - t * d[1]);
        if (off < least) {
          least = off;
          found = { edge: s + 1, t: (i + t) / (line.length - 1), loopIndex: segment.loop };
        }
      }
    });
    if (found) return whole ? { loop: this.loops[found.loopIndex].name, loopIndex: found.loopIndex } : found;
    const l = this.inside(x, y);
    // the outermost loop is dragged by its edge, so that one can look around
    if (l >= 0 && (whole || this.loops[l].parent)) return { loop: this.loops[l].name, loopIndex: l };
    return null;
  }
}
