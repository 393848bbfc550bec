/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of motion share.
 *
 * Invariants between steps: constrained components of u are the case's values, and their velocities
 * and accelerations 0; kinetic + strain + potential + dissipated changes by the work of follower
 * pressures only; Newmark's acceleration is without the push of contact planes. A step that fails
 * has written nothing but what is marked as workspace. */
#ifndef BWI_NONLINEAR_TRANSIENT_H
#define BWI_NONLINEAR_TRANSIENT_H

#include "nonlinear/newton.h"

typedef struct bwi_transient {
  bw_newton *newton;
  double *dead; /* node_count x 3: loads that do not follow */
  bwi_contact *contact;
  double contact_for; /* the factor of the mass that `contact` was made for */
  /* workspace */
  double *multiplier; /* of contact, before the step */
  double *damping;    /* the tangent at the step's start, where damping needs it: 9 per block */
  bw_solid_linear *damping_linear;               /* or element by element */
  double *centre, *next_velocity, *workspace[3]; /* node_count x 3 each */
} bwi_transient;

/* The coefficients of a step of length h, with which the end's displacement u gives
 *   a = (u - u*) / displacement,        u* = u + h v + old_displacement a,
 *   v = v* + velocity (u - u*),         v* = v + old_velocity a. */
typedef struct bwi_transient_rule {
  double displacement, velocity, old_displacement, old_velocity;
} bwi_transient_rule;
bwi_transient_rule bwi_transient_rule_of(const bw_transient_options *options);

/* By conjugate gradients. */
bool bwi_transient_iterates(const bw_transient_options *options);

/* BW_INVALID says which option cannot be. */
bw_status bwi_transient_check(bw_context *context, const bw_transient_options *options);
double bwi_transient_kinetic(const bw_solid *solid, const double *v);
/* Of loads that do not follow. */
double bwi_transient_work(const bw_solid_transient *motion, const double *u);
/* The projected tangent K at the motion's displacements, kept as damping or damping_linear; y = K
 * x. */
bw_status bwi_transient_tangent(bw_context *context, bw_solid_transient *motion, const double *x,
                                double *y);

#endif
