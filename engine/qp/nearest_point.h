/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The point of a polyhedron nearest to the origin: what the quadratic program comes down to. */
#ifndef BARWRIGHT_NEAREST_POINT_H
#define BARWRIGHT_NEAREST_POINT_H

#include "barwright/base.h"
#include "base/dense.h"

/* a_i . z <= beta_i with |a_i| = 1; every row of `a` has n numbers. Well scaled when the farthest
 * violated row lies at a distance near 1. */
typedef struct bwi_polyhedron {
  bw_context *context;
  int n, rows;
  double *a, *beta;
} bwi_polyhedron;

/* z, and the rows' multipliers: z = -sum_i mu_i a_i, mu_i >= 0. *found is false when no point was
 * found that fulfils all rows to 1e-7 of 1 + |z|; *word is what NLopt said. */
bw_status bwi_nearest_point(const bwi_polyhedron *p, double *z, double *mu, bool *found,
                            const char **word);

#endif
