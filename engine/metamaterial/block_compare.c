/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Materials by their stiffness at rest, and as points in the space where distance measures
 * difference. */
#include "base/dense.h"
#include "metamaterial/block.h"
#include "nonlinear/internal.h"

#define MIN_ENERGY 1e-12 /* against the largest of a material's energies */

void bwi_material_stiffness(const bw_solid_material *material, double stiffness[576]) {
  static const double rest[8][3];
  const double spacing[3] = {1, 1, 1};
  double force[BWI_ELEMENT_FORCES], packed[BWI_ELEMENT_NUMBERS];
  bwi_hexahedron_state state;
  bwi_cell_evaluate(material, spacing, 1, rest, BWI_TANGENT, false, &state, force, packed);
  for (int a = 0; a < 8; a++)
    for (int b = 0; b <= a; b++) {
      const double *block = packed + bwi_element_block(a, b);
      for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
          static const int upper[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
          double value = a == b ? block[upper[i][j]] : block[3 * i + j];
          stiffness[(3 * a + i) * BWI_COARSE + 3 * b + j] = value;
          stiffness[(3 * b + j) * BWI_COARSE + 3 * a + i] = value;
        }
    }
}

/* The deformations: uniform strains (stretches along axes and diagonals, shears, and their sums)
 * and gradients of strain, all of the size of one per side. */
static void deformation(int which, double u[BWI_COARSE]) {
  static const double strain[20][6] = {
      /* xx yy zz yz zx xy */
      {1, 0, 0, 0, 0, 0},  {0, 1, 0, 0, 0, 0},   {0, 0, 1, 0, 0, 0},   {0, 0, 0, 1, 0, 0},
      {0, 0, 0, 0, 1, 0},  {0, 0, 0, 0, 0, 1},   {1, 1, 1, 0, 0, 0},   {1, -1, 0, 0, 0, 0},
      {0, 1, -1, 0, 0, 0}, {-1, 0, 1, 0, 0, 0},  {1, 1, 0, 0, 0, 1},   {1, 1, 0, 0, 0, -1},
      {0, 1, 1, 1, 0, 0},  {0, 1, 1, -1, 0, 0},  {1, 0, 1, 0, 1, 0},   {1, 0, 1, 0, -1, 0},
      {1, 1, 1, 1, 1, 1},  {1, 1, 1, 1, -1, -1}, {1, 1, 1, -1, 1, -1}, {1, 1, 1, -1, -1, 1}};
  for (int c = 0; c < 8; c++) {
    double x[3] = {c & 1 ? 0.5 : -0.5, c & 2 ? 0.5 : -0.5, c & 4 ? 0.5 : -0.5};
    if (which < 20) {
      const double *e = strain[which];
      u[3 * c] = e[0] * x[0] + e[5] * x[1] + e[4] * x[2];
      u[3 * c + 1] = e[5] * x[0] + e[1] * x[1] + e[3] * x[2];
      u[3 * c + 2] = e[4] * x[0] + e[3] * x[1] + e[2] * x[2];
    } else {
      int m = (which - 20) / 3, i = (which - 20) % 3;
      double value[8], at[3] = {2 * x[0], 2 * x[1], 2 * x[2]};
      bwi_coarse_functions(at, value);
      u[3 * c] = u[3 * c + 1] = u[3 * c + 2] = 0;
      u[3 * c + i] = 0.5 * value[4 + m];
    }
  }
}

void bwi_features(const double stiffness[576], double feature[BWI_FEATURES]) {
  double largest = 0;
  for (int f = 0; f < BWI_FEATURES; f++) {
    double u[BWI_COARSE], force[BWI_COARSE];
    deformation(f, u);
    bwi_multiply(BWI_COARSE, BWI_COARSE, 1, stiffness, u, force);
    feature[f] = 0.5 * bwi_dot(BWI_COARSE, u, force);
    largest = feature[f] > largest ? feature[f] : largest;
  }
  for (int f = 0; f < BWI_FEATURES; f++)
    feature[f] = largest > 0 ? log(fmax(feature[f], MIN_ENERGY * largest)) : 0;
}
