/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Pressure with friction: Coulomb's cone at every pressure by the pyramid of m edges inscribed in
 * it (docs/theory/worst_case.md, section 15).
 *
 * Column k of a node, or a cell, with the pressure p has the traction p (-n + friction d_k), d_k
 * the unit tangent at the angle 2 pi k / m. Tangents are given once for each node, orthogonal to
 * the mean normal of its facets, and turned onto each facet by the shortest rotation from the mean
 * normal to the facet's: so they are unit tangents at every point of every facet, and neighbouring
 * points have neighbouring tangents.
 *
 * Invariants: columns of a pressure are consecutive and have the rows of the column without
 * friction; for every pressure the columns' mean is that column. */
#include "analysis/load_program.h"
#include "analysis/pressure.h"
#include "barwright/element.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

typedef struct friction_work {
  const bw_pressure_basis *plain;
  bwi_pressure_rules rules;
  double *normal;  /* plain count x 3: mean, unit */
  double *tangent; /* plain entries x 6: integrals of L phi e1 dA and L phi e2 dA */
} friction_work;

/* The mean normal of a node's facets: what a unit pressure there presses against. */
static void mean_normal(const bw_pressure_basis *plain, int32_t j, double n[3]) {
  memset(n, 0, 3 * sizeof *n);
  for (int64_t e = plain->start[j]; e < plain->start[j + 1]; e++)
    for (int k = 0; k < 3; k++)
      n[k] -= plain->coefficient[3 * e + k];
  double length = bw_norm(n);
  for (int k = 0; k < 3; k++)
    n[k] = length > 1e-9 * plain->area[j] ? n[k] / length : k == 2;
}

/* Two unit vectors that make a right-handed frame with n. The axis they start from changes only
 * where n is far from both: rounding in n does not turn the frame over. */
static void frame_of(const double n[3], double e1[3], double e2[3]) {
  const double axis[3] = {fabs(n[0]) < 0.9, !(fabs(n[0]) < 0.9), 0};
  bw_cross(axis, n, e2);
  double length = bw_norm(e2);
  for (int k = 0; k < 3; k++)
    e2[k] /= length;
  bw_cross(e2, n, e1);
}

/* v by the shortest rotation from the unit vector a to b; where they are opposite, by the half turn
 * about `axis`, a unit vector orthogonal to both. */
static void rotate(const double a[3], const double b[3], const double axis[3], const double v[3],
                   double out[3]) {
  double w[3], c = bw_dot(a, b), wv[3];
  if (c < -1 + 1e-9) {
    for (int k = 0; k < 3; k++)
      out[k] = 2 * bw_dot(axis, v) * axis[k] - v[k];
    return;
  }
  bw_cross(a, b, w);
  bw_cross(w, v, wv);
  for (int k = 0; k < 3; k++)
    out[k] = c * v[k] + wv[k] + bw_dot(w, v) / (1 + c) * w[k];
}

static int64_t find_entry(const bw_pressure_basis *plain, int32_t j, int32_t node) {
  int64_t e = plain->start[j];
  while (plain->row[e] != node)
    e++;
  return e;
}

static void add_facet(friction_work *w, int32_t f) {
  const bw_pressure_basis *plain = w->plain;
  const bw_mesh *mesh = plain->mesh;
  const bwi_pressure_rule *rule = bwi_facet_rule(&w->rules, plain, f);
  int nodes = mesh->nodes_per_facet;
  const int32_t *node = mesh->facet + (size_t)f * (size_t)nodes;
  double x[6][3];
  for (int a = 0; a < 6; a++) {
    for (int k = 0; k < 3; k++) {
      const double *p = mesh->node + k;
      int c = a - 3, d = (a - 2) % 3; /* the ends of a side */
      x[a][k] =
          a < nodes
              ? p[3 * (size_t)node[a]]
              : 0.5 * (p[3 * (size_t)node[c < 0 ? 0 : c]] + p[3 * (size_t)node[d < 0 ? 0 : d]]);
    }
  }
  for (int q = 0; q < rule->points; q++) {
    double n[3], shape[6];
    bwi_area_vector((const double(*)[3])x, rule->barycentric[q], n);
    double size = bw_norm(n);
    bw_facet_shape(nodes == 6 ? 2 : 1, rule->barycentric[q], shape);
    for (int i = rule->per_point * q; i < rule->per_point * (q + 1); i++) {
      int32_t j = plain->facet_column[plain->facet_start[f] + rule->which[i]];
      if (j < 0)
        continue;
      const double *mean = w->normal + 3 * (size_t)j;
      double e1[3], e2[3], t1[3], t2[3], unit[3];
      for (int k = 0; k < 3; k++)
        unit[k] = size > 0 ? n[k] / size : mean[k];
      frame_of(mean, e1, e2);
      rotate(mean, unit, e1, e1, t1);
      rotate(mean, unit, e1, e2, t2);
      for (int a = 0; a < nodes; a++) {
        double *to = w->tangent + 6 * find_entry(plain, j, node[a]);
        double weight = 0.5 * rule->weight[q] * size * rule->value[i] * shape[a];
        for (int k = 0; k < 3; k++) {
          to[k] += weight * t1[k];
          to[3 + k] += weight * t2[k];
        }
      }
    }
  }
}

static bw_status expand(bw_context *context, const friction_work *w,
                        const bw_pressure_options *options, bw_pressure_basis *basis) {
  const bw_pressure_basis *plain = w->plain;
  int64_t m = options->friction_facets, columns = m * plain->count;
  int64_t entries = m * plain->start[plain->count], at = 0;
  if (columns >= INT32_MAX)
    return bw_fail(context, BW_UNSUPPORTED,
                   "%d pressures with a friction cone of %d facets: fewer facets or a coarser mesh",
                   plain->count, options->friction_facets);
  basis->node = BW_NEW(context, int32_t, columns);
  basis->at = BW_NEW(context, double, 3 * columns);
  basis->area = BW_NEW(context, double, columns);
  basis->start = BW_NEW(context, int64_t, columns + 1);
  basis->row = BW_NEW(context, int32_t, entries);
  basis->coefficient = BW_NEW(context, double, 3 * entries);
  if (!basis->node || !basis->at || !basis->area || !basis->start || !basis->row ||
      !basis->coefficient)
    return BW_MEMORY;
  for (int32_t j = 0; j < plain->count; j++)
    for (int64_t k = 0; k < m; k++) {
      double angle = 2 * pi * (double)k / (double)m;
      double c = options->friction * cos(angle), s = options->friction * sin(angle);
      basis->node[basis->count] = plain->node[j];
      memcpy(basis->at + 3 * (size_t)basis->count, plain->at + 3 * (size_t)j,
             3 * sizeof *basis->at);
      basis->area[basis->count] = plain->area[j];
      basis->start[basis->count++] = at;
      for (int64_t e = plain->start[j]; e < plain->start[j + 1]; e++, at++) {
        basis->row[at] = plain->row[e];
        for (int i = 0; i < 3; i++)
          basis->coefficient[3 * at + i] = plain->coefficient[3 * e + i] +
                                           c * w->tangent[6 * e + i] +
                                           s * w->tangent[6 * e + 3 + i];
      }
    }
  basis->start[columns] = at;
  basis->directions = (int32_t)m;
  basis->complete = plain->complete;
  return BW_OK;
}

bw_status bwi_pressure_with_friction(bw_context *context, const bw_pressure_basis *plain,
                                     const bw_pressure_options *options,
                                     bw_pressure_basis **result) {
  const bw_mesh *mesh = plain->mesh;
  bw_pressure_basis *basis = NULL;
  friction_work w = {.plain = plain};
  bw_status status = BW_OK;
  w.normal = BW_NEW(context, double, 3 * (size_t)plain->count);
  w.tangent = BW_NEW0(context, double, 6 * plain->start[plain->count]);
  BW_TRY_MEMORY(w.normal && w.tangent);
  BW_TRY(bwi_pressure_rules_create(context, plain, &w.rules));
  for (int32_t j = 0; j < plain->count; j++)
    mean_normal(plain, j, w.normal + 3 * (size_t)j);
  for (int32_t f = 0; f < mesh->facet_count; f++)
    add_facet(&w, f);
  BW_TRY(bwi_pressure_basis_empty(context, mesh, &basis));
  BW_TRY(expand(context, &w, options, basis));
done:
  bwi_pressure_rules_clear(&w.rules);
  bw_free(w.normal);
  bw_free(w.tangent);
  if (status == BW_OK)
    *result = basis;
  else
    bw_release(basis);
  return status;
}
