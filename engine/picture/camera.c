/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Where the viewer stands and how the body fills the frame. */
#include <math.h>
#include <string.h>

#include "picture/internal.h"

/* v divided by its length, computed without overflow; false for zero or not finite. */
static bool unit(const double v[3], double out[3]) {
  double max = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
  if (!(max > 0) || !isfinite(v[0]) || !isfinite(v[1]) || !isfinite(v[2]))
    return false;
  for (int k = 0; k < 3; k++)
    out[k] = v[k] / max;
  double length = bw_norm(out);
  for (int k = 0; k < 3; k++)
    out[k] /= length;
  return true;
}

bw_status bwi_view_axes(bw_context *context, const double direction[3], const double up[3],
                        bwi_view *view) {
  double *right = view->axis[0], *above = view->axis[1], *toward = view->axis[2], high[3];
  memset(view, 0, sizeof *view);
  if (!unit(direction, toward))
    return bw_fail(context, BW_INVALID,
                   "the direction of the view (%g, %g, %g) must be a finite vector that is not 0",
                   direction[0], direction[1], direction[2]);
  bool given = unit(up, high);
  if (given) {
    bw_cross(high, toward, right);
    given = bw_norm(right) > 1e-6;
  }
  if (!given) { /* looking along `up`: y is up, or z when looking along y */
    double y[3] = {0, 1, 0}, z[3] = {0, 0, 1};
    bw_cross(fabs(toward[1]) < 0.9 ? y : z, toward, right);
  }
  unit(right, right);
  bw_cross(toward, right, above);
  return BW_OK;
}

void bwi_view_usual(const double up[3], double turn, bool below, double direction[3]) {
  double above[3], first[3] = {0, 0, 0}, second[3];
  if (!unit(up, above)) {
    above[0] = above[1] = 0;
    above[2] = 1;
  }
  int max = 0;
  for (int k = 1; k < 3; k++)
    if (fabs(above[k]) > fabs(above[max]))
      max = k;
  first[(max + 1) % 3] = 1;
  double part = bw_dot(first, above);
  for (int k = 0; k < 3; k++)
    first[k] -= part * above[k];
  unit(first, first);
  bw_cross(above, first, second);
  double c = cos(turn), s = sin(turn), across = c + 1.4 * s, front = s - 1.4 * c;
  for (int k = 0; k < 3; k++)
    direction[k] = across * first[k] + front * second[k] + (below ? -0.8 : 0.8) * above[k];
}

void bwi_view_bound(const bwi_view *view, int64_t count, const double *point, double bounds[4]) {
  for (int64_t i = 0; i < count; i++)
    for (int k = 0; k < 2; k++) {
      double at = bw_dot(point + 3 * i, view->axis[k]);
      bounds[k] = fmin(bounds[k], at);
      bounds[2 + k] = fmax(bounds[2 + k], at);
    }
}

void bwi_view_fit(bwi_view *view, const double bounds[4], const double frame[4], double zoom) {
  double wide = bounds[2] - bounds[0], high = bounds[3] - bounds[1];
  double across = (frame[2] - frame[0]) / wide, upright = (frame[3] - frame[1]) / high;
  double scale = fmin(wide > 0 ? across : HUGE_VAL, high > 0 ? upright : HUGE_VAL);
  view->scale = (isfinite(scale) ? scale : 1) * zoom;
  for (int k = 0; k < 2; k++) {
    view->centre[k] = (bounds[k] + bounds[2 + k]) / 2;
    view->middle[k] = (frame[k] + frame[2 + k]) / 2;
  }
}

void bwi_view_project(const bwi_view *view, const double x[3], double pixel[3]) {
  pixel[0] = view->middle[0] + view->scale * (bw_dot(x, view->axis[0]) - view->centre[0]);
  pixel[1] = view->middle[1] - view->scale * (bw_dot(x, view->axis[1]) - view->centre[1]);
  pixel[2] = view->scale * bw_dot(x, view->axis[2]);
}
