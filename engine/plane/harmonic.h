/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The harmonic extension of a displacement of the boundary to the corners inside. */
#ifndef BARWRIGHT_PLANE_HARMONIC_H
#define BARWRIGHT_PLANE_HARMONIC_H

#include "plane/internal.h"

/* Weighted Laplacian of one mesh, its inner block factored: L L' = P A P'. Nodes on segments are
 * the boundary. */
typedef struct bwi_harmonic {
  int32_t corner_count, inner_count;
  int32_t *place; /* corners: row in the factor, -1: boundary */
  int32_t *order; /* rows: the inner corner, counted among inner corners (for reuse) */
  int32_t *start; /* columns of L, diagonal first */
  int32_t *row;
  double *value;
  int32_t link_count; /* edges from inside to the boundary */
  int32_t *link;      /* x 2: row, boundary corner */
  double *link_weight;
  double *work; /* inner_count x 2 */
} bwi_harmonic;

bw_status bwi_harmonic_create(bw_context *context, const bw_plane_topology *topology,
                              const double *point, bwi_harmonic **out);
void bwi_harmonic_destroy(bwi_harmonic *harmonic);
/* u: corners x 2, given on the boundary, filled in inside. */
void bwi_harmonic_extend(const bwi_harmonic *harmonic, double *u);
/* The adjoint: g of inner corners goes to the boundary's; inside it becomes 0. */
void bwi_harmonic_gather(const bwi_harmonic *harmonic, double *g);

#endif
