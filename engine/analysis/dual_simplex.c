/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The dual simplex method for the worst-load linear program: few rows (seven for one free body),
 * many columns. It walks down the convex, piecewise linear dual function along the rows of the
 * basis's inverse, searching each exactly: boxed_simplex.c and grouped_simplex.c have the
 * iteration.
 *
 * Work per iteration is one product with all columns. A nested sample of the columns is solved
 * first (levels of the linear program, coarse to fine) and its basis starts the next one, so that
 * the full set sees only a few iterations. */
#include "analysis/simplex.h"

#include <string.h>

enum { REFRESH_EVERY = 50, ARRAYS = 20 };

/* The second attempt's, of the largest gain: far below the gap that is accepted. */
static const double second_scatter = 1e-9;

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

void bwi_simplex_destroy(bwi_simplex *s) {
  simplex_array list[ARRAYS];
  if (!s)
    return;
  arrays_of(s, list);
  for (int i = 0; i < ARRAYS; i++)
    bw_free(*list[i].place);
  bw_free(s);
}

bw_status bwi_simplex_create(bw_context *context, const bwi_linear_program *program,
                             bwi_simplex **simplex) {
  simplex_array list[ARRAYS];
  bwi_simplex *s = BW_NEW0(context, bwi_simplex, 1);
  if (!s)
    return BW_MEMORY;
  s->program = program;
  s->method = program->directions > 1 ? &bwi_grouped : &bwi_boxed;
  arrays_of(s, list);
  for (int i = 0; i < ARRAYS; i++) {
    if (list[i].count == 0)
      continue;
    *list[i].place = bw_alloc(context, list[i].count, list[i].size);
    if (!*list[i].place) {
      bwi_simplex_destroy(s);
      return BW_MEMORY;
    }
  }
  *simplex = s;
  return BW_OK;
}

/* A number from 0 to 1 that distinguishes columns. */
static double scatter(int32_t j) {
  return (double)((uint32_t)(j + 1) * 2654435761u >> 16) / 65536;
}

/* To the optimum of one level. The last iteration uses a recomputed basis and costs. */
static bwi_simplex_result optimise(bwi_simplex *s) {
  int limit = 400 + 120 * s->program->rows, since = 0, unstable = 0;
  s->method->restart(s);
  bool fresh = true;
  for (int i = 0; i < limit; i++) {
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
      s->method->restart(s);
      since = 0;
    }
  }
  return BWI_SIMPLEX_UNSTABLE;
}

bw_status bwi_simplex_solve(bw_context *context, bwi_simplex *s, const double *cost, bool sampled,
                            bwi_vertex *vertex) {
  const bwi_linear_program *p = s->program;
  double capacity = 0, sample = 0;
  bwi_simplex_result result = BWI_SIMPLEX_OPTIMAL;
  for (int32_t g = 0; g < p->groups; g++)
    capacity += p->upper[p->group_start[g]];
  /* Equal gains make ties, and ties can make the method cycle. Small perturbations remove them: in
   * the second attempt at least, or where the method needs them. */
  double apart = sampled ? s->method->scatter : second_scatter;
  for (int32_t j = 0; j < p->columns; j++)
    s->cost[j] = cost[j] + apart * scatter(j);
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
    result = optimise(s);
  }
  if (result != BWI_SIMPLEX_OPTIMAL)
    return bw_fail(context, BW_CONVERGENCE,
                   "the dual simplex method found no optimum of %d rows and %d columns in %d "
                   "groups in %d iterations (%s)",
                   p->rows, p->columns, p->groups, s->iterations,
                   result == BWI_SIMPLEX_INFEASIBLE ? "the rows contradict each other"
                                                    : "pivots too small, or too many iterations");
  s->method->hand_over(s, vertex);
  vertex->iterations = s->iterations;
  return BW_OK;
}
