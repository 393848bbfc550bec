/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The numbering of an edited shape.
 *
 * Invariants: rows 0 .. S - 1 of `frame` are those of supports, rows S .. S + domain_count - 1
 * those of the domains, whether a node uses them or not. A node takes the frame of its domain when
 * its three components are all unknowns or all held: then any frame serves. A node where some are
 * held keeps the directions in which it is held; a pinned one those in which it is pinned. */
#include <string.h>

#include "model/internal.h"

static bool whole(const uint8_t state[3]) {
  return state[0] == state[1] && state[1] == state[2] && state[0] != BW_PINNED;
}

static bw_status take_frames(bw_context *context, bw_numbering *numbering, int32_t domain_count,
                             const int32_t *node_domain, const double *frame) {
  int32_t first = numbering->frame_count;
  if ((int64_t)first + domain_count > INT32_MAX)
    return bw_fail(context, BW_LIMIT, "%d domains are too many", domain_count);
  double *all = (double *)bw_resize(context, numbering->frame,
                                    9 * ((size_t)first + (size_t)domain_count), sizeof *all);
  if (!all)
    return BW_MEMORY;
  numbering->frame = all;
  numbering->frame_count = first + domain_count;
  memcpy(all + 9 * (size_t)first, frame, 9 * (size_t)domain_count * sizeof *all);
  for (int32_t i = 0; i < numbering->mesh->node_count; i++) {
    if (!whole(numbering->state + 3 * (size_t)i))
      continue;
    int32_t domain = node_domain[i];
    if (domain < 0)
      continue;
    if (domain >= domain_count)
      return bw_fail(context, BW_INVALID, "node %d goes with domain %d of %d", i, domain + 1,
                     domain_count);
    numbering->frame_of[i] = first + domain;
    double *value = numbering->value + 3 * (size_t)i, global[3];
    memcpy(global, value, sizeof global);
    for (int k = 0; k < 3; k++)
      value[k] = bw_dot(frame + 9 * (size_t)domain + 3 * k, global);
  }
  return BW_OK;
}

bw_status bw_numbering_follow(bw_context *context, const bw_model *model,
                              const bw_numbering *previous, int32_t domain_count,
                              const int32_t *node_domain, const double *frame, bool *same,
                              bw_numbering **out) {
  bw_status status;
  int32_t count = 0;
  bwi_hold *hold = NULL;
  bw_numbering *numbering = NULL;
  const bw_mesh *mesh = model->mesh;
  if (previous && (previous->mesh->node_count != mesh->node_count ||
                   previous->mesh->component_count != mesh->component_count))
    return bw_fail(context, BW_INVALID,
                   "the numbering to follow is of a mesh of %d nodes, the model's mesh has %d",
                   previous->mesh->node_count, mesh->node_count);
  BW_TRY(bwi_holds_of(context, model, &count, &hold));
  BW_TRY(bwi_number(context, mesh, count, hold, previous, &numbering));
  BW_TRY(take_frames(context, numbering, domain_count, node_domain, frame));
  *same = previous && memcmp(previous->state, numbering->state, 3 * (size_t)mesh->node_count) == 0;
  *out = numbering;
  numbering = NULL;
done:
  bw_free(hold);
  bw_release(numbering);
  return status;
}
