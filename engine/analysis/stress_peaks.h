/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The largest stresses of many displacement fields at once. */
#ifndef BARWRIGHT_STRESS_PEAKS_H
#define BARWRIGHT_STRESS_PEAKS_H

#include "analysis/strain.h"

enum { BWI_PEAK_FIELDS = 16 };

/* The largest principal stress, tension or compression, of the element means that bw_element_stress
 * gives under 16 fields, displacement (m, node_count x 3 x 16); fields that are not wanted are 0.
 * Raises stress (Pa, element_count) and utilisation (-, element_count; or NULL) to what is larger
 * in any field, and gives the largest of each field, largest (Pa, 16), with its element, where
 * (index, 16): the first of equal ones. */
bw_status bwi_stress_peaks(bw_context *context, const bw_mesh *mesh, const bw_material *material,
                           const double *displacement, double *stress, double *utilisation,
                           double largest[BWI_PEAK_FIELDS], int32_t where[BWI_PEAK_FIELDS]);

/* The mean stress of one element, which bwi_stress_peaks takes, by the displacement of its nodes:
 * stress i is the sum of weight[i][a][k] (Pa/m) times the component k of node a. */
void bwi_mean_stress_weights(const bw_mesh *mesh, const bw_material *material, int64_t element,
                             double weight[6][10][3]);

#endif
