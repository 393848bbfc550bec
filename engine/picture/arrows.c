/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Arrows as solids: a shaft and a cone, with open seams where facets would shade across an edge. */
#include <math.h>
#include <string.h>

#include "picture/internal.h"

enum { SIDES = 28 };
/* of the longest arrow */
#define SHAFT_RADIUS 0.030
#define HEAD_RADIUS 0.085
#define HEAD_LENGTH 0.24
/* the shortest that is still drawn as an arrow */
#define SHORTEST 0.12

/* rings: tail, shaft end, head base; then the points tail middle and tip */
enum { ARROW_POINTS = 3 * SIDES + 2, ARROW_TRIANGLES = 6 * SIDES };

static void add_arrow(bwi_solid *solid, const double tail[3], const double direction[3],
                      double length, double size) {
  double head = fmin(HEAD_LENGTH * size, 0.6 * length), thick = head / (HEAD_LENGTH * size);
  double radius[3] = {SHAFT_RADIUS * size * thick, SHAFT_RADIUS * size * thick,
                      HEAD_RADIUS * size * thick};
  double along[3] = {0, length - head, length - head}, a[3], b[3];
  bw_across(direction, a, b);
  int32_t first = solid->point_count;
  double *x = solid->point + 3 * (size_t)first;
  for (int ring = 0; ring < 3; ring++)
    for (int s = 0; s < SIDES; s++) {
      double angle = 2 * 3.14159265358979323846 * s / SIDES;
      for (int k = 0; k < 3; k++)
        *x++ = tail[k] + along[ring] * direction[k] +
               radius[ring] * (cos(angle) * a[k] + sin(angle) * b[k]);
    }
  for (int k = 0; k < 3; k++) {
    x[k] = tail[k];
    x[3 + k] = tail[k] + length * direction[k];
  }
  solid->point_count += ARROW_POINTS;
  int32_t *t = solid->triangle + 3 * (size_t)solid->triangle_count;
  int32_t middle = first + 3 * SIDES, tip = middle + 1;
  for (int s = 0; s < SIDES; s++) {
    int32_t i = first + s, next = first + (s + 1) % SIDES;
    int32_t corner[6][3] = {{middle, next, i},
                            {i, next, i + SIDES},
                            {next, next + SIDES, i + SIDES},
                            {i + SIDES, next + SIDES, i + 2 * SIDES},
                            {next + SIDES, next + 2 * SIDES, i + 2 * SIDES},
                            {i + 2 * SIDES, next + 2 * SIDES, tip}};
    memcpy(t, corner, sizeof corner);
    t += 18;
  }
  solid->triangle_count += ARROW_TRIANGLES;
}

int32_t bwi_solid_nearest(const bwi_solid *body, const double *original, const double x[3]) {
  int32_t best = 0;
  double min = HUGE_VAL;
  for (int32_t i = 0; i < body->point_count; i++) {
    const double *p = original + 3 * (size_t)i;
    double d[3] = {p[0] - x[0], p[1] - x[1], p[2] - x[2]}, square = bw_dot(d, d);
    if (square < min) {
      min = square;
      best = i;
    }
  }
  return best;
}

int bwi_solid_crossings(const bwi_solid *body, const double x[3], const double direction[3],
                        double near, double *first) {
  int crossings = 0;
  *first = HUGE_VAL;
  for (int32_t f = 0; f < body->triangle_count; f++) {
    const int32_t *t = body->triangle + 3 * (size_t)f;
    const double *p = body->point + 3 * (size_t)t[0], *q = body->point + 3 * (size_t)t[1];
    const double *r = body->point + 3 * (size_t)t[2];
    double a[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
    double b[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
    double from[3] = {x[0] - p[0], x[1] - p[1], x[2] - p[2]}, n[3], c[3];
    bw_cross(a, b, n);
    double slope = bw_dot(n, direction);
    if (slope == 0)
      continue;
    double along = -bw_dot(n, from) / slope; /* Cramer's rule for x + along d = p + u a + v b */
    bw_cross(from, direction, c);
    double u = -bw_dot(b, c) / slope, v = bw_dot(a, c) / slope;
    if (along < near || u < 0 || v < 0 || u + v > 1)
      continue;
    crossings++;
    *first = fmin(*first, along);
  }
  return crossings;
}

/* How far x, when inside the body, lies below its surface along a unit direction: a resultant acts
 * at the middle of a pressed patch, which on a curved body is inside. */
static double way_out(const bwi_solid *body, const double x[3], const double direction[3],
                      double near) {
  double first;
  return bwi_solid_crossings(body, x, direction, near, &first) % 2 ? first : 0;
}

bw_status bwi_arrows_solid(bw_context *context, int count, const bw_arrow *arrow, double size,
                           const bwi_solid *body, const double *original, bwi_solid *solid,
                           double *end) {
  double largest = 0;
  memset(solid, 0, sizeof *solid);
  solid->finish = BWI_ARROW;
  for (int i = 0; i < count; i++) {
    double force = bw_norm(arrow[i].force);
    if (!isfinite(force) || !isfinite(arrow[i].at[0] + arrow[i].at[1] + arrow[i].at[2]))
      return bw_fail(context, BW_INVALID, "arrow %d is not finite", i + 1);
    largest = fmax(largest, force);
  }
  int32_t *near = BW_NEW(context, int32_t, count);
  double *normal = BW_NEW0(context, double, 3 * (size_t)count);
  solid->point = BW_NEW(context, double, 3 * (size_t)count * ARROW_POINTS);
  solid->triangle = BW_NEW(context, int32_t, 3 * (size_t)count * ARROW_TRIANGLES);
  if (!near || !normal || !solid->point || !solid->triangle) {
    bw_free(near);
    bw_free(normal);
    bwi_solid_clear(solid);
    return BW_MEMORY;
  }
  for (int i = 0; i < count; i++)
    near[i] = bwi_solid_nearest(body, original, arrow[i].at);
  for (int32_t f = 0; f < body->triangle_count; f++) { /* vector areas around those points */
    const int32_t *t = body->triangle + 3 * (size_t)f;
    for (int i = 0; i < count; i++) {
      if (t[0] != near[i] && t[1] != near[i] && t[2] != near[i])
        continue;
      const double *x = body->point + 3 * (size_t)t[0], *p = body->point + 3 * (size_t)t[1];
      const double *q = body->point + 3 * (size_t)t[2];
      double a[3] = {p[0] - x[0], p[1] - x[1], p[2] - x[2]};
      double b[3] = {q[0] - x[0], q[1] - x[1], q[2] - x[2]}, n[3];
      bw_cross(a, b, n);
      for (int k = 0; k < 3; k++)
        normal[3 * i + k] += n[k];
    }
  }
  for (int i = 0; i < count; i++) {
    double force = bw_norm(arrow[i].force), direction[3], tail[3];
    size_t p = 3 * (size_t)near[i];
    for (size_t k = 0; k < 3; k++) /* moves with the body */
      end[3 * i + (int)k] = tail[k] = arrow[i].at[k] + body->point[p + k] - original[p + k];
    if (!(force > 0))
      continue;
    double length = size * fmax(SHORTEST, force / largest);
    bool pushes = (bw_dot(arrow[i].force, normal + 3 * (size_t)i) < 0) != body->inverted;
    double out[3];
    for (int k = 0; k < 3; k++) {
      direction[k] = arrow[i].force[k] / force;
      out[k] = pushes ? -direction[k] : direction[k];
    }
    double depth = way_out(body, tail, out, 1e-3 * size);
    for (int k = 0; k < 3; k++) {
      tail[k] += depth * out[k];
      tail[k] -= pushes ? length * direction[k] : 0;
      end[3 * i + k] = tail[k] + (pushes ? 0 : length * direction[k]);
    }
    add_arrow(solid, tail, direction, length, size);
  }
  bw_free(near);
  bw_free(normal);
  return BW_OK;
}
