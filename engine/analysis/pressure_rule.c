/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Points, weights and functions of the pressures of a facet. */
#include "analysis/load_program.h"
#include "analysis/pressure.h"
#include "barwright/element.h"

#include <string.h>

/* Displacement (2) times the normal of a curved facet (2), and a hat function (1). */
enum { CELL_DEGREE = 4, HAT_DEGREE = 6 };

static bw_status allocate(bw_context *context, int pressures, int points, int per_point,
                          bwi_pressure_rule *rule) {
  rule->pressures = pressures;
  rule->points = points;
  rule->per_point = per_point;
  rule->barycentric = (double(*)[3])BW_NEW(context, double, 3 * points);
  rule->weight = BW_NEW(context, double, points);
  rule->which = BW_NEW(context, int, points *per_point);
  rule->value = BW_NEW(context, double, points *per_point);
  rule->middle = (double(*)[3])BW_NEW0(context, double, 3 * pressures);
  rule->nearest = BW_NEW(context, int, pressures);
  rule->force = (double(*)[6])BW_NEW0(context, double, 6 * pressures);
  rule->area = BW_NEW0(context, double, pressures);
  return rule->barycentric && rule->weight && rule->which && rule->value && rule->middle &&
                 rule->nearest && rule->force && rule->area
             ? BW_OK
             : BW_MEMORY;
}

static bw_status make_hats(bw_context *context, bwi_pressure_rule *rule) {
  double point[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
  int points = bw_triangle_quadrature(HAT_DEGREE, point, weight);
  bw_status status = allocate(context, 3, points, 3, rule);
  if (status != BW_OK)
    return status;
  for (int q = 0; q < points; q++) {
    rule->weight[q] = weight[q];
    for (int i = 0; i < 3; i++) {
      rule->barycentric[q][i] = point[q][i];
      rule->which[3 * q + i] = i;
      rule->value[3 * q + i] = point[q][i];
    }
  }
  for (int i = 0; i < 3; i++) {
    rule->nearest[i] = i;
    rule->middle[i][i] = 1;
  }
  return BW_OK;
}

/* The node of a facet nearest to a point, by barycentric coordinates; corners are nodes 0 to 2. */
static int nearest_node(const double l[3], int nodes) {
  int nearest = 0;
  double min = 10;
  for (int a = 0; a < nodes; a++) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
      double at = a < 3 ? k == a : 0.5 * (k == a - 3 || k == (a - 2) % 3);
      sum += (l[k] - at) * (l[k] - at);
    }
    if (sum < min - 1e-9) {
      min = sum;
      nearest = a;
    }
  }
  return nearest;
}

/* Cell (i, j) has its corners at (i, j), (i + 1, j), (i, j + 1) of a grid of so many steps along
 * both edges from the last corner; the cells between them are turned by 180 degrees. */
static bw_status make_cells(bw_context *context, int parts, int nodes, bwi_pressure_rule *rule) {
  double point[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
  int per_cell = bw_triangle_quadrature(CELL_DEGREE, point, weight), cell = 0;
  bw_status status = allocate(context, parts * parts, parts * parts * per_cell, 1, rule);
  if (status != BW_OK)
    return status;
  for (int turned = 0; turned < 2; turned++)
    for (int i = 0; i < parts - turned; i++)
      for (int j = 0; i + j < parts - turned; j++, cell++) {
        const int corner[2][3][2] = {{{i, j}, {i + 1, j}, {i, j + 1}},
                                     {{i + 1, j + 1}, {i, j + 1}, {i + 1, j}}};
        for (int q = 0; q < per_cell; q++) {
          int at = cell * per_cell + q;
          double *l = rule->barycentric[at];
          l[0] = l[1] = 0;
          for (int c = 0; c < 3; c++)
            for (int k = 0; k < 2; k++)
              l[k] += point[q][c] * corner[turned][c][k] / parts;
          l[2] = 1 - l[0] - l[1];
          rule->weight[at] = weight[q] / (parts * parts);
          rule->which[at] = cell;
          rule->value[at] = 1;
          for (int k = 0; k < 3; k++)
            rule->middle[cell][k] += weight[q] * l[k];
        }
        rule->nearest[cell] = nearest_node(rule->middle[cell], nodes);
      }
  return BW_OK;
}

static void find_means(int nodes, bwi_pressure_rule *rule) {
  for (int q = 0; q < rule->points; q++) {
    double shape[6];
    bw_facet_shape(nodes == 6 ? 2 : 1, rule->barycentric[q], shape);
    for (int k = rule->per_point * q; k < rule->per_point * (q + 1); k++) {
      double w = rule->weight[q] * rule->value[k];
      rule->area[rule->which[k]] += w;
      for (int a = 0; a < nodes; a++)
        rule->force[rule->which[k]][a] += w * shape[a];
    }
  }
}

bw_status bwi_pressure_rules_create(bw_context *context, const bw_pressure_basis *basis,
                                    bwi_pressure_rules *rules) {
  int nodes = basis->mesh->nodes_per_facet;
  memset(rules, 0, sizeof *rules);
  for (int32_t f = 0; f < basis->mesh->facet_count; f++) {
    int parts = basis->parts[f];
    bwi_pressure_rule *rule = &rules->rule[parts];
    if (rule->pressures > 0)
      continue;
    bw_status status =
        parts == 0 ? make_hats(context, rule) : make_cells(context, parts, nodes, rule);
    if (status != BW_OK) {
      bwi_pressure_rules_clear(rules);
      return status;
    }
    find_means(nodes, rule);
  }
  return BW_OK;
}

void bwi_pressure_rules_clear(bwi_pressure_rules *rules) {
  for (int s = 0; s <= BWI_MAX_PARTS; s++) {
    bwi_pressure_rule *rule = &rules->rule[s];
    bw_free(rule->barycentric);
    bw_free(rule->weight);
    bw_free(rule->which);
    bw_free(rule->value);
    bw_free(rule->middle);
    bw_free(rule->nearest);
    bw_free(rule->force);
    bw_free(rule->area);
  }
  memset(rules, 0, sizeof *rules);
}

const bwi_pressure_rule *bwi_facet_rule(const bwi_pressure_rules *rules,
                                        const bw_pressure_basis *basis, int32_t facet) {
  return &rules->rule[basis->parts[facet]];
}

void bwi_area_vector(const double (*x)[3], const double l[3], double normal[3]) {
  /* Derivatives of the six functions by L0, L1, L2, then along the two edges from corner 0. */
  const double by[6][3] = {{4 * l[0] - 1, 0, 0},    {0, 4 * l[1] - 1, 0},
                           {0, 0, 4 * l[2] - 1},    {4 * l[1], 4 * l[0], 0},
                           {0, 4 * l[2], 4 * l[1]}, {4 * l[2], 0, 4 * l[0]}};
  double u[3] = {0, 0, 0}, v[3] = {0, 0, 0};
  for (int a = 0; a < 6; a++)
    for (int k = 0; k < 3; k++) {
      u[k] += (by[a][1] - by[a][0]) * x[a][k];
      v[k] += (by[a][2] - by[a][0]) * x[a][k];
    }
  bw_cross(u, v, normal);
}
