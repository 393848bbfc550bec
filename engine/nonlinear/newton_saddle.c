/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Leaving equilibria that are not stable.
 *
 * A slab pressed straight down stays straight in exact arithmetic: Newton's method states to an
 * equilibrium whose tangent K has negative eigenvalues. Conjugate gradients on K with a right-hand
 * side f of random numbers, preconditioned by M, meet a direction p with p . K p < 0 as soon as
 * their Krylov space holds one. That they do not is an answer too, once they have converged: the
 * residual is a polynomial of M K, 1 at 0 with all its roots positive while every p . K p is, times
 * the first residual. Below 0 it is 1 or more, so a direction y with K y = l M^-1 y, l < 0, keeps
 * at least its part y . f of the residual, y . M^-1 y = 1, for good: r . M r >= (y . f)^2. With
 * f = D^1/2 times normal numbers, D the diagonal of K, y . f is normal with the variance y . D y,
 * and that is not small since M^-1 is at most a few tens of D. So when r . M r has become small
 * there is no such y but with a small, known chance, however close to 0 the least eigenvalue is,
 * and the search costs what one solution of K x = f does.
 *
 * From there the potential falls to either side; the side that falls more is taken, the first where
 * they are alike, so that the way is the same each time. The potential is now below that of the
 * equilibrium, so steps that lower it further do not lead back. */
#include "nonlinear/newton.h"

#include <math.h>
#include <string.h>

enum { DOUBLINGS = 12 };
/* The first step: largest component over the smallest side of a cell. */
#define FIRST 1e-3
/* y . D y is at least this: an element's stiffness is at most 24 times its diagonal. */
#define MIN_VARIANCE (1.0 / 30)
/* |y . f| is this part of its deviation or less once in 12,000 times. */
#define MIN_PART 1e-4
/* Curvatures below this part of p . D p are rounding. */
#define NEUTRAL 1e-12

/* Random forces: the diagonal's square root times normal numbers. */
static bw_status random_forces(bwi_newton_state *state, double *force) {
  bw_random random;
  double *blocks = state->blocks, *own = NULL;
  if (state->contact) {
    own = BW_NEW(state->context, double, 3 * state->size);
    if (!own)
      return BW_MEMORY;
    memcpy(own, blocks, 3 * (size_t)state->size * sizeof *own);
    bwi_contact_blocks(state->contact, own);
    blocks = own;
  }
  bw_random_seed(&random, 1);
  for (int64_t i = 0; i < state->size; i++) {
    double number = bw_random_normal(&random);
    force[i] = state->load_case->constrained[i] ? 0 : sqrt(fabs(blocks[3 * i + i % 3])) * number;
  }
  bw_free(own);
  return BW_OK;
}

/* A direction of negative curvature of `plain` (of the Newton state's tangent where that is
 * iterative) to state->direction. Neither *found nor *none: the iterations allowed did not
 * tell. */
static bw_status find_negative(bwi_newton_state *state, const double *plain, bool *found,
                               bool *none) {
  bw_status status = BW_OK;
  bw_context *context = state->context;
  int64_t n = state->size;
  double *r = BW_NEW(context, double, n), *z = BW_NEW(context, double, n),
         *q = BW_NEW(context, double, n), *p = state->direction;
  double before = 0;
  *found = *none = false;
  BW_TRY_MEMORY(r && z && q);
  BW_TRY(random_forces(state, r));
  for (int k = 0; k < state->plan.max_iterations && bwi_newton_left(state, NULL) > 0; k++) {
    BW_TRY(bw_check_cancel(context));
    if (state->iterative)
      BW_TRY(bwi_precondition_apply(context, state->precondition, r, z));
    else
      BW_TRY(bwi_direct_solve(context, state->newton->direct, r, z));
    double rz = bwi_newton_state_dot(state, r, z), curvature, size = 0;
    if (!isfinite(rz))
      goto done;
    *none = rz >= 0 && rz < MIN_PART * MIN_PART * MIN_VARIANCE;
    if (*none || rz < 0)
      goto done;
    for (int64_t i = 0; i < n; i++)
      p[i] = state->load_case->constrained[i] ? 0 : z[i] + (before > 0 ? rz / before * p[i] : 0);
    before = rz;
    /* q is 0 where constrained: reactions are nothing that coarse solids should see */
    if (state->iterative)
      BW_TRY(bwi_precondition_multiply(context, state->precondition, p, q));
    else
      BW_TRY(bw_block_multiply(context, state->solid->pattern, plain, 9, 3, 1, p, q));
    state->report->stability_iterations++;
    curvature = bwi_newton_state_dot(state, p, q);
    for (int64_t i = 0; i < n; i++)
      size += fabs(state->blocks[3 * i + i % 3]) * p[i] * p[i];
    if (!isfinite(curvature))
      goto done;
    *found = curvature < -NEUTRAL * size;
    *none = !*found && !(curvature > 0); /* neutral, as far as numbers tell */
    if (*found || *none)
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
static bw_status potential_at(bwi_newton_state *state, double t, double *change) {
  bw_status status = BW_OK;
  double work = 0;
  for (int64_t i = 0; i < state->size; i++) {
    state->trial.u[i] = state->now.u[i] + t * state->direction[i];
    if (!state->load_case->constrained[i])
      work += (state->now.load[i] - (state->now.contact ? state->now.contact[i] : 0)) * t *
              state->direction[i];
  }
  BW_TRY(bwi_newton_state_balance(state, &state->trial));
  *change = HUGE_VAL;
  if (!state->trial.shape.defined)
    goto done;
  /* of follower pressures: the mean of the forces at both ends */
  for (int64_t i = 0; state->follows && i < state->size; i++)
    if (!state->load_case->constrained[i])
      work += 0.5 * t * state->direction[i] *
              (state->trial.load[i] - (state->trial.contact ? state->trial.contact[i] : 0) -
               state->now.load[i] + (state->now.contact ? state->now.contact[i] : 0));
  *change = state->trial.energy - state->now.energy + state->trial.contact_energy -
            state->now.contact_energy - work;
done:
  return status;
}

static bw_status go_down(bwi_newton_state *state, bool *lower) {
  bw_status status = BW_OK;
  const double *spacing = state->solid->grid->spacing;
  double longest = 0, best = 0, at = 0;
  for (int64_t i = 0; i < state->size; i++)
    longest = fmax(longest, fabs(state->direction[i]));
  if (!(longest > 0) || !isfinite(longest))
    return BW_OK;
  double first = FIRST * fmin(spacing[0], fmin(spacing[1], spacing[2])) / longest;
  for (int side = 0; side < 2; side++)
    for (int k = 0; k < DOUBLINGS; k++) {
      double t = ldexp(side ? -first : first, k), change;
      BW_TRY(potential_at(state, t, &change));
      if (change < best * (1 + 1e-6)) { /* clearly better, so that rounding does not choose */
        best = change;
        at = t;
      } else if (k > 2)
        break;
    }
  if (best < 0) {
    double change;
    BW_TRY(potential_at(state, at, &change));
    bwi_newton_state_accept(state);
    *lower = true;
  } else
    BW_TRY(bwi_newton_state_balance(state, &state->now));
done:
  return status;
}

bw_status bwi_newton_leave(bwi_newton_state *state, bool *lower, bool *decided) {
  bw_status status = BW_OK;
  bw_newton *newton = state->newton;
  double *plain = newton->stiffness;
  bool definite = false, found = false, none = false;
  *lower = *decided = false;
  if (state->iterative) { /* the tangent is as it is, the node blocks made definite */
    status = find_negative(state, NULL, &found, &none);
    if (status == BW_OK && found)
      status = go_down(state, lower);
    *decided = found || none;
    return status;
  }
  newton->stiffness = NULL;
  newton->block_count = 0;
  BW_TRY(bwi_tangent_set(state, BWI_PROJECTED, &definite));
  if (definite)
    BW_TRY(find_negative(state, plain, &found, &none));
  if (found)
    BW_TRY(go_down(state, lower));
  *decided = found || none;
done:
  bw_free(plain);
  return status;
}
