/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Eigenproblems of free plane bodies, whose three rigid-body motions are projected out. */
#include <math.h>

#include "base/dense.h"
#include "responsive/plate.h"

enum { RIGID = BWI_PLANE_MOTIONS };

static void remove_along(int64_t n, double along, const double *v, double *from) {
  for (int64_t i = 0; i < n; i++)
    from[i] -= along * v[i];
}

bw_status bwi_free_body_begin(bw_context *context, bwi_free_body *b) {
  bw_status status = BW_OK;
  int64_t n = b->size;
  b->mass_rigid = b->rigid + RIGID * n;
  for (int k = 0; k < RIGID; k++) {
    double *v = b->rigid + k * n, *m = b->mass_rigid + k * n;
    for (int pass = 0; pass < 2; pass++)
      for (int j = 0; j < k; j++)
        remove_along(n, bwi_dot(n, b->mass_rigid + j * n, v), b->rigid + j * n, v);
    BW_TRY(b->mass(context, b->data, v, m));
    double size = sqrt(bwi_dot(n, v, m));
    for (int64_t i = 0; i < n; i++) {
      v[i] /= size;
      m[i] /= size;
    }
  }
done:
  return status;
}

static bw_status each(bw_context *context, const bwi_free_body *b, bwi_plane_product *product,
                      int64_t count, const double *x, double *y) {
  bw_status status = BW_OK;
  for (int64_t k = 0; k < count && status == BW_OK; k++)
    status = product(context, b->data, x + k * b->size, y + k * b->size);
  return status;
}

static bw_status stiffness(bw_context *context, void *data, int64_t count, const double *x,
                           double *y) {
  const bwi_free_body *b = data;
  return each(context, b, b->stiffness, count, x, y);
}

static bw_status mass(bw_context *context, void *data, int64_t count, const double *x, double *y) {
  const bwi_free_body *b = data;
  return each(context, b, b->mass, count, x, y);
}

static bw_status precondition(bw_context *context, void *data, int64_t count, const double *f,
                              double *y) {
  const bwi_free_body *b = data;
  return each(context, b, b->precondition, count, f, y);
}

static bw_status project(bw_context *context, void *data, int64_t count, double *x) {
  (void)context;
  const bwi_free_body *b = data;
  int64_t n = b->size;
  for (int64_t k = 0; k < count; k++, x += n)
    for (int r = 0; r < RIGID; r++)
      remove_along(n, bwi_dot(n, b->mass_rigid + r * n, x), b->rigid + r * n, x);
  return BW_OK;
}

bwi_eigen_problem bwi_free_body_problem(bwi_free_body *b) {
  return (bwi_eigen_problem){.size = b->size,
                             .data = b,
                             .mass = mass,
                             .stiffness = stiffness,
                             .precondition = precondition,
                             .project = project,
                             .dimension = b->size - RIGID};
}
