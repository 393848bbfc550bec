/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Blocks of rows that the sweeps of smoother.h solve together: the nodes across the thickness of
 * flat elements, along stiff fibres, of elements that are nearly flat. Node by node, an error that
 * is the same at all nodes of a block falls slowly (docs/theory/preconditioners.md). */
#ifndef BWI_LINEAR_SMOOTHER_BLOCKS_H
#define BWI_LINEAR_SMOOTHER_BLOCKS_H

#include "linear/smoother.h"

/* Calls what follows for every neighbour j of node i. */
#define BWI_FOR_NEIGHBOURS(pattern, i, body)                                                       \
  do {                                                                                             \
    for (int64_t p_ = (pattern)->start[i]; p_ < (pattern)->start[(i) + 1] - 1; p_++) {             \
      int32_t j = (pattern)->column[p_];                                                           \
      body                                                                                         \
    }                                                                                              \
    for (int64_t u_ = (pattern)->upper_start[i]; u_ < (pattern)->upper_start[(i) + 1]; u_++) {     \
      int32_t j = (pattern)->upper_row[u_];                                                        \
      body                                                                                         \
    }                                                                                              \
  } while (0)

typedef struct bwi_node_blocks {
  int32_t count;
  int32_t *of;     /* by node */
  int32_t *start;  /* count + 1: members */
  int32_t *member; /* nodes, those of a line from one end to the other */
  bool lines;      /* strong couplings have a direction */
  double largest;  /* diagonal entry of the stiffness; 0 without one */
} bwi_node_blocks;

/* `stiffness` NULL: each node is a block. *blocks is zero. Release with bwi_node_blocks_clear. */
bw_status bwi_node_blocks_find(bw_context *context, const bw_block_pattern *pattern,
                               const bwi_stiffness *stiffness, bwi_node_blocks *blocks);
void bwi_node_blocks_clear(bwi_node_blocks *blocks);
/* The blocks of the rows as they are ordered, and which entries of the parts are within them. */
bw_status bwi_smoother_set_blocks(bw_context *context, bwi_smoother *smoother,
                                  const bwi_node_blocks *blocks);
/* Factors of the blocks at the unknowns, from the stiffness in their envelopes (9 each, by rows, as
 * `factor`), which is overwritten, and `diagonal`. Where one is not positive definite, an inverse
 * is NAN. */
bw_status bwi_smoother_factor_blocks(bw_context *context, bwi_smoother *smoother, double *within,
                                     const bw_dof_map *dof_map);

#endif
