/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Systems that are solved over levels of elements (multilevel.h) in place of a factor, and how it
 * is foreseen which of the two is better. */
#ifndef BWI_SOLVE_STATIC_LEVELS_H
#define BWI_SOLVE_STATIC_LEVELS_H

#include "solve/multilevel.h"

/* What the two ways cost for one solution from nothing but the equations: s of the model's machine
 * (local.h). */
typedef struct bwi_forecast {
  double factor_flops, factor_bytes; /* bytes of L */
  double factor, levels;
  double one_iteration; /* over levels */
} bwi_forecast;

typedef struct bwi_levels {
  bw_object object;
  bwi_multilevel *multilevel; /* or NULL: not made yet */
  bwi_coarse *coarse;         /* what the forecast is from */
  bwi_forecast forecast;
  double spent; /* s of the model's machine, by all solutions over levels so far */
} bwi_levels;

/* Whether a system may be solved so. */
bool bwi_levels_fit(const bw_system *system);
/* Gives the system `levels`, with the forecast alone. */
bw_status bwi_levels_foresee(bw_context *context, bw_system *system);
/* And what solves over them. *usable is false where the equations are singular. */
bw_status bwi_levels_make(bw_context *context, const bw_model *model, bw_system *system,
                          bool *usable);

#endif
