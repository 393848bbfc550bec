/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of responsive/ share. */
#ifndef BWI_RESPONSIVE_INTERNAL_H
#define BWI_RESPONSIVE_INTERNAL_H

#include "barwright/responsive.h"

enum {
  BWI_MOST_COMPONENTS = 4,
  BWI_GRAIN_NODES = 4096,   /* rows of a matrix handed to a thread at once: smaller meshes are done
                               by the caller alone, waking a thread costs as much */
  BWI_GRAIN_ELEMENTS = 2048 /* elements, likewise */
};

static inline int bwi_nodes_per_element(const bw_plane_topology *topology) {
  return topology->nodes->order == 1 ? 3 : 6;
}

/* values[pair] = sum of the contributions in `block`: square numbers each, those of element e at
 * block + e * stride, local pair (a, b) as a row-by-row matrix of n x components unknowns. */
bw_status bwi_plane_gather(bw_context *context, const bw_plane_graph *graph, int components,
                           const double *block, double *values);

/* bw_plane_assemble with room for all element matrices, kept by the caller. */
bw_status bwi_plane_assemble(bw_context *context, const bw_plane_graph *graph, int components,
                             bw_element_matrix *element_matrix, void *data, double *room,
                             double *values);
/* Numbers in that room. */
static inline size_t bwi_plane_room(const bw_plane_graph *graph, int components) {
  size_t rows = (size_t)bwi_nodes_per_element(graph->topology) * (size_t)components;
  return (size_t)graph->topology->element_count * rows * rows;
}

#endif
