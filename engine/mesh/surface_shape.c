/* Closed surfaces by formula: box, sphere, cylinder.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include <math.h>
#include <string.h>

#include "barwright/mesh.h"

/* Gives a surface just made, which has groups 0 to count - 1, names for them, or releases it. */
static bw_status name_faces(bw_context *context, int32_t count, const bw_name *name,
                            const uint8_t *curved, bw_surface **surface) {
  bw_status status = bw_face_names_create(context, count, name, curved, &(*surface)->names);
  if (status != BW_OK) {
    bw_release(*surface);
    *surface = NULL;
  }
  return status;
}

bw_status bw_surface_box_shape(bw_context *context, const double min[3], const double max[3],
                               bw_surface **surface) {
  /* Corner i has bit k of i set where it is max along axis k. */
  static const int32_t triangle[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                       2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
  static const int32_t group[12] = {0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5};
  static const bw_name name[6] = {{"bottom"}, {"top"}, {"front"}, {"back"}, {"left"}, {"right"}};
  double point[24];
  for (int k = 0; k < 3; k++)
    if (!(min[k] < max[k]))
      return bw_fail(context, BW_INVALID, "a box from %g to %g m along %c: min must lie below max",
                     min[k], max[k], "xyz"[k]);
  for (int i = 0; i < 8; i++)
    for (int k = 0; k < 3; k++)
      point[3 * i + k] = i >> k & 1 ? max[k] : min[k];
  bw_status status = bw_surface_copy(context, 8, point, 12, triangle, group, surface);
  return status == BW_OK ? name_faces(context, 6, name, NULL, surface) : status;
}

/* An icosahedron, each facet cut in four `subdivisions` times, points on the sphere. */
bw_status bw_surface_sphere_shape(bw_context *context, const double centre[3], double radius,
                                  int subdivisions, bw_surface **surface) {
  static const int facet[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                   {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                   {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                   {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  if (!(radius > 0) || subdivisions < 0 || subdivisions > 9)
    return bw_fail(context, BW_INVALID,
                   "a sphere of radius %g m with %d subdivisions: a positive radius and 0 to 9 "
                   "subdivisions expected",
                   radius, subdivisions);
  bw_status status = BW_OK;
  bw_surface *loose = NULL;
  size_t count = 20, all = (size_t)20 << (2 * subdivisions);
  double *corner = BW_NEW(context, double, 9 * all), *next = BW_NEW(context, double, 9 * all);
  int32_t *triangle = BW_NEW(context, int32_t, 3 * all);
  int32_t *group = BW_NEW0(context, int32_t, all);
  BW_TRY_MEMORY(corner && next && triangle && group);
  double g = 0.5 * (1 + sqrt(5.0)), s = 1 / sqrt(1 + g * g), l = g * s;
  const double vertex[12][3] = {{-s, l, 0}, {s, l, 0}, {-s, -l, 0}, {s, -l, 0},
                                {0, -s, l}, {0, s, l}, {0, -s, -l}, {0, s, -l},
                                {l, 0, -s}, {l, 0, s}, {-l, 0, -s}, {-l, 0, s}};
  for (int t = 0; t < 20; t++)
    for (int k = 0; k < 3; k++)
      memcpy(corner + 9 * t + 3 * k, vertex[facet[t][k]], 3 * sizeof(double));
  for (int cut = 0; cut < subdivisions; cut++) {
    for (size_t t = 0; t < count; t++) {
      const double *x = corner + 9 * t;
      double m[3][3]; /* midpoints of 01 12 20, on the sphere; the same from both facets */
      for (int k = 0; k < 3; k++) {
        const double *a = x + 3 * k, *b = x + 3 * ((k + 1) % 3);
        for (int i = 0; i < 3; i++)
          m[k][i] = a[i] + b[i];
        double length = bw_norm(m[k]);
        for (int i = 0; i < 3; i++)
          m[k][i] /= length;
      }
      const double *piece[4][3] = {
          {x, m[0], m[2]}, {m[0], x + 3, m[1]}, {m[2], m[1], x + 6}, {m[0], m[1], m[2]}};
      for (int p = 0; p < 4; p++)
        for (int k = 0; k < 3; k++)
          memcpy(next + 36 * t + 9 * p + 3 * k, piece[p][k], 3 * sizeof(double));
    }
    count *= 4;
    double *keep = corner;
    corner = next;
    next = keep;
  }
  for (size_t i = 0; i < 3 * all; i++) {
    triangle[i] = (int32_t)i;
    for (int k = 0; k < 3; k++)
      corner[3 * i + k] = centre[k] + radius * corner[3 * i + k];
  }
  BW_TRY(
      bw_surface_copy(context, (int64_t)(3 * all), corner, (int64_t)all, triangle, group, &loose));
  BW_TRY(bw_surface_weld(context, loose, 0, surface));
  status = name_faces(context, 1, &(bw_name){"sphere"}, (const uint8_t[]){1}, surface);
done:
  bw_release(loose);
  bw_free(corner);
  bw_free(next);
  bw_free(triangle);
  bw_free(group);
  return status;
}

bw_status bw_surface_cylinder_shape(bw_context *context, const double base[3], const double axis[3],
                                    double radius, int segments, bw_surface **surface) {
  double height = bw_norm(axis);
  if (!(radius > 0) || !(height > 0) || segments < 3 || segments > 1000000)
    return bw_fail(context, BW_INVALID,
                   "a cylinder of radius %g m, height %g m and %d segments: positive lengths and 3 "
                   "to 1000000 segments are needed",
                   radius, height, segments);
  static const bw_name name[3] = {{"bottom"}, {"top"}, {"side"}};
  static const uint8_t curved[3] = {0, 0, 1};
  bw_status status = BW_OK;
  double *point = BW_NEW(context, double, 6 * (size_t)segments + 6);
  int32_t *triangle = BW_NEW(context, int32_t, 12 * (size_t)segments);
  int32_t *group = BW_NEW(context, int32_t, 4 * (size_t)segments);
  BW_TRY_MEMORY(point && triangle && group);
  /* u, v: across the axis, u x v along it */
  double along[3], u[3], v[3];
  for (int k = 0; k < 3; k++)
    along[k] = axis[k] / height;
  bw_across(along, u, v);
  int32_t min = 2 * segments, max = min + 1; /* the centres of the caps */
  for (int i = 0; i < segments; i++) {
    double turn = 2 * 3.14159265358979323846 * i / segments;
    for (int k = 0; k < 3; k++) {
      double x = base[k] + radius * (cos(turn) * u[k] + sin(turn) * v[k]);
      point[3 * (int64_t)i + k] = x;
      point[3 * ((int64_t)segments + i) + k] = x + axis[k];
    }
    int32_t a = i, b = (i + 1) % segments, c = a + segments, d = b + segments;
    const int32_t facet[12] = {a, b, d, a, d, c, b, a, min, c, d, max};
    static const int32_t own[4] = {2, 2, 0, 1};
    memcpy(triangle + 12 * (int64_t)i, facet, sizeof facet);
    memcpy(group + 4 * (int64_t)i, own, sizeof own);
  }
  for (int k = 0; k < 3; k++) {
    point[3 * (int64_t)min + k] = base[k];
    point[3 * (int64_t)max + k] = base[k] + axis[k];
  }
  BW_TRY(bw_surface_copy(context, 2 * (int64_t)segments + 2, point, 4 * (int64_t)segments, triangle,
                         group, surface));
  status = name_faces(context, 3, name, curved, surface);
done:
  bw_free(point);
  bw_free(triangle);
  bw_free(group);
  return status;
}
