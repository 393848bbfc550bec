/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A Cholesky factor copied for preconditioning: single precision, nothing stored twice, read in the
 * order in which it lies in memory. An old factor is wrong in its first digits already, and a solve
 * costs what it reads. */
#ifndef BWI_INCREMENTAL_TRIANGULAR_SOLVE_H
#define BWI_INCREMENTAL_TRIANGULAR_SOLVE_H

#include "linear/internal.h"

typedef struct bwi_triangular_solve bwi_triangular_solve;
/* All components of every node must be unknowns. */
bw_status bwi_triangular_solve_create(bw_context *context, const bwi_factor *factor,
                                      bwi_triangular_solve **solve);
void bwi_triangular_solve_destroy(bwi_triangular_solve *solve);
/* z = (L L^T)^-1 r, fields by node. */
void bwi_triangular_solve_apply(bwi_triangular_solve *solve, const double *r, double *z);

#endif
