/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How well shaped the triangles of a plane mesh are. */
#include "plane/internal.h"

#include <math.h>

static double square_between(const double a[2], const double b[2]) {
  return (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]);
}

double bwi_triangle_quality(const double a[2], const double b[2], const double c[2]) {
  double ab = square_between(a, b), bc = square_between(b, c), ca = square_between(c, a);
  double longest = sqrt(fmax(ab, fmax(bc, ca)));
  double product = (sqrt(ab) + sqrt(bc) + sqrt(ca)) * longest;
  /* inradius = twice the area / perimeter */
  return product > 0 ? 3.4641016151377544 * bwi_cross2(a, b, c) / product : 0;
}

/* The Jacobian J = x_r y_s - x_s y_r of a tri6 is a quadratic polynomial. With the Bezier points of
 * the position, P200 = corner 0, P110 = 2 m01 - (x0 + x1) / 2 and so on, the derivatives along the
 * edges 01 and 02 are linear with the coefficients d1 and d2 below (times 2); the Bernstein
 * coefficients of their cross product are the symmetrised products. */
double bwi_curved_quality(const double *x[6]) {
  double p[6][2], d1[3][2], d2[3][2], b[6], min = INFINITY, mean = 0;
  for (int k = 0; k < 2; k++) {
    for (int i = 0; i < 3; i++) {
      p[i][k] = x[i][k];
      p[3 + i][k] = 2 * x[3 + i][k] - (x[i][k] + x[(i + 1) % 3][k]) / 2;
    }
    /* at corners 0, 1, 2 */
    d1[0][k] = p[3][k] - p[0][k];
    d1[1][k] = p[1][k] - p[3][k];
    d1[2][k] = p[4][k] - p[5][k];
    d2[0][k] = p[5][k] - p[0][k];
    d2[1][k] = p[4][k] - p[3][k];
    d2[2][k] = p[2][k] - p[5][k];
  }
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3;
    b[i] = d1[i][0] * d2[i][1] - d1[i][1] * d2[i][0];
    b[3 + i] =
        (d1[i][0] * d2[j][1] - d1[i][1] * d2[j][0] + d1[j][0] * d2[i][1] - d1[j][1] * d2[i][0]) / 2;
  }
  for (int i = 0; i < 6; i++) {
    min = fmin(min, b[i]);
    mean += b[i] / 6;
  }
  return mean > 0 ? min / mean : min < 0 ? -1 : 0;
}

double bwi_plane_quality(const double *point, const int32_t *element, int order) {
  const double *x[6];
  for (int i = 0; i < (order == 2 ? 6 : 3); i++)
    x[i] = point + 2 * (size_t)element[i];
  double quality = bwi_triangle_quality(x[0], x[1], x[2]);
  if (order == 1)
    return quality;
  double curved = bwi_curved_quality(x);
  return quality > 0 || curved > 0 ? quality * fabs(curved) * (curved < 0 ? -1 : 1)
                                   : -fabs(quality * curved);
}

double bwi_plane_worst(const bw_plane_topology *topology, const double *point, int32_t *which) {
  int order = topology->nodes->order;
  size_t width = (size_t)bwi_plane_width(topology->nodes);
  double worst = INFINITY;
  for (int32_t e = 0; e < topology->element_count; e++) {
    double quality = bwi_plane_quality(point, topology->element + width * (size_t)e, order);
    if (!(quality >= worst)) { /* also what is no number */
      worst = quality == quality ? quality : -INFINITY;
      *which = e;
    }
  }
  return worst;
}

double bw_plane_element_quality(const bw_plane_mesh *mesh, int32_t element) {
  const bw_plane_topology *t = mesh->topology;
  return bwi_plane_quality(mesh->point,
                           t->element + (size_t)element * (size_t)bwi_plane_width(t->nodes),
                           t->nodes->order);
}

/* Area under the parabolic edge a m b, counted from its chord: two thirds of the triangle. */
static double bulge(const double a[2], const double b[2], const double m[2]) {
  return 2 * bwi_cross2(a, m, b) / 3;
}

void bw_plane_measure(const bw_plane_mesh *mesh, bw_plane_quality *quality) {
  const bw_plane_topology *t = mesh->topology;
  int order = t->nodes->order;
  size_t width = (size_t)bwi_plane_width(t->nodes);
  const double degree = 57.295779513082323;
  *quality = (bw_plane_quality){.worst = INFINITY, .smallest_angle = 180};
  for (int32_t e = 0; e < t->element_count; e++) {
    const int32_t *n = t->element + width * (size_t)e;
    const double *x[6];
    for (size_t i = 0; i < width; i++)
      x[i] = mesh->point + 2 * (size_t)n[i];
    double here = bwi_plane_quality(mesh->point, n, order);
    if (here < quality->worst) {
      quality->worst = here;
      quality->worst_element = e;
    }
    quality->inverted += !(here > 0);
    quality->mean += here;
    quality->area += bwi_cross2(x[0], x[1], x[2]) / 2;
    for (int i = 0; i < 3; i++) {
      const double *a = x[i], *b = x[(i + 1) % 3], *c = x[(i + 2) % 3];
      double dot = (b[0] - a[0]) * (c[0] - a[0]) + (b[1] - a[1]) * (c[1] - a[1]);
      double angle = fabs(atan2(bwi_cross2(a, b, c), dot)) * degree;
      quality->smallest_angle = fmin(quality->smallest_angle, angle);
      quality->largest_angle = fmax(quality->largest_angle, angle);
      if (order == 2)
        quality->area += bulge(a, b, x[3 + i]);
    }
  }
  quality->mean /= t->element_count;
}
