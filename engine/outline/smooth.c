/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Laplacian smoothing of a loop: each point of the control polygon moves towards the middle of its
 * two neighbours. Corners are recognised once, from the loop as it is, and stay; so do points
 * between two lines that make no angle. */
#include <math.h>
#include <string.h>

#include "outline/internal.h"

/* By how much a loop turns where a segment begins, 0 to pi. */
static double turn_at(const bw_outline *outline, const bw_loop *loop, int32_t segment) {
  bwi_outline_curve in =
      bwi_curve_of(outline->point, &outline->segment[bwi_previous_segment(loop, segment)]);
  bwi_outline_curve out = bwi_curve_of(outline->point, &outline->segment[segment]);
  double a[2], b[2];
  bwi_curve_arrives(&in, a);
  bwi_curve_leaves(&out, b);
  return fabs(atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]));
}

bw_status bw_outline_smoothed(bw_context *context, const bw_outline *outline, int32_t loop,
                              double strength, int rounds, double corner, bw_outline **smoothed) {
  bw_status status = bwi_check_loop(context, outline, loop);
  double *point = NULL, *ring = NULL;
  int32_t *number = NULL;
  bool *kept = NULL;
  if (status != BW_OK)
    return status;
  if (!(strength >= 0 && strength <= 1) || rounds < 0 || rounds > 100000 || !(corner >= 0))
    return bw_fail(context, BW_INVALID,
                   "smoothing with strength %g, %d rounds, corners from %g: a strength of 0 to 1, "
                   "0 to 100000 rounds and a corner of at least 0 expected",
                   strength, rounds, corner);
  const bw_loop *l = &outline->loop[loop];
  int32_t n = 0;
  size_t capacity = 3 * (size_t)l->count, bytes = 2 * (size_t)outline->point_count * sizeof *point;
  point = BW_NEW(context, double, 2 * (size_t)outline->point_count);
  ring = BW_NEW(context, double, 4 * capacity);
  number = BW_NEW(context, int32_t, capacity);
  kept = BW_NEW(context, bool, capacity);
  BW_TRY_MEMORY(point && ring && number && kept);
  for (int32_t s = l->first; s < l->first + l->count; s++)
    for (int i = 0; i < 3; i++)
      if (outline->segment[s].point[i] >= 0) {
        kept[n] = i == 0 && turn_at(outline, l, s) > corner;
        number[n] = outline->segment[s].point[i];
        memcpy(ring + 2 * (size_t)n, outline->point + 2 * (int64_t)number[n], 2 * sizeof *ring);
        n++;
      }
  double *now = ring, *next = ring + 2 * capacity;
  for (int r = 0; r < rounds; r++) {
    for (int32_t i = 0; i < n; i++) {
      const double *a = now + 2 * (size_t)(i > 0 ? i - 1 : n - 1), *b = now + 2 * (size_t)i;
      const double *c = now + 2 * (size_t)(i + 1 < n ? i + 1 : 0);
      for (int k = 0; k < 2; k++)
        next[2 * (size_t)i + (size_t)k] =
            kept[i] ? b[k] : b[k] + strength * ((a[k] + c[k]) / 2 - b[k]);
    }
    double *spare = now;
    now = next;
    next = spare;
    if (r % 1024 == 1023)
      BW_TRY(bw_check_cancel(context));
  }
  memcpy(point, outline->point, bytes);
  for (int32_t i = 0; i < n; i++)
    memcpy(point + 2 * (int64_t)number[i], now + 2 * (size_t)i, 2 * sizeof *point);
  BW_TRY(bw_outline_moved(context, outline, point, smoothed));
done:
  bw_free(kept);
  bw_free(number);
  bw_free(ring);
  bw_free(point);
  return status;
}
