/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Least squares with variables that must not be negative. */
#ifndef BWI_METAMATERIAL_NNLS_H
#define BWI_METAMATERIAL_NNLS_H

#include <stdint.h>

/* Numbers of working memory for n variables. */
#define BWI_NNLS_WORK(n) ((size_t)(n) * (size_t)(n) + 3 * (size_t)(n))

/* The minimum over x >= 0 of x^T G x / 2 - h^T x, where G (n x n, positive definite) = A^T A and
 * h = A^T b for |A x - b|^2 / 2. Of the variables with the same group, no more are let in than have
 * a sum of sizes up to `limit`; group[i] < 0, or group NULL: no such limit. Returns the number of
 * rounds. */
int bwi_nnls(int n, const double *g, const double *h, const int32_t *group, const int32_t *size,
             int limit, double *x, double *work);

#endif
