/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The graph of the nodes of a plane mesh that share an element.
 *
 * Invariants: row i holds all its columns in ascending order; diagonal[i] is the place of (i, i) in
 * it; mirror[mirror[p]] == p, and mirror[p] == p on the diagonal alone. The contributions
 * gather_start[p].. of pair p are in ascending order of elements: summed in this order, a value has
 * the same bits whichever thread sums it. A node of no element has its diagonal pair, without
 * contributions. */
#include <string.h>

#include "base/sort.h"
#include "responsive/internal.h"

static void destroy(void *object) {
  bw_plane_graph *graph = object;
  bw_release(graph->topology);
  bw_free(graph->start);
  bw_free(graph->column);
  bw_free(graph->diagonal);
  bw_free(graph->mirror);
  bw_free(graph->gather_start);
  bw_free(graph->gather_element);
  bw_free(graph->gather_local);
  bw_free(graph);
}

static size_t bytes(const void *object) {
  const bw_plane_graph *graph = object;
  size_t nodes = (size_t)graph->node_count, pairs = (size_t)graph->pair_count;
  return sizeof *graph + (2 * nodes + 1) * 8 + pairs * (4 + 8 + 8) + 8 +
         (size_t)graph->gather_start[pairs] * 5;
}

static const bw_kind kind = {"plane graph", destroy, bytes};

typedef struct builder {
  bw_plane_graph *graph;
  const int32_t *element;
  int n;                /* nodes of an element */
  int64_t *around;      /* node_count + 1: elements around each node, */
  int32_t *around_item; /* ascending, as element * n + local node, which fits (graph_create) */
  int32_t *mark;        /* workers x node_count */
} builder;

static bw_status list_elements(bw_context *context, builder *b) {
  int32_t nodes = b->graph->node_count;
  int64_t total = (int64_t)b->graph->topology->element_count * b->n;
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

/* Columns of each row, counted into start[i + 1]. mark[j] is one more than the last row that saw j.
 */
static bw_status count_rows(void *data, int64_t begin, int64_t end, int worker) {
  const builder *b = data;
  int32_t *mark = b->mark + (int64_t)worker * b->graph->node_count;
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
    b->graph->start[i + 1] = columns;
  }
  return BW_OK;
}

/* Columns of each row, and how many contributions each pair has, counted into gather_start[p + 1].
 * mark[j] is the place of column j, good where that place is of this row and holds j. */
static bw_status fill_columns(void *data, int64_t begin, int64_t end, int worker) {
  const builder *b = data;
  bw_plane_graph *graph = b->graph;
  int32_t *mark = b->mark + (int64_t)worker * graph->node_count;
  for (int64_t i = begin; i < end; i++) {
    int32_t *column = graph->column + graph->start[i];
    int64_t *count = graph->gather_start + graph->start[i] + 1;
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
        graph->diagonal[i] = graph->start[i] + c;
    }
    for (int64_t k = b->around[i]; k < b->around[i + 1]; k++) {
      const int32_t *node = b->element + b->around_item[k] / b->n * b->n;
      for (int a = 0; a < b->n; a++)
        count[mark[node[a]]]++;
    }
  }
  return BW_OK;
}

int64_t bwi_plane_pair(const bw_plane_graph *graph, int32_t row, int32_t column) {
  return bwi_sorted_place(graph->column, graph->start[row], graph->start[row + 1], column);
}

/* gather_start is complete: fill contributions and mirrors. mark[j] is where the next contribution
 * of column j goes, less the first of the row. */
static bw_status fill_contributions(void *data, int64_t begin, int64_t end, int worker) {
  const builder *b = data;
  bw_plane_graph *graph = b->graph;
  int32_t *mark = b->mark + (int64_t)worker * graph->node_count;
  for (int64_t i = begin; i < end; i++) {
    int64_t first = graph->gather_start[graph->start[i]];
    for (int64_t p = graph->start[i]; p < graph->start[i + 1]; p++) {
      mark[graph->column[p]] = (int32_t)(graph->gather_start[p] - first);
      graph->mirror[p] = bwi_plane_pair(graph, graph->column[p], (int32_t)i);
    }
    for (int64_t k = b->around[i]; k < b->around[i + 1]; k++) {
      int32_t e = b->around_item[k] / b->n, a = b->around_item[k] % b->n;
      for (int c = 0; c < b->n; c++) {
        int64_t place = first + mark[b->element[(int64_t)e * b->n + c]]++;
        graph->gather_element[place] = e;
        graph->gather_local[place] = (uint8_t)(a * 6 + c);
      }
    }
  }
  return BW_OK;
}

bw_status bw_plane_graph_create(bw_context *context, const bw_plane_topology *topology,
                                bw_plane_graph **out) {
  bw_status status = BW_OK;
  builder b = {.element = topology->element, .n = bwi_nodes_per_element(topology)};
  int32_t nodes = topology->nodes->node_count;
  if (topology->element_count > INT32_MAX / b.n)
    return bw_fail(context, BW_LIMIT, "%d triangles are more than a matrix on them can number",
                   topology->element_count);
  bw_plane_graph *graph = b.graph = BW_NEW0(context, bw_plane_graph, 1);
  if (!graph)
    return BW_MEMORY;
  bw_object_init(graph, &kind);
  graph->topology = bw_retain(topology);
  graph->node_count = nodes;
  graph->start = BW_NEW0(context, int64_t, (size_t)nodes + 1);
  graph->diagonal = BW_NEW(context, int64_t, nodes);
  graph->gather_start = BW_NEW0(context, int64_t, 1); /* until there are pairs: for bytes() */
  b.mark = BW_NEW0(context, int32_t, (size_t)bw_threads(context) * (size_t)nodes);
  if (!graph->start || !graph->diagonal || !graph->gather_start || !b.mark) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(list_elements(context, &b));
  BW_TRY(bw_parallel(context, nodes, BWI_GRAIN_NODES, count_rows, &b));
  for (int32_t i = 0; i < nodes; i++)
    graph->start[i + 1] += graph->start[i];
  int64_t pairs = graph->start[nodes];
  bw_free(graph->gather_start);
  graph->column = BW_NEW(context, int32_t, pairs);
  graph->mirror = BW_NEW(context, int64_t, pairs);
  graph->gather_start = BW_NEW0(context, int64_t, pairs + 1);
  int64_t contributions = (int64_t)topology->element_count * b.n * b.n;
  graph->gather_element = BW_NEW(context, int32_t, contributions);
  graph->gather_local = BW_NEW(context, uint8_t, contributions);
  if (!graph->column || !graph->mirror || !graph->gather_start || !graph->gather_element ||
      !graph->gather_local) {
    status = BW_MEMORY;
    goto done;
  }
  graph->pair_count = pairs;
  BW_TRY(bw_check_cancel(context));
  BW_TRY(bw_parallel(context, nodes, BWI_GRAIN_NODES, fill_columns, &b));
  for (int64_t p = 0; p < pairs; p++)
    graph->gather_start[p + 1] += graph->gather_start[p];
  BW_TRY(bw_parallel(context, nodes, BWI_GRAIN_NODES, fill_contributions, &b));
done:
  bw_free(b.around);
  bw_free(b.around_item);
  bw_free(b.mark);
  if (status == BW_OK)
    *out = graph;
  else
    bw_release(graph);
  return status;
}

/* ---- product ------------------------------------------------------------------------------- */

typedef struct product {
  const bw_plane_graph *graph;
  const double *values, *x;
  double *y;
} product;

/* One row of blocks; C is a constant wherever this is expanded. */
static inline __attribute__((always_inline)) void rows_times(const product *m, int64_t begin,
                                                             int64_t end, int C) {
  const bw_plane_graph *graph = m->graph;
  for (int64_t i = begin; i < end; i++) {
    double sum[BWI_MAX_COMPONENTS] = {0};
    for (int64_t p = graph->start[i]; p < graph->start[i + 1]; p++) {
      const double *a = m->values + C * C * p, *x = m->x + C * (int64_t)graph->column[p];
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

bw_status bw_plane_multiply(bw_context *context, const bw_plane_graph *graph, int components,
                            const double *values, const double *x, double *y) {
  static bw_body *const body[] = {rows_1, rows_2, rows_3, rows_4};
  product m = {graph, values, x, y};
  if (components < 1 || components > BWI_MAX_COMPONENTS)
    return bw_fail(context, BW_INVALID, "%d components at a node; 1 to %d are possible", components,
                   BWI_MAX_COMPONENTS);
  return bw_parallel(context, graph->node_count, BWI_GRAIN_NODES, body[components - 1], &m);
}
