/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A closed surface that is asked which points it holds. */
#ifndef BWI_SURFACE_CONTAINS_H
#define BWI_SURFACE_CONTAINS_H

#include "mesh/surface_topology.h"
#include "mesh/surface_tree.h"

typedef struct bwi_container {
  bwi_topology *topology;
  bwi_tree *tree;
  double size; /* beyond the diagonal of the box */
  double low[3], high[3];
} bwi_container;

bw_status bwi_container_create(bw_context *context, const bw_surface *surface, bwi_container *c);
void bwi_container_clear(bwi_container *c);
/* *unclear where the point touches a facet. */
bw_status bwi_container_holds(bw_context *context, const bwi_container *c, const double x[3],
                              bool *inside, bool *unclear);

#endif
