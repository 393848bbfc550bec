/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The round faces of a closed surface: neighbouring flat faces that are chords of one cylinder or
 * cone become one face of it.
 *
 * Only facets of groups that are named as curved count (bw_face_names). A strip is a flat face
 * whose corners lie on the cylinder or cone, and whose borders are straight lines of it or chords
 * of its circles. Such a chord becomes an arc, so that the face on its other side must be a plane
 * across the axis or another round face about the same axis; otherwise the strip stays flat. */
#ifndef BWI_IO_ROUND_FACES_H
#define BWI_IO_ROUND_FACES_H

#include "io/flat_faces.h"

/* Replaces strips by round faces; bwi_flat_loops_find is to follow. */
bw_status bwi_round_faces_find(bwi_flat_faces *faces);

/* The centre (m) and the radius of the circle of a round face through a point. */
double bwi_round_circle(const bwi_round *round, const double at[3], double centre[3]);

#endif
