/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The faces of a closed surface. Facets in one plane, of one group and joined by edges, are one
 * flat face; those that stand for a cylinder or cone are one round face (round_faces.h). Points
 * within a straight border or an arc are left out, and so are facets that repeat a corner.
 *
 * Here a side is an edge of a facet, in its direction (bwi_topology). */
#ifndef BWI_IO_FLAT_FACES_H
#define BWI_IO_FLAT_FACES_H

#include "barwright/mesh.h"
#include "mesh/surface_topology.h"

/* Points this near to a plane or line lie in it, over the diagonal of the box: numbers of 32 bits
 * have such errors. */
#define FLAT 1e-7
/* The same for points of a cylinder or cone. */
#define ROUND 1e-9

/* A cylinder or a cone. */
typedef struct bwi_round {
  double origin[3], axis[3]; /* a point of the axis, and its direction, of length 1 */
  double radius, slope; /* the radius (m) at the origin; how it grows along the axis, 0 or more */
  bool outward;         /* the solid lies inside of it */
  int32_t apex;         /* the point of a cone that lies within the face, or -1 */
} bwi_round;

typedef struct bwi_flat_faces {
  bw_context *context;
  const bw_surface *surface;
  double tolerance; /* (m) within which points lie in a plane or line */
  bwi_topology *topology;
  int32_t face_count;
  int32_t *face_of; /* per facet; -1 for one that repeats a corner */
  int32_t *seed;    /* per face: its largest facet */
  bwi_round *round; /* round faces */
  int32_t round_count;
  int32_t *round_of; /* per face: which of these it is, or -1 */
  uint8_t *kept;     /* per point: it is a vertex of a face */
  int64_t *loop;     /* the loops of borders: a side of each */
  int64_t loop_count;
} bwi_flat_faces;

/* The flat faces and their kept points; then round_faces.h may replace some. BW_GEOMETRY where the
 * surface is not closed or not oriented. To be cleared in any case. */
bw_status bwi_flat_faces_find(bw_context *context, const bw_surface *surface,
                              bwi_flat_faces *faces);
/* The kept points and loops of the faces that there are. */
bw_status bwi_flat_loops_find(bwi_flat_faces *faces);
void bwi_flat_faces_clear(bwi_flat_faces *faces);
bw_status bwi_fail_repair(bw_context *context, const char *what);

/* The same edge as a side of the neighbouring facet. */
int64_t bwi_flat_opposite(const bwi_topology *t, int64_t side);
/* Whether the facets at a side belong to different faces. */
bool bwi_flat_is_border(const bwi_flat_faces *faces, int64_t side);
/* Whether two points lie at one place along the axis. */
bool bwi_flat_is_across(const bwi_round *round, const double a[3], const double b[3],
                        double tolerance);
/* The round face of which a border side is a chord, or NULL. */
const bwi_round *bwi_flat_round_of(const bwi_flat_faces *faces, int64_t side);
/* The side that follows on the border of the face. */
int64_t bwi_flat_next(const bwi_flat_faces *faces, int64_t side);
/* The normal of a facet, twice its area long. */
void bwi_flat_normal(const bwi_topology *t, int32_t facet, double n[3]);

#endif
