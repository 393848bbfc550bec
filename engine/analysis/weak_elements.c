/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Regions of one element each: for brute force (the trace of stress) and for the search (the normal
 * stress in a direction). */
#include "analysis/weak_internal.h"

#include <math.h>

bw_status bw_weak_regions_single(bw_context *context, const bw_mesh *mesh, int64_t count,
                                 const int32_t *element, double sign, bw_weak_regions **regions) {
  bw_status status = BW_OK;
  if (sign == 0 || !isfinite(sign))
    return bw_fail(context, BW_INVALID, "the sign of single-element regions is %g", sign);
  BW_TRY(bwi_element_regions(context, mesh, count, element, BW_WORST_STRESS, regions));
  for (int i = 0; i < (*regions)->count; i++) {
    bw_weak_region *r = &(*regions)->region[i];
    r->weight[0] = copysign(1, sign) / r->volume;
  }
done:
  return status;
}

void bwi_directed_weight(const double stress[6], double scale, double weight[6]) {
  double value[3], vector[9];
  bw_eigen3(stress, value, vector);
  int at = fabs(value[0]) >= fabs(value[2]) ? 0 : 2;
  const double *n = vector + 3 * at;
  double w = copysign(scale, value[at]);
  weight[0] = w * n[0] * n[0];
  weight[1] = w * n[1] * n[1];
  weight[2] = w * n[2] * n[2];
  weight[3] = w * n[1] * n[2];
  weight[4] = w * n[2] * n[0];
  weight[5] = w * n[0] * n[1];
}

bw_status bw_weak_regions_directed(bw_context *context, const bw_mesh *mesh, int64_t count,
                                   const int32_t *element, const double *stress,
                                   bw_weak_regions **result) {
  bw_status status = BW_OK;
  bw_weak_regions *regions = NULL;
  BW_TRY(bwi_element_regions(context, mesh, count, element, BW_WORST_DIRECTION, &regions));
  for (int i = 0; i < regions->count; i++) {
    bw_weak_region *r = &regions->region[i];
    const double *t = stress + 6 * (size_t)i;
    double largest = 0;
    for (int k = 0; k < 6; k++)
      largest = fmax(largest, fabs(t[k]));
    if (!isfinite(largest) || !(largest > 0))
      BW_TRY(bw_fail(context, BW_INVALID,
                     "the stress of region %d must be finite and not zero to have a direction",
                     i + 1));
    double volume =
        bwi_shape_integrals(mesh, r->element[0], NULL, NULL); /* curved edges included */
    bwi_directed_weight(t, 1 / volume, r->weight);
    r->peak = bwi_dot_tensor(r->weight, t) * volume;
  }
  *result = regions;
  regions = NULL;
done:
  bw_release(regions);
  return status;
}
