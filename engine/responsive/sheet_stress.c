/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stresses at nodes and the estimate of the error.
 *
 * Stresses are best at the points of the stiffness's rule: the centre of tri3, three points of
 * tri6, from which they are extrapolated linearly. At a node the mean over the elements around it
 * is taken, weighted by their areas. The error (Zienkiewicz, Zhu) is the distance in energy between
 * the stresses of the elements and the field that interpolates those means; stresses may jump
 * between regions, so each region has means of its own there. */
#include <math.h>
#include <string.h>

#include "responsive/sheet.h"

enum { PARTS = 4 }; /* xx yy xy zz */

/* Stress at a point from the displacement gradient: linear, or Cauchy's after large motion. */
static void stress_at(const bwi_section *section, bool large, int n, const double (*g)[2],
                      const double (*u)[2], double stress[PARTS]) {
  double e[3], s[3];
  if (!large) {
    bwi_strain(n, g, u, e);
    bwi_times3(section->elasticity, e, stress);
    stress[3] = section->across[0] * e[0] + section->across[1] * e[1] + section->across[2] * e[2];
    return;
  }
  double f[4] = {1, 0, 0, 1};
  for (int a = 0; a < n; a++)
    for (int i = 0; i < 2; i++)
      for (int k = 0; k < 2; k++)
        f[2 * i + k] += u[a][i] * g[a][k];
  e[0] = 0.5 * (f[0] * f[0] + f[2] * f[2] - 1);
  e[1] = 0.5 * (f[1] * f[1] + f[3] * f[3] - 1);
  e[2] = f[0] * f[1] + f[2] * f[3];
  bwi_times3(section->elasticity, e, s);
  double zz = section->across[0] * e[0] + section->across[1] * e[1] + section->across[2] * e[2];
  double ezz = section->strain_across[0] * s[0] + section->strain_across[1] * s[1] +
               section->strain_across[2] * s[2];
  double across = sqrt(fmax(1 + 2 * ezz, 0)); /* stretch of the thickness */
  double scale = 1 / ((f[0] * f[3] - f[1] * f[2]) * (across > 0 ? across : 1));
  stress[0] = scale * (f[0] * (f[0] * s[0] + 2 * f[1] * s[2]) + f[1] * f[1] * s[1]);
  stress[1] = scale * (f[2] * (f[2] * s[0] + 2 * f[3] * s[2]) + f[3] * f[3] * s[1]);
  stress[2] =
      scale * (f[0] * f[2] * s[0] + f[1] * f[3] * s[1] + (f[0] * f[3] + f[1] * f[2]) * s[2]);
  stress[3] = scale * across * across * zz;
}

/* Stresses at the nodes of one element and its area. */
static double element_stress(const bw_sheet *sheet, const bwi_triangle_rule *rule, int32_t e,
                             double (*stress)[PARTS]) {
  double x[6][2], u[6][2], g[6][2], at[3][PARTS], area = 0;
  int n = rule->n;
  bwi_element_points(sheet->mesh, e, n, x);
  bwi_element_field(sheet->mesh, sheet->displacement, e, n, u);
  for (int q = 0; q < rule->count; q++) {
    area += rule->weight[q] * bwi_rule_gradient(rule, q, n, x, g);
    stress_at(bwi_section_of(sheet, e), sheet->inner->now->large, n, g, u, at[q]);
  }
  for (int a = 0; a < n; a++)
    for (int i = 0; i < PARTS; i++) {
      stress[a][i] = 0;
      for (int q = 0; q < rule->count; q++) {
        /* linear with 1 at this point and 0 at the two others: 2 L - 1/3 for the L that is 2/3
           there */
        int max = rule->point[q][0] > 0.5 ? 0 : rule->point[q][1] > 0.5 ? 1 : 2;
        double l = a < 3 ? a == max : a - 3 == max || (a - 2) % 3 == max ? 0.5 : 0;
        stress[a][i] += (rule->count == 1 ? 1 : 2 * l - 1.0 / 3) * at[q][i];
      }
    }
  return area;
}

/* Means at nodes over the elements of one region (-1: all); weight: room for node_count. */
static void recover(const bw_sheet *sheet, const bwi_triangle_rule *rule, int32_t region,
                    double *weight, double *mean) {
  const bw_plane_topology *topology = sheet->mesh->topology;
  int32_t nodes = topology->nodes->node_count;
  memset(weight, 0, (size_t)nodes * sizeof *weight);
  memset(mean, 0, PARTS * (size_t)nodes * sizeof *mean);
  for (int32_t e = 0; e < topology->element_count; e++) {
    if (region >= 0 && topology->region[e] != region)
      continue;
    double stress[6][PARTS];
    double area = element_stress(sheet, rule, e, stress);
    for (int a = 0; a < rule->n; a++) {
      int64_t node = topology->element[(int64_t)e * rule->n + a];
      weight[node] += area;
      for (int i = 0; i < PARTS; i++)
        mean[PARTS * node + i] += area * stress[a][i];
    }
  }
  for (int64_t i = 0; i < nodes; i++)
    for (int k = 0; k < PARTS && weight[i] > 0; k++)
      mean[PARTS * i + k] /= weight[i];
}

static void points_rule(const bw_sheet *sheet, bwi_triangle_rule *rule) {
  int order = sheet->mesh->topology->nodes->order;
  bwi_rule_create(order, order == 1 ? 1 : 2, rule);
}

bw_status bw_sheet_stress(bw_context *context, const bw_sheet *sheet, double *stress,
                          double *von_mises) {
  bw_status status = BW_OK;
  int32_t nodes = sheet->mesh->topology->nodes->node_count;
  double *weight = BW_NEW(context, double, nodes);
  double *mean = stress ? stress : BW_NEW(context, double, PARTS *(size_t)nodes);
  bwi_triangle_rule rule;
  BW_TRY_MEMORY(weight && mean);
  points_rule(sheet, &rule);
  recover(sheet, &rule, -1, weight, mean);
  for (int64_t i = 0; i < nodes && von_mises; i++)
    von_mises[i] = bwi_plane_von_mises(mean + PARTS * i, mean[PARTS * i + 3]);
done:
  bw_free(weight);
  if (mean != stress)
    bw_free(mean);
  return status;
}

bw_status bw_sheet_error(bw_context *context, const bw_sheet *sheet, double *relative) {
  bw_status status = BW_OK;
  const bw_plane_topology *topology = sheet->mesh->topology;
  int32_t nodes = topology->nodes->node_count, regions = 1;
  bwi_triangle_rule points, rule;
  double *weight = BW_NEW(context, double, nodes);
  double *mean = BW_NEW(context, double, PARTS *(size_t)nodes);
  double error = 0, energy = 0;
  BW_TRY_MEMORY(weight && mean);
  points_rule(sheet, &points);
  bwi_rule_create(topology->nodes->order, 2 * topology->nodes->order, &rule);
  for (int32_t e = 0; e < topology->element_count; e++)
    if (topology->region[e] + 1 > regions)
      regions = topology->region[e] + 1;
  if (sheet->inner->section_count == 1)
    regions = 1;
  for (int32_t r = 0; r < regions; r++) {
    BW_TRY(bw_check_cancel(context));
    recover(sheet, &points, regions > 1 ? r : -1, weight, mean);
    for (int32_t e = 0; e < topology->element_count; e++) {
      const bwi_section *section = bwi_section_of(sheet, e);
      const int32_t *node = topology->element + (int64_t)e * rule.n;
      double x[6][2], u[6][2], g[6][2];
      if (regions > 1 && topology->region[e] != r)
        continue;
      bwi_element_points(sheet->mesh, e, rule.n, x);
      bwi_element_field(sheet->mesh, sheet->displacement, e, rule.n, u);
      for (int q = 0; q < rule.count; q++) {
        double scale =
            section->thickness * rule.weight[q] * bwi_rule_gradient(&rule, q, rule.n, x, g);
        double here[PARTS], off[3] = {0, 0, 0}, strain[3];
        stress_at(section, sheet->inner->now->large, rule.n, g, u, here);
        for (int i = 0; i < 3; i++) {
          for (int a = 0; a < rule.n; a++)
            off[i] += rule.value[q][a] * mean[PARTS * (int64_t)node[a] + i];
          off[i] -= here[i];
        }
        bwi_times3(section->compliance, off, strain);
        error += scale * (off[0] * strain[0] + off[1] * strain[1] + off[2] * strain[2]);
        bwi_times3(section->compliance, here, strain);
        energy += scale * (here[0] * strain[0] + here[1] * strain[1] + here[2] * strain[2]);
      }
    }
  }
  *relative = error > 0 ? sqrt(error / (energy + error)) : 0;
done:
  bw_free(weight);
  bw_free(mean);
  return status;
}
