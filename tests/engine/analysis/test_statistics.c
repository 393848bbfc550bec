/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Rank correlation and weighted quantiles against small cases worked by hand. */
#include "check.h"

static void spearman_by_hand(void **state) {
  bw_context *context = check_context(state);
  double rho;
  /* Without ties: 1 - 6 sum d^2 / (n (n^2 - 1)). */
  const double a[5] = {1, 2, 3, 4, 5}, b[5] = {2, 1, 4, 3, 5};
  check_ok(context, bw_rank_correlation(context, 5, a, b, &rho));
  check_near(rho, 1 - 6.0 * 4 / (5 * 24), 1e-15);
  /* Only the order counts. */
  double c[5];
  for (int i = 0; i < 5; i++)
    c[i] = exp(3 * b[i]);
  check_ok(context, bw_rank_correlation(context, 5, a, c, &rho));
  check_near(rho, 0.8, 1e-15);
  for (int i = 0; i < 5; i++)
    c[i] = -a[i];
  check_ok(context, bw_rank_correlation(context, 5, a, c, &rho));
  check_near(rho, -1, 1e-15);
  /* Ties averaged: ranks 1, 2.5, 2.5, 4 against 1, 2, 3, 4: cov 4.5, variances 4.5 and 5. */
  const double d[4] = {0, 7, 7, 9}, e[4] = {1, 2, 3, 4};
  check_ok(context, bw_rank_correlation(context, 4, d, e, &rho));
  check_near(rho, 4.5 / sqrt(4.5 * 5), 1e-15);
}

/* A sample of weight 2 is two samples of weight 1. */
static void weights_are_repetitions(void **state) {
  bw_context *context = check_context(state);
  const double a[4] = {3, 1, 4, 1.5}, b[4] = {2, 7, 1, 8}, w[4] = {2, 1, 3, 1};
  const double aa[7] = {3, 3, 1, 4, 4, 4, 1.5}, bb[7] = {2, 2, 7, 1, 1, 1, 8};
  double once, twice;
  check_ok(context, bw_weighted_rank_correlation(context, 4, a, b, w, &once));
  check_ok(context, bw_rank_correlation(context, 7, aa, bb, &twice));
  check_near(once, twice, 1e-14);
}

static void quantiles_by_hand(void **state) {
  bw_context *context = check_context(state);
  const double v[5] = {5, 1, 4, 2, 3}, w[5] = {1, 1, 6, 1, 1};
  double q;
  check_ok(context, bw_weighted_quantile(context, 5, v, NULL, 0, &q));
  check_near(q, 1, 0);
  check_ok(context, bw_weighted_quantile(context, 5, v, NULL, 0.5, &q));
  check_near(q, 3, 0);
  check_ok(context, bw_weighted_quantile(context, 5, v, NULL, 1, &q));
  check_near(q, 5, 0);
  check_ok(context, bw_weighted_quantile(context, 5, v, w, 0.31, &q));
  check_near(q, 4, 0);
  check_ok(context, bw_weighted_quantile(context, 5, v, w, 0.9, &q));
  check_near(q, 4, 0);
  check_ok(context, bw_weighted_quantile(context, 5, v, w, 0.91, &q));
  check_near(q, 5, 0);
}

static void nonsense_is_refused(void **state) {
  bw_context *context = check_context(state);
  const double a[3] = {1, NAN, 2}, b[3] = {1, 2, 3}, same[3] = {4, 4, 4}, w[3] = {1, -1, 1};
  double out;
  check_fails(context, BW_INVALID, "sample 2", bw_rank_correlation(context, 3, a, b, &out));
  check_fails(context, BW_INVALID, "second", bw_rank_correlation(context, 3, b, same, &out));
  check_fails(context, BW_INVALID, "first", bw_rank_correlation(context, 3, same, b, &out));
  check_fails(context, BW_INVALID, "at least 2", bw_rank_correlation(context, 1, b, b, &out));
  check_fails(context, BW_INVALID, "at least 1",
              bw_weighted_quantile(context, 0, b, NULL, 0.5, &out));
  check_fails(context, BW_INVALID, "0 to 1 expected",
              bw_weighted_quantile(context, 3, b, NULL, 1.5, &out));
  check_fails(context, BW_INVALID, "weight -1", bw_weighted_quantile(context, 3, b, w, 0.5, &out));
}

static void allocation_failures(void **state) {
  bw_context *context = check_context(state);
  const double a[3] = {1, 3, 2}, b[3] = {1, 2, 3};
  for (int64_t fail = 1;; fail++) {
    double out;
    bw_fail_allocation(fail, true);
    bw_status status = bw_rank_correlation(context, 3, a, b, &out);
    bw_fail_allocation(0, false);
    if (status == BW_OK) {
      assert_int_equal(fail, 4 + 1);
      break;
    }
    assert_int_equal(status, BW_MEMORY);
  }
}

check_main(check_test(spearman_by_hand), check_test(weights_are_repetitions),
           check_test(quantiles_by_hand), check_test(nonsense_is_refused),
           check_test(allocation_failures))
