/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Selections: how they are made, combined and measured. The geometric ones are in select_shape.c,
 * those that traverse facets in select_facets.c.
 *
 * Invariants: facets and nodes ascend without repetition, every node of a chosen facet is chosen,
 * and there is at least one node. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/internal.h"

static void selection_destroy(void *object) {
  bw_selection *selection = (bw_selection *)object;
  bw_release(selection->mesh);
  bw_free(selection->facet);
  bw_free(selection->node);
  bw_free(selection);
}

static size_t selection_bytes(const void *object) {
  const bw_selection *selection = (const bw_selection *)object;
  return sizeof *selection + 4 * ((size_t)selection->facet_count + (size_t)selection->node_count);
}

static const bw_kind selection_kind = {"selection", selection_destroy, selection_bytes};

/* BW_EMPTY with what helps to find the mistake: a wrong unit or a wrong place. */
static bw_status fail_empty(bw_context *context, const bw_mesh *mesh, const char *what,
                            int32_t nearest, double distance) {
  double low[3], high[3];
  char from[96], to[96], at[96];
  bw_mesh_box(mesh, low, high);
  bwi_vector_string(from, sizeof from, low, 6, 0);
  bwi_vector_string(to, sizeof to, high, 6, 0);
  bw_status status;
  if (nearest >= 0) {
    char number[40];
    bwi_vector_string(at, sizeof at, mesh->node + 3 * (size_t)nearest, 6, 0);
    bwi_number_string(number, sizeof number, distance, 4, 0);
    status = bw_fail(context, BW_EMPTY,
                     "%s selects no boundary node: the nearest is node %d at %s m, %s m away; the "
                     "bounding box of the mesh is %s to %s m",
                     what, nearest + 1, at, number, from, to);
    bw_detail_number(context, "node", nearest + 1.0);
    bw_detail_number(context, "distance", distance);
  } else
    status = bw_fail(context, BW_EMPTY,
                     "%s selects no boundary node; the bounding box of the mesh is %s to %s m",
                     what, from, to);
  return status;
}

bw_status bwi_selection_copy(bw_context *context, const bw_mesh *mesh, int32_t facet_count,
                             const int32_t *facet, int32_t node_count, const int32_t *node,
                             bw_selection **selection) {
  bw_selection *made = BW_NEW0(context, bw_selection, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &selection_kind);
  made->mesh = (const bw_mesh *)bw_retain(mesh);
  made->facet = BW_NEW(context, int32_t, facet_count);
  made->node = BW_NEW(context, int32_t, node_count);
  if (!made->facet || !made->node) {
    bw_release(made);
    return BW_MEMORY;
  }
  made->facet_count = facet_count;
  made->node_count = node_count;
  memcpy(made->facet, facet, (size_t)facet_count * sizeof *facet);
  memcpy(made->node, node, (size_t)node_count * sizeof *node);
  *selection = made;
  return BW_OK;
}

bw_status bwi_selection_make(bw_context *context, const bw_mesh *mesh, const uint8_t *facet,
                             const uint8_t *node, const char *what, int32_t nearest,
                             double distance, bw_selection **selection) {
  bw_status status = BW_OK;
  bw_selection *made = NULL;
  uint8_t *marked = BW_NEW0(context, uint8_t, mesh->node_count);
  if (!marked)
    return BW_MEMORY;
  made = BW_NEW0(context, bw_selection, 1);
  BW_TRY_MEMORY(made);
  bw_object_init(made, &selection_kind);
  made->mesh = (const bw_mesh *)bw_retain(mesh);
  for (int32_t i = 0; node && i < mesh->boundary_node_count; i++)
    if (node[mesh->boundary_node[i]])
      marked[mesh->boundary_node[i]] = 1;
  for (int32_t f = 0; facet && f < mesh->facet_count; f++)
    if (facet[f]) {
      made->facet_count++;
      for (int a = 0; a < mesh->nodes_per_facet; a++)
        marked[mesh->facet[(size_t)f * (size_t)mesh->nodes_per_facet + (size_t)a]] = 1;
    }
  for (int32_t i = 0; i < mesh->node_count; i++)
    made->node_count += marked[i];
  if (made->node_count == 0)
    BW_TRY(fail_empty(context, mesh, what, nearest, distance));
  made->facet = BW_NEW(context, int32_t, made->facet_count);
  made->node = BW_NEW(context, int32_t, made->node_count);
  BW_TRY_MEMORY(made->facet && made->node);
  int32_t at = 0;
  for (int32_t f = 0; facet && f < mesh->facet_count; f++)
    if (facet[f])
      made->facet[at++] = f;
  at = 0;
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (marked[i])
      made->node[at++] = i;
  *selection = made;
done:
  bw_free(marked);
  if (status != BW_OK)
    bw_release(made);
  return status;
}

bw_status bw_select_all(bw_context *context, const bw_mesh *mesh, bw_selection **selection) {
  uint8_t *facet = BW_NEW(context, uint8_t, mesh->facet_count);
  if (!facet)
    return BW_MEMORY;
  memset(facet, 1, (size_t)mesh->facet_count);
  bw_status status =
      bwi_selection_make(context, mesh, facet, NULL, "the whole boundary", -1, 0, selection);
  bw_free(facet);
  return status;
}

bw_status bw_select_mask(bw_context *context, const bw_mesh *mesh, const uint8_t *facet_mask,
                         const uint8_t *node_mask, bw_selection **selection) {
  uint8_t *facet = BW_NEW0(context, uint8_t, mesh->facet_count);
  if (!facet)
    return BW_MEMORY;
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *corner = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
    facet[f] = (facet_mask && facet_mask[f]) ||
               (node_mask && node_mask[corner[0]] && node_mask[corner[1]] && node_mask[corner[2]]);
  }
  bw_status status =
      bwi_selection_make(context, mesh, facet, node_mask, "the mask", -1, 0, selection);
  bw_free(facet);
  if (status == BW_OK)
    (*selection)->node_set = !facet_mask;
  return status;
}

bw_status bw_select_region(bw_context *context, const bw_mesh *mesh, int32_t region,
                           bw_selection **selection) {
  char what[BW_NAME + 16];
  uint8_t *facet = BW_NEW0(context, uint8_t, mesh->facet_count);
  if (!facet)
    return BW_MEMORY;
  for (int32_t f = 0; f < mesh->facet_count; f++)
    facet[f] = mesh->region[mesh->facet_element[f]] == region;
  snprintf(what, sizeof what, "the region '%s'", mesh->regions[region].name.text);
  bw_status status = bwi_selection_make(context, mesh, facet, NULL, what, -1, 0, selection);
  bw_free(facet);
  return status;
}

bw_status bw_select_node_set(bw_context *context, const bw_selection *from,
                             bw_selection **selection) {
  bw_status status = bwi_selection_copy(context, from->mesh, from->facet_count, from->facet,
                                        from->node_count, from->node, selection);
  if (status == BW_OK)
    (*selection)->node_set = true;
  return status;
}

bw_status bw_select_combine(bw_context *context, const bw_selection *a, const bw_selection *b,
                            bw_set_operation operation, bw_selection **selection) {
  static const char *const name[] = {"the union", "the intersection", "the difference"};
  const bw_mesh *mesh = a->mesh;
  if (b->mesh != mesh)
    return bw_fail(context, BW_INVALID, "%s needs two selections of the same mesh",
                   name[operation]);
  bw_status status = BW_OK;
  uint8_t *facet = BW_NEW0(context, uint8_t, mesh->facet_count);
  uint8_t *node = BW_NEW0(context, uint8_t, mesh->node_count);
  BW_TRY_MEMORY(facet && node);
  for (int32_t f = 0; f < a->facet_count; f++)
    facet[a->facet[f]] |= 1;
  for (int32_t f = 0; f < b->facet_count; f++)
    facet[b->facet[f]] |= 2;
  for (int32_t i = 0; i < a->node_count; i++)
    node[a->node[i]] |= 1;
  for (int32_t i = 0; i < b->node_count; i++)
    node[b->node[i]] |= 2;
  static const uint8_t keep[3][4] = {{0, 1, 1, 1}, {0, 0, 0, 1}, {0, 1, 0, 0}};
  for (int32_t f = 0; f < mesh->facet_count; f++)
    facet[f] = keep[operation][facet[f]];
  for (int32_t i = 0; i < mesh->node_count; i++)
    node[i] = keep[operation][node[i]];
  status = bwi_selection_make(context, mesh, facet, node, name[operation], -1, 0, selection);
  if (status == BW_OK) {
    (*selection)->node_set = operation == BW_UNION          ? a->node_set && b->node_set
                             : operation == BW_INTERSECTION ? a->node_set || b->node_set
                                                            : a->node_set;
    if (operation == BW_UNION)
      (*selection)->missed_area = a->missed_area + b->missed_area;
  }
done:
  bw_free(facet);
  bw_free(node);
  return status;
}

/* ---- measures -------------------------------------------------------------------------------- */

/* Area, first moment of area and vector area of one facet. */
static double facet_area(const bw_mesh *mesh, int32_t facet, double first[3], double vector[3]) {
  double area = 0;
  memset(first, 0, 3 * sizeof *first);
  memset(vector, 0, 3 * sizeof *vector);
  if (bwi_boundary_is_straight(mesh, facet)) {
    const int32_t *node = mesh->facet + (size_t)facet * (size_t)mesh->nodes_per_facet;
    double middle[3] = {1. / 3, 1. / 3, 1. / 3};
    bwi_boundary_normal(mesh, facet, middle, vector);
    area = bw_norm(vector) / 2;
    for (int k = 0; k < 3; k++) {
      vector[k] /= 2;
      for (int a = 0; a < 3; a++)
        first[k] += area / 3 * mesh->node[3 * (size_t)node[a] + (size_t)k];
    }
    return area;
  }
  bwi_boundary_point point[BW_QUADRATURE_POINTS];
  int count = bwi_boundary_points(mesh, facet, point);
  for (int p = 0; p < count; p++) {
    double size = bw_norm(point[p].area);
    area += size;
    for (int k = 0; k < 3; k++) {
      first[k] += size * point[p].at[k];
      vector[k] += point[p].area[k];
    }
  }
  return area;
}

double bw_selection_area(const bw_selection *selection) {
  double area = 0, first[3], vector[3];
  for (int32_t f = 0; f < selection->facet_count; f++)
    area += facet_area(selection->mesh, selection->facet[f], first, vector);
  return area;
}

void bw_selection_centre(const bw_selection *selection, double centre[3]) {
  double area = 0, sum[3] = {0, 0, 0}, first[3], vector[3];
  for (int32_t f = 0; f < selection->facet_count; f++) {
    area += facet_area(selection->mesh, selection->facet[f], first, vector);
    for (int k = 0; k < 3; k++)
      sum[k] += first[k];
  }
  if (!(area > 0)) {
    area = selection->node_count;
    memset(sum, 0, sizeof sum);
    for (int32_t i = 0; i < selection->node_count; i++)
      for (int k = 0; k < 3; k++)
        sum[k] += selection->mesh->node[3 * (size_t)selection->node[i] + (size_t)k];
  }
  for (int k = 0; k < 3; k++)
    centre[k] = sum[k] / area;
}

void bw_selection_normal(const bw_selection *selection, double normal[3]) {
  double area = 0, sum[3] = {0, 0, 0}, first[3], vector[3];
  for (int32_t f = 0; f < selection->facet_count; f++) {
    area += facet_area(selection->mesh, selection->facet[f], first, vector);
    for (int k = 0; k < 3; k++)
      sum[k] += vector[k];
  }
  double size = bw_norm(sum);
  for (int k = 0; k < 3; k++) /* a closed surface has no mean normal */
    normal[k] = size > 1e-9 * area ? sum[k] / size : 0;
}
