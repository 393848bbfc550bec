/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of plane share. */
#ifndef BARWRIGHT_PLANE_INTERNAL_H
#define BARWRIGHT_PLANE_INTERNAL_H

#include "barwright/plane.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Nodes per element. */
static inline int bwi_plane_width(const bw_plane_nodes *nodes) {
  return nodes->order == 2 ? 6 : 3;
}

/* ---- making (mesh.c, topology.c) --------------------------------------------------------------
 * Each call takes the arrays over, also when it fails. */

bw_status bwi_plane_nodes_adopt(bw_context *context, int order, int32_t nodes, int32_t corners,
                                int32_t *segment, double *parameter, bw_plane_nodes **out);
/* Neighbours are found, sides follow from the nodes' places on the outline; both are checked. */
bw_status bwi_plane_topology_adopt(bw_context *context, const bw_plane_nodes *nodes,
                                   const bw_outline *outline, int32_t elements, int32_t *element,
                                   int32_t *region, bw_plane_topology **out);
bw_status bwi_plane_mesh_adopt(bw_context *context, const bw_plane_topology *topology,
                               const bw_outline *outline, double *point, bw_plane_mesh **out);
/* A topology whose arrays are all given (side arrays are those of `like`, but for the elements). */
bw_status bwi_plane_topology_like(bw_context *context, const bw_plane_topology *like,
                                  int32_t *element, int32_t *neighbour, int32_t *side_element,
                                  bw_plane_topology **out);
bw_status bwi_plane_check_arrays(bw_context *context, int order, int32_t nodes, const double *point,
                                 int32_t elements, const int32_t *element);

/* ---- quality (quality.c) --------------------------------------------------------------------- */

/* 2 sqrt(3) inradius / longest edge; < 0 when clockwise. */
double bwi_triangle_quality(const double a[2], const double b[2], const double c[2]);
/* The smallest of the six Bernstein coefficients of the Jacobian of a tri6 over their mean: never
 * above the smallest Jacobian over the mean; 1 for straight sides with centred mid-edge nodes. */
double bwi_curved_quality(const double *x[6]);
double bwi_plane_quality(const double *point, const int32_t *element, int order);
/* The worst quality of all elements, *which is the first with it. */
double bwi_plane_worst(const bw_plane_topology *topology, const double *point, int32_t *which);

/* Shape functions of tri6 and their derivatives at (r, s): corners at (0,0), (1,0), (0,1). */
void bwi_tri6(double r, double s, double f[6], double fr[6], double fs[6]);

/* Whether points can move from one to the other: the same segments and loops, also when both were
 * rebuilt (a script may write its outline down for each frame). */
bool bwi_plane_same_shape(const bw_outline *a, const bw_outline *b);

/* The numbers of places (x 2) along a Morton curve (morton.c). */
bw_status bwi_order_places(bw_context *context, int32_t count, const double *place, int32_t *order);

static inline double bwi_cross2(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

#ifdef __cplusplus
}
#endif
#endif
