/* How the facets of a surface hang together: welded corners, sides, edges, shells.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_MESH_SURFACE_TOPOLOGY_H
#define BARWRIGHT_MESH_SURFACE_TOPOLOGY_H

#include "barwright/mesh.h"
#include "base/union_find.h"
#include "mesh/surface_tree.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Side 3*t+k of facet t runs from its corner k to its corner k+1 (mod 3). The sides of one edge are
 * listed together, in ascending order. Facets that repeat a welded corner have no edges. */
typedef struct bwi_topology {
  int32_t facets;
  int32_t points;      /* welded points that facets use */
  int32_t *corner;     /* 3 per facet: welded points */
  double *point;       /* 3 per welded point */
  uint8_t *degenerate; /* per facet: it repeats a corner */
  int64_t edges;
  int64_t *start;   /* edges + 1: where an edge's sides begin in `side` */
  int64_t *side;    /* sides by edge */
  int64_t *edge_of; /* per side: its edge, or -1 */
  int32_t shells;
  int32_t *shell; /* per facet: connected through edges; -1 for degenerate facets */
} bwi_topology;

/* Welds points exactly equal and connects. */
bw_status bwi_topology_create(bw_context *context, const bw_surface *surface,
                              bwi_topology **topology);
void bwi_topology_destroy(bwi_topology *topology);

static inline int32_t bwi_side_from(const bwi_topology *topology, int64_t side) {
  return topology->corner[side];
}
static inline int32_t bwi_side_to(const bwi_topology *topology, int64_t side) {
  return topology->corner[side % 3 == 2 ? side - 2 : side + 1];
}

/* Facets that are the same triangle: same[t] is the first facet with the three corners of t in any
 * order (t itself when it is the first). Degenerate facets are on their own. */
bw_status bwi_same_facets(bw_context *context, const bwi_topology *topology, int32_t *same);

/* flat[t] = 1 where the three corners lie on a line or two of them coincide; exact. */
bw_status bwi_flat_facets(bw_context *context, const bwi_topology *topology, uint8_t *flat);

/* Pairs of facets (first < second, ascending) that meet elsewhere than in shared corners and edges.
 * Facets with skip[t] are passed over, and so are facets that are the same triangle. A facet that
 * meets more than 1000 others is listed with 1000. */
typedef struct bwi_pair {
  int32_t first, second;
} bwi_pair;
bw_status bwi_intersections(bw_context *context, const bwi_topology *topology, const uint8_t *skip,
                            bwi_pair **pairs, int64_t *count);

/* How many other shells each shell lies inside of, determined by the parity of crossings of a ray
 * from several of its facets; only facets of shells with closed[shell] count as walls. */
bw_status bwi_shell_depths(bw_context *context, const bwi_topology *topology, const uint8_t *closed,
                           const uint8_t *skip, int32_t *depth);

/* Does a segment from x to the outside (`size`: beyond the surface's box diagonal) cross the facets
 * in the tree an odd number of times? *unclear when x touches a facet. */
bw_status bwi_inside(bw_context *context, const bwi_topology *topology, const bwi_tree *tree,
                     const double x[3], double size, bool *inside, bool *unclear);

#ifdef __cplusplus
}
#endif
#endif
