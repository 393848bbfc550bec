/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What weak regions and objectives share: integrals of shape functions over one element. */
#ifndef BARWRIGHT_ANALYSIS_WEAK_INTERNAL_H
#define BARWRIGHT_ANALYSIS_WEAK_INTERNAL_H

#include "barwright/analysis.h"

/* Integrals over element e of the gradients (nodes_per_element x 3) and of the values of its shape
 * functions; either may be NULL. Returns the element's volume (curved edges included). */
double bwi_shape_integrals(const bw_mesh *mesh, int32_t e, double (*gradient)[3], double *value);

/* Signed weights (not yet scaled) of a region of a Laplacian mode from the mean gradients of the
 * mode in all elements (weak_laplacian.c). */
void bwi_laplacian_weights(const bw_mesh *mesh, const bw_weak_region *region,
                           const double *gradient, double *weight);

#endif
