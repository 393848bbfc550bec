/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Places on triangles in space, and elements near a box. */
#ifndef BWI_MESH_LOCATOR_H
#define BWI_MESH_LOCATOR_H

#include "barwright/mesh.h"
#include "base/box_tree.h"

/* The barycentric coordinates of the place on a triangle nearest to p; returns the squared distance
 * (m2). */
double bwi_triangle_weights(const double *p, const double *a, const double *b, const double *c,
                            double weight[3]);

/* Visits elements that may meet a box, in an order that the mesh alone decides. */
bw_status bwi_locator_in_box(const bw_locator *locator, const double *min, const double *max,
                             bwi_item_visit *visit, void *data);

#endif
