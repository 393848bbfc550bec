/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Vibrations within the plane of a plate: a bar narrower than it is thick rings sideways first, and
 * what is heard is then not what bending says. The plate as a sheet in plane stress, free. */
#include <math.h>
#include <string.h>

#include "responsive/plate.h"
#include "responsive/sheet.h"

enum { RIGID = BWI_PLANE_MOTIONS, GUARDS = 2, ROUNDS = 400 };

typedef struct inplane {
  const bw_sheet *sheet;
  bwi_lagged *factor;
} inplane;

static bw_status times_stiffness(bw_context *context, const void *data, const double *x,
                                 double *y) {
  const struct bwi_sheet *inner = ((const inplane *)data)->sheet->inner;
  return bw_plane_multiply(context, inner->pattern, 2, inner->stiffness, x, y);
}

static bw_status times_mass(bw_context *context, const void *data, const double *x, double *y) {
  (void)context;
  const inplane *p = data;
  const bw_plane_pattern *g = p->sheet->inner->pattern;
  const double *mass = p->sheet->inner->mass;
  for (int64_t i = 0; i < g->node_count; i++) {
    double sum[2] = {0};
    for (int64_t k = g->start[i]; k < g->start[i + 1]; k++)
      for (int c = 0; c < 2; c++)
        sum[c] += mass[k] * x[2 * (int64_t)g->column[k] + c];
    y[2 * i] = sum[0];
    y[2 * i + 1] = sum[1];
  }
  return BW_OK;
}

static bw_status precondition(bw_context *context, const void *data, const double *x, double *y) {
  return bwi_lagged_apply(context, ((const inplane *)data)->factor, false, x, y);
}

/* Two translations and the rotation. */
static void rigid_motions(const bw_plane_mesh *mesh, double *rigid) {
  int64_t nodes = mesh->topology->nodes->node_count, n = 2 * nodes;
  for (int64_t i = 0; i < nodes; i++) {
    const double motion[RIGID][2] = {{1, 0}, {0, 1}, {-mesh->point[2 * i + 1], mesh->point[2 * i]}};
    for (int k = 0; k < RIGID; k++)
      memcpy(rigid + k * n + 2 * i, motion[k], sizeof motion[k]);
  }
}

bw_status bw_plate_inplane(bw_context *context, const bw_plate *plate, int count,
                           double *frequency) {
  bw_status status = BW_OK;
  const double pi = 3.14159265358979323846;
  bw_sheet_section section = {plate->material, plate->thickness, false};
  bw_sheet_description description = {.section_count = 1, .section = &section};
  bw_sheet *sheet = NULL;
  bwi_lagged *factor = NULL;
  bwi_lagged_work work;
  bool made;
  double *shifted = NULL, *vector = NULL, *rigid = NULL, *value = NULL;
  int64_t nodes = plate->mesh->topology->nodes->node_count, n = 2 * nodes;
  int block = count + GUARDS, iterations;
  if (count < 1 || block + RIGID >= n)
    return bw_fail(
        context, BW_INVALID,
        "%d modes requested of a plate with %lld unknowns in its plane: from 1 to %lld expected",
        count, (long long)n, (long long)(n - GUARDS - RIGID - 1));
  BW_TRY(bw_sheet_create(context, plate->mesh, &description, &sheet));
  BW_TRY(bwi_sheet_prepare(context, sheet, &made));
  BW_TRY(bwi_sheet_stiffness(context, sheet));
  BW_TRY(bwi_sheet_mass(context, sheet));
  BW_TRY(bwi_lagged_create(context, &bwi_lagged_symmetric, 2, &factor));
  const bw_plane_pattern *pattern = sheet->inner->pattern;
  shifted = BW_NEW(context, double, 4 * pattern->block_count);
  vector = BW_NEW0(context, double, block *n);
  rigid = BW_NEW(context, double, 2 * RIGID * n);
  value = BW_NEW(context, double, 2 * block);
  BW_TRY_MEMORY(shifted && vector && rigid && value);
  /* waves of the plate's size: makes the free matrix definite */
  const double *x = plate->mesh->point;
  double low[2] = {x[0], x[1]}, high[2] = {x[0], x[1]};
  for (int64_t i = 0; i < n; i++) {
    low[i % 2] = fmin(low[i % 2], x[i]);
    high[i % 2] = fmax(high[i % 2], x[i]);
  }
  double size = hypot(high[0] - low[0], high[1] - low[1]);
  double shift = plate->material->young[0] / plate->material->density / (size * size);
  for (int64_t k = 0; k < pattern->block_count; k++)
    for (int c = 0; c < 4; c++)
      shifted[4 * k + c] =
          sheet->inner->stiffness[4 * k + c] + (c % 3 == 0 ? shift * sheet->inner->mass[k] : 0);
  BW_TRY(bwi_lagged_factor(context, factor, pattern, shifted, &work));
  inplane data = {sheet, factor};
  bwi_free_body body = {.size = n,
                        .data = &data,
                        .stiffness = times_stiffness,
                        .mass = times_mass,
                        .precondition = precondition,
                        .rigid = rigid};
  rigid_motions(plate->mesh, rigid);
  BW_TRY(bwi_free_body_begin(context, &body));
  const bwi_eigen_problem eigen = bwi_free_body_problem(&body);
  const bwi_eigen_near near = {
      .wanted = count, .block = block, .start = vector, .tolerance = 1e-6, .limit = ROUNDS};
  BW_TRY(bwi_eigen_follow(context, &eigen, &near, vector, value, value + block, &iterations));
  for (int k = 0; k < count; k++)
    frequency[k] = sqrt(fmax(value[k], 0)) / (2 * pi);
done:
  bwi_lagged_destroy(factor);
  bw_release(sheet);
  bw_free(shifted);
  bw_free(vector);
  bw_free(rigid);
  bw_free(value);
  return status;
}
