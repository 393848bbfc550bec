/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the files of dynamics/ share. */
#ifndef BWI_DYNAMICS_INTERNAL_H
#define BWI_DYNAMICS_INTERNAL_H

#include "barwright/dynamics.h"

/* Half of the width of the peak of vector k (rad/s) over its frequency. */
double bwi_half_width(const bw_harmonic *harmonic, int k);
/* Refuses models that no response by modes is computed of; `what` is "a harmonic response". */
bw_status bwi_check_held_model(bw_context *context, const bw_model *model, const char *what);
/* *bound (Hz): no mode of the model has a higher frequency; INFINITY where springs add stiffness.
 */
bw_status bwi_frequency_bound(bw_context *context, const bw_model *model, double *bound);
/* All modes up to `reach` (Hz), or `count` where that is above 0. *used gets the equations.
 * BW_INVALID for a reach beyond all modes that the mesh can have, where these are many, and for one
 * that needs more than 2000. */
bw_status bwi_modes_up_to(bw_context *context, const bw_model *model, bw_system *given,
                          const bw_eigensolver *solver, int count, double reach, bw_system **used,
                          bw_modes **modes);
/* A density or spectrum between two points (x[0], y[0]) and (x[1], y[1]) at f: straight on
 * logarithmic axes, or on linear ones where a number is 0. */
double bwi_between(const double *x, const double *y, double f);
/* Points of a power spectral density. */
typedef struct bwi_density {
  int count;
  const double *frequency, *density;
} bwi_density;
/* Integrals over the density, of the coordinates times the roots of their eigenvalues. */
typedef enum bwi_covariance {
  BWI_POSITION, /* of the coordinates */
  BWI_MOMENT_1, /* the same with powers of the frequency */
  BWI_MOMENT_2,
  BWI_MOMENT_4,
  BWI_CROSS, /* of the coordinates' rates (rows) with the coordinates: antisymmetric */
  BWI_COVARIANCES
} bwi_covariance;
typedef struct bwi_covariances {
  double *part[BWI_COVARIANCES]; /* (count x count) of zeros, which get the lower triangle; only
                                    the first one where the others are NULL */
  double *wrong; /* mean square of the error, on the scale of the first one's trace */
} bwi_covariances;
/* Those of bw_harmonic_random. */
bw_status bwi_integrate_covariances(bw_context *context, const bw_harmonic *harmonic,
                                    const bwi_density *density, const bwi_covariances *covariances);
/* BW_INVALID for numbers of a life curve outside their ranges. */
bw_status bwi_check_curve(bw_context *context, const bw_life_curve *curve);
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
