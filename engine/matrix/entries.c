/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Lists of matrix entries that grow. */
#include "matrix/sparse.h"

bw_status bwi_entries_add(bw_context *context, bwi_entries *e, int32_t row, int32_t column,
                          double value) {
  if (value == 0)
    return BW_OK;
  if (!bw_grow(context, (void **)&e->row, &e->row_capacity, e->count, 1, sizeof *e->row) ||
      !bw_grow(context, (void **)&e->column, &e->column_capacity, e->count, 1, sizeof *e->column) ||
      !bw_grow(context, (void **)&e->value, &e->value_capacity, e->count, 1, sizeof *e->value))
    return BW_MEMORY;
  e->row[e->count] = row;
  e->column[e->count] = column;
  e->value[e->count++] = value;
  return BW_OK;
}

bw_status bwi_entries_matrix(bw_context *context, const bwi_entries *e, int32_t rows,
                             int32_t columns, bw_sparse_matrix **matrix) {
  return bw_sparse_matrix_create(context, rows, columns, (int64_t)e->count, e->row, e->column,
                                 e->value, matrix);
}

void bwi_entries_clear(bwi_entries *e) {
  bw_free(e->row);
  bw_free(e->column);
  bw_free(e->value);
}
