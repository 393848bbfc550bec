/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stiffness and mass of one element, by quadrature in plain loops. Assembly does not call these:
 * they are what it is tested against, and the place to start reading. */
#include "assemble/internal.h"

#include <string.h>

/* Which of the six numbers xx yy zz yz zx xy holds component (i, j). */
static const int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};

bw_status bw_element_stiffness(bw_context *context, int order, const double (*x)[3],
                               const bw_material *material, double *stiffness) {
  int n = order == 1 ? 4 : 10, size = 3 * n;
  int degree = order == 1 ? 1 : bw_tet_is_straight(x) ? 2 : BWI_CURVED_DEGREE;
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  int points = bw_tet_quadrature(degree, point, weight);

  memset(stiffness, 0, (size_t)(size * size) * sizeof *stiffness);
  for (int q = 0; q < points; q++) {
    double gradient[10][3];
    double determinant = bw_tet_gradient(order, x, point[q], gradient);
    if (!(determinant > 0)) {
      bw_status status =
          bw_fail(context, BW_GEOMETRY,
                  "the element's Jacobian determinant is %g m3 at barycentric (%g, %g, %g, %g), "
                  "and must be positive",
                  determinant, point[q][0], point[q][1], point[q][2], point[q][3]);
      bw_detail_number(context, "determinant", determinant);
      return status;
    }
    double volume = weight[q] * determinant / 6;
    /* K[a i][b k] += volume * sum_jl dN_a/dx_j C_ijkl dN_b/dx_l */
    for (int a = 0; a < n; a++)
      for (int i = 0; i < 3; i++)
        for (int b = 0; b < n; b++)
          for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int j = 0; j < 3; j++)
              for (int l = 0; l < 3; l++)
                sum += gradient[a][j] * material->elasticity[6 * voigt[i][j] + voigt[k][l]] *
                       gradient[b][l];
            stiffness[(3 * a + i) * size + 3 * b + k] += volume * sum;
          }
  }
  return BW_OK;
}

void bw_element_mass(int order, const double (*x)[3], double *mass) {
  int n = order == 1 ? 4 : 10;
  int degree = order == 1 ? 2 : bw_tet_is_straight(x) ? 4 : BWI_MASS_DEGREE;
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  int points = bw_tet_quadrature(degree, point, weight);

  memset(mass, 0, (size_t)(n * n) * sizeof *mass);
  for (int q = 0; q < points; q++) {
    double value[10], gradient[10][3];
    bw_tet_shape(order, point[q], value);
    double volume = weight[q] * bw_tet_gradient(order, x, point[q], gradient) / 6;
    for (int a = 0; a < n; a++)
      for (int b = 0; b < n; b++)
        mass[a * n + b] += volume * value[a] * value[b];
  }
}
