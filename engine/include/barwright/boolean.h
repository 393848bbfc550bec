/* boolean: union, difference and intersection of closed surfaces, and their groups on meshes. */
#ifndef BARWRIGHT_BOOLEAN_H
#define BARWRIGHT_BOOLEAN_H

#include "barwright/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/* What becomes of two bodies. */
typedef enum bw_boolean {
  BW_BOOLEAN_UNION,       /* what lies in either */
  BW_BOOLEAN_DIFFERENCE,  /* what lies in the first and not in the second */
  BW_BOOLEAN_INTERSECTION /* what lies in both */
} bw_boolean;

/* The surface of a union, difference or intersection of two bodies. Intersections are computed
 * exactly, and points are rounded once at the end. Each facet of the result has the group of the
 * facet that it is a part of (0 where a surface has none); where facets of both coincide, that of
 * the first. BW_GEOMETRY where a surface is not sound (bw_surface_check), or the result touches
 * itself along an edge or in a point; BW_EMPTY where nothing is left. BW_LIMIT where time (300 s)
 * or memory (6e9 bytes) run out. Starts a process. */
BW_API bw_status bw_surface_boolean(bw_context *context, const bw_surface *first,
                                    const bw_surface *second, bw_boolean operation,
                                    bw_surface **result);

/* The group of each facet of a mesh's boundary, group (index, facet_count): of the nearest facet of
 * the surface, or of one beside it that faces as it does. BW_INVALID for one without groups. */
BW_API bw_status bw_groups_on_mesh(bw_context *context, const bw_surface *surface,
                                   const bw_mesh *mesh, int32_t *group);

#ifdef __cplusplus
}
#endif
#endif
