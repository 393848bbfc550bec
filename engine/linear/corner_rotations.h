/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A coarse space of two_level.h for bodies that linear elements represent poorly: each corner has a
 * rotation w beside its displacement t, and the mid-edge node between the corners a and b moves by
 *
 *   u = (t_a + t_b) / 2 + (w_a - w_b) x (x_b - x_a) / 4
 *
 * (Allman's field, docs/theory/preconditioners.md). Flat elements bend in it without shear. It is
 * followed by the projection onto the unknowns of the node, and A = P^T K P is computed from K, so
 * that it is exact for any supports, curved elements and materials. Rotations that are the same at
 * all corners do not move anything: A has a small multiple of its diagonal there. */
#ifndef BWI_LINEAR_CORNER_ROTATIONS_H
#define BWI_LINEAR_CORNER_ROTATIONS_H

#include "linear/two_level.h"

/* Over the coarse space without rotations, which has half the unknowns on the same graph: numbers
 * of its factor, its operations. Product, pattern and order for a corner, as operations (measured
 * on filled bodies of 1,500 to 4,500 corners: 250e3 to 410e3). */
#define BWI_ROTATIONS_ENTRIES 4.0
#define BWI_ROTATIONS_FLOPS 8.0
#define BWI_ROTATIONS_PRODUCT 360e3

/* For the shape and the supports that the preconditioner follows, of that mesh and with that
 * stiffness (block_count x 9). *rotations is NULL where A is singular. Release with bw_release. */
bw_status bwi_corner_rotations_create(bw_context *context, const bwi_two_level *two_level,
                                      const bw_mesh *mesh, const double *stiffness,
                                      bwi_corner_rotations **rotations);
/* z of the preconditioner += P A^-1 P^T of its residual, for `used` of `width` fields. */
bw_status bwi_corner_rotations_correct(bw_context *context, const bwi_corner_rotations *rotations,
                                       const bwi_two_level *two_level, int width, int used);
/* Bytes that a solution reads. */
double bwi_corner_rotations_read(const bwi_corner_rotations *rotations);

#endif
