/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Places on triangles in space. */
#ifndef BWI_MESH_LOCATOR_H
#define BWI_MESH_LOCATOR_H

#include "barwright/mesh.h"

/* The barycentric coordinates of the place on a triangle nearest to p; returns the squared distance
 * (m2). */
double bwi_triangle_weights(const double *p, const double *a, const double *b, const double *c,
                            double weight[3]);

#endif
