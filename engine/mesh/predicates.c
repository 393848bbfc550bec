/* Exact predicates. A determinant is first computed in plain doubles; where it is larger than the
 * rounding error it can have, its sign is right. Otherwise it is computed again as an expansion: a
 * sum of doubles, smallest first, that do not overlap, exact unless it underflows.
 *
 * Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later.
 *
 * J. R. Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric
 * Predicates, Discrete & Computational Geometry 18 (1997). */
#include "mesh/predicates.h"

#include <math.h>
#include <string.h>

/* ---- expansions ------------------------------------------------------------------------- */

enum { TERMS = 192 }; /* the longest: a determinant of 3 x 3 differences */

typedef struct expansion {
  int count;
  double term[TERMS];
} expansion;

/* sum + rest = a + b exactly */
static double two_sum(double a, double b, double *rest) {
  double sum = a + b, b_part = sum - a;
  *rest = (a - (sum - b_part)) + (b - b_part);
  return sum;
}

static void push(expansion *e, double term) {
  if (term != 0)
    e->term[e->count++] = term;
}

static void difference(double a, double b, expansion *out) {
  double rest, sum = two_sum(a, -b, &rest);
  out->count = 0;
  push(out, rest);
  push(out, sum);
}

/* e + b, in place */
static void add_term(expansion *e, double b) {
  int kept = 0;
  for (int i = 0; i < e->count; i++) {
    double rest;
    b = two_sum(b, e->term[i], &rest);
    if (rest != 0)
      e->term[kept++] = rest;
  }
  e->count = kept;
  push(e, b);
}

static void add(const expansion *a, const expansion *b, double sign, expansion *out) {
  expansion sum = *a;
  for (int i = 0; i < b->count; i++)
    add_term(&sum, sign * b->term[i]);
  *out = sum;
}

static void multiply(const expansion *a, const expansion *b, expansion *out) {
  expansion product = {0};
  for (int i = 0; i < a->count; i++)
    for (int k = 0; k < b->count; k++) {
      double high = a->term[i] * b->term[k], low = fma(a->term[i], b->term[k], -high);
      add_term(&product, low);
      add_term(&product, high);
    }
  *out = product;
}

static int sign_of(const expansion *e) {
  double last = e->count ? e->term[e->count - 1] : 0;
  return (last > 0) - (last < 0);
}

/* a*d - b*c */
static void cross_exactly(const expansion *a, const expansion *b, const expansion *c,
                          const expansion *d, expansion *out) {
  expansion ad, bc;
  multiply(a, d, &ad);
  multiply(b, c, &bc);
  add(&ad, &bc, -1, out);
}

/* ---- determinants ----------------------------------------------------------------------- */

/* Half a unit in the last place, relative. */
static const double epsilon = 0x1p-53;

static int orient2_exactly(const double a[2], const double b[2], const double c[2]) {
  expansion ux, uy, vx, vy, area;
  difference(b[0], a[0], &ux);
  difference(b[1], a[1], &uy);
  difference(c[0], a[0], &vx);
  difference(c[1], a[1], &vy);
  cross_exactly(&ux, &uy, &vx, &vy, &area);
  return sign_of(&area);
}

int bwi_orient2(const double a[2], const double b[2], const double c[2]) {
  double left = (b[0] - a[0]) * (c[1] - a[1]), right = (b[1] - a[1]) * (c[0] - a[0]);
  double area = left - right, bound = 4 * epsilon * (fabs(left) + fabs(right));
  if (area > bound || -area > bound)
    return area > 0 ? 1 : -1;
  if (left == 0 && right == 0 && (b[0] == a[0] || c[1] == a[1]) && (b[1] == a[1] || c[0] == a[0]))
    return 0;
  return orient2_exactly(a, b, c);
}

static int orient3_exactly(const double a[3], const double b[3], const double c[3],
                           const double d[3]) {
  expansion u[3], v[3], w[3], minor, part, volume = {0};
  for (int k = 0; k < 3; k++) {
    difference(b[k], a[k], &u[k]);
    difference(c[k], a[k], &v[k]);
    difference(d[k], a[k], &w[k]);
  }
  for (int k = 0; k < 3; k++) {
    if (w[k].count == 0)
      continue;
    int i = (k + 1) % 3, j = (k + 2) % 3;
    cross_exactly(&u[i], &u[j], &v[i], &v[j], &minor);
    multiply(&minor, &w[k], &part);
    add(&volume, &part, 1, &volume);
  }
  return sign_of(&volume);
}

int bwi_orient3(const double a[3], const double b[3], const double c[3], const double d[3]) {
  double u[3], v[3], w[3], volume = 0, size = 0;
  for (int k = 0; k < 3; k++) {
    u[k] = b[k] - a[k];
    v[k] = c[k] - a[k];
    w[k] = d[k] - a[k];
  }
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    double left = u[i] * v[j], right = u[j] * v[i];
    volume += (left - right) * w[k];
    size += (fabs(left) + fabs(right)) * fabs(w[k]);
  }
  double bound = 16 * epsilon * size;
  if (volume > bound || -volume > bound)
    return volume > 0 ? 1 : -1;
  /* Four points in a plane across an axis are common in drawn parts, and exactly seen. */
  for (int k = 0; k < 3; k++)
    if (a[k] == b[k] && a[k] == c[k] && a[k] == d[k])
      return 0;
  return orient3_exactly(a, b, c, d);
}

static void seen_along(int axis, const double a[3], double seen[2]) {
  seen[0] = a[(axis + 1) % 3];
  seen[1] = a[(axis + 2) % 3];
}

int bwi_orient_seen(int axis, const double a[3], const double b[3], const double c[3]) {
  double p[2], q[2], r[2];
  seen_along(axis, a, p);
  seen_along(axis, b, q);
  seen_along(axis, c, r);
  return bwi_orient2(p, q, r);
}

int bwi_projection(const double a[3], const double b[3], const double c[3]) {
  double area[3], best = 0;
  int axis = -1;
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    area[k] = fabs((b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]));
    if (area[k] > best) {
      best = area[k];
      axis = k;
    }
  }
  if (axis >= 0 && bwi_orient_seen(axis, a, b, c) != 0)
    return axis;
  for (int k = 0; k < 3; k++)
    if (bwi_orient_seen(k, a, b, c) != 0)
      return k;
  return -1;
}

/* ---- segment and triangle ------------------------------------------------------------------ */

static bool between(double x, double a, double b) {
  return a <= b ? a <= x && x <= b : b <= x && x <= a;
}

/* c, known to lie on the line ab, lies on the segment. */
static bool on_segment(const double a[3], const double b[3], const double c[3]) {
  return between(c[0], a[0], b[0]) && between(c[1], a[1], b[1]) && between(c[2], a[2], b[2]);
}

static bool segments_meet(int axis, const double p[3], const double q[3], const double a[3],
                          const double b[3]) {
  int sp = bwi_orient_seen(axis, a, b, p), sq = bwi_orient_seen(axis, a, b, q);
  int sa = bwi_orient_seen(axis, p, q, a), sb = bwi_orient_seen(axis, p, q, b);
  if (sp * sq < 0 && sa * sb < 0)
    return true;
  return (sp == 0 && on_segment(a, b, p)) || (sq == 0 && on_segment(a, b, q)) ||
         (sa == 0 && on_segment(p, q, a)) || (sb == 0 && on_segment(p, q, b));
}

static bool in_triangle_seen(int axis, const double p[3], const double a[3], const double b[3],
                             const double c[3]) {
  int s = bwi_orient_seen(axis, a, b, p), t = bwi_orient_seen(axis, b, c, p),
      u = bwi_orient_seen(axis, c, a, p);
  return (s >= 0 && t >= 0 && u >= 0) || (s <= 0 && t <= 0 && u <= 0);
}

bool bwi_segment_meets_triangle(const double p[3], const double q[3], const double a[3],
                                const double b[3], const double c[3]) {
  int sp = bwi_orient3(a, b, c, p), sq = bwi_orient3(a, b, c, q);
  if (sp * sq > 0)
    return false;
  if (sp == 0 && sq == 0) {
    int axis = bwi_projection(a, b, c);
    return in_triangle_seen(axis, p, a, b, c) || segments_meet(axis, p, q, a, b) ||
           segments_meet(axis, p, q, b, c) || segments_meet(axis, p, q, c, a);
  }
  int s = bwi_orient3(p, q, a, b), t = bwi_orient3(p, q, b, c), u = bwi_orient3(p, q, c, a);
  return (s >= 0 && t >= 0 && u >= 0) || (s <= 0 && t <= 0 && u <= 0);
}
