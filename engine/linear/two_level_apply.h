/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The two-level preconditioner (two_level.h), and its product, as operators on fields, for
 * iterations of others. */
#ifndef BWI_LINEAR_TWO_LEVEL_APPLY_H
#define BWI_LINEAR_TWO_LEVEL_APPLY_H

#include "linear/two_level.h"

/* Memory that it works in, between calls. */
typedef struct bwi_two_level_workspace {
  float *z, *residual, *floats;
  double *corner;
} bwi_two_level_workspace;
bw_status bwi_two_level_workspace_open(bw_context *context, const bwi_two_level *two_level,
                                       bwi_two_level_workspace *workspace);
void bwi_two_level_workspace_clear(bwi_two_level_workspace *workspace);
/* z = B f, near K^-1 f, for `count` fields in global directions. The two may be the same. */
bw_status bwi_two_level_apply(bw_context *context, bwi_two_level *two_level,
                              const bwi_two_level_workspace *workspace, int64_t count,
                              const double *f, double *z);
/* y = K x for `count` fields of a shape that is followed, and the noise of a residual of u as
 * bwi_residual_noise has it. */
bw_status bwi_two_level_multiply(bw_context *context, const bwi_two_level *two_level, int64_t count,
                                 const double *x, double *y);
double bwi_two_level_noise(const bwi_two_level *two_level, const double *u);

#endif
