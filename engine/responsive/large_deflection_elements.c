/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elements of St. Venant-Kirchhoff sheets. With F = 1 + sum_a u_a g_a^T and E = (F^T F - 1) / 2:
 *
 *   energy   1/2 E : D E
 *   force    on node a: F S g_a, that is B_a^T S with dE = B_a du_a
 *   tangent  B_a^T D B_b + (g_a . S g_b) 1
 *
 * B_a has the rows (F_00 gx, F_10 gx), (F_01 gy, F_11 gy), (F_00 gy + F_01 gx, F_10 gy + F_11 gx).
 *
 * On three-node elements all of this is constant: their gradients are found once for a mesh and
 * kept in lines; since gradients sum to zero, so do blocks along a row of the tangent and forces
 * over the nodes, and those of the third node follow from the others'. */
#include <math.h>
#include <string.h>

#include "responsive/large_deflection.h"

enum { LINE = 8 };

static bw_status line_body(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_large_deflection *bend = data;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    double x[3][2];
    bwi_element_points(bend->sheet->mesh, (int32_t)e, 3, x);
    double *line = bend->line + LINE * e;
    double ax = x[1][0] - x[0][0], ay = x[1][1] - x[0][1];
    double bx = x[2][0] - x[0][0], by = x[2][1] - x[0][1];
    double twice = ax * by - ay * bx, scale = 1 / twice;
    line[0] = scale * (ay - by);
    line[1] = scale * (bx - ax);
    line[2] = scale * by;
    line[3] = -scale * bx;
    line[4] = -scale * ay;
    line[5] = scale * ax;
    line[6] = 0.5 * twice * bwi_section_of(bend->sheet, (int32_t)e)->thickness;
  }
  return BW_OK;
}

bw_status bwi_large_deflection_prepare(bw_context *context, const bw_sheet *sheet,
                                       bwi_large_deflection *bend) {
  const bw_plane_topology *topology = sheet->mesh->topology;
  int order = topology->nodes->order;
  *bend = (bwi_large_deflection){.sheet = sheet, .inverted = -1};
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
  bend->force = BW_NEW(context, double, 2 * (size_t)bend->rule.n * (size_t)topology->element_count);
  if (!bend->energy || !bend->force)
    return BW_MEMORY;
  if (order == 2)
    return BW_OK;
  bend->line = BW_NEW(context, double, LINE *(size_t)topology->element_count);
  return bend->line
             ? bw_parallel(context, topology->element_count, BWI_GRAIN_ELEMENTS, line_body, bend)
             : BW_MEMORY;
}

void bwi_large_deflection_clear(bwi_large_deflection *bend) {
  bw_free(bend->line);
  bw_free(bend->energy);
  bw_free(bend->force);
  bend->line = bend->energy = bend->force = NULL;
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

/* P = F S */
static inline void first_stress(const double f[4], const double stress[3], double p[4]) {
  p[0] = f[0] * stress[0] + f[1] * stress[2];
  p[1] = f[0] * stress[2] + f[1] * stress[1];
  p[2] = f[2] * stress[0] + f[3] * stress[2];
  p[3] = f[2] * stress[2] + f[3] * stress[1];
}

static inline double product(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void evaluate6(const bwi_large_deflection *bend, int32_t e) {
  enum { N = 6 };
  const bw_sheet *sheet = bend->sheet;
  const bwi_section *section = bwi_section_of(sheet, e);
  double x[N][2], u[N][2], g[N][2], h[4], f[4], strain[3], stress[3], p[4], sum = 0;
  double *out = bend->force + (int64_t)e * 2 * N;
  bwi_element_points(sheet->mesh, e, N, x);
  bwi_element_field(sheet->mesh, bend->u, e, N, u);
  memset(out, 0, (size_t)(2 * N) * sizeof *out);
  bool good = true;
  for (int q = 0; q < bend->rule.count; q++) {
    double determinant = bwi_rule_gradient(&bend->rule, q, N, x, g);
    double scale = determinant * bend->rule.weight[q] * section->thickness;
    good = good && deformation(N, g, u, h) > 0 && determinant > 0;
    green(h, strain, f);
    bwi_times3(section->elasticity, strain, stress);
    first_stress(f, stress, p);
    sum += 0.5 * scale * product(stress, strain);
    for (int a = 0; a < N; a++) {
      out[2 * a] += scale * (p[0] * g[a][0] + p[1] * g[a][1]);
      out[2 * a + 1] += scale * (p[2] * g[a][0] + p[3] * g[a][1]);
    }
  }
  for (int q = 0; q < bend->corners.count && good; q++) {
    bwi_rule_gradient(&bend->corners, q, N, x, g);
    good = deformation(N, g, u, h) > 0;
  }
  bend->energy[e] = good && isfinite(sum) ? fmax(sum, 0) : -1;
}

/* What a tri3 has of its line and displacements; returns the determinant of F. */
static inline double state3(const bwi_large_deflection *bend, int32_t e, double f[4],
                            double strain[3], double stress[3]) {
  const double(*g)[2] = (const double(*)[2])(bend->line + LINE * (int64_t)e);
  double u[3][2], h[4];
  bwi_element_field(bend->sheet->mesh, bend->u, e, 3, u);
  double determinant = deformation(3, g, u, h);
  green(h, strain, f);
  bwi_times3(bwi_section_of(bend->sheet, e)->elasticity, strain, stress);
  return determinant;
}

static inline void evaluate3(const bwi_large_deflection *bend, int32_t e) {
  const double *g = bend->line + LINE * (int64_t)e;
  double f[4], strain[3], stress[3], p[4], *out = bend->force + 6 * (int64_t)e;
  double determinant = state3(bend, e, f, strain, stress);
  double sum = 0.5 * g[6] * product(stress, strain);
  first_stress(f, stress, p);
  for (int a = 0; a < 2; a++) {
    out[2 * a] = g[6] * (p[0] * g[2 * a] + p[1] * g[2 * a + 1]);
    out[2 * a + 1] = g[6] * (p[2] * g[2 * a] + p[3] * g[2 * a + 1]);
  }
  out[4] = -(out[0] + out[2]);
  out[5] = -(out[1] + out[3]);
  bend->energy[e] = determinant > 0 && g[6] > 0 && isfinite(sum) ? fmax(sum, 0) : -1;
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

static bw_status tangent6(void *data, int32_t e, double *k) {
  enum { N = 6 };
  const bwi_large_deflection *bend = data;
  const bw_sheet *sheet = bend->sheet;
  const bwi_section *section = bwi_section_of(sheet, e);
  double x[N][2], u[N][2], g[N][2], h[4], f[4], strain[3], stress[3], b[N][2][3];
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

static bw_status tangent3(void *data, int32_t e, double *k) {
  const bwi_large_deflection *bend = data;
  const double *g = bend->line + LINE * (int64_t)e, *d = bwi_section_of(bend->sheet, e)->elasticity;
  double f[4], strain[3], stress[3], b[4][3], row[4][3], block[4][4];
  state3(bend, e, f, strain, stress);
  if (bend->convex)
    positive_part(stress);
  for (int a = 0; a < 2; a++)
    for (int i = 0; i < 2; i++) {
      double *to = b[2 * a + i];
      to[0] = f[2 * i] * g[2 * a];
      to[1] = f[2 * i + 1] * g[2 * a + 1];
      to[2] = f[2 * i] * g[2 * a + 1] + f[2 * i + 1] * g[2 * a];
      for (int j = 0; j < 3; j++)
        row[2 * a + i][j] = g[6] * (d[j] * to[0] + d[3 + j] * to[1] + d[6 + j] * to[2]);
    }
  for (int r = 0; r < 4; r++)
    for (int c = r; c < 4; c++)
      block[r][c] = block[c][r] = product(row[r], b[c]);
  for (int a = 0; a < 2; a++)
    for (int c = a; c < 2; c++) {
      double along = g[6] * (g[2 * a] * (stress[0] * g[2 * c] + stress[2] * g[2 * c + 1]) +
                             g[2 * a + 1] * (stress[2] * g[2 * c] + stress[1] * g[2 * c + 1]));
      for (int i = 0; i < 2; i++) {
        block[2 * a + i][2 * c + i] += along;
        if (c > a)
          block[2 * c + i][2 * a + i] += along;
      }
    }
  for (int r = 0; r < 4; r++) {
    for (int c = 0; c < 4; c++)
      k[6 * r + c] = block[r][c];
    for (int c = 0; c < 2; c++)
      k[6 * r + 4 + c] = k[6 * (4 + c) + r] = -(block[r][c] + block[r][2 + c]);
  }
  for (int r = 4; r < 6; r++)
    for (int c = 4; c < 6; c++)
      k[6 * r + c] = -(k[6 * (r - 4) + c] + k[6 * (r - 2) + c]);
  return BW_OK;
}

static bw_status evaluate_body(void *data, int64_t begin, int64_t end, int worker) {
  const bwi_large_deflection *bend = data;
  (void)worker;
  for (int64_t e = begin; e < end; e++)
    if (bend->rule.n == 3)
      evaluate3(bend, (int32_t)e);
    else
      evaluate6(bend, (int32_t)e);
  return BW_OK;
}

bw_status bwi_large_deflection_evaluate(bw_context *context, bwi_large_deflection *bend,
                                        double *energy, double *force) {
  const bw_plane_topology *topology = bend->sheet->mesh->topology;
  int n = bend->rule.n;
  double sum = 0;
  bw_status status =
      bw_parallel(context, topology->element_count, BWI_GRAIN_ELEMENTS, evaluate_body, bend);
  if (status != BW_OK)
    return status;
  bend->inverted = -1;
  for (int32_t e = 0; e < topology->element_count; e++) {
    if (bend->energy[e] < 0) {
      bend->inverted = e;
      sum = INFINITY;
      break;
    }
    sum += bend->energy[e];
  }
  if (energy)
    *energy = sum;
  if (!force)
    return BW_OK;
  memset(force, 0, 2 * (size_t)topology->nodes->node_count * sizeof *force);
  for (int64_t k = 0; k < (int64_t)topology->element_count * n; k++) {
    int64_t node = topology->element[k];
    force[2 * node] += bend->force[2 * k];
    force[2 * node + 1] += bend->force[2 * k + 1];
  }
  return BW_OK;
}

bw_status bwi_large_deflection_tangent(bw_context *context, bwi_large_deflection *bend,
                                       const bw_plane_pattern *pattern, double *workspace,
                                       double *values) {
  return bwi_plane_assemble(context, pattern, 2, bend->rule.n == 3 ? tangent3 : tangent6, bend,
                            workspace, values);
}
