/* certificate: what multipliers prove about the largest stress, evaluated without the search. */
#ifndef BARWRIGHT_CERTIFICATE_H
#define BARWRIGHT_CERTIFICATE_H

#include "barwright/analysis.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A claim is an element with a direction n and multipliers. It says that
 *     n . sigma n  and  -n . sigma n
 * of the element's mean stress are below a bound for every admissible pressure; without a direction
 * (n = 0) that no principal stress exceeds it. All lists are borrowed. Admissible: 0 <= p <=
 * pressure, `force` in all, no work on the motions. */
typedef struct bw_dual_claims {
  double force, pressure; /* F_tot (N), p_max (Pa) */
  bool force_is_max;      /* the force may also be smaller */
  int32_t motions;        /* how many rigid-body modes */
  const double *work; /* (any, motions x basis->count) of a unit of each pressure on each mode */
  int64_t count;
  const int32_t *element;  /* (index, count) */
  const double *direction; /* (-, count x 3) unit vectors, or 0 */
  /* (any, count x (6 motions + 2)) With a direction: motions and x for the positive, then for the
   * negative sign. Without: motions for each of the six components of stress, and x. The rest of a
   * row does not count. */
  const double *multiplier;
} bw_dual_claims;

/* The bounds that follow (docs/theory/worst_case.md, "The certificate"): bound (Pa, count) for the
 * stresses under the computed displacements, rounding of the sums included, and solve_error (Pa,
 * count), what the residuals of the linear solves may add to it. BW_CONVERGENCE and BW_LIMIT where
 * the least eigenvalue that it needs is not found. Nothing of the branch and bound is used. One
 * solve for each pressure; progress "certificate". */
BW_API bw_status bw_dual_bounds(bw_context *context, bw_system *system,
                                const bw_pressure_basis *basis, const bw_dual_claims *claims,
                                double *bound, double *solve_error);

#ifdef __cplusplus
}
#endif

#endif
