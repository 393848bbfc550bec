/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conjugate gradients with the two-level preconditioner (two_level.h), for one right-hand side or
 * several side by side. The error in energy is r . K^-1 r, between r . z and that over the smallest
 * eigenvalue of the preconditioned matrix; the largest is 1. */
#include "linear/two_level.h"

#include <math.h>

/* That smallest eigenvalue: 0.09 on meshes of limbed bodies, more on regular ones. */
#define SMALLEST 0.09

/* Iterations of a probe, and to what they would lead. */
enum { PROBED = 16 };
#define PROBE_TO 1e-8

static bw_status precondition(bw_context *context, void *data, int width, int used) {
  return bwi_two_level_precondition(context, data, width, used);
}

bw_status bwi_two_level_solve(bw_context *context, bwi_two_level *l, bwi_two_level_problem *problem,
                              int64_t count, const double *force, double *displacement) {
  bw_status status = BW_OK;
  bool alone = problem->energy_alone;
  int width = bwi_smoother_width(count);
  BW_TRY(bwi_two_level_remember(context, l, count));
  BW_TRY(bwi_two_level_reserve(context, l, width));
  bwi_packed packed = {.smoother = l->smoother,
                       .dof_map = l->dof_map,
                       .rigid = l->rigid,
                       .constrained = l->constrained,
                       .constrained_count = l->constrained_count,
                       .width = width,
                       .u = l->u,
                       .r = l->r,
                       .p = l->p,
                       .q = l->q,
                       /* one column is done, or starts again without its last direction */
                       .ku = width > 1 ? l->ku : l->q,
                       .floats = l->floats,
                       .z = l->z,
                       .precondition = precondition,
                       .data = l};
  bwi_two_level_watch watch = {l, problem->expected > 0 ? &problem->expected : &packed.left};
  /* Where solutions are to be as exact as a direct one, errors must be small beside any part of
     the solution that is seen, and the energy of a load at a support, say, is that of its
     neighbourhood: ten times less. Whoever looks at the residual takes other norms: half. */
  bwi_pcg_task task = {.energy_tolerance = sqrt(SMALLEST) * problem->tolerance * (alone ? 1 : 0.1),
                       .residual_tolerance = alone ? INFINITY : 0.5 * problem->tolerance,
                       .energy_fall = alone ? BWI_ENERGY_FALLS_MOSTLY : BWI_ENERGY_FALLS,
                       .load = problem->load,
                       .energy = problem->energy,
                       .limit = problem->limit,
                       .adapt = bwi_two_level_adapt,
                       .data = &watch,
                       .progress = true};
  BW_TRY(bwi_packed_solve(context, &packed, &task, count, force, displacement));
  problem->iterations = task.iterations;
  problem->converged = task.converged;
  problem->reached = task.residual;
done:
  return status;
}

bw_status bwi_two_level_probe(bw_context *context, bwi_two_level *l, int64_t count) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)l->smoother->count;
  double *force = NULL;
  bw_random random;
  BW_TRY(bwi_two_level_remember(context, l, count));
  if (l->asked || l->fewer == 0)
    return BW_OK;
  force = BW_NEW(context, double, 2 * size);
  if (!force)
    return BW_MEMORY;
  bw_random_seed(&random, 1);
  for (int64_t i = 0; i < size; i++)
    force[i] = 2 * bw_random_uniform(&random) - 1;
  BW_TRY(bwi_balance_fields(context, l->dof_map, 1, force));
  bwi_two_level_problem problem = {
      .tolerance = PROBE_TO, .energy_alone = true, .limit = PROBED, .expected = count};
  BW_TRY(bwi_two_level_solve(context, l, &problem, 1, force, force + size));
done:
  bwi_two_level_release(l); /* iterations of others have room of their own */
  bw_free(force);
  return status;
}
