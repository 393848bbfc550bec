/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Algebraic multigrid by smoothed aggregation (Vanek, Mandel and Brezina 1996) for stiffnesses by
 * blocks of nodes: a preconditioner of conjugate gradients (docs/theory/preconditioners.md).
 *
 * Aggregates of strongly coupled nodes have six unknowns each, the rigid-body motions of their
 * nodes. The prolongation is smoothed once. On the nodes the smoother is that of smoother.h, on
 * aggregates Chebyshev's polynomial of block Jacobi. The coarsest level is solved directly. Work is
 * in floats, the setup and the coarsest level in doubles. Nothing depends on the number of
 * threads.
 *
 * Bodies that can move freely have a singular K, whose isostatic constraints do not count here. All
 * levels then have the rigid-body modes for null space, and the coarsest is solved by its
 * pseudo-inverse. */
#ifndef BWI_LINEAR_AMG_H
#define BWI_LINEAR_AMG_H

#include "linear/internal.h"
#include "linear/smoother.h"

enum { BWI_AMG_LEVELS = 12, BWI_AMG_MODES = 6, BWI_AMG_COARSEST = 100 };

/* A matrix of blocks, by rows. Blocks are row-major. */
typedef struct bwi_amg_blocks {
  int32_t rows, columns;
  int height, width; /* of a block */
  int64_t *start;    /* rows + 1 */
  int32_t *column;
  double *exact; /* during the setup */
  float *value;
} bwi_amg_blocks;

/* Level 0 are the nodes, in the rows of the smoother. */
typedef struct bwi_amg_level {
  int32_t rows;
  int unknowns;         /* of a row: 3, or 6 */
  bwi_amg_blocks a;     /* of level 0: the smoother's */
  float *inverse;       /* rows x unknowns x unknowns: of the diagonal blocks; not of level 0 */
  double largest;       /* eigenvalue of D^-1 A, estimated from above */
  bwi_amg_blocks p;     /* from the next level; none on the coarsest */
  int64_t *child_start; /* next level's rows + 1: rows with a block of p in that column */
  int64_t *child;       /* their blocks in p, */
  int32_t *child_row;   /* and their rows */
  float *b, *x, *r, *d; /* rows x unknowns x width */
} bwi_amg_level;

typedef struct bwi_amg {
  bw_object object;
  const bw_dof_map *dof_map; /* retained */
  bwi_smoother *smoother;
  int level_count;
  bwi_amg_level level[BWI_AMG_LEVELS];
  int size; /* of the coarsest level's matrix */
  double *dense, *dense_x;
  int null_count; /* rigid-body modes that supports leave free */
  double *null;   /* null_count x size: on the coarsest level, orthonormal */
  int width;      /* there is room for */
} bwi_amg;

/* Of a matrix without mass. BW_SINGULAR where a block is not positive definite, or the coarsest
 * level beside the rigid-body modes that are free. Release with bw_release. */
bw_status bwi_amg_create(bw_context *context, const bwi_matrix *matrix, bwi_amg **amg);
/* z = B r for `count` fields in global directions (count x node_count x 3), 0 at prescribed
 * components. In bodies that can move freely r has to be balanced, and z is determined up to
 * rigid-body motions. The two may be the same. */
bw_status bwi_amg_apply(bw_context *context, bwi_amg *amg, int64_t count, const double *r,
                        double *z);
/* Bytes that an application reads for one field. */
double bwi_amg_pass_bytes(const bwi_amg *amg);

/* ---- amg_setup.c ----------------------------------------------------------------------------- */

bw_status bwi_amg_set_up(bw_context *context, bwi_amg *amg, const bwi_matrix *matrix);
void bwi_amg_blocks_clear(bwi_amg_blocks *blocks);

#endif
