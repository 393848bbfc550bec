/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of filling share. */
#ifndef BARWRIGHT_PLANE_FILL_INTERNAL_H
#define BARWRIGHT_PLANE_FILL_INTERNAL_H

#include "base/limit.h"
#include "plane/internal.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The wanted edge length, from the options; the first value that is none is remembered. */
typedef struct bwi_plane_size_field {
  double size; /* upper bound everywhere */
  bw_size_function *function;
  void *data;
  bool failed;
  double at[2], value; /* where and what, when failed */
} bwi_plane_size_field;
double bwi_plane_size_at(bwi_plane_size_field *field, double x, double y);
bw_status bwi_size_check(bw_context *context, const bwi_plane_size_field *field);

/* Nodes along the outline, loop by loop (fill_boundary.c). */
typedef struct bwi_fill_boundary {
  int32_t count;
  double *point; /* x 2 */
  int32_t *segment;
  double *parameter;
  int32_t *loop_start; /* loops + 1 */
} bwi_fill_boundary;
/* turn: radians that a boundary edge may turn by; limit: of elements. BW_LIMIT when so many nodes
 * are needed that the elements between them are more than that. */
bw_status bwi_fill_boundary_create(bw_context *context, const bw_outline *outline,
                                   bwi_plane_size_field *field, double turn, int64_t limit,
                                   bwi_fill_boundary *boundary);
void bwi_fill_boundary_clear(bwi_fill_boundary *boundary);

/* Triangles inside of the boundary (fill_cgal.cpp). The boundary's nodes keep their numbers; the
 * others follow. */
typedef struct bwi_filling {
  int32_t node_count, element_count;
  double *point;    /* x 2 */
  int32_t *element; /* x 3 */
  int32_t *loop;    /* of elements: the innermost loop around */
  int32_t *chord;   /* of nodes: the boundary node at which the boundary edge begins that the node
                       was put on, -1: none */
  double *along;    /* of nodes: how far along that edge, 0 to 1 */
  bool crossed;     /* boundary edges cross: place nodes more densely. Nothing else is filled in */
  bool full;        /* the limit was reached: nothing else is filled in */
  bool stuck; /* rounding stops refinement, or it turns in circles: nothing else is filled in */
} bwi_filling;

/* The angle that is none, and boundary edges are not split: with others they are where the circle
 * over them holds a node, which along thin walls takes many. */
enum { BWI_WHOLE_EDGES = -1 };
bw_status bwi_fill_cgal(bw_context *context, const bw_outline *outline,
                        const bwi_fill_boundary *boundary, bwi_plane_size_field *field,
                        double minimum_angle, int64_t limit, const bwi_time_limit *time,
                        bwi_filling *filling);

/* The mesh (fill_mesh.c). *fits false: elements are inverted or folded, and nodes along the curves
 * must be denser. */
bw_status bwi_fill_mesh(bw_context *context, const bw_outline *outline,
                        const bwi_fill_boundary *boundary, bwi_filling *filling, int order,
                        bool *fits, bw_plane_mesh **mesh);

/* bw_plane_fill with a guess of the edge length for a wanted number of elements (0: none), which
 * comes back as what was used. */
bw_status bwi_plane_fill(bw_context *context, const bw_outline *outline,
                         const bw_plane_options *options, double *guess, bw_plane_mesh **mesh);

#ifdef __cplusplus
}
#endif
#endif
