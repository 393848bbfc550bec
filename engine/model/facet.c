/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Geometry of single facets, on the boundary or inside, straight or curved.
 *
 * A facet is parametrised by barycentric coordinates; with g_k = dx/dL_k its normal
 * (g1 - g0) x (g2 - g0) has the size of twice the area that a unit of parameter area covers, so
 * that the integral of f is sum_p w_p f(x_p) |normal_p| / 2 with weights that sum to one. */
#include <math.h>
#include <string.h>

#include "mesh/locator.h"
#include "model/internal.h"

static const int32_t *nodes_of(const bw_mesh *mesh, int32_t facet) {
  return mesh->facet + (size_t)facet * (size_t)mesh->nodes_per_facet;
}

static void normal_of(const bw_mesh *mesh, const int32_t *node, const double barycentric[3],
                      double normal[3]) {
  double g[3][3] = {{0}}, a[3], b[3];
  for (int k = 0; k < 3; k++) {
    const double *x = mesh->node + 3 * (size_t)node[k];
    double slope = mesh->order == 1 ? 1 : 4 * barycentric[k] - 1;
    for (int i = 0; i < 3; i++)
      g[k][i] += slope * x[i];
  }
  for (int k = 0; k < 3 && mesh->order == 2; k++) { /* mid-edge nodes ab bc ca: N = 4 La Lb */
    const double *x = mesh->node + 3 * (size_t)node[3 + k];
    int l = (k + 1) % 3;
    for (int i = 0; i < 3; i++) {
      g[k][i] += 4 * barycentric[l] * x[i];
      g[l][i] += 4 * barycentric[k] * x[i];
    }
  }
  for (int i = 0; i < 3; i++) {
    a[i] = g[1][i] - g[0][i];
    b[i] = g[2][i] - g[0][i];
  }
  bw_cross(a, b, normal);
}

void bwi_boundary_normal(const bw_mesh *mesh, int32_t facet, const double barycentric[3],
                         double normal[3]) {
  normal_of(mesh, nodes_of(mesh, facet), barycentric, normal);
}

void bwi_boundary_normal_at(const bw_mesh *mesh, int32_t facet, int k, double normal[3]) {
  double barycentric[3] = {0, 0, 0};
  if (k < 3)
    barycentric[k] = 1;
  else
    barycentric[k - 3] = barycentric[(k - 2) % 3] = 0.5;
  bwi_boundary_normal(mesh, facet, barycentric, normal);
}

void bwi_boundary_box(const bw_mesh *mesh, int32_t facet, double *min, double *max) {
  const int32_t *node = nodes_of(mesh, facet);
  for (int i = 0; i < 3; i++) {
    min[i] = INFINITY;
    max[i] = -INFINITY;
    for (int k = 0; k < 3; k++) {
      min[i] = fmin(min[i], mesh->node[3 * (size_t)node[k] + (size_t)i]);
      max[i] = fmax(max[i], mesh->node[3 * (size_t)node[k] + (size_t)i]);
    }
  }
}

double bwi_boundary_nearest(const bw_mesh *mesh, int32_t facet, const double *p, double weight[3]) {
  const int32_t *node = nodes_of(mesh, facet);
  return bwi_triangle_weights(p, mesh->node + 3 * (size_t)node[0], mesh->node + 3 * (size_t)node[1],
                              mesh->node + 3 * (size_t)node[2], weight);
}

bw_status bwi_check_sides(bw_context *context, const bw_selection *a, const bw_selection *b,
                          const char *what) {
  for (int32_t i = 0, k = 0; i < a->node_count && k < b->node_count;) {
    if (a->node[i] == b->node[k]) {
      const double *x = a->mesh->node + 3 * (int64_t)a->node[i];
      bw_fail(
          context, BW_INVALID,
          "node %d at (%g, %g, %g) m is on both sides of %s surfaces that have no node in common",
          a->node[i] + 1, x[0], x[1], x[2], what);
      bw_detail_number(context, "node", a->node[i] + 1.0);
      return BW_INVALID;
    }
    if (a->node[i] < b->node[k])
      i++;
    else
      k++;
  }
  return BW_OK;
}

static bool is_straight(const bw_mesh *mesh, const int32_t *node) {
  if (mesh->order == 1)
    return true;
  for (int k = 0; k < 3; k++) {
    const double *a = mesh->node + 3 * (size_t)node[k];
    const double *b = mesh->node + 3 * (size_t)node[(k + 1) % 3];
    const double *middle = mesh->node + 3 * (size_t)node[3 + k];
    double off = 0, edge = 0;
    for (int i = 0; i < 3; i++) {
      double d = middle[i] - (a[i] + b[i]) / 2;
      off += d * d;
      edge += (b[i] - a[i]) * (b[i] - a[i]);
    }
    if (off > 1e-18 * edge)
      return false;
  }
  return true;
}

bool bwi_boundary_is_straight(const bw_mesh *mesh, int32_t facet) {
  return is_straight(mesh, nodes_of(mesh, facet));
}

int bwi_facet_points(const bw_mesh *mesh, const int32_t *node, bwi_boundary_point *point) {
  double barycentric[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
  /* Straight: shape (2) times position (2 at most, torque). Curved: the normal adds 2, its size is
   * a root, so a high degree. */
  int count =
      bw_triangle_quadrature(is_straight(mesh, node) ? 2 * mesh->order : 6, barycentric, weight);
  for (int p = 0; p < count; p++) {
    bw_facet_shape(mesh->order, barycentric[p], point[p].shape);
    normal_of(mesh, node, barycentric[p], point[p].area);
    memset(point[p].at, 0, sizeof point[p].at);
    for (int i = 0; i < 3; i++)
      point[p].area[i] *= weight[p] / 2;
    for (int a = 0; a < mesh->nodes_per_facet; a++)
      for (int i = 0; i < 3; i++)
        point[p].at[i] += point[p].shape[a] * mesh->node[3 * (size_t)node[a] + (size_t)i];
  }
  return count;
}

int bwi_boundary_points(const bw_mesh *mesh, int32_t facet, bwi_boundary_point *point) {
  return bwi_facet_points(mesh, nodes_of(mesh, facet), point);
}

bw_status bwi_facet_incidence_of(bw_context *context, const bw_mesh *mesh,
                                 bwi_facet_incidence *incidence) {
  int64_t entries = (int64_t)mesh->facet_count * mesh->nodes_per_facet;
  int64_t *start = BW_NEW0(context, int64_t, (size_t)mesh->node_count + 1);
  int64_t *list = BW_NEW(context, int64_t, entries);
  if (!start || !list) {
    bw_free(start);
    bw_free(list);
    return BW_MEMORY;
  }
  for (int64_t i = 0; i < entries; i++)
    start[mesh->facet[i] + 1]++;
  for (int32_t i = 0; i < mesh->node_count; i++)
    start[i + 1] += start[i];
  for (int64_t i = entries - 1; i >= 0; i--) /* ends as cursors: they become the starts */
    list[--start[mesh->facet[i] + 1]] = i / mesh->nodes_per_facet * 8 + i % mesh->nodes_per_facet;
  for (int32_t i = 0; i < mesh->node_count; i++)
    start[i] = start[i + 1];
  start[mesh->node_count] = entries;
  incidence->start = start;
  incidence->list = list;
  return BW_OK;
}

void bwi_facet_incidence_clear(bwi_facet_incidence *incidence) {
  bw_free(incidence->start);
  bw_free(incidence->list);
  incidence->start = incidence->list = NULL;
}
