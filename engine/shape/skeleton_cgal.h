/* The contraction that CGAL does for skeletons: a bwi_child_work body.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#ifndef BARWRIGHT_SHAPE_SKELETON_CGAL_H
#define BARWRIGHT_SHAPE_SKELETON_CGAL_H

#include "barwright/mesh.h"
#include "base/child.h"

#ifdef __cplusplus
extern "C" {
#endif

/* `surface`: a bw_surface of one shell, welded, closed, manifold; its size should be about 1, since
 * CGAL holds lengths against a fixed 1e-7. Writes two int64, the numbers of points and edges; for
 * every point x y z and the mean distance to the points of the surface that were drawn into it (-1
 * for none); for every edge two int32. */
bw_status bwi_cgal_skeleton(bw_context *context, void *surface, bwi_child_stream *out);

#ifdef __cplusplus
}
#endif
#endif
