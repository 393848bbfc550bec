/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Shape functions: partition of unity, nodal values, gradients by finite differences, linear and
 * quadratic fields reproduced on straight and curved elements. */
#include "check.h"

static const double corner[4][3] = {
    {0.1, 0.2, -0.1}, {1.3, 0.1, 0.2}, {0.3, 1.1, 0.1}, {0.2, 0.4, 1.2}};

static void tet10(double bulge, double x[10][3]) {
  memcpy(x, corner, sizeof corner);
  for (int m = 0; m < 6; m++)
    for (int k = 0; k < 3; k++)
      x[4 + m][k] = 0.5 * (corner[bw_tet_edge[m][0]][k] + corner[bw_tet_edge[m][1]][k]) +
                    bulge * sin(3.0 * m + k);
}

static void node_at(int order, int a, double l[4]) {
  (void)order;
  memset(l, 0, 4 * sizeof *l);
  if (a < 4)
    l[a] = 1;
  else
    l[bw_tet_edge[a - 4][0]] = l[bw_tet_edge[a - 4][1]] = 0.5;
}

static void values_are_one_at_their_node(void **state) {
  (void)state;
  for (int order = 1; order <= 2; order++) {
    int n = order == 1 ? 4 : 10;
    for (int a = 0; a < n; a++) {
      double l[4], value[10];
      node_at(order, a, l);
      bw_tet_shape(order, l, value);
      for (int b = 0; b < n; b++)
        check_near(value[b], a == b, 0);
    }
  }
}

static void values_sum_to_one(void **state) {
  (void)state;
  double l[4] = {0.11, 0.23, 0.31, 0.35}, value[10], gradient[10][4];
  for (int order = 1; order <= 2; order++) {
    int n = order == 1 ? 4 : 10;
    double sum = 0, along = 0;
    bw_tet_shape(order, l, value);
    bw_tet_shape_gradient(order, l, gradient);
    for (int a = 0; a < n; a++) {
      sum += value[a];
      along += gradient[a][1] - gradient[a][0];
    }
    check_near(sum, 1, 1e-15);
    check_near(along, 0, 1e-14);
  }
}

static void gradients_are_differences(void **state) {
  (void)state;
  const double h = 1e-6;
  double l[4] = {0.11, 0.23, 0.31, 0.35}, gradient[10][4];
  for (int order = 1; order <= 2; order++) {
    int n = order == 1 ? 4 : 10;
    bw_tet_shape_gradient(order, l, gradient);
    for (int k = 0; k < 4; k++) {
      double up[4], down[4], high[10], low[10];
      memcpy(up, l, sizeof l);
      memcpy(down, l, sizeof l);
      up[k] += h;
      down[k] -= h;
      bw_tet_shape(order, up, high);
      bw_tet_shape(order, down, low);
      for (int a = 0; a < n; a++)
        check_near(gradient[a][k], (high[a] - low[a]) / (2 * h), 1e-9);
    }
  }
}

static void facets_are_traces(void **state) {
  (void)state;
  double l[3] = {0.2, 0.3, 0.5};
  for (int k = 0; k < 4; k++)
    for (int order = 1; order <= 2; order++) {
      double full[4] = {0}, value[10], facet[6];
      for (int i = 0; i < 3; i++)
        full[bw_tet_face[k][i]] = l[i];
      bw_tet_shape(order, full, value);
      bw_facet_shape(order, l, facet);
      for (int i = 0; i < 3; i++) {
        check_near(facet[i], value[bw_tet_face[k][i]], 1e-16);
        if (order == 2)
          check_near(facet[3 + i], value[bw_tet_face_mid_edge[k][i]], 1e-16);
      }
    }
}

/* A field of the element's degree has exactly its own gradient; on a curved element the position
 * itself is such a field. */
static void fields_have_their_gradient(void **state) {
  (void)state;
  double l[4] = {0.15, 0.35, 0.2, 0.3}, x[10][3], gradient[10][3], shape[10];
  for (int curved = 0; curved <= 1; curved++) {
    tet10(curved ? 0.05 : 0, x);
    assert_int_equal(bw_tet_is_straight((const double(*)[3])x), !curved);
    double determinant = bw_tet_gradient(2, (const double(*)[3])x, l, gradient);
    assert_true(determinant > 0);
    double identity[9] = {0}, squares[3] = {0}, at[3] = {0};
    bw_tet_shape(2, l, shape);
    for (int a = 0; a < 10; a++)
      for (int i = 0; i < 3; i++) {
        at[i] += shape[a] * x[a][i];
        for (int k = 0; k < 3; k++)
          identity[3 * i + k] += x[a][i] * gradient[a][k];
        squares[i] += x[a][0] * x[a][0] * gradient[a][i];
      }
    for (int i = 0; i < 9; i++)
      check_near(identity[i], i % 4 == 0, 1e-13);
    if (!curved) {
      check_near(squares[0], 2 * at[0], 1e-13);
      check_near(squares[1], 0, 1e-13);
    }
  }
}

static void barycentric_gradients(void **state) {
  (void)state;
  double g[4][3], gradient[4][3], l[4] = {0.25, 0.25, 0.25, 0.25};
  double volume = bw_tet_barycentric_gradient(corner[0], corner[1], corner[2], corner[3], g);
  double determinant = bw_tet_gradient(1, corner, l, gradient);
  check_near(volume, determinant / 6, 1e-15);
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++) {
      double value = 0;
      for (int k = 0; k < 3; k++) {
        check_near(g[i][k], gradient[i][k], 1e-14);
        value += g[i][k] * (corner[j][k] - corner[0][k]);
      }
      check_near(value, (i == j) - (i == 0), 1e-14);
    }
  /* A flat element has no gradients, and says so by its volume. */
  check_near(bw_tet_barycentric_gradient(corner[0], corner[1], corner[2], corner[2], g), 0, 1e-17);
}

check_main(check_test(values_are_one_at_their_node), check_test(values_sum_to_one),
           check_test(gradients_are_differences), check_test(facets_are_traces),
           check_test(fields_have_their_gradient), check_test(barycentric_gradients))
