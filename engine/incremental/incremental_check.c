/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The debug switch of systems that follow edits: everything computed again, and compared. */
#include <math.h>
#include <string.h>

#include "incremental/incremental.h"

/* The second is for iterations down to the default tolerance, and grows with a larger one.
 * Solutions of nearly singular equations differ by more; then the residual, which is what
 * iterations promise, is at most so many times the tolerance or what rounding leaves. */
static const double same_stiffness = 1e-12, same_solution = 1e-8, same_residual = 2;

static double difference(const double *a, const double *b, int64_t count) {
  double max = 0, scale = 0;
  for (int64_t i = 0; i < count; i++) {
    max = fmax(max, fabs(a[i] - b[i]));
    scale = fmax(scale, fabs(b[i]));
  }
  return scale > 0 ? max / scale : max;
}

/* |f - K u| over what it may be, at the unknowns. */
static bw_status relative_residual(bw_context *context, const bw_system *system, double tolerance,
                                   int64_t size, const double *force, const double *u,
                                   double *residual) {
  bw_status status = BW_OK;
  double left = 0, load = 0, *field = BW_NEW(context, double, 2 * size);
  if (!field)
    return BW_MEMORY;
  double *f = field + size;
  memcpy(f, force, (size_t)size * sizeof *f);
  BW_TRY(bwi_balance_fields(context, system->dof_map, 1, f));
  BW_TRY(bw_block_multiply(context, system->pattern, system->stiffness, 9, 3, 1, u, field));
  for (int64_t i = 0; i < size; i++)
    field[i] = f[i] - field[i];
  bwi_keep_states(system->dof_map, 1u << BW_DOF_UNKNOWN, field);
  bwi_keep_states(system->dof_map, 1u << BW_DOF_UNKNOWN, f);
  for (int64_t i = 0; i < size; i++) {
    left += field[i] * field[i];
    load += f[i] * f[i];
  }
  *residual = sqrt(left) / fmax(tolerance * sqrt(load),
                                bwi_residual_noise(system->pattern, system->stiffness, u));
done:
  bw_free(field);
  return status;
}

/* The stiffness of the present shape by the way that shares least with the one checked. */
static bw_status reference_stiffness(bw_context *context, const bw_incremental_system *incremental,
                                     double **values) {
  bw_status status = BW_OK;
  const bw_system *system = incremental->system;
  double *made = BW_NEW(context, double, 9 * system->pattern->block_count);
  if (!made)
    return BW_MEMORY;
  BW_TRY(bw_stiffness(context, system->pattern, system->mesh, incremental->inner->model->material,
                      made));
  *values = made;
  made = NULL;
done:
  bw_free(made);
  return status;
}

bw_status bwi_incremental_check(bw_context *context, const bw_incremental_system *incremental,
                                double tolerance, int64_t count, const double *force,
                                const double *displacement, bw_reuse *reuse) {
  bw_status status = BW_OK;
  const bw_system *system = incremental->system;
  const bw_dof_map *dof_map = system->dof_map;
  double allowed = same_solution * fmax(1, tolerance / BWI_INCREMENTAL_TOLERANCE);
  int64_t size = 3 * (int64_t)system->mesh->node_count, blocks = system->pattern->block_count;
  bwi_symbolic *symbolic = NULL;
  bwi_factor *factor = NULL;
  double *values = NULL;
  int32_t bad = 0;
  double *reference = BW_NEW(context, double, count *size);
  if (!reference)
    return BW_MEMORY;
  BW_TRY(reference_stiffness(context, incremental, &values));
  double off = difference(system->stiffness, values, 9 * blocks);
  if (reuse)
    reuse->difference_stiffness = fmax(reuse->difference_stiffness, off);
  if (!(off <= same_stiffness))
    BW_TRY(bw_fail(context, BW_INTERNAL,
                   "the incrementally updated stiffness differs from the reassembled one by %.3g "
                   "of the largest entry (allowed: %g)",
                   off, same_stiffness));
  bwi_matrix matrix = {.pattern = system->pattern, .stiffness = values, .dof_map = dof_map};
  BW_TRY(bwi_symbolic_for(context, system->pattern, dof_map, BW_ORDERING_AUTO, 0, NULL, NULL, NULL,
                          &symbolic));
  status = bwi_factor_create(context, symbolic, &matrix, &factor, &bad);
  if (status == BW_SINGULAR)
    status = bwi_fail_singular(context, system->mesh, bad);
  if (status != BW_OK)
    goto done;
  memcpy(reference, force, (size_t)(count * size) * sizeof *reference);
  BW_TRY(bwi_balance_fields(context, dof_map, count, reference));
  BW_TRY(bwi_solve_fields(context, factor, dof_map, count, reference, reference));
  BW_TRY(bwi_steady_fields(context, dof_map, count, reference));
  for (int64_t k = 0; k < count; k++) {
    off = difference(displacement + k * size, reference + k * size, size);
    if (reuse)
      reuse->difference_solution = fmax(reuse->difference_solution, off);
    double residual = 0;
    if (!(off <= allowed))
      BW_TRY(relative_residual(context, system, tolerance, size, force + k * size,
                               displacement + k * size, &residual));
    if (!(residual <= same_residual))
      BW_TRY(bw_fail(context, BW_INTERNAL,
                     "the solution for right-hand side %lld differs from that of a recomputed "
                     "factor by %.3g of the largest displacement (allowed: %g), and its "
                     "residual is %.3g times what the tolerance and rounding leave",
                     (long long)(k + 1), off, allowed, residual));
  }
done:
  bw_free(reference);
  bw_free(values);
  bw_release(symbolic);
  bw_release(factor);
  return status;
}
