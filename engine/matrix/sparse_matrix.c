/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sparse matrices by compressed rows. Invariant: columns of a row ascend strictly. */
#include "barwright/matrix.h"

#include <assert.h>
#include <string.h>

enum { ROWS_PER_CHUNK = 1024, FEW = 16 };

static void matrix_destroy(void *object) {
  bw_sparse_matrix *matrix = (bw_sparse_matrix *)object;
  bw_free(matrix->start);
  bw_free(matrix->column);
  bw_free(matrix->value);
  bw_free(matrix);
}

static size_t matrix_bytes(const void *object) {
  const bw_sparse_matrix *matrix = (const bw_sparse_matrix *)object;
  return sizeof *matrix + 8 * ((size_t)matrix->rows + 1) + 12 * (size_t)matrix->start[matrix->rows];
}

static const bw_kind matrix_kind = {"sparse matrix", matrix_destroy, matrix_bytes};

/* ---- sorting a row --------------------------------------------------------------------------- */

static void exchange(int32_t *column, double *value, int64_t a, int64_t b) {
  int32_t c = column[a];
  double v = value[a];
  column[a] = column[b];
  value[a] = value[b];
  column[b] = c;
  value[b] = v;
}

static void insertion_sort(int32_t *column, double *value, int64_t count) {
  for (int64_t i = 1; i < count; i++)
    for (int64_t k = i; k > 0 && column[k] < column[k - 1]; k--)
      exchange(column, value, k, k - 1);
}

/* Heapsort: columns of a row differ, so that its order of equal ones does not matter. */
static void sift(int32_t *column, double *value, int64_t root, int64_t count) {
  for (int64_t child; (child = 2 * root + 1) < count; root = child) {
    if (child + 1 < count && column[child] < column[child + 1])
      child++;
    if (column[root] >= column[child])
      return;
    exchange(column, value, root, child);
  }
}

static void sort_row(int32_t *column, double *value, int64_t count) {
  bool sorted = true;
  for (int64_t i = 1; i < count; i++)
    sorted = sorted && column[i - 1] < column[i];
  if (sorted)
    return;
  if (count <= FEW) {
    insertion_sort(column, value, count);
    return;
  }
  for (int64_t root = count / 2; root-- > 0;)
    sift(column, value, root, count);
  for (int64_t last = count - 1; last > 0; last--) {
    exchange(column, value, 0, last);
    sift(column, value, 0, last);
  }
}

/* ---- making ---------------------------------------------------------------------------------- */

bw_status bw_sparse_matrix_adopt(bw_context *context, int32_t rows, int32_t columns, int64_t *start,
                                 int32_t *column, double *value, bw_sparse_matrix **result) {
  if (rows < 0 || columns < 0)
    return bw_fail(context, BW_INVALID, "a matrix of %d x %d: sizes must be 0 or more", rows,
                   columns);
  if (start[0] != 0)
    return bw_fail(context, BW_INVALID, "row 1 starts at entry %lld, not at the first",
                   (long long)start[0] + 1);
  for (int32_t i = 0; i < rows; i++)
    if (start[i + 1] < start[i])
      return bw_fail(context, BW_INVALID, "row %d ends before it starts", i + 1);
  for (int32_t i = 0; i < rows; i++) {
    for (int64_t k = start[i]; k < start[i + 1]; k++)
      if (column[k] < 0 || column[k] >= columns)
        return bw_fail(context, BW_INVALID, "row %d has an entry in column %lld of %d", i + 1,
                       (long long)column[k] + 1, columns);
    sort_row(column + start[i], value + start[i], start[i + 1] - start[i]);
    for (int64_t k = start[i] + 1; k < start[i + 1]; k++)
      if (column[k] == column[k - 1])
        return bw_fail(context, BW_INVALID, "row %d has two entries in column %d", i + 1,
                       column[k] + 1);
  }
  bw_sparse_matrix *matrix = BW_NEW0(context, bw_sparse_matrix, 1);
  if (!matrix)
    return BW_MEMORY;
  bw_object_init(matrix, &matrix_kind);
  matrix->rows = rows;
  matrix->columns = columns;
  matrix->start = start;
  matrix->column = column;
  matrix->value = value;
  *result = matrix;
  return BW_OK;
}

/* Two stable counting sorts, by column and then by row, bring entries at one place together in the
 * order given. */
bw_status bw_sparse_matrix_create(bw_context *context, int32_t rows, int32_t columns, int64_t count,
                                  const int32_t *row, const int32_t *column, const double *value,
                                  bw_sparse_matrix **matrix) {
  bw_status status = BW_OK;
  if (rows < 0 || columns < 0 || count < 0)
    return bw_fail(context, BW_INVALID, "a matrix of %d x %d with %lld entries: 0 or more expected",
                   rows, columns, (long long)count);
  for (int64_t k = 0; k < count; k++)
    if (row[k] < 0 || row[k] >= rows || column[k] < 0 || column[k] >= columns)
      return bw_fail(context, BW_INVALID, "entry %lld lies at (%lld, %lld) of a matrix of %d x %d",
                     (long long)k + 1, (long long)row[k] + 1, (long long)column[k] + 1, rows,
                     columns);
  int64_t *by_column = BW_NEW(context, int64_t, count + 1);
  int64_t *by_row = BW_NEW(context, int64_t, count + 1);
  int64_t *place = BW_NEW0(context, int64_t, (size_t)columns + 1);
  int64_t *start = BW_NEW0(context, int64_t, (size_t)rows + 2);
  int32_t *to_column = BW_NEW(context, int32_t, count + 1);
  double *to_value = BW_NEW(context, double, count + 1);
  BW_TRY_MEMORY(by_column && by_row && place && start && to_column && to_value);
  for (int64_t k = 0; k < count; k++) {
    place[column[k] + 1]++;
    start[row[k] + 2]++;
  }
  for (int32_t j = 0; j < columns; j++)
    place[j + 1] += place[j];
  for (int32_t i = 0; i <= rows; i++)
    start[i + 1] += start[i];
  for (int64_t k = 0; k < count; k++)
    by_column[place[column[k]]++] = k;
  for (int64_t k = 0; k < count; k++)
    by_row[start[row[by_column[k]] + 1]++] = by_column[k];
  /* start[i] is the first of row i now; compress in place. */
  int64_t to = 0, from = 0;
  for (int32_t i = 0; i < rows; i++) {
    int64_t first = to, end = start[i + 1];
    start[i] = to;
    for (; from < end; from++) {
      int64_t k = by_row[from];
      if (to > first && to_column[to - 1] == column[k]) {
        to_value[to - 1] += value[k];
      } else {
        to_column[to] = column[k];
        to_value[to++] = value[k];
      }
    }
  }
  start[rows] = to;
  BW_TRY(bw_sparse_matrix_adopt(context, rows, columns, start, to_column, to_value, matrix));
  start = NULL;
  to_column = NULL;
  to_value = NULL;
done:
  bw_free(by_column);
  bw_free(by_row);
  bw_free(place);
  bw_free(start);
  bw_free(to_column);
  bw_free(to_value);
  return status;
}

/* ---- asking ---------------------------------------------------------------------------------- */

/* The entry (i, j), or NULL. */
static const double *entry_at(const bw_sparse_matrix *matrix, int32_t i, int32_t j) {
  int64_t low = matrix->start[i], high = matrix->start[i + 1];
  while (low < high) {
    int64_t middle = low + (high - low) / 2;
    if (matrix->column[middle] < j)
      low = middle + 1;
    else
      high = middle;
  }
  return low < matrix->start[i + 1] && matrix->column[low] == j ? matrix->value + low : NULL;
}

bool bw_sparse_matrix_is_symmetric(const bw_sparse_matrix *matrix) {
  if (matrix->rows != matrix->columns)
    return false;
  for (int32_t i = 0; i < matrix->rows; i++)
    for (int64_t k = matrix->start[i]; k < matrix->start[i + 1]; k++) {
      const double *other = entry_at(matrix, matrix->column[k], i);
      if (!other || memcmp(other, &matrix->value[k], sizeof *other) != 0)
        return false;
    }
  return true;
}

typedef struct product {
  const bw_sparse_matrix *matrix;
  int64_t count;
  const double *x;
  double *y;
} product;

static bw_status product_body(void *data, int64_t begin, int64_t end, int worker) {
  const product *p = (const product *)data;
  const bw_sparse_matrix *a = p->matrix;
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    for (int64_t v = 0; v < p->count; v++) {
      const double *x = p->x + v * a->columns;
      double sum = 0;
      for (int64_t k = a->start[i]; k < a->start[i + 1]; k++)
        sum += a->value[k] * x[a->column[k]];
      p->y[v * a->rows + i] = sum;
    }
  return BW_OK;
}

bw_status bw_sparse_matrix_apply(bw_context *context, const bw_sparse_matrix *matrix, int64_t count,
                                 const double *x, double *y) {
  product p = {matrix, count, x, y};
  return bw_parallel(context, matrix->rows, ROWS_PER_CHUNK, product_body, &p);
}
