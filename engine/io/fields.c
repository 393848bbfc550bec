/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The fields handed to a writer. */
#include "io/raw.h"

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
