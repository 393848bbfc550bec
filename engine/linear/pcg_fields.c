/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The space of conjugate gradients (pcg_space.h) whose vectors lie one after the other.
 *
 * Invariant: columns 0 .. count - 1 of r, z, p, q belong to right-hand sides that go on; side[k]
 * says which. */
#include <assert.h>
#include <string.h>

#include "linear/pcg_space.h"
#include "linear/vectors.h"

typedef struct columns {
  const bwi_pcg_fields *f;
  size_t n;
  int count;
  int side[BWI_PCG_COLUMNS];
  const double *b;
  double *x, *r, *z, *p, *q;
  bool zero; /* x is */
} columns;

static bw_status residual(bw_context *context, void *data, const bool *wanted, double *r_dot_r) {
  bw_status status = BW_OK;
  columns *c = data;
  size_t n = c->n;
  for (int k = 0; k < c->count; k++) {
    if (!wanted[k])
      continue;
    double *r = c->r + (size_t)k * n;
    size_t at = (size_t)c->side[k] * n;
    if (c->zero)
      memcpy(r, c->b + at, n * sizeof *r);
    else {
      BW_TRY(c->f->multiply(context, c->f->multiply_data, 1, c->x + at, r));
      BW_TRY(bwi_subtract_from(context, n, c->b + at, r, NULL));
    }
    if (c->f->project)
      BW_TRY(c->f->project(context, c->f->project_data, 1, r));
    BW_TRY(bwi_blocked_dot(context, n, r, r, &r_dot_r[k]));
  }
done:
  return status;
}

static bw_status precondition(bw_context *context, void *data, double *r_dot_z, double *z_dot_q) {
  bw_status status = BW_OK;
  const columns *c = data;
  size_t n = c->n;
  BW_TRY(c->f->precondition(context, c->f->precondition_data, c->count, c->r, c->z));
  for (size_t k = 0; k < (size_t)c->count; k++) {
    BW_TRY(bwi_blocked_dot(context, n, c->r + k * n, c->z + k * n, &r_dot_z[k]));
    if (z_dot_q)
      BW_TRY(bwi_blocked_dot(context, n, c->z + k * n, c->q + k * n, &z_dot_q[k]));
  }
done:
  return status;
}

static bw_status multiply(bw_context *context, void *data, const double *beta, double *p_dot_q) {
  bw_status status = BW_OK;
  const columns *c = data;
  size_t n = c->n;
  for (size_t k = 0; k < (size_t)c->count; k++)
    BW_TRY(bwi_add_scaled(context, n, beta[k], c->z + k * n, c->p + k * n));
  BW_TRY(c->f->multiply(context, c->f->multiply_data, c->count, c->p, c->q));
  for (size_t k = 0; k < (size_t)c->count; k++)
    BW_TRY(bwi_blocked_dot(context, n, c->p + k * n, c->q + k * n, &p_dot_q[k]));
done:
  return status;
}

static bw_status advance(bw_context *context, void *data, const double *alpha, double *r_dot_r) {
  bw_status status = BW_OK;
  columns *c = data;
  size_t n = c->n;
  c->zero = false;
  for (size_t k = 0; k < (size_t)c->count; k++)
    BW_TRY(bwi_step(context, n, alpha[k], c->p + k * n, c->q + k * n, c->x + (size_t)c->side[k] * n,
                    c->r + k * n, &r_dot_r[k]));
done:
  return status;
}

static double noise(void *data, int k) {
  const columns *c = data;
  return c->f->noise(c->f->noise_data, c->x + (size_t)c->side[k] * c->n);
}

static void retire(void *data, int k, int last) {
  columns *c = data;
  double *vectors[] = {c->r, c->z, c->p, c->q};
  assert(last == c->count - 1 && k <= last);
  for (int v = 0; v < 4 && k < last; v++)
    memcpy(vectors[v] + (size_t)k * c->n, vectors[v] + (size_t)last * c->n, c->n * sizeof(double));
  c->side[k] = c->side[last];
  c->count = last;
}

bw_status bwi_pcg_fields_run(bw_context *context, const bwi_pcg_fields *f, bwi_pcg_task *task,
                             const double *b, double *x) {
  size_t n = (size_t)f->size, numbers = n * (size_t)task->columns;
  double *work = f->work ? f->work : BW_NEW(context, double, 4 * numbers);
  if (!work)
    return BW_MEMORY;
  columns c = {.f = f,
               .n = n,
               .count = task->columns,
               .b = b,
               .x = x,
               .r = work,
               .z = work + numbers,
               .p = work + 2 * numbers,
               .q = work + 3 * numbers,
               .zero = !f->guess};
  for (int k = 0; k < c.count; k++)
    c.side[k] = k;
  if (c.zero)
    memset(x, 0, numbers * sizeof *x);
  const bwi_pcg_space space = {.data = &c,
                               .residual = residual,
                               .precondition = precondition,
                               .multiply = multiply,
                               .advance = advance,
                               .noise = f->noise ? noise : NULL,
                               .retire = retire,
                               .symmetric = f->symmetric};
  bw_status status = bwi_pcg_run(context, &space, task);
  if (!f->work)
    bw_free(work);
  return status;
}
