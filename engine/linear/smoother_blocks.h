/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Blocks of rows that the sweeps of smoother.h solve together: the nodes across the thickness of
 * flat elements, along stiff fibres. Node by node, an error that is the same at all nodes of such a
 * column falls slowly (docs/theory/preconditioners.md). */
#ifndef BWI_LINEAR_SMOOTHER_BLOCKS_H
#define BWI_LINEAR_SMOOTHER_BLOCKS_H

#include "linear/smoother.h"

/* near: node_count, of a pattern, in an order of their rows. Where couplings are strong, the nodes
 * of each block become neighbours in it, and block_of (node_count) is the block of each node. Else
 * neither changes, and *any is false. */
bw_status bwi_smoother_find_blocks(bw_context *context, const bw_block_pattern *pattern,
                                   const double *stiffness, int32_t *near, int32_t *block_of,
                                   bool *any);
/* The blocks of the rows as they are ordered, and which entries of the parts are within them. */
bw_status bwi_smoother_set_blocks(bw_context *context, bwi_smoother *smoother,
                                  const int32_t *block_of);
/* Inverses of the blocks at the unknowns. *usable is false where one is not positive definite. */
bw_status bwi_smoother_invert_blocks(bw_context *context, bwi_smoother *smoother,
                                     const double *stiffness, const bw_dof_map *dof_map,
                                     bool *usable);

#endif
