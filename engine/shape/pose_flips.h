/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Edge flips in flat parts of a surface. */
#ifndef BWI_POSE_FLIPS_H
#define BWI_POSE_FLIPS_H

#include "barwright/base.h"

/* Whether the edge from a to b between triangles with the third corners c and d may be flipped. */
typedef bool bwi_may_flip(void *data, int32_t a, int32_t b, int32_t c, int32_t d);

/* Flips edges (Lawson) of fresh triangles until the wanted ones are Delaunay: those whose two
 * triangles differ from the flipped ones by no more than `tolerance` (m), and which may be flipped.
 * Points stay. Flipped triangles become fresh, and take the group of the larger of the two (`group`
 * may be NULL). */
bw_status bwi_flip_flat_edges(bw_context *context, const double *point, int32_t triangles,
                              int32_t *triangle, int32_t *group, uint8_t *fresh, double tolerance,
                              bwi_may_flip *may_flip, void *data);

#endif
