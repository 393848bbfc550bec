/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Regions that stand for the mean stress over a patch of the boundary: a sum of weights times the
 * surface stress at corners of facets (surface_patch.h, surface_stress.h). */
#include "analysis/surface_patch.h"
#include "analysis/weak_internal.h"

#include <math.h>

typedef struct collected {
  double total, *weight; /* 3 for each facet of the list */
  int32_t *facet, facets;
} collected;

static void add_facet(void *data, int32_t facet, const double weight[3]) {
  collected *c = (collected *)data;
  for (int a = 0; a < 3; a++) {
    c->weight[3 * (size_t)c->facets + (size_t)a] = weight[a];
    c->total += weight[a];
  }
  c->facet[c->facets++] = facet;
}

/* What was collected, in the direction of `stress`; clears it. */
static bw_status set_region(bw_context *context, const bw_mesh *mesh, collected *c,
                            const double stress[6], bw_weak_region *r) {
  bw_free(r->element);
  bw_free(r->weight);
  r->volume = r->peak = 0;
  r->count = 3 * c->facets;
  r->element = BW_NEW(context, int32_t, r->count);
  r->corner = BW_NEW(context, int32_t, r->count);
  r->weight = BW_NEW(context, double, 6 * (size_t)r->count);
  if (!r->element || !r->corner || !r->weight)
    return BW_MEMORY;
  for (int32_t k = 0; k < r->count; k++) {
    int32_t facet = c->facet[k / 3];
    r->element[k] = mesh->facet_element[facet];
    r->corner[k] = 3 * facet + k % 3;
    bwi_directed_weight(stress, c->weight[k] / c->total, r->weight + 6 * (size_t)k);
    r->volume += mesh->volume[r->element[k]] / 3;
  }
  c->facets = 0;
  c->total = 0;
  return BW_OK;
}

static bw_status check_patch(bw_context *context, const bwi_surface_patches *patches, int64_t i,
                             int32_t node, const double stress[6]) {
  if (!bwi_surface_patch_exists(patches, node))
    return bw_fail(context, BW_INVALID, "node %d is not on the boundary, or inside of a support",
                   node + 1);
  double largest = 0;
  for (int k = 0; k < 6; k++)
    largest = fmax(largest, fabs(stress[k]));
  if (!isfinite(largest) || !(largest > 0))
    return bw_fail(context, BW_INVALID,
                   "the stress of patch %lld must be finite and not zero to have a direction",
                   (long long)i + 1);
  return BW_OK;
}

bw_status bw_weak_regions_patches(bw_context *context, const bw_mesh *mesh,
                                  const bw_dof_map *dof_map, double radius, int64_t count,
                                  const int32_t *node, const double *stress,
                                  bw_weak_regions **result) {
  bw_status status;
  bw_weak_regions *regions = NULL;
  bwi_surface_patches patches = {.mesh = mesh};
  collected c = {.weight = BW_NEW(context, double, 3 * (size_t)mesh->facet_count),
                 .facet = BW_NEW(context, int32_t, mesh->facet_count)};
  int32_t *first = BW_NEW(context, int32_t, count);
  BW_TRY_MEMORY(c.weight && c.facet && first);
  BW_TRY(bwi_surface_patches_begin(context, mesh, dof_map, radius, &patches));
  for (int64_t i = 0; i < count; i++) {
    BW_TRY(check_patch(context, &patches, i, node[i], stress + 6 * i));
    first[i] = mesh->facet_element[patches.around.element[patches.around.start[node[i]]]];
  }
  BW_TRY(bwi_element_regions(context, mesh, count, first, BW_WORST_DIRECTION, &regions));
  for (int64_t i = 0; i < count; i++) {
    bwi_surface_patch_visit(&patches, node[i], (int32_t)i + 1, 0, add_facet, &c);
    BW_TRY(set_region(context, mesh, &c, stress + 6 * i, &regions->region[i]));
  }
  *result = regions;
  regions = NULL;
done:
  bw_release(regions);
  bwi_surface_patches_clear(&patches);
  bw_free(c.weight);
  bw_free(c.facet);
  bw_free(first);
  return status;
}
