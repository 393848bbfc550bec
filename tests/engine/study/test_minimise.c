/* Minimisers against problems whose optimum is published: Rosenbrock's valley and problems of Hock
 * and Schittkowski's collection (Test Examples for Nonlinear Programming Codes, 1981). */
#include "check.h"

typedef struct problem {
  const char *name;
  int n, constraints;
  double start[10], min[10], max[10];
  double optimum;
  double (*value)(int which, const double *x, double *gradient);
} problem;

static double rosenbrock(int which, const double *x, double *g) {
  (void)which;
  double a = x[1] - x[0] * x[0], b = 1 - x[0];
  if (g) {
    g[0] = -400 * x[0] * a - 2 * b;
    g[1] = 200 * a;
  }
  return 100 * a * a + b * b;
}

/* 24: f* = -1 at (3, sqrt(3)) */
static double hock24(int which, const double *x, double *g) {
  double r = sqrt(3), u = x[0] - 3;
  switch (which) {
  case 0:
    if (g) {
      g[0] = 2 * u * x[1] * x[1] * x[1] / (27 * r);
      g[1] = (u * u - 9) * 3 * x[1] * x[1] / (27 * r);
    }
    return (u * u - 9) * x[1] * x[1] * x[1] / (27 * r);
  case 1:
    if (g) {
      g[0] = -1 / r;
      g[1] = 1;
    }
    return -(x[0] / r - x[1]);
  case 2:
    if (g) {
      g[0] = -1;
      g[1] = -r;
    }
    return -(x[0] + r * x[1]);
  default:
    if (g) {
      g[0] = 1;
      g[1] = r;
    }
    return x[0] + r * x[1] - 6;
  }
}

/* 43 (Rosen and Suzuki): f* = -44 at (0, 1, 2, -1) */
static double hock43(int which, const double *x, double *g) {
  static const double square[4][4] = {{1, 1, 2, 1}, {1, 1, 1, 1}, {1, 2, 1, 2}, {2, 1, 1, 0}};
  static const double linear[4][4] = {
      {-5, -5, -21, 7}, {1, -1, 1, -1}, {-1, 0, 0, -1}, {2, -1, 0, -1}};
  static const double constant[4] = {0, -8, -10, -5};
  double sum = constant[which];
  for (int i = 0; i < 4; i++) {
    sum += square[which][i] * x[i] * x[i] + linear[which][i] * x[i];
    if (g)
      g[i] = 2 * square[which][i] * x[i] + linear[which][i];
  }
  return sum;
}

/* 76: f* = -4.681818181 */
static double hock76(int which, const double *x, double *g) {
  static const double row[3][4] = {{1, 2, 1, 1}, {3, 1, 2, -1}, {0, -1, -4, 0}};
  static const double max[3] = {5, 4, -1.5};
  if (which == 0) {
    if (g) {
      g[0] = 2 * x[0] - x[2] - 1;
      g[1] = x[1] - 3;
      g[2] = -x[0] + 2 * x[2] + x[3] + 1;
      g[3] = x[2] + x[3] - 1;
    }
    return x[0] * x[0] + 0.5 * x[1] * x[1] + x[2] * x[2] + 0.5 * x[3] * x[3] - x[0] * x[2] +
           x[2] * x[3] - x[0] - 3 * x[1] + x[2] - x[3];
  }
  double sum = -max[which - 1];
  for (int i = 0; i < 4; i++) {
    sum += row[which - 1][i] * x[i];
    if (g)
      g[i] = row[which - 1][i];
  }
  return sum;
}

static const problem valley = {"Rosenbrock", 2, 0, {-1.2, 1}, {-5, -5}, {5, 5}, 0, rosenbrock};
static const problem hock[] = {
    {"HS24", 2, 3, {1, 0.5}, {0, 0}, {100, 100}, -1, hock24},
    {"HS43", 4, 3, {0, 0, 0, 0}, {-10, -10, -10, -10}, {10, 10, 10, 10}, -44, hock43},
    {"HS76",
     4,
     3,
     {0.5, 0.5, 0.5, 0.5},
     {0, 0, 0, 0},
     {10, 10, 10, 10},
     -4.681818181818182,
     hock76},
};

typedef struct asked {
  const problem *problem;
  int calls, fail_at; /* 0: never */
  double wrong;       /* returned at fail_at instead, when it is not 0 */
} asked;

static bw_status ask(bw_context *context, void *data, int which, const double *x, double *value,
                     double *gradient) {
  asked *a = (asked *)data;
  assert_true(a->fail_at == 0 || a->calls < a->fail_at); /* nothing is asked after a failure */
  *value = a->problem->value(which, x, gradient);
  if (++a->calls == a->fail_at) {
    if (a->wrong == 0)
      return bw_fail(context, BW_GEOMETRY, "the mesh is inverted");
    *value = a->wrong;
  }
  return BW_OK;
}

static bw_status solve(bw_context *context, asked *a, const bw_minimise_options *options, double *x,
                       bw_minimise_result *result) {
  const problem *p = a->problem;
  memcpy(x, p->start, (size_t)p->n * sizeof *x);
  return bw_minimise(context, p->n, x, p->min, p->max, p->constraints, ask, a, options, result);
}

static void test_every_method(void **state) {
  bw_context *context = check_context(state);
  for (int m = 0; bw_minimiser_word((bw_minimiser)m); m++) {
    bw_minimise_options options;
    bw_minimise_options_default(&options);
    options.method = (bw_minimiser)m;
    options.tolerance = 1e-9;
    options.evaluations = 30000;
    asked a = {&valley, 0, 0, 0};
    double x[10];
    bw_minimise_result result;
    check_ok(context, solve(context, &a, &options, x, &result));
    bool global = bw_minimiser_is_global(options.method);
    double tolerance = global ? 1e-3 : options.method == BW_COBYLA ? 1e-2 : 1e-6;
    check_near(result.value, 0, tolerance);
    check_near(rosenbrock(0, x, NULL), result.value, 0);
    assert_int_equal(result.evaluations, a.calls);
    check_near(result.violation, 0, 0);
  }
}

static void test_constraints(void **state) {
  bw_context *context = check_context(state);
  for (int m = 0; bw_minimiser_word((bw_minimiser)m); m++) {
    if (!bw_minimiser_takes_constraints((bw_minimiser)m))
      continue;
    for (size_t k = 0; k < sizeof hock / sizeof *hock; k++) {
      bw_minimise_options options;
      bw_minimise_options_default(&options);
      options.method = (bw_minimiser)m;
      options.tolerance = 1e-8;
      options.constraint_tolerance = 1e-7;
      options.evaluations = 40000;
      asked a = {&hock[k], 0, 0, 0};
      double x[10];
      bw_minimise_result result;
      check_ok(context, solve(context, &a, &options, x, &result));
      bool global = bw_minimiser_is_global(options.method);
      double error = fabs(result.value - hock[k].optimum) / fabs(hock[k].optimum);
      if (error > (global ? 1e-2 : 1e-6))
        fail_msg("%s by %s: %.10g instead of %.10g", hock[k].name, bw_minimiser_word(m),
                 result.value, hock[k].optimum);
      assert_true(result.violation <= options.constraint_tolerance);
    }
  }
}

static void test_gradients_of_the_problems(void **state) {
  (void)state;
  for (size_t k = 0; k < sizeof hock / sizeof *hock; k++)
    for (int which = 0; which <= hock[k].constraints; which++) {
      double x[4] = {0.7, 1.1, 0.4, 0.9}, g[4] = {0};
      hock[k].value(which, x, g);
      for (int i = 0; i < hock[k].n; i++) {
        double h = 1e-6, keep = x[i];
        x[i] = keep + h;
        double up = hock[k].value(which, x, NULL);
        x[i] = keep - h;
        double down = hock[k].value(which, x, NULL);
        x[i] = keep;
        check_near(g[i], (up - down) / (2 * h), 1e-6);
      }
    }
}

static void test_same_seed_same_run(void **state) {
  bw_context *context = check_context(state);
  static const bw_minimiser drawn[] = {BW_CRS2, BW_ISRES};
  for (int k = 0; k < 2; k++) {
    bw_minimise_options options;
    bw_minimise_options_default(&options);
    options.method = drawn[k];
    options.tolerance = 0;
    options.evaluations = 500;
    double x[3][2];
    bw_minimise_result result[3];
    for (int i = 0; i < 3; i++) {
      options.seed = i < 2 ? 7 : 8;
      asked a = {&valley, 0, 0, 0};
      check_ok(context, solve(context, &a, &options, x[i], &result[i]));
      assert_int_equal(result[i].end, BW_END_EVALUATIONS);
      assert_true(result[i].evaluations <= 500);
    }
    assert_memory_equal(x[0], x[1], sizeof x[0]);
    assert_memory_not_equal(x[0], x[2], sizeof x[0]);
  }
}

static void test_ends(void **state) {
  bw_context *context = check_context(state);
  bw_minimise_options options;
  bw_minimise_result result;
  double x[2];
  bw_minimise_options_default(&options);
  options.method = BW_NELDERMEAD;
  options.evaluations = 20;
  asked a = {&valley, 0, 0, 0};
  check_ok(context, solve(context, &a, &options, x, &result));
  assert_int_equal(result.end, BW_END_EVALUATIONS);
  assert_int_equal(result.evaluations, 20);
  options.evaluations = 10000;
  options.good_enough = 0.01;
  check_ok(context, solve(context, &a, &options, x, &result));
  assert_int_equal(result.end, BW_END_GOOD_ENOUGH);
  assert_true(result.value <= 0.01);
}

static void test_failures_come_out(void **state) {
  bw_context *context = check_context(state);
  bw_minimise_result result = {0};
  double x[2], before[2];
  for (int m = 0; bw_minimiser_word((bw_minimiser)m); m++) {
    bw_minimise_options options;
    bw_minimise_options_default(&options);
    options.method = (bw_minimiser)m;
    asked a = {&valley, 0, 7, 0};
    memcpy(before, valley.start, sizeof before);
    check_fails(context, BW_GEOMETRY, "inverted", solve(context, &a, &options, x, &result));
    assert_memory_equal(x, before, sizeof before); /* as it was */
    a = (asked){&valley, 0, 7, NAN};
    check_fails(context, BW_CONVERGENCE, "the objective is",
                solve(context, &a, &options, x, &result));
    bw_cancel(context);
    a = (asked){&valley, 0, 0, 0};
    check_fails(context, BW_CANCELLED, "", solve(context, &a, &options, x, &result));
    assert_int_equal(a.calls, 0);
    bw_clear_cancel(context);
  }
}

/* x >= 3 and x <= 2 at the same time */
static double impossible(int which, const double *x, double *g) {
  if (g) {
    g[0] = which == 1 ? -1 : 1;
    g[1] = 0;
  }
  return which == 0 ? x[0] : which == 1 ? 3 - x[0] : x[0] - 2;
}

static void test_misuse(void **state) {
  bw_context *context = check_context(state);
  bw_minimise_options options;
  bw_minimise_result result;
  double x[10] = {0};
  bw_minimise_options_default(&options);
  static const problem none = {"none", 2, 2, {0, 0}, {-9, -9}, {9, 9}, 0, impossible};
  asked a = {&none, 0, 0, 0};
  check_fails(context, BW_INFEASIBLE, "satisfies the constraints",
              solve(context, &a, &options, x, &result));
  options.method = BW_BOBYQA;
  check_fails(context, BW_INVALID,
              "bobyqa takes no constraints; these methods do: cobyla, isres, mma, slsqp",
              solve(context, &a, &options, x, &result));
  a.problem = &valley;
  options.method = BW_CRS2;
  x[0] = x[1] = 0;
  check_fails(context, BW_INVALID, "variable 1 lacks one; these methods need none: cobyla, bobyqa",
              bw_minimise(context, 2, x, NULL, NULL, 0, ask, &a, &options, &result));
  options.method = BW_COBYLA;
  double low[2] = {1, 1}, high[2] = {2, 2};
  check_fails(context, BW_INVALID, "variable 1 starts at 0",
              bw_minimise(context, 2, x, low, high, 0, ask, &a, &options, &result));
  check_fails(context, BW_INVALID, "bounds from 2 to 1",
              bw_minimise(context, 2, x, high, low, 0, ask, &a, &options, &result));
  options.method = BW_BOBYQA;
  check_fails(context, BW_INVALID, "2 or more variables",
              bw_minimise(context, 1, x, NULL, NULL, 0, ask, &a, &options, &result));
  options.evaluations = 0;
  check_fails(context, BW_INVALID, "0 evaluations", solve(context, &a, &options, x, &result));
}

static void test_allocation_failures(void **state) {
  bw_context *context = check_context(state);
  bw_minimise_options options;
  bw_minimise_options_default(&options);
  options.method = BW_SLSQP;
  check_each_allocation(context, status, 1) {
    asked a = {&valley, 0, 0, 0};
    double x[2];
    bw_minimise_result result;
    status = solve(context, &a, &options, x, &result);
  }
}

check_main(check_test(test_every_method), check_test(test_constraints),
           check_test(test_gradients_of_the_problems), check_test(test_same_seed_same_run),
           check_test(test_ends), check_test(test_failures_come_out), check_test(test_misuse),
           check_test(test_allocation_failures))
