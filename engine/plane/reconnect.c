/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Reconnecting: flips towards Delaunay and small moves of nodes in distorted elements; all nodes
 * are kept. */
#include "plane/edge_flips.h"
#include "plane/mesh_motion.h"

#include <string.h>

enum { ROUNDS = 4 };
/* Nodes of elements below the first are moved; the second is good enough. */
static const double POOR = 0.7, ENOUGH = 0.7;

/* Elements of sides, after flips. */
static bw_status side_elements(bw_context *context, const bw_plane_topology *topology,
                               const bwi_edge_flips *flipping, int32_t **out) {
  size_t per = flipping->order == 2 ? 3 : 2, width = flipping->order == 2 ? 6 : 3;
  int32_t *list = BW_NEW(context, int32_t, 2 * (size_t)topology->side_count);
  int32_t *side_from = BW_NEW(context, int32_t, flipping->corner_count);
  if (!list || !side_from) {
    bw_free(list);
    bw_free(side_from);
    return BW_MEMORY;
  }
  /* every corner begins at most one side */
  memset(side_from, -1, (size_t)flipping->corner_count * sizeof *side_from);
  memset(list, -1, 2 * (size_t)topology->side_count * sizeof *list);
  for (int32_t s = 0; s < topology->side_count; s++)
    side_from[topology->side[per * (size_t)s]] = s;
  for (int64_t h = 0; h < 3 * (int64_t)flipping->element_count; h++) {
    if (!flipping->constrained[h])
      continue;
    const int32_t *n = flipping->element + width * (size_t)(h / 3);
    int32_t a = n[h % 3], b = n[(h % 3 + 1) % 3];
    int32_t s = side_from[a], t = side_from[b];
    if (s >= 0 && topology->side[per * (size_t)s + 1] == b)
      list[2 * s] = (int32_t)(h / 3);
    else if (t >= 0 && topology->side[per * (size_t)t + 1] == a)
      list[2 * t + 1] = (int32_t)(h / 3);
  }
  bw_free(side_from);
  *out = list;
  return BW_OK;
}

bw_status bwi_plane_reconnect(bw_context *context, const bw_plane_topology *topology,
                              const double *point, bwi_reconnected *out) {
  bw_status status = BW_OK;
  bwi_edge_flips flipping;
  int32_t *side_element = NULL;
  memset(out, 0, sizeof *out);
  BW_TRY(bwi_edge_flips_open(context, topology, point, &flipping));
  bwi_edge_flips_queue_all(&flipping);
  out->flips = bwi_edge_flips_flip(&flipping);
  for (int round = 0; round < ROUNDS; round++) {
    int32_t moved = bwi_edge_flips_smooth(&flipping, POOR, ENOUGH);
    if (moved == 0)
      break;
    out->moved += moved;
    out->flips += bwi_edge_flips_flip(&flipping);
  }
  if (out->flips > 0) {
    BW_TRY(side_elements(context, topology, &flipping, &side_element));
    status = bwi_plane_topology_like(context, topology, flipping.element, flipping.neighbour,
                                     side_element, &out->topology);
    flipping.element = flipping.neighbour = NULL;
    BW_TRY(status);
  }
  out->point = flipping.point;
  flipping.point = NULL;
done:
  bwi_edge_flips_clear(&flipping);
  return status;
}

void bwi_reconnected_clear(bwi_reconnected *reconnected) {
  bw_release(reconnected->topology);
  bw_free(reconnected->point);
  memset(reconnected, 0, sizeof *reconnected);
}
