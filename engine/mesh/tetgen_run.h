/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* One run of TetGen in a child process. */
#ifndef BWI_TETGEN_RUN_H
#define BWI_TETGEN_RUN_H

#include "barwright/mesh.h"
#include "base/child.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A negative length means that the caller's function returned something that is no length. */
double bwi_size_at(const bw_size_field *field, const double at[3]);

typedef struct bwi_tetgen_job {
  int32_t point_count, triangle_count; /* a sound surface */
  const double *point;
  const int32_t *triangle;
  bool subdomains;    /* facets may meet in any number at an edge; result.subdomain is wanted */
  int32_t hole_count; /* a point inside each cavity */
  const double *hole;
  double max_volume;  /* 0: none */
  double radius_edge; /* 0: no quality asked for */
  double dihedral;    /* radians; 0: none */
  bool keep_surface;
  const bw_size_field *field; /* NULL: none */
  int64_t max_points;         /* points that TetGen may add; 0: as many as it likes */
  bwi_child_limits limits;
} bwi_tetgen_job;

/* Numbers and blocks of a mesh of order 1; the caller frees node, element and subdomain. */
typedef struct bwi_tetgen_result {
  int64_t node_count, element_count;
  double *node;
  int32_t *element;
  int32_t *subdomain; /* of each element: facets bound it; NULL: not asked for */
} bwi_tetgen_result;

/* BW_GEOMETRY when TetGen refuses or breaks (detail "tetgen": its code), BW_LIMIT when time or
 * memory run out, else as bwi_child_run. */
bw_status bwi_tetgen_run(bw_context *context, const bwi_tetgen_job *job, bwi_tetgen_result *result);

/* The work of the child, in C++: calls TetGen and writes the mesh as int64 node count, int64
 * element count, nodes, elements, and subdomains where they are wanted. */
bw_status bwi_tetgen_child(bw_context *context, void *job, bwi_child_stream *out);

#ifdef __cplusplus
}
#endif
#endif
