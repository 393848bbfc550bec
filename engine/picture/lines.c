/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Lines over a body as tubes: a prism around every piece, so that what lies behind the body is
 * hidden by it. The tubes overlap where pieces meet, which closes the bends. */
#include <math.h>
#include <string.h>

#include "picture/internal.h"

enum { SIDES = 8 };

static void add_piece(bwi_solid *solid, const double from[3], const double to[3], double radius) {
  double along[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]}, a[3], b[3];
  double length = bw_norm(along);
  if (!(length > 0))
    return;
  for (int k = 0; k < 3; k++)
    along[k] /= length;
  bw_across(along, a, b);
  int32_t first = solid->point_count;
  double *x = solid->point + 3 * (size_t)first;
  int32_t *t = solid->triangle + 3 * (size_t)solid->triangle_count;
  for (int end = 0; end < 2; end++)
    for (int s = 0; s < SIDES; s++) {
      double angle = 2 * 3.14159265358979323846 * s / SIDES;
      for (int k = 0; k < 3; k++) /* half a radius farther, into the next piece */
        *x++ = (end ? to : from)[k] + (end ? 0.5 : -0.5) * radius * along[k] +
               radius * (cos(angle) * a[k] + sin(angle) * b[k]);
    }
  for (int s = 0; s < SIDES; s++) {
    int32_t i = first + s, next = first + (s + 1) % SIDES;
    const int32_t corner[2][3] = {{i, next, i + SIDES}, {next, next + SIDES, i + SIDES}};
    memcpy(t + 6 * s, corner, sizeof corner);
  }
  solid->point_count += 2 * SIDES;
  solid->triangle_count += 2 * SIDES;
}

/* Where a point of the undeformed body is now: it goes with the body's nearest point. */
static void follow(const bwi_solid *body, const double *original, const double *from,
                   double to[3]) {
  if (!original) {
    memcpy(to, from, 3 * sizeof *to);
    return;
  }
  int32_t near = bwi_solid_nearest(body, original, from);
  for (size_t k = 0; k < 3; k++)
    to[k] = from[k] + body->point[3 * (size_t)near + k] - original[3 * (size_t)near + k];
}

bw_status bwi_lines_solid(bw_context *context, int count, const bw_picture_line *line,
                          double radius, const bwi_solid *body, const double *original,
                          bwi_solid *solid) {
  int64_t pieces = 0;
  memset(solid, 0, sizeof *solid);
  solid->finish = BWI_TUBE;
  for (int i = 0; i < count; i++) {
    for (int64_t k = 0; k < 3 * (int64_t)line[i].count; k++)
      if (!isfinite(line[i].point[k]))
        return bw_fail(context, BW_INVALID, "point %d of line %d is not finite", (int)(k / 3) + 1,
                       i + 1);
    pieces += line[i].count > 1 ? line[i].count - 1 : 0;
  }
  if (pieces == 0)
    return BW_OK;
  solid->point = BW_NEW(context, double, (size_t)pieces * 2 * SIDES * 3);
  solid->triangle = BW_NEW(context, int32_t, (size_t)pieces * 2 * SIDES * 3);
  if (!solid->point || !solid->triangle) {
    bwi_solid_clear(solid);
    return BW_MEMORY;
  }
  for (int i = 0; i < count; i++)
    for (int k = 0; k < line[i].count; k++) {
      double end[2][3];
      if (k > 0) {
        for (int j = 0; j < 2; j++)
          follow(body, original, line[i].point + 3 * (size_t)(k - 1 + j), end[j]);
        add_piece(solid, end[0], end[1], radius);
      }
    }
  return BW_OK;
}
