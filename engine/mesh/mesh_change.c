/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Meshes made from meshes: other node positions, other regions, another order, fewer elements, the
 * boundary. */
#include "mesh/mesh_internal.h"

#include <math.h>
#include <string.h>

/* ---- other positions ------------------------------------------------------------------------ */

bw_status bw_mesh_moved(bw_context *context, const bw_mesh *mesh, const double *node,
                        bw_mesh **moved) {
  const bwi_mesh *source = (const bwi_mesh *)mesh;
  size_t numbers = 3 * (size_t)mesh->node_count;
  for (size_t i = 0; i < numbers; i++)
    if (!isfinite(node[i])) {
      bw_fail(context, BW_GEOMETRY,
              "the new position of node %zu has coordinates that are not finite", i / 3 + 1);
      bw_detail_number(context, "node", (double)(i / 3 + 1));
      return BW_GEOMETRY;
    }
  bw_mesh *made = bwi_mesh_create(context);
  if (!made)
    return BW_MEMORY;
  bw_status status = BW_OK;
  bw_object header = made->object;
  *made = *mesh;
  made->object = header;
  /* Topology belongs to the mesh that was built first, however long the chain of moves. */
  ((bwi_mesh *)made)->topology = bw_retain(source->topology ? source->topology : mesh);
  made->names = mesh->names ? bw_retain(mesh->names) : NULL;
  bw_mesh_regions regions = bw_mesh_regions_of(mesh);
  made->node = made->volume = NULL;
  made->region_count = 0;
  made->regions = NULL;
  made->region = NULL;
  BW_TRY(bwi_mesh_set_regions(context, made, &regions));
  made->node = BW_NEW(context, double, numbers);
  made->volume = BW_NEW(context, double, mesh->element_count);
  BW_TRY_MEMORY(made->node && made->volume);
  memcpy(made->node, node, numbers * sizeof *node);

  int32_t worst = -1, inverted = 0;
  double worst_ratio = INFINITY;
  for (int32_t i = 0; i < made->element_count; i++) {
    const int32_t *e = made->element + (size_t)i * (size_t)made->nodes_per_element;
    const double *x[4];
    for (int k = 0; k < 4; k++)
      x[k] = made->node + 3 * (size_t)e[k];
    double error, determinant = bwi_tet_determinant(x[0], x[1], x[2], x[3], &error);
    made->volume[i] = determinant / 6;
    if (determinant > error)
      continue;
    inverted++;
    double ratio = determinant / 6 / mesh->volume[i];
    if (worst < 0 || ratio < worst_ratio) {
      worst = i;
      worst_ratio = ratio;
    }
  }
  if (worst >= 0) {
    const double *at =
        made->node + 3 * (size_t)made->element[(size_t)worst * (size_t)made->nodes_per_element];
    status = bw_fail(context, BW_GEOMETRY,
                     "%d elements are flat or inverted at the new positions; the worst is element "
                     "%d near (%g, %g, %g) m, whose volume goes from %g to %g m3",
                     inverted, worst + 1, at[0], at[1], at[2], mesh->volume[worst],
                     worst_ratio * mesh->volume[worst]);
    bw_detail_number(context, "element", worst + 1.0);
    bw_detail_number(context, "inverted", inverted);
  }
done:
  if (status == BW_OK)
    *moved = made;
  else
    bw_release(made);
  return status;
}

/* ---- other regions -------------------------------------------------------------------------- */

bw_status bw_mesh_with_regions(bw_context *context, const bw_mesh *mesh,
                               const bw_mesh_regions *regions, bw_mesh **out) {
  const bwi_mesh *source = (const bwi_mesh *)mesh;
  bw_mesh *made = bwi_mesh_create(context);
  if (!made)
    return BW_MEMORY;
  bw_object header = made->object;
  *made = *mesh;
  made->object = header;
  made->region_count = 0;
  made->regions = NULL;
  made->region = NULL;
  /* Arrays belong to the mesh that was built first, however long the chain. */
  ((bwi_mesh *)made)->topology = bw_retain(source->topology ? source->topology : mesh);
  ((bwi_mesh *)made)->places = bw_retain(source->places ? source->places : mesh);
  made->names = mesh->names ? bw_retain(mesh->names) : NULL;
  bw_status status = bwi_mesh_set_regions(context, made, regions);
  if (status == BW_OK)
    *out = made;
  else
    bw_release(made);
  return status;
}

/* ---- another order -------------------------------------------------------------------------- */

/* A mid-edge node for every edge, in the order of the edges' lower and then upper corner, numbered
 * behind the corners. `wide` receives ten nodes per element. */
static bw_status number_mid_edge_nodes(bw_context *context, const bw_mesh *mesh, int32_t *wide,
                                       double **node, int64_t *nodes) {
  bw_status status = BW_OK;
  size_t entries = 6 * (size_t)mesh->element_count;
  bwi_keyed *list = BW_NEW(context, bwi_keyed, entries);
  int64_t *start = BW_NEW0(context, int64_t, (size_t)mesh->node_count + 2);
  double *place = NULL;
  int64_t count = mesh->node_count;
  BW_TRY_MEMORY(list && start);
  for (int pass = 0; pass < 2; pass++) { /* count the buckets, then fill them */
    for (int32_t i = 0; i < mesh->element_count; i++)
      for (int k = 0; k < 6; k++) {
        const int32_t *e = mesh->element + 4 * (size_t)i;
        int32_t a = e[bw_tet_edge[k][0]], b = e[bw_tet_edge[k][1]];
        int32_t low = a < b ? a : b, high = a < b ? b : a;
        if (pass == 0) {
          start[low + 2]++;
        } else {
          bwi_keyed *edge = &list[start[low + 1]++];
          edge->key = (uint64_t)high;
          edge->item = i;
          edge->part = k;
        }
      }
    if (pass == 0)
      for (int32_t i = 0; i <= mesh->node_count; i++)
        start[i + 1] += start[i];
  }
  BW_TRY(bw_check_cancel(context));
  for (int32_t i = 0; i < mesh->node_count; i++) {
    bwi_sort_keyed(list + start[i], start[i + 1] - start[i]);
    for (int64_t j = start[i]; j < start[i + 1]; j++)
      count += j == start[i] || list[j].key != list[j - 1].key;
  }
  if (count > INT32_MAX)
    BW_TRY(bw_fail(context, BW_LIMIT, "%lld nodes at order 2: a mesh holds at most 2147483647",
                   (long long)count));
  place = BW_NEW(context, double, 3 * (size_t)count);
  BW_TRY_MEMORY(place);
  memcpy(place, mesh->node, 3 * (size_t)mesh->node_count * sizeof *place);
  int32_t number = mesh->node_count - 1;
  for (int32_t i = 0; i < mesh->node_count; i++)
    for (int64_t j = start[i]; j < start[i + 1]; j++) {
      if (j == start[i] || list[j].key != list[j - 1].key) {
        number++;
        for (size_t k = 0; k < 3; k++)
          place[3 * (size_t)number + k] =
              0.5 * (mesh->node[3 * (size_t)i + k] + mesh->node[3 * list[j].key + k]);
      }
      wide[10 * (size_t)list[j].item + 4 + (size_t)list[j].part] = number;
    }
  *node = place;
  *nodes = count;
done:
  if (status != BW_OK)
    bw_free(place);
  bw_free(list);
  bw_free(start);
  return status;
}

bw_status bw_mesh_with_order(bw_context *context, const bw_mesh *mesh, int order, bw_mesh **out) {
  if (order != 1 && order != 2)
    return bw_fail(context, BW_INVALID, "order %d: a mesh of tetrahedra has order 1 or 2", order);
  if (order == mesh->order) {
    *out = bw_retain(mesh);
    return BW_OK;
  }
  bw_status status = BW_OK;
  size_t elements = (size_t)mesh->element_count, width = order == 2 ? 10 : 4;
  bw_mesh_regions regions = bw_mesh_regions_of(mesh);
  int32_t *element = BW_NEW(context, int32_t, width * elements);
  double *node = NULL;
  int64_t nodes = mesh->node_count;
  BW_TRY_MEMORY(element);
  for (size_t i = 0; i < elements; i++)
    memcpy(element + width * i, mesh->element + (size_t)mesh->nodes_per_element * i,
           4 * sizeof *element);
  if (order == 2) {
    BW_TRY(number_mid_edge_nodes(context, mesh, element, &node, &nodes));
  } else { /* the mid-edge nodes, which no element uses any more, are dropped by the constructor */
    node = BW_NEW(context, double, 3 * (size_t)nodes);
    BW_TRY_MEMORY(node);
    memcpy(node, mesh->node, 3 * (size_t)nodes * sizeof *node);
  }
  BW_TRY(bw_mesh_adopt(context, order, nodes, node, mesh->element_count, element, &regions, out));
  (*out)->surface_moved = mesh->surface_moved;
  element = NULL;
  node = NULL;
  status = bwi_mesh_keep_names(context, mesh, NULL, out);
done:
  if (status != BW_OK) {
    bw_free(element);
    bw_free(node);
  }
  return status;
}

/* ---- parts ---------------------------------------------------------------------------------- */

bw_status bw_mesh_subset(bw_context *context, const bw_mesh *mesh, const uint8_t *keep,
                         bw_mesh **subset) {
  bw_status status = BW_OK;
  size_t width = (size_t)mesh->nodes_per_element, kept = 0;
  int32_t *from = NULL;
  for (int32_t i = 0; i < mesh->element_count; i++)
    kept += keep[i] != 0;
  if (kept == 0)
    return bw_fail(context, BW_EMPTY,
                   "none of the %d elements is to be kept: a mesh needs at least one",
                   mesh->element_count);
  bw_mesh_regions regions = bw_mesh_regions_of(mesh);
  int32_t *element = BW_NEW(context, int32_t, width * kept);
  int32_t *region = mesh->region ? BW_NEW(context, int32_t, kept) : NULL;
  double *node = BW_NEW(context, double, 3 * (size_t)mesh->node_count);
  from = BW_NEW(context, int32_t, kept);
  BW_TRY_MEMORY(element && node && from && (!mesh->region || region));
  size_t at = 0;
  for (size_t i = 0; i < (size_t)mesh->element_count; i++)
    if (keep[i]) {
      memcpy(element + width * at, mesh->element + width * i, width * sizeof *element);
      if (region)
        region[at] = mesh->region[i];
      from[at] = (int32_t)i;
      at++;
    }
  memcpy(node, mesh->node, 3 * (size_t)mesh->node_count * sizeof *node);
  regions.of_element = region;
  BW_TRY(bw_mesh_adopt(context, mesh->order, mesh->node_count, node, (int64_t)kept, element,
                       &regions, subset));
  element = NULL;
  node = NULL;
  status = bwi_mesh_keep_names(context, mesh, from, subset);
done:
  bw_free(region);
  bw_free(from);
  if (status != BW_OK) {
    bw_free(element);
    bw_free(node);
  }
  return status;
}

bw_status bw_mesh_boundary(bw_context *context, const bw_mesh *mesh, bw_surface **surface,
                           int32_t **node_of_point) {
  bw_status status = BW_OK;
  size_t width = (size_t)mesh->nodes_per_facet, facets = (size_t)mesh->facet_count;
  int32_t *number = BW_NEW0(context, int32_t, mesh->node_count);
  int32_t *triangle = BW_NEW(context, int32_t, 3 * facets);
  int32_t *node = BW_NEW(context, int32_t, mesh->boundary_node_count);
  int32_t *group = mesh->names ? BW_NEW(context, int32_t, facets) : NULL;
  double *point = BW_NEW(context, double, 3 * (size_t)mesh->boundary_node_count);
  BW_TRY_MEMORY(number && triangle && node && point && (group || !mesh->names));
  for (size_t i = 0; i < facets && group; i++) /* behind the names: facets without one */
    group[i] = mesh->facet_group[i] < 0 ? mesh->names->count : mesh->facet_group[i];
  for (size_t i = 0; i < facets; i++)
    for (size_t k = 0; k < 3; k++)
      number[mesh->facet[width * i + k]] = 1;
  int32_t points = 0;
  for (int32_t i = 0; i < mesh->boundary_node_count; i++) {
    int32_t n = mesh->boundary_node[i];
    if (!number[n]) /* a middle */
      continue;
    memcpy(point + 3 * (size_t)points, mesh->node + 3 * (size_t)n, 3 * sizeof *point);
    node[points] = n;
    number[n] = points++;
  }
  for (size_t i = 0; i < facets; i++)
    for (size_t k = 0; k < 3; k++)
      triangle[3 * i + k] = number[mesh->facet[width * i + k]];
  BW_TRY(bw_surface_adopt(context, points, point, mesh->facet_count, triangle, group, surface));
  (*surface)->names = bw_retain(mesh->names);
  point = NULL;
  triangle = group = NULL;
  if (node_of_point) {
    *node_of_point = node;
    node = NULL;
  }
done:
  bw_free(number);
  bw_free(triangle);
  bw_free(group);
  bw_free(node);
  bw_free(point);
  return status;
}
