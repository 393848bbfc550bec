/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What the two dual simplex methods share: a basis and its inverse, products with all columns, the
 * loop over iterations, nested samples of the columns. boxed_simplex.c has the iteration for
 * columns with a bound each, grouped_simplex.c the one for columns in groups with a common
 * bound. */
#ifndef BARWRIGHT_LP_SIMPLEX_H
#define BARWRIGHT_LP_SIMPLEX_H

#include <math.h>

#include "lp/solver.h"

typedef enum bwi_simplex_result {
  BWI_SIMPLEX_PIVOTED,
  BWI_SIMPLEX_OPTIMAL,
  BWI_SIMPLEX_INFEASIBLE,
  BWI_SIMPLEX_UNSTABLE,
  BWI_SIMPLEX_CANCELLED
} bwi_simplex_result;

typedef struct bwi_simplex bwi_simplex;

/* Where the dual function bends along a line: its slope grows by `slope` after `step`. */
typedef struct bwi_breakpoint {
  double step, slope;
  int32_t column; /* or any number that orders breakpoints */
} bwi_breakpoint;
bool bwi_sooner(const bwi_breakpoint *a, const bwi_breakpoint *b);
/* Bring to the front the first breakpoints whose slopes reach `wanted`, the last of them at the end
 * of these; returns their number, or -1 when all together do not. */
int32_t bwi_select_breakpoints(bwi_breakpoint *list, int32_t count, double wanted);

/* A change of a group's key, see grouped_simplex.c. */
typedef struct bwi_key_change {
  int32_t group, column; /* the key after it */
  bool tied;             /* ends the search: the group has a basic column */
} bwi_key_change;

/* One of the two methods. */
typedef struct bwi_method {
  double scatter;                /* added to the costs in the first attempt, see dual_simplex.c */
  void (*start)(bwi_simplex *s); /* a basis of unit columns */
  void (*basis_row)(const bwi_simplex *s, int32_t i, double *row); /* row += basic column i */
  void (*restart)(bwi_simplex *s);                                 /* recomputed from the basis */
  bwi_simplex_result (*iterate)(bwi_simplex *s);
  void (*hand_over)(bwi_simplex *s, bwi_vertex *vertex);
} bwi_method;
extern const bwi_method bwi_boxed, bwi_grouped;

struct bwi_simplex {
  const bwi_linear_program *program;
  const bwi_method *method;
  int max_iterations;
  double *cost, *reduced, *alpha; /* columns: c, d, and the row that is searched along */
  bwi_breakpoint *point;          /* columns and groups */
  double *factor, *inverse;       /* rows x rows */
  double *x, *rest, *y, *column;  /* rows */
  int32_t *pivot;                 /* rows */
  int32_t groups, end, segments;  /* of the level at work; end: columns */
  double stretch;                 /* of the bounds: a sample carries the whole force */
  int iterations;
  double apart; /* what perturbs the costs */
  int stalled;  /* iterations without progress, one after the other */
  /* Columns with a bound each. */
  uint8_t *state; /* columns */
  int32_t *basic; /* rows */
  double reach;   /* how far breakpoints are looked for at first */
  /* Columns in groups. */
  int32_t *key, *ties;        /* groups: the key, and how many columns of the basis */
  int32_t *last;              /* groups: scratch, the last breakpoint passed */
  bwi_key_change *key_change; /* columns and groups */
  int32_t *group, *member;    /* rows: the basic column's group (-1: unit column), column */
  int32_t *unit;              /* rows: number of the unit column */
};

static const double bwi_no_progress = 1e-14;   /* a step of the multipliers, for costs up to 1 */
static const double bwi_smallest_pivot = 1e-7; /* over the length of the row of the inverse */

/* What a fraction of the total force may pass its bound by. A large bound, of a high pressure on a
 * large area, allows no more: the check of the solution is on fractions. */
static inline double bwi_feasible(double bound) {
  return 1e-12 + 1e-9 * fmin(bound, 0.1);
}

/* sum += factor * A_j; nothing for a negative j. */
void bwi_add_column(const bwi_simplex *s, int32_t j, double factor, double *sum);
/* out_j = row . A_j for all columns at work. */
void bwi_times_columns(const bwi_simplex *s, const double *row, double *out);
/* The inverse of the basis; false when its columns are dependent. */
bool bwi_invert(bwi_simplex *s);
/* x = inverse * rest */
void bwi_basic_values(bwi_simplex *s);
/* The square of the length of row i of the inverse. */
double bwi_row_square(const bwi_simplex *s, int32_t i);

#endif
