/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Small quadratic programs against closed forms, and against trying every set of active rows. */
#include "check.h"

enum { MAX_N = 6, MAX_M = 8 };

typedef struct program {
  int n, m;
  double H[MAX_N * MAX_N], g[MAX_N], A[MAX_M * MAX_N], b[MAX_M];
  double low[MAX_N], high[MAX_N];
} program;

static double objective(const program *q, const double *x) {
  double sum = 0;
  for (int i = 0; i < q->n; i++) {
    sum += q->g[i] * x[i];
    for (int j = 0; j < q->n; j++)
      sum += 0.5 * x[i] * q->H[i * q->n + j] * x[j];
  }
  return sum;
}

static bw_status run(bw_context *context, const program *q, double *x, double *violation,
                     double *multiplier) {
  return bw_quadratic_program(context, q->n, q->H, q->g, q->m, q->A, q->b, q->low, q->high, x,
                              violation, multiplier);
}

static double row_at(const program *q, int i, const double *x) {
  double sum = -q->b[i];
  for (int j = 0; j < q->n; j++)
    sum += q->A[i * q->n + j] * x[j];
  return sum;
}

/* Gaussian elimination with pivoting; false when singular. */
static bool solve_dense(int n, double *a, double *b) {
  for (int k = 0; k < n; k++) {
    int pivot = k;
    for (int i = k + 1; i < n; i++)
      if (fabs(a[i * n + k]) > fabs(a[pivot * n + k]))
        pivot = i;
    if (fabs(a[pivot * n + k]) < 1e-10)
      return false;
    for (int j = 0; j < n; j++) {
      double t = a[k * n + j];
      a[k * n + j] = a[pivot * n + j];
      a[pivot * n + j] = t;
    }
    double t = b[k];
    b[k] = b[pivot];
    b[pivot] = t;
    for (int i = k + 1; i < n; i++) {
      double factor = a[i * n + k] / a[k * n + k];
      for (int j = k; j < n; j++)
        a[i * n + j] -= factor * a[k * n + j];
      b[i] -= factor * b[k];
    }
  }
  for (int i = n - 1; i >= 0; i--) {
    for (int j = i + 1; j < n; j++)
      b[i] -= a[i * n + j] * b[j];
    b[i] /= a[i * n + i];
  }
  return true;
}

/* Every set of at most n active rows and bounds: the feasible one of least objective. False when
 * there is none. */
static bool try_all(const program *q, double *best) {
  int n = q->n, rows = q->m + 2 * n;
  double row[(MAX_M + 2 * MAX_N) * MAX_N] = {0}, right[MAX_M + 2 * MAX_N];
  for (int i = 0; i < q->m; i++) {
    memcpy(row + i * n, q->A + i * n, (size_t)n * sizeof *row);
    right[i] = q->b[i];
  }
  for (int j = 0; j < n; j++) {
    row[(q->m + 2 * j) * n + j] = 1;
    right[q->m + 2 * j] = q->high[j];
    row[(q->m + 2 * j + 1) * n + j] = -1;
    right[q->m + 2 * j + 1] = -q->low[j];
  }
  bool any = false;
  double min = 0;
  for (unsigned set = 0; set < 1u << rows; set++) {
    int active[MAX_M + 2 * MAX_N], k = 0;
    for (int i = 0; i < rows; i++)
      if (set >> i & 1)
        active[k++] = i;
    if (k > n)
      continue;
    int size = n + k;
    double a[4 * MAX_N * MAX_N] = {0}, x[2 * MAX_N];
    for (int i = 0; i < n; i++) {
      for (int j = 0; j < n; j++)
        a[i * size + j] = q->H[i * n + j];
      x[i] = -q->g[i];
    }
    for (int i = 0; i < k; i++) {
      for (int j = 0; j < n; j++)
        a[(n + i) * size + j] = a[j * size + n + i] = row[active[i] * n + j];
      x[n + i] = right[active[i]];
    }
    if (!solve_dense(size, a, x))
      continue;
    bool feasible = true;
    for (int i = 0; i < rows && feasible; i++) {
      double sum = -right[i];
      for (int j = 0; j < n; j++)
        sum += row[i * n + j] * x[j];
      feasible = sum <= 1e-9;
    }
    if (!feasible)
      continue;
    if (!any || objective(q, x) < min) {
      min = objective(q, x);
      memcpy(best, x, (size_t)n * sizeof *best);
    }
    any = true;
  }
  return any;
}

static double uniform(bw_random *random) {
  return 2 * bw_random_uniform(random) - 1;
}

static void random_linear_program(bw_random *random, int n, int m, program *q) {
  double j[2 * MAX_N * MAX_N];
  memset(q, 0, sizeof *q);
  q->n = n;
  q->m = m;
  for (int i = 0; i < 2 * n * n; i++)
    j[i] = uniform(random);
  for (int a = 0; a < n; a++)
    for (int b = 0; b < n; b++)
      for (int k = 0; k < 2 * n; k++)
        q->H[a * n + b] += j[k * n + a] * j[k * n + b];
  for (int i = 0; i < n; i++) {
    q->g[i] = 3 * uniform(random);
    q->low[i] = -0.2 - bw_random_uniform(random);
    q->high[i] = 0.2 + bw_random_uniform(random);
  }
  for (int i = 0; i < n * m; i++)
    q->A[i] = uniform(random);
  for (int i = 0; i < m; i++)
    q->b[i] = 0.8 * uniform(random);
}

static void check_multipliers(const program *q, const double *x, const double *mu,
                              double violation) {
  for (int i = 0; i < q->m; i++) {
    assert_true(mu[i] >= 0);
    check_near(mu[i] * (row_at(q, i, x) - violation), 0, 1e-6 * (1 + mu[i]));
  }
  for (int j = 0; j < q->n; j++) { /* H x + g + A^T mu points out of the bounds */
    double sum = q->g[j];
    for (int k = 0; k < q->n; k++)
      sum += q->H[j * q->n + k] * x[k];
    for (int i = 0; i < q->m; i++)
      sum += mu[i] * q->A[i * q->n + j];
    if (x[j] > q->low[j] + 1e-7)
      assert_true(sum <= 1e-6);
    if (x[j] < q->high[j] - 1e-7)
      assert_true(sum >= -1e-6);
  }
}

static void against_trying_all(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 11);
  int feasible = 0, infeasible = 0;
  for (int round = 0; round < 400; round++) {
    program q;
    double x[MAX_N], expected[MAX_N], mu[MAX_M], violation;
    int n = 1 + (int)(4 * bw_random_uniform(&random));
    int m = (int)(6 * bw_random_uniform(&random));
    random_linear_program(&random, n, m, &q);
    check_ok(context, run(context, &q, x, &violation, mu));
    if (try_all(&q, expected)) {
      feasible++;
      assert_true(violation == 0);
      for (int j = 0; j < n; j++)
        check_near(x[j], expected[j], 1e-9);
    } else {
      infeasible++;
      assert_true(violation > 0);
      /* with rows relaxed by so much there is a solution, by a little less there is none */
      program relaxed = q;
      for (int i = 0; i < m; i++)
        relaxed.b[i] = q.b[i] + violation + 1e-7;
      assert_true(try_all(&relaxed, expected));
      for (int j = 0; j < n; j++)
        check_near(x[j], expected[j], 1e-3);
      for (int i = 0; i < m; i++)
        relaxed.b[i] = q.b[i] + violation - 1e-6;
      assert_false(try_all(&relaxed, expected));
    }
    for (int j = 0; j < n; j++)
      assert_true(x[j] >= q.low[j] && x[j] <= q.high[j]);
    if (violation == 0)
      check_multipliers(&q, x, mu, violation);
  }
  assert_true(feasible > 100 && infeasible > 30);
}

static void closed_forms(void **state) {
  bw_context *context = check_context(state);
  /* the point of x + y <= 1 nearest to (2, 1), H = 1 */
  program q = {.n = 2, .m = 1, .H = {1, 0, 0, 1}, .g = {-2, -1}, .A = {1, 1}, .b = {1}};
  double x[2], violation, mu[8]; /* as many as the longest quadratic program has rows */
  for (int i = 0; i < 2; i++) {
    q.low[i] = -INFINITY;
    q.high[i] = INFINITY;
  }
  check_ok(context, run(context, &q, x, &violation, mu));
  check_near(x[0], 1, 1e-12);
  check_near(x[1], 0, 1e-12);
  check_near(mu[0], 1, 1e-12);
  assert_true(violation == 0);
  /* nothing in the way */
  q.b[0] = 4;
  check_ok(context, run(context, &q, x, &violation, mu));
  check_near(x[0], 2, 1e-14);
  check_near(x[1], 1, 1e-14);
  assert_true(mu[0] == 0 && violation == 0);
  /* the same with badly scaled unknowns: x in millionths, y in millions */
  program s = {
      .n = 2, .m = 1, .H = {1e12, 0, 0, 1e-12}, .g = {-2e6, -1e-6}, .A = {1e6, 1e-6}, .b = {1}};
  for (int i = 0; i < 2; i++) {
    s.low[i] = -INFINITY;
    s.high[i] = INFINITY;
  }
  check_ok(context, run(context, &s, x, &violation, NULL));
  check_near(x[0], 1e-6, 1e-17);
  check_near(x[1], 0, 1e-6);
  /* x <= -1 and -x <= -2 (x >= 2): the midpoint, 1.5 off each */
  program e = {.n = 1, .m = 2, .H = {1}, .g = {0}, .A = {1, -1}, .b = {-1, -2}};
  e.low[0] = -10;
  e.high[0] = 10;
  check_ok(context, run(context, &e, x, &violation, mu));
  check_near(x[0], 0.5, 1e-6);
  check_near(violation, 1.5, 1e-6);
  /* held by its bound: x <= -1 with x >= 3 is relaxed by 4 */
  program h = {.n = 1, .m = 1, .H = {2}, .g = {0}, .A = {1}, .b = {-1}, .low = {3}, .high = {5}};
  check_ok(context, run(context, &h, x, &violation, mu));
  check_near(x[0], 3, 1e-7);
  check_near(violation, 4, 1e-6);
  /* a row of zeros that cannot hold */
  program z = {.n = 1, .m = 1, .H = {2}, .g = {2}, .A = {0}, .b = {-3}, .low = {-5}, .high = {5}};
  check_ok(context, run(context, &z, x, &violation, mu));
  check_near(x[0], -1, 1e-7);
  check_near(violation, 3, 1e-6);
  /* the same row ten times, and a fixed unknown */
  program d = {.n = 2, .m = 8, .H = {2, 1, 1, 2}, .g = {-8, -6}};
  for (int i = 0; i < 8; i++) {
    d.A[2 * i] = d.A[2 * i + 1] = 1;
    d.b[i] = 2;
  }
  d.low[0] = d.high[0] = 0.5;
  d.low[1] = -9;
  d.high[1] = 9;
  check_ok(context, run(context, &d, x, &violation, mu));
  check_near(x[0], 0.5, 1e-12);
  check_near(x[1], 1.5, 1e-9);
  assert_true(violation == 0);
}

/* Rows far apart in scale, as stresses and factors are. */
static void badly_scaled(void **state) {
  bw_context *context = check_context(state);
  bw_random random;
  bw_random_seed(&random, 5);
  for (int round = 0; round < 100; round++) {
    program q, s;
    double x[MAX_N], y[MAX_N], violation, other, unit[MAX_N];
    random_linear_program(&random, 4, 5, &q);
    s = q;
    double all = pow(10, 8 * uniform(&random));
    for (int j = 0; j < 4; j++)
      unit[j] = pow(10, 4 * uniform(&random)); /* x = unit y */
    for (int i = 0; i < 5; i++)
      for (int j = 0; j < 4; j++)
        s.A[4 * i + j] *= unit[j];
    for (int i = 0; i < 4; i++) {
      s.g[i] *= unit[i] * all;
      s.low[i] /= unit[i];
      s.high[i] /= unit[i];
      for (int j = 0; j < 4; j++)
        s.H[4 * i + j] *= unit[i] * unit[j] * all;
    }
    check_ok(context, run(context, &q, x, &violation, NULL));
    check_ok(context, run(context, &s, y, &other, NULL));
    check_near(other, violation, 1e-6);
    if (violation == 0)
      for (int j = 0; j < 4; j++)
        check_near(y[j] * unit[j], x[j], 1e-7);
  }
}

static void refusals(void **state) {
  bw_context *context = check_context(state);
  program q = {.n = 2, .m = 1, .H = {1, 2, 2, 1}, .A = {1, 1}, .b = {1}};
  double x[2], violation;
  for (int i = 0; i < 2; i++)
    q.high[i] = 1;
  check_fails(context, BW_INVALID, "positive definite", run(context, &q, x, &violation, NULL));
  q.H[1] = q.H[2] = 0;
  q.low[1] = 2;
  check_fails(context, BW_INVALID, "unknown 2", run(context, &q, x, &violation, NULL));
  q.low[1] = 0;
  q.b[0] = NAN;
  check_fails(context, BW_INVALID, "right-hand side", run(context, &q, x, &violation, NULL));
  q.b[0] = 1;
  q.A[1] = INFINITY;
  check_fails(context, BW_INVALID, "rows", run(context, &q, x, &violation, NULL));
  q.n = 0;
  check_fails(context, BW_INVALID, "0 unknowns", run(context, &q, x, &violation, NULL));
}

static void memory_runs_out(void **state) {
  bw_context *context = check_context(state);
  program q = {.n = 2, .m = 2, .H = {1, 0, 0, 1}, .g = {-2, -1}, .A = {1, 1, -1, -1}, .b = {1, -3}};
  double x[2], violation, mu[2];
  q.low[0] = q.low[1] = -5;
  q.high[0] = q.high[1] = 5;
  check_each_allocation(context, status, 1) {
    status = run(context, &q, x, &violation, mu);
  }
  check_near(violation, 1, 1e-6);
}

check_main(check_test(closed_forms), check_test(against_trying_all), check_test(badly_scaled),
           check_test(refusals), check_test(memory_runs_out))
