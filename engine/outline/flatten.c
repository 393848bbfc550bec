/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Outlines as polygons: a cubic becomes as many chords of equal steps in t as the tolerance asks
 * for; n of them leave a sag of 1/n^2. */
#include <math.h>
#include <string.h>

#include "outline/internal.h"

static const double max_points = 1e8;

static double chords(const bwi_outline_curve *curve, double tolerance) {
  return curve->count == 2 ? 1 : fmax(1, ceil(sqrt(bwi_curve_sag(curve) / tolerance)));
}

bw_status bw_outline_flatten(bw_context *context, const bw_outline *outline, double tolerance,
                             bw_polygons *polygons) {
  double count = 0;
  if (!(tolerance > 0) || !isfinite(tolerance))
    return bw_fail(context, BW_INVALID, "a tolerance of %g m: a length above 0 expected",
                   tolerance);
  for (int32_t s = 0; s < outline->segment_count; s++) {
    bwi_outline_curve curve = bwi_curve_of(outline->point, &outline->segment[s]);
    count += chords(&curve, tolerance);
  }
  if (count > max_points)
    return bw_fail(context, BW_LIMIT,
                   "a tolerance of %g m asks for %.3g points; the limit is %g: choose a larger one",
                   tolerance, count, max_points);
  bw_polygons made = {.loop_count = outline->loop_count};
  made.start = BW_NEW(context, int32_t, outline->loop_count + 1);
  made.point = BW_NEW(context, double, 2 * (size_t)count);
  if (!made.start || !made.point) {
    bw_polygons_clear(&made);
    return BW_MEMORY;
  }
  int32_t n = 0;
  for (int32_t l = 0; l < outline->loop_count; l++) {
    const bw_loop *loop = &outline->loop[l];
    made.start[l] = n;
    for (int32_t s = loop->first; s < loop->first + loop->count; s++) {
      bwi_outline_curve curve = bwi_curve_of(outline->point, &outline->segment[s]);
      int32_t parts = (int32_t)chords(&curve, tolerance);
      for (int32_t i = 0; i < parts; i++)
        bwi_curve_at(&curve, (double)i / parts, made.point + 2 * (int64_t)n++, NULL, NULL);
    }
  }
  made.start[outline->loop_count] = n;
  *polygons = made;
  return BW_OK;
}

void bw_polygons_clear(bw_polygons *polygons) {
  bw_free(polygons->start);
  bw_free(polygons->point);
  memset(polygons, 0, sizeof *polygons);
}
