/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Arrays: strided views of numbers. Invariant: every element (row, column) lies inside the owner's
 * memory; an array that owns its data has owner NULL and rows x columns packed row by row. */
#include "barwright/base.h"

#include <string.h>

size_t bw_type_size(bw_type type) {
  switch (type) {
  case BW_F64:
  case BW_I64:
    return 8;
  case BW_I32:
    return 4;
  case BW_U8:
    return 1;
  }
  return 0;
}

static void array_destroy(void *object) {
  bw_array *array = (bw_array *)object;
  if (array->owner)
    bw_release(array->owner);
  else
    bw_free(array->data);
  bw_free(array);
}

static size_t array_bytes(const void *object) {
  const bw_array *array = (const bw_array *)object;
  size_t items = (size_t)array->rows * (size_t)array->columns;
  return sizeof *array + (array->owner ? 0 : items * bw_type_size(array->type));
}

static const bw_kind array_kind = {"array", array_destroy, array_bytes};

static bw_status check_shape(bw_context *context, bw_type type, int64_t rows, int64_t columns) {
  int64_t count;
  if (rows < 0 || columns < 0 || __builtin_mul_overflow(rows, columns, &count) ||
      count > PTRDIFF_MAX / 8 || columns > PTRDIFF_MAX / 8)
    return bw_fail(
        context, BW_INVALID,
        "an array of %lld x %lld: sizes must be 0 or more, and its bytes must fit into memory",
        (long long)rows, (long long)columns);
  if (bw_type_size(type) == 0)
    return bw_fail(context, BW_INVALID, "array type %d is not known", (int)type);
  return BW_OK;
}

static bw_status array_new(bw_context *context, bw_type type, int64_t rows, int64_t columns,
                           void *data, const void *owner, bw_array **array) {
  bw_array *made = BW_NEW(context, bw_array, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &array_kind);
  made->type = type;
  made->rows = rows;
  made->columns = columns;
  made->column_stride = (ptrdiff_t)bw_type_size(type);
  made->row_stride = made->column_stride * (ptrdiff_t)columns;
  made->data = data;
  made->owner = bw_retain(owner);
  *array = made;
  return BW_OK;
}

bw_status bw_array_create(bw_context *context, bw_type type, int64_t rows, int64_t columns,
                          bw_array **array) {
  bw_status status = check_shape(context, type, rows, columns);
  if (status != BW_OK)
    return status;
  void *data = bw_calloc(context, (size_t)(rows * columns), bw_type_size(type));
  if (!data)
    return BW_MEMORY;
  status = array_new(context, type, rows, columns, data, NULL, array);
  if (status != BW_OK)
    bw_free(data);
  return status;
}

bw_status bw_array_adopt(bw_context *context, bw_type type, int64_t rows, int64_t columns,
                         void *data, bw_array **array) {
  bw_status status = check_shape(context, type, rows, columns);
  return status == BW_OK ? array_new(context, type, rows, columns, data, NULL, array) : status;
}

bw_status bw_array_borrow(bw_context *context, bw_type type, int64_t rows, int64_t columns,
                          const void *data, const void *owner, bw_array **array) {
  bw_status status = check_shape(context, type, rows, columns);
  if (status == BW_OK && !owner)
    status = bw_fail(context, BW_INVALID, "a borrowing array needs an owner to keep alive");
  return status == BW_OK ? array_new(context, type, rows, columns, (void *)data, owner, array)
                         : status;
}

/* Whether first, first + step, ..., count of them, lie in 0..size-1. */
static bool range_fits(int64_t first, int64_t count, int64_t step, int64_t size) {
  int64_t reach, last;
  if (count <= 0)
    return count == 0;
  if (__builtin_mul_overflow(count - 1, step, &reach) ||
      __builtin_add_overflow(first, reach, &last))
    return false;
  return first >= 0 && first < size && last >= 0 && last < size;
}

bw_status bw_array_view(bw_context *context, const bw_array *array, int64_t first_row, int64_t rows,
                        int64_t row_step, int64_t first_column, int64_t columns,
                        int64_t column_step, bw_array **view) {
  if (!range_fits(first_row, rows, row_step, array->rows) ||
      !range_fits(first_column, columns, column_step, array->columns))
    return bw_fail(context, BW_INVALID,
                   "a view of %lld rows from %lld and %lld columns from %lld does not fit an array "
                   "of %lld x %lld",
                   (long long)rows, (long long)first_row + 1, (long long)columns,
                   (long long)first_column + 1, (long long)array->rows, (long long)array->columns);
  char *data = (char *)array->data;
  if (rows > 0 && columns > 0)
    data += first_row * array->row_stride + first_column * array->column_stride;
  bw_array *made;
  bw_status status = array_new(context, array->type, rows, columns, data, array, &made);
  if (status != BW_OK)
    return status;
  /* A step that leads to no second row may be as large as it likes: its product is not formed. */
  made->row_stride = rows > 1 ? array->row_stride * (ptrdiff_t)row_step : array->row_stride;
  made->column_stride =
      columns > 1 ? array->column_stride * (ptrdiff_t)column_step : array->column_stride;
  *view = made;
  return BW_OK;
}

double bw_array_get(const bw_array *array, int64_t row, int64_t column) {
  const char *at =
      (const char *)array->data + row * array->row_stride + column * array->column_stride;
  switch (array->type) {
  case BW_F64: {
    double value;
    memcpy(&value, at, sizeof value);
    return value;
  }
  case BW_I32: {
    int32_t value;
    memcpy(&value, at, sizeof value);
    return value;
  }
  case BW_I64: {
    int64_t value;
    memcpy(&value, at, sizeof value);
    return (double)value;
  }
  case BW_U8:
    return *(const uint8_t *)at;
  }
  return 0;
}
