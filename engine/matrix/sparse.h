/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How sparse matrices are made: of entries whose number is not known before, of a lower triangle,
 * and as products. */
#ifndef BWI_MATRIX_SPARSE_H
#define BWI_MATRIX_SPARSE_H

#include "barwright/matrix.h"

/* Entries in any order; those at one place are added. Begins as {0}. */
typedef struct bwi_entries {
  size_t count, row_capacity, column_capacity, value_capacity;
  int32_t *row, *column;
  double *value;
} bwi_entries;
/* Adds an entry; 0 is none. */
bw_status bwi_entries_add(bw_context *context, bwi_entries *entries, int32_t row, int32_t column,
                          double value);
/* The matrix of these entries, which stay. */
bw_status bwi_entries_matrix(bw_context *context, const bwi_entries *entries, int32_t rows,
                             int32_t columns, bw_sparse_matrix **matrix);
void bwi_entries_clear(bwi_entries *entries);

/* The symmetric matrix of which this is the lower triangle, by rows. */
bw_status bwi_sparse_mirror(bw_context *context, int32_t rows, const int64_t *start,
                            const int32_t *column, const double *value, bw_sparse_matrix **matrix);
/* P^T A P of a symmetric A, symmetric to the last bit. */
bw_status bwi_galerkin(bw_context *context, const bw_sparse_matrix *a, const bw_sparse_matrix *p,
                       bw_sparse_matrix **product);

#endif
