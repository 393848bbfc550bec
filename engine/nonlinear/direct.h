/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Direct solutions with matrices on a solid's pattern: order and analysis are kept while the
 * pattern and what is constrained are the same, the factor's memory too.
 *
 *   bwi_direct_factor(context, direct, pattern, constrained, stiffness, &definite);
 *   bwi_direct_solve(context, direct, force, displacement);  constrained components become 0 */
#ifndef BWI_NONLINEAR_DIRECT_H
#define BWI_NONLINEAR_DIRECT_H

#include "barwright/nonlinear.h"

typedef struct bwi_direct bwi_direct;
bw_status bwi_direct_create(bw_context *context, bwi_direct **direct);
void bwi_direct_destroy(bwi_direct *direct);
size_t bwi_direct_bytes(const bwi_direct *direct); /* memory used */

/* Order and analysis for a pattern and its constrained components (node_count x 3), where they are
 * not those that are kept. At least one component must be free. */
bw_status bwi_direct_analyse(bw_context *context, bwi_direct *direct,
                             const bw_block_pattern *pattern, const uint8_t *constrained);
/* Whether the analysis that is kept is of this pattern and these constrained components. */
bool bwi_direct_keeps(const bwi_direct *direct, const bw_block_pattern *pattern,
                      const uint8_t *constrained);
/* Operations and entries of a factor, of what was analysed. */
bool bwi_direct_count(const bwi_direct *direct, double *flops, double *entries);
/* `stiffness`: 9 per block. *definite is false, and there is nothing to solve with, when the matrix
 * is not positive definite; *node (may be NULL) then is where that showed. */
bw_status bwi_direct_factor(bw_context *context, bwi_direct *direct,
                            const bw_block_pattern *pattern, const uint8_t *constrained,
                            const double *stiffness, bool *definite, int32_t *node);
/* node_count x 3 each, which may be the same. */
bw_status bwi_direct_solve(bw_context *context, const bwi_direct *direct, const double *force,
                           double *displacement);

#endif
