/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Moments of the volume of each body (of the mass where densities differ), and what the nodes need
 * for M times a rigid-body motion r = t + w x y, y = x - c.
 *
 * The shape functions reproduce positions, also of curved elements: x = sum N_j x_j. Hence
 *     (M r)_i = integral N_i r = t m_i + w x q_i,  m_i = integral N_i,  q_i = integral N_i y,
 * which is the consistent mass matrix times r with no sum over pairs, and the second moments are
 * integral y y^T = sum_i y_i q_i^T. Four numbers per node hold all of it. */
#include <string.h>

#include "model/internal.h"

void bwi_element_moments(int order, const double (*x)[3], double volume, double (*moment)[4]) {
  if (order == 1) {
    double sum[3];
    for (int k = 0; k < 3; k++)
      sum[k] = x[0][k] + x[1][k] + x[2][k] + x[3][k];
    for (int a = 0; a < 4; a++) {
      moment[a][0] = volume / 4;
      for (int k = 0; k < 3; k++)
        moment[a][1 + k] = volume / 20 * (sum[k] + x[a][k]);
    }
    return;
  }
  if (bw_tet_is_straight(x)) {
    /* N_a = L_a (2 L_a - 1), N_ab = 4 L_a L_b; integral L_a^i L_b^j ... = 6 V i! j! ... / (3+n)! */
    double sum[3];
    for (int k = 0; k < 3; k++)
      sum[k] = x[0][k] + x[1][k] + x[2][k] + x[3][k];
    for (int a = 0; a < 4; a++) {
      moment[a][0] = -volume / 20;
      for (int k = 0; k < 3; k++)
        moment[a][1 + k] = -volume / 60 * (sum[k] - x[a][k]);
    }
    for (int e = 0; e < 6; e++) {
      const double *xa = x[bw_tet_edge[e][0]], *xb = x[bw_tet_edge[e][1]];
      moment[4 + e][0] = volume / 5;
      for (int k = 0; k < 3; k++)
        moment[4 + e][1 + k] = volume / 30 * (sum[k] + xa[k] + xb[k]);
    }
    return;
  }
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  int points = bw_tet_quadrature(6, point, weight);
  memset(moment, 0, 10 * sizeof *moment);
  for (int p = 0; p < points; p++) {
    double shape[10], gradient[10][3], at[3] = {0, 0, 0};
    double size = bw_tet_gradient(2, x, point[p], gradient) / 6 * weight[p];
    bw_tet_shape(2, point[p], shape);
    for (int a = 0; a < 10; a++)
      for (int k = 0; k < 3; k++)
        at[k] += shape[a] * x[a][k];
    for (int a = 0; a < 10; a++) {
      moment[a][0] += size * shape[a];
      for (int k = 0; k < 3; k++)
        moment[a][1 + k] += size * shape[a] * at[k];
    }
  }
}

bw_status bwi_moments(bw_context *context, bw_dof_map *dof_map, const bw_material *material,
                      double *inertia) {
  const bw_mesh *mesh = dof_map->mesh;
  int32_t bodies = mesh->component_count;
  double *weight = dof_map->weight, *centre = dof_map->body_centre;
  double *volume = dof_map->body_volume;
  bool several =
      material && material->parts && material->density > 0; /* volumes count by density then */
  bw_status status = BW_OK;
  /* From the mean of the body's nodes first: no cancellation far from the origin. */
  int32_t *count = BW_NEW0(context, int32_t, bodies);
  double *reference = BW_NEW0(context, double, 3 * (size_t)bodies);
  BW_TRY_MEMORY(count && reference);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    int32_t body = mesh->component[i];
    count[body]++;
    for (int k = 0; k < 3; k++)
      reference[3 * (size_t)body + k] += mesh->node[3 * (size_t)i + k];
  }
  for (int32_t body = 0; body < bodies; body++)
    for (int k = 0; k < 3; k++)
      reference[3 * (size_t)body + k] /= count[body] ? count[body] : 1;

  memset(weight, 0, 4 * sizeof *weight * (size_t)mesh->node_count);
  for (int32_t e = 0; e < mesh->element_count; e++) {
    const int32_t *node = mesh->element + (size_t)e * (size_t)mesh->nodes_per_element;
    const double *from = reference + 3 * (size_t)mesh->component[node[0]];
    double x[10][3], moment[10][4];
    if (e % 65536 == 0)
      BW_TRY(bw_check_cancel(context));
    for (int a = 0; a < mesh->nodes_per_element; a++)
      for (int k = 0; k < 3; k++)
        x[a][k] = mesh->node[3 * (size_t)node[a] + k] - from[k];
    bwi_element_moments(mesh->order, (const double(*)[3])x, mesh->volume[e], moment);
    double relative = several ? bw_material_of(material, e)->density / material->density : 1;
    for (int a = 0; a < mesh->nodes_per_element; a++)
      for (int k = 0; k < 4; k++)
        weight[4 * (size_t)node[a] + k] += relative * moment[a][k];
  }
  memset(volume, 0, sizeof *volume * (size_t)bodies);
  memset(centre, 0, 3 * sizeof *centre * (size_t)bodies);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    int32_t body = mesh->component[i];
    volume[body] += weight[4 * (size_t)i];
    for (int k = 0; k < 3; k++)
      centre[3 * (size_t)body + k] += weight[4 * (size_t)i + 1 + k];
  }
  for (int32_t body = 0; body < bodies; body++) {
    if (!(volume[body] > 0))
      BW_TRY(bw_fail(context, BW_GEOMETRY, "body %d has the volume %g m3: it must be positive",
                     body + 1, volume[body]));
    for (int k = 0; k < 3; k++)
      centre[3 * (size_t)body + k] =
          centre[3 * (size_t)body + k] / volume[body] + reference[3 * (size_t)body + k];
  }
  memset(inertia, 0, 9 * sizeof *inertia * (size_t)bodies);
  for (int32_t i = 0; i < mesh->node_count; i++) {
    size_t body = (size_t)mesh->component[i];
    double *w = weight + 4 * (size_t)i, y[3];
    w[0] /= volume[body];
    for (int k = 0; k < 3; k++) {
      w[1 + k] = w[1 + k] / volume[body] - w[0] * (centre[3 * body + k] - reference[3 * body + k]);
      y[k] = mesh->node[3 * (size_t)i + k] - centre[3 * body + k];
    }
    for (int k = 0; k < 3; k++)
      for (int l = 0; l < 3; l++)
        inertia[9 * body + 3 * k + l] += y[k] * w[1 + l]; /* y y^T for now */
  }
  for (int32_t body = 0; body < bodies; body++) {
    double *j = inertia + 9 * (size_t)body, trace = j[0] + j[4] + j[8];
    for (int k = 0; k < 3; k++)
      for (int l = k; l < 3; l++)
        j[3 * k + l] = j[3 * l + k] = (k == l ? trace : 0) - (j[3 * k + l] + j[3 * l + k]) / 2;
  }
  if (several) {
    memset(volume, 0, sizeof *volume * (size_t)bodies);
    for (int32_t e = 0; e < mesh->element_count; e++)
      volume[mesh->component[mesh->element[(size_t)e * (size_t)mesh->nodes_per_element]]] +=
          mesh->volume[e];
  }
done:
  bw_free(count);
  bw_free(reference);
  return status;
}
