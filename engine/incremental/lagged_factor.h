/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Factors that outlive the matrix they were made of. Both kinds have the same face:
 *
 *   factor   make the factor of this matrix, keeping what still fits of order and analysis
 *   apply    z = B r with the factor as it is, of whatever age
 *   reset    drop everything
 *
 * What is kept depends on identity of objects alone: the elimination order belongs to the nodes,
 * the analysis to the topology, the numbers to the matrix. */
#ifndef BWI_INCREMENTAL_LAGGED_FACTOR_H
#define BWI_INCREMENTAL_LAGGED_FACTOR_H

#include "assemble/plane_matrix.h"
#include "barwright/incremental.h"

/* An order under which the work has grown by more than this is recomputed. */
#define BWI_MAX_WORK_GROWTH 1.25

/* What a factorisation would cost or did, counted. */
typedef struct bwi_lagged_work {
  double flops;
  double bytes;   /* of the factor */
  bool analysed;  /* the analysis was rebuilt, */
  bool reordered; /* and the order too */
} bwi_lagged_work;

/* The caller's record, or `own` where there is none; its report has words. */
bw_plane_reuse *bwi_reuse_of(bw_plane_reuse *given, bw_plane_reuse *own);

typedef struct bwi_lagged_symmetric bwi_lagged_symmetric;
bw_status bwi_lagged_symmetric_create(bw_context *context, int components,
                                      bwi_lagged_symmetric **out);
void bwi_lagged_symmetric_destroy(bwi_lagged_symmetric *s);
void bwi_lagged_symmetric_reset(bwi_lagged_symmetric *s);
bw_status bwi_lagged_symmetric_factor(bw_context *context, bwi_lagged_symmetric *s,
                                      const bw_plane_pattern *pattern, const double *values,
                                      bwi_lagged_work *work);
/* `old`: for preconditioning, in single precision; else to all digits that the factor has. */
bw_status bwi_lagged_symmetric_apply(bw_context *context, bwi_lagged_symmetric *s, bool old,
                                     const double *r, double *z);

typedef struct bwi_lagged_unsymmetric bwi_lagged_unsymmetric;
bw_status bwi_lagged_unsymmetric_create(bw_context *context, int components,
                                        bwi_lagged_unsymmetric **out);
void bwi_lagged_unsymmetric_destroy(bwi_lagged_unsymmetric *s);
void bwi_lagged_unsymmetric_reset(bwi_lagged_unsymmetric *s);
bw_status bwi_lagged_unsymmetric_factor(bw_context *context, bwi_lagged_unsymmetric *s,
                                        const bw_plane_pattern *pattern, const double *values,
                                        bwi_lagged_work *work);
bw_status bwi_lagged_unsymmetric_apply(bw_context *context, bwi_lagged_unsymmetric *s,
                                       const double *r, double *z);

/* The cheaper one, without pivoting between nodes, in single precision; not `done` where that will
 * not do (lagged_blocks.c). */
typedef struct bwi_lagged_blocks bwi_lagged_blocks;
bw_status bwi_lagged_blocks_create(bw_context *context, int components, bwi_lagged_blocks **out);
void bwi_lagged_blocks_destroy(bwi_lagged_blocks *s);
void bwi_lagged_blocks_reset(bwi_lagged_blocks *s);
bw_status bwi_lagged_blocks_factor(bw_context *context, bwi_lagged_blocks *s,
                                   const bw_plane_pattern *pattern, const double *values,
                                   bool *done, bwi_lagged_work *work);
void bwi_lagged_blocks_apply(const bwi_lagged_blocks *s, const double *r, double *z);

/* An elimination order of the nodes, by METIS, or quickly (or where there are few) by AMD:
 * permutation[k] = the node eliminated k-th. */
bw_status bwi_lagged_order(bw_context *context, const bw_plane_pattern *pattern, bool quick,
                           int32_t *permutation);

#endif
