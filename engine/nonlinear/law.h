/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Laws at eight points at once. Derivations: docs/theory/data_driven.md, Energies. */
#ifndef BWI_NONLINEAR_LAW_H
#define BWI_NONLINEAR_LAW_H

#include "barwright/nonlinear.h"
#include "nonlinear/lanes.h"

typedef enum bwi_want { BWI_ENERGY, BWI_STRESS, BWI_TANGENT } bwi_want;

/* What a law says at each point. Where `defined` is zero the other numbers mean nothing. */
typedef struct bwi_response {
  bwi_lanes energy;
  bwi_lanes ratio; /* det F */
  bwi_mask defined;
  bwi_lanes stress[9];   /* wanted at least BWI_STRESS */
  bwi_lanes inverse[9];  /* the same, neo-Hookean: F^-T, */
  bwi_lanes factor;      /* and mu - lambda ln J: all that the tangent is made of */
  bwi_lanes tangent[81]; /* BWI_TANGENT */
} bwi_response;

/* h = F - 1: what elements compute, and what keeps the digits of small strains. */
void bwi_law(bw_law law, const bwi_lanes *mu, const bwi_lanes *lambda, const bwi_lanes h[9],
             bwi_want want, bool project, bwi_response *out);
/* Adds the term of fibres with directions v. */
void bwi_fibre(const bwi_lanes *stiffness, const bwi_lanes v[3], const bwi_lanes h[9],
               bwi_want want, bool project, bwi_response *out);

/* F = U diag(s) V^T as bw_svd3. */
void bwi_svd(const bwi_lanes f[9], bwi_lanes u[9], bwi_lanes s[3], bwi_lanes v[9]);

/* A law in the frame of singular values: derivatives of the energy by the stretches, their Hessian
 * (00 11 22 12 02 01), and for the pairs 01, 02, 12 of directions the second derivative along the
 * symmetric change of F in this frame (flip) and along the antisymmetric one (twist). */
typedef struct bwi_frame {
  bwi_lanes u[9], s[3], v[9];
  bwi_lanes energy, first[3], second[6], flip[3], twist[3];
} bwi_frame;
/* u, s, v are given. */
void bwi_frame_law(bw_law law, const bwi_lanes *mu, const bwi_lanes *lambda, bwi_want want,
                   bwi_frame *frame);
void bwi_frame_project(bwi_frame *frame);
void bwi_frame_stress(const bwi_frame *frame, bwi_lanes stress[9]);
void bwi_frame_tangent(const bwi_frame *frame, bwi_lanes tangent[81]);

#endif
