/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How good the elements of an edited mesh are.
 *
 * The mean ratio of a tetrahedron compares it with the regular one W by the map J between them: the
 * geometric over the arithmetic mean of the squares of J's singular values, det(J)^(2/3) / (|J|^2 /
 * 3). In lengths and volume that is 12 (3 V)^(2/3) / (sum of squared edges). */
#include "shape/mesh_repair_internal.h"

#include <math.h>

static double edges_squared(const double *const x[4]) {
  double sum = 0;
  for (int i = 0; i < 4; i++)
    for (int j = i + 1; j < 4; j++)
      for (int k = 0; k < 3; k++)
        sum += (x[i][k] - x[j][k]) * (x[i][k] - x[j][k]);
  return sum;
}

static double quality_of(const double *const x[4], double determinant) {
  double sum = edges_squared(x);
  if (!(sum > 0))
    return 0; /* all in one point, or not numbers */
  double root = cbrt(0.5 * determinant);
  return copysign(12 * root * root / sum, determinant);
}

double bw_shape_quality(const double *a, const double *b, const double *c, const double *d) {
  const double *const x[4] = {a, b, c, d};
  return quality_of(x, bwi_tet_determinant(a, b, c, d, NULL));
}

double bwi_checked_quality(const double *const x[4]) {
  double error, determinant = bwi_tet_determinant(x[0], x[1], x[2], x[3], &error);
  double quality = quality_of(x, determinant);
  if (!isfinite(determinant) || !isfinite(quality))
    return -INFINITY;
  return determinant > error ? quality : fmin(quality, 0);
}

void bw_mesh_shape_check(const bw_mesh *mesh, const double *node, double floor,
                         bw_mesh_repair_report *report) {
  bw_mesh_repair_report r = {.worst = -1, .worst_before = INFINITY};
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *corner = mesh->element + (size_t)e * (size_t)mesh->nodes_per_element;
    const double *const x[4] = {node + 3 * (size_t)corner[0], node + 3 * (size_t)corner[1],
                                node + 3 * (size_t)corner[2], node + 3 * (size_t)corner[3]};
    double quality = bwi_checked_quality(x);
    r.inverted += quality <= 0 || quality < floor;
    if (quality < r.worst_before) {
      r.worst_before = quality;
      r.worst = e;
    }
  }
  r.worst_after = r.worst_before;
  *report = r;
}
