/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Equations at the registered external solver. It has one system open at a time: who uses another
 * one closes it, and it is opened again when it is used again. Nothing is opened before the first
 * use, which may be modes and want the mass. */
#ifndef BWI_LINEAR_EXTERNAL_H
#define BWI_LINEAR_EXTERNAL_H

#include "barwright/external.h"

typedef struct bwi_external {
  bw_object object;
  bw_external_problem problem; /* material and DOF map are retained */
  const bw_solver *solver;     /* retained */
  bw_external_report report;   /* of all the times it was open, as of bwi_external_update */
  bool written;                /* the solver has released its matrices */
  bw_external_report former;   /* of the times before the last opening */
} bwi_external;
/* BW_UNSUPPORTED where no solver is registered. */
bw_status bwi_external_create(bw_context *context, const bw_material *material,
                              const bw_dof_map *dof_map, const bw_solver *solver,
                              bwi_external **external);
/* As the functions of bw_external, with the system opened where it is not. */
bw_status bwi_external_multiply(bw_context *context, bwi_external *external, int count,
                                const double *x, double *kx, double *mx, double *magnitude);
bw_status bwi_external_solve(bw_context *context, bwi_external *external, int64_t count,
                             const double *force, double *displacement);
bw_status bwi_external_modes(bw_context *context, bwi_external *external,
                             const struct bw_modes_options *options, bw_external_modes *modes);
/* The next use opens the system again. */
bw_status bwi_external_write(bw_context *context, bwi_external *external,
                             const bw_external_output *output);
/* Asks for the report. */
void bwi_external_update(bw_context *context, bwi_external *external);
/* Solver, iterations and memory of its report; other fields are left. */
void bwi_external_fill_report(const bwi_external *external, bw_solver_report *report);

#endif
