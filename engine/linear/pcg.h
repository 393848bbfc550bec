/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conjugate gradients with a factor as preconditioner. */
#ifndef BWI_LINEAR_PCG_H
#define BWI_LINEAR_PCG_H

#include "linear/internal.h"

typedef struct bwi_pcg {
  const bw_block_pattern *pattern;
  const double *stiffness;
  const bw_dof_map *dof_map;
  const bwi_factor *factor; /* the preconditioner: of a former shape, or in single precision */
  double tolerance;
  /* Where the force is what a guess has left of another one: |f| and f . M f of that one, for every
     right-hand side, which the tolerance is relative to. Or NULL. */
  const double *load, *energy;
  bool energy_alone; /* the tolerance is on the error in energy alone */
  int limit;         /* on iterations */
  /* Give up as soon as more iterations than this are predicted to be left; 0: never. */
  double max_remaining;
  /* out */
  int iterations;              /* of the right-hand side that took most */
  double predicted_iterations; /* iterations in all, where it was given up */
  bool converged; /* false: given up, the limit was reached, or the matrix is not positive
                     definite */
} bwi_pcg;
/* K u = f at the unknowns for fields in global directions; u is 0 elsewhere. Not converged is no
 * failure; `displacement` is then what was reached. The two may not be the same block. */
bw_status bwi_pcg_solve(bw_context *context, bwi_pcg *problem, int64_t count, const double *force,
                        double *displacement);

#endif
