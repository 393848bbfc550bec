/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The dual simplex method for the worst-load linear program: few rows (seven for one free body),
 * many columns. It walks down the convex, piecewise linear dual function along the rows of the
 * basis's inverse, searching each exactly: boxed_simplex.c and grouped_simplex.c have the
 * iteration.
 *
 * Work per iteration is one product with all columns. A nested sample of the columns is solved
 * first (levels of the linear program, coarse to fine) and its basis starts the next one, so that
 * the full set sees only a few iterations. */
#include "lp/simplex.h"

#include <math.h>
#include <string.h>

enum { REFRESH_EVERY = 50, ARRAYS = 20 };

/* The second attempt's, of the largest gain: far below the gap that is accepted. */
static const double second_scatter = 1e-9;
static const double stalled_scatter = 1e-10; /* likewise, once the method stalls */
enum { MAX_STALLED = 8 /* iterations without progress, one after the other */ };

typedef struct simplex_array {
  void **place;
  size_t count, size;
} simplex_array;

/* All arrays of a method; those of the other one are empty. */
static void arrays_of(bwi_simplex *s, simplex_array list[ARRAYS]) {
  const bwi_linear_program *p = s->program;
  size_t n = (size_t)p->columns, m = (size_t)p->rows, g = (size_t)p->groups;
  bool grouped = s->method == &bwi_grouped;
  size_t own = grouped ? 0 : n, groups = grouped ? g : 0, rows = grouped ? m : 0;
  const simplex_array all[ARRAYS] = {
      {(void **)&s->cost, n, sizeof *s->cost},
      {(void **)&s->reduced, n, sizeof *s->reduced},
      {(void **)&s->alpha, n, sizeof *s->alpha},
      {(void **)&s->point, n + groups, sizeof *s->point},
      {(void **)&s->factor, m * m, sizeof *s->factor},
      {(void **)&s->inverse, m * m, sizeof *s->inverse},
      {(void **)&s->x, m, sizeof *s->x},
      {(void **)&s->rest, m, sizeof *s->rest},
      {(void **)&s->y, m, sizeof *s->y},
      {(void **)&s->column, m, sizeof *s->column},
      {(void **)&s->pivot, m, sizeof *s->pivot},
      {(void **)&s->state, own, sizeof *s->state},
      {(void **)&s->basic, m - rows, sizeof *s->basic},
      {(void **)&s->key, groups, sizeof *s->key},
      {(void **)&s->ties, groups, sizeof *s->ties},
      {(void **)&s->last, groups, sizeof *s->last},
      {(void **)&s->key_change, groups > 0 ? n + groups : 0, sizeof *s->key_change},
      {(void **)&s->group, rows, sizeof *s->group},
      {(void **)&s->member, rows, sizeof *s->member},
      {(void **)&s->unit, rows, sizeof *s->unit},
  };
  memcpy(list, all, sizeof all);
}

static void simplex_close(void *state) {
  bwi_simplex *s = state;
  simplex_array list[ARRAYS];
  if (!s)
    return;
  arrays_of(s, list);
  for (int i = 0; i < ARRAYS; i++)
    bw_free(*list[i].place);
  bw_free(s);
}

static bw_status simplex_open(bw_context *context, const bwi_linear_program *program,
                              int max_iterations, void **state) {
  simplex_array list[ARRAYS];
  bwi_simplex *s = BW_NEW0(context, bwi_simplex, 1);
  if (!s)
    return BW_MEMORY;
  s->program = program;
  s->max_iterations =
      max_iterations > 0 ? max_iterations : program->levels * (400 + 120 * program->rows);
  s->method = program->grouped ? &bwi_grouped : &bwi_boxed;
  arrays_of(s, list);
  for (int i = 0; i < ARRAYS; i++) {
    if (list[i].count == 0)
      continue;
    *list[i].place = bw_alloc(context, list[i].count, list[i].size);
    if (!*list[i].place) {
      simplex_close(s);
      return BW_MEMORY;
    }
  }
  *state = s;
  return BW_OK;
}

/* A number from 0 to 1 that distinguishes columns. It must not be linear in j, not even in parts:
 * on regular meshes such costs leave ties as they are. */
static double scatter(int32_t j) {
  uint32_t x = (uint32_t)j + 1;
  x = (x ^ x >> 16) * 0x7feb352du;
  x = (x ^ x >> 15) * 0x846ca68bu;
  return (double)(x ^ x >> 16) / 4294967296.0;
}

static void set_costs(bwi_simplex *s, const double *cost, double apart) {
  for (int32_t j = 0; j < s->program->columns; j++)
    s->cost[j] = cost[j] + apart * scatter(j);
  s->apart = apart;
  s->stalled = 0;
}

/* To the optimum of one level. Where it stalls, costs are perturbed, or it gives up. The last
 * iteration uses a recomputed basis and costs. */
static bwi_simplex_result optimise(const bw_context *context, bwi_simplex *s, const double *cost,
                                   bool perturb) {
  int since = 0, unstable = 0;
  s->method->restart(s);
  bool fresh = true;
  for (int i = 0; s->iterations < s->max_iterations && i < s->max_iterations; i++) {
    if (s->stalled > MAX_STALLED && !perturb)
      return BWI_SIMPLEX_UNSTABLE;
    if (s->stalled > MAX_STALLED && s->apart == 0) {
      set_costs(s, cost, stalled_scatter);
      fresh = true;
      s->method->restart(s);
    }
    bwi_simplex_result result = s->method->iterate(s);
    if (result == BWI_SIMPLEX_PIVOTED) {
      s->iterations++;
      fresh = ++since == REFRESH_EVERY;
    } else if (fresh || (result == BWI_SIMPLEX_UNSTABLE && unstable++ > 4)) {
      return result;
    } else {
      fresh = true;
    }
    if (fresh) {
      if (bw_cancelled(context))
        return BWI_SIMPLEX_CANCELLED;
      s->method->restart(s);
      since = 0;
    }
  }
  return BWI_SIMPLEX_UNSTABLE;
}

static bw_status simplex_solve(bw_context *context, void *state, const double *cost, int attempt,
                               bwi_vertex *vertex) {
  bwi_simplex *s = state;
  bool sampled = attempt == 0;
  const bwi_linear_program *p = s->program;
  double capacity = 0, sample = 0;
  bwi_simplex_result result = BWI_SIMPLEX_OPTIMAL;
  for (int32_t g = 0; g < p->groups; g++)
    capacity += p->upper[p->group_start[g]];
  /* Equal gains make ties, and ties can make the method cycle. Small perturbations remove them: in
   * the second attempt, where the method needs them, or once it stalls. */
  set_costs(s, cost, sampled ? s->method->scatter : second_scatter);
  s->method->start(s);
  s->iterations = s->groups = 0;
  for (int level = 0; level < p->levels; level++) {
    s->end = p->level_end[level];
    while (s->groups < p->groups && p->group_start[s->groups] < s->end)
      sample += p->upper[p->group_start[s->groups++]];
    if (!sampled && level < p->levels - 1)
      continue;
    s->segments = p->level_segments[level];
    s->stretch = level == p->levels - 1 ? 1 : capacity / sample;
    result = optimise(context, s, cost, true);
    if (result == BWI_SIMPLEX_CANCELLED)
      return bw_check_cancel(context);
  }
  if (result != BWI_SIMPLEX_OPTIMAL)
    return bw_fail(context, BW_CONVERGENCE,
                   "the dual simplex method found no optimum of %d rows and %d columns in %d "
                   "groups in %d iterations (%s)",
                   p->rows, p->columns, p->groups, s->iterations,
                   result == BWI_SIMPLEX_INFEASIBLE ? "the rows contradict each other"
                                                    : "pivots too small, or too many iterations");
  s->method->hand_over(s, vertex);
  if (s->method == &bwi_boxed && s->apart > 0) {
    /* From there to the optimum of the costs that were given, where the ties allow it. */
    set_costs(s, cost, 0);
    if (optimise(context, s, cost, false) == BWI_SIMPLEX_OPTIMAL)
      s->method->hand_over(s, vertex);
  }
  vertex->iterations = s->iterations;
  return BW_OK;
}

/* ---- what it costs ------------------------------------------------------------------------- */

/* Iterations on the coarsest level, and on each finer one, for each row. */
enum { FIRST_ITERATIONS = 5, LATER_ITERATIONS = 3 };
/* Numbers that an iteration reads or writes for each column beside its entries: costs, the row
 * searched along, breakpoints; with groups keys and their changes besides. */
enum { BOXED_NUMBERS = 4, GROUPED_NUMBERS = 16 };

static double expected_iterations(const bwi_linear_program *program) {
  return program->rows * (double)(FIRST_ITERATIONS + (program->levels - 1) * LATER_ITERATIONS);
}

/* Of so many iterations, spread over the levels as is expected. */
static bwi_lp_cost cost_of(const bwi_linear_program *program, double iterations) {
  double per_column = 1, visits = 0;
  for (int32_t k = 0; k < program->segment_count; k++)
    per_column = fmax(per_column, program->segment[k].rows + 1);
  for (int level = 0; level < program->levels; level++)
    visits += (level == 0 ? FIRST_ITERATIONS : LATER_ITERATIONS) * program->rows *
              (double)program->level_end[level];
  visits *= iterations / expected_iterations(program);
  double numbers = per_column + (program->grouped ? GROUPED_NUMBERS : BOXED_NUMBERS);
  return (bwi_lp_cost){2 * per_column * visits, 8 * numbers * visits};
}

static double memory_of(const bwi_linear_program *program) {
  simplex_array list[ARRAYS];
  bwi_simplex s = {.program = program, .method = program->grouped ? &bwi_grouped : &bwi_boxed};
  double bytes = sizeof s;
  arrays_of(&s, list);
  for (int i = 0; i < ARRAYS; i++)
    bytes += (double)list[i].count * (double)list[i].size;
  return bytes;
}

static bwi_lp_cost open_cost(const bwi_linear_program *program) {
  return (bwi_lp_cost){0, memory_of(program)};
}

const bwi_lp_method bwi_lp_dual_simplex = {.name = "dual_simplex",
                                           .solver = "dual_simplex",
                                           .backend = "barwright",
                                           .attempts = 2,
                                           .open = simplex_open,
                                           .solve = simplex_solve,
                                           .close = simplex_close,
                                           .open_cost = open_cost,
                                           .cost = cost_of,
                                           .iterations = expected_iterations,
                                           .memory = memory_of};
