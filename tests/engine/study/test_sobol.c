/* Sobol's points: what holds of dyadic boxes, exactly, and what it is good for. */
#include "check.h"

#include "study/sobol.h"

static double *points(bw_context *context, int64_t count, int dimensions,
                      bw_sobol_options options) {
  double *x = BW_NEW(context, double, count *dimensions);
  assert_non_null(x);
  check_ok(context, bw_sobol(context, count, dimensions, &options, x));
  return x;
}

/* How many primitive polynomials of each degree there are is known: phi(2^d - 1) / d. */
static void test_polynomials(void **state) {
  (void)state;
  static const int known[] = {0, 1, 1, 2, 2, 6, 6, 18, 16, 48, 60, 176, 144, 630};
  int count[BWI_SOBOL_DEGREE + 1] = {0}, all = 1;
  bwi_polynomial p = {0, 0};
  for (; bwi_next_primitive(&p); all++)
    count[p.degree]++;
  for (int d = 1; d <= BWI_SOBOL_DEGREE; d++)
    assert_int_equal(count[d], known[d]);
  assert_int_equal(all, BW_SOBOL_DIMENSIONS);
}

/* Each dyadic interval holds one of 2^k points: in every dimension, scrambled or not. */
static void test_lines(void **state) {
  enum { K = 9, COUNT = 1 << K };
  bw_context *context = check_context(state);
  bw_sobol_options options[] = {
      {0, false, 0}, {0, true, 1}, {0, true, 2}, {3 * COUNT, false, 0}, {5 * COUNT, true, 3}};
  for (size_t o = 0; o < sizeof options / sizeof *options; o++) {
    double *x = points(context, COUNT, BW_SOBOL_DIMENSIONS, options[o]);
    for (int j = 0; j < BW_SOBOL_DIMENSIONS; j++)
      for (int k = 0; k <= K; k++) {
        uint8_t held[COUNT] = {0};
        for (int i = 0; i < 1 << k; i++) {
          double u = x[i * BW_SOBOL_DIMENSIONS + j];
          assert_true(u >= 0 && u < 1);
          held[(int)(u * (1 << k))]++;
        }
        for (int i = 0; i < 1 << k; i++)
          assert_int_equal(held[i], 1);
      }
    bw_free(x);
  }
}

/* Points in the boxes of 2^-i by 2^-j for all i + j = m - t: 2^t in each. */
static bool is_net(const double *x, int dimensions, int a, int b, int m, int t) {
  for (int i = 0; i <= m - t; i++) {
    int j = m - t - i, *held = calloc((size_t)1 << (m - t), sizeof *held);
    bool good = true;
    for (int64_t k = 0; k < (int64_t)1 << m; k++) {
      int u = (int)(x[k * dimensions + a] * (1 << i)), v = (int)(x[k * dimensions + b] * (1 << j));
      held[u << j | v]++;
    }
    for (int k = 0; k < 1 << (m - t); k++)
      good = good && held[k] == 1 << t;
    free(held);
    if (!good)
      return false;
  }
  return true;
}

/* The t that the columns promise is the one that the points keep, and no smaller one. */
static void test_planes(void **state) {
  enum { D = 12 };
  bw_context *context = check_context(state);
  uint32_t column[D][BWI_SOBOL_BITS];
  double *x = points(context, 1 << 10, D, (bw_sobol_options){0});
  double *y = points(context, 1 << 10, D, (bw_sobol_options){0, true, 5});
  /* Columns from points: point 2^k of a dimension is column k. */
  for (int j = 0; j < D; j++)
    for (int k = 0; k < 10; k++)
      column[j][k] = (uint32_t)(x[((int64_t)1 << k) * D + j] * 0x1p32);
  for (int a = 0; a < D; a++)
    for (int b = 0; b < a; b++)
      for (int m = 2; m <= 10; m += 2) {
        int t = bwi_sobol_t(column[a], column[b], m);
        assert_true(is_net(x, D, a, b, m, t));
        assert_true(is_net(y, D, a, b, m, t));
        assert_true(t == 0 || !is_net(x, D, a, b, m, t - 1));
      }
  bw_free(x);
  bw_free(y);
}

/* The chosen numbers, as docs/theory/studies.md states them. */
static void test_quality(void **state) {
  bw_context *context = check_context(state);
  enum { M = 12, D = 200 };
  double *x = points(context, 1 << M, D, (bw_sobol_options){0});
  static uint32_t column[D][BWI_SOBOL_BITS];
  for (int j = 0; j < D; j++)
    for (int k = 0; k < M; k++)
      column[j][k] = (uint32_t)(x[((int64_t)1 << k) * D + j] * 0x1p32);
  static const struct {
    int dimensions, worst;
    double mean;
  } stated[] = {{10, 3, 1.9}, {50, 7, 2.7}, {200, 9, 3.15}};
  for (int s = 0; s < 3; s++) {
    int worst = 0, count = 0;
    double sum = 0;
    for (int a = 1; a < stated[s].dimensions; a++)
      for (int b = 0; b < a; b++, count++) {
        int t = bwi_sobol_t(column[a], column[b], M);
        sum += t;
        worst = t > worst ? t : worst;
      }
    if (worst > stated[s].worst || sum / count > stated[s].mean)
      fail_msg("%d dimensions: t %.3f on average, %d at worst", stated[s].dimensions, sum / count,
               worst);
  }
  bw_free(x);
}

/* Root mean square error of the mean of a smooth function in six dimensions whose integral is 1,
 * over seeds; with pseudo-random points where `plain`. */
static double error_of(bw_context *context, int64_t count, bool plain) {
  enum { D = 6, SEEDS = 12 };
  double sum = 0;
  for (uint64_t seed = 1; seed <= SEEDS; seed++) {
    double *x = points(context, count, D, (bw_sobol_options){0, true, seed}), mean = 0;
    bw_random random;
    bw_random_seed(&random, seed);
    for (int64_t i = 0; i < count; i++) {
      double product = 1;
      for (int j = 0; j < D; j++) {
        double u = plain ? bw_random_uniform(&random) : x[i * D + j];
        product *= 1 + (u - 0.5) / (j + 1);
      }
      mean += product / (double)count;
    }
    sum += (mean - 1) * (mean - 1);
    bw_free(x);
  }
  return sqrt(sum / SEEDS);
}

static void test_integration(void **state) {
  bw_context *context = check_context(state);
  double coarse = error_of(context, 1 << 7, false), fine = error_of(context, 1 << 13, false);
  double order = log(coarse / fine) / log(64);
  double random_order =
      log(error_of(context, 1 << 7, true) / error_of(context, 1 << 13, true)) / log(64);
  printf("error falls as N^-%.2f; with random points as N^-%.2f\n", order, random_order);
  assert_true(order > 1.0);
  assert_true(random_order < 0.8);
  assert_true(fine < 0.02 * error_of(context, 1 << 13, true));
}

static void test_parts_and_seeds(void **state) {
  bw_context *context = check_context(state);
  double *all = points(context, 1000, 5, (bw_sobol_options){0, true, 9});
  double *part = points(context, 300, 3, (bw_sobol_options){417, true, 9});
  double *other = points(context, 1000, 5, (bw_sobol_options){0, true, 10});
  double *plain = points(context, 4, 2, (bw_sobol_options){0});
  for (int i = 0; i < 300; i++)
    for (int j = 0; j < 3; j++)
      check_near(part[i * 3 + j], all[(i + 417) * 5 + j], 0);
  assert_memory_not_equal(all, other, 1000 * 5 * sizeof *all);
  static const double first[] = {0, 0, 0.5, 0.5, 0.25, 0.75, 0.75, 0.25};
  assert_memory_equal(plain, first, sizeof first);
  bw_free(all);
  bw_free(part);
  bw_free(other);
  bw_free(plain);
  double last[2];
  check_ok(context, bw_sobol(context, 1, 2, &(bw_sobol_options){4294967295, false, 0}, last));
  check_near(last[0], 1 - 0x1p-32, 0);
  check_fails(context, BW_INVALID, "1 to 1111",
              bw_sobol(context, 1, BW_SOBOL_DIMENSIONS + 1, NULL, last));
  check_fails(context, BW_INVALID, "there are 2^32",
              bw_sobol(context, 2, 1, &(bw_sobol_options){4294967295, false, 0}, last));
  bw_fail_allocation(1, true);
  bw_status status = bw_sobol(context, 1, 2, NULL, last);
  bw_fail_allocation(0, false);
  assert_int_equal(status, BW_MEMORY);
}

check_main(check_test(test_polynomials), check_test(test_lines), check_test(test_planes),
           check_test(test_quality), check_test(test_integration), check_test(test_parts_and_seeds))
