/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The lowest eigenpairs of what joints or sectors leave of stiffness and mass. */
#include "joint/internal.h"

/* Of the mean of all eigenvalues, how far below 0 the shift of a free body lies. */
static const double shift_part = 1e-8;

static double trace(const bw_sparse_matrix *a) {
  double sum = 0;
  for (int32_t i = 0; i < a->rows; i++)
    for (int64_t e = a->start[i]; e < a->start[i + 1]; e++)
      sum += a->column[e] == i ? a->value[e] : 0;
  return sum;
}

bw_status bwi_joined_pairs(bw_context *context, const bw_modes_options *options, int rigid_count,
                           const bw_operator *k, const bw_operator *m, bw_eigenpairs **pairs) {
  bw_eigen_solve_options how;
  bw_eigen_solve_options_default(&how);
  how.count = options->count + rigid_count;
  how.tolerance = options->tolerance;
  how.test = options->sturm;
  how.seed = options->seed;
  how.solver = options->solver;
  if (rigid_count > 0)
    how.shift = -shift_part * trace(k->matrix) / trace(m->matrix);
  return bw_eigen_solve(context, k, m, &how, pairs);
}
