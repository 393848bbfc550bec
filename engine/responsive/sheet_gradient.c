/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How the stresses of a sheet change with its nodes.
 *
 * J = (integral of vm^p / area)^(1/p) over the points where stresses are best (the centre of tri3,
 * three points of tri6), which tends to the
 * largest von Mises stress from below as p grows. J depends on node positions x and on the solution
 * of K(x) u = f(x); with K l = dJ/du (one solve, on the factor that u was found with)
 *
 *   dJ/dx = dJ/dx at fixed u + l . (df/dx - dK/dx u).
 *
 * Everything hangs on how gradients and areas change when node b moves along axis k:
 *
 *   d(weight) = weight g_b[k],   d(du_i/dx_j) = -du_i/dx_k g_b[j].
 *
 * This is exact, for six nodes and curved sides as well. Values of conditions that are functions of
 * place go with their nodes. */
#include <math.h>
#include <string.h>

#include "responsive/sheet.h"

/* At one point of an element. */
typedef struct point {
  double g[6][2], weight; /* area that the point stands for */
  double du[4];           /* du_i/dx_k at 2 i + k */
  double stress[3], mises;
  double by_strain[3]; /* vm dvm/dstrain */
} point;

static void at_point(const bwi_section *section, const bwi_triangle_rule *rule, int q,
                     const double (*x)[2], const double (*u)[2], point *p) {
  p->weight = rule->weight[q] * bwi_rule_gradient(rule, q, rule->n, x, p->g);
  memset(p->du, 0, sizeof p->du);
  for (int a = 0; a < rule->n; a++)
    for (int i = 0; i < 2; i++)
      for (int k = 0; k < 2; k++)
        p->du[2 * i + k] += u[a][i] * p->g[a][k];
  double e[3] = {p->du[0], p->du[3], p->du[1] + p->du[2]};
  bwi_times3(section->elasticity, e, p->stress);
  const double *s = p->stress, *d = section->elasticity;
  double zz = section->across[0] * e[0] + section->across[1] * e[1] + section->across[2] * e[2];
  p->mises = bwi_plane_von_mises(s, zz);
  double by[4] = {s[0] - 0.5 * (s[1] + zz), s[1] - 0.5 * (s[0] + zz), 3 * s[2],
                  zz - 0.5 * (s[0] + s[1])};
  for (int j = 0; j < 3; j++)
    p->by_strain[j] =
        by[0] * d[j] + by[1] * d[3 + j] + by[2] * d[6 + j] + by[3] * section->across[j];
}

static void element_at(const bw_sheet *sheet, const bwi_triangle_rule *rule, int32_t e,
                       double (*x)[2], double (*u)[2]) {
  bwi_element_points(sheet->mesh, e, rule->n, x);
  bwi_element_field(sheet->mesh, sheet->displacement, e, rule->n, u);
}

/* (vm / most)^p over all points, and the area. */
static void sums(const bw_sheet *sheet, const bwi_triangle_rule *rule, double p, double *max,
                 double *sum, double *area) {
  int32_t elements = sheet->mesh->topology->element_count;
  double x[6][2], u[6][2];
  point at;
  *max = *sum = *area = 0;
  for (int pass = 0; pass < 2; pass++)
    for (int32_t e = 0; e < elements; e++) {
      element_at(sheet, rule, e, x, u);
      for (int q = 0; q < rule->count; q++) {
        at_point(bwi_section_of(sheet, e), rule, q, x, u, &at);
        if (pass == 0) {
          *max = fmax(*max, at.mises);
        } else {
          *area += at.weight;
          *sum += *max > 0 ? at.weight * pow(at.mises / *max, p) : 0;
        }
      }
    }
}

/* out_k += scale sum_i d_i,k (t n)_i for a symmetric t = xx yy xy */
static void add_turned(double scale, const double d[4], const double t[3], const double n[2],
                       double out[2]) {
  double x = scale * (t[0] * n[0] + t[2] * n[1]), y = scale * (t[2] * n[0] + t[1] * n[1]);
  out[0] += d[0] * x + d[2] * y;
  out[1] += d[1] * x + d[3] * y;
}

bw_status bw_sheet_stress_gradient(bw_context *context, bw_sheet *sheet, double p, double *norm,
                                   double *gradient) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = sheet->inner;
  const bw_plane_mesh *mesh = sheet->mesh;
  const bw_plane_topology *topology = mesh->topology;
  int order = topology->nodes->order;
  size_t size = 2 * (size_t)topology->nodes->node_count;
  double max, sum, area, x[6][2], u[6][2], l[6][2], *adjoint = NULL;
  bwi_rules rules;
  bwi_triangle_rule rule;
  point at;
  if (!(p >= 1) || !(p <= 1000))
    return bw_fail(context, BW_INVALID, "an exponent of %g: from 1 to 1000 expected", p);
  if (!inner->now->statics)
    return bw_fail(
        context, BW_INVALID,
        "the gradient of stresses needs linear statics on the present mesh: solve first");
  bwi_rules_create(order, &rules);
  rule = rules.straight;
  sums(sheet, &rule, p, &max, &sum, &area);
  double value = max > 0 ? max * pow(sum / area, 1 / p) : 0;
  if (norm)
    *norm = value;
  if (!gradient)
    return BW_OK;
  memset(gradient, 0, size * sizeof *gradient);
  if (max == 0)
    return BW_OK;

  bool made;
  if (inner->matrix_step[0] >= 0) /* something else was tried since, and given up */
    BW_TRY(bwi_sheet_statics(context, sheet, &made));

  /* dJ = value / (p sum) dsum - value / (p area) darea */
  double by_sum = value / (p * sum), by_area = value / (p * area);
  memset(inner->rhs, 0, size * sizeof(double));
  for (int32_t e = 0; e < topology->element_count; e++) {
    const int32_t *node = topology->element + (int64_t)e * rule.n;
    element_at(sheet, &rule, e, x, u);
    for (int q = 0; q < rule.count; q++) {
      at_point(bwi_section_of(sheet, e), &rule, q, x, u, &at);
      double scale = by_sum * p * at.weight * pow(at.mises / max, p - 2) / (max * max);
      if (!(at.mises > 0))
        continue;
      for (int a = 0; a < rule.n; a++) {
        double *r = inner->rhs + 2 * (int64_t)node[a];
        const double *t = at.by_strain, *g = at.g[a];
        r[0] += scale * (t[0] * g[0] + t[2] * g[1]);
        r[1] += scale * (t[2] * g[0] + t[1] * g[1]);
      }
    }
  }
  adjoint = BW_NEW0(context, double, size);
  BW_TRY_MEMORY(adjoint);
  for (size_t i = 0; i < size; i++)
    if (inner->is_prescribed[i])
      inner->rhs[i] = 0;
  bw_lagged_factor_options options;
  bw_lagged_factor_options_default(&options);
  options.tolerance = 1e-10;
  BW_TRY(bw_lagged_factor_solve(context, inner->lagged, inner->pattern, inner->matrix, inner->rhs,
                                adjoint, &options, NULL));
  for (int32_t e = 0; e < topology->element_count; e++) {
    const int32_t *node = topology->element + (int64_t)e * rule.n;
    element_at(sheet, &rule, e, x, u);
    for (int q = 0; q < rule.count; q++) {
      at_point(bwi_section_of(sheet, e), &rule, q, x, u, &at);
      double power = pow(at.mises / max, p), by_weight = by_sum * power - by_area;
      double by_strain = at.mises > 0 ? by_sum * p * power / (at.mises * at.mises) : 0;
      for (int b = 0; b < rule.n; b++) {
        double *out = gradient + 2 * (int64_t)node[b];
        for (int k = 0; k < 2; k++)
          out[k] += at.weight * by_weight * at.g[b][k];
        add_turned(-at.weight * by_strain, at.du, at.by_strain, at.g[b], out);
      }
    }
  }
  /* A straight element's sides may bend under a move of its nodes: both of its rules agree as it
     is, but only that of curved ones also right beside it. */
  rule = rules.curved;
  for (int32_t e = 0; e < topology->element_count; e++) {
    const bwi_section *section = bwi_section_of(sheet, e);
    const int32_t *node = topology->element + (int64_t)e * rule.n;
    element_at(sheet, &rule, e, x, u);
    bwi_element_field(mesh, adjoint, e, rule.n, l);
    for (int q = 0; q < rule.count; q++) {
      at_point(section, &rule, q, x, u, &at);
      double dl[4] = {0}, along[2] = {0}, stress[3], thick = section->thickness;
      for (int a = 0; a < rule.n; a++)
        for (int i = 0; i < 2; i++) {
          along[i] += rule.value[q][a] * l[a][i];
          for (int k = 0; k < 2; k++)
            dl[2 * i + k] += l[a][i] * at.g[a][k];
        }
      double strain[3] = {dl[0], dl[3], dl[1] + dl[2]};
      bwi_times3(section->elasticity, strain, stress);
      double work = at.stress[0] * strain[0] + at.stress[1] * strain[1] + at.stress[2] * strain[2];
      double load =
          section->density * (along[0] * inner->gravity[0] + along[1] * inner->gravity[1]);
      for (int b = 0; b < rule.n; b++) {
        double *out = gradient + 2 * (int64_t)node[b];
        for (int k = 0; k < 2; k++)
          out[k] += at.weight * thick * (load - work) * at.g[b][k];
        add_turned(at.weight * thick, dl, at.stress, at.g[b], out);
        add_turned(at.weight * thick, at.du, stress, at.g[b], out);
      }
    }
  }
  BW_TRY(bwi_conditions_force_gradient(context, mesh, inner->condition_count, inner->condition,
                                       sheet->time, inner->section_count, inner->thickness, adjoint,
                                       gradient));
done:
  bw_free(adjoint);
  return status;
}
