/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* y = A x with A stored as the lower triangle of a pattern. Each row is summed by one thread: its
 * stored blocks, then their mirror images above the diagonal, always in the same order. The time
 * goes into reading the values, so several vectors share one pass: they are interleaved by fours or
 * eights, and a register holds the same component of each. The sums are the same as one by one. */
#include "assemble/internal.h"

#include <string.h>

enum { ROWS_PER_CHUNK = 512, MOST = 8 };

typedef double four __attribute__((vector_size(32), aligned(8), may_alias));
typedef double eight __attribute__((vector_size(64), aligned(8), may_alias));

typedef struct multiply_data {
  const bw_block_pattern *pattern;
  const double *values, *x;
  double *y;
  int components;
  int64_t stride, count; /* numbers per vector; vectors */
  int width;             /* vectors that are interleaved: 4 or 8 */
  double *packed;        /* ceil(count / width) x stride x width, or NULL for a single vector */
} multiply_data;

static bw_status pack(void *data, int64_t begin, int64_t end, int worker) {
  const multiply_data *m = (const multiply_data *)data;
  (void)worker;
  for (int64_t first = 0; first < m->count; first += m->width) {
    double *to = m->packed + first * m->stride;
    for (int64_t k = begin; k < end; k++)
      for (int v = 0; v < m->width; v++)
        to[k * m->width + v] = first + v < m->count ? m->x[(first + v) * m->stride + k] : 0;
  }
  return BW_OK;
}

/* The row sums for 3x3 blocks, and for single numbers that act on each of `n` components alike; the
 * same text serves a number and several of them. */
#define ROW_OF_BLOCKS(type, x, sum)                                                                \
  do {                                                                                             \
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++) {                          \
      const double *a = m->values + 9 * p;                                                         \
      const type *in = (x) + 3 * (int64_t)pattern->column[p];                                      \
      for (int r = 0; r < 3; r++)                                                                  \
        sum[r] += a[3 * r] * in[0] + a[3 * r + 1] * in[1] + a[3 * r + 2] * in[2];                  \
    }                                                                                              \
    for (int64_t k = pattern->upper_start[i]; k < pattern->upper_start[i + 1]; k++) {              \
      const double *a = m->values + 9 * bw_upper_block(pattern, k);                                \
      const type *in = (x) + 3 * (int64_t)pattern->upper_row[k];                                   \
      for (int r = 0; r < 3; r++)                                                                  \
        sum[r] += a[r] * in[0] + a[3 + r] * in[1] + a[6 + r] * in[2];                              \
    }                                                                                              \
  } while (0)

#define ROW_OF_NUMBERS(type, x, sum, n)                                                            \
  do {                                                                                             \
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++) {                          \
      const type *in = (x) + (n) * (int64_t)pattern->column[p];                                    \
      for (int r = 0; r < (n); r++)                                                                \
        sum[r] += m->values[p] * in[r];                                                            \
    }                                                                                              \
    for (int64_t k = pattern->upper_start[i]; k < pattern->upper_start[i + 1]; k++) {              \
      double a = m->values[bw_upper_block(pattern, k)];                                            \
      const type *in = (x) + (n) * (int64_t)pattern->upper_row[k];                                 \
      for (int r = 0; r < (n); r++)                                                                \
        sum[r] += a * in[r];                                                                       \
    }                                                                                              \
  } while (0)

static bw_status blocks_one(void *data, int64_t begin, int64_t end, int worker) {
  const multiply_data *m = (const multiply_data *)data;
  const bw_block_pattern *pattern = m->pattern;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    double sum[3] = {0};
    ROW_OF_BLOCKS(double, m->x, sum);
    memcpy(m->y + 3 * i, sum, sizeof sum);
  }
  return BW_OK;
}

static bw_status numbers_one(void *data, int64_t begin, int64_t end, int worker) {
  const multiply_data *m = (const multiply_data *)data;
  const bw_block_pattern *pattern = m->pattern;
  (void)worker;
  for (int64_t i = begin; i < end; i++) {
    double sum[3] = {0};
    ROW_OF_NUMBERS(double, m->x, sum, m->components);
    memcpy(m->y + m->components * i, sum, (size_t)m->components * sizeof *sum);
  }
  return BW_OK;
}

static void unpack(const multiply_data *m, int64_t first, int64_t i, const double *sum) {
  for (int v = 0; v < m->width && first + v < m->count; v++)
    for (int r = 0; r < m->components; r++)
      m->y[(first + v) * m->stride + m->components * i + r] = sum[r * m->width + v];
}

/* The products of several vectors; `row` is one of the sums above. */
#define MANY(name, type, n, row)                                                                   \
  static bw_status name(void *data, int64_t begin, int64_t end, int worker) {                      \
    const multiply_data *m = (const multiply_data *)data;                                          \
    const bw_block_pattern *pattern = m->pattern;                                                  \
    (void)worker;                                                                                  \
    for (int64_t first = 0; first < m->count; first += m->width)                                   \
      for (int64_t i = begin; i < end; i++) {                                                      \
        type sum[n];                                                                               \
        double number[(n)*MOST];                                                                   \
        memset(sum, 0, sizeof sum);                                                                \
        row;                                                                                       \
        memcpy(number, sum, sizeof sum);                                                           \
        unpack(m, first, i, number);                                                               \
      }                                                                                            \
    return BW_OK;                                                                                  \
  }
#define PACKED(type) ((const type *)(const void *)(m->packed + first * m->stride))
MANY(blocks_four, four, 3, ROW_OF_BLOCKS(four, PACKED(four), sum))
MANY(blocks_eight, eight, 3, ROW_OF_BLOCKS(eight, PACKED(eight), sum))
MANY(numbers_four, four, 3, ROW_OF_NUMBERS(four, PACKED(four), sum, 3))
MANY(numbers_eight, eight, 3, ROW_OF_NUMBERS(eight, PACKED(eight), sum, 3))
MANY(scalars_four, four, 1, ROW_OF_NUMBERS(four, PACKED(four), sum, 1))
MANY(scalars_eight, eight, 1, ROW_OF_NUMBERS(eight, PACKED(eight), sum, 1))

/* By what blocks are (3x3, a number on three components, a number on one) and by width. */
static bw_body *const many[3][2] = {
    {blocks_four, blocks_eight}, {numbers_four, numbers_eight}, {scalars_four, scalars_eight}};

bw_status bw_block_multiply(bw_context *context, const bw_block_pattern *pattern,
                            const double *values, int block, int components, int64_t count,
                            const double *x, double *y) {
  if ((block != 9 && block != 1) || (components != 1 && components != 3) ||
      (block == 9 && components != 3) || count < 0)
    return bw_fail(context, BW_INVALID,
                   "a product with blocks of %d numbers, %d components and %lld vectors; blocks "
                   "have 9 (then 3 components) or 1 (1 or 3 components)",
                   block, components, (long long)count);
  bw_status status = BW_OK;
  multiply_data m = {.pattern = pattern,
                     .values = values,
                     .x = x,
                     .y = y,
                     .components = components,
                     .stride = (int64_t)pattern->node_count * components,
                     .count = count,
                     .width = count > 4 ? 8 : 4};
  if (count > 1) {
    m.packed = BW_NEW(context, double, (count + m.width - 1) / m.width * m.width * m.stride);
    if (!m.packed)
      return BW_MEMORY;
    BW_TRY(bw_parallel(context, m.stride, 4096, pack, &m));
  }
  bw_body *one = block == 9 ? blocks_one : numbers_one;
  if (count > 0)
    BW_TRY(bw_parallel(context, pattern->node_count, ROWS_PER_CHUNK,
                       count > 1 ? many[block == 9        ? 0
                                        : components == 3 ? 1
                                                          : 2][count > 4]
                                 : one,
                       &m));
done:
  bw_free(m.packed);
  return status;
}
