/* Triangle surfaces: making, measuring, moving, welding.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Invariants of every bw_surface: each index lies in 0..point_count-1, each coordinate is finite.
 * Nothing else is promised: facets may repeat a point, edges may be open, shells may cross. */
#include <math.h>
#include <string.h>

#include "barwright/mesh.h"
#include "mesh/surface_internal.h"

static void surface_destroy(void *object) {
  bw_surface *surface = (bw_surface *)object;
  bw_free(surface->point);
  bw_free(surface->triangle);
  bw_free(surface->group);
  bw_release(surface->names);
  bw_free(surface);
}

static size_t surface_bytes(const void *object) {
  const bw_surface *surface = (const bw_surface *)object;
  return sizeof *surface + (size_t)surface->point_count * 3 * sizeof(double) +
         (size_t)surface->triangle_count * 3 * sizeof(int32_t) +
         (surface->group ? (size_t)surface->triangle_count * sizeof(int32_t) : 0);
}

static const bw_kind surface_kind = {"surface", surface_destroy, surface_bytes};

static bw_status check_arrays(bw_context *context, int64_t points, const double *point,
                              int64_t triangles, const int32_t *triangle) {
  if (points < 0 || triangles < 0)
    return bw_fail(context, BW_INVALID,
                   "a surface of %lld points and %lld facets: 0 or more of each expected",
                   (long long)points, (long long)triangles);
  if (points > INT32_MAX || triangles > INT32_MAX)
    return bw_fail(context, BW_LIMIT,
                   "a surface of %lld points and %lld facets: at most 2147483647 of each",
                   (long long)points, (long long)triangles);
  for (int64_t i = 0; i < points; i++)
    if (!isfinite(point[3 * i]) || !isfinite(point[3 * i + 1]) || !isfinite(point[3 * i + 2])) {
      bw_status status =
          bw_fail(context, BW_GEOMETRY,
                  "point %lld of the surface is (%g, %g, %g) m: every coordinate "
                  "must be a finite number",
                  (long long)i + 1, point[3 * i], point[3 * i + 1], point[3 * i + 2]);
      bw_detail_number(context, "point", (double)i + 1);
      return status;
    }
  for (int64_t t = 0; t < triangles; t++)
    for (int k = 0; k < 3; k++)
      if (triangle[3 * t + k] < 0 || triangle[3 * t + k] >= points) {
        bw_status status =
            bw_fail(context, BW_GEOMETRY,
                    "facet %lld of the surface names point %d, but the points are 1 to %lld",
                    (long long)t + 1, (int)triangle[3 * t + k] + 1, (long long)points);
        bw_detail_number(context, "facet", (double)t + 1);
        return status;
      }
  return BW_OK;
}

bw_status bw_surface_adopt(bw_context *context, int64_t points, double *point, int64_t triangles,
                           int32_t *triangle, int32_t *group, bw_surface **surface) {
  bw_status status = check_arrays(context, points, point, triangles, triangle);
  if (status != BW_OK)
    return status;
  bw_surface *made = BW_NEW0(context, bw_surface, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &surface_kind);
  made->point_count = (int32_t)points;
  made->triangle_count = (int32_t)triangles;
  made->point = point;
  made->triangle = triangle;
  made->group = group;
  *surface = made;
  return BW_OK;
}

bw_status bw_surface_copy(bw_context *context, int64_t points, const double *point,
                          int64_t triangles, const int32_t *triangle, const int32_t *group,
                          bw_surface **surface) {
  bw_status status = check_arrays(context, points, point, triangles, triangle);
  if (status != BW_OK)
    return status;
  double *own_point = BW_NEW(context, double, points * 3);
  int32_t *own_triangle = BW_NEW(context, int32_t, triangles * 3);
  int32_t *own_group = NULL;
  BW_TRY_MEMORY(own_point && own_triangle);
  if (points)
    memcpy(own_point, point, (size_t)points * 3 * sizeof *point);
  if (triangles)
    memcpy(own_triangle, triangle, (size_t)triangles * 3 * sizeof *triangle);
  if (group) {
    own_group = BW_NEW(context, int32_t, triangles);
    BW_TRY_MEMORY(own_group);
    if (triangles)
      memcpy(own_group, group, (size_t)triangles * sizeof *group);
  }
  BW_TRY(bw_surface_adopt(context, points, own_point, triangles, own_triangle, own_group, surface));
  return BW_OK;
done:
  bw_free(own_point);
  bw_free(own_triangle);
  bw_free(own_group);
  return status;
}

void bwi_keep_names(const bw_surface *from, bw_surface *to) {
  if (to->group && from->names && !to->names)
    to->names = bw_retain(from->names);
}

void bw_surface_box(const bw_surface *surface, double min[3], double max[3]) {
  for (int k = 0; k < 3; k++)
    min[k] = max[k] = surface->point_count ? surface->point[k] : 0;
  for (int64_t i = 1; i < surface->point_count; i++)
    for (int k = 0; k < 3; k++) {
      double x = surface->point[3 * i + k];
      min[k] = x < min[k] ? x : min[k];
      max[k] = x > max[k] ? x : max[k];
    }
}

double bwi_surface_diagonal(const bw_surface *surface) {
  double min[3], max[3];
  bw_surface_box(surface, min, max);
  double size[3] = {max[0] - min[0], max[1] - min[1], max[2] - min[2]};
  return bw_norm(size);
}

void bwi_facet_normal(const double *point, const int32_t *triangle, double normal[3]) {
  const double *a = point + 3 * (int64_t)triangle[0], *b = point + 3 * (int64_t)triangle[1],
               *c = point + 3 * (int64_t)triangle[2];
  double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
  double v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  bw_cross(u, v, normal);
}

double bw_surface_area(const bw_surface *surface) {
  double area = 0;
  for (int64_t t = 0; t < surface->triangle_count; t++) {
    double normal[3];
    bwi_facet_normal(surface->point, surface->triangle + 3 * t, normal);
    area += 0.5 * bw_norm(normal);
  }
  return area;
}

double bw_surface_volume(const bw_surface *surface) {
  /* Measured from the middle of the box: a far-away origin would cancel away digits. */
  double min[3], max[3], volume = 0;
  bw_surface_box(surface, min, max);
  double middle[3] = {0.5 * (min[0] + max[0]), 0.5 * (min[1] + max[1]), 0.5 * (min[2] + max[2])};
  for (int64_t t = 0; t < surface->triangle_count; t++)
    volume += bwi_facet_volume(surface->point, surface->triangle + 3 * t, middle);
  return volume;
}

double bwi_facet_volume(const double *point, const int32_t *triangle, const double origin[3]) {
  double normal[3];
  bwi_facet_normal(point, triangle, normal);
  const double *a = point + 3 * (int64_t)triangle[0];
  double arm[3] = {a[0] - origin[0], a[1] - origin[1], a[2] - origin[2]};
  return bw_dot(normal, arm) / 6;
}

bw_status bw_surface_transform(bw_context *context, const bw_surface *surface,
                               const double matrix[12], bw_surface **moved) {
  for (int k = 0; k < 12; k++)
    if (!isfinite(matrix[k]))
      return bw_fail(context, BW_INVALID,
                     "entry %d of the transformation is %g: it must be a finite number", k + 1,
                     matrix[k]);
  bw_surface *made = NULL;
  bw_status status = BW_OK;
  double *point = BW_NEW(context, double, (size_t)surface->point_count * 3);
  if (!point)
    return BW_MEMORY;
  for (int64_t i = 0; i < surface->point_count; i++)
    for (int k = 0; k < 3; k++) {
      const double *row = matrix + 4 * k, *x = surface->point + 3 * i;
      point[3 * i + k] = row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + row[3];
    }
  BW_TRY(bw_surface_copy(context, surface->point_count, point, surface->triangle_count,
                         surface->triangle, surface->group, &made));
  bwi_keep_names(surface, made);
  /* A mirror turns every facet inside out: turn them back. */
  double linear[9] = {matrix[0], matrix[1], matrix[2], matrix[4], matrix[5],
                      matrix[6], matrix[8], matrix[9], matrix[10]};
  double inverse[9];
  if (bw_inverse3(linear, inverse) < 0)
    for (int64_t t = 0; t < made->triangle_count; t++) {
      int32_t keep = made->triangle[3 * t + 1];
      made->triangle[3 * t + 1] = made->triangle[3 * t + 2];
      made->triangle[3 * t + 2] = keep;
    }
  *moved = made;
done:
  bw_free(point);
  return status;
}

bw_status bw_surface_scale(bw_context *context, const bw_surface *surface, double factor,
                           bw_surface **scaled) {
  if (!(factor > 0) || !isfinite(factor))
    return bw_fail(context, BW_INVALID, "scale factor %g: a positive number is needed", factor);
  const double matrix[12] = {factor, 0, 0, 0, 0, factor, 0, 0, 0, 0, factor, 0};
  return bw_surface_transform(context, surface, matrix, scaled);
}
