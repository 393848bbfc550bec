/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Conjugate gradients on small matrices whose solutions are known: as many iterations as there are
 * different eigenvalues, right-hand sides side by side as one by one, first guesses, singular
 * matrices by a projector, breakdown, prediction, and cancelling. */
#include "linear/pcg_space.h"

#include "check.h"

enum { N = 60, SIDES = 5 };

/* A = tridiagonal (-1, d, -1), or with `values` their diagonal matrix. */
typedef struct problem {
  double d;
  bool ends; /* d - 1 at both: with d = 2 the constant is the null space */
  const double *values;
  int products, applications;
  bool sided; /* the preconditioner is not quite symmetric */
} problem;

static bw_status multiply(bw_context *context, void *data, int64_t count, const double *x,
                          double *y) {
  problem *a = data;
  (void)context;
  a->products++;
  for (int64_t k = 0; k < count; k++, x += N, y += N)
    for (int i = 0; i < N; i++) {
      double d = a->d - (a->ends && (i == 0 || i == N - 1));
      y[i] = a->values ? a->values[i] * x[i]
                       : d * x[i] - (i > 0 ? x[i - 1] : 0) - (i < N - 1 ? x[i + 1] : 0);
    }
  return BW_OK;
}

static bw_status precondition(bw_context *context, void *data, int64_t count, const double *r,
                              double *z) {
  problem *a = data;
  (void)context;
  a->applications++;
  for (int64_t i = 0; i < count * N; i++)
    z[i] = r[i] * (a->sided ? 1 + 0.02 * (double)(i % 3) : 1);
  for (int64_t i = 1; a->sided && i < count * N; i++)
    z[i] += i % N ? 0.02 * r[i - 1] : 0;
  return BW_OK;
}

static bw_status without_constant(bw_context *context, void *data, int64_t count, double *x) {
  (void)context;
  (void)data;
  for (int64_t k = 0; k < count; k++, x += N) {
    double mean = 0;
    for (int i = 0; i < N; i++)
      mean += x[i] / N;
    for (int i = 0; i < N; i++)
      x[i] -= mean;
  }
  return BW_OK;
}

static bwi_pcg_fields fields_of(problem *a) {
  return (bwi_pcg_fields){.size = N,
                          .multiply = multiply,
                          .multiply_data = a,
                          .precondition = precondition,
                          .precondition_data = a,
                          .symmetric = !a->sided};
}

static bwi_pcg_task task_of(int columns) {
  return (bwi_pcg_task){.columns = columns,
                        .energy_tolerance = 1e-11,
                        .residual_tolerance = 1e-11,
                        .energy_fall = BWI_ENERGY_FALLS,
                        .limit = 200};
}

static void random_numbers(uint64_t seed, int64_t count, double *x) {
  bw_random random;
  bw_random_seed(&random, seed);
  for (int64_t i = 0; i < count; i++)
    x[i] = 2 * bw_random_uniform(&random) - 1;
}

static double distance(const double *a, const double *b, int64_t count) {
  double sum = 0;
  for (int64_t i = 0; i < count; i++)
    sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sqrt(sum);
}

/* As many iterations as A has different eigenvalues (Saad, section 6.11.3). */
static void ends_with_the_spectrum(void **state) {
  bw_context *context = check_context(state);
  double values[N], b[N], x[N], exact[N];
  for (int different = 1; different <= 7; different += 3) {
    for (int i = 0; i < N; i++) {
      values[i] = 1 + 3 * (i % different);
      b[i] = 1 + 0.1 * i;
      exact[i] = b[i] / values[i];
    }
    problem a = {.values = values};
    const bwi_pcg_fields fields = fields_of(&a);
    bwi_pcg_task task = task_of(1);
    check_ok(context, bwi_pcg_fields_run(context, &fields, &task, b, x));
    assert_true(task.converged);
    assert_false(task.indefinite);
    assert_int_equal(task.iterations, different);
    check_near(distance(x, exact, N), 0, 1e-9);
  }
}

/* Of several columns each is as by itself, also those that end sooner; in their energies alone, and
 * with a preconditioner that is not quite symmetric. */
static void side_by_side(void **state) {
  bw_context *context = check_context(state);
  double b[SIDES * N], x[SIDES * N], one[N], product[N];
  for (int way = 0; way < 4; way++) {
    problem a = {.d = 2.05, .sided = way % 2 == 1};
    const bwi_pcg_fields fields = fields_of(&a);
    random_numbers(3, SIDES * N, b);
    memset(b + N, 0, N * sizeof *b); /* nothing to do */
    for (int i = 0; i < N; i++)      /* an eigenvector but for rounding: one iteration */
      b[2 * N + i] = sin((i + 1) * 3.14159265358979 / (N + 1));
    bwi_pcg_task task = task_of(SIDES);
    if (way >= 2) {
      task.residual_tolerance = INFINITY;
      task.energy_tolerance = 1e-7;
    }
    bwi_pcg_task alone = task;
    check_ok(context, bwi_pcg_fields_run(context, &fields, &task, b, x));
    assert_true(task.converged);
    assert_true(task.residual <= (way < 2 ? 1e-11 : 1e-4));
    int most = 0;
    for (int k = 0; k < SIDES; k++) {
      alone.columns = 1;
      check_ok(context, bwi_pcg_fields_run(context, &fields, &alone, b + k * N, one));
      assert_memory_equal(one, x + k * N, sizeof one);
      most = alone.iterations > most ? alone.iterations : most;
      check_ok(context, multiply(context, &a, 1, one, product));
      check_near(distance(product, b + k * N, N), 0, way < 2 ? 1e-9 : 1e-4);
    }
    assert_int_equal(task.iterations, most);
  }
}

/* A space of its own, whose columns stay: A is diagonal, M = 1. */
typedef struct kept {
  int columns, residuals;
  double a[N], b[SIDES][N], x[SIDES][N], r[SIDES][N], p[SIDES][N], q[SIDES][N];
} kept;

static bw_status kept_residual(bw_context *context, void *data, const bool *wanted,
                               double *r_dot_r) {
  (void)context;
  kept *s = data;
  s->residuals++;
  for (int k = 0; k < s->columns; k++) {
    r_dot_r[k] = 0;
    for (int i = 0; wanted[k] && i < N; i++) {
      s->r[k][i] = s->b[k][i] - s->a[i] * s->x[k][i];
      r_dot_r[k] += s->r[k][i] * s->r[k][i];
    }
  }
  return BW_OK;
}

static bw_status kept_precondition(bw_context *context, void *data, double *r_dot_z,
                                   double *z_dot_q) {
  (void)context;
  const kept *s = data;
  assert_null(z_dot_q);
  for (int k = 0; k < s->columns; k++) {
    r_dot_z[k] = 0;
    for (int i = 0; i < N; i++)
      r_dot_z[k] += s->r[k][i] * s->r[k][i];
  }
  return BW_OK;
}

static bw_status kept_multiply(bw_context *context, void *data, const double *beta,
                               double *p_dot_q) {
  (void)context;
  kept *s = data;
  for (int k = 0; k < s->columns; k++) {
    p_dot_q[k] = 0;
    for (int i = 0; i < N; i++) {
      s->p[k][i] = s->r[k][i] + beta[k] * s->p[k][i];
      s->q[k][i] = s->a[i] * s->p[k][i];
      p_dot_q[k] += s->p[k][i] * s->q[k][i];
    }
  }
  return BW_OK;
}

static bw_status kept_advance(bw_context *context, void *data, const double *alpha,
                              double *r_dot_r) {
  (void)context;
  kept *s = data;
  for (int k = 0; k < s->columns; k++) {
    r_dot_r[k] = 0;
    for (int i = 0; i < N; i++) {
      s->x[k][i] += alpha[k] * s->p[k][i];
      s->r[k][i] -= alpha[k] * s->q[k][i];
      r_dot_r[k] += s->r[k][i] * s->r[k][i];
    }
  }
  return BW_OK;
}

/* Columns that stay end after as many iterations as their right-hand sides have eigenvectors, and
 * one product at the end computes the residuals of all. */
static void one_check_serves_all(void **state) {
  bw_context *context = check_context(state);
  static kept s;
  s = (kept){.columns = SIDES};
  for (int i = 0; i < N; i++)
    s.a[i] = 1 + i;
  for (int k = 0; k < SIDES; k++)
    for (int i = 0; i <= k; i++)
      s.b[k][3 * i] = 1;
  const bwi_pcg_space space = {.data = &s,
                               .residual = kept_residual,
                               .precondition = kept_precondition,
                               .multiply = kept_multiply,
                               .advance = kept_advance,
                               .symmetric = true};
  bwi_pcg_task task = task_of(SIDES);
  check_ok(context, bwi_pcg_run(context, &space, &task));
  assert_true(task.converged);
  assert_true(task.residual <= 1e-11);
  assert_int_equal(task.iterations, SIDES);
  assert_int_equal(s.residuals, 2); /* the first, and that of all */
  for (int k = 0; k < SIDES; k++)
    for (int i = 0; i < N; i++)
      check_near(s.x[k][i], s.b[k][i] / s.a[i], 1e-10);
}

/* A first guess, and tolerances that are relative to another right-hand side. */
static void first_guess(void **state) {
  bw_context *context = check_context(state);
  problem a = {.d = 2.05};
  double b[N], x[N], from[N], product[N];
  random_numbers(5, N, b);
  bwi_pcg_fields fields = fields_of(&a);
  bwi_pcg_task task = task_of(1);
  check_ok(context, bwi_pcg_fields_run(context, &fields, &task, b, x));
  bwi_pcg_task near = task_of(1);
  near.energy_tolerance = INFINITY;
  near.residual_tolerance = 1e-6;
  memcpy(from, x, sizeof x);
  from[7] += 1e-3;
  double load, squares = 0;
  for (int i = 0; i < N; i++)
    squares += b[i] * b[i];
  load = sqrt(squares);
  near.load = &load;
  fields.guess = true;
  check_ok(context, bwi_pcg_fields_run(context, &fields, &near, b, from));
  assert_true(near.converged);
  assert_in_range(near.iterations, 1, task.iterations / 2);
  check_ok(context, multiply(context, &a, 1, from, product));
  check_near(distance(product, b, N), 0, 1e-6 * load);
  near.iterations = -1; /* begun at the solution */
  check_ok(context, bwi_pcg_fields_run(context, &fields, &near, b, from));
  assert_int_equal(near.iterations, 0);
}

/* A singular matrix whose null space the right-hand side meets has no solution; the projector makes
 * it one. */
static void projector(void **state) {
  bw_context *context = check_context(state);
  problem a = {.d = 2, .ends = true};
  double b[N], x[N], product[N];
  random_numbers(9, N, b);
  for (int with = 0; with < 2; with++) {
    bwi_pcg_fields fields = fields_of(&a);
    bwi_pcg_task task = task_of(1);
    fields.project = with ? without_constant : NULL;
    check_ok(context, bwi_pcg_fields_run(context, &fields, &task, b, x));
    assert_int_equal(task.converged, with);
  }
  check_ok(context, multiply(context, &a, 1, x, product));
  check_ok(context, without_constant(context, NULL, 1, b));
  check_near(distance(product, b, N), 0, 1e-9);
}

/* An indefinite matrix or preconditioner ends the iteration, with what was reached before. */
static void breakdown(void **state) {
  bw_context *context = check_context(state);
  double values[N], b[2 * N], x[2 * N];
  for (int i = 0; i < N; i++)
    values[i] = i == 3 ? -1 : 1 + i;
  random_numbers(11, 2 * N, b);
  problem a = {.values = values};
  const bwi_pcg_fields fields = fields_of(&a);
  bwi_pcg_task task = task_of(2);
  check_ok(context, bwi_pcg_fields_run(context, &fields, &task, b, x));
  assert_false(task.converged);
  assert_true(task.indefinite);
  assert_true(task.residual > 0);
  for (int i = 0; i < 2 * N; i++)
    assert_true(isfinite(x[i]) != 0);
}

/* Where the rate says that more iterations are to come than allowed, it gives up, and says how
 * many; a limit holds. */
static void predicts(void **state) {
  bw_context *context = check_context(state);
  double values[N], b[N], x[N];
  for (int i = 0; i < N; i++)
    values[i] = pow(1.3, i);
  random_numbers(13, N, b);
  problem a = {.values = values};
  const bwi_pcg_fields fields = fields_of(&a);
  bwi_pcg_task task = task_of(1);
  task.max_remaining = 5;
  check_ok(context, bwi_pcg_fields_run(context, &fields, &task, b, x));
  assert_false(task.converged);
  assert_false(task.indefinite);
  assert_true(task.predicted_iterations > task.iterations + 5);
  task = task_of(1);
  task.limit = 4;
  check_ok(context, bwi_pcg_fields_run(context, &fields, &task, b, x));
  assert_int_equal(task.iterations, 4);
  assert_false(task.converged);
}

typedef struct caller {
  bw_context *context;
  int calls, last;
} caller;

static void cancel(void *data, const char *stage, double fraction) {
  caller *c = data;
  (void)stage;
  (void)fraction;
  if (++c->calls == c->last)
    bw_cancel(c->context);
}

/* At the fourth iteration, and at one that is the only one and would converge. */
static void is_cancelled(void **state) {
  bw_context *context = check_context(state);
  double b[N], x[N], values[N];
  random_numbers(5, N, b);
  for (int i = 0; i < N; i++)
    values[i] = 2;
  problem a[2] = {{.d = 2.05}, {.values = values}};
  const int last[2] = {4, 1};
  for (int k = 0; k < 2; k++) {
    caller c = {context, 0, last[k]};
    const bwi_pcg_fields fields = fields_of(&a[k]);
    bwi_pcg_task task = task_of(1);
    task.progress = true;
    bw_set_progress(context, cancel, &c);
    check_fails(context, BW_CANCELLED, "", bwi_pcg_fields_run(context, &fields, &task, b, x));
    bw_set_progress(context, NULL, NULL);
    bw_clear_cancel(context);
    assert_int_equal(task.iterations, last[k]);
  }
}

check_main(check_test(ends_with_the_spectrum), check_test(side_by_side),
           check_test(one_check_serves_all), check_test(first_guess), check_test(projector),
           check_test(breakdown), check_test(predicts), check_test(is_cancelled))
