/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The dual simplex method for columns in groups with a common upper bound (generalised upper
 * bounds, Dantzig and Van Slyke 1967), for worst loads with friction.
 *
 * maximise c . t,  A t = b,  t >= 0,  sum of t over group g <= u_g. With d_j = c_j - y . A_j the
 * dual function
 *     phi(y) = b . y + sum_g u_g max(0, max_{j in g} d_j)
 * is convex and piecewise linear. Each group has a key: the column of the largest d_j, or none (a
 * column of zeros) where that is negative. The key carries u_g less the group's basic columns. A
 * basic column is tied with its key; as a column of the basis it is A_j - A_key.
 *
 * One iteration takes the basic variable that is most negative (in the metric of its row's length)
 * and searches phi exactly along the direction that parts it from its key: keys change on the way,
 * for as long as phi falls. The search ends early where another column overtakes a tie of the
 * basis. Where a key becomes negative, it changes places with the group's largest basic column
 * first.
 *
 * Invariants between iterations: key[g] is a column of g or NONE, and d is largest there up to
 * rounding; member[i] of a basic i is a column, or NONE for the group's column of zeros, never the
 * key; rest = b - sum of u_g A_key. The basis is refactorised in every iteration: it is small. */
#include "lp/simplex.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { NONE = -1, NO_GROUP = -1 };

#ifndef NDEBUG
static bool is_in_group(const bwi_simplex *s, int32_t g, int32_t j) {
  return j == NONE || (j >= s->program->group_start[g] && j < s->program->group_start[g + 1]);
}

/* Keys and basic columns are of their groups, no basic column is a key, and ties counts them. */
static bool is_consistent(const bwi_simplex *s) {
  int32_t m = s->program->rows, tied = 0, basic = 0;
  for (int32_t i = 0; i < m; i++) {
    int32_t g = s->group[i];
    if (g == NO_GROUP ? s->member[i] != NONE
                      : g < 0 || g >= s->groups || !is_in_group(s, g, s->member[i]) ||
                            s->member[i] == s->key[g])
      return false;
    basic += g != NO_GROUP;
  }
  for (int32_t g = 0; g < s->groups; g++) {
    if (!is_in_group(s, g, s->key[g]) || s->ties[g] < 0)
      return false;
    tied += s->ties[g];
  }
  return tied == basic;
}
#endif

static double upper(const bwi_simplex *s, int32_t g) {
  return s->stretch * s->program->upper[s->program->group_start[g]];
}

static double value(const double *list, int32_t j) {
  return j == NONE ? 0 : list[j];
}

static void make_unit(bwi_simplex *s, int32_t i) {
  if (s->group[i] != NO_GROUP)
    s->ties[s->group[i]]--;
  s->group[i] = NO_GROUP;
  s->member[i] = NONE;
}

static void start(bwi_simplex *s) {
  for (int32_t g = 0; g < s->program->groups; g++) {
    s->key[g] = NONE;
    s->ties[g] = 0;
  }
  for (int32_t i = 0; i < s->program->rows; i++) {
    s->group[i] = NO_GROUP;
    s->member[i] = NONE;
    s->unit[i] = i;
  }
}

static void basis_row(const bwi_simplex *s, int32_t i, double *row) {
  if (s->group[i] == NO_GROUP) {
    row[s->unit[i]] = 1;
  } else {
    bwi_add_column(s, s->member[i], 1, row);
    bwi_add_column(s, s->key[s->group[i]], -1, row);
  }
}

static void set_key(bwi_simplex *s, int32_t g, int32_t to) {
  bwi_add_column(s, s->key[g], upper(s, g), s->rest);
  bwi_add_column(s, to, -upper(s, g), s->rest);
  s->key[g] = to;
}

/* Multipliers and reduced costs of the basis; keys of groups without a basic column. */
static void price(bwi_simplex *s) {
  const bwi_linear_program *p = s->program;
  int32_t m = p->rows;
  memset(s->y, 0, (size_t)m * sizeof *s->y);
  for (int32_t i = 0; i < m; i++) {
    if (s->group[i] == NO_GROUP)
      continue;
    double c = value(s->cost, s->member[i]) - value(s->cost, s->key[s->group[i]]);
    for (int32_t k = 0; k < m; k++)
      s->y[k] += c * s->inverse[(size_t)i * (size_t)m + (size_t)k];
  }
  bwi_times_columns(s, s->y, s->reduced);
  for (int32_t i = 0; i < m; i++)
    s->rest[i] = i == m - 1;
  for (int32_t g = 0; g < s->groups; g++) {
    int32_t best = NONE;
    for (int32_t j = p->group_start[g]; j < p->group_start[g + 1]; j++) {
      s->reduced[j] = s->cost[j] - s->reduced[j];
      if (s->reduced[j] > value(s->reduced, best))
        best = j;
    }
    if (s->ties[g] == 0)
      s->key[g] = best;
    bwi_add_column(s, s->key[g], -upper(s, g), s->rest);
  }
}

/* A basic column whose tie others overtake cannot stay: its place goes to the unit column. */
static bool overtaken(bwi_simplex *s) {
  const bwi_linear_program *p = s->program;
  bool found = false;
  for (int32_t i = 0; i < p->rows; i++) {
    int32_t g = s->group[i];
    if (g == NO_GROUP)
      continue;
    double tie = value(s->reduced, s->key[g]), max = 0;
    for (int32_t j = p->group_start[g]; j < p->group_start[g + 1]; j++)
      max = fmax(max, s->reduced[j]);
    if (max > tie + 1e-9) {
      make_unit(s, i);
      found = true;
    }
  }
  return found;
}

/* Everything recomputed from the basic columns and their keys. */
static void restart(bwi_simplex *s) {
  int32_t m = s->program->rows;
  do {
    if (!bwi_invert(s)) {
      for (int32_t i = 0; i < m; i++) {
        make_unit(s, i);
        s->unit[i] = i;
      }
      bwi_invert(s);
    }
    price(s);
  } while (overtaken(s));
  bwi_basic_values(s);
  assert(is_consistent(s));
}

/* A key that is negative changes places with the largest basic column of its group. Returns
 * whether any did. */
static bool exchange_keys(bwi_simplex *s) {
  int32_t m = s->program->rows;
  bool exchanged = false;
  for (int32_t i = 0; i < m; i++) {
    int32_t g = s->group[i], largest = i;
    if (g == NO_GROUP)
      continue;
    double left = upper(s, g);
    for (int32_t k = 0; k < m; k++)
      if (s->group[k] == g) {
        left -= s->x[k];
        largest = s->x[k] > s->x[largest] ? k : largest;
      }
    if (left >= -bwi_feasible(upper(s, g)))
      continue;
    int32_t former = s->key[g];
    set_key(s, g, s->member[largest]);
    s->member[largest] = former;
    s->x[largest] = left;
    exchanged = true;
  }
  return exchanged;
}

/* The row to leave the basis, or -1 at the optimum. */
static int32_t leaving_row(const bwi_simplex *s, double *length) {
  int32_t m = s->program->rows, found = -1;
  double best = 0;
  for (int32_t i = 0; i < m; i++) {
    bool unit = s->group[i] == NO_GROUP;
    double bound = unit ? 0 : upper(s, s->group[i]);
    double broken = unit ? fabs(s->x[i]) : -s->x[i];
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

/* The column of group g that overtakes column p first as d - step * sign * alpha; NONE - 1 when no
 * one does. */
static int32_t next_key(const bwi_simplex *s, int32_t g, int32_t p, double sign, double smallest,
                        double *step) {
  const bwi_linear_program *program = s->program;
  int32_t found = NONE - 1;
  double d = value(s->reduced, p), a = sign * value(s->alpha, p), max = 0;
  *step = INFINITY;
  for (int32_t j = program->group_start[g] - 1; j < program->group_start[g + 1]; j++) {
    int32_t q = j < program->group_start[g] ? NONE : j;
    double steeper = a - sign * value(s->alpha, q);
    if (q == p || !(steeper > smallest))
      continue;
    double at = fmax(0, d - value(s->reduced, q)) / steeper;
    if (at < *step || (at == *step && steeper > max)) {
      *step = at;
      max = steeper;
      found = q;
    }
  }
  return found;
}

/* All breakpoints of phi along the row of the inverse; those of a group follow each other. */
static int32_t breakpoints(bwi_simplex *s, int32_t leaving, double sign, double smallest) {
  int32_t count = 0;
  for (int32_t g = 0; g < s->groups; g++) {
    /* The leaving column is parted from its key: what else the group has in the basis is not. */
    bool tied = s->ties[g] > (s->group[leaving] == g);
    double step, former = 0;
    int32_t p = s->key[g];
    for (;;) {
      int32_t q = next_key(s, g, p, sign, smallest, &step);
      if (q < NONE)
        break;
      former = fmax(former, step);
      double slope = upper(s, g) * sign * (value(s->alpha, p) - value(s->alpha, q));
      s->key_change[count] = (bwi_key_change){g, q, tied};
      s->point[count] = (bwi_breakpoint){former, tied ? 1e300 : slope, count};
      count++;
      if (tied)
        break;
      p = q;
    }
  }
  return count;
}

/* The pivot of a breakpoint whose group has the key p before it. */
static double pivot_of(const bwi_simplex *s, int32_t p, int32_t q) {
  return value(s->alpha, p) - value(s->alpha, q);
}

static bwi_simplex_result iterate(bwi_simplex *s) {
  const bwi_linear_program *program = s->program;
  int32_t m = program->rows;
  double length = 1;
  do {
    if (!bwi_invert(s))
      return BWI_SIMPLEX_UNSTABLE;
    bwi_basic_values(s);
  } while (exchange_keys(s));
  int32_t r = leaving_row(s, &length);
  if (r < 0)
    return BWI_SIMPLEX_OPTIMAL;
  bool unit = s->group[r] == NO_GROUP;
  double broken = fabs(s->x[r]), sign = unit && s->x[r] > 0 ? -1 : 1;
  const double *row = s->inverse + (size_t)r * (size_t)m;
  bwi_times_columns(s, row, s->alpha);
  int32_t count = breakpoints(s, r, sign, 1e-11 * length);
  int32_t passed = bwi_select_breakpoints(s->point, count, broken);
  if (passed <= 0)
    return BWI_SIMPLEX_INFEASIBLE;
  const bwi_breakpoint stop = s->point[passed - 1];
  const bwi_key_change last = s->key_change[stop.column];

  /* Keys before the stop: the last breakpoint passed of each group. */
  for (int32_t i = 0; i < passed - 1; i++)
    s->last[s->key_change[s->point[i].column].group] = -1;
  for (int32_t i = 0; i < passed - 1; i++) {
    int32_t b = s->point[i].column;
    if (b > s->last[s->key_change[b].group])
      s->last[s->key_change[b].group] = b;
  }
  int32_t before = s->key[last.group];
  for (int32_t i = 0; i < passed - 1; i++) {
    int32_t b = s->point[i].column;
    if (s->key_change[b].group == last.group && b == s->last[last.group])
      before = s->key_change[b].column;
  }
  if (fabs(pivot_of(s, before, last.column)) < bwi_smallest_pivot * length)
    return BWI_SIMPLEX_UNSTABLE;
  for (int32_t i = 0; i < passed - 1; i++) {
    int32_t b = s->point[i].column;
    if (b == s->last[s->key_change[b].group])
      set_key(s, s->key_change[b].group, s->key_change[b].column);
  }
  double move = stop.step * sign;
  for (int32_t j = 0; j < s->end; j++)
    s->reduced[j] -= move * s->alpha[j];
  if (!unit)
    s->ties[s->group[r]]--;
  s->group[r] = last.group;
  s->member[r] = last.column;
  s->ties[last.group]++;
  assert(is_consistent(s));
  return BWI_SIMPLEX_PIVOTED;
}

/* As bwi_vertex wants it: no column of zeros in the basis. */
static void hand_over(bwi_simplex *s, bwi_vertex *vertex) {
  const bwi_linear_program *p = s->program;
  memset(vertex->at_upper, 0, (size_t)p->columns * sizeof *vertex->at_upper);
  for (int32_t i = 0; i < p->rows; i++)
    if (s->group[i] != NO_GROUP && s->member[i] == NONE) {
      s->member[i] = s->key[s->group[i]];
      s->key[s->group[i]] = NONE;
    }
  for (int32_t i = 0; i < p->rows; i++)
    vertex->basic[i] = s->group[i] == NO_GROUP ? -1 - s->unit[i] : s->member[i];
  for (int32_t g = 0; g < p->groups; g++)
    if (s->key[g] != NONE)
      vertex->at_upper[s->key[g]] = 1;
}

/* The columns of a node lie in a space of three dimensions: where three of them are tied, all are,
 * and the method would cycle, so the first attempt perturbs them as well. */
const bwi_method bwi_grouped = {1e-10, start, basis_row, restart, iterate, hand_over};
