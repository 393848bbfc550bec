/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Matrices on plane meshes: the pattern against a dense sum of element matrices, the product, what
 * prescribing unknowns does to the solution, and the same bits on any number of threads. */
#include "grids.h"

typedef struct random_elements {
  int size;
  uint64_t seed;
} random_elements;

static bw_status random_matrix(void *data, int32_t element, double *matrix) {
  const random_elements *r = data;
  bw_random random;
  bw_random_seed(&random, r->seed + (uint64_t)element);
  for (int k = 0; k < r->size; k++)
    matrix[k] = bw_random_uniform(&random) - 0.5;
  return BW_OK;
}

static void compare_with_dense(bw_context *context, int order, int components) {
  bw_plane_topology *topology = grid_create(context, order, 4, 0x35, NULL);
  bw_plane_pattern *pattern;
  check_ok(context, bw_plane_pattern_create(context, topology, &pattern));
  int n = order == 1 ? 3 : 6, rows = n * components, size = pattern->node_count * components;
  random_elements random = {rows * rows, 7};
  double *values = BW_NEW(context, double, pattern->block_count *components *components);
  double *dense = BW_NEW0(context, double, size *size);
  double *x = BW_NEW(context, double, size), *y = BW_NEW(context, double, size);
  check_ok(context,
           bw_plane_assemble(context, pattern, components, random_matrix, &random, values));
  for (int32_t e = 0; e < topology->element_count; e++) {
    double matrix[24 * 24];
    random_matrix(&random, e, matrix);
    const int32_t *node = topology->element + e * n;
    for (int a = 0; a < rows; a++)
      for (int b = 0; b < rows; b++) {
        int i = node[a / components] * components + a % components;
        int j = node[b / components] * components + b % components;
        dense[i * size + j] += matrix[a * rows + b];
      }
  }
  for (int i = 0; i < size; i++)
    x[i] = sin(i + 1.0);
  check_ok(context, bw_plane_multiply(context, pattern, components, values, x, y));
  for (int i = 0; i < size; i++) {
    double sum = 0;
    for (int j = 0; j < size; j++)
      sum += dense[i * size + j] * x[j];
    check_near(y[i], sum, 1e-12);
  }
  for (int32_t i = 0; i < pattern->node_count; i++) {
    assert_int_equal(pattern->column[pattern->diagonal[i]], i);
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++) {
      int64_t q = pattern->mirror[p];
      assert_true(p == pattern->start[i] || pattern->column[p] > pattern->column[p - 1]);
      assert_int_equal(pattern->column[q], i);
      assert_true(pattern->start[pattern->column[p]] <= q &&
                  q < pattern->start[pattern->column[p] + 1]);
      assert_int_equal(pattern->mirror[q], p);
      for (int r = 0; r < components; r++)
        for (int c = 0; c < components; c++)
          check_near(values[components * components * p + components * r + c],
                     dense[(i * components + r) * size + pattern->column[p] * components + c],
                     1e-13);
    }
  }
  bw_free(values);
  bw_free(dense);
  bw_free(x);
  bw_free(y);
  bw_release(pattern);
  bw_release(topology);
}

static void test_dense(void **state) {
  for (int order = 1; order <= 2; order++)
    for (int components = 1; components <= 4; components++)
      compare_with_dense(check_context(state), order, components);
}

/* Held unknowns take their values and the others see the same equations as before. */
static void test_prescribe(void **state) {
  bw_context *context = check_context(state);
  enum { C = 2 };
  bw_plane_topology *topology = grid_create(context, 1, 5, 0, NULL);
  bw_plane_pattern *pattern;
  check_ok(context, bw_plane_pattern_create(context, topology, &pattern));
  int size = pattern->node_count * C;
  random_elements random = {36, 11};
  double *values = BW_NEW(context, double, pattern->block_count *C *C);
  double *before = BW_NEW(context, double, pattern->block_count *C *C);
  uint8_t *is_prescribed = BW_NEW0(context, uint8_t, size);
  double *x = BW_NEW(context, double, size), *y = BW_NEW(context, double, size),
         *rhs = BW_NEW(context, double, size), *full = BW_NEW(context, double, size);
  check_ok(context, bw_plane_assemble(context, pattern, C, random_matrix, &random, values));
  memcpy(before, values, (size_t)pattern->block_count * C * C * sizeof(double));
  for (int i = 0; i < size; i++) {
    is_prescribed[i] = i % 5 == 0 || i % 7 == 3;
    x[i] = cos(3.0 * i);
  }
  /* with this x as the solution the right-hand side is A x at free unknowns */
  check_ok(context, bw_plane_multiply(context, pattern, C, values, x, full));
  memcpy(rhs, full, (size_t)size * sizeof(double));
  check_ok(context, bw_plane_prescribe(context, pattern, C, is_prescribed, x, values, rhs));
  check_ok(context, bw_plane_multiply(context, pattern, C, values, x, y));
  for (int i = 0; i < size; i++)
    check_near(y[i], rhs[i], 1e-13);
  for (int32_t i = 0; i < pattern->node_count; i++)
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++)
      for (int k = 0; k < C * C; k++) {
        int row = i * C + k / C, column = pattern->column[p] * C + k % C;
        if (!is_prescribed[row] && !is_prescribed[column])
          assert_true(values[C * C * p + k] == before[C * C * p + k]);
        else if (row != column)
          assert_true(values[C * C * p + k] == 0);
        else
          assert_true(values[C * C * p + k] > 0);
      }
  bw_free(values);
  bw_free(before);
  bw_free(is_prescribed);
  bw_free(x);
  bw_free(y);
  bw_free(rhs);
  bw_free(full);
  bw_release(pattern);
  bw_release(topology);
}

static void test_threads(void **state) {
  bw_context *context = check_context(state);
  bw_plane_topology *topology = grid_create(context, 1, 96, 0x53, NULL);
  double *first = NULL, *product = NULL;
  for (int threads = 1; threads <= 3; threads++) {
    check_ok(context, bw_set_threads(context, threads));
    bw_plane_pattern *pattern;
    check_ok(context, bw_plane_pattern_create(context, topology, &pattern));
    int64_t size = 2 * (int64_t)pattern->node_count;
    random_elements random = {36, 5};
    double *values = BW_NEW(context, double, 4 * pattern->block_count);
    double *x = BW_NEW(context, double, size), *y = BW_NEW(context, double, size);
    check_ok(context, bw_plane_assemble(context, pattern, 2, random_matrix, &random, values));
    for (int64_t i = 0; i < size; i++)
      x[i] = sin((double)i);
    check_ok(context, bw_plane_multiply(context, pattern, 2, values, x, y));
    if (first) {
      assert_memory_equal(first, values, 4 * (size_t)pattern->block_count * sizeof(double));
      assert_memory_equal(product, y, (size_t)size * sizeof(double));
      bw_free(values);
      bw_free(y);
    } else {
      first = values;
      product = y;
    }
    bw_free(x);
    bw_release(pattern);
  }
  bw_free(first);
  bw_free(product);
  bw_release(topology);
}

static void test_memory(void **state) {
  bw_context *context = check_context(state);
  bw_plane_topology *topology = grid_create(context, 2, 3, 0, NULL);
  check_ok(context, bw_set_threads(context, 1));
  check_each_allocation(context, status, 1) {
    bw_plane_pattern *pattern = NULL;
    status = bw_plane_pattern_create(context, topology, &pattern);
    bw_release(pattern);
  }
  bw_release(topology);
}

static void test_refused(void **state) {
  bw_context *context = check_context(state);
  bw_plane_topology *topology = grid_create(context, 1, 2, 0, NULL);
  bw_plane_pattern *pattern;
  double x[9] = {0};
  check_ok(context, bw_plane_pattern_create(context, topology, &pattern));
  check_fails(context, BW_INVALID, "5 components", bw_plane_multiply(context, pattern, 5, x, x, x));
  check_fails(context, BW_INVALID, "0 components",
              bw_plane_assemble(context, pattern, 0, random_matrix, NULL, x));
  bw_release(pattern);
  bw_release(topology);
}

check_main(check_test(test_dense), check_test(test_prescribe), check_test(test_threads),
           check_test(test_memory), check_test(test_refused))
