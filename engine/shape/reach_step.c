/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* One step of inverse kinematics: the least of the quadratic model within the limits of the joints,
 * to first order. Parts of the step that a limit bars are fixed, the others solved for; parts
 * pulled back inside are let go of again. */
#include "base/dense.h"
#include "shape/reach.h"

#include <math.h>
#include <string.h>

void bwi_reach_find_bars(const bwi_reach *r) {
  for (int32_t s = 0; s < r->slots; s++) {
    bwi_bars *bars = r->bars + s;
    bars->count = 0;
    if (!r->limit)
      continue;
    int32_t b = r->bone_of_slot[s], p = r->skeleton->parent[b];
    bwi_limit_bars(r->limit + b, r->direction + 3 * s, r->turn + 4 * s, bars);
    for (int i = 0; i < bars->count && p >= 0; i++) {
      double local[3];
      memcpy(local, bars->axis[i], sizeof local);
      for (int k = 0; k < 3; k++)
        bars->axis[i][k] = bw_dot(r->rotation + 9 * (size_t)p + 3 * k, local);
    }
  }
}

static void project(const bwi_reach *r, double *vector) {
  for (int32_t s = 0; s < r->slots; s++)
    for (int i = 0; i < r->bars[s].count; i++) {
      if (!r->barred[3 * s + i])
        continue;
      const double *axis = r->bars[s].axis[i];
      double part = bw_dot(vector + 3 * s, axis);
      for (int k = 0; k < 3; k++)
        vector[3 * s + k] -= part * axis[k];
    }
}

/* The step that keeps every barred part where it is barred: z = step - fixed in the range of the
 * projection P, (P H P + damping) z = P (gradient - H fixed). False when that is not positive
 * definite. */
static bool solve(const bwi_reach *r, double damping) {
  size_t n = 3 * (size_t)r->slots;
  double *a = r->matrix, *x = r->step, *fixed = r->fixed;
  memcpy(a, r->hessian, n * n * sizeof *a);
  for (size_t i = 0; i < n; i++) /* rows, then columns, of a symmetric matrix */
    project(r, a + i * n);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < i; j++) {
      double swap = a[i * n + j];
      a[i * n + j] = a[j * n + i];
      a[j * n + i] = swap;
    }
  for (size_t i = 0; i < n; i++)
    project(r, a + i * n);
  for (size_t i = 0; i < n; i++)
    a[i * n + i] += damping;
  if (!bwi_cholesky((int)n, a, 0))
    return false;
  for (size_t i = 0; i < n; i++)
    if (!(a[i * n + i] * a[i * n + i] > 1e-3 * damping))
      return false;
  memset(fixed, 0, n * sizeof *fixed);
  for (int32_t s = 0; s < r->slots; s++)
    for (int i = 0; i < r->bars[s].count; i++) {
      int side = r->barred[3 * s + i];
      double part = side > 0 ? r->bars[s].high[i] : side < 0 ? r->bars[s].low[i] : 0;
      for (int k = 0; k < 3; k++)
        fixed[3 * s + k] += part * r->bars[s].axis[i][k];
    }
  for (size_t i = 0; i < n; i++) {
    x[i] = r->gradient[i];
    for (size_t k = 0; k < n; k++)
      x[i] -= r->hessian[i * n + k] * fixed[k];
  }
  project(r, x);
  bwi_lower_solve((int)n, a, x);
  bwi_upper_solve((int)n, a, x);
  for (size_t i = 0; i < n; i++)
    x[i] += fixed[i];
  return true;
}

/* Bar what the step would take beyond a limit; with `release`, let go of what is barred but pulled
 * back inside. True when something changed. */
static bool choose_bars(const bwi_reach *r, double damping, bool release) {
  size_t n = 3 * (size_t)r->slots;
  bool changed = false;
  for (int32_t s = 0; s < r->slots; s++)
    for (int i = 0; i < r->bars[s].count; i++) {
      const bwi_bars *bars = r->bars + s;
      int8_t *side = r->barred + 3 * s + i;
      double part = bw_dot(r->step + 3 * s, bars->axis[i]);
      if (*side == 0) {
        *side = part > bars->high[i] + 1e-13 ? 1 : part < bars->low[i] - 1e-13 ? -1 : 0;
        changed |= *side != 0;
      } else if (release && bars->low[i] < bars->high[i]) {
        double pull = 0;
        for (size_t k = 0; k < 3; k++) {
          size_t row = 3 * (size_t)s + k;
          double force = r->gradient[row] - damping * r->step[row];
          for (size_t j = 0; j < n; j++)
            force -= r->hessian[row * n + j] * r->step[j];
          pull += force * bars->axis[i][k];
        }
        if (pull * *side < 0) {
          *side = 0;
          changed = true;
        }
      }
    }
  return changed;
}

/* The step within the limits, to first order; false when the matrix is not positive definite. */
bool bwi_reach_step(const bwi_reach *r, double damping) {
  memset(r->barred, 0, 3 * (size_t)r->slots);
  bool positive = solve(r, damping);
  for (int round = 0; positive && round < 12 && choose_bars(r, damping, round < 8); round++)
    positive = solve(r, damping);
  return positive;
}

/* The trial pose: the pose with the step (world directions) taken, within the limits. */

bool bwi_reach_is_minimum(const bwi_reach *r, double damping) {
  return solve(r, damping);
}
