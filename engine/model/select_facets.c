/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Selections by the direction of facets: a cone of normals, a patch inside sharp edges. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "model/internal.h"

static const double pi = 3.14159265358979323846;

/* The unit normal of a facet's three corners; false for one without area. */
static bool corner_normal(const bw_mesh *mesh, int32_t facet, double normal[3]) {
  const int32_t *node = mesh->facet + (size_t)facet * (size_t)mesh->nodes_per_facet;
  const double *x = mesh->node + 3 * (size_t)node[0], *p = mesh->node + 3 * (size_t)node[1];
  const double *q = mesh->node + 3 * (size_t)node[2];
  double a[3] = {p[0] - x[0], p[1] - x[1], p[2] - x[2]};
  double b[3] = {q[0] - x[0], q[1] - x[1], q[2] - x[2]};
  bw_cross(a, b, normal);
  double size = bw_norm(normal);
  for (int k = 0; k < 3; k++)
    normal[k] /= size > 0 ? size : 1;
  return size > 0;
}

/* The angle between unit vectors, exact also near 0 and pi. */
static double angle_between(const double a[3], const double b[3]) {
  double c[3];
  bw_cross(a, b, c);
  return atan2(bw_norm(c), bw_dot(a, b));
}

static bw_status check_angle(bw_context *context, const char *what, double angle) {
  if (!(angle >= 0 && angle <= pi))
    return bw_fail(context, BW_INVALID, "%s selection: the angle %g is not within 0 and pi radians",
                   what, angle);
  return BW_OK;
}

bw_status bw_select_normal_cone(bw_context *context, const bw_mesh *mesh, const double direction[3],
                                double angle, bw_selection **selection) {
  uint8_t *facet = NULL;
  double axis[3], min = HUGE_VAL;
  bw_status status;
  BW_TRY(check_angle(context, "normal", angle));
  double max = fmax(fabs(direction[0]), fmax(fabs(direction[1]), fabs(direction[2])));
  if (!(max > 0) || !isfinite(direction[0] + direction[1] + direction[2]))
    BW_TRY(bw_fail(
        context, BW_INVALID,
        "normal selection: (%g, %g, %g) has no direction: a finite vector that is not 0 expected",
        direction[0], direction[1], direction[2]));
  for (int k = 0; k < 3; k++)
    axis[k] = direction[k] / max;
  double size = bw_norm(axis);
  for (int k = 0; k < 3; k++)
    axis[k] /= size;
  facet = BW_NEW0(context, uint8_t, mesh->facet_count);
  BW_TRY_MEMORY(facet);
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    double normal[3];
    if (!corner_normal(mesh, f, normal))
      continue;
    double a = angle_between(axis, normal);
    min = fmin(min, a);
    facet[f] = a <= angle;
  }
  char along[96], degrees[40], nearest[40], what[300];
  bwi_vector_string(along, sizeof along, axis, 4, 0);
  bwi_number_string(degrees, sizeof degrees, angle * 180 / pi, 4, 0);
  bwi_number_string(nearest, sizeof nearest, min * 180 / pi, 4, 0);
  snprintf(what, sizeof what,
           "the cone of normals within %s degrees of %s (the nearest normal is %s degrees off)",
           degrees, along, nearest);
  BW_TRY(bwi_selection_make(context, mesh, facet, NULL, what, -1, 0, selection));
done:
  bw_free(facet);
  return status;
}

/* Square of the distance from a point to a triangle: on the face, on an edge, or at a corner. */
static double triangle_distance(const double point[3], const double *const x[3]) {
  double min = HUGE_VAL;
  double a[3], b[3], n[3], p[3];
  for (int k = 0; k < 3; k++) {
    a[k] = x[1][k] - x[0][k];
    b[k] = x[2][k] - x[0][k];
    p[k] = point[k] - x[0][k];
  }
  bw_cross(a, b, n);
  double nn = bw_dot(n, n);
  if (nn > 0) {
    double c[3];
    bw_cross(a, p, c);
    double v = bw_dot(c, n) / nn;
    bw_cross(p, b, c);
    double u = bw_dot(c, n) / nn;
    if (u >= 0 && v >= 0 && u + v <= 1) {
      double h = bw_dot(p, n);
      return h * h / nn;
    }
  }
  for (int e = 0; e < 3; e++) {
    const double *from = x[e], *to = x[(e + 1) % 3];
    double edge[3], d[3];
    for (int k = 0; k < 3; k++) {
      edge[k] = to[k] - from[k];
      d[k] = point[k] - from[k];
    }
    double length = bw_dot(edge, edge), t = length > 0 ? bw_dot(edge, d) / length : 0;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    for (int k = 0; k < 3; k++)
      d[k] -= t * edge[k];
    min = fmin(min, bw_dot(d, d));
  }
  return min;
}

/* The neighbour test of a patch: does facet f have the edge a b? */
static bool has_edge(const bw_mesh *mesh, int32_t f, int32_t a, int32_t b) {
  const int32_t *node = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
  return (node[0] == a || node[1] == a || node[2] == a) &&
         (node[0] == b || node[1] == b || node[2] == b);
}

bw_status bw_select_patch(bw_context *context, const bw_mesh *mesh, const double point[3],
                          double angle, bw_selection **selection) {
  bwi_facet_incidence at = {NULL, NULL};
  uint8_t *facet = NULL;
  int32_t *stack = NULL, depth = 0, first = -1;
  double min = HUGE_VAL;
  bw_status status;
  BW_TRY(check_angle(context, "patch", angle));
  if (!isfinite(point[0] + point[1] + point[2]))
    BW_TRY(bw_fail(context, BW_INVALID, "patch selection: the point is not finite"));
  BW_TRY(bwi_facet_incidence_of(context, mesh, &at));
  facet = BW_NEW0(context, uint8_t, mesh->facet_count);
  stack = BW_NEW(context, int32_t, mesh->facet_count);
  BW_TRY_MEMORY(facet && stack);
  for (int32_t f = 0; f < mesh->facet_count; f++) {
    const int32_t *node = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
    const double *const x[3] = {mesh->node + 3 * (size_t)node[0], mesh->node + 3 * (size_t)node[1],
                                mesh->node + 3 * (size_t)node[2]};
    double d = triangle_distance(point, x);
    if (d < min) {
      min = d;
      first = f;
    }
  }
  if (first >= 0) {
    facet[first] = 1;
    stack[depth++] = first;
  }
  while (depth > 0) {
    int32_t f = stack[--depth];
    const int32_t *node = mesh->facet + (size_t)f * (size_t)mesh->nodes_per_facet;
    double normal[3], other[3];
    bool flat = !corner_normal(mesh, f, normal); /* a sliver has no say */
    for (int e = 0; e < 3; e++) {
      int32_t a = node[e], b = node[(e + 1) % 3];
      for (int64_t i = at.start[a]; i < at.start[a + 1]; i++) {
        int32_t g = (int32_t)(at.list[i] / 8);
        if (facet[g] || !has_edge(mesh, g, a, b))
          continue;
        if (flat || !corner_normal(mesh, g, other) || angle_between(normal, other) <= angle) {
          facet[g] = 1;
          stack[depth++] = g;
        }
      }
    }
  }
  BW_TRY(bwi_selection_make(context, mesh, facet, NULL, "the patch", -1, 0, selection));
done:
  bwi_facet_incidence_clear(&at);
  bw_free(facet);
  bw_free(stack);
  return status;
}
