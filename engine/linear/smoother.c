/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sweeps over the rows of a stiffness, and products with it (smoother.h). Chunks go side by side,
 * the rows between them one after the other: no two rows that meet are ever worked on at once. */
#include "linear/smoother.h"

#include <string.h>

enum { SIDES = BWI_SMOOTHER_SIDES };

/* Three numbers of a node, and one that is ignored. */
typedef float quad __attribute__((vector_size(16), aligned(4), may_alias));
typedef double quad2 __attribute__((vector_size(32), aligned(8), may_alias));
/* One number of each of eight fields. */
typedef float eight __attribute__((vector_size(32), aligned(4), may_alias));
typedef double eight2 __attribute__((vector_size(64), aligned(8), may_alias));

/* What works on single fields and on eight side by side is one text, compiled for floats and for
 * doubles: `three` are the numbers of a node in one register, `all` those of eight fields. */
#define BLOCKS(suffix, real, three, all)                                                           \
  static inline void columns_of_six##suffix(const real *a, three column[3]) {                      \
    three low = *(const three *)a, high = *(const three *)(a + 2);                                 \
    column[0] = low;                                                                               \
    column[1] = __builtin_shufflevector(low, high, 1, 3, 6, 7);                                    \
    column[2] = __builtin_shufflevector(low, high, 2, 6, 7, 7);                                    \
  }                                                                                                \
  static inline void columns_of_nine##suffix(const real *a, three column[3]) {                     \
    for (int c = 0; c < 3; c++)                                                                    \
      column[c] = *(const three *)(a + 3 * c);                                                     \
  }                                                                                                \
  /* A x */                                                                                        \
  static inline three times##suffix(const three column[3], const real *x) {                        \
    return column[0] * x[0] + column[1] * x[1] + column[2] * x[2];                                 \
  }                                                                                                \
  /* A^T x */                                                                                      \
  static inline void across##suffix(const three column[3], three x, real y[3]) {                   \
    for (int c = 0; c < 3; c++) {                                                                  \
      three product = column[c] * x;                                                               \
      y[c] = product[0] + product[1] + product[2];                                                 \
    }                                                                                              \
  }                                                                                                \
  static inline void six_times##suffix(const real *a, const all *x, all y[3]) {                    \
    y[0] = a[0] * x[0] + a[1] * x[1] + a[2] * x[2];                                                \
    y[1] = a[1] * x[0] + a[3] * x[1] + a[4] * x[2];                                                \
    y[2] = a[2] * x[0] + a[4] * x[1] + a[5] * x[2];                                                \
  }                                                                                                \
  static inline void nine_times##suffix(const real *a, const all *x, all y[3]) {                   \
    for (int d = 0; d < 3; d++)                                                                    \
      y[d] = a[d] * x[0] + a[3 + d] * x[1] + a[6 + d] * x[2];                                      \
  }                                                                                                \
  static inline void nine_across##suffix(const real *a, const all *x, all y[3]) {                  \
    for (int d = 0; d < 3; d++)                                                                    \
      y[d] = a[3 * d] * x[0] + a[3 * d + 1] * x[1] + a[3 * d + 2] * x[2];                          \
  }                                                                                                \
  /* sum + the entries of row k times x */                                                         \
  static inline three row_times##suffix(const bwi_smoother_part *even, const real *six,            \
                                        const bwi_smoother_part *odd, const real *nine, int64_t k, \
                                        const real *x, three sum) {                                \
    three column[3];                                                                               \
    for (int64_t e = even->start[k]; e < even->start[k + 1]; e++) {                                \
      columns_of_six##suffix(six + 6 * e, column);                                                 \
      sum += times##suffix(column, x + 3 * (int64_t)even->column[e]);                              \
    }                                                                                              \
    for (int64_t e = odd->start[k]; e < odd->start[k + 1]; e++) {                                  \
      columns_of_nine##suffix(nine + 9 * e, column);                                               \
      sum += times##suffix(column, x + 3 * (int64_t)odd->column[e]);                               \
    }                                                                                              \
    return sum;                                                                                    \
  }                                                                                                \
  /* y of the columns of row k += their entries, transposed, times x */                            \
  static inline void row_across##suffix(const bwi_smoother_part *even, const real *six,            \
                                        const bwi_smoother_part *odd, const real *nine, int64_t k, \
                                        three x, real *y) {                                        \
    three column[3];                                                                               \
    real own[4] = {x[0], x[1], x[2], 0}, add[3];                                                   \
    for (int64_t e = even->start[k]; e < even->start[k + 1]; e++) {                                \
      real *to = y + 3 * (int64_t)even->column[e];                                                 \
      columns_of_six##suffix(six + 6 * e, column);                                                 \
      three product = times##suffix(column, own);                                                  \
      for (int d = 0; d < 3; d++)                                                                  \
        to[d] += product[d];                                                                       \
    }                                                                                              \
    for (int64_t e = odd->start[k]; e < odd->start[k + 1]; e++) {                                  \
      real *to = y + 3 * (int64_t)odd->column[e];                                                  \
      columns_of_nine##suffix(nine + 9 * e, column);                                               \
      across##suffix(column, x, add);                                                              \
      for (int d = 0; d < 3; d++)                                                                  \
        to[d] += add[d];                                                                           \
    }                                                                                              \
  }                                                                                                \
  static inline void rows_times##suffix(const bwi_smoother_part *even, const real *six,            \
                                        const bwi_smoother_part *odd, const real *nine, int64_t k, \
                                        const all *x, all sum[3]) {                                \
    all add[3];                                                                                    \
    for (int64_t e = even->start[k]; e < even->start[k + 1]; e++) {                                \
      six_times##suffix(six + 6 * e, x + 3 * (int64_t)even->column[e], add);                       \
      for (int d = 0; d < 3; d++)                                                                  \
        sum[d] += add[d];                                                                          \
    }                                                                                              \
    for (int64_t e = odd->start[k]; e < odd->start[k + 1]; e++) {                                  \
      nine_times##suffix(nine + 9 * e, x + 3 * (int64_t)odd->column[e], add);                      \
      for (int d = 0; d < 3; d++)                                                                  \
        sum[d] += add[d];                                                                          \
    }                                                                                              \
  }                                                                                                \
  static inline void rows_across##suffix(const bwi_smoother_part *even, const real *six,           \
                                         const bwi_smoother_part *odd, const real *nine,           \
                                         int64_t k, const all x[3], all *y) {                      \
    all add[3];                                                                                    \
    for (int64_t e = even->start[k]; e < even->start[k + 1]; e++) {                                \
      six_times##suffix(six + 6 * e, x, add);                                                      \
      for (int d = 0; d < 3; d++)                                                                  \
        y[3 * (int64_t)even->column[e] + d] += add[d];                                             \
    }                                                                                              \
    for (int64_t e = odd->start[k]; e < odd->start[k + 1]; e++) {                                  \
      nine_across##suffix(nine + 9 * e, x, add);                                                   \
      for (int d = 0; d < 3; d++)                                                                  \
        y[3 * (int64_t)odd->column[e] + d] += add[d];                                              \
    }                                                                                              \
  }

BLOCKS(_f, float, quad, eight)
BLOCKS(_d, double, quad2, eight2)

#define FLOATS(s) &(s)->even, (s)->even.value, &(s)->odd, (s)->odd.value
#define DOUBLES(s) &(s)->even, (s)->even.exact, &(s)->odd, (s)->odd.exact

/* ---- sweeps -------------------------------------------------------------------------------- */

typedef struct sweep {
  const bwi_smoother *s;
  int width;
  const float *r;
  float *z, *residual;
} sweep;

/* z of row k so that its equation holds, the rows before it as they are; `residual` of these then
 * loses what it does to them. Backwards, `residual` of the row is what rows behind it did. */
static inline void satisfy(const sweep *w, int64_t k, bool backwards) {
  const bwi_smoother *s = w->s;
  const float *a = s->inverse + 9 * k;
  if (w->width == 1) {
    const float *r = w->r + 3 * k;
    float *z = w->z + 3 * k, *residual = w->residual + 3 * k;
    quad sum = row_times_f(FLOATS(s), k, w->z, (quad){0, 0, 0, 0});
    for (int d = 0; d < 3; d++) {
      sum[d] = r[d] - sum[d] - (backwards ? residual[d] : 0);
      residual[d] = 0;
    }
    sum = *(const quad *)a * sum[0] + *(const quad *)(a + 3) * sum[1] +
          *(const quad *)(a + 6) * sum[2];
    for (int d = 0; d < 3; d++)
      z[d] = sum[d];
    row_across_f(FLOATS(s), k, sum, w->residual);
  } else {
    const eight *r = (const eight *)w->r + 3 * k;
    eight *z = (eight *)w->z + 3 * k, *residual = (eight *)w->residual + 3 * k, sum[3];
    memset(sum, 0, sizeof sum);
    rows_times_f(FLOATS(s), k, (const eight *)w->z, sum);
    for (int d = 0; d < 3; d++) {
      sum[d] = backwards ? r[d] - sum[d] - residual[d] : r[d] - sum[d];
      residual[d] = (eight){0};
    }
    eight own[3];
    for (int d = 0; d < 3; d++)
      z[d] = own[d] = a[d] * sum[0] + a[3 + d] * sum[1] + a[6 + d] * sum[2];
    rows_across_f(FLOATS(s), k, own, (eight *)w->residual);
  }
}

static bw_status chunk_forward(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const sweep *w = data;
  for (int64_t k = w->s->chunk_start[begin]; k < w->s->chunk_start[end]; k++)
    satisfy(w, k, false);
  return BW_OK;
}

static bw_status chunk_backward(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const sweep *w = data;
  for (int64_t k = w->s->chunk_start[end] - 1; k >= w->s->chunk_start[begin]; k--)
    satisfy(w, k, true);
  return BW_OK;
}

/* residual = - residual */
static bw_status leave(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const sweep *w = data;
  for (int64_t i = 3 * begin * w->width; i < 3 * end * w->width; i++)
    w->residual[i] = -w->residual[i];
  return BW_OK;
}

bw_status bwi_smoother_forward(bw_context *context, const bwi_smoother *s, int width,
                               const float *r, float *z, float *residual) {
  bw_status status = BW_OK;
  sweep w = {s, width, r, z, residual};
  BW_TRY(bw_parallel(context, s->chunk_count, 1, chunk_forward, &w));
  for (int64_t k = s->chunk_start[s->chunk_count]; k < s->count; k++)
    satisfy(&w, k, false);
  BW_TRY(bw_parallel(context, s->count, BWI_SMOOTHER_ROWS, leave, &w));
done:
  return status;
}

bw_status bwi_smoother_backward(bw_context *context, const bwi_smoother *s, int width,
                                const float *r, float *z, float *work) {
  sweep w = {s, width, r, z, work};
  memset(work, 0, 3 * (size_t)s->count * (size_t)width * sizeof *work);
  for (int64_t k = s->count - 1; k >= s->chunk_start[s->chunk_count]; k--)
    satisfy(&w, k, true);
  return bw_parallel(context, s->chunk_count, 1, chunk_backward, &w);
}

/* ---- products ------------------------------------------------------------------------------ */

typedef struct product {
  const bwi_smoother *s;
  int width;
  const double *x;
  double *y;
} product;

/* y of row k, to which only rows behind it have still to add, and what it adds to those before. */
static inline void multiply(const product *m, int64_t k) {
  const bwi_smoother *s = m->s;
  const double *a = s->diagonal + 9 * k;
  if (m->width == 1) {
    const double *x = m->x + 3 * k;
    quad2 column[3], own = {x[0], x[1], x[2], 0};
    columns_of_nine_d(a, column);
    quad2 sum = row_times_d(DOUBLES(s), k, m->x, times_d(column, x));
    for (int d = 0; d < 3; d++)
      m->y[3 * k + d] = sum[d];
    row_across_d(DOUBLES(s), k, own, m->y);
  } else {
    const eight2 *x = (const eight2 *)m->x + 3 * k;
    eight2 *y = (eight2 *)m->y + 3 * k, own[3] = {x[0], x[1], x[2]}, sum[3];
    nine_times_d(a, own, sum);
    rows_times_d(DOUBLES(s), k, (const eight2 *)m->x, sum);
    for (int d = 0; d < 3; d++)
      y[d] = sum[d];
    rows_across_d(DOUBLES(s), k, own, (eight2 *)m->y);
  }
}

static bw_status chunk_product(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const product *m = data;
  for (int64_t k = m->s->chunk_start[begin]; k < m->s->chunk_start[end]; k++)
    multiply(m, k);
  return BW_OK;
}

bw_status bwi_smoother_product(bw_context *context, const bwi_smoother *s, int width,
                               const double *x, double *y) {
  bw_status status = BW_OK;
  product m = {s, width, x, y};
  BW_TRY(bw_parallel(context, s->chunk_count, 1, chunk_product, &m));
  for (int64_t k = s->chunk_start[s->chunk_count]; k < s->count; k++)
    multiply(&m, k);
done:
  return status;
}

double bwi_smoother_bytes(int64_t blocks) {
  return (double)blocks *
         (2 * 32 + 60); /* two sweeps and a product: about seven numbers, a column */
}
