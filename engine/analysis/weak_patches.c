/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Regions that stand for the mean stress over a patch of the boundary: the elements behind its
 * facets, each with the weight of the patch on them. */
#include "analysis/surface_patch.h"
#include "analysis/weak_internal.h"

#include <math.h>
#include <string.h>

typedef struct shares {
  const bw_mesh *mesh;
  double *of_element; /* element_count, 0 but for the elements of the list */
  int32_t *element;
  int32_t count;
} shares;

static void add_facet(void *data, int32_t facet, const double share[BWI_PATCH_SAMPLES]) {
  shares *s = (shares *)data;
  int32_t e = s->mesh->facet_element[facet];
  if (s->of_element[e] == 0)
    s->element[s->count++] = e;
  for (int k = 0; k < BWI_PATCH_SAMPLES; k++)
    s->of_element[e] += share[k];
}

/* The mean over the patch of the stress in the direction of `stress`, of what `s` collected. */
static bw_status set_region(bw_context *context, shares *s, const double stress[6],
                            bw_weak_region *r) {
  double total = 0;
  bw_free(r->element);
  bw_free(r->weight);
  r->volume = r->peak = 0;
  r->count = s->count;
  r->element = BW_NEW(context, int32_t, s->count);
  r->weight = BW_NEW(context, double, 6 * (size_t)s->count);
  if (!r->element || !r->weight)
    return BW_MEMORY;
  for (int32_t k = 0; k < s->count; k++)
    total += s->of_element[s->element[k]];
  for (int32_t k = 0; k < s->count; k++) {
    int32_t e = r->element[k] = s->element[k];
    double volume = bwi_shape_integrals(s->mesh, e, NULL, NULL); /* curved edges included */
    bwi_directed_weight(stress, s->of_element[e] / (total * volume), r->weight + 6 * (size_t)k);
    r->volume += volume;
    s->of_element[e] = 0;
  }
  s->count = 0;
  return BW_OK;
}

bw_status bw_weak_regions_patches(bw_context *context, const bw_mesh *mesh, double radius,
                                  int64_t count, const int32_t *node, const double *stress,
                                  bw_weak_regions **result) {
  bw_status status;
  bw_weak_regions *regions = NULL;
  bwi_surface_patches patches = {.mesh = mesh};
  shares s = {.mesh = mesh};
  int32_t *first = BW_NEW(context, int32_t, count);
  s.of_element = BW_NEW0(context, double, mesh->element_count);
  s.element = BW_NEW(context, int32_t, mesh->facet_count);
  if (!first || !s.of_element || !s.element) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bwi_surface_patches_begin(context, mesh, radius, &patches));
  for (int64_t i = 0; i < count; i++) {
    if (node[i] < 0 || node[i] >= mesh->node_count ||
        patches.around.start[node[i]] == patches.around.start[node[i] + 1]) {
      status = bw_fail(context, BW_INVALID, "node %d is not on the boundary", node[i]);
      goto done;
    }
    first[i] = mesh->facet_element[patches.around.element[patches.around.start[node[i]]]];
    double largest = 0;
    for (int k = 0; k < 6; k++)
      largest = fmax(largest, fabs(stress[6 * i + k]));
    if (!isfinite(largest) || !(largest > 0)) {
      status = bw_fail(context, BW_INVALID,
                       "the stress of patch %lld must be finite and not zero to have a direction",
                       (long long)i);
      goto done;
    }
  }
  BW_TRY(bwi_element_regions(context, mesh, count, first, BW_WORST_DIRECTION, &regions));
  for (int64_t i = 0; i < count; i++) {
    bwi_surface_patch_visit(&patches, node[i], (int32_t)i + 1, 0, add_facet, &s);
    if (s.count == 0) { /* the radius is less than the first sample's distance */
      s.element[s.count++] = first[i];
      s.of_element[first[i]] = 1;
    }
    BW_TRY(set_region(context, &s, stress + 6 * i, &regions->region[i]));
  }
  *result = regions;
  regions = NULL;
done:
  bw_release(regions);
  bwi_surface_patches_clear(&patches);
  bw_free(first);
  bw_free(s.of_element);
  bw_free(s.element);
  return status;
}
