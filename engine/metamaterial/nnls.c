/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The active-set method of Lawson and Hanson on the normal equations: variables enter one by one,
 * the steepest first; after each, the least squares solution of those inside is taken, or as much
 * of the way to it as keeps them positive, whereupon those that reached zero leave. */
#include "metamaterial/nnls.h"

#include "base/dense.h"

/* A slope counts when above this part of the largest at x = 0, both per length of column. */
#define MIN_SLOPE 1e-9
/* A column that depends on those inside as closely as this stays outside. */
#define MIN_PIVOT 1e-12

/* Least squares solution of the `count` variables in `inside`, into s. */
static bool solve(int n, const double *g, const double *h, int count, const int32_t *inside,
                  double *s, double *matrix) {
  for (int i = 0; i < count; i++) {
    for (int j = 0; j <= i; j++)
      matrix[(size_t)i * count + j] = g[(size_t)inside[i] * n + inside[j]];
    s[i] = h[inside[i]];
  }
  if (!bwi_cholesky(count, matrix, MIN_PIVOT))
    return false;
  bwi_lower_solve(count, matrix, s);
  bwi_upper_solve(count, matrix, s);
  return true;
}

static bool full(const int32_t *group, const int32_t *size, int limit, int candidate, int count,
                 const int32_t *inside) {
  if (!group || group[candidate] < 0)
    return false;
  int sum = size[candidate];
  for (int i = 0; i < count; i++)
    if (group[inside[i]] == group[candidate])
      sum += size[inside[i]];
  return sum > limit;
}

int bwi_nnls(int n, const double *g, const double *h, const int32_t *group, const int32_t *size,
             int limit, double *x, double *work) {
  double *matrix = work, *s = work + (size_t)n * n, *barred = s + n, largest = 0;
  int32_t *inside = (int32_t *)(barred + n); /* n, then a flag for each */
  int32_t *is_inside = inside + n;
  int count = 0, round = 0;
  for (int i = 0; i < n; i++) {
    x[i] = barred[i] = 0;
    is_inside[i] = 0;
    if (g[(size_t)i * n + i] > 0 && fabs(h[i]) > largest * sqrt(g[(size_t)i * n + i]))
      largest = fabs(h[i]) / sqrt(g[(size_t)i * n + i]);
  }
  for (; round < 5 * n; round++) {
    int enter = -1;
    double steepest = MIN_SLOPE * largest;
    for (int i = 0; i < n; i++) {
      double length = g[(size_t)i * n + i], slope = h[i];
      if (is_inside[i] || barred[i] > 0 || !(length > 0))
        continue;
      for (int j = 0; j < count; j++)
        slope -= g[(size_t)i * n + inside[j]] * x[inside[j]];
      if (slope > steepest * sqrt(length) && !full(group, size, limit, i, count, inside)) {
        steepest = slope / sqrt(length);
        enter = i;
      }
    }
    if (enter < 0)
      break;
    inside[count++] = enter;
    is_inside[enter] = 1;
    bool first = true;
    while (count > 0) {
      int leave = -1;
      double part = 1;
      bool solved = solve(n, g, h, count, inside, s, matrix);
      if (!solved || (first && !(s[count - 1] > 0))) { /* the newcomer says nothing new */
        is_inside[inside[--count]] = 0;
        barred[enter] = 1;
        first = false;
        if (!solved)
          break;
        continue;
      }
      first = false;
      for (int i = 0; i < count; i++)
        if (s[i] <= 0 && x[inside[i]] / (x[inside[i]] - s[i]) <= part) {
          part = x[inside[i]] / (x[inside[i]] - s[i]);
          leave = i;
        }
      for (int i = 0; i < count; i++)
        x[inside[i]] += part * (s[i] - x[inside[i]]);
      if (leave < 0)
        break;
      x[inside[leave]] = 0;
      is_inside[inside[leave]] = 0;
      for (int i = leave + 1; i < count; i++)
        inside[i - 1] = inside[i];
      count--;
      for (int i = 0; i < n; i++)
        barred[i] = 0;
    }
  }
  return round;
}
