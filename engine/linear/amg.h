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
#include "linear/rigid_space.h"
#include "linear/smoother.h"

enum { BWI_AMG_LEVELS = 12, BWI_AMG_MODES = 6, BWI_AMG_COARSEST = 100 };

/* A matrix of blocks, by rows. */
typedef struct bwi_amg_blocks {
  int32_t rows, columns;
  int height, width; /* of a block */
  int64_t *start;    /* rows + 1 */
  int32_t *column;
  double *exact; /* during the setup: blocks row by row */
  float *value;  /* blocks by columns, and BWI_SMOOTHER_SPARE numbers behind the last */
} bwi_amg_blocks;

/* Level 0 are the nodes, in the rows of the smoother. */
typedef struct bwi_amg_level {
  int32_t rows;
  int unknowns;      /* of a row: 3, or 6 */
  bwi_amg_blocks a;  /* of level 0: the smoother's */
  float *inverse;    /* rows x unknowns x unknowns: of the diagonal blocks; not of level 0 */
  double largest;    /* eigenvalue of D^-1 A, estimated from above */
  bwi_amg_blocks p;  /* from the next level; none on the coarsest */
  bwi_amg_blocks pt; /* its transpose, so that both are read row by row */
  float *b, *x, *r;  /* rows x unknowns x width */
  float *d;          /* the same; not of level 0 */
} bwi_amg_level;

typedef struct bwi_amg {
  bw_object object;
  const bw_dof_map *dof_map; /* retained */
  bwi_smoother *smoother;
  int level_count;
  bwi_amg_level level[BWI_AMG_LEVELS];
  int size;                /* of the coarsest level's matrix */
  double *dense, *dense_x; /* dense_x: size x BWI_SMOOTHER_SIDES */
  int null_count;          /* rigid-body modes that supports leave free */
  double *null;            /* null_count x size: on the coarsest level, orthonormal */
  int width;               /* there is room for */
  int32_t constrained_count, *constrained; /* rows with a prescribed component */
  bwi_rigid_space *rigid; /* of those that solve: of the rows; NULL where no mode is free */
} bwi_amg;

/* Of a matrix without mass; `solves`: for bwi_amg_solve, with numbers for products. BW_SINGULAR
 * where a block is not positive definite, or the coarsest level beside the rigid-body modes that
 * are free. Release with bw_release. */
bw_status bwi_amg_create(bw_context *context, const bwi_matrix *matrix, bool solves, bwi_amg **amg);
/* z = B r for `count` fields in global directions (count x node_count x 3), 0 at prescribed
 * components. In bodies that can move freely r has to be balanced, and z is determined up to
 * rigid-body motions. The two may be the same. */
bw_status bwi_amg_apply(bw_context *context, bwi_amg *amg, int64_t count, const double *r,
                        double *z);
/* The levels' room for `width` fields side by side (bwi_smoother_width). */
bw_status bwi_amg_reserve(bw_context *context, bwi_amg *amg, int width);
/* x = B b of level 0, packed in the rows of the smoother; x may have a remainder of rounding along
 * prescribed components. There is room. */
bw_status bwi_amg_cycle(bw_context *context, bwi_amg *amg, int width);
/* Bytes that an application reads for one field. */
double bwi_amg_pass_bytes(const bwi_amg *amg);

/* ---- amg_solve.c ----------------------------------------------------------------------------- */

typedef struct bwi_amg_problem {
  double tolerance;
  bool energy_alone; /* it is on the error in energy alone */
  int limit;         /* on iterations */
  /* out */
  int iterations;
  bool converged;
  double residual; /* where they did not: the largest, relative to the load */
} bwi_amg_problem;
/* K u = f by conjugate gradients for `count` fields in global directions, those of force taken at
 * the unknowns; u is 0 elsewhere. Of a body that can move freely forces have to be balanced, and u
 * is one of the solutions. Not converged is no failure. The two may not be the same block. */
bw_status bwi_amg_solve(bw_context *context, bwi_amg *amg, bwi_amg_problem *problem, int64_t count,
                        const double *force, double *displacement);

/* ---- amg_setup.c ----------------------------------------------------------------------------- */

bw_status bwi_amg_set_up(bw_context *context, bwi_amg *amg, const bwi_matrix *matrix);
void bwi_amg_blocks_clear(bwi_amg_blocks *blocks);

#endif
