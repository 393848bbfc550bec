/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Numbers of stress tensors, row by row: von Mises, principal stresses, utilisation. */
#include "analysis/strain.h"

#include "barwright/analysis.h"

#include <math.h>

enum { ROWS_PER_CHUNK = 4096 };

typedef struct field {
  const bw_material *material;
  const double *stress;
  double *value, *direction;
} field;

/* Eigenvalues in descending order by Cardano's formula: with the deviator s, p^2 = s:s/6 and
 * r = det(s/p)/2, they are m + 2 p cos(phi + 2 pi k/3), phi = arccos(r)/3. Where two of them nearly
 * coincide, |r| near one, the arc cosine has lost half its digits and Jacobi rotations take
 * over. */
static void eigenvalues(const double t[6], double value[3]) {
  const double third = 2.0943951023931954923; /* 2 pi / 3 */
  double m = (t[0] + t[1] + t[2]) / 3;
  double a = t[0] - m, b = t[1] - m, c = t[2] - m, d = t[3], e = t[4], f = t[5];
  double off = d * d + e * e + f * f;
  double p = sqrt((a * a + b * b + c * c + 2 * off) / 6);
  if (!(p > 0x1p-500 && p < 0x1p300)) { /* zero, or out of the range where cubes are safe */
    bw_eigen3(t, value, NULL);
    return;
  }
  double determinant = a * (b * c - d * d) - f * (f * c - d * e) + e * (f * d - b * e);
  double r = determinant / (2 * p * p * p);
  if (!(fabs(r) < 1 - 1e-9)) {
    bw_eigen3(t, value, NULL);
    return;
  }
  double phi = acos(r) / 3;
  value[0] = m + 2 * p * cos(phi);
  value[2] = m + 2 * p * cos(phi + third);
  value[1] = 3 * m - value[0] - value[2];
}

static bw_status von_mises(void *data, int64_t begin, int64_t end, int worker) {
  const field *f = (const field *)data;
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    f->value[i] = bw_von_mises(f->stress + 6 * i);
  return BW_OK;
}

static bw_status principal(void *data, int64_t begin, int64_t end, int worker) {
  const field *f = (const field *)data;
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    if (f->direction)
      bw_eigen3(f->stress + 6 * i, f->value + 3 * i, f->direction + 9 * i);
    else
      eigenvalues(f->stress + 6 * i, f->value + 3 * i);
  return BW_OK;
}

double bwi_max_principal(const double t[6]) {
  double value[3];
  eigenvalues(t, value);
  return fmax(fabs(value[0]), fabs(value[2]));
}

static bw_status max_principal(void *data, int64_t begin, int64_t end, int worker) {
  const field *f = (const field *)data;
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    f->value[i] = bwi_max_principal(f->stress + 6 * i);
  return BW_OK;
}

static bw_status utilisation(void *data, int64_t begin, int64_t end, int worker) {
  const field *f = (const field *)data;
  (void)worker;
  for (int64_t i = begin; i < end; i++) { /* directions cost five times as much as values */
    const bw_material *own = bw_material_of(f->material, i);
    const double *strength = own->strength;
    bool same = strength[0] > 0 && strength[0] == strength[1] && strength[1] == strength[2];
    f->value[i] = same ? bwi_max_principal(f->stress + 6 * i) / strength[0]
                       : bw_material_utilisation(own, f->stress + 6 * i);
  }
  return BW_OK;
}

bw_status bw_von_mises_field(bw_context *context, int64_t count, const double *stress,
                             double *value) {
  field f = {NULL, stress, value, NULL};
  return bw_parallel(context, count, ROWS_PER_CHUNK, von_mises, &f);
}

bw_status bw_principal_field(bw_context *context, int64_t count, const double *stress,
                             double *values, double *directions) {
  field f = {NULL, stress, values, directions};
  return bw_parallel(context, count, ROWS_PER_CHUNK, principal, &f);
}

bw_status bw_max_principal_field(bw_context *context, int64_t count, const double *stress,
                                 double *value) {
  field f = {NULL, stress, value, NULL};
  return bw_parallel(context, count, ROWS_PER_CHUNK, max_principal, &f);
}

bw_status bw_utilisation_field(bw_context *context, const bw_material *material, int64_t count,
                               const double *stress, double *value) {
  if (!material)
    return bw_fail(context, BW_INVALID, "a utilisation field needs a material");
  if (material->parts && material->parts->element_count != count)
    return bw_fail(context, BW_INVALID,
                   "%lld stresses for a material given for each of %d elements: the utilisation is "
                   "of the stresses of elements then",
                   (long long)count, material->parts->element_count);
  field f = {material, stress, value, NULL};
  return bw_parallel(context, count, ROWS_PER_CHUNK, utilisation, &f);
}
