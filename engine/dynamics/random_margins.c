/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Random vibration against strength and fatigue (docs/theory/dynamics.md, "Margins"): at each place
 * the covariances of the deviator of stress and of its rate, by the covariances of coordinates. */
#include <math.h>
#include <string.h>

#include "barwright/analysis.h"
#include "dynamics/exceedance.h"
#include "dynamics/internal.h"
#include "linear/blas.h"

enum { TOGETHER = 64 }; /* points of one task */

static const double pi = 3.14159265358979323846;

/* Five numbers whose squares' sum is that of von Mises stress. */
static void deviator(const double s[6], double y[BWI_DEVIATOR]) {
  y[0] = sqrt(0.75) * (s[0] - s[1]);
  y[1] = 0.5 * (2 * s[2] - s[0] - s[1]);
  for (int c = 0; c < 3; c++)
    y[2 + c] = sqrt(3.0) * s[3 + c];
}

typedef struct margins {
  const bw_harmonic *h;
  bw_stress_points points;
  double *part[BWI_COVARIANCES]; /* (count x count) whole */
  double *field;                 /* (count x points x BWI_DEVIATOR) of coordinates of energy 1 */
  double wrong;
  const double *strength; /* (Pa, points) or NULL */
  double sigma;
  double *moment;      /* (points x 4) m0, m1, m2, m4 */
  double *probability; /* (points) where there is strength, as the others */
  double *rate, *beyond;
} margins;

static void clear(margins *m) {
  bw_stress_points_clear(&m->points);
  for (int k = 0; k < BWI_COVARIANCES; k++)
    bw_free(m->part[k]);
  bw_free(m->field);
  bw_free(m->moment);
  bw_free(m->probability);
  bw_free(m->rate);
  bw_free(m->beyond);
}

/* The upper triangles: symmetric, but for the rates'. */
static void fill_triangles(margins *m) {
  size_t n = (size_t)m->h->count;
  for (int k = 0; k < BWI_COVARIANCES; k++)
    for (size_t j = 0; j < n; j++) {
      if (k == BWI_CROSS)
        m->part[k][j * n + j] = 0;
      for (size_t i = j + 1; i < n; i++)
        m->part[k][i * n + j] = (k == BWI_CROSS ? -1 : 1) * m->part[k][j * n + i];
    }
}

static bw_status fill_fields(bw_context *context, margins *m) {
  bw_status status = BW_OK;
  const bw_harmonic *h = m->h;
  int64_t points = m->points.count;
  double *stress = BW_NEW(context, double, 6 * points);
  BW_TRY_MEMORY(stress);
  for (int k = 0; k < h->count; k++) {
    double *own = m->field + k * points * BWI_DEVIATOR, scale = 1 / sqrt(h->eigenvalue[k]);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bw_point_stress(context, h->model->mesh, h->model->material, bwi_harmonic_vector(h, k),
                           &m->points, stress));
    for (int64_t i = 0; i < points; i++) {
      deviator(stress + 6 * i, own + BWI_DEVIATOR * i);
      for (int c = 0; c < BWI_DEVIATOR; c++)
        own[BWI_DEVIATOR * i + c] *= scale;
    }
    bw_progress(context, "stresses of vectors", (double)(k + 1) / h->count);
  }
done:
  bw_free(stress);
  return status;
}

typedef double square[BWI_DEVIATOR * BWI_DEVIATOR];
/* The covariances of a point's deviator. */
typedef struct point {
  square of[BWI_COVARIANCES];
} point;

static double trace(const square a) {
  double sum = 0;
  for (int c = 0; c < BWI_DEVIATOR; c++)
    sum += a[c * BWI_DEVIATOR + c];
  return fmax(sum, 0);
}

/* Of point i, by the covariances of its deviator, of which [BWI_MOMENT_2] is without (2 pi)^2. */
static bool take_point(const margins *m, int64_t i, square of[BWI_COVARIANCES]) {
  static const int order[4] = {BWI_POSITION, BWI_MOMENT_1, BWI_MOMENT_2, BWI_MOMENT_4};
  bwi_exceedance own;
  for (int k = 0; k < 4; k++)
    m->moment[4 * i + k] = trace(of[order[k]]);
  if (!m->strength)
    return true;
  double rms = sqrt(m->moment[4 * i]);
  square copy[3];
  for (int c = 0; c < BWI_DEVIATOR * BWI_DEVIATOR; c++)
    of[BWI_MOMENT_2][c] *= 4 * pi * pi;
  memcpy(copy[0], of[BWI_POSITION], sizeof copy[0]);
  memcpy(copy[1], of[BWI_MOMENT_2], sizeof copy[1]);
  memcpy(copy[2], of[BWI_CROSS], sizeof copy[2]);
  if (!bwi_exceedance_of(BWI_DEVIATOR, of[BWI_POSITION], of[BWI_MOMENT_2], of[BWI_CROSS],
                         m->strength[i], &own))
    return false;
  m->probability[i] = own.probability;
  m->rate[i] = own.rate;
  m->beyond[i] = 0;
  if (rms > 0) {
    if (!bwi_exceedance_of(BWI_DEVIATOR, copy[0], copy[1], copy[2], m->sigma * rms, &own))
      return false;
    m->beyond[i] = own.probability;
  }
  return true;
}

static bw_status take_points(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  bw_status status = BW_OK;
  const margins *m = data;
  int n = m->h->count, rows = (int)(end - begin) * BWI_DEVIATOR;
  const double one = 1, zero = 0;
  point *at = BW_NEW0(NULL, point, end - begin);
  double *own = BW_NEW(NULL, double, (int64_t)rows *n + 1);
  double *product = BW_NEW(NULL, double, (int64_t)rows *n + 1);
  BW_TRY_MEMORY(at && own && product);
  for (int k = 0; k < n; k++)
    memcpy(own + (size_t)k * (size_t)rows,
           m->field + (k * (int64_t)m->points.count + begin) * BWI_DEVIATOR,
           (size_t)rows * sizeof *own);
  for (int k = 0; k < BWI_COVARIANCES; k++) {
    dgemm_("N", "N", &rows, &n, &n, &one, own, &rows, m->part[k], &n, &zero, product, &rows);
    for (int v = 0; v < n; v++)
      for (int64_t i = 0; i < end - begin; i++) {
        const double *a = product + (int64_t)v * rows + i * BWI_DEVIATOR;
        const double *b = own + (int64_t)v * rows + i * BWI_DEVIATOR;
        for (int q = 0; q < BWI_DEVIATOR; q++)
          for (int p = 0; p < BWI_DEVIATOR; p++)
            at[i].of[k][q * BWI_DEVIATOR + p] += a[p] * b[q];
      }
  }
  for (int64_t i = begin; i < end; i++)
    if (!take_point(m, i, at[i - begin].of))
      BW_TRY(bw_fail(NULL, BW_INTERNAL, "dsyev failed on a covariance of stress"));
done:
  bw_free(at);
  bw_free(own);
  bw_free(product);
  return status;
}

/* `strength` (Pa, points) or NULL: moments alone. */
static bw_status compute(bw_context *context, const bwi_density *density, margins *m) {
  bw_status status = BW_OK;
  int64_t n = m->h->count, points = m->points.count;
  bwi_covariances z = {.wrong = &m->wrong};
  for (int k = 0; k < BWI_COVARIANCES; k++) {
    m->part[k] = z.part[k] = BW_NEW0(context, double, n *n + 1);
    BW_TRY_MEMORY(m->part[k]);
  }
  BW_TRY(bwi_integrate_covariances(context, m->h, density, &z));
  fill_triangles(m);
  m->field = BW_NEW(context, double, n *points *BWI_DEVIATOR + 1);
  m->moment = BW_NEW(context, double, 4 * points);
  BW_TRY_MEMORY(m->field && m->moment);
  if (m->strength) {
    m->probability = BW_NEW(context, double, points);
    m->rate = BW_NEW(context, double, points);
    m->beyond = BW_NEW(context, double, points);
    BW_TRY_MEMORY(m->probability && m->rate && m->beyond);
  }
  BW_TRY(fill_fields(context, m));
  BW_TRY(bw_parallel(context, points, TOGETHER, take_points, m));
done:
  return status;
}

/* Of each point, the given one or that of its material. */
static bw_status choose_strengths(bw_context *context, const margins *m, double given,
                                  double *strength) {
  for (int32_t i = 0; i < m->points.count; i++) {
    const bw_material *own = m->points.point ? m->points.point[i].material : m->h->model->material;
    const double *s = own->strength;
    strength[i] = given > 0 ? given : s[0];
    if (given > 0 || (s[0] > 0 && s[0] == s[1] && s[0] == s[2]))
      continue;
    return bw_fail(context, BW_INVALID,
                   "%s has no strength that is one number: give the strength that von Mises stress "
                   "is compared with",
                   own->name[0] ? own->name : "the material");
  }
  return BW_OK;
}

/* A point and those of other materials at its node. */
#define FOR_POINTS_AT(k, node, points)                                                             \
  for (int32_t k = (node); k >= 0; k = (points)->point ? (points)->point[k].next : -1)

bw_status bw_harmonic_margins(bw_context *context, const bw_harmonic *harmonic, int count,
                              const double *frequency, const double *density, double strength,
                              double sigma, double *probability, double *rate, double *used,
                              double *beyond) {
  bw_status status = BW_OK;
  bwi_density given = {count, frequency, density};
  margins m = {.h = harmonic, .sigma = sigma};
  double *of_point = NULL;
  bwi_blas_enter();
  if (!(strength >= 0 && strength < INFINITY))
    BW_TRY(bw_fail(context, BW_INVALID, "the strength is %g Pa; it must be above 0", strength));
  if (!(sigma > 0 && sigma < INFINITY))
    BW_TRY(bw_fail(context, BW_INVALID, "sigma is %g; it must be above 0", sigma));
  BW_TRY(bw_stress_points_create(context, harmonic->model->mesh, harmonic->model->material,
                                 &m.points));
  of_point = BW_NEW(context, double, m.points.count);
  BW_TRY_MEMORY(of_point);
  BW_TRY(choose_strengths(context, &m, strength, of_point));
  m.strength = of_point;
  BW_TRY(compute(context, &given, &m));
  for (int32_t i = 0; i < harmonic->model->mesh->node_count; i++) {
    int32_t most = i; /* the material of the largest part of its strength */
    FOR_POINTS_AT(k, i, &m.points) {
      if (sqrt(m.moment[4 * (int64_t)k]) / of_point[k] >
          sqrt(m.moment[4 * (int64_t)most]) / of_point[most])
        most = k;
    }
    used[i] = sigma * sqrt(m.moment[4 * (int64_t)most]) / of_point[most];
    beyond[i] = m.beyond[most];
    probability[i] = rate[i] = 0;
    FOR_POINTS_AT(k, i, &m.points) {
      probability[i] = fmax(probability[i], m.probability[k]);
      rate[i] = fmax(rate[i], m.rate[k]);
    }
  }
done:
  bwi_blas_leave();
  bw_free(of_point);
  clear(&m);
  return status;
}

bw_status bw_harmonic_random_damage(bw_context *context, const bw_harmonic *harmonic, int count,
                                    const double *frequency, const double *density,
                                    const bw_life_curve *curve, double *rate, double *moment) {
  bw_status status = BW_OK;
  bwi_density given = {count, frequency, density};
  margins m = {.h = harmonic};
  double own;
  bwi_blas_enter();
  BW_TRY(bw_spectral_damage(context, curve, BW_DIRLIK, (const double[4]){0}, &own));
  BW_TRY(bw_stress_points_create(context, harmonic->model->mesh, harmonic->model->material,
                                 &m.points));
  BW_TRY(compute(context, &given, &m));
  for (int32_t i = 0; i < harmonic->model->mesh->node_count; i++) {
    int32_t most = i;
    rate[i] = -1;
    FOR_POINTS_AT(k, i, &m.points) {
      BW_TRY(bw_spectral_damage(context, curve, BW_DIRLIK, m.moment + 4 * (int64_t)k, &own));
      most = own > rate[i] ? k : most;
      rate[i] = fmax(rate[i], own);
    }
    memcpy(moment + 4 * (int64_t)i, m.moment + 4 * (int64_t)most, 4 * sizeof *moment);
  }
done:
  bwi_blas_leave();
  clear(&m);
  return status;
}
