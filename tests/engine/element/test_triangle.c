/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Triangles of the plane: gradients against differences of the shape functions, fields that they
 * have to reproduce, areas by the determinant, straightness. */
#include "check.h"

static const double corner[3][2] = {{0.2, -0.1}, {1.3, 0.3}, {0.4, 1.1}};

static void six(double x[6][2], double bulge) {
  for (int a = 0; a < 3; a++)
    for (int k = 0; k < 2; k++) {
      x[a][k] = corner[a][k];
      x[3 + a][k] = 0.5 * (corner[a][k] + corner[(a + 1) % 3][k]) + bulge * (k ? 0.3 : -0.2) * a;
    }
}

static void test_differences(void **state) {
  (void)state;
  for (int order = 1; order <= 2; order++) {
    int n = order == 1 ? 3 : 6;
    double l[3] = {0.2, 0.5, 0.3}, gradient[6][3], plus[6], minus[6], h = 1e-6;
    bw_triangle_shape_gradient(order, l, gradient);
    for (int k = 0; k < 3; k++) {
      double up[3] = {l[0], l[1], l[2]}, down[3] = {l[0], l[1], l[2]};
      up[k] += h;
      down[k] -= h;
      bw_facet_shape(order, up, plus);
      bw_facet_shape(order, down, minus);
      for (int a = 0; a < n; a++)
        check_near(gradient[a][k], (plus[a] - minus[a]) / (2 * h), 1e-9);
    }
  }
}

/* A linear field on curved triangles, a quadratic one on straight ones: gradients exact. */
static void test_fields(void **state) {
  (void)state;
  double point[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
  int count = bw_triangle_quadrature(6, point, weight);
  for (int curved = 0; curved < 2; curved++)
    for (int order = 1; order <= 2; order++) {
      double x[6][2], g[6][2], area = 0;
      int n = order == 1 ? 3 : 6;
      six(x, curved ? 0.1 : 0);
      for (int q = 0; q < count; q++) {
        double value[6], at[2] = {0, 0}, d[2] = {0, 0}, sum[2] = {0, 0};
        bool quadratic = order == 2 && !curved;
        double determinant = bw_triangle_gradient(order, (const double(*)[2])x, point[q], g);
        area += 0.5 * weight[q] * determinant;
        bw_facet_shape(order, point[q], value);
        for (int a = 0; a < n; a++) {
          double f = 3 * x[a][0] - 2 * x[a][1] + (quadratic ? x[a][0] * x[a][1] : 0);
          for (int k = 0; k < 2; k++) {
            at[k] += value[a] * x[a][k];
            d[k] += f * g[a][k];
            sum[k] += g[a][k];
          }
        }
        check_near(sum[0], 0, 1e-13);
        check_near(sum[1], 0, 1e-13);
        check_near(d[0], 3 + (quadratic ? at[1] : 0), 1e-12);
        check_near(d[1], -2 + (quadratic ? at[0] : 0), 1e-12);
      }
      /* the polygon, and two thirds of each side's bulge over its chord */
      double exact = 0;
      for (int a = 0; a < 3; a++) {
        const double *p = x[a], *q = x[(a + 1) % 3], *m = x[3 + a];
        exact += 0.5 * (p[0] * q[1] - p[1] * q[0]);
        if (order == 2)
          exact += 2.0 / 3 * ((m[0] - p[0]) * (q[1] - p[1]) - (m[1] - p[1]) * (q[0] - p[0]));
      }
      check_near(area, exact, 1e-14);
    }
}

static void test_clockwise(void **state) {
  (void)state;
  double x[3][2] = {{0, 0}, {0, 1}, {1, 0}}, flat[3][2] = {{0, 0}, {1, 1}, {2, 2}}, g[3][2];
  double l[3] = {1.0 / 3, 1.0 / 3, 1.0 / 3};
  check_near(bw_triangle_gradient(1, (const double(*)[2])x, l, g), -1, 1e-15);
  assert_true(bw_triangle_gradient(1, (const double(*)[2])flat, l, g) == 0);
  assert_true(g[0][0] == 0 && g[1][1] == 0);
}

check_main(check_test(test_differences), check_test(test_fields), check_test(test_clockwise))
