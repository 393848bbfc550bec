/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Modes by the external solver. Residuals are computed here, from products with the engine's own
 * matrices, whatever the solver says. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "eigen/modes.h"
#include "linear/external.h"

enum { RESIDUALS_AT_ONCE = 4 };

/* |K x - lambda M x| / |lambda M x| at the unknowns. */
static bw_status residuals(bw_context *context, bwi_external *external, int count,
                           const double *value, const double *vector, double *residual) {
  bw_status status = BW_OK;
  const unsigned kept = 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC;
  const bw_dof_map *dof_map = external->problem.dof_map;
  int64_t size = 3 * (int64_t)dof_map->mesh->node_count;
  double *kx = BW_NEW(context, double, RESIDUALS_AT_ONCE *size);
  double *mx = BW_NEW(context, double, RESIDUALS_AT_ONCE *size);
  BW_TRY_MEMORY(kx && mx);
  for (int first = 0; first < count; first += RESIDUALS_AT_ONCE) {
    int batch = count - first < RESIDUALS_AT_ONCE ? count - first : RESIDUALS_AT_ONCE;
    BW_TRY(bwi_external_multiply(context, external, batch, vector + first * size, kx, mx, NULL));
    for (int k = 0; k < batch; k++) {
      double *a = kx + k * size, *b = mx + k * size;
      bwi_keep_states(dof_map, kept, a);
      bwi_keep_states(dof_map, kept, b);
      double difference = 0, whole = 0;
      for (int64_t i = 0; i < size; i++) {
        double m = value[first + k] * b[i], d = a[i] - m;
        difference += d * d;
        whole += m * m;
      }
      residual[first + k] = whole > 0 ? sqrt(difference / whole) : 0;
    }
  }
done:
  bw_free(kx);
  bw_free(mx);
  return status;
}

static bw_status external_mass(bw_context *context, void *data, int64_t count, const double *x,
                               double *y) {
  bw_status status = BW_OK;
  bwi_external *external = (bwi_external *)data;
  const bw_dof_map *dof_map = external->problem.dof_map;
  int64_t size = 3 * (int64_t)dof_map->mesh->node_count;
  double *kx = BW_NEW(context, double, count *size);
  if (!kx)
    return BW_MEMORY;
  status = bwi_external_multiply(context, external, (int)count, x, kx, y, NULL);
  for (int64_t k = 0; status == BW_OK && k < count; k++)
    bwi_keep_states(dof_map, 1u << BW_DOF_UNKNOWN | 1u << BW_DOF_ISOSTATIC, y + k * size);
  bw_free(kx);
  return status;
}

static bw_status modes_of(bw_context *context, bwi_external *external,
                          const bw_modes_options *given, bw_modes **modes) {
  bw_status status = BW_OK;
  bw_modes_options options;
  const bw_dof_map *dof_map = external->problem.dof_map;
  bw_external_modes found = {0};
  bwi_eigen_result result = {0};
  double start = bw_seconds();
  bool changed = false;
  bw_external_report *report = BW_NEW0(context, bw_external_report, 1);
  if (!report)
    return BW_MEMORY;
  BW_TRY(bwi_modes_options_check(context, given, &options));
  if (options.solver && options.solver->options.kind != BW_EIGENSOLVER_AUTO &&
      options.solver->options.kind != BW_EIGENSOLVER_SLEPC) {
    status = bw_fail(context, BW_INVALID,
                     "the eigensolver %s needs the equations in this process, and they are spread "
                     "over several: take slepc",
                     bw_eigensolver_name(options.solver));
    goto done;
  }
  BW_TRY(bwi_external_modes(context, external, &options, &found));
  result = (bwi_eigen_result){.count = found.count,
                              .value = found.value,
                              .vector = found.vector,
                              .solves = found.solves,
                              .recovered = found.recovered,
                              .counted = found.counted,
                              .report = {.solver = "slepc", .backend = "", .preconditioner = ""}};
  snprintf(result.report.reason, sizeof result.report.reason, "%s",
           options.solver ? "it was given" : "the equations are spread over the processes");
  result.residual = BW_NEW(context, double, found.count);
  BW_TRY_MEMORY(result.residual);
  BW_TRY(residuals(context, external, result.count, result.value, result.vector, result.residual));
  BW_TRY(bwi_eigen_canonical(context,
                             &(bwi_eigen_problem){.size = 3 * (int64_t)dof_map->mesh->node_count,
                                                  .mesh = dof_map->mesh,
                                                  .data = external,
                                                  .mass = external_mass},
                             options.tolerance, &result, &changed));
  if (changed)
    BW_TRY(
        residuals(context, external, result.count, result.value, result.vector, result.residual));
  for (int k = 0; k < result.count; k++)
    result.report.residual = fmax(result.report.residual, result.residual[k]);
  bwi_external_update(context, external);
  *report = external->report;
  result.report.bytes = report->bytes;
  result.report.seconds = bw_seconds() - start;
  BW_TRY(bwi_modes_from(context, dof_map->mesh, external->problem.material,
                        dof_map->rigid_mode_count, &result, modes));
  (*modes)->external = report;
  report = NULL;
done:
  bwi_eigen_result_clear(&result);
  bw_free(report);
  return status;
}

bw_status bw_modes_elastic(bw_context *context, bw_system *system, const bw_modes_options *options,
                           bw_modes **modes) {
  return system->external ? modes_of(context, system->external, options, modes)
                          : bwi_modes_elastic(context, system, options, modes);
}

bw_status bw_modes_of_model(bw_context *context, const bw_model *model, bw_system *given,
                            const bw_modes_options *options, bw_system **system, bw_modes **modes) {
  bw_status status = BW_OK;
  static const bw_solver_options spread = {.kind = BW_SOLVER_CHOLESKY, .backend = BW_BACKEND_PETSC};
  const bw_eigensolver *solver = options ? options->solver : NULL;
  bool automatic = !solver || solver->options.kind == BW_EIGENSOLVER_AUTO;
  const bw_solver *inner = automatic ? NULL : solver->options.inner;
  bw_dof_map *dof_map = NULL;
  bwi_external *external = NULL;
  bw_solver *factor = NULL;
  if (!(automatic && given && given->external) &&
      (automatic || solver->options.kind != BW_EIGENSOLVER_SLEPC))
    return bwi_modes_of_model(context, model, given, options, system, modes);
  if (system)
    *system = NULL;
  BW_TRY(bw_dof_map_create(context, model, &dof_map));
  if (given && bwi_external_serves(given, model, dof_map, inner))
    external = bw_retain(given->external);
  else if (automatic) {
    BW_TRY(bwi_modes_of_model(context, model, NULL, options, system, modes));
    goto done;
  } else {
    if (!inner)
      BW_TRY(bw_solver_create(context, &spread, &factor));
    BW_TRY(
        bwi_external_create(context, model->material, dof_map, inner ? inner : factor, &external));
  }
  BW_TRY(modes_of(context, external, options, modes));
done:
  bw_release(external);
  bw_release(factor);
  bw_release(dof_map);
  return status;
}
