/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The lowest eigenpairs of K x = lambda M x by block Lanczos on the inverse, Op = K^+ M, which is
 * symmetric in the M inner product: eigenvalues theta = 1/lambda, the lowest lambda outermost.
 *
 * Why blocks: one pass over the factor serves a whole block of right-hand sides, and a block of b
 * vectors sees eigenvalues of multiplicity up to b at once, where a single-vector method sees
 * partners only by rounding.
 *
 * Invariants of the basis V (M-orthonormal, orthogonalised twice in full): T = V^T M Op V holds in
 * its upper triangle for all blocks that went through Op (`done` vectors); the vectors behind them
 * are the next block, with R its coupling, so that Op V = V T + V_next R. A restart keeps the best
 * Ritz vectors in front of the next block; the coupling comes back by the projection, which always
 * is taken on the whole basis. */
#ifndef BWI_EIGEN_BLOCK_LANCZOS_H
#define BWI_EIGEN_BLOCK_LANCZOS_H

#include "eigen/iteration.h"

enum { BWI_BLOCK = 8 };

typedef struct bwi_lanczos {
  bwi_eigen_iteration base; /* its `known` values are those of the Ritz vectors */
  int capacity, block;
  int used;       /* vectors in the basis, with the next block */
  int done;       /* of these, through Op */
  double *v, *mv; /* capacity x size: basis, and M times basis */
  double *t;      /* capacity x capacity, column-major, upper triangle */
  double *r;      /* coupling: (used - done) x the last `r_columns` done vectors, ld = block */
  int r_columns;
  double *theta, *s; /* Ritz values (descending) and coefficients, ld = capacity */
} bwi_lanczos;

#endif
