/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Sweeps over the rows of a stiffness, and products with it (smoother.h). Chunks go side by side,
 * the rows between them one after the other: no two rows that meet are ever worked on at once. */
#include "linear/element_product.h"

#include <string.h>

/* Vectors wider than the machine's registers are passed within this file alone. */
#pragma GCC diagnostic ignored "-Wpsabi"

/* Three numbers of a node, and one that is ignored. */
typedef float quad __attribute__((vector_size(16), aligned(4), may_alias));
typedef double quad2 __attribute__((vector_size(32), aligned(8), may_alias));
/* One number of each of four fields, or of eight. */
typedef float four __attribute__((vector_size(16), aligned(4), may_alias));
typedef double four2 __attribute__((vector_size(32), aligned(8), may_alias));
typedef float eight __attribute__((vector_size(32), aligned(4), may_alias));
typedef double eight2 __attribute__((vector_size(64), aligned(8), may_alias));
/* One number of each of twelve fields, and four that are ignored. */
typedef float twelve __attribute__((vector_size(64), aligned(4), may_alias));
/* The lower halves of four doubles, alone and in their place. */
typedef uint32_t halves __attribute__((vector_size(16), aligned(4), may_alias));
typedef uint64_t placed __attribute__((vector_size(32), aligned(8), may_alias));

static inline quad2 whole_four(const float *value, const uint32_t *rest) {
  return (quad2)((placed) __builtin_convertvector(*(const quad *)value, quad2) |
                 __builtin_convertvector(*(const halves *)rest, placed));
}

/* What works on single fields is one text, compiled for floats and for doubles: `three` are the
 * numbers of a node in one register. */
#define ONE(suffix, real, three)                                                                   \
  static inline void columns_of_six##suffix(three low, three high, three column[3]) {              \
    column[0] = low;                                                                               \
    column[1] = __builtin_shufflevector(low, high, 1, 3, 6, 7);                                    \
    column[2] = __builtin_shufflevector(low, high, 2, 6, 7, 7);                                    \
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
  }

#define MEMORY(suffix, real, all)                                                                  \
  static inline all at##suffix(const real *x) {                                                    \
    return *(const all *)x;                                                                        \
  }                                                                                                \
  static inline void put##suffix(real *x, all value) {                                             \
    *(all *)x = value;                                                                             \
  }                                                                                                \
  static inline void add##suffix(real *x, int64_t stride, const all value[3]) {                    \
    for (int d = 0; d < 3; d++)                                                                    \
      *(all *)(x + d * stride) += value[d];                                                        \
  }
MEMORY(_f4, float, four)
MEMORY(_f8, float, eight)
MEMORY(_d4, double, four2)
MEMORY(_d8, double, eight2)

/* Eight and four: what is loaded has to have been stored at once, or the load waits for the cache.
 */
static inline eight first_eight(twelve x) {
  return __builtin_shufflevector(x, x, 0, 1, 2, 3, 4, 5, 6, 7);
}

static inline four last_four(twelve x) {
  return __builtin_shufflevector(x, x, 8, 9, 10, 11);
}

static inline twelve at_f12(const float *x) {
  four last = *(const four *)(x + 8);
  eight wide = __builtin_shufflevector(last, last, 0, 1, 2, 3, 0, 1, 2, 3);
  return __builtin_shufflevector(*(const eight *)x, wide, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12,
                                 13, 14, 15);
}

static inline void put_f12(float *x, twelve value) {
  *(eight *)x = first_eight(value);
  *(four *)(x + 8) = last_four(value);
}

static inline void add_f12(float *x, int64_t stride, const twelve value[3]) {
  for (int d = 0; d < 3; d++) {
    *(eight *)(x + d * stride) += first_eight(value[d]);
    *(four *)(x + d * stride + 8) += last_four(value[d]);
  }
}

/* What works on fields side by side: `all` are the numbers of four or of eight of them, and
 * `stride` all the numbers between one component of a node and the next. */
#define WIDE(suffix, real, all)                                                                    \
  static inline void take##suffix(const real *x, int64_t stride, all value[3]) {                   \
    for (int d = 0; d < 3; d++)                                                                    \
      value[d] = at##suffix(x + d * stride);                                                       \
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
  }

ONE(_f, float, quad)
ONE(_d, double, quad2)
WIDE(_f4, float, four)
WIDE(_f8, float, eight)
WIDE(_f12, float, twelve)
WIDE(_d4, double, four2)
WIDE(_d8, double, eight2)

/* ---- rows ---------------------------------------------------------------------------------- */

static inline void columns_of_nine(const float *a, quad column[3]) {
  for (int c = 0; c < 3; c++)
    column[c] = *(const quad *)(a + 3 * c);
}

/* sum + the entries of row k outside its own block times z */
static inline quad row_times(const bwi_smoother *s, int64_t k, const float *z, quad sum) {
  const bwi_smoother_part *even = &s->even, *odd = &s->odd;
  quad column[3];
  for (int64_t e = even->start[k]; e < even->outside[k]; e++) {
    columns_of_six_f(*(const quad *)(even->value + 6 * e), *(const quad *)(even->value + 6 * e + 2),
                     column);
    sum += times_f(column, z + 3 * (int64_t)even->column[e]);
  }
  for (int64_t e = odd->start[k]; e < odd->outside[k]; e++) {
    columns_of_nine(odd->value + 9 * e, column);
    sum += times_f(column, z + 3 * (int64_t)odd->column[e]);
  }
  return sum;
}

/* y of the columns of row k += these entries, transposed, times x */
static inline void row_across(const bwi_smoother *s, int64_t k, quad x, float *y) {
  const bwi_smoother_part *even = &s->even, *odd = &s->odd;
  quad column[3];
  float own[4] = {x[0], x[1], x[2], 0}, add[3];
  for (int64_t e = even->start[k]; e < even->outside[k]; e++) {
    float *to = y + 3 * (int64_t)even->column[e];
    columns_of_six_f(*(const quad *)(even->value + 6 * e), *(const quad *)(even->value + 6 * e + 2),
                     column);
    quad product = times_f(column, own);
    for (int d = 0; d < 3; d++)
      to[d] += product[d];
  }
  for (int64_t e = odd->start[k]; e < odd->outside[k]; e++) {
    float *to = y + 3 * (int64_t)odd->column[e];
    columns_of_nine(odd->value + 9 * e, column);
    across_f(column, x, add);
    for (int d = 0; d < 3; d++)
      to[d] += add[d];
  }
}

/* The same for fields side by side. */
#define ROWS_OF(suffix, all)                                                                       \
  static inline void rows_times##suffix(const bwi_smoother *s, int64_t k, int64_t stride,          \
                                        const float *z, all sum[3]) {                              \
    const bwi_smoother_part *even = &s->even, *odd = &s->odd;                                      \
    all in[3], add[3];                                                                             \
    for (int64_t e = even->start[k]; e < even->outside[k]; e++) {                                  \
      take##suffix(z + 3 * stride * even->column[e], stride, in);                                  \
      six_times##suffix(even->value + 6 * e, in, add);                                             \
      for (int d = 0; d < 3; d++)                                                                  \
        sum[d] += add[d];                                                                          \
    }                                                                                              \
    for (int64_t e = odd->start[k]; e < odd->outside[k]; e++) {                                    \
      take##suffix(z + 3 * stride * odd->column[e], stride, in);                                   \
      nine_times##suffix(odd->value + 9 * e, in, add);                                             \
      for (int d = 0; d < 3; d++)                                                                  \
        sum[d] += add[d];                                                                          \
    }                                                                                              \
  }                                                                                                \
  static inline void rows_across##suffix(const bwi_smoother *s, int64_t k, int64_t stride,         \
                                         const all x[3], float *y) {                               \
    const bwi_smoother_part *even = &s->even, *odd = &s->odd;                                      \
    all product[3];                                                                                \
    for (int64_t e = even->start[k]; e < even->outside[k]; e++) {                                  \
      six_times##suffix(even->value + 6 * e, x, product);                                          \
      add##suffix(y + 3 * stride * even->column[e], stride, product);                              \
    }                                                                                              \
    for (int64_t e = odd->start[k]; e < odd->outside[k]; e++) {                                    \
      nine_across##suffix(odd->value + 9 * e, x, product);                                         \
      add##suffix(y + 3 * stride * odd->column[e], stride, product);                               \
    }                                                                                              \
  }
ROWS_OF(_f4, four)
ROWS_OF(_f8, eight)
ROWS_OF(_f12, twelve)

/* ---- sweeps -------------------------------------------------------------------------------- */

typedef struct sweep {
  const bwi_smoother *s;
  int width;
  const float *r;
  float *z, *residual;
} sweep;

/* What rows outside its own block leave of r at row k; backwards, `residual` is what those behind
 * did. It becomes 0. */
static inline quad take_rest(const sweep *w, int64_t k, bool backwards) {
  const bwi_smoother *s = w->s;
  const float *r = w->r + 3 * k;
  float *residual = w->residual + 3 * k;
  quad sum = row_times(s, k, w->z, (quad){0, 0, 0, 0});
  for (int d = 0; d < 3; d++) {
    sum[d] = r[d] - sum[d] - (backwards ? residual[d] : 0);
    residual[d] = 0;
  }
  return sum;
}

/* The same for fields side by side. */
#define TAKE_REST(suffix, all)                                                                     \
  static inline void take_rest##suffix(const sweep *w, int64_t k, bool backwards, all sum[3]) {    \
    const bwi_smoother *s = w->s;                                                                  \
    int64_t stride = w->width;                                                                     \
    const float *r = w->r + 3 * stride * k;                                                        \
    float *residual = w->residual + 3 * stride * k;                                                \
    for (int d = 0; d < 3; d++)                                                                    \
      sum[d] = (all){0};                                                                           \
    rows_times##suffix(s, k, stride, w->z, sum);                                                   \
    for (int d = 0; d < 3; d++) {                                                                  \
      sum[d] = at##suffix(r + d * stride) - sum[d];                                                \
      if (backwards)                                                                               \
        sum[d] -= at##suffix(residual + d * stride);                                               \
      put##suffix(residual + d * stride, (all){0});                                                \
    }                                                                                              \
  }
TAKE_REST(_f4, four)
TAKE_REST(_f8, eight)
TAKE_REST(_f12, twelve)

/* z of row k so that its equation holds, the rows before it as they are; `residual` of these then
 * loses what it does to them. Backwards, what it does is added to `residual`. */
static inline void satisfy_one(const sweep *w, int64_t k, bool backwards) {
  const bwi_smoother *s = w->s;
  const float *a = s->inverse + 9 * k;
  float *z = w->z + 3 * k;
  quad sum = take_rest(w, k, backwards);
  sum =
      *(const quad *)a * sum[0] + *(const quad *)(a + 3) * sum[1] + *(const quad *)(a + 6) * sum[2];
  for (int d = 0; d < 3; d++)
    z[d] = sum[d];
  row_across(s, k, backwards ? sum : -sum, w->residual);
}

/* The same for fields side by side. */
#define SATISFY(suffix, all)                                                                       \
  static inline void satisfy##suffix(const sweep *w, int64_t k, bool backwards) {                  \
    const bwi_smoother *s = w->s;                                                                  \
    int64_t stride = w->width;                                                                     \
    const float *a = s->inverse + 9 * k;                                                           \
    float *z = w->z + 3 * stride * k;                                                              \
    all sum[3], own[3];                                                                            \
    take_rest##suffix(w, k, backwards, sum);                                                       \
    nine_times##suffix(a, sum, own);                                                               \
    for (int d = 0; d < 3; d++) {                                                                  \
      put##suffix(z + d * stride, own[d]);                                                         \
      own[d] = backwards ? own[d] : -own[d];                                                       \
    }                                                                                              \
    rows_across##suffix(s, k, stride, own, w->residual);                                           \
  }
SATISFY(_f4, four)
SATISFY(_f8, eight)
SATISFY(_f12, twelve)

static inline void satisfy(const sweep *w, int64_t k, bool backwards) {
  if (w->width == 1)
    satisfy_one(w, k, backwards);
  else if (w->width == 12)
    satisfy_f12(w, k, backwards);
  else if (w->width == 8)
    satisfy_f8(w, k, backwards);
  else
    satisfy_f4(w, k, backwards);
}

/* The same for the rows of a block together. */
static void satisfy_block_one(const sweep *w, int64_t begin, int64_t end, bool backwards) {
  const bwi_smoother *s = w->s;
  quad column[3];
  for (int64_t k = begin; k < end; k++) {
    quad sum = take_rest(w, k, backwards);
    const float *l = s->factor + 9 * s->factor_start[k];
    for (int64_t j = s->envelope[k]; j < k; j++, l += 9) {
      columns_of_nine(l, column);
      sum -= times_f(column, w->z + 3 * j);
    }
    for (int d = 0; d < 3; d++)
      w->z[3 * k + d] = sum[d];
  }
  for (int64_t k = begin; k < end; k++) {
    columns_of_nine(s->inverse + 9 * k, column);
    quad own = times_f(column, w->z + 3 * k);
    for (int d = 0; d < 3; d++)
      w->z[3 * k + d] = own[d];
  }
  for (int64_t k = end - 1; k >= begin; k--) {
    const float *l = s->factor + 9 * s->factor_start[k];
    quad z = {w->z[3 * k], w->z[3 * k + 1], w->z[3 * k + 2], 0};
    for (int64_t j = s->envelope[k]; j < k; j++, l += 9) {
      float add[3];
      columns_of_nine(l, column);
      across_f(column, z, add);
      for (int d = 0; d < 3; d++)
        w->z[3 * j + d] -= add[d];
    }
    row_across(s, k, backwards ? z : -z, w->residual);
  }
}

/* And for fields side by side. */
#define SATISFY_BLOCK(suffix, all)                                                                 \
  static void satisfy_block##suffix(const sweep *w, int64_t begin, int64_t end, bool backwards) {  \
    const bwi_smoother *s = w->s;                                                                  \
    int64_t stride = w->width;                                                                     \
    float *z = w->z;                                                                               \
    all own[3], in[3], add[3];                                                                     \
    for (int64_t k = begin; k < end; k++) {                                                        \
      take_rest##suffix(w, k, backwards, own);                                                     \
      const float *l = s->factor + 9 * s->factor_start[k];                                         \
      for (int64_t j = s->envelope[k]; j < k; j++, l += 9) {                                       \
        take##suffix(z + 3 * stride * j, stride, in);                                              \
        nine_times##suffix(l, in, add);                                                            \
        for (int d = 0; d < 3; d++)                                                                \
          own[d] -= add[d];                                                                        \
      }                                                                                            \
      for (int d = 0; d < 3; d++)                                                                  \
        put##suffix(z + (3 * k + d) * stride, own[d]);                                             \
    }                                                                                              \
    for (int64_t k = begin; k < end; k++) {                                                        \
      take##suffix(z + 3 * stride * k, stride, own);                                               \
      nine_times##suffix(s->inverse + 9 * k, own, add);                                            \
      for (int d = 0; d < 3; d++)                                                                  \
        put##suffix(z + (3 * k + d) * stride, add[d]);                                             \
    }                                                                                              \
    for (int64_t k = end - 1; k >= begin; k--) {                                                   \
      take##suffix(z + 3 * stride * k, stride, own);                                               \
      const float *l = s->factor + 9 * s->factor_start[k];                                         \
      for (int64_t j = s->envelope[k]; j < k; j++, l += 9) {                                       \
        float *to = z + 3 * stride * j;                                                            \
        nine_across##suffix(l, own, add);                                                          \
        for (int d = 0; d < 3; d++)                                                                \
          put##suffix(to + d * stride, at##suffix(to + d * stride) - add[d]);                      \
      }                                                                                            \
      for (int d = 0; d < 3; d++)                                                                  \
        own[d] = backwards ? own[d] : -own[d];                                                     \
      rows_across##suffix(s, k, stride, own, w->residual);                                         \
    }                                                                                              \
  }
SATISFY_BLOCK(_f4, four)
SATISFY_BLOCK(_f8, eight)
SATISFY_BLOCK(_f12, twelve)

static void satisfy_block(const sweep *w, int64_t block, bool backwards) {
  int64_t begin = w->s->block_start[block], end = w->s->block_start[block + 1];
  if (end == begin + 1)
    satisfy(w, begin, backwards);
  else if (w->width == 1)
    satisfy_block_one(w, begin, end, backwards);
  else if (w->width == 12)
    satisfy_block_f12(w, begin, end, backwards);
  else if (w->width == 8)
    satisfy_block_f8(w, begin, end, backwards);
  else
    satisfy_block_f4(w, begin, end, backwards);
}

/* Rows, or blocks, from one chunk to another. */
static void sweep_chunks(const sweep *w, int64_t from, int64_t to, bool backwards) {
  const bwi_smoother *s = w->s;
  bool blocks = s->block_start != NULL;
  int64_t begin = blocks ? s->chunk_block[from] : s->chunk_start[from];
  int64_t end = to <= s->chunk_count ? blocks ? s->chunk_block[to] : s->chunk_start[to]
                : blocks ? s->block_count
                                     : s->count;
  for (int64_t k = 0; k < end - begin; k++) {
    int64_t at = backwards ? end - 1 - k : begin + k;
    if (blocks)
      satisfy_block(w, at, backwards);
    else
      satisfy(w, at, backwards);
  }
}

static bw_status chunk_forward(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  sweep_chunks(data, begin, end, false);
  return BW_OK;
}

static bw_status chunk_backward(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  sweep_chunks(data, begin, end, true);
  return BW_OK;
}

bw_status bwi_smoother_forward(bw_context *context, const bwi_smoother *s, int width,
                               const float *r, float *z, float *residual) {
  bw_status status = BW_OK;
  sweep w = {s, width, r, z, residual};
  BW_TRY(bw_parallel(context, s->chunk_count, 1, chunk_forward, &w));
  sweep_chunks(&w, s->chunk_count, s->chunk_count + 1, false);
done:
  return status;
}

bw_status bwi_smoother_backward(bw_context *context, const bwi_smoother *s, int width,
                                const float *r, float *z, float *work) {
  sweep w = {s, width, r, z, work};
  memset(work, 0, 3 * (size_t)s->count * (size_t)width * sizeof *work);
  sweep_chunks(&w, s->chunk_count, s->chunk_count + 1, true);
  return bw_parallel(context, s->chunk_count, 1, chunk_backward, &w);
}

/* ---- products ------------------------------------------------------------------------------ */

typedef struct product {
  const bwi_smoother *s;
  int width;
  const double *x;
  double *y, *energy; /* energy: BWI_SMOOTHER_SIDES numbers for each chunk and the rows between */
} product;

/* y of row k, to which only rows behind it have still to add, and what it adds to those before. */
static inline void multiply_one(const product *m, int64_t k, double *energy) {
  const bwi_smoother_part *even = &m->s->even, *odd = &m->s->odd;
  const double *a = m->s->diagonal + 6 * k, *x = m->x + 3 * k;
  double add[3];
  quad2 column[3], own = {x[0], x[1], x[2], 0}, sum = {0};
  columns_of_six_d(*(const quad2 *)a, *(const quad2 *)(a + 2), column);
  quad2 diagonal = times_d(column, x);
  for (int64_t e = even->start[k]; e < even->start[k + 1]; e++) {
    int64_t at = 3 * (int64_t)even->column[e];
    const float *value = even->value + 6 * e;
    const uint32_t *rest = even->rest + 6 * e;
    columns_of_six_d(whole_four(value, rest), whole_four(value + 2, rest + 2), column);
    sum += times_d(column, m->x + at);
    quad2 back = times_d(column, x);
    for (int d = 0; d < 3; d++)
      m->y[at + d] += back[d];
  }
  for (int64_t e = odd->start[k]; e < odd->start[k + 1]; e++) {
    int64_t at = 3 * (int64_t)odd->column[e];
    for (int c = 0; c < 3; c++)
      column[c] = whole_four(odd->value + 9 * e + 3 * c, odd->rest + 9 * e + 3 * c);
    sum += times_d(column, m->x + at);
    across_d(column, own, add);
    for (int d = 0; d < 3; d++)
      m->y[at + d] += add[d];
  }
  for (int d = 0; d < 3; d++) {
    m->y[3 * k + d] = diagonal[d] + sum[d];
    energy[0] += x[d] * (diagonal[d] + 2 * sum[d]);
  }
}

static inline void whole_block(const bwi_smoother_part *part, int numbers, int64_t e, double *a) {
  for (int c = 0; c < numbers; c++)
    a[c] = bwi_smoother_whole(part->value[numbers * e + c], part->rest[numbers * e + c]);
}

/* The same for four or eight fields from `first` on. */
#define MULTIPLY(suffix, all)                                                                      \
  static inline void multiply##suffix(const product *m, int64_t k, int first, double *energy) {    \
    const bwi_smoother_part *even = &m->s->even, *odd = &m->s->odd;                                \
    int64_t stride = m->width;                                                                     \
    double *y = m->y + 3 * stride * k + first, block[9];                                           \
    all own[3], in[3], add[3], diagonal[3], sum[3] = {{0}}, part = at##suffix(energy + first);     \
    take##suffix(m->x + 3 * stride * k + first, stride, own);                                      \
    six_times##suffix(m->s->diagonal + 6 * k, own, diagonal);                                      \
    for (int64_t e = even->start[k]; e < even->start[k + 1]; e++) {                                \
      int64_t at = 3 * stride * even->column[e] + first;                                           \
      whole_block(even, 6, e, block);                                                              \
      take##suffix(m->x + at, stride, in);                                                         \
      six_times##suffix(block, in, add);                                                           \
      for (int d = 0; d < 3; d++)                                                                  \
        sum[d] += add[d];                                                                          \
      six_times##suffix(block, own, add);                                                          \
      add##suffix(m->y + at, stride, add);                                                         \
    }                                                                                              \
    for (int64_t e = odd->start[k]; e < odd->start[k + 1]; e++) {                                  \
      int64_t at = 3 * stride * odd->column[e] + first;                                            \
      whole_block(odd, 9, e, block);                                                               \
      take##suffix(m->x + at, stride, in);                                                         \
      nine_times##suffix(block, in, add);                                                          \
      for (int d = 0; d < 3; d++)                                                                  \
        sum[d] += add[d];                                                                          \
      nine_across##suffix(block, own, add);                                                        \
      add##suffix(m->y + at, stride, add);                                                         \
    }                                                                                              \
    for (int d = 0; d < 3; d++) {                                                                  \
      put##suffix(y + d * stride, diagonal[d] + sum[d]);                                           \
      part += own[d] * (diagonal[d] + 2 * sum[d]);                                                 \
    }                                                                                              \
    put##suffix(energy + first, part);                                                             \
  }
MULTIPLY(_d4, four2)
MULTIPLY(_d8, eight2)

/* The rows from `begin` on; `sums`: their own. */
static void multiply_rows(const product *m, int64_t begin, int64_t end, double *sums) {
  double energy[BWI_SMOOTHER_SIDES] = {0};
  for (int64_t k = begin; k < end; k++) {
    int first = 0;
    if (m->width == 1)
      multiply_one(m, k, energy);
    else {
      for (; first + 8 <= m->width; first += 8)
        multiply_d8(m, k, first, energy);
      if (first < m->width)
        multiply_d4(m, k, first, energy);
    }
  }
  memcpy(sums, energy, sizeof energy);
}

static bw_status chunk_product(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const product *m = data;
  for (int64_t c = begin; c < end; c++)
    multiply_rows(m, m->s->chunk_start[c], m->s->chunk_start[c + 1],
                  m->energy + BWI_SMOOTHER_SIDES * c);
  return BW_OK;
}

bw_status bwi_smoother_product(bw_context *context, const bwi_smoother *s, int width,
                               const double *x, double *y, double *energy) {
  bw_status status = BW_OK;
  double sums[(BWI_SMOOTHER_MAX_CHUNKS + 1) * BWI_SMOOTHER_SIDES];
  product m = {s, width, x, y, sums};
  int32_t chunks = s->chunk_count;
  if (s->elements)
    return bwi_element_product_apply(context, s->elements, width, x, y, energy);
  BW_TRY(bw_parallel(context, chunks, 1, chunk_product, &m));
  multiply_rows(&m, s->chunk_start[chunks], s->count, sums + BWI_SMOOTHER_SIDES * chunks);
  for (int f = 0; energy && f < width; f++) {
    energy[f] = 0;
    for (int32_t c = 0; c <= chunks; c++)
      energy[f] += sums[BWI_SMOOTHER_SIDES * c + f];
  }
done:
  return status;
}

double bwi_smoother_bytes(int64_t blocks) {
  return (double)blocks * (2 * 32 + BWI_SMOOTHER_PRODUCT_BYTES);
}
