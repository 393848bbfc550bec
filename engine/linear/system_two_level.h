/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Systems that are solved by two-level PCG (two_level.h) in place of a factor, and how it
 * is predicted which of the two is better. */
#ifndef BWI_LINEAR_SYSTEM_TWO_LEVEL_H
#define BWI_LINEAR_SYSTEM_TWO_LEVEL_H

#include "linear/two_level.h"

/* What the two ways cost for one solution from nothing but the equations: s of the reference
 * machine (base/cost.h). */
typedef struct bwi_cost_prediction {
  double factor_flops, factor_bytes; /* bytes of L */
  double factor, pcg;
  double one_iteration; /* by two-level PCG */
} bwi_cost_prediction;

typedef struct bwi_two_level_solver {
  bw_object object;
  bwi_two_level *preconditioner; /* or NULL: not made yet */
  bwi_coarse *coarse;            /* what the prediction is from, or NULL */
  bwi_symbolic *symbolic;        /* of linear elements: that of the factor, or NULL */
  bwi_cost_prediction prediction;
  double spent; /* s of the reference machine, by all solutions by two-level PCG so far */
} bwi_two_level_solver;

/* Whether a system may be solved so. */
bool bwi_two_level_applies(const bw_system *system);
/* Gives the system its `two_level`, with the prediction alone. On linear elements `pcg` is that
 * with multigrid as preconditioner. */
bw_status bwi_two_level_predict(bw_context *context, bw_system *system);
/* Seconds of the reference machine of one more solution by the PCG that was predicted. */
double bwi_predicted_next(const bwi_two_level_solver *solver);
/* And the preconditioner, where the system has none yet. BW_INVALID for linear elements,
 * BW_SINGULAR where the equations of those on the corners are singular. */
bw_status bwi_two_level_make(bw_context *context, const bw_model *model, bw_system *system);

#endif
