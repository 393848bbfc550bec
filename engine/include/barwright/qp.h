/* qp: small convex quadratic programs. */
#ifndef BARWRIGHT_QP_H
#define BARWRIGHT_QP_H

#include "barwright/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A convex quadratic program in n unknowns x (any, n) with m rows: the least 1/2 x H x + g x with
 * A x <= b and min <= x <= max, by NLopt's SLSQP. H (any, n x n) is positive definite, g (any, n),
 * A (any, m x n), b (any, m); bounds min (any, n) and max (any, n) may be infinite. Where no x
 * fulfils A x <= b within the bounds, *violation (any) > 0 is the least v for which A x <= b + v
 * has a solution (so give the rows a common scale). Then x is the point of least objective with it.
 * Else it is 0. multiplier (any, m), which may be NULL, of the rows, so that H x + g + A^T
 * multiplier is 0 but for the bounds. BW_CONVERGENCE where NLopt fails. */
BW_API bw_status bw_quadratic_program(bw_context *context, int n, const double *H, const double *g,
                                      int m, const double *A, const double *b, const double *min,
                                      const double *max, double *x, double *violation,
                                      double *multiplier);

#ifdef __cplusplus
}
#endif
#endif
