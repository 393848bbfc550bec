/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Random vibration (docs/theory/dynamics.md): the covariance of the vectors' coordinates, by
 * quadrature over the frequency, and root mean squares of fields from its eigenvectors. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/strain.h"
#include "barwright/analysis.h"
#include "dynamics/internal.h"
#include "linear/blas.h"

/* Of a half panel; of panels that double away from a peak; of finite numbers above 0 at most. */
enum { POINTS = 4, LEVELS = 40, DOUBLINGS = 2100 };

static const double pi = 3.14159265358979323846;
/* Gauss's points and weights of degree 15 on -1 to 1, the positive half. */
static const double gauss_at[POINTS] = {0.18343464249564980494, 0.52553240991632898582,
                                        0.79666647741362673959, 0.96028985649753623168};
static const double gauss_weight[POINTS] = {0.36268378337836198297, 0.31370664587788728734,
                                            0.22238103445337447054, 0.10122853629037625915};
/* Parts of the mean square below this are left out. */
static const double negligible = 1e-17;

typedef bwi_density spectrum;

double bwi_between(const double *x, const double *y, double f) {
  if (x[0] > 0 && y[0] > 0 && y[1] > 0)
    return y[0] * pow(f / x[0], log(y[1] / y[0]) / log(x[1] / x[0]));
  return y[0] + (y[1] - y[0]) * (f - x[0]) / (x[1] - x[0]);
}

static bw_status check_spectrum(bw_context *context, const bw_harmonic *h, const spectrum *s) {
  double highest = h->frequency[h->frequency_count - 1];
  if (s->count < 2)
    return bw_fail(context, BW_INVALID, "a power spectral density has 2 points or more, got %d",
                   s->count);
  for (int k = 0; k < s->count; k++) {
    double f = s->frequency[k], y = s->density[k];
    if (!(f >= 0 && f < INFINITY && y >= 0 && y < INFINITY))
      return bw_fail(context, BW_INVALID,
                     "point %d of the power spectral density is %g at %g Hz; both must be 0 or "
                     "more, and finite",
                     k + 1, y, f);
    if (k > 0 && !(f > s->frequency[k - 1]))
      return bw_fail(context, BW_INVALID,
                     "the frequencies of the power spectral density must ascend: point %d is at %g "
                     "Hz, behind %g Hz",
                     k + 1, f, s->frequency[k - 1]);
  }
  if (s->frequency[s->count - 1] > highest * (1 + 1e-12))
    return bw_fail(context, BW_INVALID,
                   "the power spectral density reaches to %g Hz, and the harmonic response to %g "
                   "Hz: make that with a larger range",
                   s->frequency[s->count - 1], highest);
  return BW_OK;
}

/* The ends of panels: the points; doublings behind each, which resolve a power of the frequency;
 * and around each vector's pole steps that double from its half width, or from its distance to the
 * spectrum where that is more. */
static bw_status choose_ends(bw_context *context, const bw_harmonic *h, const spectrum *s,
                             double **ends, int *count) {
  bw_status status = BW_OK;
  int n = 0, modes = h->modes->count;
  double first = s->frequency[0], last = s->frequency[s->count - 1];
  double *end = BW_NEW(context, double, s->count + DOUBLINGS + h->count * (2 * LEVELS + 1));
  BW_TRY_MEMORY(end);
  for (int k = 0; k < s->count; k++) {
    double from = s->frequency[k], to = k + 1 < s->count ? s->frequency[k + 1] : 0;
    end[n++] = from;
    for (double f = 2 * from; f > 0 && f < to; f *= 2)
      end[n++] = f;
  }
  for (int i = 0; i < h->count; i++) {
    double f = sqrt(h->eigenvalue[i]) / (2 * pi);
    double width = f * bwi_half_width(h, i);
    double outside = fmax(fmax(first - f, f - last), 0);
    if (outside == 0 && !(width > 0) && h->load[i] != 0)
      BW_TRY(bw_fail(context, BW_SINGULAR,
                     "nothing damps %s %d at %g Hz: its random response has no limit. %s",
                     i < modes ? "mode" : "residual vector", i < modes ? i + 1 : i - modes + 1, f,
                     i < modes ? "Give a damping" : "Take more modes"));
    width = fmax(width, outside);
    for (int k = 0; k <= 2 * LEVELS && width > 0; k++) {
      double at = f + (k == 0 ? 0 : k % 2 ? 1 : -1) * width * ldexp(1, (k - 1) / 2);
      if (at > first && at < last)
        end[n++] = at;
    }
  }
  qsort(end, (size_t)n, sizeof *end, bwi_compare_numbers);
  *ends = end;
  *count = n;
  end = NULL;
done:
  bw_free(end);
  return status;
}

/* Adds the part of one frequency to the covariances, scaled by the roots of the eigenvalues. */
static bw_status add_frequency(bw_context *context, const bw_harmonic *h, double frequency,
                               double weight, double *q, const bwi_covariances *z) {
  double error, whole = 0, square = frequency * frequency;
  bw_status status = bw_harmonic_coordinates(context, h, frequency, q, &error);
  if (status != BW_OK)
    return status;
  for (int i = 0; i < h->count; i++) {
    double root = sqrt(h->eigenvalue[i]), a = q[2 * i] *= root, b = q[2 * i + 1] *= root;
    whole += a * a + b * b;
    for (int j = 0; j <= i; j++) {
      size_t at = (size_t)j * (size_t)h->count + (size_t)i;
      double product = weight * (a * q[2 * j] + b * q[2 * j + 1]);
      z->part[BWI_POSITION][at] += product;
      if (!z->part[BWI_CROSS])
        continue;
      z->part[BWI_CROSS][at] -= 2 * pi * frequency * weight * (b * q[2 * j] - a * q[2 * j + 1]);
      z->part[BWI_MOMENT_1][at] += frequency * product;
      z->part[BWI_MOMENT_2][at] += square * product;
      z->part[BWI_MOMENT_4][at] += square * square * product;
    }
  }
  if (whole > 0)
    *z->wrong += weight * error * error * whole;
  return BW_OK;
}

bw_status bwi_integrate_covariances(bw_context *context, const bw_harmonic *h, const spectrum *s,
                                    const bwi_covariances *z) {
  bw_status status = BW_OK;
  double *end = NULL, *q = BW_NEW(context, double, 2 * (int64_t)h->count + 1);
  int count, piece = 0;
  *z->wrong = 0;
  BW_TRY_MEMORY(q);
  BW_TRY(check_spectrum(context, h, s));
  BW_TRY(choose_ends(context, h, s, &end, &count));
  for (int k = 0; k + 1 < count; k++) {
    double middle = (end[k] + end[k + 1]) / 2, half = (end[k + 1] - end[k]) / 2;
    BW_TRY(bw_check_cancel(context));
    while (piece + 2 < s->count && middle > s->frequency[piece + 1])
      piece++;
    for (int p = 0; p < 2 * POINTS && half > 0; p++) {
      double f = middle + (p % 2 ? 1 : -1) * half * gauss_at[p / 2];
      double weight =
          half * gauss_weight[p / 2] * bwi_between(s->frequency + piece, s->density + piece, f);
      if (weight > 0)
        BW_TRY(add_frequency(context, h, f, weight, q, z));
    }
  }
done:
  bw_free(q);
  bw_free(end);
  return status;
}

/* Mean squares of displacement and von Mises stress at points, summed over one field. */
static bw_status add_field(bw_context *context, const bw_harmonic *h,
                           const bw_stress_points *points, const double *field, double *stress,
                           double *displacement, double *mises) {
  bw_status status = BW_OK;
  const bw_model *model = h->model;
  for (int64_t i = 0; displacement && i < 3 * (int64_t)model->mesh->node_count; i++)
    displacement[i] += field[i] * field[i];
  if (!mises)
    return BW_OK;
  BW_TRY(bw_point_stress(context, model->mesh, model->material, field, points, stress));
  for (int64_t i = 0; i < points->count; i++) {
    double own = bw_von_mises(stress + 6 * i);
    mises[i] += own * own;
  }
done:
  return status;
}

/* `covariance` becomes its eigenvectors; those that count give the fields. */
static bw_status sum_fields(bw_context *context, const bw_harmonic *h,
                            const bw_stress_points *points, double *covariance,
                            double *displacement, double *mises, double *motion, double *whole) {
  bw_status status = BW_OK;
  int n = h->count, width = 6 * h->coupling_count, info = 0, length = 8 * n + 64;
  double *mu = BW_NEW(context, double, n + 1), *work = BW_NEW(context, double, length);
  double *weight = BW_NEW(context, double, n + 1);
  double *field = BW_NEW(context, double, 3 * (int64_t)h->model->mesh->node_count);
  double *stress = BW_NEW(context, double, 6 * (int64_t)points->count + 1), left = 0;
  BW_TRY_MEMORY(mu && work && weight && field && stress);
  dsyev_("V", "L", &n, covariance, &n, mu, work, &length, &info);
  if (info != 0)
    BW_TRY(bw_fail(context, BW_INTERNAL, "dsyev failed on a covariance of %d (%d)", n, info));
  *whole = 0;
  for (int r = 0; r < n; r++)
    *whole += fmax(mu[r], 0);
  left = *whole;
  for (int r = n - 1; r >= 0 && left > negligible * *whole && mu[r] > 0; r--) {
    for (int i = 0; i < n; i++)
      weight[i] = covariance[(size_t)r * (size_t)n + (size_t)i] * sqrt(mu[r] / h->eigenvalue[i]);
    BW_TRY(bwi_harmonic_combine(context, h, weight, field));
    BW_TRY(add_field(context, h, points, field, stress, displacement, mises));
    for (int c = 0; motion && c < width; c++) {
      double sum = 0;
      for (int i = 0; i < n; i++)
        sum += weight[i] * h->motion[(int64_t)i * width + c];
      motion[c] += sum * sum;
    }
    left -= mu[r];
  }
done:
  bw_free(mu);
  bw_free(work);
  bw_free(weight);
  bw_free(field);
  bw_free(stress);
  return status;
}

bw_status bw_harmonic_random(bw_context *context, const bw_harmonic *h, int count,
                             const double *frequency, const double *density, double *displacement,
                             double *von_mises, double *motion, double *error) {
  bw_status status = BW_OK;
  spectrum s = {count, frequency, density};
  bw_stress_points points = {0};
  int64_t nodes = h->model->mesh->node_count;
  double *covariance = NULL, *mises = NULL, whole, wrong;
  bwi_blas_enter();
  covariance = BW_NEW0(context, double, (int64_t)h->count * h->count + 1);
  BW_TRY_MEMORY(covariance);
  BW_TRY(bw_stress_points_create(context, h->model->mesh, h->model->material, &points));
  if (von_mises) {
    mises = BW_NEW0(context, double, points.count);
    BW_TRY_MEMORY(mises);
  }
  if (displacement)
    memset(displacement, 0, 3 * (size_t)nodes * sizeof *displacement);
  if (motion)
    memset(motion, 0, 6 * (size_t)h->coupling_count * sizeof *motion);
  bwi_covariances z = {{covariance}, &wrong};
  BW_TRY(bwi_integrate_covariances(context, h, &s, &z));
  BW_TRY(sum_fields(context, h, &points, covariance, displacement, mises, motion, &whole));
  for (int64_t i = 0; displacement && i < 3 * nodes; i++)
    displacement[i] = sqrt(displacement[i]);
  for (int i = 0; motion && i < 6 * h->coupling_count; i++)
    motion[i] = sqrt(motion[i]);
  for (int64_t i = 0; von_mises && i < nodes; i++) {
    double largest = mises[i];
    for (int32_t k = points.point ? points.point[i].next : -1; k >= 0; k = points.point[k].next)
      largest = fmax(largest, mises[k]);
    von_mises[i] = sqrt(largest);
  }
  if (error)
    *error = whole > 0 ? sqrt(wrong / whole) : 0;
done:
  bwi_blas_leave();
  bw_stress_points_clear(&points);
  bw_free(covariance);
  bw_free(mises);
  return status;
}
