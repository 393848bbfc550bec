/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The fields of meshes in files. */
#include "io/raw.h"

#include <string.h>

bw_status bwi_check_fields(bw_context *context, int64_t points, int64_t elements, int field_count,
                           const bw_field *fields) {
  for (int i = 0; i < field_count; i++) {
    const bw_field *field = &fields[i];
    bool nodes = field->place == BW_ON_NODES;
    int64_t expected = nodes ? points : elements;
    if (field->array->rows != expected || field->array->columns < 1)
      return bw_fail(context, BW_INVALID,
                     "field '%s' on %s has %lld rows of %lld numbers, but there are %lld %s",
                     field->name, nodes ? "nodes" : "elements", (long long)field->array->rows,
                     (long long)field->array->columns, (long long)expected,
                     nodes ? "nodes" : "elements");
  }
  return BW_OK;
}

bw_status bwi_array_rows(bw_context *context, const bw_array *from, int64_t rows,
                         const int32_t *row_from, bw_array **out) {
  bw_status status = bw_array_create(context, from->type, rows, from->columns, out);
  if (status != BW_OK)
    return status;
  size_t size = bw_type_size(from->type);
  for (int64_t r = 0; r < rows; r++)
    for (int64_t c = 0; c < from->columns; c++)
      memcpy((char *)(*out)->data + r * (*out)->row_stride + c * (*out)->column_stride,
             (const char *)from->data + row_from[r] * from->row_stride + c * from->column_stride,
             size);
  return BW_OK;
}
