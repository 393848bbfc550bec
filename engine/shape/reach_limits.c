/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Swing and twist of a joint, and what its limits bar. */
#include "shape/reach.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
/* Limits closer than this, in radians, leave no room. */
static const double min_range = 1e-6;

void bw_joint_limit_none(bw_joint_limit *limit) {
  limit->swing = pi;
  limit->twist_min = -pi;
  limit->twist_max = pi;
}

/* ---- quaternions ----------------------------------------------------------------------------- */

static void normalise(double q[4]) {
  double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (int k = 0; k < 4; k++)
    q[k] /= length;
}

/* From the largest of the four squares, so that no division loses digits. */
void bwi_quaternion_of(const double r[9], double q[4]) {
  double square[4] = {1 + r[0] + r[4] + r[8], 1 + r[0] - r[4] - r[8], 1 - r[0] + r[4] - r[8],
                      1 - r[0] - r[4] + r[8]};
  double product[4][4] = {{square[0], r[7] - r[5], r[2] - r[6], r[3] - r[1]},
                          {r[7] - r[5], square[1], r[1] + r[3], r[2] + r[6]},
                          {r[2] - r[6], r[1] + r[3], square[2], r[5] + r[7]},
                          {r[3] - r[1], r[2] + r[6], r[5] + r[7], square[3]}};
  int largest = 0;
  for (int k = 1; k < 4; k++)
    if (square[k] > square[largest])
      largest = k;
  memcpy(q, product[largest], 4 * sizeof(double));
  normalise(q);
}

void bwi_quaternion_rotation(const double q[4], double r[9]) {
  double w = q[0], x = q[1], y = q[2], z = q[3];
  const double out[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z),     2 * (x * z + w * y),
                         2 * (x * y + w * z),     1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y),     2 * (y * z + w * x),     1 - 2 * (x * x + y * y)};
  memcpy(r, out, sizeof out);
}

static void product(const double a[4], const double b[4], double c[4]) {
  const double out[4] = {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
                         a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
                         a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
                         a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
  memcpy(c, out, sizeof out);
}

void bwi_quaternion_turn(const double turn[3], double q[4]) {
  double angle = bw_norm(turn), part = angle > 0 ? sin(angle / 2) / angle : 0.5;
  const double by[4] = {cos(angle / 2), part * turn[0], part * turn[1], part * turn[2]};
  product(by, q, q);
  normalise(q);
}

/* ---- swing and twist ------------------------------------------------------------------------- */

/* The twist as a quaternion, w not negative; none at all when the direction is turned right round,
 * where it is not defined. */
static void twist_of(const double q[4], const double direction[3], double twist[4]) {
  double along = bw_dot(q + 1, direction), length = hypot(q[0], along);
  double scale = length > 1e-12 ? copysign(1 / length, q[0]) : 0;
  twist[0] = scale != 0 ? q[0] * scale : 1;
  for (int k = 0; k < 3; k++)
    twist[1 + k] = along * scale * direction[k];
}

void bwi_swing_twist(const double q[4], const double direction[3], double *swing, double *twist) {
  double along = bw_dot(q + 1, direction), across[3], part[4];
  for (int k = 0; k < 3; k++)
    across[k] = q[1 + k] - along * direction[k];
  *swing = 2 * atan2(bw_norm(across), hypot(q[0], along));
  twist_of(q, direction, part);
  *twist = 2 * atan2(bw_dot(part + 1, direction), part[0]);
}

bool bwi_limit_rotation(const bw_joint_limit *limit, const double direction[3], double q[4]) {
  double swing_angle, twist_angle, twist[4], back[4], swing[4];
  bwi_swing_twist(q, direction, &swing_angle, &twist_angle);
  double twist_to = fmin(fmax(twist_angle, limit->twist_min), limit->twist_max);
  bool swings = swing_angle > limit->swing;
  if (!swings && twist_to == twist_angle)
    return false;
  twist_of(q, direction, twist);
  for (int k = 0; k < 4; k++)
    back[k] = k == 0 ? twist[k] : -twist[k];
  product(q, back, swing);
  if (swings) {
    double length = bw_norm(swing + 1), to = sin(limit->swing / 2);
    swing[0] = cos(limit->swing / 2);
    for (int k = 1; k < 4; k++)
      swing[k] *= to / length;
  }
  twist[0] = cos(twist_to / 2);
  for (int k = 0; k < 3; k++)
    twist[1 + k] = sin(twist_to / 2) * direction[k];
  product(swing, twist, q);
  normalise(q);
  return true;
}

/* ---- what is barred -------------------------------------------------------------------------- */

static void bar(bwi_bars *bars, const double axis[3], double low, double high) {
  double length = bw_norm(axis);
  for (int k = 0; k < 3; k++)
    bars->axis[bars->count][k] = axis[k] / length;
  bars->low[bars->count] = fmin(low, 0);
  bars->high[bars->count++] = fmax(high, 0);
}

/* With d the rest direction and a where the joint has turned it, a turn w changes the swing by
 * w . (d x a) / |d x a| and the twist by w . (d + a) / (1 + d . a), where |d + a|^2 = 2 (1 + d .
 * a). */
void bwi_limit_bars(const bw_joint_limit *limit, const double direction[3], const double q[4],
                    bwi_bars *bars) {
  double swing, twist, r[9], turned[3], around[3], middle[3];
  bars->count = 0;
  bwi_swing_twist(q, direction, &swing, &twist);
  bwi_quaternion_rotation(q, r);
  for (int k = 0; k < 3; k++) {
    turned[k] = bw_dot(r + 3 * k, direction);
    middle[k] = direction[k] + turned[k];
  }
  bw_cross(direction, turned, around);
  if (limit->swing < min_range) { /* both directions across are barred */
    double across[3], other[3];
    bw_across(direction, across, other);
    bar(bars, across, 0, 0);
    bar(bars, other, 0, 0);
  } else if (limit->swing < pi && bw_norm(around) > 1e-9) {
    bar(bars, around, -INFINITY, limit->swing - swing);
  }
  double rate = bw_norm(middle) / 2;
  if (rate < 1e-9)
    return;
  if (limit->twist_max - limit->twist_min < min_range)
    bar(bars, middle, 0, 0);
  else if (limit->twist_max < pi || limit->twist_min > -pi)
    bar(bars, middle, limit->twist_min > -pi ? rate * (limit->twist_min - twist) : -INFINITY,
        limit->twist_max < pi ? rate * (limit->twist_max - twist) : INFINITY);
}
