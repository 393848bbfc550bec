/* Edges and shells of a surface.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "mesh/surface_topology.h"

#include <string.h>

#include "mesh/predicates.h"
#include "mesh/surface_internal.h"

void bwi_topology_destroy(bwi_topology *topology) {
  if (!topology)
    return;
  bw_free(topology->corner);
  bw_free(topology->point);
  bw_free(topology->degenerate);
  bw_free(topology->start);
  bw_free(topology->side);
  bw_free(topology->edge_of);
  bw_free(topology->shell);
  bw_free(topology);
}

static bw_status weld_exactly(bw_context *context, const bw_surface *surface,
                              bwi_topology *topology) {
  bw_status status = BW_OK;
  int64_t corners = 3 * (int64_t)surface->triangle_count;
  uint8_t *used = BW_NEW0(context, uint8_t, surface->point_count);
  int32_t *to = BW_NEW(context, int32_t, surface->point_count);
  BW_TRY_MEMORY(used && to);
  for (int64_t i = 0; i < corners; i++)
    used[surface->triangle[i]] = 1;
  BW_TRY(
      bwi_weld_map(context, surface->point_count, surface->point, used, 0, to, &topology->points));
  topology->point = BW_NEW(context, double, (size_t)topology->points * 3);
  BW_TRY_MEMORY(topology->point);
  for (int64_t i = surface->point_count - 1; i >= 0; i--)
    if (to[i] >= 0)
      memcpy(topology->point + 3 * (int64_t)to[i], surface->point + 3 * i, 3 * sizeof(double));
  for (int64_t i = 0; i < corners; i++)
    topology->corner[i] = to[surface->triangle[i]];
  for (int64_t t = 0; t < surface->triangle_count; t++) {
    const int32_t *c = topology->corner + 3 * t;
    topology->degenerate[t] = c[0] == c[1] || c[1] == c[2] || c[2] == c[0];
  }
done:
  bw_free(used);
  bw_free(to);
  return status;
}

static int32_t low_end(const bwi_topology *topology, int64_t side) {
  int32_t a = bwi_side_from(topology, side), b = bwi_side_to(topology, side);
  return a < b ? a : b;
}

static int32_t high_end(const bwi_topology *topology, int64_t side) {
  int32_t a = bwi_side_from(topology, side), b = bwi_side_to(topology, side);
  return a < b ? b : a;
}

/* A stable counting sort of sides by one end. */
static void sort_by(const bwi_topology *topology, bool high, const int64_t *in, int64_t count,
                    int64_t *out, int64_t *slot) {
  memset(slot, 0, ((size_t)topology->points + 1) * sizeof *slot);
  for (int64_t i = 0; i < count; i++)
    slot[(high ? high_end(topology, in[i]) : low_end(topology, in[i])) + 1]++;
  for (int32_t i = 0; i < topology->points; i++)
    slot[i + 1] += slot[i];
  for (int64_t i = 0; i < count; i++)
    out[slot[high ? high_end(topology, in[i]) : low_end(topology, in[i])]++] = in[i];
}

static bw_status connect(bw_context *context, bwi_topology *topology) {
  bw_status status = BW_OK;
  int64_t sides = 3 * (int64_t)topology->facets, count = 0;
  int64_t *other = BW_NEW(context, int64_t, sides);
  int64_t *slot = BW_NEW(context, int64_t, (size_t)topology->points + 1);
  topology->side = BW_NEW(context, int64_t, sides);
  topology->edge_of = BW_NEW(context, int64_t, sides);
  topology->start = BW_NEW(context, int64_t, sides + 1);
  BW_TRY_MEMORY(other && slot && topology->side && topology->edge_of && topology->start);
  for (int64_t s = 0; s < sides; s++) {
    topology->edge_of[s] = -1;
    if (!topology->degenerate[s / 3])
      topology->side[count++] = s;
  }
  sort_by(topology, true, topology->side, count, other, slot);
  sort_by(topology, false, other, count, topology->side, slot);
  for (int64_t i = 0; i < count; i++) {
    int64_t s = topology->side[i], before = i ? topology->side[i - 1] : -1;
    if (i == 0 || low_end(topology, s) != low_end(topology, before) ||
        high_end(topology, s) != high_end(topology, before))
      topology->start[topology->edges++] = i;
    topology->edge_of[s] = topology->edges - 1;
  }
  topology->start[topology->edges] = count;
done:
  bw_free(other);
  bw_free(slot);
  return status;
}

static bw_status find_shells(bw_context *context, bwi_topology *topology) {
  int32_t *parent = BW_NEW(context, int32_t, topology->facets);
  topology->shell = BW_NEW(context, int32_t, topology->facets);
  if (!parent || !topology->shell) {
    bw_free(parent);
    return BW_MEMORY;
  }
  for (int32_t t = 0; t < topology->facets; t++)
    parent[t] = t;
  for (int64_t e = 0; e < topology->edges; e++)
    for (int64_t i = topology->start[e] + 1; i < topology->start[e + 1]; i++)
      bwi_set_join(parent, (int32_t)(topology->side[i - 1] / 3), (int32_t)(topology->side[i] / 3));
  for (int32_t t = 0; t < topology->facets; t++) {
    int32_t root = bwi_set_root(parent, t); /* the smallest facet of the shell */
    topology->shell[t] = topology->degenerate[t] ? -1
                         : root == t             ? topology->shells++
                                                 : topology->shell[root];
  }
  bw_free(parent);
  return BW_OK;
}

bw_status bwi_topology_create(bw_context *context, const bw_surface *surface, bwi_topology **out) {
  bw_status status = BW_OK;
  bwi_topology *topology = BW_NEW0(context, bwi_topology, 1);
  if (!topology)
    return BW_MEMORY;
  topology->facets = surface->triangle_count;
  topology->corner = BW_NEW(context, int32_t, (size_t)surface->triangle_count * 3);
  topology->degenerate = BW_NEW(context, uint8_t, surface->triangle_count);
  BW_TRY_MEMORY(topology->corner && topology->degenerate);
  BW_TRY(weld_exactly(context, surface, topology));
  BW_TRY(bw_check_cancel(context));
  BW_TRY(connect(context, topology));
  BW_TRY(find_shells(context, topology));
  *out = topology;
  topology = NULL;
done:
  bwi_topology_destroy(topology);
  return status;
}

/* ---- facets that are the same, facets that are flat ------------------------------------------ */

static bool same_corners(const int32_t *a, const int32_t *b) {
  int found = 0;
  for (int i = 0; i < 3; i++)
    found += a[i] == b[0] || a[i] == b[1] || a[i] == b[2];
  return found == 3;
}

bw_status bwi_same_facets(bw_context *context, const bwi_topology *topology, int32_t *same) {
  /* Hash by the sum of scrambled corners, which does not depend on their order. */
  size_t mask = 1;
  while (mask < (size_t)topology->facets)
    mask = 2 * mask + 1;
  int32_t *head = BW_NEW(context, int32_t, mask + 1);
  int32_t *next = BW_NEW(context, int32_t, topology->facets);
  if (!head || !next) {
    bw_free(head);
    bw_free(next);
    return BW_MEMORY;
  }
  memset(head, 0xff, (mask + 1) * sizeof *head);
  for (int32_t t = 0; t < topology->facets; t++) {
    same[t] = t;
    if (topology->degenerate[t])
      continue;
    const int32_t *corner = topology->corner + 3 * (int64_t)t;
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
      uint64_t x = ((uint64_t)corner[k] + 1) * 0x9e3779b97f4a7c15u;
      hash += (x ^ x >> 29) * 0xbf58476d1ce4e5b9u;
    }
    size_t slot = (size_t)(hash ^ hash >> 31) & mask;
    int32_t other = head[slot];
    while (other >= 0 && !same_corners(corner, topology->corner + 3 * (int64_t)other))
      other = next[other];
    if (other >= 0) {
      same[t] = other; /* only first ones are in the table */
    } else {
      next[t] = head[slot];
      head[slot] = t;
    }
  }
  bw_free(head);
  bw_free(next);
  return BW_OK;
}

typedef struct flat_work {
  const bwi_topology *topology;
  uint8_t *flat;
} flat_work;

static bw_status find_flat(void *data, int64_t begin, int64_t end, int worker) {
  const flat_work *work = (const flat_work *)data;
  (void)worker;
  for (int64_t t = begin; t < end; t++) {
    const int32_t *c = work->topology->corner + 3 * t;
    const double *x = work->topology->point;
    work->flat[t] =
        work->topology->degenerate[t] ||
        bwi_projection(x + 3 * (int64_t)c[0], x + 3 * (int64_t)c[1], x + 3 * (int64_t)c[2]) < 0;
  }
  return BW_OK;
}

bw_status bwi_flat_facets(bw_context *context, const bwi_topology *topology, uint8_t *flat) {
  flat_work work = {topology, flat};
  return bw_parallel(context, topology->facets, 4096, find_flat, &work);
}
