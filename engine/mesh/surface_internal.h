/* Shared between the surface files: welding maps, edges, predicates.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_MESH_SURFACE_INTERNAL_H
#define BARWRIGHT_MESH_SURFACE_INTERNAL_H

#include "barwright/mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

double bwi_surface_diagonal(const bw_surface *surface);
/* Twice the area, along the normal. */
void bwi_facet_normal(const double *point, const int32_t *triangle, double normal[3]);
/* The signed volume of the tetrahedron over a facet from origin. */
double bwi_facet_volume(const double *point, const int32_t *triangle, const double origin[3]);

/* Number points so that merged ones share a number: to[i] in 0..*count-1, in order of first
 * appearance. Points merge when they are exactly equal (tolerance 0) or lie within tolerance of the
 * first point of their cluster: no point moves by more than the tolerance, and clusters do not
 * chain. With `used`, only points i with used[i] take part; to[i] = -1 for the others. */
bw_status bwi_weld_map(bw_context *context, int64_t points, const double *point,
                       const uint8_t *used, double tolerance, int32_t *to, int32_t *count);

/* The distance, or 0 where rounding of the surface's coordinates explains it. */
double bwi_above_rounding(const bw_surface *surface, double distance);
/* The largest distance from samples of one surface to another; 0 where it is rounding. */
bw_status bwi_one_sided_distance(bw_context *context, const bw_surface *from, const bw_surface *to,
                                 double *distance);
/* How far the outside moved: the distance from `after` to `before`, and back from those samples of
 * `before` that do not lie inside `after`. Inner walls that went do not count. */
bw_status bwi_moved_outside(bw_context *context, const bw_surface *before, const bw_surface *after,
                            double *moved);
/* A surface just made, whose groups are those of another one, gets its names. */
void bwi_keep_names(const bw_surface *from, bw_surface *to);
/* Where one of `count` surfaces has names: all get groups of one list of names, *names, for the
 * caller to release; a facet without a name gets the group of an empty one. Else *names is NULL. */
bw_status bwi_name_alike(bw_context *context, int32_t count, bw_surface **surface,
                         bw_face_names **names);
/* Give the facets of a surface just made, which has no groups, the groups of the nearest facets,
 * and their names. */
bw_status bwi_take_groups(bw_context *context, const bw_surface *from, bw_surface *to);

#ifdef __cplusplus
}
#endif
#endif
