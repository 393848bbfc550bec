/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Approximate inverses of a solid's tangent, symmetric and positive definite, that need no matrix
 * of the solid itself: node blocks, or a cycle over coarse solids.
 *
 * A cycle: smooth, r -= K z, the same for the coarse solid with P^T r, z += P z', smooth. P is
 * trilinear interpolation from coarse to fine nodes; the coarsest solid's tangent is factored. The
 * smoother is a Chebyshev polynomial in D^-1 K, D the node blocks, on the upper part of the
 * spectrum, the same before and after, so that the cycle is symmetric. */
#ifndef BWI_NONLINEAR_PRECONDITION_H
#define BWI_NONLINEAR_PRECONDITION_H

#include "nonlinear/contact_plane.h"
#include "nonlinear/direct.h"

typedef struct bwi_precondition bwi_precondition;

/* Options name the coarse solids; NULL: node blocks. `constrained`: node_count x 3,
 * read while it lives. */
bw_status bwi_precondition_create(bw_context *context, const bw_solid *solid,
                                  const uint8_t *constrained, const bw_newton_options *options,
                                  const bwi_contact *contact, bwi_precondition **precondition);
void bwi_precondition_destroy(bwi_precondition *precondition);
/* For the tangent in `linear`, taken at u, with `blocks` (9 per node), to which those of contact
 * are still to be added. */
bw_status bwi_precondition_set(bw_context *context, bwi_precondition *precondition,
                               const bw_solid_linear *linear, const double *u,
                               const double *blocks);
/* z = M r, 0 where constrained. */
bw_status bwi_precondition_apply(bw_context *context, bwi_precondition *precondition,
                                 const double *r, double *z);
/* y = K x, the tangent that it was set for with its contact, 0 where constrained. */
bw_status bwi_precondition_multiply(bw_context *context, const bwi_precondition *precondition,
                                    const double *x, double *y);
/* What is constrained (*size components). */
const uint8_t *bwi_precondition_constrained(const bwi_precondition *precondition, int64_t *size);
int bwi_precondition_factorisations(const bwi_precondition *precondition);
size_t bwi_precondition_bytes(const bwi_precondition *precondition);

/* Conjugate gradients (cg.c) for K x = f on components that are not constrained, K the linear's
 * tangent with contact. *negative: a direction p with p . K p <= 0 came up and x is what was
 * reached before. */
typedef struct bwi_cg_report {
  int32_t iterations;
  double residual; /* relative */
  bool negative;
} bwi_cg_report;
bw_status bwi_cg_solve(bw_context *context, bwi_precondition *precondition, double tolerance,
                       int32_t iterations, const double *force, double *x, bwi_cg_report *report);

#endif
