/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The block sparsity pattern of a plane mesh: nodes i and j share an element.
 *
 * Invariants: row i holds all its columns in ascending order; diagonal[i] is the place of (i, i) in
 * it; mirror[mirror[p]] == p, and mirror[p] == p on the diagonal alone. The contributions
 * gather_start[p].. of block p are in ascending order of elements: summed in this order, a value
 * has the same bits whichever thread sums it. A node of no element has its diagonal block, without
 * contributions. */
#include <string.h>

#include "assemble/plane_matrix.h"
#include "base/sort.h"

static void destroy(void *object) {
  bw_plane_pattern *pattern = object;
  bw_release(pattern->topology);
  bw_free(pattern->start);
  bw_free(pattern->column);
  bw_free(pattern->diagonal);
  bw_free(pattern->mirror);
  bw_free(pattern->gather_start);
  bw_free(pattern->gather_element);
  bw_free(pattern->gather_local);
  bw_free(pattern);
}

static size_t bytes(const void *object) {
  const bw_plane_pattern *pattern = object;
  size_t nodes = (size_t)pattern->node_count, blocks = (size_t)pattern->block_count;
  return sizeof *pattern + (2 * nodes + 1) * 8 + blocks * (4 + 8 + 8) + 8 +
         (size_t)pattern->gather_start[blocks] * 5;
}

static const bw_kind kind = {"plane pattern", destroy, bytes};

typedef struct builder {
  bw_plane_pattern *pattern;
  const int32_t *element;
  int n;                /* nodes of an element */
  int64_t *around;      /* node_count + 1: elements around each node, */
  int32_t *around_item; /* ascending, as element * n + local node, which fits (graph_create) */
  int32_t *mark;        /* workers x node_count */
} builder;

static bw_status list_elements(bw_context *context, builder *b) {
  int32_t nodes = b->pattern->node_count;
  int64_t total = (int64_t)b->pattern->topology->element_count * b->n;
  b->around = BW_NEW0(context, int64_t, (size_t)nodes + 2);
  b->around_item = BW_NEW(context, int32_t, total);
  if (!b->around || !b->around_item)
    return BW_MEMORY;
  /* Counted two places up; filling moves each start to where the next one is. */
  for (int64_t k = 0; k < total; k++)
    b->around[b->element[k] + 2]++;
  for (int32_t i = 0; i < nodes; i++)
    b->around[i + 2] += b->around[i + 1];
  for (int64_t k = 0; k < total; k++)
    b->around_item[b->around[b->element[k] + 1]++] = (int32_t)k;
  return BW_OK;
}

/* Columns of each row, counted into start[i + 1]. mark[j] is one more than the last row that saw
 * j. */
static bw_status count_rows(void *data, int64_t begin, int64_t end, int worker) {
  const builder *b = data;
  int32_t *mark = b->mark + (int64_t)worker * b->pattern->node_count;
  for (int64_t i = begin; i < end; i++) {
    int64_t columns = 1;
    mark[i] = (int32_t)i + 1;
    for (int64_t k = b->around[i]; k < b->around[i + 1]; k++) {
      const int32_t *node = b->element + b->around_item[k] / b->n * b->n;
      for (int a = 0; a < b->n; a++) {
        columns += mark[node[a]] != (int32_t)i + 1;
        mark[node[a]] = (int32_t)i + 1;
      }
    }
    b->pattern->start[i + 1] = columns;
  }
  return BW_OK;
}

/* Columns of each row, and how many contributions each block has, counted into gather_start[p + 1].
 * mark[j] is the index of column j, valid where that index is of this row and holds j. */
static bw_status fill_columns(void *data, int64_t begin, int64_t end, int worker) {
  const builder *b = data;
  bw_plane_pattern *pattern = b->pattern;
  int32_t *mark = b->mark + (int64_t)worker * pattern->node_count;
  for (int64_t i = begin; i < end; i++) {
    int32_t *column = pattern->column + pattern->start[i];
    int64_t *count = pattern->gather_start + pattern->start[i] + 1;
    int32_t columns = 1;
    column[0] = (int32_t)i;
    mark[i] = 0;
    for (int64_t k = b->around[i]; k < b->around[i + 1]; k++) {
      const int32_t *node = b->element + b->around_item[k] / b->n * b->n;
      for (int a = 0; a < b->n; a++) {
        int32_t m = mark[node[a]];
        if (m < 0 || m >= columns || column[m] != node[a]) {
          mark[node[a]] = columns;
          column[columns++] = node[a];
        }
      }
    }
    bwi_sort_columns(column, columns);
    memset(count, 0, (size_t)columns * sizeof *count);
    for (int32_t c = 0; c < columns; c++) {
      mark[column[c]] = c;
      if (column[c] == i)
        pattern->diagonal[i] = pattern->start[i] + c;
    }
    for (int64_t k = b->around[i]; k < b->around[i + 1]; k++) {
      const int32_t *node = b->element + b->around_item[k] / b->n * b->n;
      for (int a = 0; a < b->n; a++)
        count[mark[node[a]]]++;
    }
  }
  return BW_OK;
}

int64_t bwi_plane_block_index(const bw_plane_pattern *pattern, int32_t row, int32_t column) {
  return bwi_sorted_index(pattern->column, pattern->start[row], pattern->start[row + 1], column);
}

/* gather_start is complete: fill contributions and mirrors. mark[j] is where the next contribution
 * of column j goes, less the first of the row. */
static bw_status fill_contributions(void *data, int64_t begin, int64_t end, int worker) {
  const builder *b = data;
  bw_plane_pattern *pattern = b->pattern;
  int32_t *mark = b->mark + (int64_t)worker * pattern->node_count;
  for (int64_t i = begin; i < end; i++) {
    int64_t first = pattern->gather_start[pattern->start[i]];
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++) {
      mark[pattern->column[p]] = (int32_t)(pattern->gather_start[p] - first);
      pattern->mirror[p] = bwi_plane_block_index(pattern, pattern->column[p], (int32_t)i);
    }
    for (int64_t k = b->around[i]; k < b->around[i + 1]; k++) {
      int32_t e = b->around_item[k] / b->n, a = b->around_item[k] % b->n;
      for (int c = 0; c < b->n; c++) {
        int64_t index = first + mark[b->element[(int64_t)e * b->n + c]]++;
        pattern->gather_element[index] = e;
        pattern->gather_local[index] = (uint8_t)(a * 6 + c);
      }
    }
  }
  return BW_OK;
}

bw_status bw_plane_pattern_create(bw_context *context, const bw_plane_topology *topology,
                                  bw_plane_pattern **out) {
  bw_status status = BW_OK;
  builder b = {.element = topology->element, .n = bwi_nodes_per_element(topology)};
  int32_t nodes = topology->nodes->node_count;
  if (topology->element_count > INT32_MAX / b.n)
    return bw_fail(context, BW_LIMIT, "%d triangles are more than a matrix on them can number",
                   topology->element_count);
  bw_plane_pattern *pattern = b.pattern = BW_NEW0(context, bw_plane_pattern, 1);
  if (!pattern)
    return BW_MEMORY;
  bw_object_init(pattern, &kind);
  pattern->topology = bw_retain(topology);
  pattern->node_count = nodes;
  pattern->start = BW_NEW0(context, int64_t, (size_t)nodes + 1);
  pattern->diagonal = BW_NEW(context, int64_t, nodes);
  pattern->gather_start = BW_NEW0(context, int64_t, 1); /* until there are blocks: for bytes() */
  b.mark = BW_NEW0(context, int32_t, (size_t)bw_threads(context) * (size_t)nodes);
  BW_TRY_MEMORY(pattern->start && pattern->diagonal && pattern->gather_start && b.mark);
  BW_TRY(list_elements(context, &b));
  BW_TRY(bw_parallel(context, nodes, BWI_GRAIN_NODES, count_rows, &b));
  for (int32_t i = 0; i < nodes; i++)
    pattern->start[i + 1] += pattern->start[i];
  int64_t blocks = pattern->start[nodes];
  bw_free(pattern->gather_start);
  pattern->column = BW_NEW(context, int32_t, blocks);
  pattern->mirror = BW_NEW(context, int64_t, blocks);
  pattern->gather_start = BW_NEW0(context, int64_t, blocks + 1);
  int64_t contributions = (int64_t)topology->element_count * b.n * b.n;
  pattern->gather_element = BW_NEW(context, int32_t, contributions);
  pattern->gather_local = BW_NEW(context, uint8_t, contributions);
  BW_TRY_MEMORY(pattern->column && pattern->mirror && pattern->gather_start &&
                pattern->gather_element && pattern->gather_local);
  pattern->block_count = blocks;
  BW_TRY(bw_check_cancel(context));
  BW_TRY(bw_parallel(context, nodes, BWI_GRAIN_NODES, fill_columns, &b));
  for (int64_t p = 0; p < blocks; p++)
    pattern->gather_start[p + 1] += pattern->gather_start[p];
  BW_TRY(bw_parallel(context, nodes, BWI_GRAIN_NODES, fill_contributions, &b));
done:
  bw_free(b.around);
  bw_free(b.around_item);
  bw_free(b.mark);
  if (status == BW_OK)
    *out = pattern;
  else
    bw_release(pattern);
  return status;
}

/* ---- product ------------------------------------------------------------------------------- */

typedef struct product {
  const bw_plane_pattern *pattern;
  const double *values, *x;
  double *y;
} product;

/* One row of blocks; C is a constant wherever this is expanded. */
static inline __attribute__((always_inline)) void rows_times(const product *m, int64_t begin,
                                                             int64_t end, int C) {
  const bw_plane_pattern *pattern = m->pattern;
  for (int64_t i = begin; i < end; i++) {
    double sum[BWI_MAX_COMPONENTS] = {0};
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++) {
      const double *a = m->values + C * C * p, *x = m->x + C * (int64_t)pattern->column[p];
      for (int r = 0; r < C; r++)
        for (int c = 0; c < C; c++)
          sum[r] += a[C * r + c] * x[c];
    }
    for (int r = 0; r < C; r++)
      m->y[C * i + r] = sum[r];
  }
}

#define ROWS(C)                                                                                    \
  static bw_status rows_##C(void *data, int64_t begin, int64_t end, int worker) {                  \
    (void)worker;                                                                                  \
    rows_times(data, begin, end, C);                                                               \
    return BW_OK;                                                                                  \
  }
ROWS(1)
ROWS(2)
ROWS(3)
ROWS(4)

bw_status bw_plane_multiply(bw_context *context, const bw_plane_pattern *pattern, int components,
                            const double *values, const double *x, double *y) {
  static bw_body *const body[] = {rows_1, rows_2, rows_3, rows_4};
  product m = {pattern, values, x, y};
  if (components < 1 || components > BWI_MAX_COMPONENTS)
    return bw_fail(context, BW_INVALID, "%d components at a node; 1 to %d are possible", components,
                   BWI_MAX_COMPONENTS);
  return bw_parallel(context, pattern->node_count, BWI_GRAIN_NODES, body[components - 1], &m);
}
