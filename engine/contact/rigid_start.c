/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Where contact first brings bodies that it alone restrains: rigid bodies on springs at the
 * candidates, and springs of stiffness epsilon on their motions, which goes to zero. The energy
 *     epsilon |a|^2 / 2 - load . a + sum stiffness / area min(0, q + E a)^2 / 2
 * is convex and has a piecewise constant second derivative. Springs along tangents pull too. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "contact/internal.h"

enum { NEWTON_STEPS = 100 };

static const double first = 1e-2, last = 1e-12; /* of the stiffness when all candidates touch */
static const double decrease = 0.01;            /* of epsilon from one to the next */
static const double balanced = 1e-6;            /* of the load: what may be left */
static const double descent = 1e-4;             /* of what the slope promises (Armijo) */
static const double shortest = 1e-16;           /* of a Newton step */

/* Energy at a, with gradient and second derivative. `nonzero` (motions) is for its work. */
static double evaluate(const bwi_rigid_start *s, double epsilon, const double *a, int *nonzero,
                       double *gradient, double *second) {
  int m = s->motions;
  double energy = epsilon * bwi_dot(m, a, a) / 2 - bwi_dot(m, a, s->load);
  memset(second, 0, (size_t)m * (size_t)m * sizeof *second);
  for (int k = 0; k < m; k++) {
    gradient[k] = epsilon * a[k] - s->load[k];
    second[(int64_t)k * m + k] = epsilon;
  }
  for (int i = 0; i < s->count; i++) {
    const double *e = s->e + (size_t)i * (size_t)m;
    double gap = s->q[i] + bwi_dot(m, e, a), c = s->stiffness / s->area[i];
    if (gap >= 0 && !(s->pulls && s->pulls[i]))
      continue;
    energy += c * gap * gap / 2;
    int count = 0; /* a candidate moves with one or two of the bodies */
    for (int k = 0; k < m; k++)
      if (e[k] != 0)
        nonzero[count++] = k;
    for (int x = 0; x < count; x++) {
      int k = nonzero[x];
      gradient[k] += c * gap * e[k];
      for (int y = 0; y < count; y++)
        second[(int64_t)k * m + nonzero[y]] += c * e[k] * e[nonzero[y]];
    }
  }
  return energy;
}

bw_status bwi_rigid_start_find(bw_context *context, bwi_rigid_start *s) {
  bw_status status = BW_OK;
  int m = s->motions;
  double whole = 0, before = INFINITY, left = 0, size = sqrt(bwi_dot(m, s->load, s->load));
  double *g = BW_NEW(context, double, m), *h = BW_NEW(context, double, (int64_t)m *m);
  double *step = BW_NEW(context, double, m), *trial = BW_NEW(context, double, m);
  double *d = BW_NEW0(context, double, m); /* what the springs carried at the epsilon before */
  int *nonzero = BW_NEW(context, int, m);
  BW_TRY_MEMORY(g && h && step && trial && d && nonzero);
  memset(s->a, 0, (size_t)m * sizeof *s->a);
  for (int i = 0; i < s->count; i++)
    whole += s->stiffness / s->area[i] *
             bwi_dot(m, s->e + (size_t)i * (size_t)m, s->e + (size_t)i * (size_t)m) / m;
  for (double epsilon = first * whole; epsilon > 0.5 * last * whole; epsilon *= decrease) {
    for (int i = 0; i < NEWTON_STEPS; i++) {
      BW_TRY(bw_check_cancel(context));
      double energy = evaluate(s, epsilon, s->a, nonzero, g, h), t = 1, slope;
      if (!bwi_cholesky(m, h, 0))
        break;
      for (int k = 0; k < m; k++)
        step[k] = -g[k];
      bwi_lower_solve(m, h, step);
      bwi_upper_solve(m, h, step);
      slope = bwi_dot(m, g, step);
      bool gains = false;
      for (; !gains && t > shortest && -t * slope > DBL_EPSILON * fabs(energy); t *= 0.5) {
        for (int k = 0; k < m; k++)
          trial[k] = s->a[k] + t * step[k];
        gains = evaluate(s, epsilon, trial, nonzero, g, h) <= energy + descent * t * slope;
      }
      if (!gains) /* rounding hides what is left to gain */
        break;
      memcpy(s->a, trial, (size_t)m * sizeof *trial);
      if (sqrt(bwi_dot(m, step, step)) <= 1e-12 * sqrt(bwi_dot(m, s->a, s->a)))
        break;
    }
    before = left;
    left = epsilon * sqrt(bwi_dot(m, s->a, s->a));
    for (int k = 0; k < m; k++) { /* the limit of what goes linearly with epsilon */
      double carried = epsilon * s->a[k];
      s->unheld[k] = carried - (d[k] - carried) * decrease / (1 - decrease);
      d[k] = carried;
    }
  }
  s->reach = size / (last * whole);
  s->held = !(left > balanced * size && left > 0.5 * before);
  evaluate(s, 0, s->a, nonzero, g, h);
  s->scale = 0;
  for (int k = 0; k < m; k++)
    s->scale += h[(int64_t)k * m + k] / m;
  if (!(s->scale > 0))
    s->scale = whole;
done:
  bw_free(g);
  bw_free(h);
  bw_free(d);
  bw_free(step);
  bw_free(trial);
  bw_free(nonzero);
  return status;
}
