// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// A surface with fewer triangles, by clusters of points. Its triangles use points of the surface itself.

// Surfaces with fewer triangles are always drawn whole; coarse ones have at most as many.
export const MOST = 20000;

// For each point the sum of the unit normals of the triangles around it, and how many there are; and the whole area.
function normalsOf(points, triangles) {
  const normals = new Float32Array(points.length);
  const counts = new Uint16Array(points.length / 3);
  let area = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
    const [ux, uy, uz] = [points[b] - points[a], points[b + 1] - points[a + 1], points[b + 2] - points[a + 2]];
    const [vx, vy, vz] = [points[c] - points[a], points[c + 1] - points[a + 1], points[c + 2] - points[a + 2]];
    const [x, y, z] = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
    const length = Math.hypot(x, y, z);
    if (!(length > 0)) continue;
    area += 0.5 * length;
    for (const p of [a, b, c]) {
      normals[p] += x / length;
      normals[p + 1] += y / length;
      normals[p + 2] += z / length;
      counts[p / 3]++;
    }
  }
  return { normals, counts, area };
}

// The cube of a size that each point lies in, apart by the signs of the normal, so that both sides of a thin wall stay
// apart: number of clusters, number of the cluster of each point.
function clusters(points, normals, low, size) {
  const numbers = new Map();
  const of = new Int32Array(points.length / 3);
  for (let i = 0; i < of.length; i++) {
    const p = 3 * i;
    const part = 0.3 * Math.hypot(normals[p], normals[p + 1], normals[p + 2]);
    let key = 0;
    for (let k = 0; k < 3; k++) key = 3 * key + (normals[p + k] > part ? 2 : normals[p + k] < -part ? 1 : 0);
    for (let k = 0; k < 3; k++) key = key * 4096 + Math.min(4095, Math.floor((points[p + k] - low[k]) / size));
    let number = numbers.get(key);
    if (number === undefined) numbers.set(key, (number = numbers.size));
    of[i] = number;
  }
  return { count: numbers.size, of };
}

// One point of each cluster: where the surface is sharpest, then nearest to the mean of all.
function chosen(points, { normals, counts }, { count, of }) {
  const sums = new Float64Array(4 * count);
  for (let i = 0; i < of.length; i++) {
    for (let k = 0; k < 3; k++) sums[4 * of[i] + k] += points[3 * i + k];
    sums[4 * of[i] + 3]++;
  }
  const best = new Int32Array(count).fill(-1);
  const [flattest, least] = [new Float64Array(count), new Float64Array(count)];
  for (let i = 0; i < of.length; i++) {
    const [c, p] = [of[i], 3 * i];
    const flat = Math.round((8 * Math.hypot(normals[p], normals[p + 1], normals[p + 2])) / Math.max(1, counts[i]));
    let far = 0;
    for (let k = 0; k < 3; k++) far += (points[p + k] - sums[4 * c + k] / sums[4 * c + 3]) ** 2;
    if (best[c] >= 0 && (flat > flattest[c] || (flat === flattest[c] && far >= least[c]))) continue;
    best[c] = i;
    flattest[c] = flat;
    least[c] = far;
  }
  return best;
}

// Triangles, numbers of points, of a surface with at most `most`; the same ones where there are no more.
export function coarsen(points, triangles, most = MOST) {
  if (triangles.length / 3 <= most) return triangles;
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i++) {
    low[i % 3] = Math.min(low[i % 3], points[i]);
    high[i % 3] = Math.max(high[i % 3], points[i]);
  }
  const around = normalsOf(points, triangles);
  const longest = Math.max(...high.map((x, k) => x - low[k])) || 1;
  for (let size = Math.max(longest / 4096, Math.sqrt((2.2 * around.area) / most)); ; size *= 1.25) {
    const parts = clusters(points, around.normals, low, size);
    const point = chosen(points, around, parts);
    const out = [];
    const seen = new Set();
    for (let t = 0; t < triangles.length; t += 3) {
      const [a, b, c] = [parts.of[triangles[t]], parts.of[triangles[t + 1]], parts.of[triangles[t + 2]]];
      if (a === b || b === c || c === a) continue;
      const first = Math.min(a, b, c);
      const last = Math.max(a, b, c);
      const key = (first * parts.count + (a + b + c - first - last)) * parts.count + last;
      if (seen.has(key)) continue;
      seen.add(key);
      out.push(point[a], point[b], point[c]);
    }
    if (out.length / 3 <= most || size > longest) return Uint32Array.from(out);
  }
}
