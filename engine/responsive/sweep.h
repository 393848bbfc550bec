/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A Cholesky factor copied for preconditioning: single precision, nothing stored twice, read in the
 * order in which it lies in memory. An old factor is wrong in its first digits already, and a sweep
 * costs what it reads. */
#ifndef BWI_RESPONSIVE_SWEEP_H
#define BWI_RESPONSIVE_SWEEP_H

#include "solve/internal.h"

typedef struct bwi_sweep bwi_sweep;
/* All components of every node must be unknowns. */
bw_status bwi_sweep_create(bw_context *context, const bwi_factor *factor, bwi_sweep **sweep);
void bwi_sweep_free(bwi_sweep *sweep);
/* z = (L L^T)^-1 r, fields by node. */
void bwi_sweep_apply(bwi_sweep *sweep, const double *r, double *z);
/* Bytes read by one. */
double bwi_sweep_bytes(const bwi_sweep *sweep);

#endif
