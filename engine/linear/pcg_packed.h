/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The space of conjugate gradients (pcg_space.h) whose vectors are packed in the rows of a smoother
 * (smoother.h): right-hand sides interleaved number by number, so that one pass serves all. */
#ifndef BWI_LINEAR_PCG_PACKED_H
#define BWI_LINEAR_PCG_PACKED_H

#include "linear/pcg_space.h"
#include "linear/rigid_space.h"
#include "linear/smoother.h"

/* The equations are taken times a power of two for the matrix (the smoother's) and one for each
 * right-hand side, so that floats hold what the preconditioner works on. */
typedef struct bwi_packed {
  const bwi_smoother *smoother;
  const bw_dof_map *dof_map;
  bwi_rigid_space *rigid;     /* of the rows: residuals and directions are free of it; or NULL */
  const int32_t *constrained; /* rows with a prescribed component */
  int32_t constrained_count;
  int width;    /* there is room for; at work: of the fields side by side */
  int64_t left; /* at work: fields without a solution */
  double *u, *r, *p, *q, *ku;
  float *floats, *z; /* r, and what becomes of it */
  /* z of the residuals in `floats`, of which `used` are not 0 */
  bw_status (*precondition)(bw_context *context, void *data, int width, int used);
  void *data;
} bwi_packed;

/* K u = f at the unknowns for `count` fields in global directions, one after the other, as many at
 * a time as there is room for; u is 0 elsewhere. `load` and `energy` of the task are those of the
 * fields. Its iterations are the most of all; where some did not converge, the fields behind them
 * have no solution. */
bw_status bwi_packed_solve(bw_context *context, bwi_packed *packed, bwi_pcg_task *task,
                           int64_t count, const double *force, double *displacement);

#endif
