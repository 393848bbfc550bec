/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* How often the length of a Gaussian vector of mean 0 exceeds a level (docs/theory/dynamics.md,
 * "Margins"). The square of the length is Q = sum of lambda_i times squares of independent normal
 * variables. Its distribution is an integral of exp(-s x) M(s), M(s) = product of
 * (1 - 2 lambda_i s)^(-1/2), over a path that opens to the right through a saddle point: the sum
 * has the digits of its first term, however small the probability is. */
#include "dynamics/exceedance.h"

#include <complex.h>
#include <math.h>

#include "linear/blas.h"

/* Of bisections; of terms of the sum at most. */
enum { HALVINGS = 40, TERMS = 2000 };

static const double pi = 3.14159265358979323846;
/* Between points of the path, in units of the width of the saddle. */
static const double spacing = 0.15;
/* Components of y below this part of the mean square of another one, such as rounding, tell nothing
 * of y . y_t: their sizes enter its mean at given y by the correlation alone, however small. */
static const double negligible = 1e-8;

/* What the path integrates, all with lambda_1 = 1. */
typedef struct form {
  int count;
  double lambda[BWI_DEVIATOR]; /* descending from 1 */
  double x;
  double first[BWI_DEVIATOR];                /* factors of 1/(1 - 2 lambda_i s) */
  double second[BWI_DEVIATOR][BWI_DEVIATOR]; /* and of products of two of these */
} form;

/* Of Q at x: probability beyond x, density, and densities times means of squares of the rate. */
typedef struct integrals {
  double probability, density, square, drift;
} integrals;

/* The path is s = c + w (i u + k u^2), with c at the saddle of exp(-s x) M(s) / |s|: above 0, where
 * `far` is 1/2 - c, or below 0, where `far` is -c. */
typedef struct path {
  bool above;
  double far, c, w, k;
} path;

/* The derivative of log M(s) - s x - log |s|, which grows with s; curvature may be NULL. */
static double slope_at(const form *f, bool above, double far, double *curvature) {
  double s = above ? 0.5 - far : -far, sum = -f->x - 1 / s, bend = 1 / (s * s);
  for (int i = 0; i < f->count; i++) {
    double l = f->lambda[i], base = above ? 1 - l + 2 * l * far : 1 + 2 * l * far;
    sum += l / base;
    bend += 2 * (l / base) * (l / base);
  }
  if (curvature)
    *curvature = bend;
  return sum;
}

static path choose_path(const form *f) {
  double sum = 0, bend, low, high;
  for (int i = 0; i < f->count; i++)
    sum += f->lambda[i];
  path p = {.above = f->x > sum};
  if (p.above) {
    low = 0.1 / (f->x + 10);
    high = 0.5 - 0.1 / (f->x + 10);
  } else {
    low = 0.9 / f->x;
    high = (f->count / 2.0 + 1.1) / f->x;
  }
  for (int k = 0; k < HALVINGS; k++) { /* the slope falls as `far` grows */
    double middle = sqrt(low * high);
    if (slope_at(f, p.above, middle, NULL) > 0)
      low = middle;
    else
      high = middle;
  }
  p.far = sqrt(low * high);
  p.c = p.above ? 0.5 - p.far : -p.far;
  slope_at(f, p.above, p.far, &bend);
  p.w = 1 / sqrt(bend);
  p.k = p.w / (4 * p.far);
  return p;
}

/* Adds the values at u; the size of the term. */
static double add_point(const form *f, const path *p, double u, integrals *sum) {
  double complex step = p->w * (p->k * u * u + I * u), s = p->c + step;
  double complex inverse[BWI_DEVIATOR], m = 1, first = 0, second = 0;
  for (int i = 0; i < f->count; i++) {
    double l = f->lambda[i];
    double base = p->above ? 1 - l + 2 * l * p->far : 1 + 2 * l * p->far;
    double complex factor = base - 2 * l * step;
    inverse[i] = 1 / factor;
    m /= csqrt(factor);
  }
  for (int i = 0; i < f->count; i++) {
    first += f->first[i] * inverse[i];
    for (int j = 0; j < i; j++)
      second += f->second[i][j] * inverse[i] * inverse[j];
  }
  double complex term = m * cexp(-step * f->x) * p->w * (I + 2 * p->k * u);
  double twice = u > 0 ? 2 : 1; /* -u has the conjugate value */
  sum->probability += twice * cimag(term / s);
  sum->density += twice * cimag(term);
  sum->square += twice * cimag(term * first);
  sum->drift += twice * cimag(term * second);
  return cabs(term) * (1 + 1 / cabs(s) + cabs(first) + cabs(second));
}

static integrals integrate(const form *f) {
  integrals sum = {0};
  path p = choose_path(f);
  double scale = spacing / (2 * pi) * exp(-p.c * f->x), most = 0;
  for (int k = 0; k < TERMS; k++) {
    double size = add_point(f, &p, spacing * k, &sum);
    most = fmax(most, size);
    if (size < 1e-17 * most)
      break;
  }
  sum.probability *= scale;
  sum.density *= scale;
  sum.square *= scale;
  sum.drift *= scale;
  if (!p.above)
    sum.probability += 1; /* beyond the pole at 0 */
  sum.probability = fmin(fmax(sum.probability, 0), 1);
  return sum;
}

/* matrix = vectors' matrix vectors, count x count. */
static void turn(int count, const double *vectors, double *matrix) {
  double product[BWI_DEVIATOR * BWI_DEVIATOR];
  const double one = 1, zero = 0;
  dgemm_("N", "N", &count, &count, &count, &one, matrix, &count, vectors, &count, &zero, product,
         &count);
  dgemm_("T", "N", &count, &count, &count, &one, vectors, &count, product, &count, &zero, matrix,
         &count);
}

/* The factors by which E[(y . y_t)^2] and its part by the mean of y . y_t at given y are found.
 * Schwarz's inequality limits the square of c_ij, which rounding may not. */
static void fill_factors(int n, const double *velocity, const double *cross, double unit, form *f) {
  for (int i = 0; i < n; i++) {
    double li = f->lambda[i], vi = fmax(velocity[i * n + i] / unit, 0);
    f->first[i] = li * vi;
    for (int j = 0; j < n; j++) {
      double lj = f->lambda[j], vj = fmax(velocity[j * n + j] / unit, 0);
      double c = cross[j * n + i] / unit, square = fmin(c * c, fmin(lj * vi, li * vj));
      f->first[i] -= square;
      f->second[i][j] =
          fmin(li, lj) > negligible * fmax(li, lj) ? square * (li - lj) * (li - lj) / (li * lj) : 0;
    }
  }
}

bool bwi_exceedance_of(int count, double *position, double *velocity, double *cross, double level,
                       bwi_exceedance *result) {
  double mu[BWI_DEVIATOR], work[8 * BWI_DEVIATOR];
  int info = 0, length = 8 * BWI_DEVIATOR;
  form f = {.count = count};
  *result = (bwi_exceedance){0};
  dsyev_("V", "U", &count, position, &count, mu, work, &length, &info);
  if (info != 0)
    return false;
  double most = mu[count - 1];
  f.x = level / most * level;
  if (!(most > 0) || !(f.x < 1e5)) /* beyond, exp(-x / 2) is 0 */
    return true;
  if (f.x < 1e-100) {
    result->probability = 1;
    return true;
  }
  for (int i = 0; i < count; i++)
    f.lambda[i] = fmax(mu[i] / most, 0);
  turn(count, position, velocity);
  turn(count, position, cross);
  fill_factors(count, velocity, cross, most, &f);
  integrals sum = integrate(&f);
  result->probability = sum.probability;
  /* E|y . y_t| at |y|^2 = x by Schwarz, with E|z| <= sqrt(2/pi E(z - m)^2 + m^2) of a normal z */
  double square = fmax(2 / pi * sum.square + (1 - 2 / pi) * fmax(sum.drift, 0), 0);
  result->rate = sqrt(fmax(sum.density, 0) * square);
  return true;
}
