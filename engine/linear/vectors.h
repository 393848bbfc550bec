/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Vectors of iterations: several operations in one pass, sums by blocks that do not depend on the
 * number of threads. */
#ifndef BWI_LINEAR_VECTORS_H
#define BWI_LINEAR_VECTORS_H

#include "barwright/base.h"

bw_status bwi_blocked_dot(bw_context *context, size_t n, const double *a, const double *b,
                          double *sum);
/* r = b - r; *square = r . r (may be NULL) */
bw_status bwi_subtract_from(bw_context *context, size_t n, const double *b, double *r,
                            double *square);
/* p = z + beta p; p is not read when beta is 0 */
bw_status bwi_add_scaled(bw_context *context, size_t n, double beta, const double *z, double *p);
/* x += alpha p, r -= alpha q; *square = r . r */
bw_status bwi_step(bw_context *context, size_t n, double alpha, const double *p, const double *q,
                   double *x, double *r, double *square);
/* p = r + beta (p - omega v) */
bw_status bwi_direction(bw_context *context, size_t n, double beta, double omega, const double *r,
                        const double *v, double *p);

#endif
