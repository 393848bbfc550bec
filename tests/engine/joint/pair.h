/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the tests of joints share: bodies side by side in one mesh, and modes of rigid bodies. */
#ifndef PAIR_H
#define PAIR_H

#include "bodies.h"

#include "barwright/joint.h"

/* Two boxes in one mesh: `second` begins at `offset`. */
static inline bw_mesh *pair(bw_context *context, bw_mesh *first, bw_mesh *second,
                            const double offset[3]) {
  bw_mesh *mesh = NULL;
  int64_t nodes = first->node_count + (int64_t)second->node_count,
          elements = first->element_count + (int64_t)second->element_count,
          width = first->nodes_per_element, own = first->element_count * width;
  double *node = numbers(3 * nodes);
  int32_t *element = calloc((size_t)(elements * width), sizeof *element);
  memcpy(node, first->node, 3 * (size_t)first->node_count * sizeof *node);
  memcpy(element, first->element, (size_t)own * sizeof *element);
  for (int64_t i = 0; i < 3 * (int64_t)second->node_count; i++)
    node[3 * (int64_t)first->node_count + i] = second->node[i] + offset[i % 3];
  for (int64_t i = 0; i < second->element_count * width; i++)
    element[own + i] = second->element[i] + first->node_count;
  check_ok(context,
           bw_mesh_copy(context, first->order, nodes, node, elements, element, NULL, &mesh));
  free(node);
  free(element);
  bw_release(first);
  bw_release(second);
  return mesh;
}

/* The facets of one body in a plane across an axis. */
static inline bw_selection *face(bw_context *context, const bw_mesh *mesh, int body, int k,
                                 double at) {
  uint8_t *mask = calloc((size_t)mesh->facet_count, 1);
  bw_selection *selection = NULL;
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *node = mesh->facet + (int64_t)f * mesh->nodes_per_facet;
    mask[f] = body < 0 || mesh->component[node[0]] == body;
    for (int c = 0; c < 3; c++)
      mask[f] &= fabs(mesh->node[3 * (int64_t)node[c] + k] - at) < 1e-9;
  }
  check_ok(context, bw_select_mask(context, mesh, mask, NULL, &selection));
  free(mask);
  return selection;
}

/* The six lowest modes of a model, none of them rigid, are those of these squares (1/s2). */
static inline void check_six(bw_context *context, const bw_model *model, double square[6],
                             double tolerance) {
  bw_modes *modes = NULL;
  bw_modes_options options;
  for (int i = 0; i < 6; i++)
    for (int j = i + 1; j < 6; j++)
      if (square[j] < square[i]) {
        double kept = square[i];
        square[i] = square[j];
        square[j] = kept;
      }
  bw_modes_options_default(&options);
  options.count = 6;
  check_ok(context, bw_joined_modes(context, model, &options, &modes));
  assert_int_equal(modes->rigid_count, 0);
  for (int i = 0; i < 6; i++)
    check_near(modes->frequency[i], sqrt(square[i]) / 6.28318530717958647692,
               tolerance * modes->frequency[i]);
  bw_release(modes);
}

#endif
