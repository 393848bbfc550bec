/* How thick a body is under places of its surface: the way straight in until the wall on the other
 * side.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * The samples have equal parts of the area: sample k lies in the facet where the running sum of
 * areas passes (k + 1/2) / samples, at a place in it that a low-discrepancy sequence gives, so that
 * quantiles of the thicknesses are fractions of the area, and the same ones every time. */
#include <math.h>
#include <string.h>

#include "barwright/mesh.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_tree.h"

/* A segment from inside the surface, and the nearest wall on it so far (fraction of its length). */
typedef struct probe {
  const bw_surface *surface;
  double from[3], way[3];
  int32_t own;
  double nearest;
} probe;

static const double *corner(const bw_surface *surface, int32_t facet, int k) {
  return surface->point + 3 * (int64_t)surface->triangle[3 * (int64_t)facet + k];
}

/* Does the segment leave the body through the facet? Edges count for both neighbours: a ray that
 * hits one must not slip through. */
static bool visit(void *data, int32_t facet) {
  enum { X, Y, Z };
  static const double slack = 1e-9;
  probe *ray = (probe *)data;
  if (facet == ray->own)
    return true;
  const double *a = corner(ray->surface, facet, 0);
  double u[3], v[3], s[3], normal[3], moment[3];
  for (int k = 0; k < 3; k++) {
    u[k] = corner(ray->surface, facet, 1)[k] - a[k];
    v[k] = corner(ray->surface, facet, 2)[k] - a[k];
    s[k] = ray->from[k] - a[k];
  }
  bw_cross(u, v, normal);
  double along = bw_dot(normal, ray->way);
  if (along <= 0) /* in through this one, or past it */
    return true;
  bw_cross(s, ray->way, moment);
  double first = -bw_dot(v, moment) / along, second = bw_dot(u, moment) / along;
  double at = -bw_dot(normal, s) / along;
  if (first >= -slack && second >= -slack && first + second <= 1 + slack && at > 0 &&
      at < ray->nearest)
    ray->nearest = at;
  return true;
}

static double area_of(const bw_surface *surface, int32_t facet, double normal[3]) {
  double u[3], v[3];
  for (int k = 0; k < 3; k++) {
    u[k] = corner(surface, facet, 1)[k] - corner(surface, facet, 0)[k];
    v[k] = corner(surface, facet, 2)[k] - corner(surface, facet, 0)[k];
  }
  bw_cross(u, v, normal);
  return 0.5 * bw_norm(normal);
}

bw_status bw_surface_thickness(bw_context *context, const bw_surface *surface, int32_t samples,
                               double *thickness, double *place) {
  bw_status status = BW_OK;
  bwi_tree *tree = NULL;
  double total = 0, passed = 0, normal[3], reach = bwi_surface_diagonal(surface);
  int32_t done = 0;
  if (samples < 1)
    return bw_fail(context, BW_INVALID, "thickness: %d samples asked for, at least 1 expected",
                   (int)samples);
  for (int64_t t = 0; t < surface->triangle_count; t++)
    total += area_of(surface, (int32_t)t, normal);
  if (!(total > 0))
    return bw_fail(context, BW_GEOMETRY, "thickness: the surface has no area");
  BW_TRY(bwi_tree_create(context, surface->point, surface->triangle_count, surface->triangle, NULL,
                         &tree));
  for (int64_t t = 0; t < surface->triangle_count && done < samples; t++) {
    double area = area_of(surface, (int32_t)t, normal), length = 2 * area;
    passed += area;
    bool last = t == surface->triangle_count - 1;
    for (; done < samples && length > 0 && (last || (done + 0.5) / samples * total <= passed);
         done++) {
      if (done % 256 == 0)
        BW_TRY(bw_check_cancel(context));
      /* The plastic number's sequence, folded into the triangle. */
      double p = fmod(0.5 + 0.7548776662466927 * (done + 1), 1),
             q = fmod(0.5 + 0.5698402909980532 * (done + 1), 1);
      if (p + q > 1) {
        p = 1 - p;
        q = 1 - q;
      }
      probe ray = {.surface = surface, .own = (int32_t)t, .nearest = INFINITY};
      double to[3];
      for (int k = 0; k < 3; k++) {
        const double *a = corner(surface, (int32_t)t, 0);
        ray.from[k] = a[k] + p * (corner(surface, (int32_t)t, 1)[k] - a[k]) +
                      q * (corner(surface, (int32_t)t, 2)[k] - a[k]);
        ray.way[k] = -normal[k] / length * 1.001 * reach;
        to[k] = ray.from[k] + ray.way[k];
      }
      bwi_tree_on_segment(tree, ray.from, to, visit, &ray);
      thickness[done] = ray.nearest * 1.001 * reach;
      if (place)
        memcpy(place + 3 * (int64_t)done, ray.from, sizeof ray.from);
    }
  }
  for (; done < samples; done++) { /* the last facets had no area */
    thickness[done] = thickness[done > 0 ? done - 1 : 0];
    if (place)
      memcpy(place + 3 * (int64_t)done, place + 3 * (int64_t)(done > 0 ? done - 1 : 0),
             3 * sizeof *place);
  }
done:
  bwi_tree_destroy(tree);
  return status;
}
