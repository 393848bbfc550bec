/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Small dense systems by elimination with column pivoting: the bases of linear programs. */
#include "lp/linear_program.h"

#include <math.h>

bool bwi_dense_factor(int32_t n, double *a, int32_t *pivot) {
  double largest = 0;
  for (size_t i = 0; i < (size_t)n * (size_t)n; i++)
    largest = fmax(largest, fabs(a[i]));
  for (int32_t k = 0; k < n; k++) {
    int32_t p = k;
    for (int32_t i = k + 1; i < n; i++)
      if (fabs(a[(size_t)i * (size_t)n + (size_t)k]) > fabs(a[(size_t)p * (size_t)n + (size_t)k]))
        p = i;
    pivot[k] = p;
    double *row_k = a + (size_t)k * (size_t)n, *row_p = a + (size_t)p * (size_t)n;
    if (!(fabs(row_p[k]) > 1e-13 * largest))
      return false;
    for (int32_t j = 0; j < n && p != k; j++) {
      double t = row_k[j];
      row_k[j] = row_p[j];
      row_p[j] = t;
    }
    for (int32_t i = k + 1; i < n; i++) {
      double *row = a + (size_t)i * (size_t)n;
      if (row[k] == 0)
        continue;
      double factor = row[k] /= row_k[k];
      for (int32_t j = k + 1; j < n; j++)
        row[j] -= factor * row_k[j];
    }
  }
  return true;
}

void bwi_dense_solve(int32_t n, const double *a, const int32_t *pivot, double *x) {
  for (int32_t k = 0; k < n; k++) {
    double t = x[k];
    x[k] = x[pivot[k]];
    x[pivot[k]] = t;
  }
  for (int32_t i = 0; i < n; i++)
    for (int32_t j = 0; j < i; j++)
      x[i] -= a[(size_t)i * (size_t)n + (size_t)j] * x[j];
  for (int32_t i = n - 1; i >= 0; i--) {
    for (int32_t j = i + 1; j < n; j++)
      x[i] -= a[(size_t)i * (size_t)n + (size_t)j] * x[j];
    x[i] /= a[(size_t)i * (size_t)n + (size_t)i];
  }
}

void bwi_dense_solve_transposed(int32_t n, const double *a, const int32_t *pivot, double *x) {
  for (int32_t i = 0; i < n; i++) {
    for (int32_t j = 0; j < i; j++)
      x[i] -= a[(size_t)j * (size_t)n + (size_t)i] * x[j];
    x[i] /= a[(size_t)i * (size_t)n + (size_t)i];
  }
  for (int32_t i = n - 1; i >= 0; i--)
    for (int32_t j = i + 1; j < n; j++)
      x[i] -= a[(size_t)j * (size_t)n + (size_t)i] * x[j];
  for (int32_t k = n - 1; k >= 0; k--) {
    double t = x[k];
    x[k] = x[pivot[k]];
    x[pivot[k]] = t;
  }
}
