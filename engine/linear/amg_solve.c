/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conjugate gradients with multigrid (amg.h) on packed fields (pcg_packed.h), for one right-hand
 * side or several side by side. Residuals in floats are level 0's b, and what a cycle makes of them
 * its x, so that nothing is copied between the two. */
#include <math.h>
#include <stdio.h>

#include "barwright/job.h"
#include "linear/amg.h"
#include "linear/pcg_packed.h"

/* The smallest eigenvalue of the preconditioned matrix; the largest is 1. Ritz values of conjugate
 * gradients: 0.049 to 0.066 on quadratic elements of limbed bodies, 0.10 on those of a block, 0.17
 * to 0.34 on linear elements of blocks, plates and bars. */
#define SMALLEST 0.045

static bw_status precondition(bw_context *context, void *data, int width, int used) {
  (void)used;
  return bwi_amg_cycle(context, data, width);
}

/* Room for the vectors of doubles, one after the other; one column needs none for K u (packed.ku).
 */
static bw_status open_vectors(bw_context *context, const bwi_amg *g, bwi_packed *packed,
                              double **work) {
  int64_t numbers = 3 * (int64_t)g->smoother->count * packed->width + BWI_SMOOTHER_SPARE;
  int vectors = packed->width > 1 ? 5 : 4;
  double bytes = (double)(vectors * numbers) * sizeof(double), available = bw_available_memory();
  if (bytes > available) {
    bw_fail(context, BW_MEMORY,
            "conjugate gradients for %d right-hand sides take %.3g GB of memory, more than the "
            "%.3g GB available",
            packed->width, bytes / 1e9, available / 1e9);
    bw_detail_number(context, "bytes", bytes);
    return BW_MEMORY;
  }
  *work = BW_NEW(context, double, vectors *numbers);
  if (!*work)
    return BW_MEMORY;
  packed->u = *work;
  packed->r = *work + numbers;
  packed->p = *work + 2 * numbers;
  packed->q = *work + 3 * numbers;
  /* one column is done, or starts again without its last direction */
  packed->ku = packed->width > 1 ? *work + 4 * numbers : packed->q;
  return BW_OK;
}

bw_status bwi_amg_solve(bw_context *context, bwi_amg *g, bwi_amg_problem *problem, int64_t count,
                        const double *force, double *displacement) {
  bw_status status = BW_OK;
  bool alone = problem->energy_alone;
  double *work = NULL;
  bwi_packed packed = {.smoother = g->smoother,
                       .dof_map = g->dof_map,
                       .rigid = g->rigid,
                       .constrained = g->constrained,
                       .constrained_count = g->constrained_count,
                       .width = bwi_smoother_width(count),
                       .precondition = precondition,
                       .data = g};
  bwi_pcg_task task = {.energy_tolerance = (alone ? sqrt(SMALLEST) : 1) * problem->tolerance,
                       .residual_tolerance = alone ? INFINITY : problem->tolerance,
                       .energy_fall = alone ? BWI_ENERGY_FALLS_MOSTLY : BWI_ENERGY_FALLS,
                       .limit = problem->limit,
                       .progress = true};
  BW_TRY(open_vectors(context, g, &packed, &work));
  BW_TRY(bwi_amg_reserve(context, g, packed.width));
  packed.floats = g->level[0].b;
  packed.z = g->level[0].x;
  BW_TRY(bwi_packed_solve(context, &packed, &task, count, force, displacement));
  problem->iterations = task.iterations;
  problem->converged = task.converged;
  problem->residual = task.residual;
done:
  bw_free(work);
  return status;
}
