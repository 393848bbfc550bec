/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elements of St. Venant-Kirchhoff sheets. With F = 1 + sum_a u_a g_a^T and E = (F^T F - 1) / 2:
 *
 *   energy   1/2 E : D E
 *   force    on node a: F S g_a, that is B_a^T S with dE = B_a du_a
 *   tangent  B_a^T D B_b + (g_a . S g_b) 1
 *
 * B_a has the rows (F_00 gx, F_10 gx), (F_01 gy, F_11 gy), (F_00 gy + F_01 gx, F_10 gy + F_11 gx).
 */
#include <math.h>
#include <string.h>

#include "responsive/bend.h"

bw_status bwi_bend_prepare(bw_context *context, const bw_sheet *sheet, bwi_bend *bend) {
  const bw_plane_topology *topology = sheet->mesh->topology;
  int order = topology->nodes->order;
  *bend = (bwi_bend){.sheet = sheet, .inverted = -1};
  bwi_rule_create(order, order == 1 ? 1 : 4, &bend->rule);
  bwi_rule_create(order, 4, &bend->corners);
  bend->corners.count = order == 1 ? 0 : 6; /* F of tri3 is the same everywhere */
  for (int a = 0; a < bend->corners.count; a++) {
    double l[3] = {0, 0, 0}, by_l[6][3];
    if (a < 3)
      l[a] = 1;
    else
      l[a - 3] = l[(a - 2) % 3] = 0.5;
    bw_triangle_shape_gradient(order, l, by_l);
    for (int b = 0; b < 6; b++)
      for (int k = 0; k < 2; k++)
        bend->corners.slope[a][b][k] = by_l[b][k + 1] - by_l[b][0];
  }
  bend->energy = BW_NEW(context, double, topology->element_count);
  bend->force = BW_NEW(context, double, 12 * (size_t)topology->element_count);
  return bend->energy && bend->force ? BW_OK : BW_MEMORY;
}

void bwi_bend_clear(bwi_bend *bend) {
  bw_free(bend->energy);
  bw_free(bend->force);
  bend->energy = bend->force = NULL;
}

/* H = F - 1, row by row: no digits are lost where F is close to 1. Returns the determinant of F. */
static inline __attribute__((always_inline)) double deformation(int N, const double (*g)[2],
                                                                const double (*u)[2], double h[4]) {
  h[0] = h[1] = h[2] = h[3] = 0;
  for (int a = 0; a < N; a++) {
    h[0] += u[a][0] * g[a][0];
    h[1] += u[a][0] * g[a][1];
    h[2] += u[a][1] * g[a][0];
    h[3] += u[a][1] * g[a][1];
  }
  return (1 + h[0]) * (1 + h[3]) - h[1] * h[2];
}

/* E = (H + H^T + H^T H) / 2 with engineering shear, and F. */
static inline void green(const double h[4], double e[3], double f[4]) {
  e[0] = h[0] + 0.5 * (h[0] * h[0] + h[2] * h[2]);
  e[1] = h[3] + 0.5 * (h[3] * h[3] + h[1] * h[1]);
  e[2] = h[1] + h[2] + h[0] * h[1] + h[2] * h[3];
  f[0] = 1 + h[0], f[1] = h[1];
  f[2] = h[2], f[3] = 1 + h[3];
}

static inline __attribute__((always_inline)) void element_energy(const bwi_bend *bend, int32_t e,
                                                                 int N) {
  const bw_sheet *sheet = bend->sheet;
  const bwi_section *section = bwi_section_of(sheet, e);
  double x[6][2], u[6][2], g[6][2], h[4], f[4], strain[3], stress[3], sum = 0;
  bwi_element_points(sheet->mesh, e, N, x);
  bwi_element_field(sheet->mesh, bend->u, e, N, u);
  bool good = true;
  for (int q = 0; q < bend->rule.count; q++) {
    double determinant = bwi_rule_gradient(&bend->rule, q, N, x, g);
    good = good && deformation(N, g, u, h) > 0 && determinant > 0;
    green(h, strain, f);
    bwi_times3(section->elasticity, strain, stress);
    sum += 0.5 * bend->rule.weight[q] * determinant * section->thickness *
           (stress[0] * strain[0] + stress[1] * strain[1] + stress[2] * strain[2]);
  }
  for (int q = 0; q < bend->corners.count && good; q++) {
    bwi_rule_gradient(&bend->corners, q, N, x, g);
    good = deformation(N, g, u, h) > 0;
  }
  bend->energy[e] = good && isfinite(sum) ? fmax(sum, 0) : -1;
}

static inline __attribute__((always_inline)) void element_force(const bwi_bend *bend, int32_t e,
                                                                int N) {
  const bw_sheet *sheet = bend->sheet;
  const bwi_section *section = bwi_section_of(sheet, e);
  double x[6][2], u[6][2], g[6][2], h[4], f[4], strain[3], stress[3];
  double *out = bend->force + (int64_t)e * 2 * N;
  bwi_element_points(sheet->mesh, e, N, x);
  bwi_element_field(sheet->mesh, bend->u, e, N, u);
  memset(out, 0, (size_t)(2 * N) * sizeof *out);
  for (int q = 0; q < bend->rule.count; q++) {
    double scale =
        bwi_rule_gradient(&bend->rule, q, N, x, g) * bend->rule.weight[q] * section->thickness;
    deformation(N, g, u, h);
    green(h, strain, f);
    bwi_times3(section->elasticity, strain, stress);
    /* P = F S */
    double xx = scale * (f[0] * stress[0] + f[1] * stress[2]);
    double xy = scale * (f[0] * stress[2] + f[1] * stress[1]);
    double yx = scale * (f[2] * stress[0] + f[3] * stress[2]);
    double yy = scale * (f[2] * stress[2] + f[3] * stress[1]);
    for (int a = 0; a < N; a++) {
      out[2 * a] += xx * g[a][0] + xy * g[a][1];
      out[2 * a + 1] += yx * g[a][0] + yy * g[a][1];
    }
  }
}

/* The positive part of a symmetric 2x2 matrix xx yy xy. */
static void positive_part(double s[3]) {
  double mean = 0.5 * (s[0] + s[1]), half = 0.5 * (s[0] - s[1]), radius = hypot(half, s[2]);
  double low = mean - radius, high = mean + radius;
  if (low >= 0)
    return;
  if (high <= 0) {
    s[0] = s[1] = s[2] = 0;
    return;
  }
  double scale = high / (2 * radius); /* high times the projector on its direction */
  s[0] = scale * (radius + half);
  s[1] = scale * (radius - half);
  s[2] = scale * s[2];
}

static inline __attribute__((always_inline)) bw_status
element_tangent(const bwi_bend *bend, int32_t e, int N, double *k) {
  const bw_sheet *sheet = bend->sheet;
  const bwi_section *section = bwi_section_of(sheet, e);
  double x[6][2], u[6][2], g[6][2], h[4], f[4], strain[3], stress[3], b[6][2][3];
  bwi_element_points(sheet->mesh, e, N, x);
  bwi_element_field(sheet->mesh, bend->u, e, N, u);
  memset(k, 0, (size_t)(4 * N * N) * sizeof *k);
  for (int q = 0; q < bend->rule.count; q++) {
    double scale =
        bwi_rule_gradient(&bend->rule, q, N, x, g) * bend->rule.weight[q] * section->thickness;
    deformation(N, g, u, h);
    green(h, strain, f);
    bwi_times3(section->elasticity, strain, stress);
    if (bend->convex)
      positive_part(stress);
    for (int a = 0; a < N; a++)
      for (int i = 0; i < 2; i++) {
        b[a][i][0] = f[2 * i] * g[a][0];
        b[a][i][1] = f[2 * i + 1] * g[a][1];
        b[a][i][2] = f[2 * i] * g[a][1] + f[2 * i + 1] * g[a][0];
      }
    for (int a = 0; a < N; a++) {
      double along[2] = {scale * (stress[0] * g[a][0] + stress[2] * g[a][1]),
                         scale * (stress[2] * g[a][0] + stress[1] * g[a][1])};
      for (int i = 0; i < 2; i++) {
        double row[3], *out = k + (2 * a + i) * 2 * N;
        for (int j = 0; j < 3; j++)
          row[j] = scale *
                   (section->elasticity[j] * b[a][i][0] + section->elasticity[3 + j] * b[a][i][1] +
                    section->elasticity[6 + j] * b[a][i][2]);
        for (int c = 0; c < N; c++) {
          for (int j = 0; j < 2; j++)
            out[2 * c + j] += row[0] * b[c][j][0] + row[1] * b[c][j][1] + row[2] * b[c][j][2];
          out[2 * c + i] += along[0] * g[c][0] + along[1] * g[c][1];
        }
      }
    }
  }
  return BW_OK;
}

static bw_status energy_body(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_bend *bend = data;
  (void)worker;
  for (int64_t e = begin; e < end; e++)
    if (bend->rule.n == 3)
      element_energy(bend, (int32_t)e, 3);
    else
      element_energy(bend, (int32_t)e, 6);
  return BW_OK;
}

static bw_status force_body(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_bend *bend = data;
  (void)worker;
  for (int64_t e = begin; e < end; e++)
    if (bend->rule.n == 3)
      element_force(bend, (int32_t)e, 3);
    else
      element_force(bend, (int32_t)e, 6);
  return BW_OK;
}

static bw_status tangent3(void *data, int32_t e, double *k) {
  return element_tangent(data, e, 3, k);
}
static bw_status tangent6(void *data, int32_t e, double *k) {
  return element_tangent(data, e, 6, k);
}

bw_status bwi_bend_energy(bw_context *context, bwi_bend *bend, double *energy) {
  int32_t count = bend->sheet->mesh->topology->element_count;
  bw_status status = bw_parallel(context, count, BWI_GRAIN_ELEMENTS, energy_body, bend);
  double sum = 0;
  bend->inverted = -1;
  for (int32_t e = 0; e < count && status == BW_OK; e++) {
    if (bend->energy[e] < 0) {
      bend->inverted = e;
      sum = INFINITY;
      break;
    }
    sum += bend->energy[e];
  }
  *energy = sum;
  return status;
}

bw_status bwi_bend_force(bw_context *context, bwi_bend *bend, double *force) {
  const bw_plane_topology *topology = bend->sheet->mesh->topology;
  int n = bend->rule.n;
  bw_status status =
      bw_parallel(context, topology->element_count, BWI_GRAIN_ELEMENTS, force_body, bend);
  memset(force, 0, 2 * (size_t)topology->nodes->node_count * sizeof *force);
  for (int64_t k = 0; k < (int64_t)topology->element_count * n && status == BW_OK; k++) {
    int64_t node = topology->element[k];
    force[2 * node] += bend->force[2 * k];
    force[2 * node + 1] += bend->force[2 * k + 1];
  }
  return status;
}

bw_status bwi_bend_tangent(bw_context *context, bwi_bend *bend, const bw_plane_graph *graph,
                           double *room, double *values) {
  return bwi_plane_assemble(context, graph, 2, bend->rule.n == 3 ? tangent3 : tangent6, bend, room,
                            values);
}
