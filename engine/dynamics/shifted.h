/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* K + s M and M on the displacements that supports and joints allow: what direct integration solves
 * (docs/theory/transient.md). */
#ifndef BWI_DYNAMICS_SHIFTED_H
#define BWI_DYNAMICS_SHIFTED_H

#include "dynamics/equations.h"
#include "linear/matrix_factor.h"

typedef struct bwi_shifted {
  const bwi_equations *equations; /* borrowed */
  bwi_symbolic *symbolic;         /* of all factors, once there is one */
  int64_t size;                   /* of the numbers that are solved for: fields, or the unknowns x
                                     of a joined model */
  double *diagonal;               /* size: of the mass */
  /* of a joined model */
  bw_operator *mass;    /* T^T M T */
  bwi_matrix_pair pair; /* T^T K T and T^T M T */
  double *b, *x;        /* work space: size each */
} bwi_shifted;
/* Isostatic constraints are left out, and rigid-body modes may be free. Clear with
 * bwi_shifted_clear in any case. */
bw_status bwi_shifted_open(bw_context *context, const bwi_equations *equations,
                           bwi_shifted *shifted);
void bwi_shifted_clear(bwi_shifted *shifted);
size_t bwi_shifted_bytes(const bwi_shifted *shifted);

/* The factor of K + shift M. BW_SINGULAR says where it fails; BW_MEMORY, before it is allocated,
 * for a larger one than what is free. */
bw_status bwi_shifted_factor(bw_context *context, bwi_shifted *shifted, double shift,
                             bwi_factor **factor);
/* Eigenvalues of K x = lambda M x below `lambda` ((rad/s)^2), with those of rigid-body modes;
 * *trusted as in bwi_count_negative. */
bw_status bwi_shifted_below(bw_context *context, bwi_shifted *shifted, double lambda,
                            int64_t *count, bool *trusted);
/* u = (K + shift M)^-1 f; the two may be the same block. */
bw_status bwi_shifted_solve(bw_context *context, const bwi_shifted *shifted,
                            const bwi_factor *factor, const double *f, double *u);
/* u = M^-1 f, another block. BW_CONVERGENCE for elements almost without volume. */
bw_status bwi_shifted_solve_mass(bw_context *context, const bwi_shifted *shifted, const double *f,
                                 double *u);

#endif
