/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Energy of a solid, its gradient and its second derivatives. */
#include "nonlinear/internal.h"

#include <math.h>
#include <string.h>

enum { ELEMENTS_PER_CHUNK = 64, ROWS_PER_CHUNK = 256, SIZE = 24 };

typedef struct element_shape {
  double energy, ratio;
  bool defined;
} element_shape;

typedef struct data {
  const bw_solid *solid;
  const double *u;
  bool project;
  element_shape *shape; /* by element */
  double *force;        /* elements x 24, or NULL */
  double *matrix;       /* elements x 24 x 24, or NULL */
  double *gradient, *stiffness;
} data;

static bool point(const data *d, const bw_solid_material *m, int32_t e, int q, double volume,
                  element_shape *shape) {
  const bw_grid *grid = d->solid->grid;
  double g[8][3], f[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, energy, stress[9], tangent[81];
  for (int a = 0; a < 8; a++)
    for (int k = 0; k < 3; k++)
      g[a][k] = m->rule->gradient[24 * (int64_t)q + 3 * a + k] / grid->spacing[k];
  for (int a = 0; a < 8; a++)
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 3; k++)
        f[3 * i + k] += d->u[3 * (int64_t)grid->element[8 * (int64_t)e + a] + i] * g[a][k];
  double ratio = f[0] * (f[4] * f[8] - f[5] * f[7]) - f[1] * (f[3] * f[8] - f[5] * f[6]) +
                 f[2] * (f[3] * f[7] - f[4] * f[6]);
  shape->ratio = fmin(shape->ratio, ratio);
  if (!bw_law_evaluate((bw_law)m->law[q], m->mu[q], m->lambda[q], f, d->project, &energy,
                       d->force ? stress : NULL, d->matrix ? tangent : NULL))
    return false;
  for (int k = 0; k < m->fibre_count; k++)
    bw_fibre_add(m->fibre_stiffness[q * m->fibre_count + k],
                 m->fibre + 3 * ((int64_t)q * m->fibre_count + k), f, d->project, &energy,
                 d->force ? stress : NULL, d->matrix ? tangent : NULL);
  double weight = volume * m->rule->weight[q];
  shape->energy += weight * energy;
  if (d->force)
    for (int a = 0; a < 8; a++)
      for (int i = 0; i < 3; i++)
        d->force[SIZE * (int64_t)e + 3 * a + i] += weight * bw_dot(stress + 3 * i, g[a]);
  if (d->matrix)
    for (int a = 0; a < 8; a++)
      for (int i = 0; i < 3; i++)
        for (int b = 0; b < 8; b++)
          for (int k = 0; k < 3; k++) {
            double sum = 0;
            for (int j = 0; j < 3; j++)
              for (int l = 0; l < 3; l++)
                sum += g[a][j] * tangent[9 * (3 * i + j) + 3 * k + l] * g[b][l];
            d->matrix[SIZE * (SIZE * (int64_t)e + 3 * a + i) + 3 * b + k] += weight * sum;
          }
  return true;
}

static bw_status elements(void *of, int64_t begin, int64_t end, int worker) {
  const data *d = (const data *)of;
  (void)worker;
  for (int64_t e = begin; e < end; e++) {
    const bw_solid_material *m = d->solid->palette->material[d->solid->grid->material[e]];
    double volume = bwi_solid_volume(d->solid->grid, (int32_t)e);
    d->shape[e] = (element_shape){0, INFINITY, true};
    for (int32_t q = 0; q < m->rule->count; q++)
      if (!point(d, m, (int32_t)e, q, volume, &d->shape[e]))
        d->shape[e].defined = false;
  }
  return BW_OK;
}

static bw_status rows(void *of, int64_t begin, int64_t end, int worker) {
  const data *d = (const data *)of;
  const bw_graph *graph = d->solid->graph;
  (void)worker;
  for (int64_t i = begin; i < end; i++)
    for (int64_t p = graph->start[i]; p < graph->start[i + 1]; p++) {
      double block[9] = {0};
      for (int64_t k = graph->gather_start[p]; k < graph->gather_start[p + 1]; k++) {
        int64_t e = graph->gather_element[k];
        int a = graph->gather_local[k] >> 4, b = graph->gather_local[k] & 15;
        for (int r = 0; r < 3 && d->stiffness; r++)
          for (int c = 0; c < 3; c++)
            block[3 * r + c] += d->matrix[SIZE * (SIZE * e + 3 * a + r) + 3 * b + c];
        if (d->gradient && graph->column[p] == i)
          for (int r = 0; r < 3; r++)
            d->gradient[3 * i + r] += d->force[SIZE * e + 3 * a + r];
      }
      if (d->stiffness)
        memcpy(d->stiffness + 9 * p, block, sizeof block);
    }
  return BW_OK;
}

bw_status bw_solid_evaluate(bw_context *context, const bw_solid *solid, const double *u,
                            bool project, double *energy, double *gradient, double *stiffness,
                            bw_solid_shape *out) {
  bw_status status = BW_OK;
  int64_t count = solid->grid->element_count;
  data d = {
      .solid = solid, .u = u, .project = project, .gradient = gradient, .stiffness = stiffness};
  d.shape = BW_NEW(context, element_shape, count);
  d.force = gradient ? BW_NEW0(context, double, SIZE *count) : NULL;
  d.matrix = stiffness ? BW_NEW0(context, double, SIZE *SIZE *count) : NULL;
  if (!d.shape || (gradient && !d.force) || (stiffness && !d.matrix)) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bw_parallel(context, count, ELEMENTS_PER_CHUNK, elements, &d));
  double sum = 0;
  *out = (bw_solid_shape){.least_ratio = INFINITY, .defined = true};
  for (int32_t e = 0; e < count; e++) {
    sum += d.shape[e].energy;
    out->inverted += !(d.shape[e].ratio > 0);
    out->defined = out->defined && d.shape[e].defined;
    if (!(d.shape[e].ratio >= out->least_ratio)) {
      out->least_ratio = d.shape[e].ratio;
      out->worst = e;
    }
  }
  if (!out->defined)
    goto done;
  if (energy)
    *energy = sum;
  if (gradient)
    memset(gradient, 0, 3 * (size_t)solid->grid->node_count * sizeof *gradient);
  if (gradient || stiffness)
    BW_TRY(bw_parallel(context, solid->graph->node_count, ROWS_PER_CHUNK, rows, &d));
done:
  bw_free(d.shape);
  bw_free(d.force);
  bw_free(d.matrix);
  return status;
}
