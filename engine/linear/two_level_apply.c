/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The two-level preconditioner, and products, on fields of doubles: packed several at a time into
 * the order of its rows, each times a power of two that brings it into the range of floats. */
#include "linear/two_level_apply.h"

#include <float.h>
#include <math.h>

enum { SIDES = BWI_SMOOTHER_SIDES, ROWS = BWI_SMOOTHER_ROWS };

void bwi_two_level_workspace_clear(bwi_two_level_workspace *w) {
  bw_free(w->z);
  bw_free(w->residual);
  bw_free(w->floats);
  bw_free(w->corner);
  *w = (bwi_two_level_workspace){0};
}

bw_status bwi_two_level_workspace_open(bw_context *context, const bwi_two_level *l,
                                       bwi_two_level_workspace *w) {
  size_t numbers = 3 * (size_t)l->smoother->count * SIDES + BWI_SMOOTHER_SPARE;
  *w = (bwi_two_level_workspace){0};
  w->z = BW_NEW0(context, float, numbers);
  w->residual = BW_NEW0(context, float, numbers);
  w->floats = BW_NEW0(context, float, numbers);
  w->corner = BW_NEW(context, double, 3 * (size_t)bwi_coarse_corners(l->coarse) * SIDES);
  return w->z && w->residual && w->floats && w->corner ? BW_OK : BW_MEMORY;
}

typedef struct packing {
  const bwi_two_level *l;
  int width, used;
  int64_t size; /* of a field */
  const double *f;
  double *z;
  double unit[SIDES];
} packing;

static bw_status pack(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *p = data;
  const bwi_smoother *s = p->l->smoother;
  for (int64_t k = begin; k < end; k++)
    for (int d = 0; d < 3; d++)
      for (int i = 0; i < p->width; i++)
        p->l->floats[(3 * k + d) * p->width + i] =
            i < p->used ? (float)(p->unit[i] * p->f[i * p->size + 3 * (int64_t)s->node[k] + d]) : 0;
  return BW_OK;
}

static bw_status unpack(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const packing *p = data;
  const bwi_smoother *s = p->l->smoother;
  for (int64_t k = begin; k < end; k++)
    for (int d = 0; d < 3; d++)
      for (int i = 0; i < p->used; i++)
        p->z[i * p->size + 3 * (int64_t)s->node[k] + d] =
            (double)p->l->z[(3 * k + d) * p->width + i] * (s->unit / p->unit[i]);
  return BW_OK;
}

/* The power of two that brings the largest entry between 1/2 and 1. */
static double unit_of(const double *f, int64_t size) {
  double largest = 0;
  int exponent = 0;
  for (int64_t i = 0; i < size; i++)
    largest = fmax(largest, fabs(f[i]));
  frexp(largest, &exponent);
  return ldexp(1, -exponent);
}

bw_status bwi_two_level_apply(bw_context *context, bwi_two_level *l,
                              const bwi_two_level_workspace *w, int64_t count, const double *f,
                              double *z) {
  bw_status status = BW_OK;
  int64_t size = 3 * (int64_t)l->smoother->pattern->node_count;
  const bwi_two_level_workspace own = {l->z, l->residual, l->floats, l->corner};
  l->z = w->z;
  l->residual = w->residual;
  l->floats = w->floats;
  l->corner = w->corner;
  for (int64_t first = 0; first < count; first += SIDES) {
    packing p = {.l = l,
                 .width = bwi_smoother_width(count - first),
                 .used = (int)(count - first < SIDES ? count - first : SIDES),
                 .size = size,
                 .f = f + first * size,
                 .z = z + first * size};
    for (int i = 0; i < p.used; i++)
      p.unit[i] = unit_of(p.f + i * size, size);
    BW_TRY(bw_check_cancel(context));
    BW_TRY(bw_parallel(context, l->smoother->count, ROWS, pack, &p));
    BW_TRY(bwi_two_level_precondition(context, l, p.width, p.used));
    BW_TRY(bw_parallel(context, l->smoother->count, ROWS, unpack, &p));
  }
done:
  l->z = own.z;
  l->residual = own.residual;
  l->floats = own.floats;
  l->corner = own.corner;
  return status;
}

/* ---- products ------------------------------------------------------------------------------ */

typedef struct product {
  const bwi_smoother *s;
  int width, used;
  int64_t size;
  const double *x;
  double *y, *packed, *result;
} product;

static bw_status pack_doubles(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const product *p = data;
  for (int64_t k = begin; k < end; k++)
    for (int d = 0; d < 3; d++)
      for (int i = 0; i < p->width; i++)
        p->packed[(3 * k + d) * p->width + i] =
            i < p->used ? p->x[i * p->size + 3 * (int64_t)p->s->node[k] + d] : 0;
  return BW_OK;
}

static bw_status unpack_doubles(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const product *p = data;
  for (int64_t k = begin; k < end; k++)
    for (int d = 0; d < 3; d++)
      for (int i = 0; i < p->used; i++)
        p->y[i * p->size + 3 * (int64_t)p->s->node[k] + d] =
            p->result[(3 * k + d) * p->width + i] / p->s->unit;
  return BW_OK;
}

bw_status bwi_two_level_multiply(bw_context *context, const bwi_two_level *l, int64_t count,
                                 const double *x, double *y) {
  bw_status status = BW_OK;
  const bwi_smoother *s = l->smoother;
  int64_t size = 3 * (int64_t)s->count, numbers = size * bwi_smoother_width(count);
  double *work = BW_NEW(context, double, 2 * numbers + 2 * BWI_SMOOTHER_SPARE);
  if (!work)
    return BW_MEMORY;
  for (int64_t first = 0; first < count; first += SIDES) {
    product p = {.s = s,
                 .width = bwi_smoother_width(count - first),
                 .used = (int)(count - first < SIDES ? count - first : SIDES),
                 .size = size,
                 .x = x + first * size,
                 .y = y + first * size,
                 .packed = work,
                 .result = work + numbers + BWI_SMOOTHER_SPARE};
    BW_TRY(bw_parallel(context, s->count, ROWS, pack_doubles, &p));
    BW_TRY(bwi_smoother_product(context, s, p.width, p.packed, p.result, NULL));
    BW_TRY(bw_parallel(context, s->count, ROWS, unpack_doubles, &p));
  }
done:
  bw_free(work);
  return status;
}

double bwi_two_level_noise(const bwi_two_level *l, const double *u) {
  static const int six[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  double sum = 0;
  for (int64_t k = 0; k < l->smoother->count; k++) {
    const double *a = l->smoother->diagonal + 6 * k, *v = u + 3 * (int64_t)l->smoother->node[k];
    for (int d = 0; d < 3; d++) {
      double term = 0;
      for (int c = 0; c < 3; c++)
        term += fabs(a[six[c][d]] * v[c]);
      sum += term * term;
    }
  }
  return BWI_RESIDUAL_NOISE * DBL_EPSILON * sqrt(sum) / l->smoother->unit;
}
