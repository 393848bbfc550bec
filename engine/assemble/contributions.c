/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Rows of a pattern from the elements around their nodes, and which elements contribute to its
 * blocks (internal.h). */
#include "assemble/internal.h"

#include <string.h>

bw_status bwi_row_sums_open(bw_context *context, const bw_block_pattern *pattern,
                            int32_t element_count, int nodes_per_element, const int32_t *element,
                            bwi_row_sums *rows) {
  *rows = (bwi_row_sums){
      .pattern = pattern, .nodes_per_element = nodes_per_element, .element = element};
  rows->place = BW_NEW(context, int32_t, (int64_t)pattern->node_count * bw_threads(context));
  return rows->place ? bwi_incidence_of_elements(context, pattern->node_count, element_count,
                                                 nodes_per_element, element, &rows->incidence)
                     : BW_MEMORY;
}

void bwi_row_sums_close(bwi_row_sums *rows) {
  bwi_incidence_clear(&rows->incidence);
  bw_free(rows->place);
}

/* ---- lists of contributions ---- */

typedef struct lister {
  bwi_row_sums rows;
  bwi_contributions *list;
} lister;

/* The contributions to each row, counted into the start of its first block. */
static bw_status count_rows(void *data, int64_t begin, int64_t end, int worker) {
  const lister *l = (const lister *)data;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    int64_t count = 0;
    for (int64_t k = l->rows.incidence.start[i]; k < l->rows.incidence.start[i + 1]; k++) {
      const int32_t *node = bwi_row_element(&l->rows, k);
      for (int a = 0; a < l->rows.nodes_per_element; a++)
        count += node[a] <= i;
    }
    l->list->start[l->rows.pattern->start[i]] = count;
  }
  return BW_OK;
}

/* Row i, whose contributions are listed from where its first block starts. */
static void list_row(const lister *l, int64_t i, int32_t *place) {
  const bwi_row_sums *r = &l->rows;
  bwi_contributions *list = l->list;
  int64_t *start = list->start + r->pattern->start[i], next = start[0], first = next;
  int64_t count = bwi_row_places(r, i, place);
  memset(start, 0, (size_t)count * sizeof *start);
  /* counts, then starts, then, moved along by filling, the starts of the next blocks */
  for (int64_t k = r->incidence.start[i]; k < r->incidence.start[i + 1]; k++) {
    const int32_t *node = bwi_row_element(r, k);
    for (int a = 0; a < r->nodes_per_element; a++)
      if (node[a] <= i)
        start[place[node[a]]]++;
  }
  for (int64_t p = 0; p < count; p++) {
    int64_t here = start[p];
    start[p] = next;
    next += here;
  }
  for (int64_t k = r->incidence.start[i]; k < r->incidence.start[i + 1]; k++) {
    const int32_t *node = bwi_row_element(r, k);
    for (int a = 0; a < r->nodes_per_element; a++)
      if (node[a] <= i) {
        int64_t index = start[place[node[a]]]++;
        list->element[index] = r->incidence.element[k];
        list->local[index] = (uint8_t)(r->incidence.local[k] << 4 | a);
      }
  }
  for (int64_t p = count - 1; p > 0; p--)
    start[p] = start[p - 1];
  start[0] = first;
}

static bw_status list_rows(void *data, int64_t begin, int64_t end, int worker) {
  const lister *l = (const lister *)data;
  int32_t *place = l->rows.place + (int64_t)worker * l->rows.pattern->node_count;
  for (int64_t i = begin; i < end; i++)
    list_row(l, i, place);
  return BW_OK;
}

static void destroy(void *object) {
  bwi_contributions *list = (bwi_contributions *)object;
  bw_free(list->start);
  bw_free(list->element);
  bw_free(list->local);
  bw_free(list);
}

static size_t bytes(const void *object) {
  const bwi_contributions *list = (const bwi_contributions *)object;
  return sizeof *list + (size_t)(list->blocks + 1) * sizeof *list->start +
         (size_t)list->count * (sizeof *list->element + sizeof *list->local);
}

static const bw_kind contributions_kind = {"contributions", destroy, bytes};

bw_status bwi_contributions_create(bw_context *context, const bw_block_pattern *pattern,
                                   int32_t element_count, int nodes_per_element,
                                   const int32_t *element, bwi_contributions **out) {
  bw_status status = BW_OK;
  lister l = {0};
  int64_t nodes = pattern->node_count, count = 0;
  bwi_contributions *list = BW_NEW0(context, bwi_contributions, 1);
  if (!list)
    return BW_MEMORY;
  bw_object_init(list, &contributions_kind);
  l.list = list;
  list->blocks = pattern->block_count;
  list->start = BW_NEW(context, int64_t, list->blocks + 1);
  BW_TRY_MEMORY(list->start);
  BW_TRY(bwi_row_sums_open(context, pattern, element_count, nodes_per_element, element, &l.rows));
  BW_TRY(bw_parallel(context, nodes, BWI_ROWS_PER_CHUNK, count_rows, &l));
  for (int64_t i = 0; i < nodes; i++) {
    int64_t here = list->start[pattern->start[i]];
    list->start[pattern->start[i]] = count;
    count += here;
  }
  list->start[list->blocks] = list->count = count;
  list->element = BW_NEW(context, int32_t, count);
  list->local = BW_NEW(context, uint8_t, count);
  BW_TRY_MEMORY(list->element && list->local);
  BW_TRY(bw_parallel(context, nodes, BWI_ROWS_PER_CHUNK, list_rows, &l));
done:
  bwi_row_sums_close(&l.rows);
  if (status == BW_OK)
    *out = list;
  else
    bw_release(list);
  return status;
}
