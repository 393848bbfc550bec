/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The block eigensolver by itself, on diagonal problems whose every eigenpair is known: high
 * multiplicity, partners hidden from the start vectors, exhausted spaces. */
#include "bodies.h"

#include "eigen/internal.h"

typedef struct diagonal {
  int64_t size;
  const double *value;
  const uint8_t *hide; /* components kept out of the first random block; NULL: none */
  int projections;
  int counts; /* Sturm counts asked for */
} diagonal;

static bw_status divide(bw_context *context, void *data, int64_t count, const double *f,
                        double *y) {
  (void)context;
  const diagonal *d = data;
  for (int64_t k = 0; k < count; k++)
    for (int64_t i = 0; i < d->size; i++)
      y[k * d->size + i] = f[k * d->size + i] / d->value[i];
  return BW_OK;
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

static void solve(bw_context *context, diagonal *d, int count, bwi_eigen_result *result) {
  bwi_eigen_problem problem = {.size = d->size,
                               .data = d,
                               .solve = divide,
                               .mass = copy,
                               .stiffness = times,
                               .project = hide,
                               .below = below,
                               .dimension = d->size};
  bw_modes_options options;
  bw_modes_options_default(&options);
  options.count = count;
  check_ok(context, bwi_eigen_lowest(context, &problem, &options, result));
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
  diagonal d = {.size = SIZE, .value = value};
  bwi_eigen_result result;
  solve(context, &d, 15, &result);
  assert_int_equal(result.recovered, 0);
  assert_int_equal(d.counts, 1);
  bwi_eigen_result_clear(&result);
  free(value);
}

/* Multiplicity 12: more than the block holds. */
static void multiplicity_beyond_the_block(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 2000 };
  double *value = numbers(SIZE);
  for (int i = 0; i < SIZE; i++)
    value[i] = 1 + i / 12;
  diagonal d = {.size = SIZE, .value = value};
  bwi_eigen_result result;
  solve(context, &d, 12, &result);
  bwi_eigen_result_clear(&result);
  solve(context, &d, 20, &result); /* the last one in the middle of a cluster */
  bwi_eigen_result_clear(&result);
  free(value);
}

/* Two partners that the start block does not contain at all: the count calls for them. */
static void hidden_partners(void **state) {
  bw_context *context = check_context(state);
  enum { SIZE = 1500 };
  double *value = numbers(SIZE);
  uint8_t *mask = calloc(SIZE, 1);
  for (int i = 0; i < SIZE; i++)
    value[i] = 3 + i;
  value[4] = value[3];
  mask[4] = mask[7] = 1;
  diagonal d = {.size = SIZE, .value = value, .hide = mask};
  bwi_eigen_result result;
  solve(context, &d, 10, &result);
  assert_int_equal(result.recovered, 2);
  bwi_eigen_result_clear(&result);
  free(value);
  free(mask);
}

/* Spaces as small as what is asked for, and smaller. */
static void small_spaces(void **state) {
  bw_context *context = check_context(state);
  for (int64_t size = 1; size <= 40; size += 3) {
    double *value = numbers(size);
    for (int64_t i = 0; i < size; i++)
      value[i] = 1 + (double)(i % 5);
    diagonal d = {.size = size, .value = value};
    bwi_eigen_result result;
    solve(context, &d, 15, &result);
    bwi_eigen_result_clear(&result);
    free(value);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {check_test(simple_spectrum),
                                     check_test(multiplicity_beyond_the_block),
                                     check_test(hidden_partners), check_test(small_spaces)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
