/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Leaving equilibria that are not stable.
 *
 * A slab pressed straight down stays straight in exact arithmetic: Newton's method walks to an
 * equilibrium whose tangent K has negative eigenvalues. Conjugate gradients on K with a right-hand
 * side of random numbers, preconditioned by the projected tangent, meet a direction p with p . K p
 * < 0 as soon as their Krylov space holds one. The least eigenvalue that this space knows (of the
 * tridiagonal matrix of Lanczos, which the coefficients of conjugate gradients are) only falls;
 * where it has stopped falling above zero the search ends. From there the potential falls to either
 * side; the side that falls more is taken, the first where they are alike, so that the way is the
 * same each time. The potential is now below that of the equilibrium, so steps that lower it
 * further do not lead back. */
#include "nonlinear/newton.h"

#include <math.h>
#include <string.h>

enum { CG = 300, DOUBLINGS = 12 };
/* The first step: largest component over the smallest side of a cell. */
#define FIRST 1e-3
/* The search ends when so many iterations lower the least eigenvalue by no more than a part of it.
 */
#define STRIDE 20
#define SETTLED 0.03

/* What conjugate gradients know of the spectrum: a tridiagonal matrix. */
typedef struct lanczos {
  double diagonal[CG], beside[CG]; /* beside[k]: between k - 1 and k */
  double step, least;              /* of the last iteration; least eigenvalue when last asked */
  int count;
} lanczos;

static void lanczos_add(lanczos *it, double step, double ratio) {
  int k = it->count++;
  it->diagonal[k] = 1 / step + (k > 0 ? ratio / it->step : 0);
  it->beside[k] = k > 0 ? sqrt(ratio) / it->step : 0;
  it->step = step;
}

/* Some eigenvalue lies below x: a pivot of T - x is negative. */
static bool lanczos_below(const lanczos *it, double x) {
  double pivot = 1;
  for (int k = 0; k < it->count; k++) {
    pivot = it->diagonal[k] - x - (k > 0 ? it->beside[k] * it->beside[k] / pivot : 0);
    if (!(pivot > 0))
      return true;
  }
  return false;
}

/* Whether the least eigenvalue has fallen by less than SETTLED since last asked. */
static bool lanczos_settled(lanczos *it) {
  double low = 0, high = it->diagonal[0], before = it->least;
  for (int k = 1; k < it->count; k++)
    high = fmin(high, it->diagonal[k]);
  for (int halving = 0; halving < 50 && high - low > 1e-3 * high; halving++) {
    double middle = 0.5 * (low + high);
    if (lanczos_below(it, middle))
      high = middle;
    else
      low = middle;
  }
  it->least = high;
  return before > 0 && it->least > (1 - SETTLED) * before;
}

/* A direction of negative curvature of `plain` to walk->direction. */
static bw_status find_negative(bwi_walk *walk, const double *plain, bool *found) {
  bw_status status = BW_OK;
  bw_context *context = walk->context;
  int64_t n = walk->size;
  double *r = BW_NEW(context, double, n), *z = BW_NEW(context, double, n),
         *q = BW_NEW(context, double, n), *p = walk->direction;
  bw_random random;
  lanczos known;
  memset(&known, 0, sizeof known);
  *found = false;
  if (!r || !z || !q) {
    status = BW_MEMORY;
    goto done;
  }
  bw_random_seed(&random, 1);
  for (int64_t i = 0; i < n; i++)
    r[i] = walk->the->held[i] ? 0 : bw_random_uniform(&random) - 0.5;
  double rz = 0, first = 0;
  for (int k = 0; k < CG; k++) {
    BW_TRY(bw_check_cancel(context));
    if (walk->iterative)
      BW_TRY(bwi_precondition_apply(context, walk->precondition, r, z));
    else
      BW_TRY(bwi_direct_solve(context, walk->newton->direct, r, z));
    double next = bwi_walk_dot(walk, r, z);
    first = k == 0 ? next : first;
    if (next <= 0 && walk->iterative)
      next = 0; /* the cycle itself is not definite: z may be such a direction */
    else if (!(next > 1e-16 * first))
      goto done;
    double ratio = k > 0 && rz > 0 ? next / rz : 0;
    for (int64_t i = 0; i < n; i++)
      p[i] = walk->the->held[i] ? 0 : z[i] + ratio * p[i];
    rz = next;
    if (walk->iterative)
      BW_TRY(bwi_tangent_multiply(walk, p, q));
    else
      BW_TRY(bw_graph_multiply(context, walk->solid->graph, plain, 9, 3, 1, p, q));
    double curvature = bwi_walk_dot(walk, p, q), size = 0;
    for (int64_t i = 0; i < n; i++)
      size += walk->blocks[3 * i + i % 3] * p[i] * p[i];
    if (curvature < -1e-12 * size) {
      *found = true;
      goto done;
    }
    if (!(curvature > 0) || !(rz > 0))
      goto done;
    lanczos_add(&known, rz / curvature, ratio);
    if (known.count % STRIDE == 0 && lanczos_settled(&known))
      goto done;
    for (int64_t i = 0; i < n; i++)
      r[i] -= rz / curvature * q[i];
  }
done:
  bw_free(r);
  bw_free(z);
  bw_free(q);
  return status;
}

/* The potential at now.u + t direction less that at now.u; HUGE_VAL where it is not defined. */
static bw_status potential_at(bwi_walk *walk, double t, double *change) {
  bw_status status = BW_OK;
  double work = 0;
  for (int64_t i = 0; i < walk->size; i++) {
    walk->trial.u[i] = walk->now.u[i] + t * walk->direction[i];
    if (!walk->the->held[i])
      work += (walk->now.load[i] - (walk->now.contact ? walk->now.contact[i] : 0)) * t *
              walk->direction[i];
  }
  BW_TRY(bwi_walk_balance(walk, &walk->trial));
  *change = HUGE_VAL;
  if (!walk->trial.shape.defined)
    goto done;
  /* of follower pressures: the mean of the forces at both ends */
  for (int64_t i = 0; walk->follows && i < walk->size; i++)
    if (!walk->the->held[i])
      work += 0.5 * t * walk->direction[i] *
              (walk->trial.load[i] - (walk->trial.contact ? walk->trial.contact[i] : 0) -
               walk->now.load[i] + (walk->now.contact ? walk->now.contact[i] : 0));
  *change = walk->trial.energy - walk->now.energy + walk->trial.contact_energy -
            walk->now.contact_energy - work;
done:
  return status;
}

static bw_status go_down(bwi_walk *walk, bool *lower) {
  bw_status status = BW_OK;
  const double *spacing = walk->solid->grid->spacing;
  double longest = 0, best = 0, at = 0;
  for (int64_t i = 0; i < walk->size; i++)
    longest = fmax(longest, fabs(walk->direction[i]));
  if (!(longest > 0) || !isfinite(longest))
    return BW_OK;
  double first = FIRST * fmin(spacing[0], fmin(spacing[1], spacing[2])) / longest;
  for (int side = 0; side < 2; side++)
    for (int k = 0; k < DOUBLINGS; k++) {
      double t = ldexp(side ? -first : first, k), change;
      BW_TRY(potential_at(walk, t, &change));
      if (change < best * (1 + 1e-6)) { /* clearly better, so that rounding does not choose */
        best = change;
        at = t;
      } else if (k > 2)
        break;
    }
  if (best < 0) {
    double change;
    BW_TRY(potential_at(walk, at, &change));
    bwi_walk_accept(walk);
    *lower = true;
  } else
    BW_TRY(bwi_walk_balance(walk, &walk->now));
done:
  return status;
}

bw_status bwi_newton_leave(bwi_walk *walk, bool *lower) {
  bw_status status = BW_OK;
  bw_newton *newton = walk->newton;
  double *plain = newton->stiffness;
  bool definite = false, found = false;
  *lower = false;
  if (walk->iterative) { /* the tangent is as it is, the node blocks made definite */
    status = find_negative(walk, NULL, &found);
    return status == BW_OK && found ? go_down(walk, lower) : status;
  }
  newton->stiffness = NULL;
  newton->pairs = 0;
  BW_TRY(bwi_tangent_set(walk, BWI_PROJECTED, &definite));
  if (definite)
    BW_TRY(find_negative(walk, plain, &found));
  if (found)
    BW_TRY(go_down(walk, lower));
done:
  bw_free(plain);
  return status;
}
