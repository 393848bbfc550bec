/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Triangular solves in single precision (triangular_solve.h).
 *
 * A supernode is stored as its triangle, column by column with the diagonal inverted, and then the
 * rows below, a column-major matrix with rows filled up to a multiple of WIDE by zeros. Vectors go
 * in elimination order, so that a supernode's own part is contiguous; the part below is gathered
 * into a block, and scattered from it, node by node. The factor is divided by its largest diagonal
 * entry and right-hand sides by their largest number, so that no unit of measure overflows. */
#include "incremental/triangular_solve.h"

#include <math.h>
#include <string.h>

enum { WIDE = 8 };
typedef float wide __attribute__((vector_size(4 * WIDE), aligned(4), may_alias));
typedef float quad __attribute__((vector_size(16), aligned(4), may_alias));

struct bwi_triangular_solve {
  const bwi_symbolic *symbolic; /* retained */
  float *entry;
  int64_t *start; /* super_count + 1 */
  float *x, *below;
  double scale; /* of the factor, squared */
};

static int64_t padded(int64_t rows) {
  return (rows + WIDE - 1) / WIDE * WIDE;
}

void bwi_triangular_solve_destroy(bwi_triangular_solve *solve) {
  if (!solve)
    return;
  bw_release(solve->symbolic);
  bw_free(solve->entry);
  bw_free(solve->start);
  bw_free(solve->x);
  bw_free(solve->below);
  bw_free(solve);
}

typedef struct copy {
  const bwi_factor *factor;
  bwi_triangular_solve *solve;
  double scale;
} copy;

static bw_status copy_supernodes(void *data, int64_t begin, int64_t end, int worker) {
  const copy *c = data;
  const bwi_symbolic *symbolic = c->factor->symbolic;
  (void)worker;
  for (int64_t s = begin; s < end; s++) {
    int32_t n = bwi_pivots(symbolic, (int32_t)s), rows = symbolic->rows[s], m = rows - n;
    const double *value = c->factor->value, *panel = value + symbolic->panel[s];
    float *to = c->solve->entry + c->solve->start[s];
    for (int32_t j = 0; j < n; j++) {
      const double *column = panel + (int64_t)j * rows;
      *to++ = (float)(1 / (c->scale * column[j]));
      for (int32_t i = j + 1; i < n; i++)
        *to++ = (float)(c->scale * column[i]);
    }
    int64_t ld = padded(m);
    for (int32_t j = 0; j < n; j++, to += ld) {
      const double *column = panel + (int64_t)j * rows + n;
      for (int32_t i = 0; i < m; i++)
        to[i] = (float)(c->scale * column[i]);
      for (int64_t i = m; i < ld; i++)
        to[i] = 0;
    }
  }
  return BW_OK;
}

bw_status bwi_triangular_solve_create(bw_context *context, const bwi_factor *factor,
                                      bwi_triangular_solve **out) {
  bw_status status = BW_OK;
  const bwi_symbolic *symbolic = factor->symbolic;
  int32_t supers = symbolic->order->super_count;
  int64_t max = 0;
  double largest = 0;
  const double *value = factor->value;
  bwi_triangular_solve *solve = BW_NEW0(context, bwi_triangular_solve, 1);
  if (!solve)
    return BW_MEMORY;
  solve->symbolic = bw_retain(symbolic);
  solve->start = BW_NEW(context, int64_t, (size_t)supers + 1);
  BW_TRY_MEMORY(solve->start);
  solve->start[0] = 0;
  for (int32_t s = 0; s < supers; s++) {
    int64_t n = bwi_pivots(symbolic, s), rows = symbolic->rows[s], below = padded(rows - n);
    solve->start[s + 1] = solve->start[s] + n * (n + 1) / 2 + n * below;
    max = below > max ? below : max;
    for (int64_t j = 0; j < n; j++)
      largest = fmax(largest, value[symbolic->panel[s] + j * rows + j]);
  }
  solve->entry = BW_NEW(context, float, solve->start[supers]);
  solve->x = BW_NEW(context, float, symbolic->unknowns);
  solve->below = BW_NEW0(context, float, max);
  BW_TRY_MEMORY(solve->entry && solve->x && solve->below);
  copy c = {factor, solve, largest > 0 ? 1 / largest : 1};
  solve->scale = c.scale * c.scale;
  BW_TRY(bw_parallel(context, supers, 1024, copy_supernodes, &c));
done:
  if (status == BW_OK)
    *out = solve;
  else
    bwi_triangular_solve_destroy(solve);
  return status;
}

/* ---- one supernode ------------------------------------------------------------------------- */

static void forward(const float *entry, int32_t n, int64_t ld, float *x, float *y) {
  for (int32_t j = 0; j < n; j++) {
    float v = x[j] *= *entry++;
    for (int32_t i = j + 1; i < n; i++)
      x[i] -= v * *entry++;
  }
  int32_t j = 0;
  for (; j + 4 <= n; j += 4, entry += 4 * ld) {
    float x0 = x[j], x1 = x[j + 1], x2 = x[j + 2], x3 = x[j + 3];
    for (int64_t i = 0; i < ld; i += WIDE) {
      const float *l = entry + i;
      wide sum = *(wide *)(y + i);
      sum += *(const wide *)l * x0 + *(const wide *)(l + ld) * x1;
      sum += *(const wide *)(l + 2 * ld) * x2 + *(const wide *)(l + 3 * ld) * x3;
      *(wide *)(y + i) = sum;
    }
  }
  for (; j < n; j++, entry += ld)
    for (int64_t i = 0; i < ld; i += WIDE)
      *(wide *)(y + i) += *(const wide *)(entry + i) * x[j];
}

static float total(const wide *sum) {
  wide v = *sum;
  return ((v[0] + v[4]) + (v[1] + v[5])) + ((v[2] + v[6]) + (v[3] + v[7]));
}

static void backward(const float *entry, int32_t n, int64_t ld, float *x, const float *y) {
  const float *triangle = entry + (int64_t)n * (n + 1) / 2;
  const float *l = triangle;
  int32_t j = 0;
  for (; j + 4 <= n; j += 4, l += 4 * ld) {
    wide s0 = {0}, s1 = {0}, s2 = {0}, s3 = {0};
    for (int64_t i = 0; i < ld; i += WIDE) {
      wide v = *(const wide *)(y + i);
      s0 += *(const wide *)(l + i) * v;
      s1 += *(const wide *)(l + ld + i) * v;
      s2 += *(const wide *)(l + 2 * ld + i) * v;
      s3 += *(const wide *)(l + 3 * ld + i) * v;
    }
    x[j] -= total(&s0);
    x[j + 1] -= total(&s1);
    x[j + 2] -= total(&s2);
    x[j + 3] -= total(&s3);
  }
  for (; j < n; j++, l += ld) {
    wide s = {0};
    for (int64_t i = 0; i < ld; i += WIDE)
      s += *(const wide *)(l + i) * *(const wide *)(y + i);
    x[j] -= total(&s);
  }
  for (j = n - 1; j >= 0; j--) {
    triangle -= n - j;
    quad sums = {0}; /* one sum alone would wait for each product */
    float sum = x[j];
    int32_t i = j + 1;
    for (; i + 4 <= n; i += 4)
      sums += *(const quad *)(triangle + i - j) * *(const quad *)(x + i);
    for (; i < n; i++)
      sum -= triangle[i - j] * x[i];
    x[j] = (sum - ((sums[0] + sums[2]) + (sums[1] + sums[3]))) * triangle[0];
  }
}

/* ---- both solves --------------------------------------------------------------------------- */

static inline __attribute__((always_inline)) void forward_backward(bwi_triangular_solve *solve,
                                                                   int C) {
  const bwi_order *order = solve->symbolic->order;
  float *x = solve->x, *y = solve->below;
  for (int32_t s = 0; s < order->super_count; s++) {
    int32_t first = order->super[s], nodes = order->super[s + 1] - first;
    const int32_t *row = order->row + order->row_start[s] + nodes;
    int64_t below = order->row_start[s + 1] - order->row_start[s] - nodes, ld = padded(below * C);
    memset(y, 0, (size_t)ld * sizeof *y);
    forward(solve->entry + solve->start[s], nodes * C, ld, x + (int64_t)first * C, y);
    for (int64_t k = 0; k < below; k++)
      for (int c = 0; c < C; c++)
        x[(int64_t)row[k] * C + c] -= y[k * C + c];
  }
  for (int32_t s = order->super_count - 1; s >= 0; s--) {
    int32_t first = order->super[s], nodes = order->super[s + 1] - first;
    const int32_t *row = order->row + order->row_start[s] + nodes;
    int64_t below = order->row_start[s + 1] - order->row_start[s] - nodes, ld = padded(below * C);
    for (int64_t k = 0; k < below; k++)
      for (int c = 0; c < C; c++)
        y[k * C + c] = x[(int64_t)row[k] * C + c];
    for (int64_t k = below * C; k < ld; k++)
      y[k] = 0;
    backward(solve->entry + solve->start[s], nodes * C, ld, x + (int64_t)first * C, y);
  }
}

void bwi_triangular_solve_apply(bwi_triangular_solve *solve, const double *r, double *z) {
  const bwi_order *order = solve->symbolic->order;
  int C = solve->symbolic->components;
  int64_t size = solve->symbolic->unknowns;
  double largest = 0;
  for (int64_t i = 0; i < size; i++)
    largest = fmax(largest, fabs(r[i]));
  double scale = largest > 0 ? 1 / largest : 0, back = largest * solve->scale;
  for (int32_t p = 0; p < order->size; p++)
    for (int c = 0; c < C; c++)
      solve->x[(int64_t)p * C + c] = (float)(scale * r[(int64_t)order->node_at[p] * C + c]);
  switch (C) {
  case 1:
    forward_backward(solve, 1);
    break;
  case 2:
    forward_backward(solve, 2);
    break;
  default:
    forward_backward(solve, 3);
  }
  for (int32_t p = 0; p < order->size; p++)
    for (int c = 0; c < C; c++)
      z[(int64_t)order->node_at[p] * C + c] = back * (double)solve->x[(int64_t)p * C + c];
}
