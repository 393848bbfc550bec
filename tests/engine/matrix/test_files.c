/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sparse matrices and arrays in files: what is written is read back to the last bit, by SciPy too
 * where it is installed; the examples of the format's paper; files that are damaged. */
#include "check.h"

#include "barwright/io.h"
#include "barwright/matrix.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { ROWS = 9, COLUMNS = 7 };

static double entry(int i, int j) {
  return (7 * i + 5 * j) % 4 == 0 ? 1.0 / (1 + i + 3 * j) : 0;
}

static bw_sparse_matrix *make_matrix(bw_context *context) {
  int32_t row[ROWS * COLUMNS], column[ROWS * COLUMNS];
  double value[ROWS * COLUMNS];
  int count = 0;
  for (int j = COLUMNS - 1; j >= 0; j--) /* not in the order of rows */
    for (int i = 0; i < ROWS; i++)
      if (entry(i, j) != 0) {
        row[count] = i;
        column[count] = j;
        value[count++] = entry(i, j);
      }
  bw_sparse_matrix *matrix = NULL;
  check_ok(context,
           bw_sparse_matrix_create(context, ROWS, COLUMNS, count, row, column, value, &matrix));
  return matrix;
}

/* Tridiagonal: 2 and -0.1, with two more entries. */
static bw_sparse_matrix *make_symmetric(bw_context *context) {
  int32_t row[32], column[32];
  double value[32];
  int count = 0;
  for (int i = 0; i < 5; i++)
    for (int j = i - 2; j <= i + 2; j++)
      if (j >= 0 && j < 5 && (i == j || (i + j) % 2 == 0 || i + j == 3)) {
        row[count] = i;
        column[count] = j;
        value[count++] = i == j ? 2 : -0.1;
      }
  bw_sparse_matrix *matrix = NULL;
  check_ok(context, bw_sparse_matrix_create(context, 5, 5, count, row, column, value, &matrix));
  assert_true(bw_sparse_matrix_is_symmetric(matrix));
  return matrix;
}

static void same_matrix(const bw_sparse_matrix *a, const bw_sparse_matrix *b) {
  assert_int_equal(a->rows, b->rows);
  assert_int_equal(a->columns, b->columns);
  assert_memory_equal(a->start, b->start, ((size_t)a->rows + 1) * sizeof *a->start);
  assert_memory_equal(a->column, b->column, (size_t)a->start[a->rows] * sizeof *a->column);
  assert_memory_equal(a->value, b->value, (size_t)a->start[a->rows] * sizeof *a->value);
}

static const char *in(const char *folder, const char *name) {
  static char path[4][256];
  static int at;
  at = (at + 1) % 4;
  snprintf(path[at], sizeof path[at], "%s/%s", folder, name);
  return path[at];
}

static void make_folder(char folder[64]) {
  strcpy(folder, "/tmp/barwright-matrix-XXXXXX");
  assert_non_null(mkdtemp(folder));
}

static void remove_folder(const char *folder) {
  char command[128];
  snprintf(command, sizeof command, "rm -r '%s'", folder);
  assert_int_equal(system(command), 0);
}

static void duplicates_are_added_in_order(void **state) {
  bw_context *context = check_context(state);
  const int32_t row[] = {1, 0, 1, 1}, column[] = {0, 1, 2, 0};
  const double value[] = {1e16, 3, 4, 1};
  const double x[] = {1, 10, 100, 2, 0, 0};
  double y[4];
  bw_sparse_matrix *matrix = NULL;
  check_ok(context, bw_sparse_matrix_create(context, 2, 3, 4, row, column, value, &matrix));
  assert_int_equal(matrix->start[2], 3);
  assert_true(matrix->value[1] == 1e16 + 1);
  check_ok(context, bw_sparse_matrix_apply(context, matrix, 2, x, y));
  assert_true(y[0] == 30 && y[1] == 1e16 + 1 + 400 && y[2] == 0 && y[3] == 2e16 + 2);
  assert_false(bw_sparse_matrix_is_symmetric(matrix));
  bw_release(matrix);
  const int32_t outside[] = {1, 0, 2, 1};
  check_fails(context, BW_INVALID, "entry 3 lies at (3, 3) of a matrix of 2 x 3",
              bw_sparse_matrix_create(context, 2, 3, 4, outside, column, value, &matrix));
}

static void long_rows_are_sorted(void **state) {
  bw_context *context = check_context(state);
  enum { N = 1000 };
  int64_t *start = BW_NEW(context, int64_t, 2);
  int32_t *column = BW_NEW(context, int32_t, N);
  double *value = BW_NEW(context, double, N);
  start[0] = 0;
  start[1] = N;
  for (int i = 0; i < N; i++)
    value[i] = column[i] = i * 617 % N;
  bw_sparse_matrix *matrix = NULL;
  check_ok(context, bw_sparse_matrix_adopt(context, 1, N, start, column, value, &matrix));
  for (int i = 0; i < N; i++)
    assert_true(matrix->column[i] == i && matrix->value[i] == i);
  bw_release(matrix);
}

static bw_array *make_array(bw_context *context) {
  bw_array *array = NULL, *view = NULL;
  check_ok(context, bw_array_create(context, BW_F64, 4, 6, &array));
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 6; j++)
      ((double *)array->data)[6 * i + j] = sqrt(j + 10.0 * (3 - i));
  /* the transpose would need a view that no function makes: reversed rows do as well */
  check_ok(context, bw_array_view(context, array, 3, 4, -1, 0, 6, 1, &view));
  bw_release(array);
  check_ok(context, bw_array_create(context, BW_F64, 6, 4, &array));
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 4; j++)
      ((double *)array->data)[4 * i + j] = bw_array_get(view, j, i);
  bw_release(view);
  return array;
}

static void same_array(const bw_array *a, const bw_array *b, double tolerance) {
  assert_int_equal(a->rows, b->rows);
  assert_int_equal(a->columns, b->columns);
  for (int64_t i = 0; i < a->rows; i++)
    for (int64_t j = 0; j < a->columns; j++)
      check_near(bw_array_get(a, i, j), bw_array_get(b, i, j), tolerance);
}

static void files_are_read_back(void **state) {
  bw_context *context = check_context(state);
  char folder[64];
  make_folder(folder);
  bw_sparse_matrix *made[2] = {make_matrix(context), make_symmetric(context)};
  for (int k = 0; k < 2; k++)
    for (int f = 0; f < 2; f++) {
      const char *path = in(folder, f == 0 ? "k.mtx" : "k.npz");
      bw_sparse_matrix *back = NULL;
      check_ok(context, bw_sparse_matrix_write(context, made[k], path));
      check_ok(context, bw_sparse_matrix_read(context, path, &back));
      same_matrix(made[k], back);
      bw_release(back);
    }
  check_fails(context, BW_UNSUPPORTED, ".mtx",
              bw_sparse_matrix_write(context, made[0], in(folder, "k.csv")));
  /* numbers that are not finite; zeros that differ in sign alone are not symmetric */
  const int32_t row[] = {0, 0, 1, 1}, column[] = {0, 1, 0, 1};
  const double special[] = {-INFINITY, 0, -0.0, NAN};
  bw_sparse_matrix *odd = NULL;
  check_ok(context, bw_sparse_matrix_create(context, 2, 2, 4, row, column, special, &odd));
  assert_false(bw_sparse_matrix_is_symmetric(odd));
  for (int f = 0; f < 2; f++) {
    const char *path = in(folder, f == 0 ? "o.mtx" : "o.npz");
    bw_sparse_matrix *back = NULL;
    check_ok(context, bw_sparse_matrix_write(context, odd, path));
    check_ok(context, bw_sparse_matrix_read(context, path, &back));
    assert_true(back->value[0] == -INFINITY && signbit(back->value[2]) && isnan(back->value[3]));
    assert_false(signbit(back->value[1]));
    bw_release(back);
  }
  bw_release(odd);
  for (int k = 0; k < 2; k++)
    bw_release(made[k]);
  const bw_type types[] = {BW_F64, BW_I32, BW_I64, BW_U8};
  for (int t = 0; t < 4; t++) {
    bw_array *whole = NULL, *array = NULL, *back = NULL;
    check_ok(context, bw_array_create(context, types[t], 5, 4, &whole));
    for (size_t i = 0; i < 20 * bw_type_size(types[t]); i++)
      ((uint8_t *)whole->data)[i] = (uint8_t)(types[t] == BW_F64 ? 0 : i);
    check_ok(context, bw_array_view(context, whole, 4, 3, -2, 1, 2, 2, &array));
    check_ok(context, bw_array_write(context, array, in(folder, "b.npy")));
    check_ok(context, bw_array_read(context, in(folder, "b.npy"), &back));
    assert_int_equal(back->type, types[t]);
    same_array(array, back, 0);
    bw_release(back);
    bw_release(array);
    bw_release(whole);
  }
  bw_array *array = make_array(context), *back = NULL;
  check_ok(context, bw_array_write(context, array, in(folder, "b.mtx")));
  check_ok(context, bw_array_read(context, in(folder, "b.mtx"), &back));
  same_array(array, back, 0);
  check_fails(context, BW_UNSUPPORTED, ".npy", bw_array_write(context, array, in(folder, "b.txt")));
  bw_release(array);
  bw_release(back);
  remove_folder(folder);
}

static void scipy_reads_and_writes_them(void **state) {
  bw_context *context = check_context(state);
  char folder[64], command[512];
  make_folder(folder);
  bw_sparse_matrix *a = make_matrix(context), *s = make_symmetric(context), *back = NULL;
  bw_array *b = make_array(context), *c = NULL, *read = NULL;
  check_ok(context, bw_array_create(context, BW_I32, 5, 1, &c));
  for (int i = 0; i < 5; i++)
    ((int32_t *)c->data)[i] = i * i;
  check_ok(context, bw_sparse_matrix_write(context, a, in(folder, "a.npz")));
  check_ok(context, bw_sparse_matrix_write(context, a, in(folder, "a.mtx")));
  check_ok(context, bw_sparse_matrix_write(context, s, in(folder, "s.mtx")));
  check_ok(context, bw_array_write(context, b, in(folder, "b.npy")));
  check_ok(context, bw_array_write(context, b, in(folder, "b.mtx")));
  check_ok(context, bw_array_write(context, c, in(folder, "c.npy")));
  static const char *const python[] = {"python3", "/usr/bin/python3"};
  bool there = false;
  for (int k = 0; k < 2 && !there; k++) {
    snprintf(command, sizeof command, "%s tests/engine/matrix/read_scipy.py %s", python[k], folder);
    int result = system(command);
    there = WIFEXITED(result) && WEXITSTATUS(result) != 77 && WEXITSTATUS(result) != 127;
    assert_true(!there || result == 0);
  }
  if (there) {
    const char *const same[] = {"packed.npz", "stored.npz", "general.mtx"};
    for (int k = 0; k < 3; k++) {
      check_ok(context, bw_sparse_matrix_read(context, in(folder, same[k]), &back));
      same_matrix(a, back);
      bw_release(back);
    }
    check_ok(context, bw_sparse_matrix_read(context, in(folder, "symmetric.mtx"), &back));
    same_matrix(s, back);
    bw_release(back);
    check_ok(context, bw_array_read(context, in(folder, "fortran.npy"), &read));
    same_array(b, read, 0);
    bw_release(read);
    check_ok(context, bw_array_read(context, in(folder, "big.npy"), &read));
    same_array(b, read, 1e-6);
    bw_release(read);
    check_ok(context, bw_array_read(context, in(folder, "bool.npy"), &read));
    for (int i = 0; i < 6; i++)
      for (int j = 0; j < 4; j++)
        assert_true(bw_array_get(read, i, j) == (bw_array_get(b, i, j) > 3));
    bw_release(read);
    check_fails(context, BW_UNSUPPORTED, "format 'csc'",
                bw_sparse_matrix_read(context, in(folder, "csc.npz"), &back));
    check_fails(context, BW_UNSUPPORTED, "more than two dimensions",
                bw_array_read(context, in(folder, "cube.npy"), &read));
    check_fails(context, BW_UNSUPPORTED, "'<c16'",
                bw_array_read(context, in(folder, "complex.npy"), &read));
  }
  bw_release(a);
  bw_release(s);
  bw_release(b);
  bw_release(c);
  remove_folder(folder);
  if (!there)
    print_message("  SciPy is not installed\n");
}

static bw_status parse(bw_context *context, const char *text, bw_sparse_matrix **matrix) {
  *matrix = NULL;
  return bw_sparse_matrix_parse(context, "a.mtx", (const unsigned char *)text, strlen(text),
                                matrix);
}

/* Files of the kinds that the format has, and faults in them by line. */
static void matrix_market_has_several_kinds(void **state) {
  bw_context *context = check_context(state);
  bw_sparse_matrix *matrix;
  check_ok(context, parse(context,
                          "%%MatrixMarket  MATRIX Coordinate Real General\r\n% a comment\r\n\r\n"
                          "  3 4 2 \r\n1 4 1.5e1\r\n3 1 -2\r\n",
                          &matrix));
  assert_true(matrix->rows == 3 && matrix->columns == 4 && matrix->value[0] == 15);
  bw_release(matrix);
  check_ok(context,
           parse(context, "%%MatrixMarket matrix coordinate pattern symmetric\n2 2 2\n1 1\n2 1",
                 &matrix));
  assert_true(matrix->start[2] == 3 && matrix->value[2] == 1);
  bw_release(matrix);
  check_ok(context,
           parse(context, "%%MatrixMarket matrix coordinate integer skew-symmetric\n2 2 1\n2 1 7\n",
                 &matrix));
  assert_true(matrix->value[0] == -7 && matrix->value[1] == 7);
  bw_release(matrix);
  static const struct {
    bw_status status;
    const char *text, *message;
  } bad[] = {
      {BW_FORMAT, "%%MatrixMarket matrix coordinate real general\n2 2 1\n3 1 5\n",
       "a.mtx:3: an entry at (3, 1) of a matrix of 2 x 2"},
      {BW_FORMAT, "%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n1 2 5\n",
       "a.mtx:3: an entry at (1, 2) lies above the diagonal"},
      {BW_FORMAT, "%%MatrixMarket matrix coordinate real symmetric\n2 3 1\n1 2 5\n", "square"},
      {BW_FORMAT, "%%MatrixMarket matrix coordinate real general\n2 2 1\n1 1 x\n", "a.mtx:3: "},
      {BW_FORMAT, "%%MatrixMarket matrix coordinate real general\n2 2 900\n1 1 1\n",
       "entries is 900, but only"},
      {BW_FORMAT, "%%MatrixMarket matrix coordinate real general\n2 2 1\n1 1 1\n2 2 2\n",
       "a.mtx:4: found 2 behind the last entry"},
      {BW_FORMAT, "%%MatrixMarket matrix coordinate real general\n2 2 1\n1 1\n", "the value"},
      {BW_UNSUPPORTED, "%%MatrixMarket matrix coordinate complex general\n2 2 0\n", "complex"},
      {BW_FORMAT, "%%MatrixMarket matrix array real general\n1 1\n5\n", "as an array"},
      {BW_FORMAT, "%%MatrixMarket vector coordinate real general\n1 1\n5\n", "'matrix'"},
      {BW_FORMAT, "%%MatrixMarket matrix coordinate real hermitian\n1 1 0\n", "'symmetric'"},
      {BW_FORMAT, "%%MatrixMarket matrix coordinate real general\n1000000000 5 0\n",
       "the number must be wrong"},
      {BW_LIMIT, "%%MatrixMarket matrix coordinate real general\n3000000000 5 0\n", "2^31"},
      {BW_FORMAT, "1 2 3\n", "neither Matrix Market"},
  };
  for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
    check_fails(context, bad[i].status, bad[i].message, parse(context, bad[i].text, &matrix));
}

/* Every file that is cut short or has one byte changed is refused with a message, or read. */
static void damaged_archives(void **state) {
  bw_context *context = check_context(state);
  char folder[64];
  unsigned char *bytes = NULL;
  size_t count = 0;
  make_folder(folder);
  bw_sparse_matrix *a = make_matrix(context), *matrix = NULL;
  check_ok(context, bw_sparse_matrix_write(context, a, in(folder, "a.npz")));
  check_ok(context, bw_read_file(context, in(folder, "a.npz"), &bytes, &count));
  for (size_t cut = 0; cut < count; cut++) {
    matrix = NULL;
    assert_int_not_equal(bw_sparse_matrix_parse(context, "a.npz", bytes, cut, &matrix), BW_OK);
    assert_null(matrix);
    assert_true(strlen(bw_message(context)) > 8);
  }
  int refused = 0;
  for (size_t at = 0; at < count; at++) {
    bytes[at] ^= 0x41;
    matrix = NULL;
    bw_status status = bw_sparse_matrix_parse(context, "a.npz", bytes, count, &matrix);
    assert_int_equal(status == BW_OK, matrix != NULL);
    if (matrix)
      same_matrix(a, matrix); /* the byte does not matter: a date, a version */
    refused += status != BW_OK;
    bw_release(matrix);
    bytes[at] ^= 0x41;
  }
  assert_true(refused > (int)count / 2);
  bw_free(bytes);
  bw_release(a);
  remove_folder(folder);
}

static void memory_runs_out(void **state) {
  bw_context *context = check_context(state);
  char folder[64];
  make_folder(folder);
  bw_sparse_matrix *a = make_matrix(context);
  check_ok(context, bw_sparse_matrix_write(context, a, in(folder, "a.npz")));
  check_ok(context, bw_sparse_matrix_write(context, a, in(folder, "a.mtx")));
  for (int f = 0; f < 2; f++)
    check_each_allocation(context, status, 5) {
      const char *path = in(folder, f == 0 ? "a.npz" : "a.mtx");
      bw_sparse_matrix *back = NULL;
      status = bw_sparse_matrix_read(context, path, &back);
      if (status == BW_OK)
        status = bw_sparse_matrix_write(context, back, in(folder, f == 0 ? "b.npz" : "b.mtx"));
      bw_release(back);
    }
  bw_release(a);
  remove_folder(folder);
}

check_main(check_test(duplicates_are_added_in_order), check_test(long_rows_are_sorted),
           check_test(files_are_read_back), check_test(scipy_reads_and_writes_them),
           check_test(matrix_market_has_several_kinds), check_test(damaged_archives),
           check_test(memory_runs_out))
