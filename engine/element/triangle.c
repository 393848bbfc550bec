/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Triangles of the plane, three or six nodes, in barycentric coordinates L0 L1 L2. Values are those
 * of a facet (shape.c); corner i has L_i or L_i (2 L_i - 1), the middle of edge ab 4 L_a L_b. */
#include <string.h>

#include "barwright/element.h"

void bw_triangle_shape_gradient(int order, const double barycentric[3], double (*gradient)[3]) {
  const double *l = barycentric;
  memset(gradient, 0, (order == 1 ? 3 : 6) * sizeof *gradient);
  for (int i = 0; i < 3; i++)
    gradient[i][i] = order == 1 ? 1 : 4 * l[i] - 1;
  if (order == 1)
    return;
  for (int a = 0; a < 3; a++) {
    int b = (a + 1) % 3;
    gradient[3 + a][a] = 4 * l[b];
    gradient[3 + a][b] = 4 * l[a];
  }
}

double bw_triangle_gradient(int order, const double (*x)[2], const double barycentric[3],
                            double (*gradient)[2]) {
  int n = order == 1 ? 3 : 6;
  double by_l[6][3];
  bw_triangle_shape_gradient(order, barycentric, by_l);
  /* dx_k / dL_j for j = 1, 2, with L0 dependent on them */
  double j00 = 0, j01 = 0, j10 = 0, j11 = 0;
  for (int a = 0; a < n; a++) {
    double by_1 = by_l[a][1] - by_l[a][0], by_2 = by_l[a][2] - by_l[a][0];
    j00 += x[a][0] * by_1;
    j01 += x[a][0] * by_2;
    j10 += x[a][1] * by_1;
    j11 += x[a][1] * by_2;
  }
  double determinant = j00 * j11 - j01 * j10, scale = determinant != 0 ? 1 / determinant : 0;
  for (int a = 0; a < n; a++) {
    double by_1 = by_l[a][1] - by_l[a][0], by_2 = by_l[a][2] - by_l[a][0];
    gradient[a][0] = scale * (by_1 * j11 - by_2 * j10);
    gradient[a][1] = scale * (by_2 * j00 - by_1 * j01);
  }
  return determinant;
}
