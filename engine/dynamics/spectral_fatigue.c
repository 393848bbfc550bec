/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Fatigue of a random stress by its spectral moments (docs/theory/dynamics.md). */
#include <math.h>

#include "barwright/dynamics.h"
#include "dynamics/internal.h"

enum { TERMS = 10000 };

/* The logarithm of the integral of t^(a-1) e^-t beyond x, for a of 1 or more. */
static double log_gamma_beyond(double a, double x) {
  double whole = lgamma(a);
  if (!(x > 0))
    return whole;
  double front = a * log(x) - x;
  if (x < a + 1) { /* the series of what is below x */
    double term = 1 / a, sum = term;
    for (int n = 1; n < TERMS && term > 1e-17 * sum; n++)
      sum += term *= x / (a + n);
    return whole + log1p(-fmin(exp(front + log(sum) - whole), 1));
  }
  double b = x + 1 - a, c = INFINITY, d = 1 / b, fraction = d; /* Lentz */
  for (int n = 1; n < TERMS; n++) {
    double an = n * (a - n);
    b += 2;
    d = 1 / (an * d + b);
    c = b + an / c;
    fraction *= c * d;
    if (fabs(c * d - 1) < 1e-16)
      break;
  }
  return front + log(fraction);
}

/* The mean of (z / a)^k over amplitudes z above the limit: of Rayleigh's distribution whose
 * Gaussian has the deviation `sigma`; and of an exponential one of this mean. */
static double rayleigh(const bw_life_curve *c, double sigma) {
  double k = c->exponent, l = c->limit / sigma;
  return exp(k * log(sigma / c->amplitude * sqrt(2)) + log_gamma_beyond(1 + k / 2, l * l / 2));
}

static double exponential(const bw_life_curve *c, double mean) {
  return exp(c->exponent * log(mean / c->amplitude) +
             log_gamma_beyond(1 + c->exponent, c->limit / mean));
}

/* Irregularities of a spectrum, 0 to 1: a2 is that of zero crossings over peaks. */
typedef struct bandwidth {
  double sigma;    /* (Pa) */
  double crossing; /* (1/s) upwards through 0 */
  double a1, a2;
} bandwidth;

static bandwidth bandwidth_of(const double m[4]) {
  bandwidth b = {.sigma = sqrt(m[0]), .crossing = sqrt(m[2] / m[0])};
  b.a1 = fmin(m[1] / sqrt(m[0] * m[2]), 1);
  b.a2 = fmin(m[2] / sqrt(m[0]) / sqrt(m[3]), b.a1);
  return b;
}

/* Benasciutti and Tovo (2005), equations of the approximation "2". */
static double tovo_benasciutti(const bw_life_curve *c, const bandwidth *b) {
  double narrow = b->crossing * rayleigh(c, b->sigma), rest = 1 - b->a2;
  if (!(rest > 1e-9))
    return narrow;
  double d = (b->a1 - b->a2) / rest;
  double weight = d * (1.112 * (1 - b->a1) * exp(2.11 * b->a2) + d);
  weight = fmin(fmax(weight, 0), 1);
  return weight * narrow + (1 - weight) * b->crossing / b->a2 * rayleigh(c, b->a2 * b->sigma);
}

/* Dirlik (1985), with amplitudes sigma Z. */
static double dirlik(const bw_life_curve *c, const bandwidth *b) {
  double g = b->a2, xm = b->a1 * g, peaks = b->crossing / g;
  if (!(1 - g > 1e-9))
    return b->crossing * rayleigh(c, b->sigma);
  double d1 = 2 * (xm - g * g) / (1 + g * g);
  double r = (g - xm - d1 * d1) / (1 - g - d1 + d1 * d1);
  double d2 = (1 - g - d1 + d1 * d1) / (1 - r), d3 = 1 - d1 - d2;
  double sum = d3 * rayleigh(c, b->sigma);
  if (r != 0)
    sum += d2 * rayleigh(c, fabs(r) * b->sigma);
  double q = 1.25 * (g - d3 - d2 * r) / d1;
  if (d1 > 0 && q > 0)
    sum += d1 * exponential(c, q * b->sigma);
  return peaks * sum;
}

/* Wirsching and Light (1980). */
static double wirsching_light(const bw_life_curve *c, const bandwidth *b) {
  double k = c->exponent, a = 0.926 - 0.033 * k, width = sqrt(1 - b->a2 * b->a2);
  return (a + (1 - a) * pow(1 - width, 1.587 * k - 2.323)) * b->crossing * rayleigh(c, b->sigma);
}

bw_status bw_spectral_damage(bw_context *context, const bw_life_curve *curve,
                             bw_spectral_method method, const double moment[4], double *rate) {
  bw_status status = bwi_check_curve(context, curve);
  if (status != BW_OK)
    return status;
  if (curve->strength > 0)
    return bw_fail(context, BW_INVALID,
                   "a random stress has the mean 0, so that no strength of mean stresses enters: "
                   "leave 'strength' out");
  *rate = 0;
  for (int k = 0; k < 4; k++)
    if (!(moment[k] >= 0 && moment[k] < INFINITY))
      return bw_fail(context, BW_INVALID,
                     "spectral moment %d is %g; it must be 0 or more, and finite", k + 1,
                     moment[k]);
  if (!(moment[0] > 0 && moment[1] > 0 && moment[2] > 0 && moment[3] > 0))
    return BW_OK;
  bandwidth b = bandwidth_of(moment);
  switch (method) {
  case BW_TOVO_BENASCIUTTI:
    *rate = tovo_benasciutti(curve, &b);
    break;
  case BW_DIRLIK:
    *rate = dirlik(curve, &b);
    break;
  case BW_WIRSCHING_LIGHT:
    *rate = wirsching_light(curve, &b);
    break;
  case BW_NARROW_BAND:
    *rate = b.crossing * rayleigh(curve, b.sigma);
    break;
  }
  *rate /= curve->cycles;
  return BW_OK;
}
