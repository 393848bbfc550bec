/* Dropping sheets that divide a body or hang on it.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * Edges with another number of facets than two cut the surface into patches. Where three facets
 * meet, one patch is too many. It is the one that lies inside what the others enclose, or a small
 * one that ends in the open; the smallest such patch goes, and the rest is looked at again. */
#include <string.h>

#include "mesh/surface_internal.h"
#include "mesh/surface_repair.h"
#include "mesh/surface_topology.h"

enum { SAMPLES = 5, MAX_ROUNDS = 30 };

typedef struct patch_info {
  double area;
  int32_t facets;
  bool odd;  /* borders an edge of three facets, or five, ... */
  bool open; /* has an open rim */
  bool tried;
} patch_info;

static bw_status is_inside(bw_context *context, const bwi_topology *topology, const int32_t *patch,
                           int32_t which, int32_t facets, uint8_t *skip, double size,
                           bool *result) {
  bw_status status = BW_OK;
  bwi_tree *tree = NULL;
  int votes = 0, seen = 0;
  BW_TRY(bwi_flat_facets(context, topology, skip));
  for (int32_t t = 0; t < topology->facets; t++)
    skip[t] |= patch[t] == which;
  BW_TRY(
      bwi_tree_create(context, topology->point, topology->facets, topology->corner, skip, &tree));
  for (int32_t t = 0; t < topology->facets; t++) {
    if (patch[t] != which)
      continue;
    for (int k = 0; k < SAMPLES; k++)
      if (seen == (int64_t)facets * k / SAMPLES) {
        double x[3] = {0};
        bool inside, unclear;
        for (int i = 0; i < 9; i++)
          x[i % 3] +=
              topology->point[3 * (int64_t)topology->corner[3 * (int64_t)t + i / 3] + i % 3] / 3;
        BW_TRY(bwi_inside(context, topology, tree, x, size, &inside, &unclear));
        if (!unclear)
          votes += inside ? 1 : -1;
      }
    seen++;
  }
  *result = votes > 0;
done:
  bwi_tree_destroy(tree);
  return status;
}

static bw_status drop_one(bw_context *context, const bw_surface *surface, bw_surface **out,
                          int64_t *changed) {
  bw_status status = BW_OK;
  bwi_topology *topology = NULL;
  patch_info *info = NULL;
  double total = 0, size = 2 * bwi_surface_diagonal(surface);
  int32_t *patch = BW_NEW(context, int32_t, surface->triangle_count), gone = -1;
  uint8_t *skip = BW_NEW(context, uint8_t, surface->triangle_count);
  info = BW_NEW0(context, patch_info, surface->triangle_count);
  BW_TRY_MEMORY(patch && skip && info);
  BW_TRY(bwi_topology_create(context, surface, &topology));
  for (int32_t t = 0; t < topology->facets; t++)
    patch[t] = t;
  for (int64_t e = 0; e < topology->edges; e++)
    if (topology->start[e + 1] - topology->start[e] == 2)
      bwi_set_join(patch, (int32_t)(topology->side[topology->start[e]] / 3),
                   (int32_t)(topology->side[topology->start[e] + 1] / 3));
  for (int32_t t = 0; t < topology->facets; t++) {
    double normal[3];
    patch[t] = bwi_set_root(patch, t);
    bwi_facet_normal(topology->point, topology->corner + 3 * (int64_t)t, normal);
    info[patch[t]].area += 0.5 * bw_norm(normal);
    info[patch[t]].facets++;
    total += 0.5 * bw_norm(normal);
  }
  for (int64_t e = 0; e < topology->edges; e++) {
    int64_t facets = topology->start[e + 1] - topology->start[e];
    for (int64_t i = topology->start[e]; facets % 2 && i < topology->start[e + 1]; i++) {
      patch_info *p = &info[patch[topology->side[i] / 3]];
      *(facets == 1 ? &p->open : &p->odd) = true;
    }
  }
  for (int tries = 0; tries < MAX_ROUNDS && gone < 0; tries++) {
    int32_t best = -1;
    for (int32_t t = 0; t < topology->facets; t++)
      if (info[t].odd && !info[t].tried && (best < 0 || info[t].area < info[best].area))
        best = t;
    if (best < 0)
      break;
    bool inside = info[best].open && info[best].area < 0.05 * total;
    info[best].tried = true;
    if (!inside)
      BW_TRY(is_inside(context, topology, patch, best, info[best].facets, skip, size, &inside));
    if (inside)
      gone = best;
  }
  *changed = gone < 0 ? 0 : info[gone].facets;
  if (gone < 0) {
    *out = (bw_surface *)bw_retain(surface);
    goto done;
  }
  for (int32_t t = 0; t < topology->facets; t++)
    skip[t] = patch[t] != gone; /* now: keep */
  BW_TRY(bwi_surface_select(context, surface, skip, 0, NULL, NULL, out));
done:
  bwi_topology_destroy(topology);
  bw_free(patch);
  bw_free(skip);
  bw_free(info);
  return status;
}

bw_status bwi_drop_walls(bw_context *context, const bw_surface *surface, bw_surface **out,
                         int64_t *changed) {
  return bwi_change_again(context, surface, drop_one, MAX_ROUNDS, out, changed);
}
