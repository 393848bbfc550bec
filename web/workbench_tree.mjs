// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// A tree of boxes over triangles: which one a ray meets first. Nodes lie in arrays, children behind their parent.

const most = 8; // triangles in a leaf

export class Tree {
  constructor(positions, triangles) {
    this.positions = positions;
    this.triangles = triangles;
    const count = triangles.length / 3;
    this.order = Uint32Array.from({ length: count }, (_, i) => i);
    this.centres = new Float32Array(triangles.length);
    for (let t = 0; t < count; t++)
      for (let k = 0; k < 3; k++)
        this.centres[3 * t + k] = (positions[3 * triangles[3 * t] + k] + positions[3 * triangles[3 * t + 1] + k] +
          positions[3 * triangles[3 * t + 2] + k]) / 3;
    const nodes = Math.max(1, count);
    this.boxes = new Float32Array(12 * nodes);
    this.first = new Uint32Array(2 * nodes); // of a leaf: its first triangle in `order`; else its second child
    this.size = new Uint32Array(2 * nodes); // triangles of a leaf, 0 of others
    this.used = 0;
    if (count > 0) this.build(0, count, 0);
  }

  build(from, to, depth) {
    const node = this.used++;
    const { boxes, positions, triangles, order, centres } = this;
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    const least = [Infinity, Infinity, Infinity];
    const largest = [-Infinity, -Infinity, -Infinity];
    for (let i = from; i < to; i++) {
      const t = 3 * order[i];
      for (let k = 0; k < 3; k++) {
        const c = centres[t + k];
        if (c < least[k]) least[k] = c;
        if (c > largest[k]) largest[k] = c;
        for (let v = 0; v < 3; v++) {
          const x = positions[3 * triangles[t + v] + k];
          if (x < low[k]) low[k] = x;
          if (x > high[k]) high[k] = x;
        }
      }
    }
    boxes.set(low, 6 * node);
    boxes.set(high, 6 * node + 3);
    const extent = largest.map((x, k) => x - least[k]);
    const axis = extent.indexOf(Math.max(...extent));
    if (to - from <= most || !(extent[axis] > 0) || depth > 48) {
      this.first[node] = from;
      this.size[node] = to - from;
      return node;
    }
    const middle = (least[axis] + largest[axis]) / 2;
    let split = from;
    for (let i = from; i < to; i++)
      if (centres[3 * order[i] + axis] < middle) {
        [order[i], order[split]] = [order[split], order[i]];
        split++;
      }
    if (split === from || split === to) split = (from + to) >> 1;
    this.build(from, split, depth + 1);
    this.first[node] = this.build(split, to, depth + 1);
    return node;
  }

  // How far along a ray its box begins, or Infinity.
  enter(node, origin, inverse, nearest) {
    let [from, to] = [0, nearest];
    for (let k = 0; k < 3; k++) {
      const a = (this.boxes[6 * node + k] - origin[k]) * inverse[k];
      const b = (this.boxes[6 * node + 3 + k] - origin[k]) * inverse[k];
      from = Math.max(from, Math.min(a, b));
      to = Math.min(to, Math.max(a, b));
    }
    return from <= to * (1 + 1e-6) ? from : Infinity;
  }

  // The first triangle along a ray whose point `visible(point)` accepts: {triangle, point, distance, weights}, or null.
  hit(origin, direction, visible = () => true) {
    const inverse = direction.map((x) => 1 / (x || 1e-30));
    const stack = this.used ? [0] : [];
    let best = null;
    while (stack.length) {
      const node = stack.pop();
      if (this.enter(node, origin, inverse, best ? best.distance : Infinity) === Infinity) continue;
      if (this.size[node] === 0) {
        stack.push(this.first[node], node + 1);
        continue;
      }
      for (let i = this.first[node]; i < this.first[node] + this.size[node]; i++) {
        const found = this.meets(this.order[i], origin, direction);
        if (found && (!best || found.distance < best.distance) && visible(found.point)) best = found;
      }
    }
    return best;
  }

  // Moeller and Trumbore, 1997.
  meets(triangle, o, d) {
    const { positions: p, triangles } = this;
    const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[3 * triangle + k]);
    const [e0, e1, e2] = [p[b] - p[a], p[b + 1] - p[a + 1], p[b + 2] - p[a + 2]];
    const [f0, f1, f2] = [p[c] - p[a], p[c + 1] - p[a + 1], p[c + 2] - p[a + 2]];
    const [h0, h1, h2] = [d[1] * f2 - d[2] * f1, d[2] * f0 - d[0] * f2, d[0] * f1 - d[1] * f0];
    const det = e0 * h0 + e1 * h1 + e2 * h2;
    if (det === 0) return null;
    const [s0, s1, s2] = [o[0] - p[a], o[1] - p[a + 1], o[2] - p[a + 2]];
    const u = (s0 * h0 + s1 * h1 + s2 * h2) / det;
    if (u < 0 || u > 1) return null;
    const [q0, q1, q2] = [s1 * e2 - s2 * e1, s2 * e0 - s0 * e2, s0 * e1 - s1 * e0];
    const v = (d[0] * q0 + d[1] * q1 + d[2] * q2) / det;
    if (v < 0 || u + v > 1) return null;
    const distance = (f0 * q0 + f1 * q1 + f2 * q2) / det;
    if (!(distance > 0)) return null;
    return { triangle, distance, weights: [1 - u - v, u, v], point: o.map((x, k) => x + distance * d[k]) };
  }
}
