/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Linear programs of fractions in scaled form, and what their solvers share.
 *
 *     maximise c . t   subject to   A t = b,  0 <= t <= u,  b = (0, ..., 0, 1)
 *
 * The last row of A is all ones: the fractions t add up to one. A column has entries in a few
 * consecutive rows besides. Columns may be grouped; then u bounds the sum of each group. They are
 * ordered by levels, nested samples of the columns from coarse to fine, and inside a level by
 * segments, which have the same rows. */
#ifndef BARWRIGHT_LP_LINEAR_PROGRAM_H
#define BARWRIGHT_LP_LINEAR_PROGRAM_H

#include "barwright/lp.h"

enum { BWI_LOCAL_ROWS = 6, BWI_MAX_LEVELS = 8 };

/* Columns begin..end-1 have their local rows 0..rows-1 at global rows row.. */
typedef struct bwi_segment {
  int32_t begin, end, row, rows;
} bwi_segment;

typedef struct bwi_linear_program {
  int32_t rows, columns;
  bool grouped;         /* a group may have more than one column */
  int32_t groups;       /* each column is in one */
  int32_t *group_start; /* groups + 1: columns of each */
  int32_t *group;       /* columns */
  double *entry;        /* BWI_LOCAL_ROWS x columns: local row l of column j at [l * columns + j] */
  double *upper;        /* columns; the same for all of a group */
  int32_t *first_row, *row_count; /* columns: where the local rows stand */
  int32_t segment_count;
  bwi_segment *segment;
  int levels;
  int32_t level_end[BWI_MAX_LEVELS];      /* columns of levels 0..k: whole groups */
  int32_t level_segments[BWI_MAX_LEVELS]; /* their segments */
} bwi_linear_program;

/* Releases what it holds. */
void bwi_linear_program_clear(bwi_linear_program *program);

/* Where a solver ended: `rows` basic columns (-1 - r: the unit column of row r, for a row without a
 * basic column of its own) and for the others whether they sit at their upper bound. In a group one
 * column at most is at the upper bound: it carries what the group's basic columns leave of it. */
typedef struct bwi_vertex {
  int32_t *basic;
  uint8_t *at_upper;
  int iterations;
} bwi_vertex;

/* The exact solution at a vertex: basic values and multipliers by a dense factor of the basis.
 * `fraction` has `columns` entries, `multiplier` has `rows`. Says how far the vertex is from being
 * optimal: violation of bounds and rows (fractions), and the duality gap over |c| . t. */
typedef struct bwi_solution {
  double *fraction, *multiplier;
  double value, violation, gap;
} bwi_solution;
bw_status bwi_linear_program_evaluate(bw_context *context, const bwi_linear_program *program,
                                      const double *cost, const bwi_vertex *vertex,
                                      bwi_solution *solution);

/* A bound of  max gain . t,  sum t = 1,  0 <= t <= upper:  x + sum upper max(0, gain - x), for any
 * multiplier x. That of so many halvings exceeds the maximum by at most the range of the gains
 * times 2^-halvings. */
double bwi_knapsack_value(int32_t count, const double *gain, const double *upper, double x);
double bwi_knapsack_multiplier(int32_t count, const double *gain, const double *upper,
                               int halvings);
double bwi_knapsack(int32_t count, const double *gain, const double *upper, int halvings);

/* Solve a dense system in place by elimination with column pivoting; false when singular. */
bool bwi_dense_factor(int32_t n, double *a, int32_t *pivot);
void bwi_dense_solve(int32_t n, const double *a, const int32_t *pivot, double *x);
void bwi_dense_solve_transposed(int32_t n, const double *a, const int32_t *pivot, double *x);

#endif
