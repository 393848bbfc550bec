/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Operators: square matrices that are known by their products. */
#include "barwright/matrix.h"

#include <math.h>
#include <stdio.h>

static void operator_destroy(void *object) {
  bw_operator *a = (bw_operator *)object;
  if (a->destroy)
    a->destroy(a->data);
  bw_release(a->matrix);
  bw_free(a);
}

static size_t operator_bytes(const void *object) {
  (void)object;
  return sizeof(bw_operator);
}

static const bw_kind operator_kind = {"operator", operator_destroy, operator_bytes};

bw_status bw_operator_create(bw_context *context, int64_t size, bw_operator_function *apply,
                             void *data, void (*destroy)(void *data), const char *name,
                             bw_operator **result) {
  if (size < 0)
    return bw_fail(context, BW_INVALID, "an operator of %lld rows: 0 or more expected",
                   (long long)size);
  if (!apply)
    return bw_fail(context, BW_INVALID, "an operator needs a function that computes its product");
  bw_operator *a = BW_NEW0(context, bw_operator, 1);
  if (!a)
    return BW_MEMORY;
  bw_object_init(a, &operator_kind);
  a->size = size;
  a->apply = apply;
  a->data = data;
  a->destroy = destroy;
  snprintf(a->name.text, sizeof a->name.text, "%s", name ? name : "operator");
  *result = a;
  return BW_OK;
}

static bw_status apply_matrix(bw_context *context, void *data, int64_t count, const double *x,
                              double *y) {
  return bw_sparse_matrix_apply(context, (const bw_sparse_matrix *)data, count, x, y);
}

bw_status bw_operator_of_matrix(bw_context *context, const bw_sparse_matrix *matrix,
                                const char *name, bw_operator **result) {
  if (matrix->rows != matrix->columns)
    return bw_fail(context, BW_INVALID, "the matrix of %d x %d is not square", matrix->rows,
                   matrix->columns);
  bw_status status = bw_operator_create(context, matrix->rows, apply_matrix, (void *)matrix, NULL,
                                        name ? name : "matrix", result);
  if (status == BW_OK)
    (*result)->matrix = (const bw_sparse_matrix *)bw_retain(matrix);
  return status;
}

bw_status bw_operator_apply(bw_context *context, const bw_operator *a, int64_t count,
                            const double *x, double *y) {
  bw_status status = a->apply(context, a->data, count, x, y);
  if (status != BW_OK)
    return status;
  for (int64_t i = 0; i < count * a->size; i++)
    if (!isfinite(y[i]))
      return bw_fail(context, BW_INVALID, "the product of \"%s\" has %s in row %lld", a->name.text,
                     isnan(y[i]) ? "nan" : "inf", (long long)(i % a->size) + 1);
  return BW_OK;
}
