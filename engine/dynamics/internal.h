/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of dynamics/ share. */
#ifndef BWI_DYNAMICS_INTERNAL_H
#define BWI_DYNAMICS_INTERNAL_H

#include "barwright/dynamics.h"

/* Half of the width of the peak of vector k (rad/s) over its frequency. */
double bwi_half_width(const bw_harmonic *harmonic, int k);
/* Refuses models that no response by modes is computed of; `what` is "a harmonic response". */
bw_status bwi_check_held_model(bw_context *context, const bw_model *model, const char *what);
/* All modes up to `reach` (Hz), or `count` where that is above 0. *used gets the equations. */
bw_status bwi_modes_up_to(bw_context *context, const bw_model *model, bw_system *given,
                          const bw_eigensolver *solver, int count, double reach, bw_system **used,
                          bw_modes **modes);
/* A density or spectrum between two points (x[0], y[0]) and (x[1], y[1]) at f: straight on
 * logarithmic axes, or on linear ones where a number is 0. */
double bwi_between(const double *x, const double *y, double f);
/* For qsort of doubles. */
int bwi_compare_numbers(const void *a, const void *b);
/* Vector k (node_count x 3) of a response. */
static inline const double *bwi_harmonic_vector(const bw_harmonic *harmonic, int k) {
  int64_t size = 3 * (int64_t)harmonic->model->mesh->node_count;
  int modes = harmonic->modes->count;
  return k < modes ? harmonic->modes->shape + k * size : harmonic->residual + (k - modes) * size;
}
/* sum of weight (harmonic->count) times vector: field (node_count x 3). */
bw_status bwi_harmonic_combine(bw_context *context, const bw_harmonic *harmonic,
                               const double *weight, double *field);
/* The product of tensors a and b (6) that is the square of von Mises stress for a = b. */
double bwi_von_mises_product(const double *a, const double *b);

#endif
