/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the residual of a linear solve says of the error of the stress. */
#ifndef BARWRIGHT_SOLVE_ERROR_H
#define BARWRIGHT_SOLVE_ERROR_H

#include "barwright/linear.h"

typedef struct bwi_solve_error {
  const bw_system *system;
  double *compliance; /* node_count: 1 / (lambda theta m_i), 0 where no mode is */
} bwi_solve_error;
/* Computes the lowest elastic mode, confirmed by a Sturm count. */
bw_status bwi_solve_error_open(bw_context *context, bw_system *system, bwi_solve_error *error);
void bwi_solve_error_close(bwi_solve_error *error);
/* Of the error d of `displacement` under `force`: sqrt(d . K d) is at most this. `work`: room for
 * 6 node_count numbers. May run from any thread. */
double bwi_solve_error_energy(const bwi_solve_error *error, const double *force,
                              const double *displacement, double *work);
/* The Frobenius norm of an element's mean stress is at most this times the square root of
 * d . K d. */
double bwi_stress_per_energy(const bw_system *system, int64_t element);

#endif
