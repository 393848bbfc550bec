/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Which loop lies in which, by the winding number of one loop about a point of another. A ray to
 * the right is followed through halves of curves until the ends alone decide. Ends count by one
 * rule (up is above, level is below) and are shared bit for bit, so that no passage is lost or
 * doubled. */
#include <math.h>

#include "outline/internal.h"

static int passes(const bwi_outline_curve *curve, const double at[2]) {
  int last = curve->count - 1;
  bool from = curve->point[0][1] > at[1], to = curve->point[last][1] > at[1];
  double low[2], high[2];
  bwi_curve_hull(curve, low, high);
  if (high[0] < at[0] || high[1] < at[1] || low[1] > at[1])
    return 0;
  if (low[0] > at[0])
    return to - from;
  if (curve->count == 2) {
    const double *p = curve->point[0], *q = curve->point[1];
    double turn = (q[0] - p[0]) * (at[1] - p[1]) - (q[1] - p[1]) * (at[0] - p[0]);
    return from == to ? 0 : to ? turn > 0 : -(turn < 0);
  }
  /* As straight as its coordinates can express: the gap between segments is far larger. */
  double far = fmax(fmax(fabs(low[0]), fabs(high[0])), fmax(fabs(low[1]), fabs(high[1])));
  if (bwi_curve_sag(curve) <= 1e-14 * far) {
    bwi_outline_curve line = {2, {{0, 0}}};
    for (int k = 0; k < 2; k++) {
      line.point[0][k] = curve->point[0][k];
      line.point[1][k] = curve->point[last][k];
    }
    return passes(&line, at);
  }
  bwi_outline_curve left, right;
  bwi_curve_split(curve, 0.5, &left, &right);
  return passes(&left, at) + passes(&right, at);
}

/* How often a loop runs around a place that does not lie on it (counter-clockwise is positive). */
static int loop_winding(const double *point, const bw_loop *loop, const bw_segment *segment,
                        const double at[2]) {
  int winding = 0;
  for (int32_t s = loop->first; s < loop->first + loop->count; s++) {
    bwi_outline_curve curve = bwi_curve_of(point, &segment[s]);
    winding += passes(&curve, at);
  }
  return winding;
}

/* Of the loops around a point the one of least area is directly around it: they lie in each other
 * like shells. */
bw_status bwi_outline_nesting(bw_context *context, const double *point, int32_t loops,
                              const bw_loop *loop, const bw_segment *segment, double *area,
                              int32_t *parent) {
  bw_status status = BW_OK;
  double *box = BW_NEW(context, double, 4 * (size_t)loops);
  if (!box)
    return BW_MEMORY;
  for (int32_t l = 0; l < loops; l++) {
    double *low = box + 4 * (int64_t)l, *high = low + 2;
    area[l] = bwi_loop_area(point, &loop[l], segment);
    for (int32_t s = loop[l].first; s < loop[l].first + loop[l].count; s++) {
      bwi_outline_curve curve = bwi_curve_of(point, &segment[s]);
      double a[2], b[2];
      bwi_curve_hull(&curve, a, b);
      for (int k = 0; k < 2; k++) {
        low[k] = s == loop[l].first ? a[k] : fmin(low[k], a[k]);
        high[k] = s == loop[l].first ? b[k] : fmax(high[k], b[k]);
      }
    }
  }
  for (int32_t l = 0; l < loops; l++) {
    const double *at = point + 2 * (int64_t)segment[loop[l].first].point[0];
    parent[l] = -1;
    for (int32_t m = 0; m < loops; m++) {
      const double *low = box + 4 * (int64_t)m, *high = low + 2;
      if (m != l && at[0] > low[0] && at[0] < high[0] && at[1] > low[1] && at[1] < high[1] &&
          (parent[l] < 0 || fabs(area[m]) < fabs(area[parent[l]])) &&
          loop_winding(point, &loop[m], segment, at) != 0)
        parent[l] = m;
    }
    if (l % 1024 == 1023)
      BW_TRY(bw_check_cancel(context));
  }
done:
  bw_free(box);
  return status;
}
