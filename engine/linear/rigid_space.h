/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The null space of the stiffness of bodies that can move freely, for solvers without a factor.
 *
 * Z has as columns the unconstrained rigid-body modes, orthonormal in the plain sum over the nodes
 * of a field: Z^T Z = 1. The projector Q = 1 - Z Z^T is symmetric, so that it serves displacements
 * and forces alike. Z is never stored: at a node, a mode is t + w x (x - centre). */
#ifndef BWI_LINEAR_RIGID_SPACE_H
#define BWI_LINEAR_RIGID_SPACE_H

#include "barwright/model.h"

enum { BWI_RIGID_FIELDS = 12 }; /* fields that are projected at once, at most */

/* Where a field's numbers are: component d of row r in field f is at r * row + d * component + f *
 * field. */
typedef struct bwi_field_layout {
  int64_t row, component, field;
} bwi_field_layout;

typedef struct bwi_rigid_space bwi_rigid_space;

/* Of fields on those nodes of a DOF map's mesh with a row: row_of (node_count), or -1. Release with
 * bw_release. */
bw_status bwi_rigid_space_create(bw_context *context, const bw_dof_map *dof_map,
                                 const int32_t *row_of, bwi_rigid_space **space);
/* x = Q x for up to BWI_RIGID_FIELDS fields. One call at a time: it works in the space's memory. */
bw_status bwi_rigid_space_project(bw_context *context, bwi_rigid_space *space,
                                  const bwi_field_layout *layout, int fields, double *x);
/* Isostatic constraints: as many components as there are modes, such that none vanishes at all of
 * them, become -1 in unknown (rows x 3; negative where there is no unknown), preferably those of
 * the last call, of a former shape. False where modes cannot be told apart at the unknowns. */
bool bwi_rigid_space_constrain(bwi_rigid_space *space, const bwi_rigid_space *former,
                               int32_t *unknown);

#endif
