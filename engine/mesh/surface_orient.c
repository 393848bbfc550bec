/* Orienting facets so that neighbours agree and shells face the right way.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Facets joined by edges of exactly two facets form a patch; within it the orientation of one facet
 * decides that of all. A patch is then oriented by its volume: outwards where it lies inside an
 * even number of other shells, inwards (a cavity) where odd. A patch with holes is measured as if
 * each hole were closed by a fan from the middle of all its open edges; one that is nearly flat
 * keeps the side that most of its facets had. */
#include <math.h>
#include <string.h>

#include "barwright/mesh.h"
#include "mesh/surface_internal.h"
#include "mesh/surface_topology.h"

typedef struct patches {
  int32_t count;
  int32_t *of;       /* per facet, -1 for degenerate ones */
  uint8_t *reversed; /* per facet: against the way it was given */
} patches;

/* Spread the orientation of one facet over its patch. */
static bw_status spread(bw_context *context, const bwi_topology *topology, int32_t seed,
                        patches *patch, int32_t *queue) {
  int64_t head = 0, tail = 0;
  queue[tail++] = seed;
  patch->of[seed] = patch->count;
  patch->reversed[seed] = 0;
  while (head < tail) {
    int32_t t = queue[head++];
    for (int k = 0; k < 3; k++) {
      int64_t s = 3 * (int64_t)t + k, e = topology->edge_of[s], first = topology->start[e];
      if (topology->start[e + 1] - first != 2)
        continue;
      int64_t o = topology->side[first] == s ? topology->side[first + 1] : topology->side[first];
      int32_t other = (int32_t)(o / 3);
      bool against = bwi_side_from(topology, s) == bwi_side_from(topology, o);
      uint8_t reversed = patch->reversed[t] ^ (uint8_t)against;
      if (patch->of[other] < 0) {
        patch->of[other] = patch->count;
        patch->reversed[other] = reversed;
        queue[tail++] = other;
      } else if (patch->reversed[other] != reversed) {
        const double *x = topology->point + 3 * (int64_t)topology->corner[s];
        bw_status status =
            bw_fail(context, BW_GEOMETRY,
                    "the surface has one side only, like a Moebius strip: facets %d and %d near "
                    "(%g, %g, %g) cannot agree on an outside",
                    t + 1, other + 1, x[0], x[1], x[2]);
        bw_detail_number(context, "facet", t + 1.0);
        return status;
      }
    }
  }
  patch->count++;
  return BW_OK;
}

typedef struct patch_sum {
  double middle[3]; /* of its open edges, or a corner when it has none */
  int64_t open;
  double volume, area;
  int64_t facets, reversed;
  int32_t shell;
} patch_sum;

static void sum_up(const bwi_topology *topology, const patches *patch, patch_sum *sum) {
  for (int64_t s = 0; s < 3 * (int64_t)topology->facets; s++) {
    int32_t p = patch->of[s / 3];
    if (p < 0)
      continue;
    int64_t e = topology->edge_of[s];
    const double *x = topology->point + 3 * (int64_t)topology->corner[s];
    sum[p].shell = topology->shell[s / 3];
    if (topology->start[e + 1] - topology->start[e] != 2) {
      if (sum[p].open++ == 0)
        memset(sum[p].middle, 0, sizeof sum[p].middle);
      for (int k = 0; k < 3; k++)
        sum[p].middle[k] += x[k];
    } else if (sum[p].open == 0) {
      memcpy(sum[p].middle, x, sizeof sum[p].middle);
    }
  }
  for (int32_t p = 0; p < patch->count; p++)
    for (int k = 0; k < 3 && sum[p].open; k++)
      sum[p].middle[k] /= (double)sum[p].open;
  for (int64_t t = 0; t < topology->facets; t++) {
    int32_t p = patch->of[t];
    if (p < 0)
      continue;
    double normal[3],
        volume = bwi_facet_volume(topology->point, topology->corner + 3 * t, sum[p].middle);
    bwi_facet_normal(topology->point, topology->corner + 3 * t, normal);
    sum[p].volume += patch->reversed[t] ? -volume : volume;
    sum[p].area += 0.5 * bw_norm(normal);
    sum[p].facets++;
    sum[p].reversed += patch->reversed[t];
  }
}

/* Shells all of whose edges have an even number of facets enclose something. */
static void find_closed(const bwi_topology *topology, uint8_t *closed) {
  memset(closed, 1, (size_t)topology->shells);
  for (int64_t e = 0; e < topology->edges; e++)
    if ((topology->start[e + 1] - topology->start[e]) % 2)
      closed[topology->shell[topology->side[topology->start[e]] / 3]] = 0;
}

bw_status bw_surface_orient(bw_context *context, const bw_surface *surface, bw_surface **oriented,
                            int64_t *flipped) {
  bw_status status = BW_OK;
  bwi_topology *topology = NULL;
  patch_sum *sum = NULL;
  uint8_t *closed = NULL, *flat = NULL;
  int32_t *depth = NULL;
  bw_surface *made = NULL;
  int64_t count = 0;
  patches patch = {0};
  int32_t *queue = BW_NEW(context, int32_t, surface->triangle_count);
  patch.of = BW_NEW(context, int32_t, surface->triangle_count);
  patch.reversed = BW_NEW0(context, uint8_t, surface->triangle_count);
  BW_TRY_MEMORY(queue && patch.of && patch.reversed);
  BW_TRY(bwi_topology_create(context, surface, &topology));
  memset(patch.of, 0xff, (size_t)topology->facets * sizeof *patch.of);
  for (int32_t t = 0; t < topology->facets; t++)
    if (patch.of[t] < 0 && !topology->degenerate[t])
      BW_TRY(spread(context, topology, t, &patch, queue));

  sum = BW_NEW0(context, patch_sum, patch.count);
  closed = BW_NEW(context, uint8_t, topology->shells);
  flat = BW_NEW(context, uint8_t, topology->facets);
  depth = BW_NEW0(context, int32_t, topology->shells);
  BW_TRY_MEMORY(sum && closed && flat && depth);
  sum_up(topology, &patch, sum);
  find_closed(topology, closed);
  BW_TRY(bwi_flat_facets(context, topology, flat));
  BW_TRY(bwi_shell_depths(context, topology, closed, flat, depth));

  BW_TRY(bw_surface_copy(context, surface->point_count, surface->point, surface->triangle_count,
                         surface->triangle, surface->group, &made));
  bwi_keep_names(surface, made);
  for (int64_t t = 0; t < topology->facets; t++) {
    int32_t p = patch.of[t];
    if (p < 0)
      continue;
    bool inwards = depth[sum[p].shell] % 2 == 1;
    bool decided = fabs(sum[p].volume) > 1e-6 * sum[p].area * sqrt(sum[p].area) ||
                   (sum[p].open == 0 && sum[p].volume != 0);
    bool reverse_patch =
        decided ? (sum[p].volume < 0) != inwards : 2 * sum[p].reversed > sum[p].facets;
    if (patch.reversed[t] == (uint8_t)reverse_patch)
      continue;
    int32_t keep = made->triangle[3 * t + 1];
    made->triangle[3 * t + 1] = made->triangle[3 * t + 2];
    made->triangle[3 * t + 2] = keep;
    count++;
  }
  *oriented = made;
  made = NULL;
  if (flipped)
    *flipped = count;
done:
  bw_release(made);
  bwi_topology_destroy(topology);
  bw_free(queue);
  bw_free(patch.of);
  bw_free(patch.reversed);
  bw_free(sum);
  bw_free(closed);
  bw_free(flat);
  bw_free(depth);
  return status;
}
