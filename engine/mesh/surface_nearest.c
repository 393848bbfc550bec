/* The facets of a surface that are nearest to points, and how far they are.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * A point that is nearest to an edge or a corner is as near to all facets there but for rounding,
 * which would choose one of them by chance. So the smallest distance is found first, then the first
 * facet that is as near to TIE times the largest coordinate. */
#include <math.h>
#include <string.h>

#include "barwright/sample.h"
#include "mesh/surface_tree.h"

static const double TIE = 1e-12;
enum { GRAIN = 512 };

typedef struct nearest {
  const bw_surface *surface;
  const bwi_tree *tree;
  const double *point;
  double tie;
  int32_t *facet;
  double *place, *distance;
} nearest;

static bw_status find_nearest(void *data, int64_t begin, int64_t end, int worker) {
  const nearest *n = (const nearest *)data;
  const bw_surface *surface = n->surface;
  int32_t hint = -1;
  double place[3];
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    const double *x = n->point + 3 * i;
    double square = bwi_tree_nearest(n->tree, x, hint, 0, place, &hint);
    if (n->facet || n->place) {
      double size = fmax(n->tie, TIE * fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2]))));
      int32_t first = bwi_tree_first_within(n->tree, x, sqrt(square) + size);
      if (first <
          0) /* of coordinates so large that squares overflow, or so small that they vanish */
        first = hint < 0 ? 0 : hint;
      const double *corner[3];
      for (int k = 0; k < 3; k++)
        corner[k] = surface->point + 3 * (int64_t)surface->triangle[3 * (int64_t)first + k];
      square = bwi_nearest_on_triangle(x, corner[0], corner[1], corner[2], place);
      if (n->facet)
        n->facet[i] = first;
      if (n->place)
        memcpy(n->place + 3 * i, place, sizeof place);
    }
    if (n->distance)
      n->distance[i] = sqrt(square);
  }
  return BW_OK;
}

bw_status bw_surface_nearest(bw_context *context, const bw_surface *surface, int64_t count,
                             const double *point, int32_t *facet, double *place, double *distance) {
  bw_status status = BW_OK;
  bwi_tree *tree = NULL;
  if (surface->triangle_count == 0)
    return bw_fail(context, BW_GEOMETRY, "the surface has no facets: no distance from it");
  for (int64_t i = 0; i < 3 * count; i++)
    if (!isfinite(point[i]))
      return bw_fail(context, BW_INVALID, "point %lld is not finite", (long long)(i / 3 + 1));
  double largest = 0;
  for (int64_t i = 0; i < 3 * (int64_t)surface->point_count; i++)
    largest = fmax(largest, fabs(surface->point[i]));
  BW_TRY(bwi_tree_create(context, surface->point, surface->triangle_count, surface->triangle, NULL,
                         &tree));
  nearest n = {surface, tree, point, TIE * largest, facet, place, distance};
  BW_TRY(bw_parallel(context, count, GRAIN, find_nearest, &n));
done:
  bwi_tree_destroy(tree);
  return status;
}

bw_status bw_surface_offsets(bw_context *context, const bw_surface *surface, int64_t count,
                             const double *point, double *distance) {
  return bw_surface_nearest(context, surface, count, point, NULL, NULL, distance);
}
