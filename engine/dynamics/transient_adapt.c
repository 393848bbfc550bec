/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The error of a step of generalised-alpha and the length of the next one
 * (docs/theory/transient.md). */
#include "dynamics/transient_adapt.h"

#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "linear/blas.h"

enum {
  SHORTEST = -10, /* powers of 2 of the base step */
  LONGEST = 6,
  WAIT = 8, /* steps of one length before a longer one: a factor may be needed for it */
  DROP = 4, /* powers of 2 at once: an error of what was not seen says little of its length */
};

/* Of the tolerance: a longer step aims below it, as its error is of third order alone in the limit.
 */
static const double reserve = 2.0 / 3;

void bwi_adaptive_begin(bwi_adaptive *a, double tolerance, double base) {
  *a = (bwi_adaptive){.tolerance = tolerance, .base = base};
}

void bwi_adaptive_clear(bwi_adaptive *a) {
  bw_free(a->rigid);
}

bw_status bwi_adaptive_leave_out_rigid(bw_context *context, const bw_mesh *mesh,
                                       const bwi_equations *e, bwi_adaptive *a) {
  bw_status status = BW_OK;
  int64_t size = e->size;
  double middle[3] = {0}, *work = BW_NEW(context, double, size);
  a->rigid = BW_NEW0(context, double, 6 * size);
  BW_TRY_MEMORY(work && a->rigid);
  a->relative = true;
  for (int64_t i = 0; i < size; i++)
    middle[i % 3] += mesh->node[i] / mesh->node_count;
  for (int k = 0; k < 6; k++) {
    double *r = a->rigid + k * size;
    for (int64_t i = 0; i < size; i += 3) {
      int b = (k + 1) % 3, c = (k + 2) % 3;
      if (k < 3)
        r[i + k] = 1;
      else {
        r[i + b] = -(mesh->node[i + c] - middle[c]);
        r[i + c] = mesh->node[i + b] - middle[b];
      }
    }
    for (int j = 0; j <= k; j++) {
      BW_TRY(bwi_equations_mass(context, e, r, work));
      if (j < k) {
        const double *q = a->rigid + j * size, part = bwi_dot(size, q, work);
        for (int64_t i = 0; i < size; i++)
          r[i] -= part * q[i];
      }
    }
    double square = bwi_dot(size, r, work);
    if (k == 0)
      a->mass = square;
    for (int64_t i = 0; i < size; i++)
      r[i] /= sqrt(square);
  }
done:
  bw_free(work);
  return status;
}

/* The norm of a field in M, without its motion as a rigid body where that does not count. */
static bw_status size_of(bw_context *context, const bwi_adaptive *a, const bwi_equations *e,
                         const double *x, double *work, double *norm) {
  bw_status status = bwi_equations_mass(context, e, x, work);
  double square = status == BW_OK ? bwi_dot(e->size, x, work) : 0, whole = square;
  for (int k = 0; k < 6 && a->relative; k++) {
    double part = bwi_dot(e->size, a->rigid + k * e->size, work);
    square -= part * part;
  }
  *norm = sqrt(fmax(square, 1e-14 * whole)); /* less is rounding */
  return status;
}

bw_status bwi_adaptive_estimate(bw_context *context, const bwi_adaptive *a, bwi_computed_step *step,
                                double *error, double norm[3]) {
  bw_status status = BW_OK;
  const bwi_equations *equations = step->shifted->equations;
  int64_t size = equations->size;
  double moved, speed, change, square = step->h * step->h, *e = step->change;
  BW_TRY(bwi_equations_mass(context, equations, e, step->work));
  for (int64_t i = 0; i < size; i++)
    e[i] = step->shift * square * (step->constant * step->work[i] + step->missed[i]);
  BW_TRY(bwi_shifted_solve(context, step->shifted, step->factor, e, e));
  BW_TRY(bwi_equations_mass(context, equations, e, step->work));
  norm[0] =
      sqrt(fmax(bwi_dot(size, e, step->work), 0)) + fabs(step->support_missed) * sqrt(a->mass);
  BW_TRY(size_of(context, a, equations, step->u, step->work, &moved));
  BW_TRY(size_of(context, a, equations, step->v, step->work, &speed));
  BW_TRY(size_of(context, a, equations, step->a, step->work, &change));
  norm[1] = moved;
  norm[2] = speed;
  /* at the start of a motion: as far as it goes in a base step */
  double scale = fmax(fmax(a->largest, moved), fmax(a->base * speed, a->base * a->base * change));
  *error = norm[0] > 0 ? norm[0] / scale : 0;
done:
  return status;
}

bool bwi_adaptive_accepts(bwi_adaptive *a, double error) {
  if (error <= a->tolerance || a->level == SHORTEST)
    return true;
  double down = ceil(log2(error / a->tolerance) / 3); /* the error is of third order */
  a->level -= (int)fmin(fmin(fmax(down, 1), DROP), a->level - SHORTEST);
  a->waited = 0;
  a->worst = 0;
  return false;
}

/* The largest error, which halves in 1.4 radians of the motion: in a swing that of the displacement
 * vanishes twice in a period, while that of the velocity is largest. */
static double remembered(const bwi_adaptive *a) {
  double rate = a->largest > 0 ? a->fastest / a->largest : 0;
  return a->worst * exp(-0.5 * rate * bwi_adaptive_step(a));
}

void bwi_adaptive_accept(bwi_adaptive *a, double error, const double norm[3]) {
  a->ticks += (int64_t)1 << (a->level - SHORTEST);
  a->sum += norm[0];
  a->largest = fmax(a->largest, norm[1]);
  a->fastest = fmax(a->fastest, norm[2]);
  a->worst = fmax(remembered(a), error);
  a->waited++;
  if (a->waited < WAIT)
    return;
  double longer = a->worst > 0 ? floor(log2(reserve * a->tolerance / a->worst) / 3) : LONGEST;
  int before = a->level;
  while (a->level < LONGEST && a->level - before < longer &&
         a->ticks % ((int64_t)2 << (a->level - SHORTEST)) == 0)
    a->level++;
  if (a->level == before && longer >= 1 && before < LONGEST)
    return; /* a longer step can begin after the next one */
  a->worst = ldexp(a->worst, 3 * (a->level - before));
  a->waited = 0;
}

double bwi_adaptive_step(const bwi_adaptive *a) {
  return ldexp(a->base, a->level);
}

double bwi_adaptive_time(const bwi_adaptive *a) {
  return ldexp(a->base, SHORTEST) * (double)a->ticks;
}

double bwi_adaptive_total(const bwi_adaptive *a) {
  return a->sum > 0 ? 0.5 * M_PI * a->sum / a->largest : 0;
}
