/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Quadrature against the exact integrals of monomials over a simplex of dimension d:
 * mean of L0^a L1^b ... = d! a! b! ... / (a + b + ... + d)!. */
#include "check.h"

static double factorial(int n) {
  return n <= 1 ? 1 : n * factorial(n - 1);
}

static double power(double x, int n) {
  return n == 0 ? 1 : x * power(x, n - 1);
}

static void tetrahedron_is_exact(void **state) {
  (void)state;
  for (int degree = 1; degree <= 6; degree++) {
    double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
    int n = bw_tet_quadrature(degree, point, weight);
    assert_in_range(n, 1, BW_QUADRATURE_POINTS);
    for (int q = 0; q < n; q++) {
      assert_true(weight[q] > 0);
      double sum = 0;
      for (int k = 0; k < 4; k++) {
        assert_true(point[q][k] >= 0);
        sum += point[q][k];
      }
      check_near(sum, 1, 4e-16);
    }
    for (int a = 0; a <= degree; a++)
      for (int b = 0; a + b <= degree; b++)
        for (int c = 0; a + b + c <= degree; c++)
          for (int d = 0; a + b + c + d <= degree; d++) {
            double sum = 0;
            for (int q = 0; q < n; q++)
              sum += weight[q] * power(point[q][0], a) * power(point[q][1], b) *
                     power(point[q][2], c) * power(point[q][3], d);
            check_near(sum,
                       6 * factorial(a) * factorial(b) * factorial(c) * factorial(d) /
                           factorial(a + b + c + d + 3),
                       1e-15);
          }
  }
}

static void triangle_is_exact(void **state) {
  (void)state;
  for (int degree = 1; degree <= 6; degree++) {
    double point[BW_QUADRATURE_POINTS][3], weight[BW_QUADRATURE_POINTS];
    int n = bw_triangle_quadrature(degree, point, weight);
    assert_in_range(n, 1, BW_QUADRATURE_POINTS);
    for (int q = 0; q < n; q++)
      assert_true(weight[q] > 0 && point[q][0] >= 0 && point[q][1] >= 0 && point[q][2] >= 0);
    for (int a = 0; a <= degree; a++)
      for (int b = 0; a + b <= degree; b++)
        for (int c = 0; a + b + c <= degree; c++) {
          double sum = 0;
          for (int q = 0; q < n; q++)
            sum +=
                weight[q] * power(point[q][0], a) * power(point[q][1], b) * power(point[q][2], c);
          check_near(sum, 2 * factorial(a) * factorial(b) * factorial(c) / factorial(a + b + c + 2),
                     1e-15);
        }
  }
}

check_main(check_test(tetrahedron_is_exact), check_test(triangle_is_exact))
