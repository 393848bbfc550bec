/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The equations of a joined model on fields of its nodes (node_count x 3), for analyses that know a
 * body by products and solutions (docs/theory/joints.md). With the motions q = D u of remote points
 *
 *     K = K_body + springs + D^T S D,    M = M_body + masses + D^T M_p D
 *
 * act on all displacements, and T^T K T, T^T M T on those that joints and supports allow. */
#ifndef BWI_JOINT_FIELDS_H
#define BWI_JOINT_FIELDS_H

#include "joint/internal.h"
#include "linear/internal.h"
#include "linear/matrix_factor.h"

typedef struct bwi_joined_fields {
  const bw_model *model; /* borrowed */
  bwi_joined_equations equations;
  double *mass;       /* with attached masses */
  bwi_factor *factor; /* of T^T K T, or NULL */
  double *x;          /* work space: unknowns */
} bwi_joined_fields;
/* Preloads keep their shortening. Clear with bwi_joined_fields_clear in any case. */
bw_status bwi_joined_fields_open(bw_context *context, const bw_model *model,
                                 bwi_joined_fields *fields);
void bwi_joined_fields_clear(bwi_joined_fields *fields);
/* Makes the factor, which solutions need. BW_UNCONSTRAINED where rigid-body modes are left. */
bw_status bwi_joined_factor(bw_context *context, bwi_joined_fields *fields);

bw_status bwi_joined_mass(bw_context *context, const bwi_joined_fields *fields, const double *u,
                          double *f);
bw_status bwi_joined_stiffness(bw_context *context, const bwi_joined_fields *fields,
                               const double *u, double *f);
/* u = T (T^T K T)^-1 T^T f */
bw_status bwi_joined_solve(bw_context *context, const bwi_joined_fields *fields, const double *f,
                           double *u);
/* f = K u of the equations of a model. */
bw_status bwi_joined_multiply(bw_context *context, const bw_model *model,
                              const bwi_joined_equations *equations, const double *u, double *f);
/* The largest component of T^T f. */
bw_status bwi_joined_largest(bw_context *context, const bwi_joined_fields *fields, const double *f,
                             double *largest);

/* Residuals M a + C v + K u - f (node_count x 3) become reactions of supports: 0 where none acts.
 */
bw_status bwi_joined_reactions(bw_context *context, const bwi_joined_fields *fields, double *force);
/* (J) of the springs of attachments and remote points. */
double bwi_spring_energy(const bw_model *model, const double *u);

/* The motions q = D u of the remote points of a model: displacement and rotation (m, rad,
 * coupling_count x 6). */
void bwi_point_motions(const bw_model *model, const double *u, double *q);
/* Given forces and moments of remote points, without weight: f += D^T p. */
void bwi_point_loads(const bw_model *model, double *f);
/* The weight of remote points by all gravity loads: f += D^T m g. */
void bwi_point_weights(const bw_model *model, double *f);

#endif
