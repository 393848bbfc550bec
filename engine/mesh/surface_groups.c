/* Groups of a surface's facets on another surface, and on the boundary of a mesh.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * A facet gets the group of the facet that is nearest to its middle. Where the two face different
 * ways, as on the lid of a hole that was filled, the group of a neighbour that faces the same way
 * is better. */
#include <math.h>
#include <string.h>

#include "barwright/boolean.h"
#include "mesh/mesh_internal.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_topology.h"
#include "mesh/surface_tree.h"

/* The cosine of the angle between the planes of two facets, which may not be oriented alike. */
static double cosine(const bw_surface *a, int64_t t, const bw_surface *b, int64_t u) {
  double n[3], m[3];
  bwi_facet_normal(a->point, a->triangle + 3 * t, n);
  bwi_facet_normal(b->point, b->triangle + 3 * u, m);
  double sizes = bw_norm(n) * bw_norm(m);
  return sizes > 0 ? fabs(bw_dot(n, m)) / sizes : 0;
}

/* The nearest facets; clear (triangle_count) where they face the same way. *unclear counts others.
 */
static bw_status find_nearest(bw_context *context, const bw_surface *from, const bw_surface *to,
                              int32_t *group, uint8_t *clear, int64_t *unclear) {
  bw_status status;
  bwi_tree *tree = NULL;
  int32_t nearest = -1;
  *unclear = 0;
  BW_TRY(bwi_tree_create(context, from->point, from->triangle_count, from->triangle, NULL, &tree));
  for (int64_t t = 0; t < to->triangle_count; t++) {
    double middle[3] = {0}, place[3];
    if (t % 4096 == 0)
      BW_TRY(bw_check_cancel(context));
    for (int k = 0; k < 9; k++)
      middle[k % 3] += to->point[3 * (int64_t)to->triangle[3 * t + k / 3] + k % 3] / 3;
    bwi_tree_nearest(tree, middle, nearest, 0, place, &nearest);
    group[t] = from->group[nearest];
    clear[t] = cosine(from, nearest, to, t) > 0.7;
    *unclear += !clear[t];
  }
done:
  bwi_tree_destroy(tree);
  return status;
}

/* The neighbour of an unclear facet that is clear and faces the same way best, or -1. */
static int32_t best_neighbour(const bw_surface *surface, const bwi_topology *topology,
                              const uint8_t *clear, int32_t t) {
  int32_t best = -1;
  double most = 0.7;
  for (int k = 0; k < 3 && !topology->degenerate[t]; k++) {
    int64_t e = topology->edge_of[3 * (int64_t)t + k];
    for (int64_t i = topology->start[e]; i < topology->start[e + 1]; i++) {
      int32_t other = (int32_t)(topology->side[i] / 3);
      double c = other != t && clear[other] ? cosine(surface, t, surface, other) : 0;
      if (c > most) {
        most = c;
        best = other;
      }
    }
  }
  return best;
}

/* Unclear facets take over the groups of neighbours, ring by ring. */
static bw_status settle(bw_context *context, const bw_surface *surface, int32_t *group,
                        uint8_t *clear) {
  bwi_topology *topology = NULL;
  int32_t *chosen = NULL;
  bool some = true;
  bw_status status;
  BW_TRY(bwi_topology_create(context, surface, &topology));
  chosen = BW_NEW(context, int32_t, surface->triangle_count);
  BW_TRY_MEMORY(chosen);
  while (some) {
    some = false;
    BW_TRY(bw_check_cancel(context));
    for (int32_t t = 0; t < surface->triangle_count; t++)
      chosen[t] = clear[t] ? -1 : best_neighbour(surface, topology, clear, t);
    for (int32_t t = 0; t < surface->triangle_count; t++)
      if (chosen[t] >= 0) {
        group[t] = group[chosen[t]];
        clear[t] = 1;
        some = true;
      }
  }
done:
  bwi_topology_destroy(topology);
  bw_free(chosen);
  return status;
}

bw_status bwi_take_groups(bw_context *context, const bw_surface *from, bw_surface *to) {
  bw_status status = BW_OK;
  int64_t unclear;
  if (!from->group || to->group || from->triangle_count == 0)
    return BW_OK;
  int32_t *group = BW_NEW(context, int32_t, to->triangle_count);
  uint8_t *clear = BW_NEW(context, uint8_t, to->triangle_count);
  BW_TRY_MEMORY(group && clear);
  BW_TRY(find_nearest(context, from, to, group, clear, &unclear));
  if (unclear > 0)
    BW_TRY(settle(context, to, group, clear));
  to->group = group;
  group = NULL;
  bwi_keep_names(from, to);
done:
  bw_free(group);
  bw_free(clear);
  return status;
}

bw_status bw_groups_on_mesh(bw_context *context, const bw_surface *surface, const bw_mesh *mesh,
                            int32_t *group) {
  bw_surface *boundary = NULL;
  bw_status status = BW_OK;
  if (!surface->group || surface->triangle_count == 0)
    return bw_fail(context, BW_INVALID, "the surface has no groups");
  BW_TRY(bw_mesh_boundary(context, mesh, &boundary, NULL));
  bw_free(boundary->group); /* of the surface that the mesh was filled from */
  bw_release(boundary->names);
  boundary->group = NULL;
  boundary->names = NULL;
  BW_TRY(bwi_take_groups(context, surface, boundary));
  if (mesh->facet_count)
    memcpy(group, boundary->group, (size_t)mesh->facet_count * sizeof *group);
done:
  bw_release(boundary);
  return status;
}

bw_status bwi_mesh_take_names(bw_context *context, const bw_surface *surface, bw_mesh *mesh) {
  if (!surface->names || surface->triangle_count == 0)
    return BW_OK;
  bw_status status;
  int32_t *group = BW_NEW(context, int32_t, mesh->facet_count);
  BW_TRY_MEMORY(group);
  BW_TRY(bw_groups_on_mesh(context, surface, mesh, group));
  bwi_mesh_adopt_groups(mesh, group, surface->names);
  group = NULL;
done:
  bw_free(group);
  return status;
}
