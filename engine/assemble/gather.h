/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Gradient products of blocks, summed from the elements around them.
 *
 * Everything that assembly needs of a block (i, j) is the 3x3 tensor
 *     T_ij = integral of grad N_i (x) grad N_j:
 * stiffness is a fixed linear map of it, given by the material, and the Laplacian its trace. On a
 * straight element all gradients are combinations of the four barycentric ones g_0..g_3, and T_ij
 * of two nodes is a sum of at most two products of the vectors h_i = sqrt(V) g_i (corners)   and
 * h_a + h_b (mid-edge node ab), with factors that depend on the local numbers alone
 * (docs/theory/elements.md). So an element is a frame of 4 or 10 vectors, small enough to stay in
 * cache while a row of blocks is summed, and no element matrix is ever stored. Curved elements have
 * their products from quadrature instead. */
#ifndef BARWRIGHT_GATHER_H
#define BARWRIGHT_GATHER_H

#include "assemble/internal.h"

/* Four doubles in a register; memory need not be aligned. */
typedef double bwi_vector __attribute__((vector_size(32), aligned(8), may_alias));

typedef struct bwi_frames {
  const bw_mesh *mesh;
  int vectors;             /* per element: 4 or 10 */
  bwi_vector *vector;      /* element_count x vectors: x y z 0 */
  int32_t *curved;         /* as bwi_find_curved */
  double *curved_tensor;   /* curved elements x 55 x 9: pairs b <= a of local nodes, T_ab */
  bwi_vector *curved_mean; /* curved elements x 10: sqrt(V) times the mean of grad N_a */
} bwi_frames;
/* The frame of one straight element into h (4 or 10 vectors); returns the Jacobian determinant,
 * without which being positive the frame means nothing. */
double bwi_element_frame(const bw_mesh *mesh, int64_t element, bwi_vector *h);
bw_status bwi_frames_create(bw_context *context, const bw_mesh *mesh, bwi_frames *frames);
void bwi_frames_clear(bwi_frames *frames);

#endif
