/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conjugate gradients on the stiffness of a body, with any preconditioner on its fields, in blocks
 * of right-hand sides: the preconditioner (mostly a factor of a former matrix, or one in single
 * precision) is read once per iteration for all of a block. All fields are 0 off the unknowns. */
#include <assert.h>
#include <math.h>

#include "linear/pcg.h"
#include "linear/pcg_space.h"

enum { WIDTH = 12 };

static bw_status project(bw_context *context, void *data, int64_t count, double *x) {
  const bwi_pcg *problem = data;
  int64_t size = 3 * (int64_t)problem->dof_map->mesh->node_count;
  (void)context;
  for (int64_t k = 0; k < count; k++)
    bwi_keep_states(problem->dof_map, 1u << BW_DOF_UNKNOWN, x + k * size);
  return BW_OK;
}

static bw_status multiply(bw_context *context, void *data, int64_t count, const double *x,
                          double *y) {
  const bwi_pcg *problem = data;
  bw_status status =
      bw_block_multiply(context, problem->pattern, problem->stiffness, 9, 3, count, x, y);
  return status == BW_OK ? project(context, data, count, y) : status;
}

static double noise(void *data, const double *x) {
  const bwi_pcg *problem = data;
  return bwi_residual_noise(problem->pattern, problem->stiffness, x);
}

bw_status bwi_pcg_solve(bw_context *context, bwi_pcg *problem, int64_t count, const double *force,
                        double *displacement) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)problem->dof_map->mesh->node_count;
  bool energy = problem->energy_alone;
  assert(problem->tolerance > 0 && problem->limit >= 0);
  assert(size == 3 * (int64_t)problem->pattern->node_count);
  const bwi_pcg_fields fields = {.size = size,
                                 .multiply = multiply,
                                 .multiply_data = problem,
                                 .precondition = problem->precondition,
                                 .precondition_data = problem->data,
                                 .project = project,
                                 .project_data = problem,
                                 .noise = noise,
                                 .noise_data = problem};
  problem->iterations = 0;
  problem->predicted_iterations = problem->residual = 0;
  problem->converged = true;
  for (int64_t first = 0; first < count && problem->converged; first += WIDTH) {
    bwi_pcg_task task = {.columns = (int)(count - first < WIDTH ? count - first : WIDTH),
                         .energy_tolerance = problem->tolerance,
                         .residual_tolerance = energy ? INFINITY : problem->tolerance,
                         .energy_fall = energy ? BWI_ENERGY_FALLS_MOSTLY : BWI_ENERGY_FALLS,
                         .load = problem->load ? problem->load + first : NULL,
                         .energy = problem->energy ? problem->energy + first : NULL,
                         .limit = problem->limit,
                         .max_remaining = problem->max_remaining,
                         .progress = true};
    BW_TRY(bwi_pcg_fields_run(context, &fields, &task, force + first * size,
                              displacement + first * size));
    problem->converged = task.converged;
    problem->residual = task.residual;
    problem->predicted_iterations = task.predicted_iterations;
    if (task.iterations > problem->iterations)
      problem->iterations = task.iterations;
  }
done:
  return status;
}
