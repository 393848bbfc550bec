/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Solving a system that follows edits without its factor, by two-level PCG (two_level.h).
 * Iterations then do not depend on how far the shape has come from the one that was factored; they
 * are learnt, as meshes differ. */
#include <math.h>
#include <string.h>

#include "incremental/incremental.h"
#include "linear/element_product.h"

bool bwi_incremental_has_two_level(const bw_incremental_system *incremental) {
  return bwi_coarse_fits(incremental->inner->rest->mesh);
}

static bw_status update_two_level(bw_context *context, const bw_incremental_system *incremental) {
  bw_status status = BW_OK;
  bwi_incremental *inner = incremental->inner;
  const bw_system *system = incremental->system;
  if (!inner->two_level) {
    bool even;
    BW_TRY(bwi_element_product_serves(context, inner->rest->mesh, inner->model->material, &even));
    BW_TRY(bwi_two_level_create(context, inner->rest->mesh, system->pattern,
                                even && !inner->rotate_material, NULL, &inner->two_level));
  }
  if (!inner->two_level_known)
    BW_TRY(bwi_two_level_follow(context, inner->two_level, inner->model, system->dof_map,
                                system->stiffness, &inner->two_level_usable));
  inner->two_level_known = true;
done:
  return status;
}

bw_status bwi_incremental_by_two_level(bw_context *context, bw_incremental_system *incremental,
                                       const bw_incremental_options *options, int limit,
                                       const bwi_initial_guess *left, int64_t count,
                                       double *displacement, int *iterations, bool *converged) {
  bw_status status = BW_OK;
  bwi_incremental *inner = incremental->inner;
  const bw_dof_map *dof_map = incremental->system->dof_map;
  size_t size = (size_t)count * 3 * (size_t)dof_map->mesh->node_count;
  double *solution = NULL;
  bwi_two_level_problem problem = {.tolerance = options->tolerance,
                                   .load = left->load,
                                   .energy = left->energy,
                                   .energy_alone = options->energy,
                                   .limit = limit};
  *converged = false;
  BW_TRY(update_two_level(context, incremental));
  if (!inner->two_level_usable)
    goto done;
  solution = BW_NEW(context, double, size);
  BW_TRY_MEMORY(solution);
  BW_TRY(bwi_two_level_solve(context, inner->two_level, &problem, count,
                             left->force ? left->force : displacement, solution));
  *iterations += problem.iterations;
  *converged = problem.converged;
  if (*converged) {
    memcpy(displacement, solution, size * sizeof *displacement);
    for (size_t i = 0; left->guess && i < size; i++)
      displacement[i] += left->guess[i];
    BW_TRY(bwi_steady_fields(context, dof_map, count, displacement));
  }
done:
  bw_free(solution);
  return status;
}
