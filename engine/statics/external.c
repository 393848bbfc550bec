/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Static solutions by an external solver. Residuals are computed here, from products with the
 * engine's own matrices, whatever the solver says. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "barwright/io.h"
#include "base/dense.h"
#include "linear/external.h"
#include "model/internal.h"
#include "statics/internal.h"

/* (-) relative residual that a solver is to reach. */
static double tolerance_of(const bw_solver *solver) {
  return solver->options.tolerance > 0 ? solver->options.tolerance : BW_EXTERNAL_TOLERANCE;
}

static bw_status solve(bw_context *context, void *data, const double *force, double *displacement) {
  return bwi_external_solve(context, data, 1, force, displacement);
}

/* As bwi_residual_noise. */
static bw_status multiply_one(bw_context *context, void *data, const double *x, double *product,
                              double *noise) {
  double magnitude = 0;
  bw_status status = bwi_external_multiply(context, data, 1, x, product, NULL, &magnitude);
  if (noise)
    *noise = BWI_RESIDUAL_NOISE * DBL_EPSILON * magnitude;
  return status;
}

/* The residual is above what was asked for. It stands where rounding alone leaves as much: of K u,
 * or of a load that inertia balances to nothing (a body that falls). */
static bw_status check(bw_context *context, bwi_external *external, const bw_static *result) {
  bw_status status = BW_OK;
  double noise = 0;
  const bw_dof_map *dof_map = external->problem.dof_map;
  const bw_solver *solver = external->solver;
  int64_t size = 3 * (int64_t)dof_map->mesh->node_count;
  double *residual = BW_NEW(context, double, size);
  double *product = BW_NEW(context, double, size);
  BW_TRY_MEMORY(residual && product);
  memcpy(residual, result->force, (size_t)size * sizeof *residual);
  if (dof_map->rigid_mode_count > 0)
    bw_rigid_modes_balance(dof_map, residual);
  BW_TRY(multiply_one(context, external, result->displacement, product, &noise));
  for (int64_t i = 0; i < size; i++)
    residual[i] -= product[i];
  bwi_keep_states(dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC, residual);
  double remaining = sqrt(bwi_dot(size, residual, residual));
  bool product_rounding = result->residual < 1e-6 && remaining < 10 * noise;
  bool nothing_to_solve = remaining < 1e-13 * sqrt(bwi_dot(size, result->force, result->force));
  if (!product_rounding && !nothing_to_solve) {
    status =
        bw_fail(context, BW_CONVERGENCE,
                "the residual of the solution is %.2e of the load; %.2e was requested. %s",
                result->residual, tolerance_of(solver),
                solver->options.kind == BW_SOLVER_PCG
                    ? "Give a larger tolerance, or the solver cholesky"
                    : "The factor lost these digits: the body is nearly a mechanism, or its "
                      "elements are very flat. Give pcg with amg of the backend petsc, or mesh "
                      "again");
    bw_detail_number(context, "residual", result->residual);
  }
done:
  bw_free(residual);
  bw_free(product);
  return status;
}

/* Before anything is solved. */
static bw_status check_output(bw_context *context, const bw_model *model, const char *path) {
  char *piece = NULL;
  if (path && bwi_model_expands(model))
    return bw_fail(context, BW_UNSUPPORTED,
                   "the processes do not know the temperatures of the body, and so not its "
                   "stresses: write the static solution in place of the option write");
  bw_status status = path ? bw_pvtu_piece_path(context, path, 0, &piece) : BW_OK;
  bw_free(piece);
  return status;
}

static bw_status write_output(bw_context *context, bwi_external *external, const char *path,
                              const bw_static *result) {
  const bw_external_output output = {
      .path = path,
      .count = 3,
      .name = (const char *[]){"displacement", "force", "reaction"},
      .field = (const double *[]){result->displacement, result->force, result->reaction},
      .displacement = 0};
  return bwi_external_write(context, external, &output);
}

bw_status bwi_statics_external(bw_context *context, const bw_model *model,
                               const bw_statics_options *statics, bw_static **out) {
  bw_status status = BW_OK;
  const double tolerance = tolerance_of(statics->solver);
  bw_dof_map *dof_map = NULL;
  bwi_external *external = NULL;
  bw_static *result = NULL;
  double start = bw_seconds();
  BW_TRY(check_output(context, model, statics->output));
  BW_TRY(bw_dof_map_create(context, model, &dof_map));
  BW_TRY(bwi_external_create(context, model->material, dof_map, statics->solver, &external));
  BW_TRY(bwi_static_begin(context, model, statics, dof_map, &result));
  result->external = BW_NEW0(context, bw_external_report, 1);
  BW_TRY_MEMORY(result->external);
  bwi_static_solver solver = {
      .solve = solve, .multiply = multiply_one, .data = external, .refine_to = tolerance};
  BW_TRY(bwi_static_solve(context, dof_map, NULL, &solver, result));
  if (result->residual > tolerance)
    BW_TRY(check(context, external, result));
  if (statics->output)
    BW_TRY(write_output(context, external, statics->output, result));
  bwi_external_update(context, external);
  *result->external = external->report;
  bwi_external_fill_report(external, &result->report);
  result->report.residual = result->residual;
done:
  bw_release(external);
  bw_release(dof_map);
  if (status == BW_OK) {
    result->report.seconds = bw_seconds() - start;
    *out = result;
  } else
    bw_release(result);
  return status;
}
