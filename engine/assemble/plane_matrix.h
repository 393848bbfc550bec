/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Matrices on a plane mesh: what assembly and those who solve with them share. */
#ifndef BWI_ASSEMBLE_PLANE_MATRIX_H
#define BWI_ASSEMBLE_PLANE_MATRIX_H

#include "barwright/plane_matrix.h"

enum {
  BWI_MAX_COMPONENTS = 4,
  BWI_GRAIN_NODES = 4096,   /* rows of a matrix handed to a thread at once: smaller meshes are done
                               by the caller alone, waking a thread costs as much */
  BWI_GRAIN_ELEMENTS = 2048 /* elements, likewise */
};

static inline int bwi_nodes_per_element(const bw_plane_topology *topology) {
  return topology->nodes->order == 1 ? 3 : 6;
}

/* The block (row, column), which share an element. */
int64_t bwi_plane_block_index(const bw_plane_pattern *pattern, int32_t row, int32_t column);

/* bw_plane_assemble with a workspace for all element matrices, which the caller owns. */
bw_status bwi_plane_assemble(bw_context *context, const bw_plane_pattern *pattern, int components,
                             bw_element_matrix *element_matrix, void *data, double *workspace,
                             double *values);
/* Numbers in that workspace. */
static inline size_t bwi_plane_workspace_size(const bw_plane_pattern *pattern, int components) {
  size_t rows = (size_t)bwi_nodes_per_element(pattern->topology) * (size_t)components;
  return (size_t)pattern->topology->element_count * rows * rows;
}

#endif
