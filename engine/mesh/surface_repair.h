/* The steps of repair. Each takes a surface and gives a new one (or a new reference to the same,
 * with *changed 0, when there is nothing to do).
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_MESH_SURFACE_REPAIR_H
#define BARWRIGHT_MESH_SURFACE_REPAIR_H

#include "barwright/mesh.h"
#include "base/child.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A changed surface, or the same one, and how many facets or points that concerned. */
typedef bw_status bwi_surface_change(bw_context *context, const bw_surface *surface,
                                     bw_surface **out, int64_t *changed);
/* The change again and again until nothing is left of it, `rounds` times at most. */
bw_status bwi_change_again(bw_context *context, const bw_surface *surface,
                           bwi_surface_change *change, int rounds, bw_surface **out,
                           int64_t *changed);
/* Facets that repeat a corner after exact welding go. */
bw_status bwi_drop_repeated(bw_context *context, const bw_surface *surface, bw_surface **out,
                            int64_t *changed);
/* Of facets that are the same triangle one stays. Where facets lie back to back, all of them go if
 * that leaves fewer bad edges (a wall between two touching bodies), else one stays (a surface that
 * was written twice). */
bw_status bwi_drop_duplicates(bw_context *context, const bw_surface *surface, bw_surface **out,
                              int64_t *changed);
/* Facets whose corners lie on a line: the neighbour across the longest side is split at the middle
 * corner and the facet goes. */
bw_status bwi_split_flat(bw_context *context, const bw_surface *surface, bw_surface **out,
                         int64_t *changed);
/* Facets that stick out: with an open side and a side of three facets or more, one after
 * another. */
bw_status bwi_drop_fins(bw_context *context, const bw_surface *surface, bw_surface **out,
                        int64_t *changed);
/* Sheets that hang on the rest along edges of three facets: those that lie inside (baffles), and
 * small ones with an open rim, one after another. */
bw_status bwi_drop_walls(bw_context *context, const bw_surface *surface, bw_surface **out,
                         int64_t *changed);
/* Close cracks: points of open edges closer than tolerance are merged, and open edges are split
 * where such a point lies on them within tolerance. */
bw_status bwi_stitch(bw_context *context, const bw_surface *surface, double tolerance,
                     bw_surface **out, int64_t *changed);
/* Fill loops of open edges that are small (within `size`) or flat. *left counts the others. */
bw_status bwi_fill_holes(bw_context *context, const bw_surface *surface, double size,
                         const bwi_child_limits *limits, bw_surface **out, int64_t *changed,
                         int64_t *left);
/* Pull fans of facets that touch in a point or along an edge apart by `gap`, into the body. */
bw_status bwi_separate(bw_context *context, const bw_surface *surface, double gap, bw_surface **out,
                       int64_t *changed);

/* The facets with keep[t] (all when NULL) and `extra` more triangles of the same points (group:
 * that of extra_from[i]; where that is NULL and there are any, no facet has a group). Points are
 * welded exactly. */
bw_status bwi_surface_select(bw_context *context, const bw_surface *surface, const uint8_t *keep,
                             int64_t extra, const int32_t *extra_triangle,
                             const int32_t *extra_from, bw_surface **out);

#ifdef __cplusplus
}
#endif
#endif
