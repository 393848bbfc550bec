/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Responses of remote points: their motions are linear in those of the nodes. */
#include <math.h>
#include <string.h>

#include "dynamics/internal.h"
#include "joint/fields.h"
#include "linear/blas.h"

bw_status bw_harmonic_point_curve(bw_context *context, const bw_harmonic *h, int coupling,
                                  int count, const double *frequency, double *response) {
  bw_status status = BW_OK;
  int points = h->coupling_count;
  double *q = NULL;
  if (coupling < 0 || coupling >= points)
    return bw_fail(context, BW_INVALID, "there is no coupling %d: the model has %d", coupling + 1,
                   points);
  q = BW_NEW(context, double, 2 * (int64_t)h->count + 1);
  BW_TRY_MEMORY(q);
  memset(response, 0, 12 * (size_t)count * sizeof *response);
  for (int i = 0; i < count; i++) {
    BW_TRY(bw_harmonic_coordinates(context, h, frequency[i], q, NULL));
    for (int k = 0; k < h->count; k++)
      for (int c = 0; c < 12; c++)
        response[12 * (int64_t)i + c] +=
            q[2 * k + c / 6] * h->motion[6 * ((int64_t)k * points + coupling) + c % 6];
  }
done:
  bw_free(q);
  return status;
}

bw_status bw_harmonic_random_points(bw_context *context, const bw_harmonic *h, int count,
                                    const double *frequency, const double *density,
                                    double *motion) {
  bw_status status = BW_OK;
  int n = h->count, width = 6 * h->coupling_count;
  double wrong, *covariance = BW_NEW0(context, double, (int64_t)n *n + 1);
  const double *of = h->motion;
  bwi_blas_enter();
  BW_TRY_MEMORY(covariance);
  BW_TRY(bwi_harmonic_covariance(context, h, count, frequency, density, covariance, &wrong));
  for (int c = 0; c < width; c++) {
    double sum = 0;
    for (int i = 0; i < n; i++)
      for (int j = 0; j <= i; j++)
        sum += (i == j ? 1 : 2) * covariance[(int64_t)j * n + i] * of[(int64_t)i * width + c] *
               of[(int64_t)j * width + c] / sqrt(h->eigenvalue[i] * h->eigenvalue[j]);
    motion[c] = sqrt(fmax(sum, 0));
  }
done:
  bwi_blas_leave();
  bw_free(covariance);
  return status;
}
