/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A dual simplex method for the worst-load programme: few rows (seven for one free body), many
 * boxed columns.
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
 * Work per iteration is one product with all columns. A nested sample of the columns is solved
 * first (levels of the programme, coarse to fine) and its basis starts the next one, so that the
 * full set sees only a few iterations.
 *
 * Invariants between iterations: inverse * B = I; reduced[j] = c_j - y . A_j; state[j] agrees with
 * the sign of reduced[j] for nonbasic columns; rest = b - sum of columns at their upper bounds;
 * x = inverse * rest. */
#include "analysis/programme.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { AT_LOWER = 0, AT_UPPER = 1, BASIC = 2 };
enum { REFACTOR_EVERY = 50 };

static const double feasible_share = 1e-12; /* of the total force */
static const double feasible_bound = 1e-9;  /* of a column's bound */
static const double smallest_pivot = 1e-7;  /* over the length of the row of the inverse */

struct bwi_simplex {
  const bwi_programme *programme;
  double *reduced, *alpha, *cost; /* columns */
  uint8_t *state;                 /* columns */
  bwi_breakpoint *point;          /* columns */
  double *inverse, *factor;       /* rows x rows */
  double *x, *rest, *y, *column;  /* rows */
  int32_t *basic, *pivot;         /* rows */
  int32_t end, segments;          /* of the level at work */
  double stretch;                 /* of the bounds: a sample carries the whole force */
  double reach;                   /* how far breakpoints are looked for at first */
  int iterations;
};

void bwi_simplex_free(bwi_simplex *s) {
  if (!s)
    return;
  bw_free(s->reduced);
  bw_free(s->alpha);
  bw_free(s->cost);
  bw_free(s->state);
  bw_free(s->point);
  bw_free(s->inverse);
  bw_free(s->factor);
  bw_free(s->x);
  bw_free(s->rest);
  bw_free(s->y);
  bw_free(s->column);
  bw_free(s->basic);
  bw_free(s->pivot);
  bw_free(s);
}

bw_status bwi_simplex_create(bw_context *context, const bwi_programme *programme,
                             bwi_simplex **simplex) {
  size_t n = (size_t)programme->columns, m = (size_t)programme->rows;
  bwi_simplex *s = BW_NEW0(context, bwi_simplex, 1);
  if (!s)
    return BW_MEMORY;
  s->programme = programme;
  s->reduced = BW_NEW(context, double, n);
  s->alpha = BW_NEW(context, double, n);
  s->cost = BW_NEW(context, double, n);
  s->state = BW_NEW(context, uint8_t, n);
  s->point = BW_NEW(context, bwi_breakpoint, n);
  s->inverse = BW_NEW(context, double, m *m);
  s->factor = BW_NEW(context, double, m *m);
  s->x = BW_NEW(context, double, m);
  s->rest = BW_NEW(context, double, m);
  s->y = BW_NEW(context, double, m);
  s->column = BW_NEW(context, double, m);
  s->basic = BW_NEW(context, int32_t, m);
  s->pivot = BW_NEW(context, int32_t, m);
  if (!s->reduced || !s->alpha || !s->cost || !s->state || !s->point || !s->inverse || !s->factor ||
      !s->x || !s->rest || !s->y || !s->column || !s->basic || !s->pivot) {
    bwi_simplex_free(s);
    return BW_MEMORY;
  }
  *simplex = s;
  return BW_OK;
}

static double upper(const bwi_simplex *s, int32_t j) {
  return j < 0 ? 0 : s->stretch * s->programme->upper[j]; /* unit columns are held at zero */
}

/* sum += factor * A_j */
static void add(const bwi_simplex *s, int32_t j, double factor, double *sum) {
  const bwi_programme *p = s->programme;
  double *local = sum + p->first_row[j];
  for (int32_t l = 0; l < p->row_count[j]; l++)
    local[l] += factor * p->entry[(size_t)l * (size_t)p->columns + (size_t)j];
  sum[p->rows - 1] += factor;
}

/* out_j = row . A_j for all columns at work. */
static void times_columns(const bwi_simplex *s, const double *row, double *out) {
  const bwi_programme *p = s->programme;
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

/* inverse from the basic columns; false when they are dependent. */
static bool invert(bwi_simplex *s) {
  int32_t m = s->programme->rows;
  size_t square = (size_t)m * (size_t)m;
  memset(s->factor, 0, square * sizeof *s->factor);
  for (int32_t i = 0; i < m; i++) {
    double *row = s->factor + (size_t)i * (size_t)m; /* the transpose of the basis */
    if (s->basic[i] < 0)
      row[-1 - s->basic[i]] = 1;
    else
      add(s, s->basic[i], 1, row);
  }
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

static void basic_values(bwi_simplex *s) {
  int32_t m = s->programme->rows;
  for (int32_t i = 0; i < m; i++) {
    double sum = 0;
    for (int32_t k = 0; k < m; k++)
      sum += s->inverse[(size_t)i * (size_t)m + (size_t)k] * s->rest[k];
    s->x[i] = sum;
  }
}

/* Everything afresh from the basic columns. */
static bool restart(bwi_simplex *s) {
  int32_t m = s->programme->rows;
  if (!invert(s)) {
    for (int32_t i = 0; i < m; i++)
      s->basic[i] = -1 - i;
    invert(s);
  }
  memset(s->y, 0, (size_t)m * sizeof *s->y);
  for (int32_t i = 0; i < m; i++) {
    double c = s->basic[i] < 0 ? 0 : s->cost[s->basic[i]];
    for (int32_t k = 0; k < m && c != 0; k++)
      s->y[k] += c * s->inverse[(size_t)i * (size_t)m + (size_t)k];
  }
  times_columns(s, s->y, s->reduced);
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
      add(s, j, -upper(s, j), s->rest);
  basic_values(s);
  return true;
}

/* The row to leave the basis, or -1 at the optimum. */
static int32_t leaving_row(const bwi_simplex *s, double *length) {
  int32_t m = s->programme->rows, found = -1;
  double best = 0;
  for (int32_t i = 0; i < m; i++) {
    double bound = upper(s, s->basic[i]);
    double broken = fmax(-s->x[i], s->x[i] - bound);
    if (!(broken > feasible_share + feasible_bound * bound))
      continue;
    double square = 0;
    const double *row = s->inverse + (size_t)i * (size_t)m;
    for (int32_t k = 0; k < m; k++)
      square += row[k] * row[k];
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

typedef enum step_result { STEP_DONE, STEP_OPTIMAL, STEP_INFEASIBLE, STEP_UNSTABLE } step_result;

static step_result iterate(bwi_simplex *s) {
  int32_t m = s->programme->rows;
  double length = 1;
  int32_t r = leaving_row(s, &length);
  if (r < 0)
    return STEP_OPTIMAL;
  int32_t out = s->basic[r];
  double bound = upper(s, out);
  bool above = s->x[r] > bound;
  double broken = above ? s->x[r] - bound : -s->x[r], sign = above ? -1 : 1;
  double *row = s->inverse + (size_t)r * (size_t)m;
  times_columns(s, row, s->alpha);

  double smallest = 1e-11 * length;
  int32_t count, passed = -1;
  for (double reach = s->reach;; reach = reach < 1e-3 ? 1e-2 : INFINITY) {
    count = breakpoints(s, sign, smallest, reach);
    passed = bwi_select_breakpoints(s->point, count, broken);
    if (passed > 0 || isinf(reach))
      break;
  }
  if (passed <= 0)
    return STEP_INFEASIBLE;
  /* The last breakpoint enters, unless its pivot is too small: then an earlier one does, with less
   * to gain. */
  int32_t enters = passed - 1;
  if (fabs(s->alpha[s->point[enters].column]) < smallest_pivot * length) {
    enters = -1;
    for (int32_t i = 0; i < passed; i++)
      if (fabs(s->alpha[s->point[i].column]) >= smallest_pivot * length &&
          (enters < 0 || bwi_sooner(&s->point[enters], &s->point[i])))
        enters = i;
    if (enters < 0)
      return STEP_UNSTABLE;
  }
  const bwi_breakpoint stop = s->point[enters];
  int32_t q = stop.column;

  memset(s->column, 0, (size_t)m * sizeof *s->column);
  add(s, q, 1, s->column);
  double pivot = 0;
  for (int32_t k = 0; k < m; k++)
    pivot += row[k] * s->column[k];
  if (fabs(pivot - s->alpha[q]) > 1e-8 * (length + fabs(pivot)))
    return STEP_UNSTABLE;

  /* Turn over what was passed, move the multipliers, exchange r for q. */
  for (int32_t i = 0; i < passed; i++) {
    int32_t j = s->point[i].column;
    if (j == q || !bwi_sooner(&s->point[i], &stop))
      continue;
    add(s, j, s->state[j] == AT_UPPER ? upper(s, j) : -upper(s, j), s->rest);
    s->state[j] = s->state[j] == AT_UPPER ? AT_LOWER : AT_UPPER;
  }
  double move = stop.step * sign;
  for (int32_t j = 0; j < s->end; j++)
    s->reduced[j] -= move * s->alpha[j];
  if (out >= 0) {
    s->reduced[out] = -move;
    s->state[out] = above ? AT_UPPER : AT_LOWER;
    if (above)
      add(s, out, -bound, s->rest);
  }
  if (s->state[q] == AT_UPPER)
    add(s, q, upper(s, q), s->rest);
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
  basic_values(s);
  return STEP_DONE;
}

/* To the optimum of one level. The last word is had by a basis factored afresh. */
static step_result optimise(bwi_simplex *s) {
  int32_t m = s->programme->rows;
  int limit = 200 + 60 * m, since = 0, unstable = 0;
  restart(s);
  bool fresh = true;
  for (int i = 0; i < limit; i++) {
    step_result result = iterate(s);
    if (result == STEP_DONE) {
      s->iterations++;
      fresh = false;
      if (++since == REFACTOR_EVERY) {
        restart(s);
        since = 0;
        fresh = true;
      }
      continue;
    }
    if (fresh || (result == STEP_UNSTABLE && unstable++ > 4))
      return result;
    restart(s);
    since = 0;
    fresh = true;
  }
  return STEP_UNSTABLE;
}

bw_status bwi_simplex_solve(bw_context *context, bwi_simplex *s, const double *cost, bool sampled,
                            bwi_vertex *vertex) {
  const bwi_programme *p = s->programme;
  int32_t m = p->rows, n = p->columns;
  double capacity = 0, sample = 0;
  int32_t at = 0;
  step_result result = STEP_OPTIMAL;
  for (int32_t j = 0; j < n; j++)
    capacity += p->upper[j];
  for (int32_t i = 0; i < m; i++)
    s->basic[i] = -1 - i;
  /* Equal gains make ties, and ties can make the method go round in circles. The second attempt
   * tells them apart by amounts far below the gap that is accepted. */
  for (int32_t j = 0; j < n; j++)
    s->cost[j] = cost[j] + (sampled ? 0 : 1e-12 * (double)((uint32_t)j * 2654435761u % 1024));
  s->iterations = 0;
  s->reach = INFINITY;
  for (int level = 0; level < p->levels; level++) {
    for (; at < p->level_end[level]; at++)
      sample += p->upper[at];
    if (!sampled && level < p->levels - 1)
      continue;
    s->end = p->level_end[level];
    s->segments = p->level_segments[level];
    s->stretch = level == p->levels - 1 ? 1 : capacity / sample;
    result = optimise(s);
  }
  if (result != STEP_OPTIMAL)
    return bw_fail(context, BW_CONVERGENCE,
                   "the dual simplex method found no optimum of %d rows and %d columns in %d "
                   "iterations (%s)",
                   m, n, s->iterations,
                   result == STEP_INFEASIBLE ? "the rows contradict each other"
                                             : "pivots too small, or too many iterations");
  memcpy(vertex->basic, s->basic, (size_t)m * sizeof *s->basic);
  for (int32_t j = 0; j < n; j++)
    vertex->at_upper[j] = s->state[j] == AT_UPPER;
  vertex->iterations = s->iterations;
  return BW_OK;
}
