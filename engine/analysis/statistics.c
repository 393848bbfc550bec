/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Ranks and quantiles of weighted samples.
 *
 * A sample's weighted rank is the weight of all samples below it plus half the weight of those
 * equal to it (its own included). With equal weights that is the usual rank with ties averaged,
 * less one half, so Spearman's coefficient is the same. */
#include "barwright/analysis.h"

#include <math.h>
#include <stdlib.h>

typedef struct sample {
  double value, weight;
  int64_t index;
} sample;

static int by_value(const void *a, const void *b) {
  const sample *x = (const sample *)a, *y = (const sample *)b;
  if (x->value != y->value)
    return x->value < y->value ? -1 : 1;
  return (x->index > y->index) - (x->index < y->index);
}

static bw_status sorted(bw_context *context, int64_t count, const double *value,
                        const double *weight, sample **list, double *total) {
  if (count < 1)
    return bw_fail(context, BW_INVALID, "a statistic of %lld values: at least 1 is needed",
                   (long long)count);
  *total = 0;
  for (int64_t i = 0; i < count; i++) {
    double w = weight ? weight[i] : 1;
    if (isnan(value[i]) || !(w >= 0) || isinf(w)) {
      bw_status status = bw_fail(context, BW_INVALID,
                                 "sample %lld has value %g and weight %g: values must be numbers, "
                                 "weights finite and not negative",
                                 (long long)i + 1, value[i], w);
      bw_detail_number(context, "sample", (double)i + 1);
      return status;
    }
    *total += w;
  }
  if (!(*total > 0) || isinf(*total))
    return bw_fail(context, BW_INVALID, "the weights of %lld samples add up to %g",
                   (long long)count, *total);
  sample *samples = BW_NEW(context, sample, count);
  if (!samples)
    return BW_MEMORY;
  for (int64_t i = 0; i < count; i++)
    samples[i] = (sample){value[i], weight ? weight[i] : 1, i};
  qsort(samples, (size_t)count, sizeof *samples, by_value);
  *list = samples;
  return BW_OK;
}

/* Ranks less their weighted mean (half the total weight), and their weighted sum of squares. */
static bw_status centred_ranks(bw_context *context, int64_t count, const double *value,
                               const double *weight, double *rank, double *square) {
  sample *list = NULL;
  double total = 0, below = 0;
  bw_status status = sorted(context, count, value, weight, &list, &total);
  if (status != BW_OK)
    return status;
  *square = 0;
  for (int64_t i = 0; i < count;) {
    int64_t end = i;
    double tied = 0;
    while (end < count && list[end].value == list[i].value)
      tied += list[end++].weight;
    double r = below + 0.5 * tied - 0.5 * total;
    *square += tied * r * r;
    below += tied;
    for (; i < end; i++)
      rank[list[i].index] = r;
  }
  bw_free(list);
  return BW_OK;
}

bw_status bw_weighted_rank_correlation(bw_context *context, int64_t count, const double *a,
                                       const double *b, const double *weight, double *rho) {
  bw_status status = BW_OK;
  double *rank_a = NULL, *rank_b = NULL, square_a, square_b, product = 0;
  if (count < 2)
    return bw_fail(context, BW_INVALID, "a rank correlation of %lld pairs: at least 2 are needed",
                   (long long)count);
  rank_a = BW_NEW(context, double, count);
  rank_b = BW_NEW(context, double, count);
  BW_TRY_MEMORY(rank_a && rank_b);
  BW_TRY(centred_ranks(context, count, a, weight, rank_a, &square_a));
  BW_TRY(centred_ranks(context, count, b, weight, rank_b, &square_b));
  if (!(square_a > 0) || !(square_b > 0))
    BW_TRY(bw_fail(context, BW_INVALID,
                   "no rank correlation: the %s series has the same value everywhere",
                   square_a > 0 ? "second" : "first"));
  for (int64_t i = 0; i < count; i++)
    product += (weight ? weight[i] : 1) * rank_a[i] * rank_b[i];
  product /= sqrt(square_a) * sqrt(square_b);
  *rho = product > 1 ? 1 : product < -1 ? -1 : product;
done:
  bw_free(rank_a);
  bw_free(rank_b);
  return status;
}

bw_status bw_rank_correlation(bw_context *context, int64_t count, const double *a, const double *b,
                              double *rho) {
  return bw_weighted_rank_correlation(context, count, a, b, NULL, rho);
}

bw_status bw_weighted_quantile(bw_context *context, int64_t count, const double *value,
                               const double *weight, double p, double *quantile) {
  sample *list = NULL;
  double total = 0, below = 0;
  if (!(p >= 0 && p <= 1))
    return bw_fail(context, BW_INVALID, "a quantile at %g: 0 to 1 expected", p);
  bw_status status = sorted(context, count, value, weight, &list, &total);
  if (status != BW_OK)
    return status;
  /* The last sample of any weight stands for p = 1, whatever the sum's rounding. */
  int64_t found = -1;
  for (int64_t i = 0; i < count; i++) {
    if (list[i].weight == 0)
      continue;
    found = i;
    below += list[i].weight;
    if (below >= p * total)
      break;
  }
  *quantile = list[found].value;
  bw_free(list);
  return BW_OK;
}
