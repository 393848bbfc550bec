/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What iterations share. */
#include <math.h>

#include "eigen/iteration.h"

/* A pair that has not converged may be one with that before it, where it is as near to it. */
static const double maybe_equal = 1e-3;

bool bwi_eigen_may_be_equal(const bwi_eigen_iteration *it, int n) {
  return n < it->known && it->value[n] < INFINITY &&
         it->value[n] - it->value[n - 1] <= maybe_equal * fabs(it->value[n]);
}

bw_status bwi_eigen_random(bwi_eigen_iteration *it, int count, double *x) {
  for (int64_t i = 0; i < count * it->size; i++)
    x[i] = 2 * bw_random_uniform(&it->random) - 1;
  return it->problem->project(it->context, it->problem->data, count, x);
}

bw_status bwi_eigen_stopped(const bwi_eigen_iteration *it, int found, int wanted,
                            double tolerance) {
  return bw_fail(it->context, BW_CONVERGENCE,
                 "%d of %d modes converged to a relative residual of %g, with %d right-hand sides "
                 "solved for: ask for a larger tolerance or fewer modes, or take %s",
                 found, wanted, tolerance, it->solves,
                 it->problem->solve ? "another eigensolver"
                                    : "another preconditioner, or equations that have a factor "
                                      "(the solver cholesky)");
}
