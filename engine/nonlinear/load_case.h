/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What acts on a solid, as numbers at nodes. */
#ifndef BWI_NONLINEAR_LOAD_CASE_H
#define BWI_NONLINEAR_LOAD_CASE_H

#include "barwright/nonlinear.h"

/* BW_EMPTY without nodes, BW_INVALID for one that the grid does not have; BW_INVALID for a vector
 * that is not finite. */
bw_status bwi_load_case_check_nodes(bw_context *context, const bw_grid *grid, int64_t count,
                                    const int32_t *node, const char *what);
bw_status bwi_load_case_check_finite(bw_context *context, const char *what, const double vector[3]);

/* Where the points of an embedding are at rest (point_count x 3). */
void bwi_embedding_rest(const bw_embedding *embedding, double *rest);

/* Dead loads at full: forces, gravity, dead pressures (node_count x 3). */
bw_status bwi_load_case_dead(bw_context *context, const bw_solid *solid, const bw_load_case *it,
                             double *force);
bool bwi_load_case_follows(const bw_load_case *it);

/* Follower pressures at displacements u, times `factor`, added to `force`; and their derivative
 * along v. A triangle's force p a, a its area vector, goes to its three points alike. */
bw_status bwi_load_case_follow(bw_context *context, const bw_load_case *it, const double *u,
                               double factor, double *force);
bw_status bwi_load_case_follow_along(bw_context *context, const bw_load_case *it, const double *u,
                                     const double *v, double factor, double *force);

/* The symmetric part of what follower pressures, times `factor`, add to the second derivatives of
 * the potential, as far as it is between nodes that share an element (9 per block, added). */
bw_status bwi_load_case_follow_stiffness(bw_context *context, const bw_load_case *it,
                                         const double *u, double factor,
                                         const bw_block_pattern *pattern, double *values);
/* The place of block (a, b), b <= a, or -1. */
static inline int64_t bwi_block_index(const bw_block_pattern *pattern, int32_t a, int32_t b) {
  int64_t low = pattern->start[a], high = pattern->start[a + 1] - 1;
  while (low < high) {
    int64_t middle = low + (high - low) / 2;
    if (pattern->column[middle] < b)
      low = middle + 1;
    else
      high = middle;
  }
  return pattern->column[low] == b ? low : -1;
}

/* BW_UNCONSTRAINED where a group of elements connected by nodes can move as a rigid body: by what
 * is constrained and, towards them, by contact planes. */
bw_status bwi_load_case_check_constraints(bw_context *context, const bw_load_case *it);

#endif
