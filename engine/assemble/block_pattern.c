/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The block sparsity pattern: nodes i and j share an element.
 *
 * Invariants: row i holds its columns j <= i in ascending order, the diagonal last. From
 * upper_start[i] on, upper_row and upper_place list the blocks (k, i) with k > i, k ascending. */
#include "assemble/internal.h"
#include "base/sort.h"

#include <assert.h>
#include <string.h>

enum { ROWS_PER_CHUNK = 512 };

static void destroy(void *object) {
  bw_block_pattern *pattern = (bw_block_pattern *)object;
  bw_release(pattern->mesh);
  bw_free(pattern->start);
  bw_free(pattern->column);
  bw_free(pattern->upper_start);
  bw_free(pattern->upper_place);
  bw_free(pattern->upper_row);
  bw_free(pattern);
}

static size_t bytes(const void *object) {
  const bw_block_pattern *pattern = (const bw_block_pattern *)object;
  size_t nodes = (size_t)pattern->node_count + 1, blocks = (size_t)pattern->block_count;
  return sizeof *pattern + 2 * nodes * sizeof(int64_t) + blocks * sizeof(int32_t) +
         (blocks + 1 - nodes) * 2 * sizeof(int32_t);
}

static const bw_kind pattern_kind = {"pattern", destroy, bytes};

bw_status bwi_incidence_of_elements(bw_context *context, int32_t node_count, int32_t element_count,
                                    int nodes_per_element, const int32_t *element,
                                    bwi_incidence *incidence) {
  int64_t total = (int64_t)element_count * nodes_per_element;
  memset(incidence, 0, sizeof *incidence);
  int64_t *start = incidence->start = BW_NEW0(context, int64_t, (int64_t)node_count + 1);
  incidence->element = BW_NEW(context, int32_t, total);
  incidence->local = BW_NEW(context, uint8_t, total);
  if (!incidence->start || !incidence->element || !incidence->local) {
    bwi_incidence_clear(incidence);
    return BW_MEMORY;
  }
  /* Counted into start[i + 1]; then start[i] is where node i writes next, and in the end where node
   * i + 1 starts, so that one shift puts it right. */
  for (int64_t k = 0; k < total; k++)
    start[element[k] + 1]++;
  for (int32_t i = 0; i < node_count; i++)
    start[i + 1] += start[i];
  for (int32_t e = 0; e < element_count; e++)
    for (int a = 0; a < nodes_per_element; a++) {
      int64_t index = start[element[(int64_t)e * nodes_per_element + a]]++;
      incidence->element[index] = e;
      incidence->local[index] = (uint8_t)a;
    }
  memmove(start + 1, start, (size_t)node_count * sizeof *start);
  start[0] = 0;
  return BW_OK;
}

bw_status bwi_incidence_create(bw_context *context, const bw_mesh *mesh, bwi_incidence *incidence) {
  return bwi_incidence_of_elements(context, mesh->node_count, mesh->element_count,
                                   mesh->nodes_per_element, mesh->element, incidence);
}

void bwi_incidence_clear(bwi_incidence *incidence) {
  bw_free(incidence->start);
  bw_free(incidence->element);
  bw_free(incidence->local);
  memset(incidence, 0, sizeof *incidence);
}

typedef struct builder {
  int nodes_per_element;
  const int32_t *element; /* elements x nodes_per_element */
  bwi_incidence incidence;
  bw_block_pattern *pattern;
  int32_t *mark; /* threads x node_count: see count_rows and fill_rows */
} builder;

/* Count columns into start[i + 1]. Here mark[j] is one more than the last row that saw j. */
static bw_status count_rows(void *data, int64_t begin, int64_t end, int worker) {
  builder *b = (builder *)data;
  int n = b->nodes_per_element;
  int32_t *mark = b->mark + (int64_t)worker * b->pattern->node_count;
  for (int64_t i = begin; i < end; i++) {
    int64_t columns = 0;
    for (int64_t k = b->incidence.start[i]; k < b->incidence.start[i + 1]; k++) {
      const int32_t *node = b->element + (int64_t)b->incidence.element[k] * n;
      for (int a = 0; a < n; a++)
        if (node[a] <= i) {
          columns += mark[node[a]] != i + 1;
          mark[node[a]] = (int32_t)(i + 1);
        }
    }
    b->pattern->start[i + 1] = columns;
  }
  return BW_OK;
}

/* Fill the columns of rows. Here mark[j] is the index of column j in the row, if that entry is
 * filled and holds j; anything may stand in mark before. */
static bw_status fill_rows(void *data, int64_t begin, int64_t end, int worker) {
  builder *b = (builder *)data;
  bw_block_pattern *pattern = b->pattern;
  int n = b->nodes_per_element;
  int32_t *mark = b->mark + (int64_t)worker * b->pattern->node_count;
  for (int64_t i = begin; i < end; i++) {
    int32_t *column = pattern->column + pattern->start[i];
    int32_t count = 0;
    for (int64_t k = b->incidence.start[i]; k < b->incidence.start[i + 1]; k++) {
      const int32_t *node = b->element + (int64_t)b->incidence.element[k] * n;
      for (int a = 0; a < n; a++) {
        int32_t j = node[a], index = mark[j];
        if (j > i || (index >= 0 && index < count && column[index] == j))
          continue;
        mark[j] = count;
        column[count++] = j;
      }
    }
    bwi_sort_columns(column, count);
  }
  return BW_OK;
}

static bw_status fill_upper(bw_context *context, bw_block_pattern *pattern) {
  int64_t count = pattern->block_count - pattern->node_count;
  int64_t *start = pattern->upper_start =
      BW_NEW0(context, int64_t, (int64_t)pattern->node_count + 1);
  pattern->upper_place = BW_NEW(context, int32_t, count);
  pattern->upper_row = BW_NEW(context, int32_t, count);
  if (!pattern->upper_start || !pattern->upper_place || !pattern->upper_row)
    return BW_MEMORY;
  for (int32_t i = 0; i < pattern->node_count; i++)
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1] - 1; p++)
      start[pattern->column[p] + 1]++;
  for (int32_t i = 0; i < pattern->node_count; i++)
    start[i + 1] += start[i];
  for (int32_t i = 0; i < pattern->node_count; i++)
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1] - 1; p++) {
      int64_t index = start[pattern->column[p]]++;
      pattern->upper_place[index] = (int32_t)(p - pattern->start[i]);
      pattern->upper_row[index] = i;
    }
  memmove(start + 1, start, (size_t)pattern->node_count * sizeof *start);
  start[0] = 0;
  return BW_OK;
}

#ifndef NDEBUG
/* The invariants at the top of this file. */
static bool is_ordered(const bw_block_pattern *pattern) {
  for (int64_t i = 0; i < pattern->node_count; i++) {
    int64_t end = pattern->start[i + 1];
    if (end <= pattern->start[i] || pattern->column[end - 1] != i)
      return false;
    for (int64_t p = pattern->start[i]; p + 1 < end; p++)
      if (pattern->column[p] < 0 || pattern->column[p] >= pattern->column[p + 1])
        return false;
    for (int64_t k = pattern->upper_start[i]; k < pattern->upper_start[i + 1]; k++)
      if (pattern->column[bw_upper_block(pattern, k)] != i || pattern->upper_row[k] <= i ||
          (k > pattern->upper_start[i] && pattern->upper_row[k] <= pattern->upper_row[k - 1]))
        return false;
  }
  return pattern->start[pattern->node_count] == pattern->block_count;
}
#endif

bw_status bw_block_pattern_of_elements(bw_context *context, int32_t node_count,
                                       int32_t element_count, int nodes_per_element,
                                       const int32_t *element, bw_block_pattern **pattern) {
  bw_status status = BW_OK;
  builder b = {.nodes_per_element = nodes_per_element, .element = element};
  int64_t nodes = node_count;
  bw_block_pattern *g = BW_NEW0(context, bw_block_pattern, 1);
  if (!g)
    return BW_MEMORY;
  bw_object_init(g, &pattern_kind);
  g->node_count = node_count;
  b.pattern = g;

  BW_TRY(bwi_incidence_of_elements(context, node_count, element_count, nodes_per_element, element,
                                   &b.incidence));
  b.mark = BW_NEW0(context, int32_t, nodes * bw_threads(context));
  g->start = BW_NEW0(context, int64_t, nodes + 1);
  BW_TRY_MEMORY(b.mark && g->start);
  BW_TRY(bw_parallel(context, nodes, ROWS_PER_CHUNK, count_rows, &b));
  for (int64_t i = 0; i < nodes; i++)
    g->start[i + 1] += g->start[i];
  g->block_count = g->start[nodes];
  g->column = BW_NEW(context, int32_t, g->block_count);
  BW_TRY_MEMORY(g->column);
  BW_TRY(bw_check_cancel(context));
  BW_TRY(bw_parallel(context, nodes, ROWS_PER_CHUNK, fill_rows, &b));
  BW_TRY(fill_upper(context, g));
  assert(is_ordered(g));
  *pattern = g;
  g = NULL;
done:
  bwi_incidence_clear(&b.incidence);
  bw_free(b.mark);
  bw_release(g);
  return status;
}

bw_status bwi_block_pattern_of_rows(bw_context *context, int32_t node_count, int64_t *start,
                                    int32_t *column, bw_block_pattern **pattern) {
  bw_status status = BW_OK;
  bw_block_pattern *g = BW_NEW0(context, bw_block_pattern, 1);
  if (!g)
    return BW_MEMORY;
  bw_object_init(g, &pattern_kind);
  g->node_count = node_count;
  g->block_count = start[node_count];
  g->start = start;
  g->column = column;
  status = fill_upper(context, g);
  if (status == BW_OK) {
    assert(is_ordered(g));
    *pattern = g;
  } else {
    g->start = NULL;
    g->column = NULL;
    g->block_count = 0;
    bw_release(g);
  }
  return status;
}

bw_status bw_block_pattern_create(bw_context *context, const bw_mesh *mesh,
                                  bw_block_pattern **pattern) {
  bw_status status = bw_block_pattern_of_elements(context, mesh->node_count, mesh->element_count,
                                                  mesh->nodes_per_element, mesh->element, pattern);
  if (status == BW_OK)
    (*pattern)->mesh = (const bw_mesh *)bw_retain(mesh);
  return status;
}

bw_status bwi_block_pattern_fits(bw_context *context, const bw_block_pattern *pattern,
                                 const bw_mesh *mesh) {
  const bw_mesh *own = pattern->mesh;
  if (!own)
    return bw_fail(context, BW_INVALID,
                   "the pattern was made of element lists, not of a mesh; create a pattern of this "
                   "mesh");
  if (mesh == own || mesh->element == own->element)
    return BW_OK;
  if (mesh->node_count == own->node_count && mesh->element_count == own->element_count &&
      mesh->nodes_per_element == own->nodes_per_element)
    return BW_OK;
  return bw_fail(
      context, BW_INVALID,
      "the pattern belongs to a mesh of %d nodes and %d elements of %d nodes, not to this "
      "one of %d nodes and %d elements of %d nodes; create a pattern of this mesh",
      own->node_count, own->element_count, own->nodes_per_element, mesh->node_count,
      mesh->element_count, mesh->nodes_per_element);
}

void bwi_block_pattern_mark_surface(const bw_block_pattern *pattern, const bw_mesh *mesh,
                                    uint8_t *surface) {
  int n = mesh->nodes_per_facet;
  for (int64_t f = 0; f < mesh->facet_count; f++)
    for (int a = 0; a < n; a++)
      for (int b = 0; b < n; b++) {
        int32_t row = mesh->facet[f * n + a], column = mesh->facet[f * n + b];
        if (column >= row)
          continue;
        surface[bwi_sorted_index(pattern->column, pattern->start[row], pattern->start[row + 1],
                                 column)] = 1;
      }
}
