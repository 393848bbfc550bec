/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Quadrature rules with the shape functions of tri3 or tri6 at their points. */
#include <math.h>

#include "responsive/sheet.h"

void bwi_rule_create(int order, int degree, bwi_triangle_rule *rule) {
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

void bwi_rules_create(int order, bwi_rules *rules) {
  bwi_rule_create(order, order == 1 ? 1 : 2, &rules->straight);
  bwi_rule_create(order, order == 1 ? 1 : 4, &rules->curved);
}

/* A side counts as straight where its mid-edge node is within 1e-10 of its length from the
 * midpoint: what that leaves out is below rounding errors of the stiffness. */
const bwi_triangle_rule *bwi_rules_for(const bwi_rules *rules, const double (*x)[2]) {
  for (int a = 0; a < 3 && rules->straight.order == 2; a++) {
    const double *p = x[a], *q = x[(a + 1) % 3], *m = x[3 + a];
    double off = fabs(m[0] - 0.5 * (p[0] + q[0])) + fabs(m[1] - 0.5 * (p[1] + q[1]));
    if (off > 1e-10 * (fabs(q[0] - p[0]) + fabs(q[1] - p[1])))
      return &rules->curved;
  }
  return &rules->straight;
}
