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
  const uint8_t *held = bwi_precondition_held(m, &n);
  double *r = BW_NEW(context, double, n), *z = BW_NEW(context, double, n),
         *p = BW_NEW(context, double, n), *q = BW_NEW(context, double, n);
  *report = (bwi_cg_report){0};
  if (!r || !z || !p || !q) {
    status = BW_MEMORY;
    goto done;
  }
  for (int64_t i = 0; i < n; i++)
    r[i] = held[i] ? 0 : force[i];
  memset(x, 0, (size_t)n * sizeof *x);
  double first = sqrt(bwi_dot(n, r, r)), before = 0;
  report->residual = first > 0 ? 1 : 0;
  while (report->residual > tolerance && report->iterations < iterations) {
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bwi_precondition_apply(context, m, r, z));
    double rz = bwi_dot(n, r, z);
    if (!(rz > 0) || !isfinite(rz)) { /* the cycle is definite unless the tangent is not */
      report->negative = true;
      break;
    }
    for (int64_t i = 0; i < n; i++)
      p[i] = z[i] + (report->iterations > 0 ? rz / before * p[i] : 0);
    before = rz;
    BW_TRY(bwi_precondition_multiply(context, m, p, q));
    double curvature = bwi_dot(n, p, q);
    if (!(curvature > 0) || !isfinite(curvature)) {
      report->negative = true;
      break;
    }
    double a = rz / curvature;
    for (int64_t i = 0; i < n; i++) {
      x[i] += a * p[i];
      r[i] -= a * q[i];
    }
    report->residual = sqrt(bwi_dot(n, r, r)) / first;
    report->iterations++;
  }
done:
  bw_free(r);
  bw_free(z);
  bw_free(p);
  bw_free(q);
  return status;
}
