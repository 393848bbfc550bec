/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Small dense linear algebra and meshes for the tests of assembly and stress, written to be
 * obviously right. */
#ifndef TESTS_DENSE_H
#define TESTS_DENSE_H

#include "check.h"

/* Solve a x = b by Cholesky, in place; a is n x n, positive definite. */
static inline void dense_solve(int n, double *a, double *b) {
  for (int j = 0; j < n; j++) {
    for (int k = 0; k < j; k++)
      for (int i = j; i < n; i++)
        a[i * n + j] -= a[i * n + k] * a[j * n + k];
    if (!(a[j * n + j] > 0))
      fail_msg("the matrix of the test is not positive definite at %d", j);
    double pivot = sqrt(a[j * n + j]);
    for (int i = j; i < n; i++)
      a[i * n + j] /= pivot;
  }
  for (int i = 0; i < n; i++) {
    for (int k = 0; k < i; k++)
      b[i] -= a[i * n + k] * b[k];
    b[i] /= a[i * n + i];
  }
  for (int i = n - 1; i >= 0; i--) {
    for (int k = i + 1; k < n; k++)
      b[i] -= a[k * n + i] * b[k];
    b[i] /= a[i * n + i];
  }
}

/* Eigenvalues of a symmetric matrix by Jacobi rotations, ascending; a is destroyed. */
static inline void dense_eigenvalues(int n, double *a, double *value) {
  for (int sweep = 0; sweep < 60; sweep++) {
    double off = 0, all = 0;
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++) {
        all += a[i * n + j] * a[i * n + j];
        off += i != j ? a[i * n + j] * a[i * n + j] : 0;
      }
    if (off <= 1e-32 * all)
      break;
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++) {
        if (a[p * n + q] == 0)
          continue;
        double theta = (a[q * n + q] - a[p * n + p]) / (2 * a[p * n + q]);
        double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
        double c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < n; k++) {
          double x = a[k * n + p], y = a[k * n + q];
          a[k * n + p] = c * x - s * y;
          a[k * n + q] = s * x + c * y;
        }
        for (int k = 0; k < n; k++) {
          double x = a[p * n + k], y = a[q * n + k];
          a[p * n + k] = c * x - s * y;
          a[q * n + k] = s * x + c * y;
        }
      }
  }
  for (int i = 0; i < n; i++)
    value[i] = a[i * n + i];
  for (int i = 1; i < n; i++)
    for (int j = i; j > 0 && value[j - 1] > value[j]; j--) {
      double t = value[j];
      value[j] = value[j - 1], value[j - 1] = t;
    }
}

/* The full matrix of a stiffness on a pattern: 3 node_count squared. To be freed. */
static inline double *dense_stiffness(const bw_block_pattern *pattern, const double *values) {
  int n = 3 * pattern->node_count;
  double *a = (double *)calloc((size_t)n * (size_t)n, sizeof *a);
  for (int i = 0; i < pattern->node_count; i++)
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++)
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) {
          int row = 3 * i + r, column = 3 * pattern->column[p] + c;
          a[row * n + column] = a[column * n + row] = values[9 * p + 3 * r + c];
        }
  return a;
}

/* u where `free` is false is given; the rest is solved for under the forces f (may be NULL). */
static inline void dense_static(bw_context *context, const bw_mesh *mesh,
                                const bw_material *material, const bool *is_free, const double *f,
                                double *u) {
  bw_block_pattern *pattern = NULL;
  check_ok(context, bw_block_pattern_create(context, mesh, &pattern));
  double *values = (double *)malloc(sizeof *values * 9 * (size_t)pattern->block_count);
  check_ok(context, bw_stiffness(context, pattern, mesh, material, values));
  double *k = dense_stiffness(pattern, values);
  int n = 3 * mesh->node_count, m = 0;
  int *number = (int *)malloc(sizeof *number * (size_t)n);
  for (int i = 0; i < n; i++)
    if (is_free[i])
      number[m++] = i;
  double *a = (double *)malloc(sizeof *a * ((size_t)m * (size_t)m + 1));
  double *b = (double *)malloc(sizeof *b * ((size_t)m + 1));
  for (int i = 0; i < m; i++) {
    b[i] = f ? f[number[i]] : 0;
    for (int j = 0; j < m; j++)
      a[i * m + j] = k[number[i] * n + number[j]];
    for (int j = 0; j < n; j++)
      if (!is_free[j])
        b[i] -= k[number[i] * n + j] * u[j];
  }
  dense_solve(m, a, b);
  for (int i = 0; i < m; i++)
    u[number[i]] = b[i];
  free(values), free(k), free(number), free(a), free(b);
  bw_release(pattern);
}

/* A box whose inner nodes are perturbed and, with `bulge`, whose mid-edge nodes leave their edges.
 */
static inline void perturbed_box(bw_context *context, int nx, int ny, int nz, int order,
                                 double shake, double bulge, bw_mesh **mesh) {
  double low[3] = {0, 0, 0}, high[3] = {0.3 * nx, 0.2 * ny, 0.25 * nz};
  int cells[3] = {nx, ny, nz};
  bw_mesh *linear = NULL, *moved = NULL, *quadratic = NULL;
  bw_random random;
  bw_random_seed(&random, 7);
  check_ok(context, bw_mesh_box_grid(context, low, high, cells, 1, &linear));
  double *node = (double *)malloc(sizeof *node * 3 * (size_t)linear->node_count);
  for (int i = 0; i < linear->node_count; i++)
    for (int k = 0; k < 3; k++) {
      double x = linear->node[3 * i + k];
      bool inside = x > 1e-9 && x < high[k] - 1e-9;
      node[3 * i + k] = x + (inside ? shake * 0.2 * (bw_random_uniform(&random) - 0.5) : 0);
    }
  check_ok(context, bw_mesh_moved(context, linear, node, &moved));
  free(node);
  bw_release(linear);
  if (order == 1) {
    *mesh = moved;
    return;
  }
  check_ok(context, bw_mesh_with_order(context, moved, 2, &quadratic));
  bw_release(moved);
  if (bulge == 0) {
    *mesh = quadratic;
    return;
  }
  node = (double *)malloc(sizeof *node * 3 * (size_t)quadratic->node_count);
  memcpy(node, quadratic->node, sizeof *node * 3 * (size_t)quadratic->node_count);
  /* every third element gets a curved edge */
  for (int e = 0; e < quadratic->element_count; e += 3) {
    double *x = node + 3 * (size_t)quadratic->element[10 * e + 4 + e % 6];
    for (int k = 0; k < 3; k++)
      x[k] += bulge * 0.2 * (bw_random_uniform(&random) - 0.5);
  }
  check_ok(context, bw_mesh_moved(context, quadratic, node, mesh));
  free(node);
  bw_release(quadratic);
}

/* An orthotropic material with nothing special about it. */
static inline bw_material *odd_material(bw_context *context) {
  double a = 0.4, b = 0.9;
  bw_orthotropic c = {.name = "odd",
                      .young = {3e9, 2e9, 1e9},
                      .poisson = {0.35, 0.12, 0.3},
                      .shear = {0.7e9, 0.5e9, 0.9e9},
                      .axes = {cos(a), sin(a), 0, -sin(a) * cos(b), cos(a) * cos(b), sin(b),
                               sin(a) * sin(b), -cos(a) * sin(b), cos(b)}};
  bw_material *material = NULL;
  check_ok(context, bw_material_orthotropic(context, &c, &material));
  return material;
}

static inline bw_material *plain_material(bw_context *context, double young, double poisson) {
  bw_isotropic c = {"plain", young, poisson, 1000, 1e6, 0, 0};
  bw_material *material = NULL;
  check_ok(context, bw_material_isotropic(context, &c, &material));
  return material;
}

/* Isotropic and orthotropic in the standard formulation; then nearly incompressible ones in the
 * B-bar formulation. */
static inline void formulated_materials(bw_context *context, double young,
                                        bw_material *material[4]) {
  bw_orthotropic c = {.name = "squashed",
                      .young = {3e9, 2.5e9, 2.2e9},
                      .poisson = {0.55, 0.45, 0.47},
                      .shear = {0.9e9, 0.8e9, 1e9}};
  bw_material *plain = plain_material(context, young, 0.49), *squashed = NULL;
  check_ok(context, bw_material_orthotropic(context, &c, &squashed));
  material[0] = plain_material(context, young, 0.3);
  material[1] = odd_material(context);
  check_ok(context, bw_material_formulated(context, plain, BW_B_BAR, &material[2]));
  check_ok(context, bw_material_formulated(context, squashed, BW_B_BAR, &material[3]));
  for (int m = 2; m < 4; m++)
    assert_true(bw_material_projected_bulk(material[m]) > 0.5 * bw_material_bulk(material[m]));
  bw_release(plain);
  bw_release(squashed);
}

/* The patch of MacNeal and Harder in the unit cube: eight inner nodes, seven hexahedra, each cut
 * into six tetrahedra by the diagonals that start at the lowest node of every face. */
static inline void patch_mesh(bw_context *context, int order, bw_mesh **mesh) {
  static const double node[16][3] = {
      {0, 0, 0},          {1, 0, 0},          {1, 1, 0},          {0, 1, 0},
      {0, 0, 1},          {1, 0, 1},          {1, 1, 1},          {0, 1, 1},
      {.249, .342, .192}, {.826, .288, .288}, {.850, .649, .263}, {.273, .750, .230},
      {.320, .186, .643}, {.677, .305, .683}, {.788, .693, .644}, {.165, .745, .702}};
  static const int face[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                 {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  int hexahedron[7][8], count = 0;
  int32_t tet[100][4];
  for (int i = 0; i < 8; i++)
    hexahedron[0][i] = 8 + i;
  for (int f = 0; f < 6; f++)
    for (int i = 0; i < 4; i++) {
      hexahedron[f + 1][i] = face[f][i];
      hexahedron[f + 1][4 + i] = 8 + face[f][i];
    }
  for (int h = 0; h < 7; h++) {
    int lowest = 0;
    for (int i = 1; i < 8; i++)
      if (hexahedron[h][i] < hexahedron[h][lowest])
        lowest = i;
    for (int f = 0; f < 6; f++) {
      int q[4], start = 0;
      bool touches = false;
      for (int i = 0; i < 4; i++) {
        q[i] = hexahedron[h][face[f][i]];
        touches = touches || face[f][i] == lowest;
        start = q[i] < q[start] ? i : start;
      }
      if (touches)
        continue;
      for (int t = 1; t <= 2; t++, count++) {
        tet[count][0] = hexahedron[h][lowest];
        tet[count][1] = q[start];
        tet[count][2] = q[(start + t) % 4];
        tet[count][3] = q[(start + t + 1) % 4];
      }
    }
  }
  bw_mesh *linear = NULL;
  check_ok(context, bw_mesh_copy(context, 1, 16, &node[0][0], count, &tet[0][0], NULL, &linear));
  check_near(bw_mesh_volume(linear), 1, 1e-14); /* nothing overlaps */
  check_ok(context, bw_mesh_with_order(context, linear, order, mesh));
  bw_release(linear);
}

#endif
