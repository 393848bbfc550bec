/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which elements contribute to the blocks of a pattern (internal.h): by rows, from the elements
 * around their nodes. */
#include "assemble/internal.h"

#include <string.h>

/* Rows whose contributions stay in cache until they are summed. */
enum { ROWS_PER_CHUNK = 256 };

typedef struct rows {
  const bw_block_pattern *pattern;
  int nodes_per_element;
  const int32_t *element;
  bwi_incidence incidence;
  bwi_contributions *list; /* one for each thread, or one of all rows */
  int32_t *mark;           /* threads x node_count: index of a column in the row in work */
  int64_t *row_start;      /* node_count + 1: contributions before each row, of all rows; or NULL */
  bwi_contributions_body *body;
  void *data;
} rows;

/* Contributions to row i. */
static int64_t count_row(const rows *r, int64_t i) {
  int64_t count = 0;
  for (int64_t k = r->incidence.start[i]; k < r->incidence.start[i + 1]; k++) {
    const int32_t *node = r->element + (int64_t)r->incidence.element[k] * r->nodes_per_element;
    for (int a = 0; a < r->nodes_per_element; a++)
      count += node[a] <= i;
  }
  return count;
}

/* Row i, whose contributions are listed from `next` on; returns the end. */
static int64_t list_row(const rows *r, int64_t i, int64_t next, int32_t *mark,
                        bwi_contributions *list) {
  int n = r->nodes_per_element;
  const int32_t *column = r->pattern->column + r->pattern->start[i];
  int64_t *start = list->start + (r->pattern->start[i] - list->first);
  int64_t count = r->pattern->start[i + 1] - r->pattern->start[i];
  for (int64_t p = 0; p < count; p++) {
    mark[column[p]] = (int32_t)p;
    start[p] = 0;
  }
  /* counts, then starts, then, moved along by filling, the starts of the next blocks */
  for (int64_t k = r->incidence.start[i]; k < r->incidence.start[i + 1]; k++) {
    const int32_t *node = r->element + (int64_t)r->incidence.element[k] * n;
    for (int a = 0; a < n; a++)
      if (node[a] <= i)
        start[mark[node[a]]]++;
  }
  int64_t first = next;
  for (int64_t p = 0; p < count; p++) {
    int64_t here = start[p];
    start[p] = next;
    next += here;
  }
  for (int64_t k = r->incidence.start[i]; k < r->incidence.start[i + 1]; k++) {
    int32_t e = r->incidence.element[k];
    const int32_t *node = r->element + (int64_t)e * n;
    for (int a = 0; a < n; a++)
      if (node[a] <= i) {
        int64_t index = start[mark[node[a]]]++;
        list->element[index] = e;
        list->local[index] = (uint8_t)(r->incidence.local[k] << 4 | a);
      }
  }
  for (int64_t p = count - 1; p > 0; p--)
    start[p] = start[p - 1];
  start[0] = first;
  return next;
}

static bw_status list_rows(void *data, int64_t begin, int64_t end, int worker) {
  const rows *r = data;
  int32_t *mark = r->mark + (int64_t)worker * r->pattern->node_count;
  for (int64_t i = begin; i < end; i++)
    list_row(r, i, r->row_start[i], mark, r->list);
  return BW_OK;
}

static bw_status sum_rows(void *data, int64_t begin, int64_t end, int worker) {
  const rows *r = data;
  bwi_contributions *list = r->list + worker;
  int32_t *mark = r->mark + (int64_t)worker * r->pattern->node_count;
  list->first = r->pattern->start[begin];
  list->count = 0;
  for (int64_t i = begin; i < end; i++)
    list->count = list_row(r, i, list->count, mark, list);
  list->start[r->pattern->start[end] - list->first] = list->count;
  r->body(r->data, list, begin, end);
  return BW_OK;
}

static bw_status open_rows(bw_context *context, const bw_block_pattern *pattern,
                           int32_t element_count, int nodes_per_element, const int32_t *element,
                           rows *r) {
  *r = (rows){.pattern = pattern, .nodes_per_element = nodes_per_element, .element = element};
  r->mark = BW_NEW(context, int32_t, (int64_t)pattern->node_count * bw_threads(context));
  return r->mark ? bwi_incidence_of_elements(context, pattern->node_count, element_count,
                                             nodes_per_element, element, &r->incidence)
                 : BW_MEMORY;
}

static void close_rows(rows *r) {
  bwi_incidence_clear(&r->incidence);
  bw_free(r->mark);
  bw_free(r->row_start);
}

static bw_status reserve(bw_context *context, int64_t blocks, int64_t count,
                         bwi_contributions *list) {
  list->blocks = blocks;
  list->start = BW_NEW(context, int64_t, blocks + 1);
  list->element = BW_NEW(context, int32_t, count);
  list->local = BW_NEW(context, uint8_t, count);
  return list->start && list->element && list->local ? BW_OK : BW_MEMORY;
}

static void clear(bwi_contributions *list) {
  bw_free(list->start);
  bw_free(list->element);
  bw_free(list->local);
}

static void destroy(void *object) {
  clear(object);
  bw_free(object);
}

static size_t bytes(const void *object) {
  const bwi_contributions *list = object;
  return sizeof *list + (size_t)(list->blocks + 1) * sizeof *list->start +
         (size_t)list->count * (sizeof *list->element + sizeof *list->local);
}

static const bw_kind contributions_kind = {"contributions", destroy, bytes};

bw_status bwi_contributions_create(bw_context *context, const bw_block_pattern *pattern,
                                   int32_t element_count, int nodes_per_element,
                                   const int32_t *element, bwi_contributions **out) {
  bw_status status = BW_OK;
  rows r = {0};
  int64_t nodes = pattern->node_count;
  bwi_contributions *list = BW_NEW0(context, bwi_contributions, 1);
  if (!list)
    return BW_MEMORY;
  bw_object_init(list, &contributions_kind);
  BW_TRY(open_rows(context, pattern, element_count, nodes_per_element, element, &r));
  r.row_start = BW_NEW(context, int64_t, nodes + 1);
  if (!r.row_start) {
    status = BW_MEMORY;
    goto done;
  }
  for (int64_t i = 0; i < nodes; i++) {
    r.row_start[i] = list->count;
    list->count += count_row(&r, i);
  }
  BW_TRY(reserve(context, pattern->block_count, list->count, list));
  list->start[pattern->block_count] = list->count;
  r.list = list;
  BW_TRY(bw_parallel(context, nodes, ROWS_PER_CHUNK, list_rows, &r));
done:
  close_rows(&r);
  if (status == BW_OK)
    *out = list;
  else
    bw_release(list);
  return status;
}

bw_status bwi_for_contributions(bw_context *context, const bw_block_pattern *pattern,
                                const bw_mesh *mesh, bwi_contributions_body *body, void *data) {
  bw_status status = BW_OK;
  rows r = {0};
  int threads = bw_threads(context);
  int64_t nodes = pattern->node_count, blocks = 0, most = 0;
  BW_TRY(
      open_rows(context, pattern, mesh->element_count, mesh->nodes_per_element, mesh->element, &r));
  r.body = body;
  r.data = data;
  for (int64_t i = 0; i < nodes; i += ROWS_PER_CHUNK) {
    int64_t end = i + ROWS_PER_CHUNK < nodes ? i + ROWS_PER_CHUNK : nodes, count = 0;
    count = mesh->nodes_per_element * (r.incidence.start[end] - r.incidence.start[i]);
    most = count > most ? count : most;
    count = pattern->start[end] - pattern->start[i];
    blocks = count > blocks ? count : blocks;
  }
  r.list = BW_NEW0(context, bwi_contributions, threads);
  if (!r.list) {
    status = BW_MEMORY;
    goto done;
  }
  for (int t = 0; t < threads; t++)
    BW_TRY(reserve(context, blocks, most, &r.list[t]));
  BW_TRY(bw_parallel(context, nodes, ROWS_PER_CHUNK, sum_rows, &r));
done:
  for (int t = 0; r.list && t < threads; t++)
    clear(&r.list[t]);
  bw_free(r.list);
  close_rows(&r);
  return status;
}
