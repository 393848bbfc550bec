/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Displacement and stress of a harmonic response. */
#include <math.h>
#include <string.h>

#include "analysis/strain.h"
#include "barwright/analysis.h"
#include "dynamics/internal.h"
#include "linear/blas.h"
#include "linear/multivector.h"

bw_status bwi_harmonic_combine(bw_context *context, const bw_harmonic *h, const double *weight,
                               double *field) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)h->model->mesh->node_count;
  int modes = h->modes->count, more = h->count - modes;
  memset(field, 0, (size_t)size * sizeof *field);
  if (modes)
    BW_TRY(bwi_multi_combine(context, size, modes, h->modes->shape, 1, weight, modes, 1, 0, field));
  if (more)
    BW_TRY(
        bwi_multi_combine(context, size, more, h->residual, 1, weight + modes, more, 1, 1, field));
done:
  return status;
}

bw_status bw_harmonic_displacement(bw_context *context, const bw_harmonic *h, double frequency,
                                   double *real, double *imaginary) {
  bw_status status = BW_OK;
  double *q = BW_NEW(context, double, 2 * (int64_t)h->count + 1);
  double *part = BW_NEW(context, double, h->count + 1);
  bwi_blas_enter();
  BW_TRY_MEMORY(q && part);
  BW_TRY(bw_harmonic_coordinates(context, h, frequency, q, NULL));
  for (int which = 0; which < 2; which++) {
    for (int k = 0; k < h->count; k++)
      part[k] = q[2 * k + which];
    BW_TRY(bwi_harmonic_combine(context, h, part, which ? imaginary : real));
  }
done:
  bwi_blas_leave();
  bw_free(q);
  bw_free(part);
  return status;
}

/* What `width` numbers of each vector, `stride` apart, are over frequencies: real parts, then
 * imaginary ones. */
static bw_status take_curve(bw_context *context, const bw_harmonic *h, int width, int64_t stride,
                            const double *of, int count, const double *frequency,
                            double *response) {
  bw_status status = BW_OK;
  double *q = BW_NEW(context, double, 2 * (int64_t)h->count + 1);
  BW_TRY_MEMORY(q);
  for (int i = 0; i < count; i++) {
    double *out = response + 2 * (int64_t)width * i;
    BW_TRY(bw_harmonic_coordinates(context, h, frequency[i], q, NULL));
    memset(out, 0, 2 * (size_t)width * sizeof *out);
    for (int k = 0; k < h->count; k++)
      for (int c = 0; c < 2 * width; c++)
        out[c] += q[2 * k + c / width] * of[k * stride + c % width];
  }
done:
  bw_free(q);
  return status;
}

bw_status bw_harmonic_curve(bw_context *context, const bw_harmonic *h, int32_t node, int count,
                            const double *frequency, double *response) {
  bw_status status = BW_OK;
  double *u = NULL;
  if (node < 0 || node >= h->model->mesh->node_count)
    return bw_fail(context, BW_INVALID, "there is no node %d: the mesh has %d", (int)node + 1,
                   (int)h->model->mesh->node_count);
  u = BW_NEW(context, double, 3 * (int64_t)h->count + 1);
  BW_TRY_MEMORY(u);
  for (int k = 0; k < h->count; k++)
    memcpy(u + 3 * (size_t)k, bwi_harmonic_vector(h, k) + 3 * (int64_t)node, 3 * sizeof *u);
  BW_TRY(take_curve(context, h, 3, 3, u, count, frequency, response));
done:
  bw_free(u);
  return status;
}

bw_status bw_harmonic_point_curve(bw_context *context, const bw_harmonic *h, int coupling,
                                  int count, const double *frequency, double *response) {
  int points = h->coupling_count;
  if (coupling < 0 || coupling >= points)
    return bw_fail(context, BW_INVALID, "there is no coupling %d: the model has %d", coupling + 1,
                   points);
  return take_curve(context, h, 6, 6 * (int64_t)points, h->motion + 6 * (int64_t)coupling, count,
                    frequency, response);
}

double bwi_von_mises_product(const double *a, const double *b) {
  return ((a[0] - a[1]) * (b[0] - b[1]) + (a[1] - a[2]) * (b[1] - b[2]) +
          (a[2] - a[0]) * (b[2] - b[0])) /
             2 +
         3 * (a[3] * b[3] + a[4] * b[4] + a[5] * b[5]);
}

/* The largest von Mises stress of a cos t - b sin t. */
static double largest_von_mises(const double *a, const double *b) {
  double aa = bwi_von_mises_product(a, a), bb = bwi_von_mises_product(b, b),
         ab = bwi_von_mises_product(a, b);
  return sqrt(fmax((aa + bb) / 2 + hypot((aa - bb) / 2, ab), 0));
}

bw_status bw_harmonic_stress(bw_context *context, const bw_harmonic *h, double frequency,
                             double *real, double *imaginary, double *von_mises) {
  bw_status status = BW_OK;
  const bw_mesh *mesh = h->model->mesh;
  const bw_material *material = h->model->material;
  int64_t size = 3 * (int64_t)mesh->node_count;
  bw_stress_points points = {0};
  double *u = BW_NEW(context, double, 2 * size), *stress = NULL;
  BW_TRY_MEMORY(u);
  BW_TRY(bw_harmonic_displacement(context, h, frequency, u, u + size));
  BW_TRY(bw_stress_points_create(context, mesh, material, &points));
  stress = BW_NEW(context, double, 12 * (int64_t)points.count);
  BW_TRY_MEMORY(stress);
  double *other = stress + 6 * (int64_t)points.count;
  BW_TRY(bw_point_stress(context, mesh, material, u, &points, stress));
  BW_TRY(bw_point_stress(context, mesh, material, u + size, &points, other));
  for (int32_t i = 0; i < mesh->node_count; i++) {
    int32_t most = i;
    double largest = -1;
    for (int32_t k = i; k >= 0; k = points.point ? points.point[k].next : -1) {
      double own = largest_von_mises(stress + 6 * (int64_t)k, other + 6 * (int64_t)k);
      most = own > largest ? k : most;
      largest = fmax(own, largest);
    }
    if (von_mises)
      von_mises[i] = largest;
    if (real)
      memcpy(real + 6 * (int64_t)i, stress + 6 * (int64_t)most, 6 * sizeof *real);
    if (imaginary)
      memcpy(imaginary + 6 * (int64_t)i, other + 6 * (int64_t)most, 6 * sizeof *imaginary);
  }
done:
  bw_stress_points_clear(&points);
  bw_free(u);
  bw_free(stress);
  return status;
}
