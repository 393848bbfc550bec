/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sparse systems given by entries: gathered into rows of the lower triangle, wrapped as a pattern
 * without a mesh, and handed to the ordering and the factor. */
#include "linear/sparse.h"

#include <string.h>

#include "linear/internal.h"

typedef struct rows {
  bw_block_pattern pattern; /* a view for the ordering and the factor; no object of its own */
  double *value;
} rows;

static void rows_clear(rows *r) {
  bw_free(r->pattern.start);
  bw_free(r->pattern.column);
  bw_free(r->pattern.upper_start);
  bw_free(r->pattern.upper_place);
  bw_free(r->pattern.upper_row);
  bw_free(r->value);
}

static void sort_row(int32_t *column, double *value, int64_t count) {
  for (int64_t i = 1; i < count; i++) {
    int32_t c = column[i];
    double v = value[i];
    int64_t k = i;
    for (; k > 0 && column[k - 1] > c; k--) {
      column[k] = column[k - 1];
      value[k] = value[k - 1];
    }
    column[k] = c;
    value[k] = v;
  }
}

/* Entries by row, those of one place added in the order given. */
static bw_status gather(bw_context *context, int64_t entries, const bwi_entry *entry, rows *r) {
  bw_status status = BW_OK;
  int32_t size = r->pattern.node_count;
  int64_t *first = BW_NEW0(context, int64_t, (size_t)size + 2);
  int64_t *order = BW_NEW(context, int64_t, entries), *seen = BW_NEW(context, int64_t, size);
  r->pattern.start = BW_NEW(context, int64_t, (size_t)size + 1);
  r->pattern.column = BW_NEW(context, int32_t, entries);
  r->value = BW_NEW(context, double, entries);
  if (!first || !order || !seen || !r->pattern.start || !r->pattern.column || !r->value) {
    status = BW_MEMORY;
    goto done;
  }
  for (int64_t i = 0; i < entries; i++) {
    int32_t row = entry[i].row > entry[i].column ? entry[i].row : entry[i].column;
    first[row + 2]++;
  }
  for (int32_t i = 0; i < size; i++) {
    first[i + 2] += first[i + 1];
    seen[i] = -1;
  }
  for (int64_t i = 0; i < entries; i++) {
    int32_t row = entry[i].row > entry[i].column ? entry[i].row : entry[i].column;
    order[first[row + 1]++] = i;
  }
  int64_t count = 0;
  for (int32_t row = 0; row < size; row++) {
    int64_t begin = r->pattern.start[row] = count;
    for (int64_t k = first[row]; k < first[row + 1]; k++) {
      const bwi_entry *e = &entry[order[k]];
      int32_t column = e->row > e->column ? e->column : e->row;
      if (seen[column] < begin) {
        seen[column] = count;
        r->pattern.column[count] = column;
        r->value[count++] = 0;
      }
      r->value[seen[column]] += e->value;
    }
    sort_row(r->pattern.column + begin, r->value + begin, count - begin);
    if (count == begin || r->pattern.column[count - 1] != row) {
      status = bw_fail(context, BW_INTERNAL, "row %d of a sparse system has no diagonal", row + 1);
      goto done;
    }
  }
  r->pattern.start[size] = r->pattern.block_count = count;
done:
  bw_free(first);
  bw_free(order);
  bw_free(seen);
  return status;
}

/* The blocks (k, i) with k > i, seen from i. */
static bw_status mirror(bw_context *context, rows *r) {
  bw_block_pattern *g = &r->pattern;
  int64_t above = g->block_count - g->node_count;
  g->upper_start = BW_NEW0(context, int64_t, (size_t)g->node_count + 2);
  g->upper_place = BW_NEW(context, int32_t, above);
  g->upper_row = BW_NEW(context, int32_t, above);
  if (!g->upper_start || !g->upper_place || !g->upper_row)
    return BW_MEMORY;
  for (int32_t i = 0; i < g->node_count; i++)
    for (int64_t k = g->start[i]; k < g->start[i + 1] - 1; k++)
      g->upper_start[g->column[k] + 2]++;
  for (int32_t i = 0; i < g->node_count; i++)
    g->upper_start[i + 2] += g->upper_start[i + 1];
  for (int32_t i = 0; i < g->node_count; i++)
    for (int64_t k = g->start[i]; k < g->start[i + 1] - 1; k++) {
      int64_t index = g->upper_start[g->column[k] + 1]++;
      g->upper_place[index] = (int32_t)(k - g->start[i]);
      g->upper_row[index] = i;
    }
  return BW_OK;
}

bw_status bwi_sparse_solve(bw_context *context, int32_t size, int64_t entries,
                           const bwi_entry *entry, int64_t count, double *x) {
  bw_status status = BW_OK;
  bwi_order *order = NULL;
  bwi_symbolic *symbolic = NULL;
  bwi_factor *factor = NULL;
  int32_t *unknown = NULL;
  rows r = {.pattern = {.node_count = size}};
  if (size == 0)
    return BW_OK;
  BW_TRY(gather(context, entries, entry, &r));
  BW_TRY(mirror(context, &r));
  unknown = BW_NEW0(context, int32_t, size);
  if (!unknown) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bwi_order_create(context, &r.pattern, NULL, &order));
  BW_TRY(bwi_symbolic_create(context, order, 1, unknown, &symbolic));
  bwi_matrix matrix = {.pattern = &r.pattern, .stiffness = r.value};
  BW_TRY(bwi_factor_create(context, symbolic, &matrix, &factor, NULL));
  BW_TRY(bwi_solve_fields(context, factor, NULL, count, x, x));
done:
  bw_release(factor);
  bw_release(symbolic);
  bw_release(order);
  bw_free(unknown);
  rows_clear(&r);
  return status;
}
