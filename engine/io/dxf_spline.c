/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* B-splines of degree 1 to 3 as lines and cubics, exactly. On a span [u_i, u_{i+1}] the control
 * points of the Bézier curve are values of the spline's polar form (blossom) at arguments that are
 * each one of the two knots; de Boor's recursion gives them. */
#include <math.h>
#include <string.h>

#include "io/contours.h"

const char *bwi_spline_wrong(const bwi_spline *s) {
  if (s->degree < 1 || s->degree > 3)
    return "its degree is not 1 to 3: save it with degree 3, or as polylines";
  if (s->points < (size_t)s->degree + 1)
    return "it has fewer control points than its degree asks for (fit points alone are not read: "
           "save "
           "it with control points)";
  if (s->knots != s->points + (size_t)s->degree + 1)
    return "the number of its knots is not that of its control points, plus degree, plus 1";
  for (size_t i = 1; i < s->knots; i++)
    if (!(s->knot[i] >= s->knot[i - 1]))
      return "its knots do not increase";
  if (!(s->knot[s->points] > s->knot[s->degree]))
    return "its knots span nothing";
  return NULL;
}

/* The polar form on span i with `ends` of the arguments at its end and the rest at its start. */
static void polar(const bwi_spline *s, size_t i, int ends, double value[2]) {
  size_t p = (size_t)s->degree;
  double d[4][2];
  memcpy(d, s->point + 2 * (i - p), 2 * (p + 1) * sizeof **d);
  for (size_t r = 1; r <= p; r++) {
    double at = r <= (size_t)ends ? s->knot[i + 1] : s->knot[i];
    for (size_t j = p; j >= r; j--) {
      double low = s->knot[i - p + j], high = s->knot[i + 1 + j - r];
      double a = (at - low) / (high - low);
      for (int k = 0; k < 2; k++)
        d[j][k] = (1 - a) * d[j - 1][k] + a * d[j][k];
    }
  }
  memcpy(value, d[p], sizeof d[p]);
}

void bwi_spline_start(const bwi_spline *s, double at[2]) {
  size_t i = (size_t)s->degree;
  while (!(s->knot[i + 1] > s->knot[i]))
    i++;
  polar(s, i, 0, at);
}

void bwi_spline_add(const bwi_spline *s, bwi_contours *contours) {
  for (size_t i = (size_t)s->degree; i < s->points; i++) {
    double b[4][2];
    if (!(s->knot[i + 1] > s->knot[i]))
      continue;
    for (int k = 1; k <= s->degree; k++)
      polar(s, i, k, b[k]);
    if (s->degree == 1)
      bwi_contours_line(contours, b[1]);
    else if (s->degree == 2)
      bwi_contours_quadratic(contours, b[1], b[2]);
    else
      bwi_contours_cubic(contours, b[1], b[2], b[3]);
  }
}
