/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the engine's factor is compared with: CHOLMOD's numeric factorisation and solve from
 * scratch, in the same order, with as many BLAS threads as there are threads. */
#ifndef BENCH_CHOLMOD_BASELINE_H
#define BENCH_CHOLMOD_BASELINE_H

#include "linear/internal.h"

typedef struct cholmod_times {
  double analysis, factor, solve; /* s */
  double flops, entries;          /* of the factor, as CHOLMOD counts them */
} cholmod_times;
/* x = A^-1 x, one right-hand side in the order of `symbolic` (3 components). */
bw_status cholmod_baseline(bw_context *context, const bwi_symbolic *symbolic,
                           const bwi_matrix *matrix, double *x, cholmod_times *times);

#endif
