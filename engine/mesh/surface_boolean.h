/* Boolean operations of closed surfaces, done by CGAL in a child process.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_MESH_SURFACE_BOOLEAN_H
#define BARWRIGHT_MESH_SURFACE_BOOLEAN_H

#include "barwright/boolean.h"
#include "base/child.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Two sound surfaces. Facets of the result have the group of the facet that they are a part of. */
typedef struct bwi_boolean_job {
  const bw_surface *first, *second;
  bw_boolean operation;
} bwi_boolean_job;
/* Writes the surface, and behind it the group (int32) of every facet. */
bw_status bwi_cgal_boolean(bw_context *context, void *job, bwi_child_stream *out);

#ifdef __cplusplus
}
#endif
#endif
