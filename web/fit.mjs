// Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
// How far a camera of perspective stands from the centre of a box, so that the whole box is in its picture.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / (Math.hypot(...a) || 1));

// In diagonals of the box: the camera stays outside what is seen end on.
export const LEAST = 0.6;

// The least distance for a box of sizes [x, y, z] seen from a direction (from the centre to the camera). `fov` is the
// vertical angle of view in degrees, `aspect` the width over the height, `margin` a factor of room on each side.
export function fitDistance(sizes, from, up, fov, aspect, margin = 1.06) {
  const back = unit(from);
  const aside = cross(up, back);
  const right = unit(Math.hypot(...aside) > 1e-9 ? aside : cross([1, 0, 0], back));
  const above = cross(back, right);
  const slope = Math.tan((fov * Math.PI) / 360) / margin;
  let distance = LEAST * Math.hypot(...sizes);
  for (let k = 0; k < 8; k++) {
    const corner = sizes.map((size, i) => ((k >> i) & 1 ? 0.5 : -0.5) * size);
    const needed = Math.max(Math.abs(dot(corner, right)) / aspect, Math.abs(dot(corner, above))) / slope;
    distance = Math.max(distance, needed + dot(corner, back));
  }
  return distance;
}
