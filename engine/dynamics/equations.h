/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Products and solutions that a response by modes needs, of models with joints and without. */
#ifndef BWI_DYNAMICS_EQUATIONS_H
#define BWI_DYNAMICS_EQUATIONS_H

#include "joint/fields.h"

/* Displacements u are those that supports and joints allow, forces f act on them alone. */
typedef struct bwi_equations {
  bw_system *system; /* of a model without joints, with mass and factor; else NULL */
  bwi_joined_fields joined;
  const bw_dof_map *dof_map; /* of the nodes, whatever joins them */
  const bw_block_pattern *pattern;
  const double *stiffness; /* (pattern->block_count x 9) of elements and springs at nodes */
  int64_t size;            /* 3 node_count */
  int64_t unknown_count;
  int rigid_count; /* rigid-body modes that supports and joints leave */
} bwi_equations;
/* `system`: that of a model without joints, which is retained. Clear with bwi_equations_clear in
 * any case. */
bw_status bwi_equations_begin(bw_context *context, const bw_model *model, bw_system *system,
                              bwi_equations *equations);
/* The same with the factor that solutions need. BW_UNCONSTRAINED for a joined model that can move
 * freely. */
bw_status bwi_equations_open(bw_context *context, const bw_model *model, bw_system *system,
                             bwi_equations *equations);
void bwi_equations_clear(bwi_equations *equations);

/* f = M u, K u, and A u of values (9 for each block) on the pattern. */
bw_status bwi_equations_mass(bw_context *context, const bwi_equations *equations, const double *u,
                             double *f);
bw_status bwi_equations_stiffness(bw_context *context, const bwi_equations *equations,
                                  const double *u, double *f);
bw_status bwi_equations_values(bw_context *context, const bwi_equations *equations,
                               const double *values, const double *u, double *f);
/* f = K u, at components that supports hold too. */
bw_status bwi_equations_elastic(bw_context *context, const bwi_equations *equations,
                                const double *u, double *f);
/* u = K^-1 f */
bw_status bwi_equations_solve(bw_context *context, const bwi_equations *equations, const double *f,
                              double *u);
/* The loads of the model, of its remote points too: f (N, node_count x 3). */
bw_status bwi_equations_force(bw_context *context, const bw_model *model, double *f);
/* The system of a model without joints, `given` where it serves; without a factor where it is new.
 */
bw_status bwi_equations_system(bw_context *context, const bw_model *model,
                               const bw_dof_map *dof_map, bw_system *given, bw_system **system);
/* BW_INVALID for modes that are not elastic modes of the model. */
bw_status bwi_equations_check_modes(bw_context *context, const bw_model *model,
                                    const bwi_equations *equations, const bw_modes *modes);
/* *part (-): the norm of `given` less `taken` in the mass, where no support holds it, over that of
 * `given`; 0 where that vanishes. */
bw_status bwi_equations_left_out(bw_context *context, const bwi_equations *equations,
                                 const double *given, const double *taken, double *part);
/* The largest part of f that moves an unknown. */
bw_status bwi_equations_largest(bw_context *context, const bwi_equations *equations,
                                const double *f, double *largest);

#endif
