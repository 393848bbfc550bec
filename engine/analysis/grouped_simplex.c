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
 * key; rest = b - sum of u_g A_key. The basis is factored anew in every iteration: it is small. */
#include "analysis/programme.h"

#include <math.h>
#include <string.h>

enum { NONE = -1, NO_GROUP = -1, REFRESH_EVERY = 50 };

static const double feasible_share = 1e-12; /* of the total force */
static const double feasible_bound = 1e-9;  /* of a group's bound */
static const double smallest_pivot = 1e-7;  /* over the length of the row of the inverse */

typedef struct bend {
  int32_t group, column; /* the key after it */
  bool tied;             /* ends the search: the group has a basic column */
} bend;

struct bwi_grouped {
  const bwi_programme *programme;
  double *cost, *reduced, *alpha; /* columns */
  int32_t *key, *ties;            /* groups: the key, and how many columns of the basis */
  int32_t *last;                  /* groups: scratch, the last breakpoint passed */
  bwi_breakpoint *point;          /* columns and groups */
  bend *bend;                     /* the same */
  int32_t *group, *member;  /* rows: the basic column's group (NO_GROUP: unit column), column */
  int32_t *unit;            /* rows: number of the unit column */
  double *factor, *inverse; /* rows x rows */
  double *x, *rest, *y, *column; /* rows */
  int32_t *pivot;
  int32_t end;    /* groups of the level at work */
  double stretch; /* of the bounds: a sample carries the whole force */
  int iterations;
};

void bwi_grouped_free(bwi_grouped *s) {
  if (!s)
    return;
  bw_free(s->cost);
  bw_free(s->reduced);
  bw_free(s->alpha);
  bw_free(s->key);
  bw_free(s->ties);
  bw_free(s->last);
  bw_free(s->point);
  bw_free(s->bend);
  bw_free(s->group);
  bw_free(s->member);
  bw_free(s->unit);
  bw_free(s->factor);
  bw_free(s->inverse);
  bw_free(s->x);
  bw_free(s->rest);
  bw_free(s->y);
  bw_free(s->column);
  bw_free(s->pivot);
  bw_free(s);
}

bw_status bwi_grouped_create(bw_context *context, const bwi_programme *programme,
                             bwi_grouped **grouped) {
  size_t n = (size_t)programme->columns, m = (size_t)programme->rows, g = (size_t)programme->groups;
  bwi_grouped *s = BW_NEW0(context, bwi_grouped, 1);
  if (!s)
    return BW_MEMORY;
  s->programme = programme;
  s->cost = BW_NEW(context, double, n);
  s->reduced = BW_NEW(context, double, n);
  s->alpha = BW_NEW(context, double, n);
  s->key = BW_NEW(context, int32_t, g);
  s->ties = BW_NEW(context, int32_t, g);
  s->last = BW_NEW(context, int32_t, g);
  s->point = BW_NEW(context, bwi_breakpoint, n + g);
  s->bend = BW_NEW(context, bend, n + g);
  s->group = BW_NEW(context, int32_t, m);
  s->member = BW_NEW(context, int32_t, m);
  s->unit = BW_NEW(context, int32_t, m);
  s->factor = BW_NEW(context, double, m *m);
  s->inverse = BW_NEW(context, double, m *m);
  s->x = BW_NEW(context, double, m);
  s->rest = BW_NEW(context, double, m);
  s->y = BW_NEW(context, double, m);
  s->column = BW_NEW(context, double, m);
  s->pivot = BW_NEW(context, int32_t, m);
  if (!s->cost || !s->reduced || !s->alpha || !s->key || !s->ties || !s->last || !s->point ||
      !s->bend || !s->group || !s->member || !s->unit || !s->factor || !s->inverse || !s->x ||
      !s->rest || !s->y || !s->column || !s->pivot) {
    bwi_grouped_free(s);
    return BW_MEMORY;
  }
  *grouped = s;
  return BW_OK;
}

static double upper(const bwi_grouped *s, int32_t g) {
  return s->stretch * s->programme->upper[s->programme->group_start[g]];
}

static double value(const double *list, int32_t j) {
  return j == NONE ? 0 : list[j];
}

/* sum += factor * A_j */
static void add(const bwi_grouped *s, int32_t j, double factor, double *sum) {
  const bwi_programme *p = s->programme;
  if (j == NONE)
    return;
  double *local = sum + p->first_row[j];
  for (int32_t l = 0; l < p->row_count[j]; l++)
    local[l] += factor * p->entry[(size_t)l * (size_t)p->columns + (size_t)j];
  sum[p->rows - 1] += factor;
}

/* out_j = row . A_j for all columns at work. */
static void times_columns(const bwi_grouped *s, const double *row, double *out) {
  const bwi_programme *p = s->programme;
  size_t n = (size_t)p->columns;
  int32_t end = p->group_start[s->end];
  for (int32_t j = 0; j < end; j++) {
    const double *e = p->entry + j, *r = row + p->first_row[j];
    double sum = row[p->rows - 1];
    for (int32_t l = 0; l < p->row_count[j]; l++)
      sum += r[l] * e[(size_t)l * n];
    out[j] = sum;
  }
}

static void make_unit(bwi_grouped *s, int32_t i) {
  if (s->group[i] != NO_GROUP)
    s->ties[s->group[i]]--;
  s->group[i] = NO_GROUP;
  s->member[i] = NONE;
}

/* The inverse of the basis; false when its columns are dependent. */
static bool invert(bwi_grouped *s) {
  int32_t m = s->programme->rows;
  size_t square = (size_t)m * (size_t)m;
  memset(s->factor, 0, square * sizeof *s->factor);
  for (int32_t i = 0; i < m; i++) {
    double *row = s->factor + (size_t)i * (size_t)m; /* the transpose of the basis */
    if (s->group[i] == NO_GROUP) {
      row[s->unit[i]] = 1;
    } else {
      add(s, s->member[i], 1, row);
      add(s, s->key[s->group[i]], -1, row);
    }
  }
  if (!bwi_dense_factor(m, s->factor, s->pivot))
    return false;
  memset(s->inverse, 0, square * sizeof *s->inverse);
  for (int32_t i = 0; i < m; i++) {
    double *row = s->inverse + (size_t)i * (size_t)m;
    row[i] = 1;
    bwi_dense_solve(m, s->factor, s->pivot, row);
  }
  return true;
}

static void basic_values(bwi_grouped *s) {
  int32_t m = s->programme->rows;
  for (int32_t i = 0; i < m; i++) {
    double sum = 0;
    for (int32_t k = 0; k < m; k++)
      sum += s->inverse[(size_t)i * (size_t)m + (size_t)k] * s->rest[k];
    s->x[i] = sum;
  }
}

static void set_key(bwi_grouped *s, int32_t g, int32_t to) {
  add(s, s->key[g], upper(s, g), s->rest);
  add(s, to, -upper(s, g), s->rest);
  s->key[g] = to;
}

/* Multipliers and reduced costs of the basis; keys of groups without a basic column. */
static void price(bwi_grouped *s) {
  const bwi_programme *p = s->programme;
  int32_t m = p->rows;
  memset(s->y, 0, (size_t)m * sizeof *s->y);
  for (int32_t i = 0; i < m; i++) {
    if (s->group[i] == NO_GROUP)
      continue;
    double c = value(s->cost, s->member[i]) - value(s->cost, s->key[s->group[i]]);
    for (int32_t k = 0; k < m; k++)
      s->y[k] += c * s->inverse[(size_t)i * (size_t)m + (size_t)k];
  }
  times_columns(s, s->y, s->reduced);
  for (int32_t i = 0; i < m; i++)
    s->rest[i] = i == m - 1;
  for (int32_t g = 0; g < s->end; g++) {
    int32_t best = NONE;
    for (int32_t j = p->group_start[g]; j < p->group_start[g + 1]; j++) {
      s->reduced[j] = s->cost[j] - s->reduced[j];
      if (s->reduced[j] > value(s->reduced, best))
        best = j;
    }
    if (s->ties[g] == 0)
      s->key[g] = best;
    add(s, s->key[g], -upper(s, g), s->rest);
  }
}

/* A basic column whose tie others overtake cannot stay: its place goes to the unit column. */
static bool overtaken(bwi_grouped *s) {
  const bwi_programme *p = s->programme;
  bool found = false;
  for (int32_t i = 0; i < p->rows; i++) {
    int32_t g = s->group[i];
    if (g == NO_GROUP)
      continue;
    double tie = value(s->reduced, s->key[g]), most = 0;
    for (int32_t j = p->group_start[g]; j < p->group_start[g + 1]; j++)
      most = fmax(most, s->reduced[j]);
    if (most > tie + 1e-9) {
      make_unit(s, i);
      found = true;
    }
  }
  return found;
}

/* Everything afresh from the basic columns and their keys. */
static void restart(bwi_grouped *s) {
  int32_t m = s->programme->rows;
  do {
    if (!invert(s)) {
      for (int32_t i = 0; i < m; i++) {
        make_unit(s, i);
        s->unit[i] = i;
      }
      invert(s);
    }
    price(s);
  } while (overtaken(s));
  basic_values(s);
}

/* A key that is negative changes places with the largest basic column of its group. Returns
 * whether any did. */
static bool turn_keys(bwi_grouped *s) {
  int32_t m = s->programme->rows;
  bool turned = false;
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
    if (left >= -(feasible_share + feasible_bound * upper(s, g)))
      continue;
    int32_t former = s->key[g];
    set_key(s, g, s->member[largest]);
    s->member[largest] = former;
    s->x[largest] = left;
    turned = true;
  }
  return turned;
}

/* The row to leave the basis, or -1 at the optimum. */
static int32_t leaving_row(const bwi_grouped *s, double *length) {
  int32_t m = s->programme->rows, found = -1;
  double best = 0;
  for (int32_t i = 0; i < m; i++) {
    bool unit = s->group[i] == NO_GROUP;
    double bound = unit ? 0 : upper(s, s->group[i]), square = 0;
    double broken = unit ? fabs(s->x[i]) : -s->x[i];
    if (!(broken > feasible_share + feasible_bound * bound))
      continue;
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

/* The column of group g that overtakes column p first as d - step * sign * alpha; NONE - 1 when no
 * one does. */
static int32_t next_key(const bwi_grouped *s, int32_t g, int32_t p, double sign, double smallest,
                        double *step) {
  const bwi_programme *programme = s->programme;
  int32_t found = NONE - 1;
  double d = value(s->reduced, p), a = sign * value(s->alpha, p), most = 0;
  *step = INFINITY;
  for (int32_t j = programme->group_start[g] - 1; j < programme->group_start[g + 1]; j++) {
    int32_t q = j < programme->group_start[g] ? NONE : j;
    double steeper = a - sign * value(s->alpha, q);
    if (q == p || !(steeper > smallest))
      continue;
    double at = fmax(0, d - value(s->reduced, q)) / steeper;
    if (at < *step || (at == *step && steeper > most)) {
      *step = at;
      most = steeper;
      found = q;
    }
  }
  return found;
}

/* All breakpoints of phi along the row of the inverse; those of a group follow each other. */
static int32_t breakpoints(bwi_grouped *s, int32_t leaving, double sign, double smallest) {
  int32_t count = 0;
  for (int32_t g = 0; g < s->end; g++) {
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
      s->bend[count] = (bend){g, q, tied};
      s->point[count] = (bwi_breakpoint){former, tied ? 1e300 : slope, count};
      count++;
      if (tied)
        break;
      p = q;
    }
  }
  return count;
}

typedef enum step_result { STEP_DONE, STEP_OPTIMAL, STEP_INFEASIBLE, STEP_UNSTABLE } step_result;

/* The pivot of a breakpoint whose group has the key p before it. */
static double pivot_of(const bwi_grouped *s, int32_t p, int32_t q) {
  return value(s->alpha, p) - value(s->alpha, q);
}

static step_result iterate(bwi_grouped *s) {
  const bwi_programme *programme = s->programme;
  int32_t m = programme->rows;
  double length = 1;
  do {
    if (!invert(s))
      return STEP_UNSTABLE;
    basic_values(s);
  } while (turn_keys(s));
  int32_t r = leaving_row(s, &length);
  if (r < 0)
    return STEP_OPTIMAL;
  bool unit = s->group[r] == NO_GROUP;
  double broken = fabs(s->x[r]), sign = unit && s->x[r] > 0 ? -1 : 1;
  const double *row = s->inverse + (size_t)r * (size_t)m;
  times_columns(s, row, s->alpha);
  int32_t count = breakpoints(s, r, sign, 1e-11 * length);
  int32_t passed = bwi_select_breakpoints(s->point, count, broken);
  if (passed <= 0)
    return STEP_INFEASIBLE;
  const bwi_breakpoint stop = s->point[passed - 1];
  const bend last = s->bend[stop.column];

  /* Keys before the stop: the last breakpoint passed of each group. */
  for (int32_t i = 0; i < passed - 1; i++)
    s->last[s->bend[s->point[i].column].group] = -1;
  for (int32_t i = 0; i < passed - 1; i++) {
    int32_t b = s->point[i].column;
    if (b > s->last[s->bend[b].group])
      s->last[s->bend[b].group] = b;
  }
  int32_t before = s->key[last.group];
  for (int32_t i = 0; i < passed - 1; i++) {
    int32_t b = s->point[i].column;
    if (s->bend[b].group == last.group && b == s->last[last.group])
      before = s->bend[b].column;
  }
  if (fabs(pivot_of(s, before, last.column)) < smallest_pivot * length)
    return STEP_UNSTABLE;
  for (int32_t i = 0; i < passed - 1; i++) {
    int32_t b = s->point[i].column;
    if (b == s->last[s->bend[b].group])
      set_key(s, s->bend[b].group, s->bend[b].column);
  }
  double move = stop.step * sign;
  int32_t end = programme->group_start[s->end];
  for (int32_t j = 0; j < end; j++)
    s->reduced[j] -= move * s->alpha[j];
  if (!unit)
    s->ties[s->group[r]]--;
  s->group[r] = last.group;
  s->member[r] = last.column;
  s->ties[last.group]++;
  return STEP_DONE;
}

/* A number from 0 to 1 that tells columns apart. */
static double scatter(int32_t j) {
  return (double)((uint32_t)(j + 1) * 2654435761u >> 16) / 65536;
}

/* To the optimum of one level. The last word is had by a basis and costs computed afresh. */
static step_result optimise(bwi_grouped *s) {
  int limit = 400 + 120 * s->programme->rows, since = 0, unstable = 0;
  restart(s);
  bool fresh = true;
  for (int i = 0; i < limit; i++) {
    step_result result = iterate(s);
    if (result == STEP_DONE) {
      s->iterations++;
      fresh = ++since == REFRESH_EVERY;
      if (fresh) {
        restart(s);
        since = 0;
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

/* As bwi_vertex wants it: no column of zeros in the basis. */
static void hand_over(bwi_grouped *s, bwi_vertex *vertex) {
  const bwi_programme *p = s->programme;
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
  vertex->iterations = s->iterations;
}

bw_status bwi_grouped_solve(bw_context *context, bwi_grouped *s, const double *cost, bool sampled,
                            bwi_vertex *vertex) {
  const bwi_programme *p = s->programme;
  double capacity = 0, sample = 0;
  int32_t at = 0;
  step_result result = STEP_OPTIMAL;
  for (int32_t g = 0; g < p->groups; g++) {
    capacity += p->upper[p->group_start[g]];
    s->key[g] = NONE;
    s->ties[g] = 0;
  }
  for (int32_t i = 0; i < p->rows; i++) {
    s->group[i] = NO_GROUP;
    s->member[i] = NONE;
    s->unit[i] = i;
  }
  /* The columns of a node lie in a space of three dimensions: where three of them are tied, all
   * are, and the method would go round in circles. Amounts far below the gap that is accepted tell
   * them apart, larger ones in the second attempt. */
  for (int32_t j = 0; j < p->columns; j++)
    s->cost[j] = cost[j] + (sampled ? 1e-10 : 1e-9) * scatter(j);
  s->iterations = 0;
  for (int level = 0; level < p->levels; level++) {
    while (at < p->groups && p->group_start[at] < p->level_end[level])
      sample += p->upper[p->group_start[at++]];
    if (!sampled && level < p->levels - 1)
      continue;
    s->end = at;
    s->stretch = level == p->levels - 1 ? 1 : capacity / sample;
    result = optimise(s);
  }
  if (result != STEP_OPTIMAL)
    return bw_fail(context, BW_CONVERGENCE,
                   "the dual simplex method found no optimum of %d rows and %d columns in %d "
                   "groups in %d iterations (%s)",
                   p->rows, p->columns, p->groups, s->iterations,
                   result == STEP_INFEASIBLE ? "the rows contradict each other"
                                             : "pivots too small, or too many iterations");
  hand_over(s, vertex);
  return BW_OK;
}
