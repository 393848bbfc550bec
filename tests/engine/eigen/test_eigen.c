/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The eigensolvers by themselves, on diagonal problems whose every eigenpair is known: high
 * multiplicity, partners hidden from the start vectors, exhausted spaces, runs that are cancelled,
 * threads beside each other. Each test runs once for each of them. */
#include "bodies.h"

#include <pthread.h>

#include "eigen/internal.h"

static const bw_eigensolver_kind kinds[] = {BW_EIGENSOLVER_LANCZOS, BW_EIGENSOLVER_ARPACK,
                                            BW_EIGENSOLVER_LOBPCG};
enum { KINDS = sizeof kinds / sizeof *kinds };

typedef struct diagonal {
  int64_t size;
  const double *value;
  const uint8_t *hide; /* components kept out of the first random block; NULL: none */
  int projections;
  int counts;     /* Sturm counts asked for */
  int solves;     /* right-hand sides */
  int cancel_at;  /* that of a solve in which the run is cancelled; 0: none */
  bool uncounted; /* there is no count */
  bool rough;     /* there is no inverse, but a preconditioner */
} diagonal;

static bw_status divide(bw_context *context, void *data, int64_t count, const double *f,
                        double *y) {
  diagonal *d = data;
  d->solves += (int)count;
  if (d->cancel_at > 0 && d->solves >= d->cancel_at)
    bw_cancel(context);
  for (int64_t k = 0; k < count; k++)
    for (int64_t i = 0; i < d->size; i++)
      y[k * d->size + i] = f[k * d->size + i] / d->value[i];
  return BW_OK;
}
/* Within a factor of three of the inverse. */
static bw_status rough(bw_context *context, void *data, int64_t count, const double *f, double *y) {
  const diagonal *d = data;
  bw_status status = divide(context, data, count, f, y);
  for (int64_t k = 0; k < count; k++)
    for (int64_t i = 0; i < d->size; i++)
      y[k * d->size + i] *= 1 + (double)(i % 3);
  return status;
}
static bw_status copy(bw_context *context, void *data, int64_t count, const double *x, double *y) {
  (void)context;
  memcpy(y, x, (size_t)(count * ((diagonal *)data)->size) * sizeof(double));
  return BW_OK;
}
static bw_status times(bw_context *context, void *data, int64_t count, const double *x, double *y) {
  (void)context;
  const diagonal *d = data;
  for (int64_t k = 0; k < count; k++)
    for (int64_t i = 0; i < d->size; i++)
      y[k * d->size + i] = x[k * d->size + i] * d->value[i];
  return BW_OK;
}
static bw_status hide(bw_context *context, void *data, int64_t count, double *x) {
  (void)context;
  diagonal *d = data;
  if (d->projections++ == 0 && d->hide)
    for (int64_t k = 0; k < count; k++)
      for (int64_t i = 0; i < d->size; i++)
        if (d->hide[i])
          x[k * d->size + i] = 0;
  return BW_OK;
}
static bw_status below(bw_context *context, void *data, double sigma, int64_t *count,
                       bool *trusted) {
  (void)context;
  diagonal *d = data;
  *count = 0;
  for (int64_t i = 0; i < d->size; i++)
    *count += d->value[i] < sigma;
  *trusted = true;
  d->counts++;
  return BW_OK;
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

static bw_eigensolver *eigensolver(bw_context *context, bw_eigensolver_kind kind) {
  bw_eigensolver *solver = NULL;
  bw_eigensolver_options options;
  bw_eigensolver_options_default(&options);
  options.kind = kind;
  check_ok(context, bw_eigensolver_create(context, &options, &solver));
  return solver;
}

static bw_status lowest(bw_context *context, diagonal *d, const bw_eigensolver *solver, int count,
                        bwi_eigen_result *result) {
  bwi_eigen_problem problem = {.size = d->size,
                               .data = d,
                               .solve = divide,
                               .mass = copy,
                               .stiffness = times,
                               .project = hide,
                               .below = below,
                               .dimension = d->size};
  if (d->uncounted)
    problem.below = NULL;
  if (d->rough) {
    problem.solve = NULL;
    problem.precondition = rough;
    problem.preconditioner = "rough";
  }
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = count;
  options.solver = solver;
  return bwi_eigen_lowest(context, &problem, &options, result);
}

static void solve(bw_context *context, diagonal *d, bw_eigensolver_kind kind, int count,
                  bwi_eigen_result *result) {
  bw_eigensolver *solver = eigensolver(context, kind);
  check_ok(context, lowest(context, d, solver, count, result));
  if (d->size > 500) /* a smaller space may be too small for ARPACK */
    assert_string_equal(result->report.solver, bw_eigensolver_name(solver));
  bw_release(solver);
  assert_int_equal(result->count, count < d->size ? count : d->size);
  double *sorted = numbers(d->size);
  memcpy(sorted, d->value, (size_t)d->size * sizeof(double));
  qsort(sorted, (size_t)d->size, sizeof *sorted, ascending);
  for (int i = 0; i < result->count; i++) {
    check_near(result->value[i], sorted[i], 1e-10 * sorted[i]);
    assert_true(result->residual[i] < 1e-7);
    for (int j = 0; j <= i; j++) {
      double dot = 0;
      for (int64_t k = 0; k < d->size; k++)
        dot += result->vector[i * d->size + k] * result->vector[j * d->size + k];
      check_near(dot, i == j, 1e-9);
    }
  }
  assert_true(result->counted);
  free(sorted);
}

static void simple_spectrum(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 3000 };
  double *value = numbers(SIZE);
  for (int i = 0; i < SIZE; i++)
    value[i] = 1 + pow(i, 1.5);
  for (int k = 0; k < KINDS; k++) {
    diagonal d = {.size = SIZE, .value = value};
    bwi_eigen_result result;
    solve(context, &d, kinds[k], 15, &result);
    assert_int_equal(result.recovered, 0);
    assert_int_equal(d.counts, 1);
    bwi_eigen_result_clear(&result);
  }
  free(value);
}

/* Multiplicity 12: more than the block holds. */
static void multiplicity_beyond_the_block(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 2000 };
  double *value = numbers(SIZE);
  for (int i = 0; i < SIZE; i++)
    value[i] = 1 + i / 12;
  for (int k = 0; k < KINDS; k++) {
    diagonal d = {.size = SIZE, .value = value};
    bwi_eigen_result result;
    solve(context, &d, kinds[k], 12, &result);
    bwi_eigen_result_clear(&result);
    solve(context, &d, kinds[k], 20, &result); /* the last one in the middle of a cluster */
    /* without a mesh fields are weighted by number, whose eigenvectors are single numbers */
    for (int i = 0; i < 20; i++)
      check_near(fabs(result.vector[i * SIZE + i]), 1, 1e-6);
    assert_null(strstr(result.report.reason, "last frequency"));
    bwi_eigen_result_clear(&result);
  }
  for (int i = 0; i < SIZE; i++)
    value[i] = 1 + i / 18;
  for (int k = 0; k < KINDS; k++) { /* too many to be completed */
    diagonal d = {.size = SIZE, .value = value};
    bwi_eigen_result result;
    solve(context, &d, kinds[k], 2, &result);
    assert_non_null(strstr(result.report.reason, "more modes may have the last frequency"));
    bwi_eigen_result_clear(&result);
  }
  free(value);
}

/* Where nothing counts, the others of the last one's cluster are found one after the other. */
static void multiplicity_uncounted(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 2000 };
  double *value = numbers(SIZE);
  for (int i = 0; i < SIZE; i++)
    value[i] = 1 + i / 12;
  bw_eigensolver *solver = eigensolver(context, BW_EIGENSOLVER_LOBPCG);
  for (int count = 1; count < 12; count++) {
    diagonal d = {.size = SIZE, .value = value, .uncounted = true, .rough = true};
    bwi_eigen_result result;
    check_ok(context, lowest(context, &d, solver, count, &result));
    for (int i = 0; i < count; i++)
      check_near(fabs(result.vector[i * SIZE + i]), 1, 1e-6);
    assert_null(strstr(result.report.reason, "last frequency"));
    bwi_eigen_result_clear(&result);
  }
  bw_release(solver);
  free(value);
}

/* A pair nearer to each other than the tolerance of 1e-8 is one eigenvalue, and one that residuals
 * tell apart is two, for each eigensolver, whether the last mode wanted is one of it or not. */
static void nearly_equal(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 1000 };
  static const double apart[] = {0, 1e-9, 9e-9, 1e-7, 1e-6, 1e-4, 9e-4};
  double *value = numbers(SIZE);
  for (size_t a = 0; a < sizeof apart / sizeof *apart; a++)
    for (int k = 0; k < 2 * KINDS; k++) {
      bool last = k < KINDS;
      diagonal d = {.size = SIZE,
                    .value = value,
                    .uncounted = kinds[k % KINDS] == BW_EIGENSOLVER_LOBPCG,
                    .rough = kinds[k % KINDS] == BW_EIGENSOLVER_LOBPCG};
      for (int i = 0; i < SIZE; i++)
        value[i] = 1 + 0.1 * (i == 6 ? 5 : i);
      value[6] *= 1 + apart[a];
      bwi_eigen_result result;
      bw_eigensolver *solver = eigensolver(context, kinds[k % KINDS]);
      check_ok(context, lowest(context, &d, solver, last ? 6 : 8, &result));
      double mean = apart[a] < 1e-8 ? 0.5 * (value[5] + value[6]) : value[5];
      check_near(result.value[5], mean, 1e-12);
      for (int i = 0; i < result.count; i++)
        check_near(fabs(result.vector[i * SIZE + i]), 1, 1e-6);
      bw_release(solver);
      bwi_eigen_result_clear(&result);
    }
  free(value);
}

/* Multiplicity 40: as 40 equal pieces have. The count calls for more than a basis for 15 holds. */
static void many_equal_pieces(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 2000 };
  double *value = numbers(SIZE);
  for (int i = 0; i < SIZE; i++)
    value[i] = 1 + i / 40;
  for (int k = 0; k < KINDS; k++)
    for (int count = 15; count <= 45; count += 15) {
      diagonal d = {.size = SIZE, .value = value};
      bwi_eigen_result result;
      solve(context, &d, kinds[k], count, &result);
      bwi_eigen_result_clear(&result);
    }
  free(value);
}

/* Two partners that the first start vectors do not contain at all: the count calls for them. */
static void hidden_partners(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 1500 };
  double *value = numbers(SIZE);
  uint8_t *mask = calloc(SIZE, 1);
  for (int i = 0; i < SIZE; i++)
    value[i] = 3 + i;
  value[4] = value[3];
  mask[4] = mask[7] = 1;
  for (int k = 0; k < KINDS; k++) {
    diagonal d = {.size = SIZE, .value = value, .hide = mask};
    bwi_eigen_result result;
    solve(context, &d, kinds[k], 10, &result);
    assert_int_equal(result.recovered, 2);
    bwi_eigen_result_clear(&result);
  }
  free(value);
  free(mask);
}

/* Spaces as small as what is asked for, and smaller. */
static void small_spaces(void **state) {
  bw_context *context = check_context(state);
  for (int k = 0; k < KINDS; k++)
    for (int64_t size = 1; size <= 151; size += size < 40 ? 3 : 10) {
      double *value = numbers(size);
      for (int64_t i = 0; i < size; i++)
        value[i] = 1 + (double)(i % 5);
      diagonal d = {.size = size, .value = value};
      bwi_eigen_result result;
      solve(context, &d, kinds[k], 15, &result);
      bwi_eigen_result_clear(&result);
      free(value);
    }
}

/* Whatever ran before in the process: Krylov spaces that close, so that random vectors are taken in
 * the midst of a run. */
static void same_bits_again(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 600, RUNS = 3 };
  double *value = numbers(SIZE);
  for (int i = 0; i < SIZE; i++)
    value[i] = 1 + i / 20;
  for (int k = 0; k < KINDS; k++) {
    bwi_eigen_result result[RUNS];
    for (int run = 0; run < RUNS; run++) {
      diagonal d = {.size = SIZE, .value = value};
      solve(context, &d, kinds[k], 25, &result[run]);
      assert_memory_equal(result[run].vector, result[0].vector, 25 * SIZE * sizeof(double));
    }
    for (int run = 0; run < RUNS; run++)
      bwi_eigen_result_clear(&result[run]);
  }
  free(value);
}

static void cancelled(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 3000 };
  double *value = numbers(SIZE);
  for (int i = 0; i < SIZE; i++)
    value[i] = 1 + i;
  for (int k = 0; k < KINDS; k++) {
    bw_eigensolver *solver = eigensolver(context, kinds[k]);
    diagonal d = {.size = SIZE, .value = value, .cancel_at = 20};
    bwi_eigen_result result;
    check_fails(context, BW_CANCELLED, "", lowest(context, &d, solver, 15, &result));
    assert_true(d.solves < 40);
    bw_release(solver);
    bw_clear_cancel(context);
    d = (diagonal){.size = SIZE, .value = value}; /* nothing is left locked */
    solve(context, &d, kinds[k], 15, &result);
    bwi_eigen_result_clear(&result);
  }
  free(value);
}

typedef struct reports {
  bw_context *context;
  int count, last;
} reports;

static void report(void *data, const char *stage, double fraction) {
  reports *r = data;
  (void)stage;
  (void)fraction;
  if (++r->count == r->last)
    bw_cancel(r->context);
}

/* Whoever is shown the last report, and cancels then, gets no modes. */
static void cancelled_at_the_last_report(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 300 };
  double *value = numbers(SIZE);
  for (int i = 0; i < SIZE; i++)
    value[i] = 1 + i;
  for (int k = 0; k < KINDS; k++) {
    bw_eigensolver *solver = eigensolver(context, kinds[k]);
    reports r = {.context = context};
    bwi_eigen_result result;
    bw_set_progress(context, report, &r);
    diagonal d = {.size = SIZE, .value = value};
    check_ok(context, lowest(context, &d, solver, 5, &result));
    bwi_eigen_result_clear(&result);
    assert_true(r.count > 0);
    r = (reports){.context = context, .last = r.count};
    d = (diagonal){.size = SIZE, .value = value};
    check_fails(context, BW_CANCELLED, "", lowest(context, &d, solver, 5, &result));
    assert_int_equal(r.count, r.last);
    bw_set_progress(context, NULL, NULL);
    bw_clear_cancel(context);
    bw_release(solver);
  }
  free(value);
}

typedef struct beside {
  diagonal d;
  bw_eigensolver_kind kind;
  bwi_eigen_result result;
} beside;

static void *run_beside(void *data) {
  beside *b = data;
  bw_context *context = bw_context_create();
  solve(context, &b->d, b->kind, 15, &b->result);
  bw_context_destroy(context);
  return NULL;
}

/* Runs in several threads at once have the bits of runs one after the other. */
static void threads_beside_each_other(void **state) {
  (void)state;
  enum { SIZE = 4000, THREADS = 4 };
  double *value = numbers(SIZE);
  for (int i = 0; i < SIZE; i++)
    value[i] = 1 + pow(i, 1.3);
  for (int k = 0; k < KINDS; k++) {
    beside all[THREADS + 1];
    pthread_t thread[THREADS];
    for (int i = 0; i <= THREADS; i++)
      all[i] = (beside){.d = {.size = SIZE, .value = value}, .kind = kinds[k]};
    run_beside(&all[THREADS]);
    for (int i = 0; i < THREADS; i++)
      assert_int_equal(pthread_create(&thread[i], NULL, run_beside, &all[i]), 0);
    for (int i = 0; i < THREADS; i++)
      pthread_join(thread[i], NULL);
    for (int i = 0; i < THREADS; i++)
      assert_memory_equal(all[i].result.vector, all[THREADS].result.vector,
                          15 * SIZE * sizeof(double));
    for (int i = 0; i <= THREADS; i++)
      bwi_eigen_result_clear(&all[i].result);
  }
  free(value);
}

/* LOBPCG with a preconditioner that is no inverse, and nothing that counts. Partners that its start
 * does not contain are found by the test with random vectors. */
static void without_a_factor(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 3000 };
  double *value = numbers(SIZE);
  uint8_t *mask = calloc(SIZE, 1);
  for (int i = 0; i < SIZE; i++)
    value[i] = 3 + i / 2; /* all double */
  mask[4] = mask[7] = mask[8] = mask[9] = 1;
  for (int hidden = 0; hidden < 2; hidden++) {
    bw_eigensolver *solver = eigensolver(context, BW_EIGENSOLVER_LOBPCG);
    diagonal d = {.size = SIZE,
                  .value = value,
                  .hide = hidden ? mask : NULL,
                  .uncounted = true,
                  .rough = true};
    bwi_eigen_result result;
    check_ok(context, lowest(context, &d, solver, 15, &result));
    for (int i = 0; i < 15; i++)
      check_near(result.value[i], value[i], 1e-10 * value[i]);
    assert_string_equal(result.report.preconditioner, "rough");
    assert_true(result.report.residual <= 1e-8);
    assert_false(result.counted);
    assert_true(result.tested);
    assert_true(hidden ? result.recovered > 0 : result.recovered == 0);
    bwi_eigen_result_clear(&result);
    bw_release(solver);
  }
  free(value);
  free(mask);
}

static void refused(void **state) {
  bw_context *context = check_context(state);
  bw_eigensolver *solver = NULL;
  bw_eigensolver_options options;
  bw_eigensolver_options_default(&options);
  options.kind = (bw_eigensolver_kind)99;
  check_fails(context, BW_INVALID, "eigensolver 99",
              bw_eigensolver_create(context, &options, &solver));
  bw_eigensolver_options_default(&options);
  options.basis = -1;
  check_fails(context, BW_INVALID, "basis of -1",
              bw_eigensolver_create(context, &options, &solver));
  bw_eigensolver_options_default(&options);
  const bw_solver factor = {.options = {.backend = BW_BACKEND_PETSC}};
  options.inner = &factor;
  check_fails(context, BW_INVALID, "has no inner systems",
              bw_eigensolver_create(context, &options, &solver));
  double value[100];
  for (int i = 0; i < 100; i++)
    value[i] = 1 + i;
  for (int k = 0; k < KINDS && kinds[k] != BW_EIGENSOLVER_LOBPCG; k++) {
    diagonal d = {.size = 100, .value = value};
    bwi_eigen_result result;
    bw_eigensolver_options_default(&options);
    options.kind = kinds[k];
    options.basis = 16;
    check_ok(context, bw_eigensolver_create(context, &options, &solver));
    check_fails(context, BW_INVALID, "too small for 15 modes",
                lowest(context, &d, solver, 15, &result));
    bw_release(solver);
    options.basis = 45;
    check_ok(context, bw_eigensolver_create(context, &options, &solver));
    check_ok(context, lowest(context, &d, solver, 15, &result));
    check_near(result.value[14], 15, 1e-9);
    bw_release(solver);
    bwi_eigen_result_clear(&result);
  }
}

/* The orders of dense matrices are counted in 32 bits. */
static void too_many_modes(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 200000 };
  double *value = numbers(SIZE);
  for (int i = 0; i < SIZE; i++)
    value[i] = 1 + i;
  for (int k = 0; k < KINDS; k++) {
    bw_eigensolver *solver = eigensolver(context, kinds[k]);
    diagonal d = {.size = SIZE, .value = value};
    bwi_eigen_result result;
    check_fails(context, BW_LIMIT, "more than", lowest(context, &d, solver, 30000, &result));
    bw_release(solver);
  }
  free(value);
}

check_main(check_test(simple_spectrum), check_test(multiplicity_beyond_the_block),
           check_test(multiplicity_uncounted), check_test(nearly_equal),
           check_test(many_equal_pieces), check_test(hidden_partners), check_test(small_spaces),
           check_test(same_bits_again), check_test(cancelled),
           check_test(cancelled_at_the_last_report), check_test(threads_beside_each_other),
           check_test(without_a_factor), check_test(refused), check_test(too_many_modes))
