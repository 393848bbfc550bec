/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The DOF map of an edited shape.
 *
 * Invariants: rows 0 .. S - 1 of `frame` are those of supports, rows S .. S + subdomain_count - 1
 * those of the subdomains, whether a node uses them or not. A node takes the frame of its subdomain
 * when its three components are all held or none is: then any frame serves. A node where some are
 * held keeps the directions in which it is held. Pins are chosen after that, so that a pin of a
 * body that turns turns with it. */
#include <string.h>

#include "model/internal.h"

bw_status bwi_take_frames(bw_context *context, bw_dof_map *dof_map, const bwi_follow *follow) {
  int32_t first = dof_map->frame_count, subdomains = follow->subdomain_count;
  if ((int64_t)first + subdomains > INT32_MAX)
    return bw_fail(context, BW_LIMIT, "%d subdomains are too many", subdomains);
  double *all = (double *)bw_resize(context, dof_map->frame,
                                    9 * ((size_t)first + (size_t)subdomains), sizeof *all);
  if (!all)
    return BW_MEMORY;
  dof_map->frame = all;
  dof_map->frame_count = first + subdomains;
  memcpy(all + 9 * (size_t)first, follow->frame, 9 * (size_t)subdomains * sizeof *all);
  for (int32_t i = 0; i < dof_map->mesh->node_count; i++) {
    const uint8_t *state = dof_map->state + 3 * (size_t)i;
    int32_t subdomain = follow->node_subdomain[i];
    if (subdomain < 0 || state[0] != state[1] || state[1] != state[2])
      continue;
    if (subdomain >= subdomains)
      return bw_fail(context, BW_INVALID, "node %d goes with subdomain %d of %d", i + 1,
                     subdomain + 1, subdomains);
    dof_map->frame_of[i] = first + subdomain;
    double *value = dof_map->value + 3 * (size_t)i, global[3];
    memcpy(global, value, sizeof global);
    for (size_t k = 0; k < 3; k++)
      value[k] = bw_dot(follow->frame + 9 * (size_t)subdomain + 3 * k, global);
  }
  return BW_OK;
}

bw_status bw_dof_map_follow(bw_context *context, const bw_model *model, const bw_dof_map *previous,
                            int32_t subdomain_count, const int32_t *node_subdomain,
                            const double *frame, bool *same, bw_dof_map **out) {
  bw_status status;
  int32_t count = 0;
  bwi_hold *hold = NULL;
  const bw_mesh *mesh = model->mesh;
  const bwi_follow follow = {previous, subdomain_count, node_subdomain, frame};
  if (previous && (previous->mesh->node_count != mesh->node_count ||
                   previous->mesh->component_count != mesh->component_count))
    return bw_fail(context, BW_INVALID,
                   "the DOF map to follow is of a mesh of %d nodes, the model's mesh has %d",
                   previous->mesh->node_count, mesh->node_count);
  BW_TRY(bwi_holds_of(context, model, &count, &hold));
  BW_TRY(bwi_number(context, mesh, count, hold, &follow, out));
  *same = previous && memcmp(previous->state, (*out)->state, 3 * (size_t)mesh->node_count) == 0;
done:
  bw_free(hold);
  return status;
}
