/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sparse matrices and the caller's own operators by each solver: closed forms, the same bits on any
 * number of threads, what is wrong in words, cancellation, and memory that runs out. */
#include <sys/resource.h>

#include "check.h"

#include "barwright/job.h"

#include "base/job.h"

enum { N = 500 };

/* The tridiagonal matrix of 2 and -1 times `scale`, with `diagonal` added; `skew` goes to the upper
 * triangle alone. */
static bw_sparse_matrix *laplacian(bw_context *context, int n, double diagonal, double skew) {
  int32_t *row = BW_NEW(context, int32_t, 3 * n), *column = BW_NEW(context, int32_t, 3 * n);
  double *value = BW_NEW(context, double, 3 * n);
  int64_t count = 0;
  for (int i = 0; i < n; i++)
    for (int j = i - 1; j <= i + 1; j++)
      if (j >= 0 && j < n) {
        row[count] = i;
        column[count] = j;
        value[count++] = i == j ? 2 + diagonal : -1 + (j > i ? skew : 0);
      }
  bw_sparse_matrix *matrix = NULL;
  check_ok(context, bw_sparse_matrix_create(context, n, n, count, row, column, value, &matrix));
  bw_free(row);
  bw_free(column);
  bw_free(value);
  return matrix;
}

/* The same as an operator of the caller's: data is what is added to the diagonal. */
static int products;

static bw_status laplacian_product(bw_context *context, void *data, int64_t count, const double *x,
                                   double *y) {
  (void)context;
  double diagonal = *(const double *)data;
  products += (int)count;
  for (int64_t k = 0; k < count; k++, x += N, y += N)
    for (int i = 0; i < N; i++)
      y[i] = (2 + diagonal) * x[i] - (i > 0 ? x[i - 1] : 0) - (i + 1 < N ? x[i + 1] : 0);
  return BW_OK;
}

static bw_operator *own(bw_context *context, double *diagonal) {
  bw_operator *a = NULL;
  check_ok(context, bw_operator_create(context, N, laplacian_product, diagonal, NULL, "own", &a));
  return a;
}

static bw_operator *of_matrix(bw_context *context, bw_sparse_matrix *matrix) {
  bw_operator *a = NULL;
  check_ok(context, bw_operator_of_matrix(context, matrix, NULL, &a));
  bw_release(matrix);
  return a;
}

static bw_solver *solver(bw_context *context, bw_solver_options options) {
  bw_solver *made = NULL;
  check_ok(context, bw_solver_create(context, &options, &made));
  return made;
}

/* x of the Laplacian for f = 1 everywhere: i (n + 1 - i) / 2, i from 1. */
static double parabola(int i) {
  return 0.5 * (i + 1) * (N - i);
}

/* Every solver that serves a matrix, and what serves an operator. */
static void each_solver_gives_the_closed_form(void **state) {
  bw_context *context = check_context(state);
  double zero = 0, near = 1e-5;
  bw_operator *matrix = of_matrix(context, laplacian(context, N, 0, 0)),
              *free_one = own(context, &zero);
  bw_sparse_matrix *similar = laplacian(context, N, near, 0);
  bw_solver *jacobi = solver(context, (bw_solver_options){.kind = BW_SOLVER_JACOBI});
  bw_solver *factor =
      solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY, .precision = 32});
  bw_operator *inverse = NULL;
  check_ok(context, bw_operator_inverse(context, similar, NULL, &inverse));
  const struct {
    bw_solver_options options;
    bool automatic, operator_too;
    const bw_operator *preconditioner;
    const char *solver, *backend, *word;
  } rows[] = {
      {.automatic = true, .solver = "cholesky", .backend = "multifrontal", .word = ""},
      {{.kind = BW_SOLVER_CHOLESKY,
        .backend = BW_BACKEND_MULTIFRONTAL,
        .ordering = BW_ORDERING_AMD},
       .solver = "cholesky",
       .backend = "multifrontal",
       .word = ""},
      {{.kind = BW_SOLVER_CHOLESKY, .backend = BW_BACKEND_CHOLMOD},
       .solver = "cholesky",
       .backend = "cholmod",
       .word = ""},
      {{.kind = BW_SOLVER_CHOLESKY, .precision = 32},
       .solver = "pcg",
       .backend = "multifrontal",
       .word = "cholesky"},
      {{.kind = BW_SOLVER_PCG}, .solver = "pcg", .backend = "", .word = "jacobi"},
      {{.kind = BW_SOLVER_PCG, .preconditioner = jacobi},
       .solver = "pcg",
       .backend = "",
       .word = "jacobi"},
      {{.kind = BW_SOLVER_PCG, .preconditioner = factor},
       .solver = "pcg",
       .backend = "multifrontal",
       .word = "cholesky"},
      {.automatic = true,
       .operator_too = true,
       .preconditioner = inverse,
       .solver = "pcg",
       .backend = "multifrontal",
       .word = "cholesky"},
      {{.kind = BW_SOLVER_PCG},
       .operator_too = true,
       .preconditioner = inverse,
       .solver = "pcg",
       .backend = "multifrontal",
       .word = "cholesky"},
  };
  double b[3 * N], x[3 * N];
  for (int i = 0; i < N; i++) {
    b[i] = 1;
    b[N + i] = 0;
    b[2 * N + i] = i == 7 ? 3 : 0;
  }
  for (size_t r = 0; r < sizeof rows / sizeof *rows; r++)
    for (int which = 0; which <= rows[r].operator_too; which++) {
      bw_solver *given = rows[r].automatic ? NULL : solver(context, rows[r].options);
      const bw_linear_solve_options options = {.solver = given,
                                               .preconditioner = rows[r].preconditioner};
      bw_solver_report report;
      memset(x, 0x7f, sizeof x);
      check_ok(context,
               bw_linear_solve(context, which ? free_one : matrix, &options, 3, b, x, &report));
      for (int i = 0; i < N; i++) {
        check_near(x[i], parabola(i), 1e-6 * parabola(N / 2));
        assert_true(x[N + i] == 0);
        double unit = i < 7 ? (double)(i + 1) * (N - 7) : 8.0 * (N - i);
        check_near(x[2 * N + i], 3 * unit / (N + 1), 1e-6 * 24);
      }
      assert_string_equal(report.solver, rows[r].solver);
      assert_string_equal(report.backend, rows[r].backend);
      assert_string_equal(report.preconditioner, rows[r].word);
      assert_true(report.residual < 1e-10);
      assert_true(report.reason[0] != 0);
      assert_true((report.iterations > 0) == (strcmp(report.solver, "pcg") == 0));
      bw_release(given);
    }
  bw_release(inverse);
  bw_release(similar);
  bw_release(factor);
  bw_release(jacobi);
  bw_release(free_one);
  bw_release(matrix);
}

/* Without a preconditioner; a guess saves work, and the solution itself all of it. */
static void guesses_save_iterations(void **state) {
  bw_context *context = check_context(state);
  double diagonal = 0.01, b[N], x[N], y[N];
  bw_operator *a = own(context, &diagonal);
  bw_solver_report report, next;
  for (int i = 0; i < N; i++)
    b[i] = sin(i);
  check_ok(context, bw_linear_solve(context, a, NULL, 1, b, x, &report));
  assert_string_equal(report.preconditioner, "");
  for (int i = 0; i < N; i++)
    y[i] = x[i] * (1 + 1e-6 * sin(3 * i));
  bw_linear_solve_options options = {.guess = y};
  check_ok(context, bw_linear_solve(context, a, &options, 1, b, x, &next));
  assert_true(next.iterations < 0.7 * report.iterations);
  memcpy(y, x, sizeof x);
  products = 0;
  check_ok(context, bw_linear_solve(context, a, &options, 1, b, x, &next));
  assert_int_equal(next.iterations, 0);
  assert_true(products <= 2);
  assert_memory_equal(x, y, sizeof x);
  bw_release(a);
}

/* A matrix of elements, which tells threads apart more than one of three diagonals. */
static void bits_do_not_depend_on_threads(void **state) {
  bw_context *context = check_context(state);
  enum { SIDE = 40, SIZE = SIDE * SIDE };
  int32_t *row = BW_NEW(context, int32_t, 5 * SIZE), *column = BW_NEW(context, int32_t, 5 * SIZE);
  double *value = BW_NEW(context, double, 5 * SIZE);
  double *b = BW_NEW(context, double, SIZE), *x = BW_NEW(context, double, SIZE),
         *y = BW_NEW(context, double, SIZE);
  int64_t count = 0;
  for (int i = 0; i < SIZE; i++) {
    const int step[5] = {-SIDE, -1, 0, 1, SIDE};
    b[i] = cos(0.7 * i);
    for (int s = 0; s < 5; s++) {
      int j = i + step[s];
      if (j < 0 || j >= SIZE || (abs(step[s]) == 1 && j / SIDE != i / SIDE))
        continue;
      row[count] = i;
      column[count] = j;
      value[count++] = j == i ? 4.001 : -1;
    }
  }
  bw_sparse_matrix *matrix = NULL;
  check_ok(context,
           bw_sparse_matrix_create(context, SIZE, SIZE, count, row, column, value, &matrix));
  bw_operator *a = of_matrix(context, matrix);
  for (int kind = 0; kind < 2; kind++) {
    bw_solver *given =
        solver(context, (bw_solver_options){.kind = kind ? BW_SOLVER_PCG : BW_SOLVER_CHOLESKY});
    const bw_linear_solve_options options = {.solver = given};
    for (int threads = 1; threads <= 3; threads++) {
      check_ok(context, bw_set_threads(context, threads));
      check_ok(context, bw_linear_solve(context, a, &options, 1, b, threads > 1 ? y : x, NULL));
      if (threads > 1)
        assert_memory_equal(x, y, SIZE * sizeof *x);
    }
    bw_release(given);
  }
  bw_release(a);
  bw_free(row);
  bw_free(column);
  bw_free(value);
  bw_free(b);
  bw_free(x);
  bw_free(y);
}

/* ---- what is wrong --------------------------------------------------------------------------- */

static bw_status skew_product(bw_context *context, void *data, int64_t count, const double *x,
                              double *y) {
  bw_status status = laplacian_product(context, data, count, x, y);
  for (int64_t k = 0; k < count; k++)
    for (int i = 0; i + 1 < N; i++)
      y[k * N + i] += 3 * x[k * N + i + 1];
  return status;
}

static bw_status broken_product(bw_context *context, void *data, int64_t count, const double *x,
                                double *y) {
  bw_status status = laplacian_product(context, data, count, x, y);
  y[4] = NAN;
  return status;
}

static bw_status failing_product(bw_context *context, void *data, int64_t count, const double *x,
                                 double *y) {
  (void)data, (void)count, (void)x, (void)y;
  return bw_fail(context, BW_IO, "the disk is full");
}

static bw_status cancelling_product(bw_context *context, void *data, int64_t count, const double *x,
                                    double *y) {
  bw_status status = laplacian_product(context, data, count, x, y);
  if (products > 5)
    bw_cancel(context);
  return status;
}

static void failures_are_reported(void **state) {
  bw_context *context = check_context(state);
  double zero = 0, negative = -1, tiny = 1e-3, b[N], x[N];
  for (int i = 0; i < N; i++)
    b[i] = 1 + i % 3;
  bw_operator *good = own(context, &zero),
              *matrix = of_matrix(context, laplacian(context, N, 0, 0));
  bw_operator *indefinite = own(context, &negative), *bad = NULL;
  bw_solver *pcg = solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .max_iterations = 5});
  bw_solver *factor = solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY});
  bw_solver *jacobi = solver(context, (bw_solver_options){.kind = BW_SOLVER_JACOBI});
  bw_solver *amg = solver(context, (bw_solver_options){.kind = BW_SOLVER_AMG});
  bw_solver *both =
      solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = jacobi});
  bw_solver *by_amg =
      solver(context, (bw_solver_options){.kind = BW_SOLVER_PCG, .preconditioner = amg});
  bw_solver *petsc =
      solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY, .backend = BW_BACKEND_PETSC});
#define FAILS(status, text, a, ...)                                                                \
  do {                                                                                             \
    const bw_linear_solve_options options_ = {__VA_ARGS__};                                        \
    check_fails(context, status, text, bw_linear_solve(context, a, &options_, 1, b, x, NULL));     \
  } while (0)
  FAILS(BW_CONVERGENCE, "in 5 iterations; 1e-10 was requested", good, .solver = pcg);
  FAILS(BW_SINGULAR, "\"own\" is not positive definite: p . A p = -", indefinite, .solver = NULL);
  FAILS(BW_INVALID, "a factor needs the entries of a sparse matrix, and \"own\" is an operator",
        good, .solver = factor);
  FAILS(BW_INVALID, "\"jacobi\" is a preconditioner and no solver", matrix, .solver = jacobi);
  bw_solver *lu = solver(context, (bw_solver_options){.kind = BW_SOLVER_LU});
  FAILS(BW_INVALID, "\"lu\" is for the unsymmetric equations of flows", matrix, .solver = lu);
  check_fails(context, BW_INVALID, "\"lu\" is for the unsymmetric equations of flows",
              bw_operator_inverse(context, matrix->matrix, lu, &bad));
  bw_release(lu);
  FAILS(BW_INVALID, "a preconditioner that the solver makes needs the entries", good,
        .solver = both);
  FAILS(BW_INVALID, "two preconditioners", matrix, .solver = both, .preconditioner = good);
  FAILS(BW_INVALID, "a factor needs no preconditioner: leave \"own\" out", matrix, .solver = factor,
        .preconditioner = good);
  FAILS(BW_SINGULAR, "\"own\" is not positive definite: r . M r = -", matrix, .solver = NULL,
        .preconditioner = indefinite);
  FAILS(BW_UNSUPPORTED, "\"amg\" works on the elements of a body", matrix, .solver = by_amg);
  FAILS(BW_UNSUPPORTED, "the backend \"petsc\" factors the equations of a model", matrix,
        .solver = petsc);
  x[0] = INFINITY;
  FAILS(BW_INVALID, "row 1 of the guess is inf", good, .guess = x);

  const struct {
    bw_operator_function *apply;
    bw_status status;
    const char *text;
  } bads[] = {{skew_product, BW_INVALID, "\"bad\" is not symmetric: x . A y = "},
              {broken_product, BW_INVALID, "the product of \"bad\" has nan in row 5"},
              {failing_product, BW_IO, "the disk is full"},
              {cancelling_product, BW_CANCELLED, ""}};
  for (size_t k = 0; k < sizeof bads / sizeof *bads; k++) {
    products = 0;
    check_ok(context, bw_operator_create(context, N, bads[k].apply, &tiny, NULL, "bad", &bad));
    FAILS(bads[k].status, bads[k].text, bad, .solver = NULL);
    bw_clear_cancel(context);
    bw_release(bad);
  }
  assert_true(products < 12); /* it ended where it was asked to */

  bw_sparse_matrix *skew = laplacian(context, N, 0, 0.1), *wide = NULL;
  bw_operator *other = of_matrix(context, skew);
  FAILS(BW_INVALID, "\"matrix\" is not symmetric", other, .solver = NULL);
  bw_release(other);
  other = of_matrix(context, laplacian(context, N, -1, 0));
  FAILS(BW_SINGULAR, "\"matrix\" is not positive definite: elimination fails at row", other,
        .solver = NULL);
  bw_release(other);
  other = of_matrix(context, laplacian(context, N, -2, 0));
  FAILS(BW_SINGULAR, "entry (1, 1) of its diagonal is 0", other, .solver = pcg);
  bw_release(other);
  other = of_matrix(context, laplacian(context, 3, 0, 0));
  FAILS(BW_INVALID, "the preconditioner \"matrix\" has 3 rows, \"own\" 500", good,
        .preconditioner = other);
  bw_release(other);
  check_ok(context, bw_sparse_matrix_create(context, 2, 3, 0, NULL, NULL, NULL, &wide));
  check_fails(context, BW_INVALID, "the matrix of 2 x 3 is not square",
              bw_operator_of_matrix(context, wide, NULL, &bad));
  check_fails(context, BW_INVALID, "needs a function",
              bw_operator_create(context, 2, NULL, NULL, NULL, NULL, &bad));
  check_fails(context, BW_INVALID, "an operator of -1 rows",
              bw_operator_create(context, -1, skew_product, NULL, NULL, NULL, &bad));
  b[2] = NAN;
  FAILS(BW_INVALID, "row 3 of the right-hand side is nan", good, .solver = NULL);
  bw_release(wide);
  bw_release(petsc);
  bw_release(by_amg);
  bw_release(both);
  bw_release(amg);
  bw_release(jacobi);
  bw_release(factor);
  bw_release(pcg);
  bw_release(indefinite);
  bw_release(matrix);
  bw_release(good);
}

/* Matrices symmetric to rounding are taken, as files of other programs have them. */
static void rounding_is_no_asymmetry(void **state) {
  bw_context *context = check_context(state);
  double b[N], x[N];
  bw_operator *a = of_matrix(context, laplacian(context, N, 0, 1e-15));
  assert_false(bw_sparse_matrix_is_symmetric(a->matrix));
  for (int i = 0; i < N; i++)
    b[i] = 1;
  check_ok(context, bw_linear_solve(context, a, NULL, 1, b, x, NULL));
  check_near(x[N / 2], parabola(N / 2), 1e-6 * parabola(N / 2));
  bw_release(a);
}

/* Entries far outside of the range of float. */
static void single_precision_takes_any_units(void **state) {
  bw_context *context = check_context(state);
  const double value[] = {4e-60, 1e-60, 1e-60, 3e-60}, b[] = {1, 2};
  const int32_t row[] = {0, 0, 1, 1}, column[] = {0, 1, 0, 1};
  double x[2];
  bw_sparse_matrix *matrix = NULL;
  check_ok(context, bw_sparse_matrix_create(context, 2, 2, 4, row, column, value, &matrix));
  bw_operator *a = of_matrix(context, matrix);
  bw_solver *single =
      solver(context, (bw_solver_options){.kind = BW_SOLVER_CHOLESKY, .precision = 32});
  const bw_linear_solve_options options = {.solver = single};
  check_ok(context, bw_linear_solve(context, a, &options, 1, b, x, NULL));
  check_near(x[0] * 1e-60, 1.0 / 11, 1e-9);
  check_near(x[1] * 1e-60, 7.0 / 11, 1e-9);
  bw_release(single);
  bw_release(a);
}

/* Memory that runs out anywhere is reported, and nothing is lost. */
static void memory_failures(void **state) {
  bw_context *context = check_context(state);
  double zero = 0, b[2 * N], x[2 * N];
  for (int i = 0; i < 2 * N; i++)
    b[i] = i;
  for (int which = 0; which < 3; which++) {
    bw_operator *a = which ? of_matrix(context, laplacian(context, N, 0, 0)) : own(context, &zero);
    bw_solver *given = solver(
        context, (bw_solver_options){.kind = which == 1 ? BW_SOLVER_CHOLESKY : BW_SOLVER_PCG});
    const bw_linear_solve_options options = {.solver = given};
    bw_status status = BW_MEMORY;
    int64_t n = 0;
    while (status == BW_MEMORY) {
      bw_fail_allocation(++n, false);
      status = bw_linear_solve(context, a, &options, 2, b, x, NULL);
      bw_fail_allocation(0, false);
    }
    if (status != BW_OK)
      fail_msg("%s (%s)", bw_message(context), bw_status_word(status));
    assert_true(n > (which == 1 ? 20 : 1));
    bw_release(given);
    bw_release(a);
  }
}

/* The matrix of seven numbers a row of a grid of n x n x n points. */
static bw_sparse_matrix *grid_laplacian(bw_context *context, int n) {
  int size = n * n * n, count = 0, step[3] = {1, n, n * n};
  int32_t *row = BW_NEW(context, int32_t, 7 * size), *column = BW_NEW(context, int32_t, 7 * size);
  double *value = BW_NEW(context, double, 7 * size);
  bw_sparse_matrix *matrix = NULL;
  for (int i = 0; i < size; i++) {
    row[count] = column[count] = i;
    value[count++] = 6;
    for (int d = 0; d < 3; d++)
      for (int side = -1; side <= 1; side += 2) {
        int at = i / step[d] % n + side;
        if (at < 0 || at >= n)
          continue;
        row[count] = i;
        column[count] = i + side * step[d];
        value[count++] = -1;
      }
  }
  check_ok(context,
           bw_sparse_matrix_create(context, size, size, count, row, column, value, &matrix));
  bw_free(row);
  bw_free(column);
  bw_free(value);
  return matrix;
}

#ifndef __SANITIZE_ADDRESS__ /* it takes all addresses */
/* Where a factor does not fit, the message names what serves in its place. */
static void factors_beyond_memory_name_what_needs_none(void **state) {
  bw_context *context = check_context(state);
  enum { EDGE = 36, SPARE = 48 << 20 };
  bw_sparse_matrix *matrix = grid_laplacian(context, EDGE);
  bw_operator *a = NULL, *inverse = NULL;
  bw_eigenpairs *pairs = NULL;
  const bw_eigen_solve_options options = {.count = 2, .tolerance = 1e-8};
  struct rlimit before, limit;
  check_ok(context, bw_operator_of_matrix(context, matrix, NULL, &a));
  getrlimit(RLIMIT_AS, &before);
  limit = before;
  limit.rlim_cur = (rlim_t)bwi_address_space() + SPARE;
  setrlimit(RLIMIT_AS, &limit);
  bw_status of_inverse = bw_operator_inverse(context, matrix, NULL, &inverse);
  char message[2][400];
  snprintf(message[0], sizeof message[0], "%s", bw_message(context));
  bw_status of_pairs = bw_eigen_solve(context, a, NULL, &options, &pairs);
  snprintf(message[1], sizeof message[1], "%s", bw_message(context));
  setrlimit(RLIMIT_AS, &before);
  assert_int_equal(of_inverse, BW_MEMORY);
  assert_int_equal(of_pairs, BW_MEMORY);
  assert_non_null(strstr(message[0], "conjugate gradients with jacobi need none"));
  assert_non_null(strstr(message[1], "the eigensolver lobpcg needs none"));
  bw_release(a);
  bw_release(matrix);
}
#endif

int main(void) {
  const struct CMUnitTest tests[] = {
      check_test(each_solver_gives_the_closed_form),
      check_test(guesses_save_iterations),
      check_test(bits_do_not_depend_on_threads),
      check_test(failures_are_reported),
      check_test(rounding_is_no_asymmetry),
      check_test(single_precision_takes_any_units),
      check_test(memory_failures),
#ifndef __SANITIZE_ADDRESS__
      check_test(factors_beyond_memory_name_what_needs_none),
#endif
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
