/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What weak regions and objectives share: integrals of shape functions over one element. */
#ifndef BARWRIGHT_ANALYSIS_WEAK_INTERNAL_H
#define BARWRIGHT_ANALYSIS_WEAK_INTERNAL_H

#include "barwright/analysis.h"

/* Weights per element of a region. */
static inline size_t bwi_weight_width(bw_worst_target target) {
  return target == BW_WORST_STRESS ? 1 : target == BW_WORST_DISPLACEMENT ? 3 : 6;
}

/* T = scale s n n^T, n the direction and s the sign of the principal stress of largest magnitude:
 * T : stress = scale max |sigma_i|. */
void bwi_directed_weight(const double stress[6], double scale, double weight[6]);

/* T : sigma of symmetric tensors xx yy zz yz zx xy. */
static inline double bwi_dot_tensor(const double t[6], const double s[6]) {
  return t[0] * s[0] + t[1] * s[1] + t[2] * s[2] + 2 * (t[3] * s[3] + t[4] * s[4] + t[5] * s[5]);
}

/* `count` regions of one element each, weights zero. Elements are checked. */
bw_status bwi_element_regions(bw_context *context, const bw_mesh *mesh, int64_t count,
                              const int32_t *element, bw_worst_target target,
                              bw_weak_regions **regions);

/* Integrals over element e of the gradients (nodes_per_element x 3) and of the values of its shape
 * functions; either may be NULL. Returns the element's volume (curved edges included). */
double bwi_shape_integrals(const bw_mesh *mesh, int32_t e, double (*gradient)[3], double *value);

/* s = C : T, so that T : sigma = s : grad u. */
static inline void bwi_conjugate_stress(const double c[36], const double t[6], double s[6]) {
  for (int k = 0; k < 6; k++) {
    const double *row = c + 6 * k;
    s[k] = row[0] * t[0] + row[1] * t[1] + row[2] * t[2] +
           2 * (row[3] * t[3] + row[4] * t[4] + row[5] * t[5]);
  }
}

/* Signed weights (not yet scaled) of a region of a Laplacian mode from the mean gradients of the
 * mode in all elements (weak_laplacian.c). */
void bwi_laplacian_weights(const bw_mesh *mesh, const bw_weak_region *region,
                           const double *gradient, double *weight);

#endif
