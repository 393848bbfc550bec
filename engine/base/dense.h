/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Small dense matrices, row by row, in the caller's memory. Order of operations is fixed. */
#ifndef BWI_BASE_DENSE_H
#define BWI_BASE_DENSE_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* a = L L^T in the lower triangle. False where a pivot is not above `min` times its diagonal. */
static inline bool bwi_cholesky(int n, double *a, double min) {
  for (int j = 0; j < n; j++) {
    double *row = a + (size_t)j * (size_t)n, whole = row[j], pivot = whole;
    for (int k = 0; k < j; k++)
      pivot -= row[k] * row[k];
    if (!(pivot > min * whole))
      return false;
    row[j] = sqrt(pivot);
    double inverse = 1 / row[j];
    for (int i = j + 1; i < n; i++) {
      double *other = a + (size_t)i * (size_t)n, sum = other[j];
      for (int k = 0; k < j; k++)
        sum -= other[k] * row[k];
      other[j] = sum * inverse;
    }
  }
  return true;
}

/* x = L^-1 x, and x = L^-T x. */
static inline void bwi_lower_solve(int n, const double *l, double *x) {
  for (int i = 0; i < n; i++) {
    double sum = x[i];
    for (int k = 0; k < i; k++)
      sum -= l[(size_t)i * (size_t)n + k] * x[k];
    x[i] = sum / l[(size_t)i * (size_t)n + i];
  }
}
static inline void bwi_upper_solve(int n, const double *l, double *x) {
  for (int i = n - 1; i >= 0; i--) {
    double value = x[i] /= l[(size_t)i * (size_t)n + i];
    for (int k = 0; k < i; k++)
      x[k] -= l[(size_t)i * (size_t)n + k] * value;
  }
}

/* c (m x n) = a (m x k) b (k x n) */
static inline void bwi_multiply(int m, int k, int n, const double *a, const double *b, double *c) {
  for (int i = 0; i < m; i++) {
    double *row = c + (size_t)i * (size_t)n;
    memset(row, 0, (size_t)n * sizeof *row);
    for (int l = 0; l < k; l++) {
      double factor = a[(size_t)i * (size_t)k + l];
      const double *from = b + (size_t)l * (size_t)n;
      for (int j = 0; j < n; j++)
        row[j] += factor * from[j];
    }
  }
}

/* c (m x n) += a^T b, a (k x m), b (k x n) */
static inline void bwi_multiply_add(int m, int k, int n, const double *a, const double *b,
                                    double *c) {
  for (int l = 0; l < k; l++)
    for (int i = 0; i < m; i++) {
      double factor = a[(size_t)l * (size_t)m + i], *row = c + (size_t)i * (size_t)n;
      const double *from = b + (size_t)l * (size_t)n;
      for (int j = 0; j < n; j++)
        row[j] += factor * from[j];
    }
}

/* Eigenvalues (the diagonal of a) and orthonormal eigenvectors (rows of v) of a symmetric matrix by
 * cyclic Jacobi rotations, until the squares off the diagonal are `tolerance` of those on it, or
 * for so many sweeps. Rows of both are `stride` numbers apart. */
static inline void bwi_symmetric_eigen(int n, int stride, double *a, double *v, double tolerance,
                                       int sweeps) {
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++)
      v[stride * i + j] = i == j;
  for (int sweep = 0; sweep < sweeps; sweep++) {
    double off = 0, on = 0;
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++)
        *(i == j ? &on : &off) += a[stride * i + j] * a[stride * i + j];
    if (off <= tolerance * on)
      return;
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++) {
        double *ap = a + stride * p, *aq = a + stride * q, *vp = v + stride * p,
               *vq = v + stride * q;
        if (ap[q] == 0)
          continue;
        double theta = (aq[q] - ap[p]) / (2 * ap[q]);
        double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
        double c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < n; k++) {
          double x = a[stride * k + p], y = a[stride * k + q];
          a[stride * k + p] = c * x - s * y;
          a[stride * k + q] = s * x + c * y;
        }
        for (int k = 0; k < n; k++) {
          double x = ap[k], y = aq[k], f = vp[k], g = vq[k];
          ap[k] = c * x - s * y;
          aq[k] = s * x + c * y;
          vp[k] = c * f - s * g;
          vq[k] = s * f + c * g;
        }
      }
  }
}

static inline double bwi_dot(int64_t n, const double *a, const double *b) {
  double sum = 0;
  for (int64_t i = 0; i < n; i++)
    sum += a[i] * b[i];
  return sum;
}

#endif
