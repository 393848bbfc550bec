/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Stiffness and mass of one element, by quadrature in plain loops. Assembly does not call these:
 * they are what it is tested against, and the place to start reading. */
#include "assemble/internal.h"

#include <string.h>

/* The strain (xx yy zz yz zx xy, engineering shears) of unit displacements of the nodes. */
static void strain_matrix(int n, const double gradient[10][3], double b[6][30]) {
  memset(b, 0, 6 * sizeof *b);
  for (int a = 0; a < n; a++)
    for (int i = 0; i < 3; i++) {
      int j = (i + 1) % 3, k = (i + 2) % 3;
      b[i][3 * a + i] = gradient[a][i];
      b[3 + j][3 * a + i] = gradient[a][k];
      b[3 + k][3 * a + i] = gradient[a][j];
    }
}

bw_status bw_element_stiffness(bw_context *context, int order, const double (*x)[3],
                               const bw_material *material, double *stiffness) {
  int n = order == 1 ? 4 : 10, size = 3 * n;
  int degree = order == 1 ? 1 : bw_tet_is_straight(x) ? 2 : BWI_CURVED_DEGREE;
  double point[BW_QUADRATURE_POINTS][4], weight[BW_QUADRATURE_POINTS];
  double gradient[BW_QUADRATURE_POINTS][10][3], volume[BW_QUADRATURE_POINTS];
  double mean[10][3] = {{0}}, whole = 0;
  double projected = order == 1 ? 0 : bw_material_projected_bulk(material);
  int points = bw_tet_quadrature(degree, point, weight);

  for (int q = 0; q < points; q++) {
    double determinant = bw_tet_gradient(order, x, point[q], gradient[q]);
    if (!(determinant > 0)) {
      bw_status status =
          bw_fail(context, BW_GEOMETRY,
                  "the element's Jacobian determinant is %g m3 at barycentric (%g, %g, %g, %g), "
                  "and must be positive",
                  determinant, point[q][0], point[q][1], point[q][2], point[q][3]);
      bw_detail_number(context, "determinant", determinant);
      return status;
    }
    volume[q] = weight[q] * determinant / 6;
    whole += volume[q];
    for (int a = 0; a < n; a++)
      for (int k = 0; k < 3; k++)
        mean[a][k] += volume[q] * gradient[q][a][k];
  }
  memset(stiffness, 0, (size_t)(size * size) * sizeof *stiffness);
  for (int q = 0; q < points; q++) {
    double b[6][30], stress[6][30];
    strain_matrix(n, (const double(*)[3])gradient[q], b);
    for (int r = 0; r < 6; r++)
      for (int j = 0; j < size; j++) {
        stress[r][j] = 0;
        for (int s = 0; s < 6; s++)
          stress[r][j] += material->elasticity[6 * r + s] * b[s][j];
        if (r < 3)
          stress[r][j] += projected * (mean[j / 3][j % 3] / whole - gradient[q][j / 3][j % 3]);
      }
    for (int i = 0; i < size; i++)
      for (int j = 0; j < size; j++)
        for (int r = 0; r < 6; r++)
          stiffness[i * size + j] += volume[q] * b[r][i] * stress[r][j];
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
