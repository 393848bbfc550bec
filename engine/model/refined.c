/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Selections and nodal fields on a refined mesh.
 *
 * A facet is selected where the facet before that it lies in was. Its nodes are selected with it.
 * Any other node lies in a corner, an edge, a face or the inside of an element before: it is
 * selected where all nodes of order 2 on that corner, edge or face were, so that a line of nodes
 * stays a line. Nodes of a linear mesh do not say which of their edges are meant: there only
 * corners are. */
#include "model/internal.h"

#include <string.h>

/* Nodes of an element (bit k: node k) on the smallest corner, edge or face that holds a point. A
 * node itself is the smallest. */
static unsigned smallest_part(int order, const double l[4]) {
  unsigned corners = 0, nodes = 0;
  for (int k = 0; k < 4; k++)
    corners |= (l[k] > 0 ? 1u : 0u) << k;
  for (int e = 0; e < 6 && order == 2; e++) {
    unsigned ends = 1u << bw_tet_edge[e][0] | 1u << bw_tet_edge[e][1];
    if (corners == ends && l[bw_tet_edge[e][0]] == 0.5)
      return 1u << (4 + e);
    if ((corners & ends) == ends)
      nodes |= 1u << (4 + e);
  }
  return nodes | corners;
}

bw_status bwi_refined_selection(bw_context *context, const bw_refinement *r, const bw_mesh *mesh,
                                const bw_selection *on, bw_selection **refined) {
  const bw_mesh *from = on->mesh;
  size_t width = (size_t)mesh->nodes_per_facet, old_width = (size_t)from->nodes_per_element;
  bw_status status = BW_OK;
  int32_t facets = 0, nodes = 0;
  uint8_t *old_facet = BW_NEW0(context, uint8_t, from->facet_count);
  uint8_t *old_node = BW_NEW0(context, uint8_t, from->node_count);
  uint8_t *chosen = BW_NEW0(context, uint8_t, mesh->node_count);
  int32_t *facet = BW_NEW(context, int32_t, mesh->facet_count);
  int32_t *node = BW_NEW(context, int32_t, mesh->node_count);
  BW_TRY_MEMORY(old_facet && old_node && chosen && facet && node);
  for (int32_t i = 0; i < on->facet_count; i++)
    old_facet[on->facet[i]] = 1;
  for (int32_t i = 0; i < on->node_count; i++)
    old_node[on->node[i]] = 1;
  for (int32_t f = 0; f < mesh->facet_count; f++)
    if (old_facet[r->facet_parent[f]]) {
      facet[facets++] = f;
      for (size_t k = 0; k < width; k++)
        chosen[mesh->facet[width * (size_t)f + k]] = 1;
    }
  for (int32_t i = 0; i < mesh->boundary_node_count; i++) {
    size_t n = (size_t)mesh->boundary_node[i];
    const int32_t *own = from->element + old_width * (size_t)r->node_parent[n];
    unsigned part = smallest_part(from->order, r->node_weight + 4 * n);
    bool all = from->order == 2 || (part & (part - 1)) == 0;
    for (int a = 0; a < from->nodes_per_element && all; a++)
      all = !(part >> a & 1u) || old_node[own[a]];
    chosen[n] |= all;
  }
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (chosen[i])
      node[nodes++] = i;
  BW_TRY(bwi_selection_copy(context, mesh, facets, facet, nodes, node, refined));
  (*refined)->node_set = on->node_set;
done:
  bw_free(old_facet);
  bw_free(old_node);
  bw_free(chosen);
  bw_free(facet);
  bw_free(node);
  return status;
}

bw_status bwi_refined_array(bw_context *context, const bw_refinement *r, const bw_mesh *from,
                            const bw_mesh *mesh, const bw_array *array, bool interpolated,
                            bw_array **refined) {
  size_t width = (size_t)from->nodes_per_element;
  bw_array *made = NULL;
  bw_status status = bw_array_create(context, BW_F64, mesh->node_count, array->columns, &made);
  if (status != BW_OK)
    return status;
  double *value = (double *)made->data;
  for (int64_t i = 0; i < mesh->node_count; i++) {
    const int32_t *own = from->element + width * (size_t)r->node_parent[i];
    double shape[10];
    bw_tet_shape(from->order, r->node_weight + 4 * i, shape);
    for (int64_t k = 0; k < array->columns; k++) {
      double sum = 0;
      for (size_t a = 0; a < width; a++)
        if (interpolated ? shape[a] != 0 : shape[a] == 1)
          sum += shape[a] * bw_array_get(array, own[a], k);
      value[i * array->columns + k] = sum;
    }
  }
  *refined = made;
  return BW_OK;
}
