/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What following an outline is made of. */
#ifndef BARWRIGHT_PLANE_MESH_MOTION_H
#define BARWRIGHT_PLANE_MESH_MOTION_H

#include "plane/internal.h"

/* What reconnecting makes; no topology where no edge was flipped. */
typedef struct bwi_reconnected {
  bw_plane_topology *topology;
  double *point;
  int32_t flips, moved;
} bwi_reconnected;
bw_status bwi_plane_reconnect(bw_context *context, const bw_plane_topology *topology,
                              const double *point, bwi_reconnected *out);
void bwi_reconnected_clear(bwi_reconnected *reconnected);

/* Places under relocation, computed from a base: a mesh from which displacements are measured
 * (relocate.c). An object: what it keeps from call to call changes no result. */
typedef struct bwi_relocator bwi_relocator;
/* Its equations are factored at the first use. */
bw_status bwi_relocator_create(bw_context *context, const bw_plane_mesh *base, bwi_relocator **out);
const bw_plane_mesh *bwi_relocator_base(const bwi_relocator *relocator);
/* Nodes of the outline to their places on it, those inside harmonically along. */
bw_status bwi_relocate(bw_context *context, bwi_relocator *relocator, const bw_outline *outline,
                       double *point);
/* The paper's springs, from the places of `mesh`. */
bw_status bwi_relocate_springs(bw_context *context, const bw_plane_mesh *mesh,
                               const bw_outline *outline, int rounds, double *point);
/* From the gradient by the nodes of `mesh` to that by the points of its outline. BW_INVALID where
 * the mesh does not have the base's nodes. */
bw_status bwi_relocate_adjoint(bw_context *context, bwi_relocator *relocator,
                               const bw_plane_mesh *mesh, const double *node_gradient,
                               double *point_gradient);

#endif
