/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conjugate gradients for a solid's tangent, which exists element by element only. */
#include <math.h>
#include <string.h>

#include "base/dense.h"
#include "nonlinear/precondition.h"

bw_status bwi_cg_solve(bw_context *context, bwi_precondition *m, double tolerance,
                       int32_t iterations, const double *force, double *x, bwi_cg_report *report) {
  bw_status status = BW_OK;
  int64_t n;
  const uint8_t *constrained = bwi_precondition_constrained(m, &n);
  double *r = BW_NEW(context, double, n), *z = BW_NEW(context, double, n),
         *p = BW_NEW(context, double, n), *q = BW_NEW(context, double, n);
  *report = (bwi_cg_report){0};
  if (!r || !z || !p || !q) {
    status = BW_MEMORY;
    goto done;
  }
  for (int64_t i = 0; i < n; i++)
    r[i] = constrained[i] ? 0 : force[i];
  memset(x, 0, (size_t)n * sizeof *x);
  double initial = sqrt(bwi_dot(n, r, r)), r_dot_z_old = 0;
  report->residual = initial > 0 ? 1 : 0;
  while (report->residual > tolerance && report->iterations < iterations) {
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bwi_precondition_apply(context, m, r, z));
    double r_dot_z = bwi_dot(n, r, z);
    /* the cycle is definite unless the tangent is not */
    if (!(r_dot_z > 0) || !isfinite(r_dot_z)) {
      report->negative = true;
      break;
    }
    bool first = report->iterations == 0;
    double beta = first ? 0 : r_dot_z / r_dot_z_old;
    for (int64_t i = 0; i < n; i++)
      p[i] = z[i] + (first ? 0 : beta * p[i]);
    r_dot_z_old = r_dot_z;
    BW_TRY(bwi_precondition_multiply(context, m, p, q));
    double p_dot_Ap = bwi_dot(n, p, q);
    if (!(p_dot_Ap > 0) || !isfinite(p_dot_Ap)) {
      report->negative = true;
      break;
    }
    double alpha = r_dot_z / p_dot_Ap;
    for (int64_t i = 0; i < n; i++) {
      x[i] += alpha * p[i];
      r[i] -= alpha * q[i];
    }
    report->residual = sqrt(bwi_dot(n, r, r)) / initial;
    report->iterations++;
  }
done:
  bw_free(r);
  bw_free(z);
  bw_free(p);
  bw_free(q);
  return status;
}
