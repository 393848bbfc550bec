/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Exponents of the elastic field at an edge (docs/theory/singular.md). */
#include "barwright/singular.h"

#include <complex.h>
#include <math.h>

static const double pi = 3.14159265358979323846;

/* sin(lambda angle) + lambda sin(angle): symmetric fields of a wedge with free faces. */
static double symmetric(double lambda, double angle) {
  return sin(lambda * angle) + lambda * sin(angle);
}

/* The least root in (0, 1). With one face sliding the wedge is half of a symmetric one, and the
 * angle goes up to 4 pi. */
static double min_symmetric(double angle) {
  enum { STEPS = 200 };
  double low = 1e-3;
  if (symmetric(low, angle) <= 0)
    return 1;
  for (int i = 1; i <= STEPS; i++) {
    double high = 1e-3 + (1 - 1e-6 - 1e-3) * i / STEPS;
    if (symmetric(high, angle) > 0) {
      low = high;
      continue;
    }
    for (int k = 0; k < 60; k++) {
      double middle = (low + high) / 2;
      if (symmetric(middle, angle) > 0)
        low = middle;
      else
        high = middle;
    }
    return (low + high) / 2;
  }
  return 1;
}

/* 4 k sin(lambda angle)^2 - (k + 1)^2 + 4 lambda^2 sin(angle)^2 with k = 3 - 4 nu: one face fixed,
 * one free. The roots are complex where the angle is large; Newton from a grid of starts. */
static double min_fixed(double angle, double poisson) {
  const double kappa = 3 - 4 * poisson, square = sin(angle) * sin(angle);
  double min = 1;
  for (int i = 1; i < 20; i++)
    for (int j = 0; j < 8; j++) {
      double complex z = 0.05 * i + 0.1 * j * I, step = 1;
      for (int k = 0; k < 60 && cabs(step) > 1e-14; k++) {
        double complex s = csin(z * angle);
        double complex value = 4 * kappa * s * s - (kappa + 1) * (kappa + 1) + 4 * z * z * square;
        double complex slope = 8 * kappa * angle * s * ccos(z * angle) + 8 * z * square;
        if (cabs(slope) < 1e-300)
          break;
        step = value / slope;
        z -= step;
        if (cabs(z) > 4)
          break;
      }
      if (cabs(step) < 1e-6 && creal(z) > 1e-3 && creal(z) < min)
        min = creal(z);
    }
  return min < 1 - 1e-6 ? min : 1;
}

double bw_williams_exponent(bw_corner corner, double angle, double poisson) {
  angle = fmin(angle, 2 * pi);
  if (!(angle > 0))
    return 1;
  if (corner == BW_CORNER_FIXED)
    return min_fixed(angle, poisson);
  return min_symmetric(corner == BW_CORNER_SLIDING ? 2 * angle : angle);
}

const char *bw_singular_word(bw_singular_kind kind) {
  static const char *const word[] = {
      "re-entrant edge", "border of a support", "border of a rigid coupling",
      "end of a bond",   "line load",           "line support",
      "point load",      "point support"};
  return word[kind];
}
