/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Singular places where sectors of cyclic symmetry meet. */
#ifndef BWI_MODEL_SINGULAR_SECTOR_H
#define BWI_MODEL_SINGULAR_SECTOR_H

#include "barwright/model.h"
#include "mesh/singular_internal.h"
#include "mesh/surface_topology.h"

/* A wedge that a cut halves is re-entrant beyond 180 degrees by more than this: facets of a round
 * face that meets the cut squarely lean by half of their angle. */
#define BWI_FACET_MARGIN (30 * 0.017453292519943295)

/* What is known of the facets of a sector's boundary. */
typedef struct bwi_sector_border {
  const bw_mesh *mesh;
  const bw_cyclic *cyclic;
  const bwi_topology *top;
  const bw_faces *faces;
  const double *normal;  /* per facet, unit outward */
  const uint8_t *corner; /* per facet: bw_corner */
  const uint8_t *cut;    /* per facet: whether another sector goes on there */
  double margin;         /* (rad) of re-entrant edges */
} bwi_sector_border;

/* Adds the edges of the wheel in its cuts between facets of two sectors, of which one is
 * constrained like this (BW_CORNER_FREE: none). The angle is that of both sectors together. Each
 * stands in the sector that has more of it. */
bw_status bwi_sector_seams(bw_context *context, const bwi_sector_border *border, bw_corner corner,
                           bwi_seams *seams);

/* Replaces places by those that are not in a cut as a whole: the boundary has these, the wheel has
 * not. */
bw_status bwi_sector_without_cuts(bw_context *context, const bw_model *model,
                                  bw_singular_places **places);

#endif
