/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The DOF map of an edited shape.
 *
 * Invariants: rows 0 .. S - 1 of `frame` are those of supports, rows S .. S + subdomain_count - 1
 * those of the subdomains, whether a node uses them or not. A node takes the frame of its subdomain
 * when its three components are all constrained or none is: then any frame serves. A node where
 * some are constrained keeps these directions. Isostatic constraints are chosen after that, so that
 * one of a body that rotates rotates with it. */
#include <string.h>

#include "model/internal.h"

bw_status bw_dof_map_follow(bw_context *context, const bw_model *model, const bw_dof_map *previous,
                            int32_t subdomain_count, const int32_t *node_subdomain,
                            const double *frame, bool *same, bw_dof_map **out) {
  bw_status status;
  int32_t count = 0;
  bwi_constraint *constraint = NULL;
  const bw_mesh *mesh = model->mesh;
  const bwi_follow follow = {previous, subdomain_count, node_subdomain, frame};
  if (previous && (previous->mesh->node_count != mesh->node_count ||
                   previous->mesh->component_count != mesh->component_count))
    return bw_fail(context, BW_INVALID,
                   "the DOF map to follow is of a mesh of %d nodes, the model's mesh has %d",
                   previous->mesh->node_count, mesh->node_count);
  BW_TRY(bw_model_refuse_joints(context, model));
  BW_TRY(bwi_node_constraints(context, model, &count, &constraint));
  BW_TRY(bwi_number(context, mesh, model->material, count, constraint, &follow, out));
  *same = previous && memcmp(previous->state, (*out)->state, 3 * (size_t)mesh->node_count) == 0;
done:
  bw_free(constraint);
  return status;
}
