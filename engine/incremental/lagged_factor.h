/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Factors that outlive the matrix they were made of, on plane patterns. All kinds have one face:
 *
 *   factor   make the factor of this matrix, keeping what still fits of order and analysis
 *   apply    z = B r with the factor as it is, of whatever age
 *   reset    drop everything
 *
 * What is kept depends on identity of objects alone: the elimination order belongs to the nodes,
 * the analysis to the topology, the numbers to the matrix. A reconnected mesh has the same nodes,
 * and while flips are few the order stays good: only the analysis under it is rebuilt. Flips across
 * separators add fill; an order under which the work has grown by more than a quarter is recomputed
 * too (lagged.c). */
#ifndef BWI_INCREMENTAL_LAGGED_FACTOR_H
#define BWI_INCREMENTAL_LAGGED_FACTOR_H

#include "assemble/plane_matrix.h"
#include "barwright/incremental.h"
#include "linear/order.h"

/* What a factorisation would cost or did, counted. */
typedef struct bwi_lagged_work {
  double flops;
  double bytes;   /* of the factor */
  bool analysed;  /* the analysis was rebuilt, */
  bool reordered; /* and the order too */
  bool refused;   /* there is no factor: this kind does not serve the matrix */
} bwi_lagged_work;

/* The caller's record, or `own` where there is none; its report has words. */
bw_plane_reuse *bwi_reuse_of(bw_plane_reuse *given, bw_plane_reuse *own);

typedef struct bwi_lagged_kind bwi_lagged_kind;
/* What all kinds have; a kind's own struct begins with it. */
typedef struct bwi_lagged {
  const bwi_lagged_kind *kind;
  int components;
  const bw_plane_nodes *nodes;       /* retained: what the order is of */
  idx_t *permutation;                /* node eliminated k-th */
  double ordered, flops;             /* operations when the order was new, and now */
  const bw_plane_topology *topology; /* retained: what the analysis is of */
  bool made;                         /* there is a factor */
} bwi_lagged;

struct bwi_lagged_kind {
  size_t size; /* of the kind's struct */
  /* The analysis under s->permutation, and its operations in s->flops. `near` is made where it is
   * asked for (bwi_lagged_adjacency). */
  bw_status (*analyse)(bw_context *context, bwi_lagged *s, const bw_plane_pattern *pattern,
                       const double *values, bwi_adjacency *near);
  /* The numbers under the analysis; operations and bytes, or that it was refused. */
  bw_status (*factor)(bw_context *context, bwi_lagged *s, const bw_plane_pattern *pattern,
                      const double *values, bwi_lagged_work *work);
  /* `old`: the factor is of another matrix, and digits do not matter. */
  bw_status (*apply)(bw_context *context, bwi_lagged *s, bool old, const double *r, double *z);
  /* Releases the analysis; and all else that the kind has of these nodes. */
  void (*forget_analysis)(bwi_lagged *s);
  void (*forget)(bwi_lagged *s);
};
/* Cholesky of symmetric positive definite matrices (lagged_symmetric.c); LU with pivoting
 * (lagged_unsymmetric.c); the cheaper one without pivoting between nodes, in single precision,
 * which refuses matrices where that will not do (lagged_blocks.c). */
extern const bwi_lagged_kind bwi_lagged_symmetric, bwi_lagged_unsymmetric, bwi_lagged_blocks;

bw_status bwi_lagged_create(bw_context *context, const bwi_lagged_kind *kind, int components,
                            bwi_lagged **out);
/* NULL is allowed in both. */
void bwi_lagged_destroy(bwi_lagged *s);
void bwi_lagged_reset(bwi_lagged *s);
bw_status bwi_lagged_factor(bw_context *context, bwi_lagged *s, const bw_plane_pattern *pattern,
                            const double *values, bwi_lagged_work *work);
bw_status bwi_lagged_apply(bw_context *context, bwi_lagged *s, bool old, const double *r,
                           double *z);

/* For kinds: the graph of the nodes. Clear with bwi_adjacency_clear in any case. */
bw_status bwi_lagged_adjacency(bw_context *context, const bw_plane_pattern *pattern,
                               bwi_adjacency *near);

#endif
