/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which facet of another part a point of contact faces: that with the nearest point. */
#include <math.h>
#include <string.h>

#include "base/box_tree.h"
#include "contact/internal.h"
#include "model/internal.h"

enum { LEAF = 8 };

/* A point faces a facet when its distance along the facet is below this fraction of the gap... */
static const double slant = 0.5;
/* ... or of the size of the facet; where it has moved, curved facets have no exact nearest point.
 */
static const double beside = 1e-6, beside_moved = 1e-3;

static double distance_to(void *data, int32_t facet, const double *p) {
  double weight[3];
  return bwi_boundary_nearest(data, facet, p, weight);
}

static void box_of(const void *data, int32_t facet, double *min, double *max) {
  bwi_boundary_box(data, facet, min, max);
}

/* Whether the point, at x, faces a facet. */
static bool faces(const bw_mesh *mesh, int32_t facet, bool moved, const double x[3],
                  bwi_contact_point *point) {
  const int32_t *node = mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
  double weight[3], own[3], y[3] = {0}, off[3], size, along;
  bwi_boundary_normal(mesh, point->facet, point->hat, own);
  bwi_boundary_nearest(mesh, facet, x, weight);
  point->opposite = facet;
  bw_facet_shape(mesh->order, weight, point->far);
  bwi_boundary_normal(mesh, facet, weight, point->normal);
  size = bw_norm(point->normal);
  for (int a = 0; a < mesh->nodes_per_facet; a++)
    for (int i = 0; i < 3; i++)
      y[i] += point->far[a] * mesh->node[3 * (int64_t)node[a] + i];
  for (int i = 0; i < 3; i++) {
    point->normal[i] /= size;
    off[i] = x[i] - y[i];
  }
  point->apart = along = bw_dot(point->normal, off);
  for (int i = 0; i < 3; i++)
    off[i] -= along * point->normal[i];
  return bw_dot(own, point->normal) <= BWI_FACING * bw_norm(own) &&
         bw_norm(off) <= slant * fabs(along) + (moved ? beside_moved : beside) * sqrt(size);
}

bw_status bwi_contact_find_opposite(bw_context *context, const bw_mesh *mesh,
                                    const bw_contact_pair *pair, bool moved, int64_t count,
                                    bwi_contact_point *point) {
  bw_status status = BW_OK;
  bwi_box_tree tree = {0};
  int32_t *item = BW_NEW(context, int32_t, pair->against->facet_count);
  BW_TRY_MEMORY(item);
  memcpy(item, pair->against->facet, (size_t)pair->against->facet_count * sizeof *item);
  BW_TRY(
      bwi_box_tree_create(context, 3, LEAF, pair->against->facet_count, item, box_of, mesh, &tree));
  for (int64_t p = 0; p < count; p++) {
    const int32_t *node = mesh->facet + (int64_t)point[p].facet * mesh->nodes_per_facet;
    double x[3] = {0}, square;
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      for (int i = 0; i < 3; i++)
        x[i] += point[p].shape[a] * mesh->node[3 * (int64_t)node[a] + i];
    int32_t nearest = bwi_box_tree_nearest(&tree, x, distance_to, (void *)mesh, &square);
    if (nearest < 0 || !faces(mesh, nearest, moved, x, &point[p]))
      point[p].opposite = -1;
  }
done:
  bwi_box_tree_clear(&tree);
  return status;
}
