/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of statics/ share, and those that solve statically. */
#ifndef BWI_STATICS_INTERNAL_H
#define BWI_STATICS_INTERNAL_H

#include "barwright/statics.h"
#include "linear/internal.h"

/* ---- statics (statics.c) ------------------------------------------------------------------- */

/* displacement = K^-1 force as bw_system_solve does for one right-hand side. */
typedef struct bwi_static_solver {
  bw_status (*solve)(bw_context *context, void *data, const double *force, double *displacement);
  /* product = K x and *noise as bwi_residual_noise, where no system is given; else NULL */
  bw_status (*multiply)(bw_context *context, void *data, const double *x, double *product,
                        double *noise);
  void *data;
  double refine_to;
  bool once; /* not refined: its residual is no measure of what is asked for */
} bwi_static_solver;
/* A static solution with room for displacement and force, which are not set. */
bw_status bwi_static_new(bw_context *context, const bw_model *model, bw_static **result);
/* A static solution with its load vector, checked for balance; nothing solved yet. */
bw_status bwi_static_begin(bw_context *context, const bw_model *model,
                           const bw_statics_options *options, const bw_dof_map *dof_map,
                           bw_static **result);
/* Displacements, residual, energy, reactions. `system` is NULL where the solver multiplies; its
 * caller judges the residual then. BW_SINGULAR when a tenth of the load is left. */
bw_status bwi_static_solve(bw_context *context, const bw_dof_map *dof_map, bw_system *system,
                           const bwi_static_solver *solver, bw_static *result);

/* bw_statics by the external solver (external.c). */
bw_status bwi_statics_external(bw_context *context, const bw_model *model,
                               const bw_statics_options *options, bw_static **result);

#endif
