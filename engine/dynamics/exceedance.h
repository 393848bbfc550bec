/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How often the length of a Gaussian vector of mean 0 exceeds a level (docs/theory/dynamics.md). */
#ifndef BWI_DYNAMICS_EXCEEDANCE_H
#define BWI_DYNAMICS_EXCEEDANCE_H

#include <stdbool.h>

/* Components of the largest vector: the deviator of a stress. */
enum { BWI_DEVIATOR = 5 };

typedef struct bwi_exceedance {
  double probability; /* (-) at an instant */
  double rate;        /* (1/s) of upcrossings, at most */
} bwi_exceedance;
/* Of a process y(t) with the covariances E[y y'] = position, E[y_t y_t'] = velocity and E[y_t y'] =
 * cross, which is antisymmetric; column-major, count x count, overwritten. level above 0.
 * False where LAPACK fails. */
bool bwi_exceedance_of(int count, double *position, double *velocity, double *cross, double level,
                       bwi_exceedance *result);

#endif
