/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Numbers of a mesh from a file. A mesh generator numbers points as it inserts them, or mid-edge
 * nodes behind all corners: the rows of one element are then far apart in memory, and assembly,
 * products and smoothers wait for it. Along a space-filling curve they are near.
 *
 * The span of an element is the largest difference of its nodes' numbers. The mean of the
 * logarithms of the spans is compared, since a curve has a few long jumps too. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/sort.h"
#include "io/raw.h"

/* Meshes of fewer elements fit the cache in any order. Spans that are shorter than this many times
 * those along the curve gain nothing that can be measured (docs/benchmarks.md). */
enum { SMALL = 20000 };
#define MIN_SPAN_RATIO 4.0

/* Geometric mean of the spans of the elements. */
static double mean_span(const bw_mesh *mesh) {
  double sum = 0;
  for (int64_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + e * mesh->nodes_per_element;
    int32_t min = node[0], max = node[0];
    for (int a = 1; a < mesh->nodes_per_element; a++) {
      min = node[a] < min ? node[a] : min;
      max = node[a] > max ? node[a] : max;
    }
    sum += log((double)max - min);
  }
  return exp(sum / (double)mesh->element_count);
}

/* to[old] = new. */
static void invert(int64_t count, const int32_t *from, int32_t *to) {
  for (int64_t i = 0; i < count; i++)
    to[from[i]] = (int32_t)i;
}

static void renumber_sets(bw_mesh_file *file, const int32_t *new_node, const int32_t *new_element) {
  for (int i = 0; i < file->set_count; i++) {
    bw_named_set *set = &file->set[i];
    const int32_t *to = set->of_elements ? new_element : new_node;
    for (int64_t k = 0; k < set->count; k++)
      set->member[k] = to[set->member[k]];
    bwi_sort_columns(set->member, set->count);
  }
}

bw_status bw_mesh_file_renumber(bw_context *context, bw_mesh_file *file, bw_renumber when) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = file->mesh;
  bw_mesh *renumbered = NULL;
  int32_t *node_from = NULL, *element_from = NULL, *new_node = NULL, *new_element = NULL;
  bw_array **array = NULL;
  if (when == BW_RENUMBER_NEVER || (when == BW_RENUMBER_AUTO && mesh->element_count < SMALL))
    return BW_OK;
  BW_TRY(bw_mesh_renumbered(context, mesh, &node_from, &element_from, &renumbered));
  double ratio = mean_span(mesh) / mean_span(renumbered);
  if (when == BW_RENUMBER_AUTO && !(ratio >= MIN_SPAN_RATIO))
    goto done;
  new_node = BW_NEW(context, int32_t, mesh->node_count);
  new_element = BW_NEW(context, int32_t, mesh->element_count);
  array = BW_NEW0(context, bw_array *, file->field_count + 1);
  BW_TRY_MEMORY(new_node && new_element && array);
  for (int i = 0; i < file->field_count; i++)
    BW_TRY(bwi_array_rows(context, file->field_array[i], file->field_array[i]->rows,
                          file->field_place[i] == BW_ON_NODES ? node_from : element_from,
                          &array[i]));
  /* Nothing fails from here on. */
  invert(mesh->node_count, node_from, new_node);
  invert(mesh->element_count, element_from, new_element);
  renumber_sets(file, new_node, new_element);
  for (int i = 0; i < file->field_count; i++) {
    bw_array *old = file->field_array[i];
    file->field_array[i] = array[i];
    array[i] = old;
  }
  bw_release(file->mesh);
  file->mesh = renumbered;
  renumbered = NULL;
  file->node_from = node_from;
  file->element_from = element_from;
  node_from = element_from = NULL;
  if (when == BW_RENUMBER_AUTO)
    bw_warn(context,
            "the mesh is renumbered: its elements spanned %.0f times as many rows as along a "
            "space-filling curve; node_from and element_from of the second result have the numbers "
            "of the file, and renumber = false keeps them",
            ratio);
done:
  for (int i = 0; array && i < file->field_count; i++)
    bw_release(array[i]);
  bw_free(array);
  bw_free(new_node);
  bw_free(new_element);
  bw_free(node_from);
  bw_free(element_from);
  bw_release(renumbered);
  return status;
}
