/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Linear programs of fractions: each backend against trying every vertex, with and without groups;
 * the choice between them, limits, cancelling, and GLPK's way of failing. */
#include "lp/backends.h"

#include <glpk.h>
#include <math.h>
#include <pthread.h>
#include <string.h>

/* A random program with one segment. Its middle is feasible: sum u = 2, and half of each bound
 * fulfils the rows. */
typedef struct random_program {
  bwi_linear_program lp;
  double *cost;
} random_program;

static void program_open(bw_context *context, random_program *p, bw_random *random, int32_t rows,
                         int32_t groups, int32_t size) {
  int32_t n = groups * size;
  memset(p, 0, sizeof *p);
  p->lp.rows = rows;
  p->lp.columns = n;
  p->lp.grouped = size > 1;
  p->lp.groups = groups;
  p->lp.group_start = BW_NEW(context, int32_t, groups + 1);
  p->lp.group = BW_NEW(context, int32_t, n);
  p->lp.entry = BW_NEW0(context, double, (size_t)BWI_LOCAL_ROWS *(size_t)n);
  p->lp.upper = BW_NEW(context, double, n);
  p->lp.first_row = BW_NEW0(context, int32_t, n);
  p->lp.row_count = BW_NEW(context, int32_t, n);
  p->lp.segment = BW_NEW0(context, bwi_segment, 1);
  p->lp.segment_count = 1;
  p->lp.segment[0] = (bwi_segment){0, n, 0, rows - 1};
  p->lp.levels = 1;
  p->lp.level_end[0] = n;
  p->lp.level_segments[0] = 1;
  p->cost = BW_NEW(context, double, n);
  double sum = 0;
  for (int32_t g = 0; g <= groups; g++)
    p->lp.group_start[g] = g * size;
  for (int32_t g = 0; g < groups; g++) {
    double upper = 0.2 + bw_random_uniform(random);
    sum += upper;
    for (int32_t j = g * size; j < (g + 1) * size; j++) {
      p->lp.group[j] = g;
      p->lp.upper[j] = upper;
      p->lp.row_count[j] = rows - 1;
      p->cost[j] = bw_random_normal(random);
    }
  }
  for (int32_t j = 0; j < n; j++)
    p->lp.upper[j] *= 2 / sum;
  for (int32_t l = 0; l < rows - 1; l++) {
    double *entry = p->lp.entry + (size_t)l * (size_t)n, rest = 0;
    for (int32_t j = 0; j < n; j++) {
      entry[j] = bw_random_normal(random);
      rest += entry[j] * p->lp.upper[j] / size;
    }
    for (int32_t j = 0; j < n; j++) /* sum over all of entry u / size is 0 */
      entry[j] -= rest / 2;
  }
}

static void program_close(random_program *p) {
  bwi_linear_program_clear(&p->lp);
  bw_free(p->cost);
}

/* The best of all vertices: every choice of one of three states for each group or column, basic
 * columns found by solving. Columns of a group: none, or one at the bound, or basic ones. */
typedef struct trial {
  const random_program *p;
  int32_t basic[8], count;
  uint8_t full[16];
  double best;
} trial;

static void judge(trial *t) {
  const bwi_linear_program *lp = &t->p->lp;
  int32_t m = lp->rows, n = lp->columns, pivot[8];
  double a[64] = {0}, x[8] = {0}, share[16] = {0}, value = 0;
  x[m - 1] = 1;
  for (int32_t j = 0; j < n; j++)
    if (t->full[j]) {
      share[j] = lp->upper[j];
      for (int32_t l = 0; l < m; l++)
        x[l] -= lp->upper[j] * (l == m - 1 ? 1 : lp->entry[l * n + j]);
    }
  for (int32_t i = 0; i < m; i++)
    for (int32_t l = 0; l < m; l++) {
      int32_t j = t->basic[i], key = -1;
      for (int32_t k = lp->group_start[lp->group[j]]; k < lp->group_start[lp->group[j] + 1]; k++)
        key = t->full[k] ? k : key;
      a[l * m + i] = l == m - 1 ? (key < 0) : lp->entry[l * n + j];
      if (key >= 0 && l < m - 1)
        a[l * m + i] -= lp->entry[l * n + key];
    }
  if (!bwi_dense_factor(m, a, pivot))
    return;
  bwi_dense_solve(m, a, pivot, x);
  for (int32_t i = 0; i < m; i++) {
    int32_t j = t->basic[i];
    share[j] += x[i];
    for (int32_t k = lp->group_start[lp->group[j]]; k < lp->group_start[lp->group[j] + 1]; k++)
      if (t->full[k])
        share[k] -= x[i];
  }
  for (int32_t g = 0; g < lp->groups; g++) {
    double sum = 0;
    for (int32_t j = lp->group_start[g]; j < lp->group_start[g + 1]; j++) {
      if (share[j] < -1e-10)
        return;
      sum += share[j];
      value += t->p->cost[j] * share[j];
    }
    if (sum > lp->upper[lp->group_start[g]] + 1e-10)
      return;
  }
  t->best = fmax(t->best, value);
}

/* The states of group g and those after it: which of its columns is full, and which are basic. */
static void try_groups(trial *t, int32_t g) {
  const bwi_linear_program *lp = &t->p->lp;
  if (g == lp->groups) {
    if (t->count == lp->rows)
      judge(t);
    return;
  }
  int32_t first = lp->group_start[g], size = lp->group_start[g + 1] - first, before = t->count;
  for (int32_t full = -1; full < size; full++)
    for (int set = 0; set < 1 << size; set++) {
      if (full >= 0 && (set >> full & 1))
        continue;
      t->count = before;
      for (int32_t k = 0; k < size && t->count <= lp->rows; k++)
        if (set >> k & 1) {
          if (t->count < lp->rows)
            t->basic[t->count] = first + k;
          t->count++;
        }
      if (t->count > lp->rows)
        continue;
      if (full >= 0)
        t->full[first + full] = 1;
      try_groups(t, g + 1);
      if (full >= 0)
        t->full[first + full] = 0;
    }
  t->count = before;
}

static void each_backend_finds_the_best_vertex(void **state) {
  bw_context *context = check_context(state);
  const int32_t shape[4][3] = {{1, 5, 1}, {3, 7, 1}, {4, 8, 1}, {3, 4, 3}};
  bw_random random;
  bw_random_seed(&random, 5);
  for (int kind = 0; kind < 4; kind++)
    for (int turn = 0; turn < 20; turn++) {
      random_program p;
      program_open(context, &p, &random, shape[kind][0], shape[kind][1], shape[kind][2]);
      trial t = {.p = &p, .best = -INFINITY};
      try_groups(&t, 0);
      assert_true(isfinite(t.best));
      for (int b = 0; b <= LP_BACKENDS; b++) { /* the last: chosen */
        bw_lp_solver *solver = b < LP_BACKENDS ? lp_backend(context, b) : NULL;
        bwi_lp_choice choice;
        bwi_lp_workspace workspace;
        double share[16], y[8];
        bwi_solution solution = {.fraction = share, .multiplier = y};
        bwi_lp_choose(&p.lp, solver, &choice);
        assert_ptr_equal(choice.other == NULL, solver != NULL);
        check_ok(context, bwi_lp_open(context, &p.lp, &choice, &workspace));
        check_ok(context, bwi_lp_solve(context, &workspace, p.cost, &solution));
        check_near(solution.value, t.best, 1e-9 * (1 + fabs(t.best)));
        bw_solver_report report;
        bwi_lp_report(&choice, &p.lp, 1, &workspace.counts, &report);
        if (solver) {
          assert_string_equal(report.backend, lp_backends[b]->backend);
          assert_true(report.predicted_cost == 0);
        } else {
          assert_true(report.predicted_cost > 0 && report.rival_cost > 0);
        }
        assert_true(report.bytes > 0 && strlen(report.reason) > 0 && report.residual < 1e-9);
        bwi_lp_close(&workspace);
        bw_release(solver);
      }
      program_close(&p);
    }
}

/* With a limit a backend gives up, and does not pass the program on: the user has chosen it. */
static void a_limit_of_iterations_holds(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 6);
  random_program p;
  program_open(context, &p, &random, 5, 200, 1);
  double *share = BW_NEW(context, double, 200), y[8];
  bwi_solution solution = {.fraction = share, .multiplier = y};
  for (int b = 0; b < LP_BACKENDS; b++) {
    const bw_lp_options few = {.max_iterations = 1}, wrong = {.max_iterations = -1};
    bw_lp_solver *solver = NULL;
    bwi_lp_choice choice;
    bwi_lp_workspace workspace;
    check_fails(context, BW_INVALID, "max_iterations is -1",
                b == 0 ? bw_lp_dual_simplex(context, &wrong, &solver)
                       : bw_lp_glpk(context, &wrong, &solver));
    check_ok(context, b == 0 ? bw_lp_dual_simplex(context, &few, &solver)
                             : bw_lp_glpk(context, &few, &solver));
    bwi_lp_choose(&p.lp, solver, &choice);
    check_ok(context, bwi_lp_open(context, &p.lp, &choice, &workspace));
    check_fails(context, BW_CONVERGENCE, solver->name,
                bwi_lp_solve(context, &workspace, p.cost, &solution));
    bwi_lp_close(&workspace);
    bw_release(solver);
  }
  bw_free(share);
  program_close(&p);
}

/* A request to stop ends a solver that is at work. */
static void *cancel_soon(void *data) {
  struct timespec wait = {0, 150000000};
  nanosleep(&wait, NULL);
  bw_cancel((bw_context *)data);
  return NULL;
}

static void solvers_can_be_cancelled(void **state) {
  bw_context *context = check_context(state);
  enum { GROUPS = 4000, SIZE = 8 };
  bw_random random;
  bw_random_seed(&random, 7);
  random_program p;
  program_open(context, &p, &random, 7, GROUPS, SIZE); /* GLPK: many seconds */
  double *share = BW_NEW(context, double, GROUPS *SIZE), y[8];
  bwi_solution solution = {.fraction = share, .multiplier = y};
  for (int b = 0; b < LP_BACKENDS; b++) {
    bw_lp_solver *solver = lp_backend(context, b);
    bwi_lp_choice choice;
    bwi_lp_workspace workspace;
    pthread_t thread;
    bwi_lp_choose(&p.lp, solver, &choice);
    check_ok(context, bwi_lp_open(context, &p.lp, &choice, &workspace));
    if (b == 0)
      bw_cancel(context); /* ours ends too soon to be stopped in the middle */
    else
      assert_int_equal(pthread_create(&thread, NULL, cancel_soon, context), 0);
    double start = bw_seconds();
    assert_int_equal(bwi_lp_solve(context, &workspace, p.cost, &solution), BW_CANCELLED);
    assert_true(bw_seconds() - start < 2);
    if (b == 1)
      pthread_join(thread, NULL);
    bw_clear_cancel(context);
    bwi_lp_close(&workspace);
    bw_release(solver);
  }
  bw_free(share);
  program_close(&p);
}

/* GLPK aborts where memory ends. The abort is caught, and its environment goes, with the limit that
 * was set on it: the next attempt succeeds. */
static void an_abort_of_glpk_is_caught(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 8);
  random_program p;
  program_open(context, &p, &random, 7, 40000, 1);
  double *share = BW_NEW(context, double, 40000), y[8];
  bwi_solution solution = {.fraction = share, .multiplier = y};
  bw_lp_solver *solver = lp_backend(context, 1);
  bwi_lp_choice choice;
  bwi_lp_workspace workspace;
  bwi_lp_choose(&p.lp, solver, &choice);
  glp_init_env();
  glp_mem_limit(1);
  check_ok(context, bwi_lp_open(context, &p.lp, &choice, &workspace));
  check_ok(context, bwi_lp_solve(context, &workspace, p.cost, &solution));
  assert_non_null(strstr(bw_message(context), "GLPK failed"));
  assert_true(solution.gap < 1e-8);
  bwi_lp_close(&workspace);
  bw_free(share);
  bw_release(solver);
  program_close(&p);
}

/* A program that uses GLPK itself keeps its problem and its terminal. */
static void environments_of_others_are_left_alone(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 9);
  random_program p;
  program_open(context, &p, &random, 3, 20, 1);
  glp_prob *theirs = glp_create_prob();
  glp_set_prob_name(theirs, "theirs");
  glp_term_out(GLP_OFF);
  bw_lp_solver *solver = lp_backend(context, 1);
  bwi_lp_choice choice;
  bwi_lp_workspace workspace;
  double share[20], y[8];
  bwi_solution solution = {.fraction = share, .multiplier = y};
  bwi_lp_choose(&p.lp, solver, &choice);
  check_ok(context, bwi_lp_open(context, &p.lp, &choice, &workspace));
  check_ok(context, bwi_lp_solve(context, &workspace, p.cost, &solution));
  bwi_lp_close(&workspace);
  assert_string_equal(glp_get_prob_name(theirs), "theirs");
  assert_int_equal(glp_term_out(GLP_OFF), GLP_OFF);
  glp_delete_prob(theirs);
  glp_free_env();
  bw_release(solver);
  program_close(&p);
}

/* The bound is at least every feasible value, and the greedy filling (optimal) attains it. */
static void knapsack_bounds(void **state) {
  (void)state;
  enum { N = 40 };
  bw_random random;
  bw_random_seed(&random, 10);
  for (int turn = 0; turn < 50; turn++) {
    double gain[N], upper[N], capacity = 1, greedy = 0, range = 0;
    bool used[N] = {false};
    for (int j = 0; j < N; j++) {
      gain[j] = 2 * bw_random_uniform(&random) - 1;
      upper[j] = 0.01 + 0.1 * bw_random_uniform(&random);
      range = fmax(range, fabs(gain[j]));
    }
    while (capacity > 0) {
      int best = -1;
      for (int j = 0; j < N; j++)
        if (!used[j] && (best < 0 || gain[j] > gain[best]))
          best = j;
      assert_true(best >= 0);
      double t = fmin(capacity, upper[best]);
      greedy += t * gain[best];
      capacity -= t;
      used[best] = true;
    }
    double close = bwi_knapsack(N, gain, upper, 48), rough = bwi_knapsack(N, gain, upper, 6);
    check_near(close, greedy, 1e-12);
    assert_true(close >= greedy - 1e-12 && rough >= greedy - 1e-12);
    assert_true(rough <= greedy + 2 * range / 64 * 2);
  }
}

check_main(check_test(each_backend_finds_the_best_vertex), check_test(a_limit_of_iterations_holds),
           check_test(solvers_can_be_cancelled), check_test(an_abort_of_glpk_is_caught),
           check_test(environments_of_others_are_left_alone), check_test(knapsack_bounds))
