/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The flat faces of a closed surface. Facets in one plane, of one group and joined by edges, are
 * one face; points within a straight border are left out.
 *
 * Here a side is an edge of a facet, in its direction (bwi_topology). */
#ifndef BWI_IO_FLAT_FACES_H
#define BWI_IO_FLAT_FACES_H

#include "barwright/mesh.h"
#include "mesh/surface_topology.h"

typedef struct bwi_flat_faces {
  bw_context *context;
  const bw_surface *surface;
  double tolerance; /* (m) within which points lie in a plane or line */
  bwi_topology *topology;
  int32_t face_count;
  int32_t *face_of; /* per facet */
  int32_t *seed;    /* per face: its largest facet */
  uint8_t *kept;    /* per point: it is a vertex of a face */
  int64_t *loop;    /* the loops of borders: a side of each */
  int64_t loop_count;
} bwi_flat_faces;

/* BW_GEOMETRY where the surface is not closed or not oriented. To be cleared in any case. */
bw_status bwi_flat_faces_find(bw_context *context, const bw_surface *surface,
                              bwi_flat_faces *faces);
void bwi_flat_faces_clear(bwi_flat_faces *faces);
bw_status bwi_fail_repair(bw_context *context, const char *what);

/* The side that follows on the border of the face. */
int64_t bwi_flat_next(const bwi_flat_faces *faces, int64_t side);
/* The normal of a facet, twice its area long. */
void bwi_flat_normal(const bwi_topology *t, int32_t facet, double n[3]);

#endif
