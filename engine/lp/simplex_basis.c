/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The basis of the dual simplex methods: its columns, inverse, and products with all columns. */
#include "lp/simplex.h"

#include <string.h>

void bwi_add_column(const bwi_simplex *s, int32_t j, double factor, double *sum) {
  const bwi_linear_program *p = s->program;
  if (j < 0)
    return;
  double *local = sum + p->first_row[j];
  for (int32_t l = 0; l < p->row_count[j]; l++)
    local[l] += factor * p->entry[(size_t)l * (size_t)p->columns + (size_t)j];
  sum[p->rows - 1] += factor;
}

void bwi_times_columns(const bwi_simplex *s, const double *row, double *out) {
  const bwi_linear_program *p = s->program;
  size_t n = (size_t)p->columns;
  double last = row[p->rows - 1];
  for (int32_t k = 0; k < s->segments; k++) {
    const bwi_segment *g = &p->segment[k];
    const double *r = row + g->row;
    if (g->rows == BWI_LOCAL_ROWS) {
      const double *e0 = p->entry, *e1 = e0 + n, *e2 = e1 + n, *e3 = e2 + n, *e4 = e3 + n,
                   *e5 = e4 + n;
      const double r0 = r[0], r1 = r[1], r2 = r[2], r3 = r[3], r4 = r[4], r5 = r[5];
      for (int32_t j = g->begin; j < g->end; j++)
        out[j] = last + ((r0 * e0[j] + r1 * e1[j]) + (r2 * e2[j] + r3 * e3[j])) +
                 (r4 * e4[j] + r5 * e5[j]);
      continue;
    }
    for (int32_t j = g->begin; j < g->end; j++)
      out[j] = last;
    for (int32_t l = 0; l < g->rows; l++) {
      const double *e = p->entry + (size_t)l * n, f = r[l];
      for (int32_t j = g->begin; j < g->end; j++)
        out[j] += f * e[j];
    }
  }
}

bool bwi_invert(bwi_simplex *s) {
  int32_t m = s->program->rows;
  size_t square = (size_t)m * (size_t)m;
  memset(s->factor, 0, square * sizeof *s->factor);
  for (int32_t i = 0; i < m; i++) /* the transpose of the basis */
    s->method->basis_row(s, i, s->factor + (size_t)i * (size_t)m);
  if (!bwi_dense_factor(m, s->factor, s->pivot))
    return false;
  /* Row i of the inverse solves B^T z = e_i. */
  memset(s->inverse, 0, square * sizeof *s->inverse);
  for (int32_t i = 0; i < m; i++) {
    double *row = s->inverse + (size_t)i * (size_t)m;
    row[i] = 1;
    bwi_dense_solve(m, s->factor, s->pivot, row);
  }
  return true;
}

void bwi_basic_values(bwi_simplex *s) {
  int32_t m = s->program->rows;
  for (int32_t i = 0; i < m; i++) {
    double sum = 0;
    for (int32_t k = 0; k < m; k++)
      sum += s->inverse[(size_t)i * (size_t)m + (size_t)k] * s->rest[k];
    s->x[i] = sum;
  }
}

double bwi_row_square(const bwi_simplex *s, int32_t i) {
  int32_t m = s->program->rows;
  const double *row = s->inverse + (size_t)i * (size_t)m;
  double square = 0;
  for (int32_t k = 0; k < m; k++)
    square += row[k] * row[k];
  return square;
}
