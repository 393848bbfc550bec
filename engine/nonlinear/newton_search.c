/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How far to go along a direction.
 *
 * The potential along u + a d is strain energy, less the work of dead loads (linear in a), less
 * that of follower pressures, plus the energy of contact. A follower's force is quadratic in a, so
 * its work along the line, the integral of f . d, comes out of Simpson's rule without error: along
 * a line there is a potential, whether or not the force has one. */
#include "nonlinear/newton.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define ARMIJO 1e-4
/* Differences of energies below this part of the energies are rounding. */
#define ROUNDING 1e-11
enum { TRIALS = 40 };

/* ---- when points lose their volume ---------------------------------------------------------- */

static double determinant(const double f[9]) {
  return f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) +
         f[2] * (f[3] * f[7] - f[4] * f[6]);
}

/* The least root of c0 + c1 t + c2 t^2 + c3 t^3 in (0, t1], c0 > 0; t1 where there is none. */
static double min_root(const double c[4], double t1) {
  double turn[4] = {0}, place[2];
  int count = 1;
  double a = 3 * c[3], b = 2 * c[2], d = b * b - 4 * a * c[1];
  if (a == 0) {
    if (b != 0)
      turn[count++] = -c[1] / b;
  } else if (d > 0) {
    double q = -0.5 * (b + copysign(sqrt(d), b));
    place[0] = q / a;
    place[1] = q != 0 ? c[1] / q : 0;
    turn[count++] = fmin(place[0], place[1]);
    turn[count++] = fmax(place[0], place[1]);
  }
  turn[count++] = t1;
  double low = 0;
  for (int k = 1; k < count; k++) {
    double high = turn[k];
    if (!(high > low) || high > t1)
      continue;
    if (c[0] + high * (c[1] + high * (c[2] + high * c[3])) <= 0) {
      for (int i = 0; i < 60; i++) {
        double t = 0.5 * (low + high);
        *(c[0] + t * (c[1] + t * (c[2] + t * c[3])) > 0 ? &low : &high) = t;
      }
      return low;
    }
    low = high;
  }
  return t1;
}

typedef struct cap {
  const bw_solid *solid;
  const double *u, *d;
  bool all;
  double *min; /* by chunk */
} cap;

enum { CHUNK = 256 };

static bw_status cap_chunk(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const cap *c = (const cap *)data;
  const bw_grid *grid = c->solid->grid;
  double min = 1;
  for (int64_t e = begin; e < end; e++) {
    const bw_solid_material *m = c->solid->material_table->material[grid->material[e]];
    for (int32_t q = 0; q < m->rule->count; q++) {
      if (!c->all && m->law[q] != BW_NEO_HOOKEAN)
        continue;
      double f[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, g[9] = {0}, h[9], at[3];
      for (int a = 0; a < 8; a++) {
        int64_t node = grid->element[8 * e + a];
        for (int i = 0; i < 3; i++)
          for (int k = 0; k < 3; k++) {
            double slope = m->rule->gradient[24 * (int64_t)q + 3 * a + k] / grid->spacing[k];
            f[3 * i + k] += c->u[3 * node + i] * slope;
            g[3 * i + k] += c->d[3 * node + i] * slope;
          }
      }
      /* the cubic through t = -1, 0, 1 with leading coefficient det g */
      double cubic[4] = {determinant(f), 0, 0, determinant(g)};
      if (!(cubic[0] > 0))
        continue;
      for (int s = 0; s < 2; s++) {
        for (int i = 0; i < 9; i++)
          h[i] = f[i] + (s ? -1 : 1) * g[i];
        at[s] = determinant(h);
      }
      cubic[1] = 0.5 * (at[0] - at[1]) - cubic[3];
      cubic[2] = 0.5 * (at[0] + at[1]) - cubic[0];
      min = fmin(min, min_root(cubic, min));
    }
  }
  c->min[begin / CHUNK] = min;
  return BW_OK;
}

bw_status bwi_newton_cap(bw_context *context, const bw_solid *solid, const double *u,
                         const double *d, bool all, double *part) {
  bw_status status = BW_OK;
  int64_t elements = solid->grid->element_count, chunks = (elements + CHUNK - 1) / CHUNK;
  cap c = {solid, u, d, all, BW_NEW(context, double, chunks)};
  if (!c.min)
    return BW_MEMORY;
  BW_TRY(bw_parallel(context, elements, CHUNK, cap_chunk, &c));
  *part = 1;
  for (int64_t k = 0; k < chunks; k++)
    *part = fmin(*part, c.min[k]);
done:
  bw_free(c.min);
  return status;
}

/* ---- the search ----------------------------------------------------------------------------- */

/* Work per unit step of follower pressures at u + a d. */
static bw_status follower_power(bwi_newton_state *state, double a, double *power) {
  bw_status status = BW_OK;
  double *at = state->trial.u, *load = state->work; /* both are overwritten before they are used */
  for (int64_t i = 0; i < state->size; i++) {
    at[i] = state->now.u[i] + a * state->direction[i];
    load[i] = 0;
  }
  BW_TRY(bwi_load_case_follow(state->context, state->load_case, at,
                              state->initial_residual ? 1 : state->load, load));
  *power = bwi_newton_state_dot(state, load, state->direction);
done:
  return status;
}

/* What a search knows of its line. */
typedef struct line {
  double constant; /* power of loads that do not follow */
  double power;    /* of those that do, at the beginning */
  double change;   /* of the potential, at the last trial */
  double rounding; /* what of that may be rounding */
} line;

/* state->trial at `a` along the line. */
static bw_status try_length(bwi_newton_state *state, double a, line *l) {
  bw_status status = BW_OK;
  const bwi_energy_forces *now = &state->now, *trial = &state->trial;
  double work = l->constant * a, power[2];
  if (state->follows) {
    BW_TRY(follower_power(state, 0.5 * a, &power[0]));
    BW_TRY(follower_power(state, a, &power[1]));
    work += a / 6 * (l->power + 4 * power[0] + power[1]);
  }
  for (int64_t i = 0; i < state->size; i++)
    state->trial.u[i] = now->u[i] + a * state->direction[i];
  BW_TRY(bw_check_cancel(state->context));
  BW_TRY(bwi_newton_state_balance(state, &state->trial));
  l->change = trial->energy - now->energy + trial->contact_energy - now->contact_energy +
              trial->quadratic_energy - now->quadratic_energy - work;
  l->rounding = ROUNDING * (fabs(trial->energy) + fabs(now->energy) + fabs(work) +
                            fabs(trial->contact_energy) + fabs(now->contact_energy) +
                            fabs(trial->quadratic_energy) + fabs(now->quadratic_energy));
  /* a strain e has the energy K e^2 / 2 and, when it is the difference of F and a rotation, an
     error of some DBL_EPSILON: that makes K e DBL_EPSILON of energy */
  l->rounding +=
      16 * DBL_EPSILON * sqrt(state->elastic * (fabs(trial->energy) + fabs(now->energy)));
done:
  return status;
}

/* Whether the trial's slope says that the way was good, where energies no longer can. */
static bool slope_is_less(const bwi_newton_state *state, double slope) {
  double ahead = 0;
  for (int64_t i = 0; i < state->size; i++)
    if (!state->load_case->constrained[i])
      ahead += (state->trial.internal[i] - state->trial.load[i]) * state->direction[i];
  return fabs(ahead) <= 0.9 * fabs(slope);
}

/* Where a step falls by more than the tangent's parabola, which loses half of the slope, the
 * tangent was projected and too stiff, as it is beside unstable equilibria: twice the step, and
 * again, while that pays. */
static bool falls_faster(const line *l, double a, double slope) {
  return l->change < 0.6 * a * slope && -l->change > l->rounding;
}

static bw_status extend(bwi_newton_state *state, double slope, line *l, double *step) {
  bw_status status = BW_OK;
  double best = l->change, a = *step;
  while (state->tangent != BWI_PLAIN && a < 1e6 && falls_faster(l, a, slope)) {
    BW_TRY(try_length(state, 2 * a, l));
    if (!state->trial.shape.defined || !(l->change < best))
      break;
    a *= 2;
    best = l->change;
  }
  if (a == *step && l->change == best)
    goto done; /* the trial is that step */
  *step = a;
  BW_TRY(try_length(state, a, l));
done:
  return status;
}

bw_status bwi_newton_search(bwi_newton_state *state, double slope, double *step) {
  bw_status status = BW_OK;
  const double *d = state->direction;
  double a = 1, longest = 0;
  line l = {0};
  *step = 0;
  for (int64_t i = 0; i < state->size; i++)
    longest = fmax(longest, fabs(d[i]));
  if (!isfinite(longest) || !isfinite(slope))
    return BW_OK;
  for (int64_t i = 0; i < state->size; i++)
    if (!state->load_case->constrained[i])
      l.constant += (state->now.load[i] - (state->now.contact ? state->now.contact[i] : 0)) * d[i];
  if (state->follows) {
    BW_TRY(follower_power(state, 0, &l.power));
    l.constant -= l.power;
  }
  for (int k = 0; k < TRIALS; k++) {
    BW_TRY(try_length(state, a, &l));
    if (!state->trial.shape.defined) {
      double part;
      BW_TRY(bwi_newton_cap(state->context, state->solid, state->now.u, d, false, &part));
      a = fmin(0.5 * a, 0.8 * part);
      continue;
    }
    if (l.change <= ARMIJO * a * slope || (l.change <= l.rounding && slope_is_less(state, slope))) {
      *step = a;
      if (k == 0)
        BW_TRY(extend(state, slope, &l, step));
      bwi_newton_state_accept(state);
      return BW_OK;
    }
    double curvature = l.change - a * slope; /* of the parabola, times a^2 */
    double best = curvature > 0 ? -0.5 * slope * a * a / curvature : 0;
    a = fmin(0.5 * a, fmax(0.1 * a, best));
  }
  /* the contact's forces are those of the last trial */
  if (state->contact)
    BW_TRY(bwi_newton_state_balance(state, &state->now));
done:
  return status;
}
