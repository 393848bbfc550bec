/* Symmetric positive definite systems that do not come from a mesh: factored once, solved for many
 * right-hand sides, by the same ordering and factor as everything else.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BWI_LINEAR_SPARSE_H
#define BWI_LINEAR_SPARSE_H

#include "barwright/linear.h"

/* One contribution to A[row, column] = A[column, row]; several at one place are added. */
typedef struct bwi_entry {
  int32_t row, column;
  double value;
} bwi_entry;

/* Solve A x = b in place for `count` right-hand sides of `size` numbers, one after the other. Every
 * row must have an entry on its diagonal. BW_SINGULAR when A is not positive definite. The same
 * entries in the same order give the same bits, for any number of threads. */
bw_status bwi_sparse_solve(bw_context *context, int32_t size, int64_t entries,
                           const bwi_entry *entry, int64_t count, double *x);

#endif
