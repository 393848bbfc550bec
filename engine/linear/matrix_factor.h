/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sparse matrices as the factor takes them, and their inverses (matrix_factor.c, inverse.c). */
#ifndef BWI_LINEAR_MATRIX_FACTOR_H
#define BWI_LINEAR_MATRIX_FACTOR_H

#include "linear/internal.h"

/* Lower triangles of two symmetric matrices on one pattern: a row of theirs is a node with one
 * component. */
typedef struct bwi_matrix_pair {
  bw_block_pattern *pattern;
  double *k, *m; /* block_count each; m: the identity where no second matrix is given */
} bwi_matrix_pair;
/* `m` may be NULL. Clear with bwi_matrix_pair_clear in any case. */
bw_status bwi_matrix_pair_open(bw_context *context, const bw_sparse_matrix *k,
                               const bw_sparse_matrix *m, bwi_matrix_pair *pair);
void bwi_matrix_pair_clear(bwi_matrix_pair *pair);
/* The factor of K - sigma M as `solver` (NULL: the default) describes it, in the elimination order
 * `symbolic` (NULL: a new one), that of a former factor of the pair: factor->symbolic. BW_SINGULAR
 * names the matrix and the row; BW_MEMORY before any is allocated where it is larger than what is
 * free. `advice`: what needs less memory, as the end of that message. */
bw_status bwi_matrix_pair_factor(bw_context *context, const bwi_matrix_pair *pair, double sigma,
                                 const bw_solver *solver, const char *name, const char *advice,
                                 bwi_symbolic *symbolic, bwi_factor **factor);
/* Solves A x = b in place for `count` right-hand sides of matrix->rows numbers, one after the
 * other, by a factor that is not kept. Those of bwi_matrix_pair_factor. */
bw_status bwi_matrix_solve(bw_context *context, const bw_sparse_matrix *matrix, const char *name,
                           const char *advice, int64_t count, double *x);

/* BW_INVALID where an operator is not symmetric: a matrix by its entries, or by two random vectors;
 * another one by these. *norm (may be NULL): |A v| / |v| of the vectors, near the norm of A. */
bw_status bwi_operator_check_symmetric(bw_context *context, const bw_operator *a, double *norm);

/* The word of an operator of bw_operator_inverse in a report ("cholesky"), "operator" for another
 * one, "" for NULL. */
const char *bwi_operator_word(const bw_operator *a);
/* The factor of an operator of bw_operator_inverse, or NULL. */
const bwi_factor *bwi_operator_factor(const bw_operator *a);

/* What an inverse by a factor had in common with that of another matrix. */
typedef enum bwi_inverse_reuse {
  BWI_REUSED_NONE,
  BWI_REUSED_ORDER,
  BWI_REUSED_FACTOR
} bwi_inverse_reuse;
/* Makes *inverse (NULL: none yet) that of another matrix. Where the entries of the matrix lie in
 * the pattern of the one before, the elimination order is kept, and where they are the same to the
 * last bit, the factor. On failure *inverse is released and NULL. Those of bw_operator_inverse. */
bw_status bwi_operator_inverse_follow(bw_context *context, const bw_sparse_matrix *matrix,
                                      bw_operator **inverse, bwi_inverse_reuse *reused);
/* bw_linear_solve, directly by an inverse of `a` in double precision that the caller has; NULL: as
 * the options say. */
bw_status bwi_linear_solve_by(bw_context *context, const bw_operator *a,
                              const bw_linear_solve_options *options, const bw_operator *inverse,
                              int64_t count, const double *b, double *x, bw_solver_report *report);

#endif
