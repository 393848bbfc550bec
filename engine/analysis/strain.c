/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "analysis/strain.h"

#include <string.h>

/* On a straight tet10 div u is linear, so that the centre has the mean: the gradients of corners
 * vanish there. */
static double mean_dilatation(const bwi_element_state *s) {
  double sum = 0, whole = 0, point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  if (s->straight) {
    for (int m = 0; m < 6; m++)
      sum += bw_dot(s->u[4 + m], s->g[bw_tet_edge[m][0]]) +
             bw_dot(s->u[4 + m], s->g[bw_tet_edge[m][1]]);
    return sum;
  }
  int points = bw_tet_quadrature(BWI_CURVED_DEGREE, point, weight);
  for (int q = 0; q < points; q++) {
    double gradient[10][3];
    double volume =
        weight[q] * bw_tet_gradient(s->order, (const double(*)[3])s->x, point[q], gradient) / 6;
    whole += volume;
    for (int a = 0; a < s->nodes; a++)
      sum += volume * bw_dot(s->u[a], gradient[a]);
  }
  return sum / whole;
}

void bwi_element_state_load(const bw_mesh *mesh, const bw_material *material,
                            const double *displacement, int64_t element, bwi_element_state *s) {
  const int32_t *node = mesh->element + element * mesh->nodes_per_element;
  s->order = mesh->order;
  s->nodes = mesh->nodes_per_element;
  for (int a = 0; a < s->nodes; a++)
    memcpy(s->u[a], displacement + 3 * (int64_t)node[a], sizeof s->u[a]);
  s->straight = true;
  if (s->order == 2) {
    bwi_element_nodes(mesh, element, s->x);
    s->straight = bw_tet_is_straight((const double(*)[3])s->x);
  }
  s->volume = bw_tet_barycentric_gradient(
      mesh->node + 3 * (int64_t)node[0], mesh->node + 3 * (int64_t)node[1],
      mesh->node + 3 * (int64_t)node[2], mesh->node + 3 * (int64_t)node[3], s->g);
  s->projected = bwi_projected_bulk(mesh, bw_material_of(material, element));
  s->dilatation = s->projected > 0 ? mean_dilatation(s) : 0;
}

double bwi_strain_at(const bwi_element_state *s, const double (*by_l)[4], const double l[4],
                     double strain[6]) {
  double grad[9] = {0}, volume = s->volume;
  if (s->straight) {
    for (int k = 0; k < 4; k++) {
      double d[3] = {0};
      if (s->order == 1)
        memcpy(d, s->u[k], sizeof d);
      else
        for (int a = 0; a < 10; a++)
          for (int i = 0; i < 3; i++)
            d[i] += s->u[a][i] * by_l[a][k];
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          grad[3 * i + j] += d[i] * s->g[k][j];
    }
  } else {
    double gradient[10][3];
    volume = bw_tet_gradient(s->order, (const double(*)[3])s->x, l, gradient) / 6;
    for (int a = 0; a < s->nodes; a++)
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
          grad[3 * i + j] += s->u[a][i] * gradient[a][j];
  }
  bwi_strain_of(grad, strain);
  return volume;
}

void bwi_rule_make(int order, int degree, bwi_rule *rule) {
  rule->points = bw_tet_quadrature(degree, rule->l, rule->weight);
  for (int q = 0; q < rule->points; q++) {
    bw_tet_shape(order, rule->l[q], rule->value[q]);
    bw_tet_shape_gradient(order, rule->l[q], rule->by_l[q]);
  }
}

bw_status bwi_check_stress_input(bw_context *context, const bw_mesh *mesh,
                                 const bw_material *material, const double *displacement,
                                 const char *what) {
  if (material && displacement)
    return bw_material_fits(context, material, mesh->element_count);
  return bw_fail(context, BW_INVALID, "%s needs a %s", what,
                 material ? "displacement" : "material");
}
