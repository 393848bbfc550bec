/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Eigenpairs of sparse matrices and of the caller's own operators, by each eigensolver: closed
 * forms of finite differences and of finite elements in one dimension, errors that hold, what is
 * wrong in words, and memory that runs out. */
#include "check.h"

enum { N = 120, COUNT = 5 };
#define PI 3.14159265358979323846

/* The tridiagonal matrix of `diagonal` and `beside`. */
static bw_sparse_matrix *tridiagonal(bw_context *context, double diagonal, double beside) {
  int32_t row[3 * N], column[3 * N];
  double value[3 * N];
  int64_t count = 0;
  for (int i = 0; i < N; i++)
    for (int j = i - 1; j <= i + 1; j++)
      if (j >= 0 && j < N) {
        row[count] = i;
        column[count] = j;
        value[count++] = i == j ? diagonal : beside;
      }
  bw_sparse_matrix *matrix = NULL;
  check_ok(context, bw_sparse_matrix_create(context, N, N, count, row, column, value, &matrix));
  return matrix;
}

static bw_status product(bw_context *context, void *data, int64_t count, const double *x,
                         double *y) {
  (void)context;
  const double *of = data;
  for (int64_t k = 0; k < count; k++, x += N, y += N)
    for (int i = 0; i < N; i++)
      y[i] = of[0] * x[i] + of[1] * ((i > 0 ? x[i - 1] : 0) + (i + 1 < N ? x[i + 1] : 0));
  return BW_OK;
}

static bw_operator *operator_of(bw_context *context, double of[2], bool own, const char *name) {
  bw_operator *a = NULL;
  if (own) {
    check_ok(context, bw_operator_create(context, N, product, of, NULL, name, &a));
    return a;
  }
  bw_sparse_matrix *matrix = tridiagonal(context, of[0], of[1]);
  check_ok(context, bw_operator_of_matrix(context, matrix, name, &a));
  bw_release(matrix);
  return a;
}

static bw_eigensolver *eigensolver(bw_context *context, bw_eigensolver_kind kind) {
  bw_eigensolver_options options;
  bw_eigensolver *made = NULL;
  bw_eigensolver_options_default(&options);
  options.kind = kind;
  check_ok(context, bw_eigensolver_create(context, &options, &made));
  return made;
}

/* Eigenvalue k of the stiffness 2 - 2 cos and of the mass (4 + 2 cos) / 6 of linear elements. */
static double exact(int k, bool mass) {
  double c = cos((k + 1) * PI / (N + 1));
  return mass ? (2 - 2 * c) / ((4 + 2 * c) / 6) : 2 - 2 * c;
}

static double dot(const double *x, const double *y) {
  double sum = 0;
  for (int i = 0; i < N; i++)
    sum += x[i] * y[i];
  return sum;
}

/* |r| in the norm of M^-1, by a factor of M, is the error. */
static void check_error(bw_context *context, bool mass, const double *r, double error) {
  double z[N];
  memcpy(z, r, sizeof z);
  if (mass) {
    bw_sparse_matrix *matrix = tridiagonal(context, 4.0 / 6, 1.0 / 6);
    bw_operator *inverse = NULL;
    check_ok(context, bw_operator_inverse(context, matrix, NULL, &inverse));
    check_ok(context, bw_operator_apply(context, inverse, 1, r, z));
    bw_release(inverse);
    bw_release(matrix);
  }
  check_near(error, sqrt(dot(r, z)), 0.01 * error + 1e-14);
}

static void check_pairs(bw_context *context, const bw_operator *k, const bw_operator *m,
                        const bw_eigenpairs *pairs, double tolerance) {
  double kx[N], mx[COUNT][N];
  assert_int_equal(pairs->count, COUNT);
  assert_int_equal(pairs->size, N);
  for (int i = 0; i < COUNT; i++) {
    const double *x = pairs->vector + i * N;
    double value = exact(i, m != NULL), left = 0, size = 0;
    check_near(pairs->value[i], value, tolerance * value);
    /* an eigenvalue lies within the error, but for rounding of K x */
    check_near(pairs->value[i], value, pairs->error[i] + 1e-14);
    check_ok(context, bw_operator_apply(context, k, 1, x, kx));
    if (m)
      check_ok(context, bw_operator_apply(context, m, 1, x, mx[i]));
    else
      memcpy(mx[i], x, sizeof mx[i]);
    for (int j = 0; j <= i; j++)
      check_near(dot(x, mx[j]), i == j, 1e-7);
    double r[N];
    for (int j = 0; j < N; j++) {
      r[j] = kx[j] - pairs->value[i] * mx[i][j];
      left += r[j] * r[j];
      size += value * value * mx[i][j] * mx[i][j];
    }
    check_error(context, m != NULL, r, pairs->error[i]);
    assert_true(sqrt(left / size) < 1e-7 && pairs->residual[i] < 1e-8);
    /* sines */
    double largest = 0, here = 0;
    for (int j = 0; j < N; j++) {
      largest = fmax(largest, fabs(x[j]));
      here = fmax(here, x[j]);
    }
    assert_true(here == largest || here > largest * (1 - 1e-6));
    check_near(x[0] / largest, sin((i + 1) * PI / (N + 1)) * (x[0] > 0 ? 1 : -1), 1e-3);
  }
}

/* Each eigensolver that serves matrices; LOBPCG with and without a preconditioner; operators. */
static void each_eigensolver_gives_the_closed_form(void **state) {
  bw_context *context = check_context(state);
  double stiff[2] = {2, -1}, heavy[2] = {4.0 / 6, 1.0 / 6}, near[2] = {2.001, -1};
  bw_sparse_matrix *similar = tridiagonal(context, near[0], near[1]);
  bw_operator *inverse = NULL;
  check_ok(context, bw_operator_inverse(context, similar, NULL, &inverse));
  static const struct {
    bw_eigensolver_kind kind;
    bool operators, preconditioned;
    const char *solver, *preconditioner;
  } rows[] = {{BW_EIGENSOLVER_AUTO, false, false, "lanczos", ""},
              {BW_EIGENSOLVER_LANCZOS, false, false, "lanczos", ""},
              {BW_EIGENSOLVER_ARPACK, false, false, "arpack", ""},
              {BW_EIGENSOLVER_LOBPCG, false, false, "lobpcg", "jacobi"},
              {BW_EIGENSOLVER_LOBPCG, false, true, "lobpcg", "cholesky"},
              {BW_EIGENSOLVER_AUTO, false, true, "lobpcg", "cholesky"},
              {BW_EIGENSOLVER_AUTO, true, true, "lobpcg", "cholesky"},
              {BW_EIGENSOLVER_LOBPCG, true, false, "lobpcg", ""}};
  for (size_t r = 0; r < sizeof rows / sizeof *rows; r++)
    for (int masses = 0; masses < 3; masses++) { /* none, a matrix, an operator */
      bw_operator *k = operator_of(context, stiff, rows[r].operators, "K"), *m = NULL;
      if (masses > 0)
        m = operator_of(context, heavy, masses == 2, "M");
      bw_eigensolver *solver = eigensolver(context, rows[r].kind);
      bw_eigen_solve_options options;
      bw_eigenpairs *pairs = NULL;
      bw_eigen_solve_options_default(&options);
      options.count = COUNT;
      options.solver = rows[r].kind == BW_EIGENSOLVER_AUTO ? NULL : solver;
      options.preconditioner = rows[r].preconditioned ? inverse : NULL;
      check_ok(context, bw_eigen_solve(context, k, m, &options, &pairs));
      check_pairs(context, k, m, pairs, 1e-9);
      assert_string_equal(pairs->report.solver, rows[r].solver);
      assert_string_equal(pairs->report.preconditioner, rows[r].preconditioner);
      bool counts = strcmp(rows[r].solver, "lobpcg") != 0 && masses < 2;
      assert_int_equal(pairs->counted, counts);
      assert_int_equal(pairs->tested, !counts);
      bw_release(pairs);
      bw_release(solver);
      bw_release(k);
      bw_release(m);
    }
  bw_release(inverse);
  bw_release(similar);
}

/* A singular stiffness: a chain with free ends, whose smallest eigenvalue is 0. */
static bw_status free_chain(bw_context *context, void *data, int64_t count, const double *x,
                            double *y) {
  double stiff[2] = {2, -1};
  bw_status status = product(context, stiff, count, x, y);
  (void)data;
  for (int64_t k = 0; k < count; k++) {
    y[k * N] -= x[k * N];
    y[k * N + N - 1] -= x[k * N + N - 1];
  }
  return status;
}

static void a_shift_serves_singular_matrices(void **state) {
  bw_context *context = check_context(state);
  double one[N * N], unit[N];
  int32_t row[N * N], column[N * N];
  int64_t count = 0;
  for (int j = 0; j < N; j++) {
    double y[N];
    memset(unit, 0, sizeof unit);
    unit[j] = 1;
    check_ok(context, free_chain(context, NULL, 1, unit, y));
    for (int i = 0; i < N; i++)
      if (y[i] != 0) {
        row[count] = i;
        column[count] = j;
        one[count++] = y[i];
      }
  }
  bw_sparse_matrix *matrix = NULL;
  bw_operator *k = NULL, *free_one = NULL;
  double twice[2] = {2, 0};
  check_ok(context, bw_sparse_matrix_create(context, N, N, count, row, column, one, &matrix));
  check_ok(context, bw_operator_of_matrix(context, matrix, NULL, &k));
  check_ok(context, bw_operator_create(context, N, free_chain, NULL, NULL, NULL, &free_one));
  bw_operator *m = operator_of(context, twice, false, "M");
  for (int kind = BW_EIGENSOLVER_LANCZOS; kind <= BW_EIGENSOLVER_LOBPCG; kind++)
    for (int own = 0; own <= (kind == BW_EIGENSOLVER_LOBPCG); own++) {
      bw_eigensolver *solver = eigensolver(context, (bw_eigensolver_kind)kind);
      bw_eigen_solve_options options;
      bw_eigenpairs *pairs = NULL;
      bw_eigen_solve_options_default(&options);
      options.count = 4;
      options.shift = -1e-3;
      options.solver = solver;
      check_ok(context, bw_eigen_solve(context, own ? free_one : k, m, &options, &pairs));
      for (int i = 0; i < 4; i++)
        check_near(pairs->value[i], 0.5 * (2 - 2 * cos(i * PI / N)), 1e-11);
      assert_true(pairs->counted || pairs->tested);
      bw_release(pairs);
      if (!own && kind == BW_EIGENSOLVER_LANCZOS) {
        options.shift = 0;
        check_fails(context, BW_SINGULAR, "\"matrix\" is not positive definite",
                    bw_eigen_solve(context, k, m, &options, &pairs));
        options.shift = 1e-3;
        check_fails(context, BW_SINGULAR, "\"matrix\" is not positive definite",
                    bw_eigen_solve(context, k, m, &options, &pairs));
      }
      if (own) {
        options.shift = 1e-3;
        check_fails(context, BW_SINGULAR, "\"operator\" less its shift is not positive definite",
                    bw_eigen_solve(context, free_one, m, &options, &pairs));
      }
      bw_release(solver);
    }
  bw_release(m);
  bw_release(k);
  bw_release(free_one);
  bw_release(matrix);
}

/* Every pair there is, of a matrix with a multiple eigenvalue. */
static void all_pairs_of_a_small_matrix(void **state) {
  bw_context *context = check_context(state);
  const int32_t row[] = {0, 0, 0, 1, 1, 1, 2, 2, 2}, column[] = {0, 1, 2, 0, 1, 2, 0, 1, 2};
  const double value[] = {2, 1, 1, 1, 2, 1, 1, 1, 2};
  bw_sparse_matrix *matrix = NULL;
  bw_operator *k = NULL;
  check_ok(context, bw_sparse_matrix_create(context, 3, 3, 9, row, column, value, &matrix));
  check_ok(context, bw_operator_of_matrix(context, matrix, NULL, &k));
  for (int kind = BW_EIGENSOLVER_AUTO; kind <= BW_EIGENSOLVER_LOBPCG; kind++) {
    bw_eigensolver *solver = eigensolver(context, (bw_eigensolver_kind)kind);
    bw_eigen_solve_options options;
    bw_eigenpairs *pairs = NULL;
    bw_eigen_solve_options_default(&options);
    options.solver = solver;
    check_ok(context, bw_eigen_solve(context, k, NULL, &options, &pairs));
    assert_int_equal(pairs->count, 3);
    check_near(pairs->value[0], 1, 1e-12);
    check_near(pairs->value[1], 1, 1e-12);
    check_near(pairs->value[2], 4, 1e-12);
    bw_release(pairs);
    bw_release(solver);
  }
  bw_release(k);
  bw_release(matrix);
}

static void bits_do_not_depend_on_threads(void **state) {
  bw_context *context = check_context(state);
  double stiff[2] = {2, -1}, heavy[2] = {4.0 / 6, 1.0 / 6}, values[COUNT];
  bw_operator *m = operator_of(context, heavy, false, "M");
  for (int kind = BW_EIGENSOLVER_LANCZOS; kind <= BW_EIGENSOLVER_LOBPCG; kind++)
    for (int threads = 1; threads <= 2; threads++) {
      bw_operator *k = operator_of(context, stiff, kind == BW_EIGENSOLVER_LOBPCG, "K");
      bw_eigensolver *solver = eigensolver(context, (bw_eigensolver_kind)kind);
      bw_eigen_solve_options options;
      bw_eigenpairs *pairs = NULL;
      bw_eigen_solve_options_default(&options);
      options.count = COUNT;
      options.solver = solver;
      check_ok(context, bw_set_threads(context, threads));
      check_ok(context, bw_eigen_solve(context, k, m, &options, &pairs));
      if (threads == 1)
        memcpy(values, pairs->value, sizeof values);
      assert_memory_equal(values, pairs->value, sizeof values);
      bw_release(pairs);
      bw_release(solver);
      bw_release(k);
    }
  bw_release(m);
}

static bw_status cancelling(bw_context *context, void *data, int64_t count, const double *x,
                            double *y) {
  static int calls;
  if (++calls > 20)
    bw_cancel(context);
  return product(context, data, count, x, y);
}

static bw_status skew(bw_context *context, void *data, int64_t count, const double *x, double *y) {
  bw_status status = product(context, data, count, x, y);
  y[0] += 0.01 * x[1];
  return status;
}

static void failures_are_reported(void **state) {
  bw_context *context = check_context(state);
  double stiff[2] = {2, -1}, heavy[2] = {4.0 / 6, 1.0 / 6}, odd[2] = {-1, 0};
  bw_operator *k = operator_of(context, stiff, true, "K"),
              *matrix = operator_of(context, stiff, false, NULL);
  bw_operator *m = operator_of(context, heavy, true, "M"),
              *bad = operator_of(context, odd, true, "bad");
  bw_operator *other = NULL;
  bw_eigensolver *lanczos = eigensolver(context, BW_EIGENSOLVER_LANCZOS);
  bw_eigensolver *slepc = eigensolver(context, BW_EIGENSOLVER_SLEPC);
  bw_eigenpairs *pairs = NULL;
#define FAILS(status, text, k_, m_, ...)                                                           \
  do {                                                                                             \
    bw_eigen_solve_options options = {__VA_ARGS__};                                                \
    options.count = options.count ? options.count : 2;                                             \
    options.tolerance = options.tolerance != 0 ? options.tolerance : 1e-8;                         \
    check_fails(context, status, text, bw_eigen_solve(context, k_, m_, &options, &pairs));         \
  } while (0)
  FAILS(BW_INVALID, "needs the entries of a sparse matrix, and \"K\" is an operator", k, m,
        .solver = lanczos);
  FAILS(BW_INVALID, "and \"M\" is an operator", matrix, m, .solver = lanczos, .shift = -1);
  FAILS(BW_INVALID, "the preconditioner \"K\" is for lobpcg", matrix, NULL, .solver = lanczos,
        .preconditioner = k);
  FAILS(BW_UNSUPPORTED, "SLEPc computes elastic modes", matrix, NULL, .solver = slepc);
  bw_solver *amg = NULL;
  bw_eigensolver *of_bodies = NULL;
  bw_eigensolver_options how;
  check_ok(context, bw_solver_create(context, &(bw_solver_options){.kind = BW_SOLVER_AMG}, &amg));
  bw_eigensolver_options_default(&how);
  how.kind = BW_EIGENSOLVER_LOBPCG;
  how.preconditioner = amg;
  check_ok(context, bw_eigensolver_create(context, &how, &of_bodies));
  FAILS(BW_UNSUPPORTED, "\"amg\" works on the elements of a body", matrix, NULL,
        .solver = of_bodies);
  bw_release(of_bodies);
  bw_release(amg);
  double nothing[2] = {0, 0};
  bw_operator *empty = operator_of(context, nothing, false, NULL);
  for (bw_eigensolver_kind kind = BW_EIGENSOLVER_AUTO; kind < BW_EIGENSOLVER_SLEPC; kind++) {
    bw_eigensolver *solver = eigensolver(context, kind);
    FAILS(BW_SINGULAR, "is zero: there are no eigenpairs", matrix, empty, .solver = solver,
          .seed = 1);
    bw_release(solver);
  }
  bw_release(empty);
  FAILS(BW_INVALID, "-1 eigenpairs were requested", k, m, .count = -1);
  FAILS(BW_INVALID, "the tolerance on eigenpairs is 2", k, m, .tolerance = 2);
  FAILS(BW_INVALID, "the shift is nan", k, m, .shift = NAN);
  FAILS(BW_SINGULAR, "\"bad\" is not positive definite: x . A x = -", bad, m, .seed = 1);
  FAILS(BW_SINGULAR, "\"bad\" is not positive definite: x . A x = -", k, bad, .seed = 1);
  check_ok(context, bw_operator_create(context, N, skew, stiff, NULL, "skew", &other));
  FAILS(BW_INVALID, "\"skew\" is not symmetric", other, m, .seed = 1);
  FAILS(BW_INVALID, "\"skew\" is not symmetric", k, other, .seed = 1);
  bw_release(other);
  check_ok(context, bw_operator_create(context, N - 1, product, stiff, NULL, "short", &other));
  FAILS(BW_INVALID, "the mass \"short\" has 119 rows, \"K\" 120", k, other, .seed = 1);
  bw_release(other);
  check_ok(context, bw_operator_create(context, N, cancelling, stiff, NULL, "K", &other));
  FAILS(BW_CANCELLED, "", other, NULL, .seed = 1);
  bw_clear_cancel(context);
  bw_release(other);
  bw_release(slepc);
  bw_release(lanczos);
  bw_release(bad);
  bw_release(m);
  bw_release(matrix);
  bw_release(k);
}

/* A mass whose inverse plain conjugate gradients do not find: nothing is known of the errors. */
static bw_status steep(bw_context *context, void *data, int64_t count, const double *x, double *y) {
  (void)context, (void)data;
  for (int64_t k = 0; k < count * N; k++)
    y[k] = pow(10, -14.0 * (double)(k % N) / N) * x[k];
  return BW_OK;
}

static void errors_may_be_unknown(void **state) {
  bw_context *context = check_context(state);
  double stiff[2] = {2, -1};
  bw_operator *k = operator_of(context, stiff, false, "K"), *m = NULL;
  bw_eigen_solve_options options;
  bw_eigenpairs *pairs = NULL;
  bw_eigen_solve_options_default(&options);
  options.count = 2;
  check_ok(context, bw_operator_create(context, N, steep, NULL, NULL, "M", &m));
  check_ok(context, bw_eigen_solve(context, k, m, &options, &pairs));
  assert_true(isinf(pairs->error[0]) && isinf(pairs->error[1]));
  assert_true(pairs->residual[1] < 1e-8);
  bw_release(pairs);
  bw_release(m);
  bw_release(k);
}

/* Memory that runs out anywhere is reported, and nothing is lost. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  double stiff[2] = {2, -1}, heavy[2] = {4.0 / 6, 1.0 / 6};
  for (int own = 0; own < 2; own++) {
    bw_operator *k = operator_of(context, stiff, own, "K"),
                *m = operator_of(context, heavy, false, "M");
    double near[2] = {2.5, -1};
    bw_sparse_matrix *similar = tridiagonal(context, near[0], near[1]);
    bw_operator *inverse = NULL;
    check_ok(context, bw_operator_inverse(context, similar, NULL, &inverse));
    bw_eigen_solve_options options;
    bw_eigenpairs *pairs = NULL;
    bw_eigen_solve_options_default(&options);
    options.count = 2;
    options.test = false;
    options.tolerance = 1e-5;
    options.preconditioner = own ? inverse : NULL;
    bw_status status = BW_MEMORY;
    int64_t n = 0;
    while (status == BW_MEMORY) {
      bw_fail_allocation(++n, false);
      status = bw_eigen_solve(context, k, m, &options, &pairs);
      bw_fail_allocation(0, false);
    }
    if (status != BW_OK)
      fail_msg("%s (%s)", bw_message(context), bw_status_word(status));
    assert_true(n > 40);
    bw_release(pairs);
    bw_release(inverse);
    bw_release(similar);
    bw_release(m);
    bw_release(k);
  }
}

check_main(check_test(each_eigensolver_gives_the_closed_form),
           check_test(a_shift_serves_singular_matrices), check_test(all_pairs_of_a_small_matrix),
           check_test(bits_do_not_depend_on_threads), check_test(failures_are_reported),
           check_test(errors_may_be_unknown), check_test(memory_failures))
