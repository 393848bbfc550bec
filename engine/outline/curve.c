/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* One segment: a line or a cubic Bézier curve with its position, derivatives, halves and boxes. */
#include "outline/internal.h"

#include <math.h>
#include <string.h>

bwi_outline_curve bwi_curve_of(const double *point, const bw_segment *segment) {
  bwi_outline_curve curve = {.count = bwi_is_line(segment) ? 2 : 4};
  for (int i = 0; i < curve.count; i++) {
    int32_t p = segment->point[curve.count == 2 ? 3 * i : i];
    curve.point[i][0] = point[2 * (int64_t)p];
    curve.point[i][1] = point[2 * (int64_t)p + 1];
  }
  return curve;
}

void bwi_curve_at(const bwi_outline_curve *curve, double t, double position[2],
                  double derivative[2], double second[2]) {
  const double(*p)[2] = curve->point;
  double s = 1 - t;
  for (int k = 0; k < 2; k++) {
    if (curve->count == 2) {
      if (position)
        position[k] = s * p[0][k] + t * p[1][k];
      if (derivative)
        derivative[k] = p[1][k] - p[0][k];
      if (second)
        second[k] = 0;
      continue;
    }
    double a = p[1][k] - p[0][k], b = p[2][k] - p[1][k], c = p[3][k] - p[2][k];
    if (position)
      position[k] =
          s * s * (s * p[0][k] + 3 * t * p[1][k]) + t * t * (3 * s * p[2][k] + t * p[3][k]);
    if (derivative)
      derivative[k] = 3 * (s * s * a + 2 * s * t * b + t * t * c);
    if (second)
      second[k] = 6 * (s * (b - a) + t * (c - b));
  }
}

void bwi_curve_split(const bwi_outline_curve *curve, double t, bwi_outline_curve *left,
                     bwi_outline_curve *right) {
  bwi_outline_curve work = *curve;
  int n = curve->count;
  left->count = right->count = n;
  for (int level = 0; level < n; level++) {
    memcpy(left->point[level], work.point[0], sizeof work.point[0]);
    memcpy(right->point[n - 1 - level], work.point[n - 1 - level], sizeof work.point[0]);
    for (int i = 0; i + level + 1 < n; i++)
      for (int k = 0; k < 2; k++)
        work.point[i][k] += t * (work.point[i + 1][k] - work.point[i][k]);
  }
}

/* |B - chord| <= max |B''| / 8, and B'' / 6 lies between the second differences. */
double bwi_curve_sag(const bwi_outline_curve *curve) {
  if (curve->count == 2)
    return 0;
  const double(*p)[2] = curve->point;
  double max = 0;
  for (int i = 0; i < 2; i++) {
    double x = p[i][0] - 2 * p[i + 1][0] + p[i + 2][0];
    double y = p[i][1] - 2 * p[i + 1][1] + p[i + 2][1];
    max = fmax(max, x * x + y * y);
  }
  return 0.75 * sqrt(max);
}

void bwi_curve_hull(const bwi_outline_curve *curve, double low[2], double high[2]) {
  for (int k = 0; k < 2; k++) {
    low[k] = high[k] = curve->point[0][k];
    for (int i = 1; i < curve->count; i++) {
      low[k] = fmin(low[k], curve->point[i][k]);
      high[k] = fmax(high[k], curve->point[i][k]);
    }
  }
}

void bwi_curve_box(const bwi_outline_curve *curve, double low[2], double high[2]) {
  int last = curve->count - 1;
  for (int k = 0; k < 2; k++) {
    const double from = curve->point[0][k], to = curve->point[last][k];
    low[k] = fmin(from, to);
    high[k] = fmax(from, to);
    if (curve->count == 2)
      continue;
    /* B' / 3 = a s^2 + 2 b s t + c t^2: the roots of (a - 2b + c) t^2 - 2 (a - b) t + a. */
    double a = curve->point[1][k] - from, b = curve->point[2][k] - curve->point[1][k];
    double c = to - curve->point[2][k];
    double square = a - 2 * b + c, half = a - b, inside = half * half - square * a, root[2];
    if (inside < 0)
      continue;
    double sum = half + copysign(sqrt(inside), half);
    root[0] = square != 0 ? sum / square : -1;
    root[1] = sum != 0 ? a / sum : -1;
    for (int i = 0; i < 2; i++)
      if (root[i] > 0 && root[i] < 1) {
        double at[2];
        bwi_curve_at(curve, root[i], at, NULL, NULL);
        low[k] = fmin(low[k], at[k]);
        high[k] = fmax(high[k], at[k]);
      }
  }
}

static void direction_of(const bwi_outline_curve *curve, int from, int step, double direction[2]) {
  direction[0] = direction[1] = 0;
  for (int i = from + step; i >= 0 && i < curve->count; i += step) {
    double x = curve->point[i][0] - curve->point[from][0];
    double y = curve->point[i][1] - curve->point[from][1], length = hypot(x, y);
    if (length > 0) {
      direction[0] = step * x / length;
      direction[1] = step * y / length;
      return;
    }
  }
}

void bwi_curve_leaves(const bwi_outline_curve *curve, double direction[2]) {
  direction_of(curve, 0, 1, direction);
}

void bwi_curve_arrives(const bwi_outline_curve *curve, double direction[2]) {
  direction_of(curve, curve->count - 1, -1, direction);
}

void bw_outline_evaluate(const bw_outline *outline, int32_t segment, double t, double position[2],
                         double derivative[2], double second[2]) {
  bwi_outline_curve curve = bwi_curve_of(outline->point, &outline->segment[segment]);
  bwi_curve_at(&curve, t, position, derivative, second);
}

void bw_outline_basis(const bw_outline *outline, int32_t segment, double t, double weight[4]) {
  double s = 1 - t;
  if (bwi_is_line(&outline->segment[segment])) {
    weight[0] = s;
    weight[1] = weight[2] = 0;
    weight[3] = t;
  } else {
    weight[0] = s * s * s;
    weight[1] = 3 * s * s * t;
    weight[2] = 3 * s * t * t;
    weight[3] = t * t * t;
  }
}

void bw_segment_box(const bw_outline *outline, int32_t segment, double min[2], double max[2]) {
  bwi_outline_curve curve = bwi_curve_of(outline->point, &outline->segment[segment]);
  bwi_curve_box(&curve, min, max);
}
