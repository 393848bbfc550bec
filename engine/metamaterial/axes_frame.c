/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The coordinates in which a block is fitted, and points of the coarse cell in them. */
#include "base/dense.h"
#include "metamaterial/axes.h"

enum { SQUARE = BWI_SHAPES * BWI_SHAPES };

#define MIN_EIGENVALUE 0.02

void bwi_octant_point(int octant, double spread, double at[3]) {
  for (int d = 0; d < 3; d++)
    at[d] = 0.5 + (octant >> d & 1 ? 0.5 : -0.5) * spread / sqrt(3.0);
}

/* Gradients of the coarse functions in the unit cube. */
static void function_gradients(const double at[3], double gradient[8][3]) {
  double x = 2 * at[0] - 1, y = 2 * at[1] - 1, z = 2 * at[2] - 1;
  const double all[8][3] = {
      {0, 0, 0},         {2, 0, 0},         {0, 2, 0},         {0, 0, 2},
      {2 * y, 2 * x, 0}, {0, 2 * z, 2 * y}, {2 * z, 0, 2 * x}, {2 * y * z, 2 * x * z, 2 * x * y}};
  memcpy(gradient, all, sizeof all);
}

static void gradients(const double *shape, const double at[3], double *gradient) {
  double of[8][3];
  function_gradients(at, of);
  memset(gradient, 0, 9 * BWI_SHAPES * sizeof *gradient);
  for (int m = 1; m < 8; m++)
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        for (int s = 0; s < BWI_SHAPES; s++)
          gradient[(3 * i + j) * BWI_SHAPES + s] += of[m][j] * shape[(3 * m + i) * BWI_SHAPES + s];
}

void bwi_frame18_gradient(const bwi_frame18 *frame, const double at[3],
                          double gradient[9 * BWI_SHAPES]) {
  gradients(frame->shape, at, gradient);
}

/* Strains xx yy zz yz zx xy (engineering shears) from displacement gradients: 6 x 18. */
void bwi_point_strains(const double *gradient, double *strain) {
  static const int row[6][2] = {{0, 0}, {4, 4}, {8, 8}, {5, 7}, {2, 6}, {1, 3}};
  for (int k = 0; k < 6; k++)
    for (int s = 0; s < BWI_SHAPES; s++)
      strain[k * BWI_SHAPES + s] =
          gradient[row[k][0] * BWI_SHAPES + s] + (k < 3 ? 0 : gradient[row[k][1] * BWI_SHAPES + s]);
}

/* matrix (18 x 18) += factor v v^T */
void bwi_add_square(double factor, const double *v, double *matrix) {
  for (int a = 0; a < BWI_SHAPES; a++)
    for (int b = 0; b < BWI_SHAPES; b++)
      matrix[a * BWI_SHAPES + b] += factor * v[a] * v[b];
}

/* Stiffness of a point with constants mu, lambda. */
void bwi_add_isotropic(double mu, double lambda, const double *strain, double *matrix) {
  double trace[BWI_SHAPES];
  for (int s = 0; s < BWI_SHAPES; s++)
    trace[s] = strain[s] + strain[BWI_SHAPES + s] + strain[2 * BWI_SHAPES + s];
  if (lambda > 0)
    bwi_add_square(lambda, trace, matrix);
  for (int k = 0; k < 6 && mu > 0; k++)
    bwi_add_square(k < 3 ? 2 * mu : mu, strain + k * BWI_SHAPES, matrix);
}

/* The stretch of a fibre for each coordinate. */
void bwi_fibre_strain(const double v[3], const double *strain, double *along) {
  const double factor[6] = {v[0] * v[0], v[1] * v[1], v[2] * v[2],
                            v[1] * v[2], v[2] * v[0], v[0] * v[1]};
  bwi_multiply(1, 6, BWI_SHAPES, factor, strain, along);
}

void bwi_frame18_of(const bwi_condensed *condensed, const bwi_base *base, bwi_frame18 *frame) {
  double shape[BWI_COARSE * BWI_SHAPES] = {0}, half[BWI_COARSE * BWI_SHAPES];
  double stiffness[SQUARE] = {0}, lower[SQUARE];
  static const int pair[3][2] = {{1, 2}, {2, 0}, {0, 1}};
  for (int d = 0; d < 3; d++) {
    int i = pair[d][0], j = pair[d][1];
    shape[(3 * (1 + d) + d) * BWI_SHAPES + d] = 1;
    shape[(3 * (1 + j) + i) * BWI_SHAPES + 3 + d] = sqrt(0.5);
    shape[(3 * (1 + i) + j) * BWI_SHAPES + 3 + d] = sqrt(0.5);
  }
  for (int g = 0; g < BWI_SHAPES - BWI_STRAINS; g++)
    shape[(BWI_AFFINE + g) * BWI_SHAPES + BWI_STRAINS + g] = 1;
  bwi_multiply(BWI_COARSE, BWI_COARSE, BWI_SHAPES, condensed->stiffness, shape, half);
  bwi_multiply_add(BWI_SHAPES, BWI_COARSE, BWI_SHAPES, shape, half, stiffness);
  memcpy(lower, stiffness, sizeof lower);
  for (int k = 0; k < BWI_OCTANTS; k++) {
    double at[3], gradient[9 * BWI_SHAPES], strain[6 * BWI_SHAPES];
    bwi_octant_point(k, 1, at);
    gradients(shape, at, gradient);
    bwi_point_strains(gradient, strain);
    bwi_add_isotropic(BWI_FLOOR * base->mean_mu / 8, 0, strain, lower);
  }
  bwi_cholesky(BWI_SHAPES, lower, 0);
  /* shape <- shape L^-T, row by row: (L^-1 row^T)^T */
  memcpy(frame->shape, shape, sizeof shape);
  for (int r = 0; r < BWI_COARSE; r++)
    bwi_lower_solve(BWI_SHAPES, lower, frame->shape + (size_t)r * BWI_SHAPES);
  memset(frame->target, 0, sizeof frame->target);
  bwi_multiply(BWI_COARSE, BWI_COARSE, BWI_SHAPES, condensed->stiffness, frame->shape, half);
  bwi_multiply_add(BWI_SHAPES, BWI_COARSE, BWI_SHAPES, frame->shape, half, frame->target);
  for (int s = 0; s < BWI_SHAPES; s++)
    frame->weight[s] = s < BWI_STRAINS ? 1 : BWI_GRADIENT_WEIGHT;
}

void bwi_metric(const double response[SQUARE], double metric[SQUARE]) {
  double a[SQUARE], v[SQUARE];
  memcpy(a, response, sizeof a);
  bwi_symmetric_eigen(BWI_SHAPES, BWI_SHAPES, a, v, 1e-24, 30);
  memset(metric, 0, SQUARE * sizeof *metric);
  for (int k = 0; k < BWI_SHAPES; k++)
    bwi_add_square(1 / sqrt(sqrt(fmax(a[19 * k], MIN_EIGENVALUE))), v + 18 * k, metric);
}
