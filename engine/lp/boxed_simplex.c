/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The dual simplex method for boxed columns.
 *
 * maximise c . t, A t = b, 0 <= t <= u. For multipliers y let d_j = c_j - y . A_j. Because every
 * column has two bounds, any basis is dual feasible once each nonbasic column sits at the bound its
 * d_j asks for (upper when positive), so there is no first phase, and any basis may be a start.
 * The method walks down the convex, piecewise linear dual function
 *     g(y) = b . y + sum_j u_j max(0, c_j - y . A_j).
 * One iteration takes the basic variable r that breaks its bound most (in the metric of the row's
 * length: dual steepest edge, exact because the inverse of the basis is at hand), and searches g
 * exactly along the direction that repairs it: the bound-flipping ratio test passes breakpoints,
 * turning columns over from one bound to the other, for as long as g keeps falling.
 *
 * Invariants between iterations: inverse * B = I; reduced[j] = c_j - y . A_j; state[j] agrees with
 * the sign of reduced[j] for nonbasic columns; rest = b - sum of columns at their upper bounds;
 * x = inverse * rest. */
#include "lp/simplex.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { AT_LOWER = 0, AT_UPPER = 1, BASIC = 2 };

static double upper(const bwi_simplex *s, int32_t j) {
  return j < 0 ? 0 : s->stretch * s->program->upper[j]; /* unit columns are fixed at zero */
}

static void start(bwi_simplex *s) {
  for (int32_t i = 0; i < s->program->rows; i++)
    s->basic[i] = -1 - i;
  s->reach = INFINITY;
}

static void basis_row(const bwi_simplex *s, int32_t i, double *row) {
  if (s->basic[i] < 0)
    row[-1 - s->basic[i]] = 1;
  else
    bwi_add_column(s, s->basic[i], 1, row);
}

/* Everything recomputed from the basic columns. */
static void restart(bwi_simplex *s) {
  int32_t m = s->program->rows;
  if (!bwi_invert(s)) {
    for (int32_t i = 0; i < m; i++)
      s->basic[i] = -1 - i;
    bwi_invert(s);
  }
  memset(s->y, 0, (size_t)m * sizeof *s->y);
  for (int32_t i = 0; i < m; i++) {
    double c = s->basic[i] < 0 ? 0 : s->cost[s->basic[i]];
    for (int32_t k = 0; k < m && c != 0; k++)
      s->y[k] += c * s->inverse[(size_t)i * (size_t)m + (size_t)k];
  }
  bwi_times_columns(s, s->y, s->reduced);
  for (int32_t j = 0; j < s->end; j++) {
    s->reduced[j] = s->cost[j] - s->reduced[j];
    s->state[j] = s->reduced[j] > 0 ? AT_UPPER : AT_LOWER;
  }
  for (int32_t i = 0; i < m; i++)
    if (s->basic[i] >= 0)
      s->state[s->basic[i]] = BASIC;
  for (int32_t i = 0; i < m; i++)
    s->rest[i] = i == m - 1;
  for (int32_t j = 0; j < s->end; j++)
    if (s->state[j] == AT_UPPER)
      bwi_add_column(s, j, -upper(s, j), s->rest);
  bwi_basic_values(s);
}

/* The row to leave the basis, or -1 at the optimum. */
static int32_t leaving_row(const bwi_simplex *s, double *length) {
  int32_t m = s->program->rows, found = -1;
  double best = 0;
  for (int32_t i = 0; i < m; i++) {
    double bound = upper(s, s->basic[i]);
    double broken = fmax(-s->x[i], s->x[i] - bound);
    if (!(broken > bwi_feasible(bound)))
      continue;
    double square = bwi_row_square(s, i);
    if (broken * broken > best * square) {
      best = broken * broken / square;
      *length = sqrt(square);
      found = i;
    }
  }
  return found;
}

/* The breakpoints along the row with steps up to `reach`; columns turn over when
 * sign * alpha_j has the sign of d_j. */
static int32_t breakpoints(bwi_simplex *s, double sign, double smallest, double reach) {
  int32_t count = 0;
  for (int32_t j = 0; j < s->end; j++) {
    double d = fabs(s->reduced[j]);
    double v = s->state[j] == AT_UPPER ? sign * s->alpha[j] : -sign * s->alpha[j];
    if (v > smallest && d <= reach * v && s->state[j] != BASIC)
      s->point[count++] = (bwi_breakpoint){d / v, v * upper(s, j), j};
  }
  return count;
}

#ifndef NDEBUG
/* A column is basic where a row has it, and no two rows have the same. */
static bool is_basis(const bwi_simplex *s) {
  int32_t rows = 0, columns = 0;
  for (int32_t i = 0; i < s->program->rows; i++)
    if (s->basic[i] >= 0) {
      rows++;
      if (s->basic[i] >= s->end || s->state[s->basic[i]] != BASIC)
        return false;
    }
  for (int32_t j = 0; j < s->end; j++)
    columns += s->state[j] == BASIC;
  return rows == columns;
}
#endif

static bwi_simplex_result iterate(bwi_simplex *s) {
  int32_t m = s->program->rows;
  assert(is_basis(s));
  double length = 1;
  int32_t r = leaving_row(s, &length);
  if (r < 0)
    return BWI_SIMPLEX_OPTIMAL;
  int32_t out = s->basic[r];
  double bound = upper(s, out);
  bool above = s->x[r] > bound;
  double broken = above ? s->x[r] - bound : -s->x[r], sign = above ? -1 : 1;
  double *row = s->inverse + (size_t)r * (size_t)m;
  bwi_times_columns(s, row, s->alpha);

  double smallest = 1e-11 * length;
  int32_t count, passed = -1;
  for (double reach = s->reach;; reach = reach < 1e-3 ? 1e-2 : INFINITY) {
    count = breakpoints(s, sign, smallest, reach);
    passed = bwi_select_breakpoints(s->point, count, broken);
    if (passed > 0 || isinf(reach))
      break;
  }
  if (passed <= 0)
    return BWI_SIMPLEX_INFEASIBLE;
  /* The last breakpoint enters, unless its pivot is too small: then an earlier one does, with less
   * to gain. Where all are too small, as on meshes that are symmetric but for rounding, the largest
   * does: the check of the solution decides whether that is good. */
  int32_t enters = passed - 1;
  if (fabs(s->alpha[s->point[enters].column]) < bwi_smallest_pivot * length) {
    double largest = 0;
    for (int32_t i = 0; i < passed; i++)
      largest = fmax(largest, fabs(s->alpha[s->point[i].column]));
    double least = fmin(largest, bwi_smallest_pivot * length);
    enters = -1;
    for (int32_t i = 0; i < passed; i++)
      if (fabs(s->alpha[s->point[i].column]) >= least &&
          (enters < 0 || bwi_sooner(&s->point[enters], &s->point[i])))
        enters = i;
  }
  const bwi_breakpoint stop = s->point[enters];
  int32_t q = stop.column;

  memset(s->column, 0, (size_t)m * sizeof *s->column);
  bwi_add_column(s, q, 1, s->column);
  double pivot = 0;
  for (int32_t k = 0; k < m; k++)
    pivot += row[k] * s->column[k];
  if (fabs(pivot - s->alpha[q]) > 1e-8 * (length + fabs(pivot)))
    return BWI_SIMPLEX_UNSTABLE;

  /* Turn over what was passed, move the multipliers, exchange r for q. */
  for (int32_t i = 0; i < passed; i++) {
    int32_t j = s->point[i].column;
    if (j == q || !bwi_sooner(&s->point[i], &stop))
      continue;
    bwi_add_column(s, j, s->state[j] == AT_UPPER ? upper(s, j) : -upper(s, j), s->rest);
    s->state[j] = s->state[j] == AT_UPPER ? AT_LOWER : AT_UPPER;
  }
  s->stalled = stop.step > bwi_no_progress ? 0 : s->stalled + 1;
  double move = stop.step * sign;
  for (int32_t j = 0; j < s->end; j++)
    s->reduced[j] -= move * s->alpha[j];
  if (out >= 0) {
    s->reduced[out] = -move;
    s->state[out] = above ? AT_UPPER : AT_LOWER;
    if (above)
      bwi_add_column(s, out, -bound, s->rest);
  }
  if (s->state[q] == AT_UPPER)
    bwi_add_column(s, q, upper(s, q), s->rest);
  s->state[q] = BASIC;
  s->reduced[q] = 0;
  s->basic[r] = q;
  s->reach = 4 * stop.step;

  for (int32_t k = 0; k < m; k++)
    row[k] /= pivot;
  for (int32_t i = 0; i < m; i++) {
    if (i == r)
      continue;
    double *other = s->inverse + (size_t)i * (size_t)m, entry = 0;
    for (int32_t k = 0; k < m; k++)
      entry += other[k] * s->column[k];
    for (int32_t k = 0; k < m && entry != 0; k++)
      other[k] -= entry * row[k];
  }
  bwi_basic_values(s);
  return BWI_SIMPLEX_PIVOTED;
}

static void hand_over(bwi_simplex *s, bwi_vertex *vertex) {
  memcpy(vertex->basic, s->basic, (size_t)s->program->rows * sizeof *s->basic);
  for (int32_t j = 0; j < s->program->columns; j++)
    vertex->at_upper[j] = s->state[j] == AT_UPPER;
}

const bwi_method bwi_boxed = {0, start, basis_row, restart, iterate, hand_over};
