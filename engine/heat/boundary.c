/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Heat through the boundary: fluxes, powers, convection and radiation, by quadrature of facets. */
#include "heat/internal.h"
#include "model/internal.h"

#include <math.h>

bool bwi_heat_is_film(const bw_heat_condition *condition) {
  return condition->kind == BW_HEAT_CONVECTION || condition->kind == BW_HEAT_RADIATION;
}

bool bwi_heat_joins(const bw_heat_condition *condition) {
  return condition->kind == BW_HEAT_CONTACT || condition->kind == BW_HEAT_BOND;
}

/* The flux into the body at a temperature of the surface, and how it falls for each kelvin. */
static double flux_at(const bw_heat_condition *c, double t, double *fall) {
  double s = BW_STEFAN_BOLTZMANN * c->coefficient, a = c->about, v = c->value;
  *fall = 0;
  switch (c->kind) {
  case BW_HEAT_FLUX:
    return c->value;
  case BW_HEAT_POWER:
    return c->value / c->size;
  case BW_HEAT_CONVECTION:
    *fall = c->coefficient;
    return c->coefficient * (v - t);
  case BW_HEAT_RADIATION:
    if (a > 0) { /* the secant between `about` and what is around */
      *fall = s * (a + v) * (a * a + v * v);
      return *fall * (v - t);
    }
    *fall = 4 * s * t * t * t;
    return s * (v * v * v * v - t * t * t * t);
  default:
    return 0;
  }
}

static double at_point(const bw_mesh *mesh, int32_t facet, const bwi_boundary_point *point,
                       const double *temperature) {
  const int32_t *node = mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
  double t = 0;
  for (int a = 0; temperature && a < mesh->nodes_per_facet; a++)
    t += point->shape[a] * temperature[node[a]];
  return t;
}

bw_status bwi_heat_boundary(bw_context *context, const bw_mesh *mesh,
                            const bw_heat_condition *condition, const double *temperature,
                            double *in, double *sum) {
  bwi_boundary_point point[BW_QUADRATURE_POINTS];
  *sum = 0;
  for (int32_t f = 0; f < condition->on->facet_count; f++) {
    int32_t facet = condition->on->facet[f];
    const int32_t *node = mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
    int points = bwi_boundary_points(mesh, facet, point);
    for (int p = 0; p < points; p++) {
      double fall, t = at_point(mesh, facet, &point[p], temperature);
      double heat = bw_norm(point[p].area) * flux_at(condition, t, &fall);
      if (condition->kind == BW_HEAT_RADIATION && !(condition->about > 0) && !(t >= 0))
        return bw_fail(context, BW_INVALID,
                       "the surface at (%g, %g, %g) m has a temperature of %g, and radiation needs "
                       "kelvin, from absolute zero: give all temperatures in kelvin, or look for a "
                       "flux out of the body that nothing can supply",
                       point[p].at[0], point[p].at[1], point[p].at[2], t);
      *sum += heat;
      for (int a = 0; a < mesh->nodes_per_facet; a++)
        in[node[a]] += point[p].shape[a] * heat;
    }
  }
  return BW_OK;
}

void bwi_heat_film(const bw_block_pattern *pattern, const bw_mesh *mesh,
                   const bw_heat_condition *condition, const double *temperature, double *values) {
  bwi_boundary_point point[BW_QUADRATURE_POINTS];
  for (int32_t f = 0; f < condition->on->facet_count; f++) {
    int32_t facet = condition->on->facet[f];
    const int32_t *node = mesh->facet + (int64_t)facet * mesh->nodes_per_facet;
    int n = mesh->nodes_per_facet, points = bwi_boundary_points(mesh, facet, point);
    double matrix[6][6] = {{0}};
    for (int p = 0; p < points; p++) {
      double fall;
      flux_at(condition, at_point(mesh, facet, &point[p], temperature), &fall);
      fall *= bw_norm(point[p].area);
      for (int a = 0; a < n; a++)
        for (int b = 0; b <= a; b++)
          matrix[a][b] += fall * point[p].shape[a] * point[p].shape[b];
    }
    for (int a = 0; a < n; a++)
      for (int b = 0; b <= a; b++)
        values[bwi_heat_block(pattern, node[a], node[b])] += matrix[a][b];
  }
}

int64_t bwi_heat_block(const bw_block_pattern *pattern, int32_t i, int32_t j) {
  int32_t row = i > j ? i : j, column = i > j ? j : i;
  int64_t low = pattern->start[row], high = pattern->start[row + 1] - 1;
  while (low < high) {
    int64_t middle = (low + high) / 2;
    if (pattern->column[middle] < column)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}
