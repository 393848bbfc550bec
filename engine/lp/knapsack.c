/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The linear program without its balance rows: a continuous knapsack, and its bound. */
#include "lp/linear_program.h"

#include <math.h>

double bwi_knapsack_multiplier(int32_t count, const double *gain, const double *upper,
                               int halvings) {
  double low = INFINITY, high = -INFINITY;
  for (int32_t j = 0; j < count; j++) {
    low = fmin(low, gain[j]);
    high = fmax(high, gain[j]);
  }
  /* The multiplier where the columns above it just fill the knapsack is optimal. */
  for (int step = 0; step < halvings; step++) {
    double x = 0.5 * (low + high), filled = 0;
    for (int32_t j = 0; j < count; j++)
      filled += gain[j] > x ? upper[j] : 0;
    if (filled > 1)
      low = x;
    else
      high = x;
  }
  return high;
}

double bwi_knapsack_value(int32_t count, const double *gain, const double *upper, double x) {
  double sum = x;
  for (int32_t j = 0; j < count; j++)
    sum += upper[j] * fmax(0, gain[j] - x);
  return sum;
}

double bwi_knapsack(int32_t count, const double *gain, const double *upper, int halvings) {
  double x = bwi_knapsack_multiplier(count, gain, upper, halvings);
  return bwi_knapsack_value(count, gain, upper, x);
}
