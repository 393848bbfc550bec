/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Quadrature in the unit cube: 2 x 2 x 2 Gauss points, in the cube or in each of its 8, 64, ...
 * small cubes; and the same drawn towards the middle. */
#include "barwright/nonlinear.h"

#include <math.h>
#include <string.h>

enum { LEVELS = 5 };

static void destroy(void *object) {
  bw_rule *rule = (bw_rule *)object;
  bw_free(rule->at);
  bw_free(rule->weight);
  bw_free(rule->value);
  bw_free(rule->gradient);
  bw_free(rule);
}

static size_t bytes(const void *object) {
  const bw_rule *rule = (const bw_rule *)object;
  return sizeof *rule + (3 + 1 + 8 + 24) * sizeof(double) * (size_t)rule->count;
}

static const bw_kind rule_kind = {"rule", destroy, bytes};

/* Weights, and shape functions with their gradients at the points. */
static void fill(bw_rule *rule) {
  for (int32_t p = 0; p < rule->count; p++) {
    const double *at = rule->at + 3 * (int64_t)p;
    rule->weight[p] = 1.0 / rule->count;
    for (int c = 0; c < 8; c++) {
      double factor[3], slope[3];
      for (int d = 0; d < 3; d++) {
        factor[d] = c >> d & 1 ? at[d] : 1 - at[d];
        slope[d] = c >> d & 1 ? 1 : -1;
      }
      double *gradient = rule->gradient + 24 * (int64_t)p + 3 * (int64_t)c;
      rule->value[8 * (int64_t)p + c] = factor[0] * factor[1] * factor[2];
      gradient[0] = slope[0] * factor[1] * factor[2];
      gradient[1] = factor[0] * slope[1] * factor[2];
      gradient[2] = factor[0] * factor[1] * slope[2];
    }
  }
}

static void place(bw_rule *rule) {
  const double gauss[2] = {0.5 - 0.5 / sqrt(3.0), 0.5 + 0.5 / sqrt(3.0)};
  for (int32_t p = 0; p < rule->count; p++) {
    double *at = rule->at + 3 * (int64_t)p, size = 1;
    int32_t block = rule->count / 8, rest = p;
    at[0] = at[1] = at[2] = 0;
    for (; block > 1; rest %= block, block /= 8) {
      size /= 2;
      for (int d = 0; d < 3; d++)
        at[d] += size * ((rest / block) >> d & 1);
    }
    for (int d = 0; d < 3; d++)
      at[d] += size * gauss[rest / block >> d & 1];
    for (int d = 0; d < 3; d++)
      at[d] = 0.5 + rule->spread[d] * (at[d] - 0.5);
  }
}

bw_status bw_rule_create(bw_context *context, int level, bw_rule **out) {
  const double spread[3] = {1, 1, 1};
  return bw_rule_create_spread(context, level, spread, out);
}

static bw_rule *reserve(bw_context *context, int level, int32_t count, const double spread[3]) {
  bw_rule *rule = BW_NEW0(context, bw_rule, 1);
  if (!rule)
    return NULL;
  bw_object_init(rule, &rule_kind);
  rule->level = level;
  memcpy(rule->spread, spread, sizeof rule->spread);
  rule->count = count;
  rule->at = BW_NEW(context, double, 3 * (int64_t)count);
  rule->weight = BW_NEW(context, double, count);
  rule->value = BW_NEW(context, double, 8 * (int64_t)count);
  rule->gradient = BW_NEW(context, double, 24 * (int64_t)count);
  if (rule->at && rule->weight && rule->value && rule->gradient)
    return rule;
  bw_release(rule);
  return NULL;
}

bw_status bw_rule_create_spread(bw_context *context, int level, const double spread[3],
                                bw_rule **out) {
  if (level < 0 || level > LEVELS)
    return bw_fail(context, BW_INVALID, "quadrature level %d: 0 to %d expected", level, LEVELS);
  for (int d = 0; d < 3; d++)
    if (!(spread[d] > 0 && spread[d] <= 1))
      return bw_fail(context, BW_INVALID,
                     "quadrature points spread by %g: above 0 and at most 1 expected", spread[d]);
  int32_t count = 8;
  for (int l = 1; l < level; l++)
    count *= 8;
  bw_rule *rule = reserve(context, level, count, spread);
  if (!rule)
    return BW_MEMORY;
  place(rule);
  fill(rule);
  *out = rule;
  return BW_OK;
}

bw_status bw_rule_create_selective(bw_context *context, bw_rule **out) {
  const double spread[3] = {1, 1, 1};
  bw_rule *gauss = NULL, *rule = NULL;
  bw_status status = BW_OK;
  BW_TRY(bw_rule_create(context, 0, &gauss));
  rule = reserve(context, 0, 2 * gauss->count, spread);
  BW_TRY_MEMORY(rule);
  memcpy(rule->at, gauss->at, 3 * (size_t)gauss->count * sizeof *rule->at);
  for (int32_t k = 3 * gauss->count; k < 3 * rule->count; k++)
    rule->at[k] = 0.5;
  fill(rule);
  *out = rule;
done:
  bw_release(gauss);
  return status;
}
