/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Judging a vertex that a solver of linear programs ended at. See linear_program.h for the form. */
#include "lp/linear_program.h"

#include <math.h>
#include <string.h>

void bwi_linear_program_clear(bwi_linear_program *program) {
  bw_free(program->entry);
  bw_free(program->upper);
  bw_free(program->first_row);
  bw_free(program->row_count);
  bw_free(program->group_start);
  bw_free(program->group);
  bw_free(program->segment);
  memset(program, 0, sizeof *program);
}

static void add_column(const bwi_linear_program *program, int32_t j, double factor, double *sum) {
  for (int32_t l = 0; l < program->row_count[j]; l++)
    sum[program->first_row[j] + l] +=
        factor * program->entry[(size_t)l * (size_t)program->columns + (size_t)j];
  sum[program->rows - 1] += factor;
}

/* The column at the upper bound in the group of basic column j, or -1. */
static int32_t full_column(const bwi_linear_program *program, const bwi_vertex *vertex, int32_t j) {
  int32_t g = program->group[j];
  for (int32_t k = program->group_start[g]; k < program->group_start[g + 1]; k++)
    if (k != j && vertex->at_upper[k])
      return k;
  return -1;
}

/* b - A t. */
static void residual(const bwi_linear_program *program, const double *fraction, double *rest) {
  int32_t m = program->rows;
  for (int32_t i = 0; i < m; i++)
    rest[i] = i == m - 1;
  for (int32_t j = 0; j < program->columns; j++)
    if (fraction[j] != 0)
      add_column(program, j, -fraction[j], rest);
}

bw_status bwi_linear_program_evaluate(bw_context *context, const bwi_linear_program *program,
                                      const double *cost, const bwi_vertex *vertex,
                                      bwi_solution *solution) {
  bw_status status = BW_OK;
  int32_t m = program->rows, n = program->columns;
  double *fraction = solution->fraction, *y = solution->multiplier;
  double *basis = BW_NEW0(context, double, (size_t)m *(size_t)m);
  double *rest = BW_NEW(context, double, m), *x = BW_NEW(context, double, m);
  int32_t *pivot = BW_NEW(context, int32_t, m), *full = BW_NEW(context, int32_t, m);
  BW_TRY_MEMORY(basis && rest && x && pivot && full);
  solution->value = 0;
  solution->violation = solution->gap = INFINITY;
  for (int32_t j = 0; j < n; j++)
    fraction[j] = vertex->at_upper[j] ? program->upper[j] : 0;
  for (int32_t i = 0; i < m; i++) {
    /* The transpose of the basis is filled: column i as row i. */
    double *column = basis + (size_t)i * (size_t)m;
    if (vertex->basic[i] < 0) {
      column[-1 - vertex->basic[i]] = 1;
    } else {
      add_column(program, vertex->basic[i], 1, column);
      fraction[vertex->basic[i]] = 0;
    }
    y[i] = vertex->basic[i] < 0 ? 0 : cost[vertex->basic[i]];
    full[i] = vertex->basic[i] < 0 ? -1 : full_column(program, vertex, vertex->basic[i]);
    if (full[i] >= 0) {
      add_column(program, full[i], -1, column);
      y[i] -= cost[full[i]];
    }
  }
  if (!bwi_dense_factor(m, basis, pivot))
    goto done;
  bwi_dense_solve(m, basis, pivot, y); /* B^T y = c_B */

  /* Basic values, with one step of refinement: x on top of what the fractions already hold. */
  double artificial = 0;
  for (int pass = 0; pass < 2; pass++) {
    residual(program, fraction, rest);
    if (pass == 1)
      for (int32_t i = 0; i < m; i++)
        if (vertex->basic[i] < 0)
          rest[-1 - vertex->basic[i]] -= x[i];
    double *step = rest;
    bwi_dense_solve_transposed(m, basis, pivot, step); /* B step = rest */
    for (int32_t i = 0; i < m; i++) {
      x[i] = pass == 0 ? step[i] : x[i] + step[i];
      if (vertex->basic[i] >= 0)
        fraction[vertex->basic[i]] = x[i];
      if (full[i] >= 0)
        fraction[full[i]] -= step[i];
    }
  }
  double violation = 0;
  for (int32_t i = 0; i < m; i++) {
    int32_t j = vertex->basic[i];
    if (j < 0) {
      artificial = fmax(artificial, fabs(x[i]));
      continue;
    }
    violation = fmax(violation, fmax(-fraction[j], fraction[j] - program->upper[j]));
    fraction[j] = fmin(fmax(fraction[j], 0), program->upper[j]);
    if (full[i] >= 0) {
      violation = fmax(violation, -fraction[full[i]]);
      fraction[full[i]] = fmax(fraction[full[i]], 0);
    }
  }
  residual(program, fraction, rest);
  for (int32_t i = 0; i < m; i++)
    violation = fmax(violation, fabs(rest[i]));
  solution->violation = fmax(violation, artificial);

  /* Weak duality: the multipliers bound every feasible value from above. */
  double bound = y[m - 1], value = 0, largest = 0;
  for (int32_t g = 0; g < program->groups; g++) {
    double max = 0;
    for (int32_t j = program->group_start[g]; j < program->group_start[g + 1]; j++) {
      double reduced = cost[j] - y[m - 1];
      for (int32_t l = 0; l < program->row_count[j]; l++)
        reduced -= y[program->first_row[j] + l] * program->entry[(size_t)l * (size_t)n + (size_t)j];
      max = fmax(max, reduced);
      value += cost[j] * fraction[j];
      largest = fmax(largest, fabs(cost[j]));
    }
    if (max > 0)
      bound += program->upper[program->group_start[g]] * max;
  }
  solution->value = value;
  solution->gap = largest > 0 ? fabs(bound - value) / (fabs(value) + 1e-3 * largest) : 0;
done:
  bw_free(basis);
  bw_free(rest);
  bw_free(x);
  bw_free(pivot);
  bw_free(full);
  return status;
}
