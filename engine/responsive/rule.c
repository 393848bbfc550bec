/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Quadrature rules with the shape functions of tri3 or tri6 at their points. */
#include "responsive/sheet.h"

void bwi_rule_create(int order, int degree, bwi_rule *rule) {
  double point[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
  rule->order = order;
  rule->n = order == 1 ? 3 : 6;
  rule->count = bw_triangle_quadrature(degree, point, weight);
  for (int q = 0; q < rule->count; q++) {
    double by_l[6][3];
    for (int k = 0; k < 3; k++)
      rule->point[q][k] = point[q][k];
    rule->weight[q] = 0.5 * weight[q];
    bw_facet_shape(order, point[q], rule->value[q]);
    bw_triangle_shape_gradient(order, point[q], by_l);
    for (int a = 0; a < rule->n; a++) {
      rule->slope[q][a][0] = by_l[a][1] - by_l[a][0];
      rule->slope[q][a][1] = by_l[a][2] - by_l[a][0];
    }
  }
}
