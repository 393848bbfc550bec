/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Products P^T A P by rows (Gustavson 1978): the lower triangle is summed, the upper one is its
 * mirror. */
#include "matrix/sparse.h"

#include <assert.h>
#include <string.h>

typedef struct lower {
  int64_t *start;
  size_t count, column_capacity, value_capacity;
  int32_t *column;
  double *value;
} lower;

static bw_status transpose(bw_context *context, const bw_sparse_matrix *p, bw_sparse_matrix **t) {
  bw_status status = BW_OK;
  int64_t entries = p->start[p->rows];
  int32_t *row = BW_NEW(context, int32_t, entries);
  BW_TRY_MEMORY(row);
  for (int32_t r = 0; r < p->rows; r++)
    for (int64_t k = p->start[r]; k < p->start[r + 1]; k++)
      row[k] = r;
  BW_TRY(
      bw_sparse_matrix_create(context, p->columns, p->rows, entries, p->column, row, p->value, t));
done:
  bw_free(row);
  return status;
}

/* Row r of the lower triangle. `place`: of each column in the row, or -1. */
static bw_status sum_row(bw_context *context, const bw_sparse_matrix *a, const bw_sparse_matrix *p,
                         const bw_sparse_matrix *t, int32_t r, int64_t *place, lower *l) {
  size_t first = l->count;
  for (int64_t i = t->start[r]; i < t->start[r + 1]; i++)
    for (int64_t j = a->start[t->column[i]]; j < a->start[t->column[i] + 1]; j++)
      for (int64_t k = p->start[a->column[j]]; k < p->start[a->column[j] + 1]; k++) {
        int32_t c = p->column[k];
        if (c > r)
          continue;
        if (place[c] < 0) {
          if (!bw_grow(context, (void **)&l->column, &l->column_capacity, l->count, 1,
                       sizeof *l->column) ||
              !bw_grow(context, (void **)&l->value, &l->value_capacity, l->count, 1,
                       sizeof *l->value))
            return BW_MEMORY;
          place[c] = (int64_t)l->count;
          l->column[l->count] = c;
          l->value[l->count++] = 0;
        }
        l->value[place[c]] += t->value[i] * a->value[j] * p->value[k];
      }
  for (size_t k = first; k < l->count; k++)
    place[l->column[k]] = -1;
  l->start[r + 1] = (int64_t)l->count;
  return BW_OK;
}

bw_status bwi_sparse_mirror(bw_context *context, int32_t rows, const int64_t *lower_start,
                            const int32_t *lower_column, const double *lower_value,
                            bw_sparse_matrix **out) {
  bw_status status = BW_OK;
  int32_t *column = NULL;
  double *value = NULL;
  int64_t *next = NULL, *start = BW_NEW0(context, int64_t, (int64_t)rows + 1);
  BW_TRY_MEMORY(start);
  for (int32_t i = 0; i < rows; i++)
    for (int64_t e = lower_start[i]; e < lower_start[i + 1]; e++) {
      start[i + 1]++;
      start[lower_column[e] + 1] += lower_column[e] != i;
    }
  for (int32_t i = 0; i < rows; i++)
    start[i + 1] += start[i];
  next = BW_NEW(context, int64_t, rows);
  column = BW_NEW(context, int32_t, start[rows]);
  value = BW_NEW(context, double, start[rows]);
  BW_TRY_MEMORY(next && column && value);
  memcpy(next, start, (size_t)rows * sizeof *next);
  for (int32_t i = 0; i < rows; i++)
    for (int64_t e = lower_start[i]; e < lower_start[i + 1]; e++) {
      int32_t j = lower_column[e];
      column[next[i]] = j;
      value[next[i]++] = lower_value[e];
      if (j == i)
        continue;
      column[next[j]] = i;
      value[next[j]++] = lower_value[e];
    }
  BW_TRY(bw_sparse_matrix_adopt(context, rows, rows, start, column, value, out));
  start = NULL;
  column = NULL;
  value = NULL;
done:
  bw_free(start);
  bw_free(next);
  bw_free(column);
  bw_free(value);
  return status;
}

bw_status bwi_galerkin(bw_context *context, const bw_sparse_matrix *a, const bw_sparse_matrix *p,
                       bw_sparse_matrix **product) {
  bw_status status = BW_OK;
  bw_sparse_matrix *t = NULL;
  lower l = {.start = BW_NEW0(context, int64_t, (size_t)p->columns + 1)};
  int64_t *place = BW_NEW(context, int64_t, p->columns);
  assert(a->rows == a->columns && a->rows == p->rows);
  BW_TRY_MEMORY(l.start && place);
  for (int32_t c = 0; c < p->columns; c++)
    place[c] = -1;
  BW_TRY(transpose(context, p, &t));
  for (int32_t r = 0; r < p->columns; r++) {
    if (r % 4096 == 0)
      BW_TRY(bw_check_cancel(context));
    BW_TRY(sum_row(context, a, p, t, r, place, &l));
  }
  BW_TRY(bwi_sparse_mirror(context, p->columns, l.start, l.column, l.value, product));
done:
  bw_release(t);
  bw_free(l.start);
  bw_free(l.column);
  bw_free(l.value);
  bw_free(place);
  return status;
}
