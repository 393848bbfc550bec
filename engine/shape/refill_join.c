/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Joining what was kept of a mesh and its refilled parts.
 *
 * Nodes of the new mesh are the old ones that a kept element or a facet of a component has, in
 * their order, then new ones by component: corners, and at order 2 the mid-edge nodes of all new
 * edges. An edge of a new element that was there before (along a component's boundary) has its old
 * mid-edge node, so that the parts fit. */
#include "shape/mesh_repair_internal.h"

#include <string.h>

/* r->number: the new number of every node that stays, -1 for the others. */
static void number_nodes(bwi_refiller *r) {
  const bw_mesh *mesh = r->mesh;
  size_t width = (size_t)mesh->nodes_per_element;
  for (int32_t i = 0; i < mesh->node_count; i++)
    r->number[i] = -1;
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *n = bwi_nodes_of(r->mesh, e);
    if (r->component_of[e] < 0)
      for (size_t k = 0; k < width; k++)
        r->number[n[k]] = 0;
    else
      for (int k = 0; k < 4; k++)
        for (int j = 0; j < 3 && bwi_on_component_boundary(r, e, k); j++) {
          r->number[n[bw_tet_face[k][j]]] = 0;
          if (mesh->order == 2)
            r->number[n[bw_tet_face_mid_edge[k][j]]] = 0;
        }
  }
  r->node_count = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (r->number[i] == 0)
      r->number[i] = (int32_t)r->node_count++;
}

/* Old edges that a new element may meet again: those of kept elements and of components' facets
 * whose ends are both on a component's boundary. Keyed by new numbers, sorted; item: the middle. */
static bw_status old_edges(bwi_refiller *r, bwi_keyed **list, size_t *count) {
  bw_status status = BW_OK;
  size_t found = 0, capacity = 0;
  bwi_keyed *edges = NULL;
  uint8_t *touched = BW_NEW0(r->context, uint8_t, r->mesh->node_count);
  if (!touched)
    return BW_MEMORY;
  for (int32_t p = 0; p < r->components; p++)
    for (int32_t i = 0; i < r->component[p].corners; i++)
      touched[r->component[p].corner[i]] = 1;
  for (int32_t e = 0; e < r->mesh->element_count; e++) {
    const int32_t *n = bwi_nodes_of(r->mesh, e);
    for (int k = 0; k < 6; k++) {
      int32_t a = n[bw_tet_edge[k][0]], b = n[bw_tet_edge[k][1]], middle = r->number[n[4 + k]];
      if (!touched[a] || !touched[b] || middle < 0)
        continue;
      uint64_t low = (uint64_t)r->number[a < b ? a : b], high = (uint64_t)r->number[a < b ? b : a];
      BW_TRY_MEMORY(bw_grow(r->context, (void **)&edges, &capacity, found, 1, sizeof *edges));
      edges[found++] = (bwi_keyed){low << 32 | high, middle, 0};
    }
  }
  bwi_sort_keyed(edges, (int64_t)found);
  *list = edges;
  *count = found;
  edges = NULL;
done:
  bw_free(touched);
  bw_free(edges);
  return status;
}

static int32_t find_edge(const bwi_keyed *list, size_t count, uint64_t key) {
  size_t low = 0, high = count;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (list[middle].key < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low < count && list[low].key == key ? list[low].item : -1;
}

/* Mid-edge nodes for the elements from r->kept on: old ones where the edge is old, else new ones in
 * the order of edges. Grows r->new_node and r->node_from. */
static bw_status place_new_mid_edge_nodes(bwi_refiller *r) {
  bw_status status;
  bwi_keyed *old = NULL, *edge = NULL;
  size_t olds = 0, edges = 6 * (size_t)(r->element_count - r->kept), at = 0;
  int64_t count = r->node_count;
  BW_TRY(old_edges(r, &old, &olds));
  edge = BW_NEW(r->context, bwi_keyed, edges);
  BW_TRY_MEMORY(edge);
  for (int64_t e = r->kept; e < r->element_count; e++)
    for (int k = 0; k < 6; k++) {
      const int32_t *n = r->element + 10 * (size_t)e;
      uint64_t a = (uint64_t)n[bw_tet_edge[k][0]], b = (uint64_t)n[bw_tet_edge[k][1]];
      edge[at++] = (bwi_keyed){a < b ? a << 32 | b : b << 32 | a, (int32_t)e, k};
    }
  bwi_sort_keyed(edge, (int64_t)edges);
  for (int pass = 0; pass < 2; pass++) { /* count, then place */
    int64_t next = r->node_count;
    for (size_t i = 0; i < edges;) {
      size_t end = i;
      int32_t middle = find_edge(old, olds, edge[i].key);
      bool is_new = middle < 0;
      if (is_new)
        middle = (int32_t)next++;
      for (; end < edges && edge[end].key == edge[i].key; end++)
        if (pass == 1)
          r->element[10 * (size_t)edge[end].item + 4 + (size_t)edge[end].part] = middle;
      if (pass == 1 && is_new) {
        size_t a = (size_t)(edge[i].key >> 32), b = (size_t)(edge[i].key & 0xffffffff);
        for (size_t k = 0; k < 3; k++)
          r->new_node[3 * (size_t)middle + k] =
              0.5 * (r->new_node[3 * a + k] + r->new_node[3 * b + k]);
        r->node_from[middle] = -1;
      }
      i = end;
    }
    count = next;
    if (count > INT32_MAX)
      BW_TRY(bw_fail(r->context, BW_LIMIT, "%lld nodes: a mesh holds at most 2147483647",
                     (long long)count));
    if (pass == 0) {
      double *node = bw_resize(r->context, r->new_node, 3 * (size_t)count, sizeof *node);
      if (node)
        r->new_node = node;
      int32_t *from = bw_resize(r->context, r->node_from, (size_t)count, sizeof *from);
      if (from)
        r->node_from = from;
      BW_TRY_MEMORY(node && from);
    }
  }
  r->node_count = count;
done:
  bw_free(old);
  bw_free(edge);
  return status;
}

bw_status bwi_refill_join(bwi_refiller *r) {
  const bw_mesh *mesh = r->mesh;
  size_t width = (size_t)mesh->nodes_per_element;
  number_nodes(r);
  int64_t next = r->node_count, nodes = r->node_count;
  r->element_count = r->kept;
  for (int32_t p = 0; p < r->components; p++) {
    nodes += r->component[p].filled.node_count - r->component[p].corners;
    r->element_count += r->component[p].filled.element_count;
  }
  if (nodes > INT32_MAX || r->element_count > INT32_MAX)
    return bw_fail(r->context, BW_LIMIT,
                   "%lld nodes and %lld elements: a mesh holds at most 2147483647 each",
                   (long long)nodes, (long long)r->element_count);
  r->new_node = BW_NEW(r->context, double, 3 * (size_t)nodes);
  r->node_from = BW_NEW(r->context, int32_t, nodes);
  r->element = BW_NEW(r->context, int32_t, width * (size_t)r->element_count);
  r->element_from = BW_NEW(r->context, int32_t, r->element_count);
  r->region = mesh->region ? BW_NEW(r->context, int32_t, r->element_count) : NULL;
  if (!r->new_node || !r->node_from || !r->element || !r->element_from ||
      (mesh->region && !r->region))
    return BW_MEMORY;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (r->number[i] >= 0) {
      memcpy(r->new_node + 3 * (size_t)r->number[i], r->node + 3 * (size_t)i, 3 * sizeof(double));
      r->node_from[r->number[i]] = i;
    }
  size_t at = 0;
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (r->component_of[e] < 0) {
      for (size_t k = 0; k < width; k++)
        r->element[width * at + k] = r->number[bwi_nodes_of(r->mesh, e)[k]];
      if (r->region)
        r->region[at] = mesh->region[e];
      r->element_from[at++] = e;
    }
  for (int32_t i = 0; i < r->components; i++) {
    const bwi_component *p = &r->component[i];
    int64_t offset = next - p->corners;
    for (int32_t n = p->corners; n < p->filled.node_count; n++, next++) {
      memcpy(r->new_node + 3 * (size_t)next, p->filled.node + 3 * (size_t)n, 3 * sizeof(double));
      r->node_from[next] = -1;
    }
    for (int32_t e = 0; e < p->filled.element_count; e++, at++) {
      for (size_t k = 0; k < 4; k++) {
        int32_t n = p->filled.element[4 * (size_t)e + k];
        r->element[width * at + k] =
            n < p->corners ? r->number[p->corner[n]] : (int32_t)(offset + n);
      }
      if (r->region)
        r->region[at] = p->region;
      r->element_from[at] = -1 - i;
    }
  }
  r->node_count = next;
  return mesh->order == 2 ? place_new_mid_edge_nodes(r) : BW_OK;
}

/* ---- facets in their old order --------------------------------------------------------------- */

static bwi_keyed facet_key(const int32_t *corner, int32_t item) {
  bool turned;
  bwi_keyed key = bwi_triangle_key(corner[0], corner[1], corner[2], &turned);
  key.part = item;
  return key;
}

bw_status bwi_refill_order_facets(bwi_refiller *r, bw_mesh *made) {
  const bw_mesh *mesh = r->mesh;
  size_t width = (size_t)mesh->nodes_per_facet;
  bw_status status = BW_OK;
  int32_t *element = BW_NEW(r->context, int32_t, made->facet_count);
  bwi_keyed *list = BW_NEW(r->context, bwi_keyed, made->facet_count);
  BW_TRY_MEMORY(element && list);
  if (made->facet_count != mesh->facet_count)
    goto different;
  for (int32_t i = 0; i < made->facet_count; i++) {
    list[i] = facet_key(made->facet + width * (size_t)i, i);
    element[i] = made->facet_element[i];
  }
  bwi_sort_keyed(list, made->facet_count);
  for (int32_t i = 0; i < mesh->facet_count; i++) {
    const int32_t *old = mesh->facet + width * (size_t)i;
    int32_t now[6], low = 0, high = made->facet_count;
    for (size_t k = 0; k < width; k++)
      now[k] = r->number[old[k]];
    bwi_keyed key = facet_key(now, i);
    while (low < high) {
      int32_t middle = low + (high - low) / 2;
      const bwi_keyed *m = &list[middle];
      if (m->key < key.key || (m->key == key.key && m->item < key.item))
        low = middle + 1;
      else
        high = middle;
    }
    if (low == made->facet_count || list[low].key != key.key || list[low].item != key.item)
      goto different;
    memcpy(made->facet + width * (size_t)i, now, width * sizeof *now);
    made->facet_element[i] = element[list[low].part];
  }
  goto done;
different:
  status = bw_fail(r->context, BW_INTERNAL,
                   "%d boundary facets became %d others when a part was remeshed",
                   mesh->facet_count, made->facet_count);
done:
  bw_free(element);
  bw_free(list);
  return status;
}
