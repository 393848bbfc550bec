/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of dynamics/ share. */
#ifndef BWI_DYNAMICS_INTERNAL_H
#define BWI_DYNAMICS_INTERNAL_H

#include "barwright/dynamics.h"

/* Half of the width of the peak of vector k (rad/s) over its frequency. */
double bwi_half_width(const bw_harmonic *harmonic, int k);
/* For qsort of doubles. */
int bwi_compare_numbers(const void *a, const void *b);
/* Vector k (node_count x 3) of a response. */
const double *bwi_harmonic_vector(const bw_harmonic *harmonic, int k);
/* sum of weight (harmonic->count) times vector: field (node_count x 3). */
bw_status bwi_harmonic_combine(bw_context *context, const bw_harmonic *harmonic,
                               const double *weight, double *field);
/* The product of tensors a and b (6) that is the square of von Mises stress for a = b. */
double bwi_von_mises_product(const double *a, const double *b);

#endif
