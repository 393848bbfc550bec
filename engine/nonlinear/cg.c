/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conjugate gradients for a solid's tangent, which exists element by element only. The cycle is
 * symmetric, and definite unless the tangent is not. Tolerances are loose. */
#include <math.h>

#include "linear/pcg_space.h"
#include "nonlinear/precondition.h"

static bw_status multiply(bw_context *context, void *data, int64_t count, const double *x,
                          double *y) {
  (void)count; /* one */
  return bwi_precondition_multiply(context, data, x, y);
}

static bw_status precondition(bw_context *context, void *data, int64_t count, const double *r,
                              double *z) {
  (void)count;
  return bwi_precondition_apply(context, data, r, z);
}

static bw_status project(bw_context *context, void *data, int64_t count, double *x) {
  int64_t n;
  const uint8_t *constrained = bwi_precondition_constrained(data, &n);
  (void)context;
  (void)count;
  for (int64_t i = 0; i < n; i++)
    if (constrained[i])
      x[i] = 0;
  return BW_OK;
}

bw_status bwi_cg_solve(bw_context *context, bwi_precondition *m, double tolerance,
                       int32_t iterations, const double *force, double *x, bwi_cg_report *report) {
  int64_t n;
  bwi_precondition_constrained(m, &n);
  const bwi_pcg_fields fields = {.size = n,
                                 .multiply = multiply,
                                 .multiply_data = m,
                                 .precondition = precondition,
                                 .precondition_data = m,
                                 .project = project,
                                 .project_data = m,
                                 .symmetric = true};
  bwi_pcg_task task = {.columns = 1,
                       .energy_tolerance = INFINITY,
                       .residual_tolerance = tolerance,
                       .recurrence = true,
                       .limit = iterations};
  bw_status status = bwi_pcg_fields_run(context, &fields, &task, force, x);
  *report = (bwi_cg_report){task.iterations, task.residual, task.indefinite};
  return status;
}
