/* The steps that CGAL does for surfaces. Each is a bwi_child_work body: it runs in a child process,
 * reads a job struct, and writes a surface (or a list of triangles) to the stream.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_MESH_SURFACE_CGAL_H
#define BARWRIGHT_MESH_SURFACE_CGAL_H

#include "barwright/mesh.h"
#include "base/child.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Alpha wrap; lengths in m. Input: any triangles. */
typedef struct bwi_wrap_job {
  const bw_surface *surface;
  double alpha, offset;
} bwi_wrap_job;
bw_status bwi_cgal_wrap(bw_context *context, void *job, bwi_child_stream *out);

/* Take self-intersections out locally: by smoothing, else by cutting out and filling again. Input:
 * a bw_surface, welded, closed and manifold. */
bw_status bwi_cgal_resolve(bw_context *context, void *surface, bwi_child_stream *out);

/* The union of closed shells, exactly. Input: welded, each shell closed, manifold, outwards or, for
 * a cavity, inwards, without self-intersections of its own. */
typedef struct bwi_union_job {
  const bw_surface *surface;
  int32_t shells;
  const int32_t *shell;  /* per facet */
  const uint8_t *cavity; /* per shell: to be taken away from the others */
} bwi_union_job;
bw_status bwi_cgal_union(bw_context *context, void *job, bwi_child_stream *out);

/* The first of two surfaces with the points and edges that it has in common with the second. Where
 * faces of both lie in one plane they get the same facets. Input: both closed and manifold. */
typedef struct bwi_refine_job {
  const bw_surface *surface, *other;
  bool second; /* the second surface is wanted, not the first */
} bwi_refine_job;
bw_status bwi_cgal_refine(bw_context *context, void *job, bwi_child_stream *out);

/* Triangles over closed loops of points: writes int32 triples of points, loop by loop. A loop that
 * cannot be filled gives no triangle. */
typedef struct bwi_hole_job {
  const double *point;
  int32_t loops;
  const int64_t *start; /* loops + 1 */
  const int32_t *of;    /* points around each loop */
} bwi_hole_job;
bw_status bwi_cgal_fill(bw_context *context, void *job, bwi_child_stream *out);

/* Run a job that writes a surface and take that surface. */
bw_status bwi_cgal_surface(bw_context *context, const char *what, const bwi_child_limits *limits,
                           bwi_child_work *work, void *job, bw_surface **surface);

#ifdef __cplusplus
}
#endif
#endif
