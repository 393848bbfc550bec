/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Shape functions of tet4 and tet10 and of their facets, in barycentric coordinates L0..L3.
 *
 * Corner i of tet4 has L_i. Of tet10, corner i has L_i (2 L_i - 1) and the middle of edge ab has
 * 4 L_a L_b. Gradients by barycentric coordinates treat L0..L3 as independent; with
 * L0 = 1 - L1 - L2 - L3 a derivative in space is sum_k dN/dL_k grad L_k.
 *
 * docs/theory/elements.md derives everything here. */
#include "barwright/element.h"

#include <math.h>
#include <string.h>

void bw_tet_shape(int order, const double barycentric[4], double *value) {
  const double *l = barycentric;
  if (order == 1) {
    memcpy(value, l, 4 * sizeof *value);
    return;
  }
  for (int i = 0; i < 4; i++)
    value[i] = l[i] * (2 * l[i] - 1);
  for (int m = 0; m < 6; m++)
    value[4 + m] = 4 * l[bw_tet_edge[m][0]] * l[bw_tet_edge[m][1]];
}

void bw_tet_shape_gradient(int order, const double barycentric[4], double (*gradient)[4]) {
  const double *l = barycentric;
  memset(gradient, 0, (order == 1 ? 4 : 10) * sizeof *gradient);
  for (int i = 0; i < 4; i++)
    gradient[i][i] = order == 1 ? 1 : 4 * l[i] - 1;
  if (order == 1)
    return;
  for (int m = 0; m < 6; m++) {
    int a = bw_tet_edge[m][0], b = bw_tet_edge[m][1];
    gradient[4 + m][a] = 4 * l[b];
    gradient[4 + m][b] = 4 * l[a];
  }
}

void bw_facet_shape(int order, const double barycentric[3], double *value) {
  const double *l = barycentric;
  if (order == 1) {
    memcpy(value, l, 3 * sizeof *value);
    return;
  }
  for (int i = 0; i < 3; i++) {
    value[i] = l[i] * (2 * l[i] - 1);
    value[3 + i] = 4 * l[i] * l[(i + 1) % 3];
  }
}

double bw_tet_gradient(int order, const double (*x)[3], const double barycentric[4],
                       double (*gradient)[3]) {
  int n = order == 1 ? 4 : 10;
  double by_l[10][4];
  bw_tet_shape_gradient(order, barycentric, by_l);

  /* jacobian[k][j] = dx_k / dL_j for j = 1..3, with L0 dependent on them */
  double jacobian[9] = {0}, inverse[9];
  for (int a = 0; a < n; a++)
    for (int k = 0; k < 3; k++)
      for (int j = 0; j < 3; j++)
        jacobian[3 * k + j] += x[a][k] * (by_l[a][j + 1] - by_l[a][0]);
  double determinant = bw_inverse3(jacobian, inverse);
  if (determinant == 0) {
    memset(gradient, 0, (size_t)n * sizeof *gradient);
    return 0;
  }
  for (int a = 0; a < n; a++)
    for (int k = 0; k < 3; k++) {
      double sum = 0;
      for (int j = 0; j < 3; j++)
        sum += (by_l[a][j + 1] - by_l[a][0]) * inverse[3 * j + k];
      gradient[a][k] = sum;
    }
  return determinant;
}

double bw_tet_barycentric_gradient(const double *x0, const double *x1, const double *x2,
                                   const double *x3, double gradient[4][3]) {
  double a[3], b[3], c[3];
  for (int k = 0; k < 3; k++) {
    a[k] = x1[k] - x0[k];
    b[k] = x2[k] - x0[k];
    c[k] = x3[k] - x0[k];
  }
  bw_cross(b, c, gradient[1]);
  bw_cross(c, a, gradient[2]);
  bw_cross(a, b, gradient[3]);
  double determinant = bw_dot(a, gradient[1]);
  double scale = determinant != 0 ? 1 / determinant : 0;
  for (int k = 0; k < 3; k++) {
    for (int i = 1; i < 4; i++)
      gradient[i][k] *= scale;
    gradient[0][k] = -(gradient[1][k] + gradient[2][k] + gradient[3][k]);
  }
  return determinant / 6;
}

bool bw_tet_is_straight(const double (*x)[3]) {
  for (int m = 0; m < 6; m++) {
    const double *a = x[bw_tet_edge[m][0]], *b = x[bw_tet_edge[m][1]];
    double off = 0, length = 0;
    for (int k = 0; k < 3; k++) {
      double d = x[4 + m][k] - 0.5 * (a[k] + b[k]), e = b[k] - a[k];
      off += d * d;
      length += e * e;
    }
    if (!(off <= 1e-18 * length))
      return false;
  }
  return true;
}
