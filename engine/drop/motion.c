/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Free flight: fall, rotation without torque, and modes that swing (docs/theory/drop.md). */
#include "drop/internal.h"

#include <math.h>
#include <string.h>

bw_status bwi_drop_motion_create(bw_context *context, const bw_modes *modes, int count,
                                 const bw_damping *damping, bwi_drop_motion *m) {
  bw_status status = BW_OK;
  m->modes = count;
  m->omega = BW_NEW(context, double, m->modes);
  m->damping = BW_NEW(context, double, m->modes);
  m->q = BW_NEW0(context, double, m->modes);
  m->rate = BW_NEW0(context, double, m->modes);
  m->map = BW_NEW(context, double, 4 * (int64_t)m->modes);
  BW_TRY_MEMORY(m->omega && m->damping && m->q && m->rate && m->map);
  for (int k = 0; k < m->modes; k++) {
    m->omega[k] = sqrt(modes->eigenvalue[k]);
    m->damping[k] = 2 * damping->ratio * m->omega[k] + damping->stiffness * modes->eigenvalue[k];
  }
done:
  return status;
}

void bwi_drop_motion_clear(bwi_drop_motion *m) {
  bw_free(m->omega);
  bw_free(m->damping);
  bw_free(m->q);
  bw_free(m->rate);
  bw_free(m->map);
}

void bwi_drop_motion_copy(const bwi_drop_motion *from, bwi_drop_motion *to) {
  to->time = from->time;
  to->damped = from->damped;
  memcpy(to->centre, from->centre, sizeof to->centre);
  memcpy(to->velocity, from->velocity, sizeof to->velocity);
  memcpy(to->turn, from->turn, sizeof to->turn);
  memcpy(to->momentum, from->momentum, sizeof to->momentum);
  memcpy(to->q, from->q, (size_t)to->modes * sizeof *to->q);
  memcpy(to->rate, from->rate, (size_t)to->modes * sizeof *to->rate);
}

/* ---- rotation -------------------------------------------------------------------------------- */

/* turn I^-1 turn^T momentum */
static void spin_of(const bwi_drop_motion *m, const double turn[9], double spin[3]) {
  double body[3] = {0}, rate[3];
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      body[k] += turn[3 * i + k] * m->momentum[i];
  for (int i = 0; i < 3; i++)
    rate[i] = bw_dot(m->inverse + 3 * i, body);
  for (int i = 0; i < 3; i++)
    spin[i] = bw_dot(turn + 3 * i, rate);
}

void bwi_drop_spin(const bwi_drop_motion *m, double spin[3]) {
  spin_of(m, m->turn, spin);
}

/* out = the rotation by `angle` (a vector of space) times turn (Rodrigues) */
static void rotate(const double angle[3], const double turn[9], double out[9]) {
  double size = bw_norm(angle), s = size > 0 ? sin(size) / size : 1, half = sin(size / 2);
  double c = size > 0 ? 2 * half * half / (size * size) : 0.5;
  for (int k = 0; k < 3; k++) {
    double x[3] = {turn[k], turn[3 + k], turn[6 + k]}, once[3], twice[3];
    bw_cross(angle, x, once);
    bw_cross(angle, once, twice);
    for (int i = 0; i < 3; i++)
      out[3 * i + k] = x[i] + s * once[i] + c * twice[i];
  }
}

/* Rows of length 1 at right angles, against rounding. */
static void straighten(double turn[9]) {
  double *x = turn, *y = turn + 3, *z = turn + 6, along = bw_dot(x, y) / bw_dot(x, x), scale[2];
  for (int k = 0; k < 3; k++)
    y[k] -= along * x[k];
  scale[0] = 1 / bw_norm(x);
  scale[1] = 1 / bw_norm(y);
  for (int k = 0; k < 3; k++) {
    x[k] *= scale[0];
    y[k] *= scale[1];
  }
  bw_cross(x, y, z);
}

/* The rule of the middle: the spin is that of the attitude after half a step. It is found by
 * iteration, which gains the factor |spin| step each time. */
static void rotate_freely(bwi_drop_motion *m, double step) {
  double spin[3], angle[3], middle[9], turned[9];
  spin_of(m, m->turn, spin);
  for (int round = 0; round < 20; round++) {
    double before[3], change = 0;
    memcpy(before, spin, sizeof before);
    for (int k = 0; k < 3; k++)
      angle[k] = 0.5 * step * spin[k];
    rotate(angle, m->turn, middle);
    spin_of(m, middle, spin);
    for (int k = 0; k < 3; k++)
      change = fmax(change, fabs(spin[k] - before[k]));
    if (change <= 1e-15 * bw_norm(spin))
      break;
  }
  for (int k = 0; k < 3; k++)
    angle[k] = step * spin[k];
  rotate(angle, m->turn, turned);
  straighten(turned);
  memcpy(m->turn, turned, sizeof turned);
}

/* ---- modes ----------------------------------------------------------------------------------- */

/* exp of a step of q'' + c q' + w^2 q = 0 */
static void map_step(bwi_drop_motion *m, double step) {
  m->step = step;
  for (int k = 0; k < m->modes; k++) {
    double w = m->omega[k], d = m->damping[k] / 2, square = w * w - d * d, c, s;
    double *map = m->map + 4 * k;
    double fall = exp(-d * step), r = sqrt(fabs(square)), x = r * step;
    if (square >= 0) { /* s = sin(r t) / r */
      c = fall * cos(x);
      s = x > 0 ? fall * sin(x) / r : fall * step;
    } else { /* overdamped: both exponents are negative */
      double slow = exp((r - d) * step), fast = exp(-(r + d) * step);
      c = 0.5 * (slow + fast);
      s = 0.5 * (slow - fast) / r;
    }
    map[0] = c + d * s;
    map[1] = s;
    map[2] = -w * w * s;
    map[3] = c - d * s;
  }
}

static double modal_energy(const bwi_drop_motion *m) {
  double sum = 0;
  for (int k = 0; k < m->modes; k++) {
    double swing = m->omega[k] * m->q[k];
    sum += 0.5 * (m->rate[k] * m->rate[k] + swing * swing);
  }
  return sum;
}

void bwi_drop_drift(bwi_drop_motion *m, double step) {
  bool damped = false;
  if (m->step != step)
    map_step(m, step);
  for (int k = 0; k < m->modes; k++)
    damped = damped || m->damping[k] > 0;
  double before = damped ? modal_energy(m) : 0;
  for (int k = 0; k < m->modes; k++) {
    const double *map = m->map + 4 * k;
    double q = m->q[k], rate = m->rate[k];
    m->q[k] = map[0] * q + map[1] * rate;
    m->rate[k] = map[2] * q + map[3] * rate;
  }
  if (damped)
    m->damped += before - modal_energy(m);
  for (int k = 0; k < 3; k++) {
    m->centre[k] += step * (m->velocity[k] + 0.5 * step * m->gravity[k]);
    m->velocity[k] += step * m->gravity[k];
  }
  rotate_freely(m, step);
  m->time += step;
}
