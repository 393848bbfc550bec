/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Rules integrate what 2 x 2 x 2 Gauss points in every small cube must, and their numbering is that
 * of children within children. */
#include "check.h"

/* Integral over the unit cube of x^a y^b z^c. */
static double moment(const bw_rule *rule, int a, int b, int c) {
  double sum = 0;
  for (int32_t q = 0; q < rule->count; q++)
    sum += rule->weight[q] * pow(rule->at[3 * q], a) * pow(rule->at[3 * q + 1], b) *
           pow(rule->at[3 * q + 2], c);
  return sum;
}

static void test_exact(void **state) {
  bw_context *context = check_context(state);
  for (int level = 0; level <= 3; level++) {
    bw_rule *rule = NULL;
    check_ok(context, bw_rule_create(context, level, &rule));
    assert_int_equal(rule->count, level < 2 ? 8 : level == 2 ? 64 : 512);
    for (int a = 0; a <= 3; a++)
      for (int b = 0; b <= 3; b++)
        for (int c = 0; c <= 3; c++)
          check_near(moment(rule, a, b, c), 1.0 / ((a + 1) * (b + 1) * (c + 1)), 1e-15);
    bw_release(rule);
  }
}

static void test_functions(void **state) {
  bw_context *context = check_context(state);
  bw_rule *rule = NULL;
  check_ok(context, bw_rule_create(context, 2, &rule));
  for (int32_t q = 0; q < rule->count; q++) {
    const double *x = rule->at + 3 * (size_t)q;
    double sum[10] = {0};
    /* the functions interpolate 1 and x: values and gradients of both */
    for (int c = 0; c < 8; c++) {
      const double *g = rule->gradient + 24 * (size_t)q + 3 * (size_t)c;
      double value = rule->value[8 * q + c];
      sum[0] += value;
      for (int d = 0; d < 3; d++) {
        sum[1 + d] += value * (c >> d & 1);
        sum[4 + d] += g[d];
        sum[7 + d] += g[d] * (c >> d & 1);
      }
    }
    check_near(sum[0], 1, 1e-15);
    for (int d = 0; d < 3; d++) {
      check_near(sum[1 + d], x[d], 1e-15);
      check_near(sum[4 + d], 0, 1e-15);
      check_near(sum[7 + d], 1, 1e-15);
    }
    /* point q is number q % 8 of small cube q / 8, corners' order both */
    for (int d = 0; d < 3; d++) {
      double low = 0.5 * (q / 8 >> d & 1), half = low + 0.25 * (q % 8 >> d & 1);
      assert_true(x[d] > half && x[d] < half + 0.25);
    }
  }
  bw_release(rule);
}

/* Points drawn towards the middle: places scaled, weights kept, linear functions still exact. */
static void test_spread(void **state) {
  bw_context *context = check_context(state);
  const double spread[3] = {0.5, 1, 0.8};
  bw_rule *rule = NULL, *plain = NULL;
  check_ok(context, bw_rule_create(context, 1, &plain));
  check_ok(context, bw_rule_create_spread(context, 1, spread, &rule));
  for (int32_t q = 0; q < 8; q++)
    for (int d = 0; d < 3; d++)
      check_near(rule->at[3 * q + d] - 0.5, spread[d] * (plain->at[3 * q + d] - 0.5), 1e-16);
  check_near(moment(rule, 1, 0, 0), 0.5, 1e-15);
  check_near(moment(rule, 2, 0, 0), 0.25 + 0.25 / 12, 1e-15);
  bw_release(rule);
  bw_release(plain);
}

static void test_refused(void **state) {
  bw_context *context = check_context(state);
  bw_rule *rule = NULL;
  const double none[3] = {1, 0, 1}, wide[3] = {1, 1, 1.5}, odd[3] = {NAN, 1, 1};
  check_fails(context, BW_INVALID, "level -1", bw_rule_create(context, -1, &rule));
  check_fails(context, BW_INVALID, "level 6", bw_rule_create(context, 6, &rule));
  check_fails(context, BW_INVALID, "spread", bw_rule_create_spread(context, 1, none, &rule));
  check_fails(context, BW_INVALID, "spread", bw_rule_create_spread(context, 1, wide, &rule));
  check_fails(context, BW_INVALID, "spread", bw_rule_create_spread(context, 1, odd, &rule));
  assert_null(rule);
  check_each_allocation(context, status, 1) {
    status = bw_rule_create(context, 1, &rule);
  }
  assert_true(bw_bytes(rule) > 8 * 36 * sizeof(double));
  bw_release(rule);
}

check_main(check_test(test_exact), check_test(test_functions), check_test(test_spread),
           check_test(test_refused))
