/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Vector operations of the iterations. Sums are made of sums over blocks of fixed length, each by
 * one thread in eight strands, added in order. */
#include "linear/vectors.h"

enum { BLOCK = 1 << 15, STRANDS = 8, BLOCKS_AT_ONCE = 64 };

typedef enum operation { DOT, SUBTRACT, ADD_SCALED, STEP, DIRECTION } operation;

typedef struct pass {
  operation operation;
  const double *a, *b;
  double *c, *d;
  double alpha, beta;
  double *sum; /* of each block */
} pass;

/* The loop over a block: `update` changes element k, `term` is what it adds to the sum. */
#define LOOP(update, term)                                                                         \
  do {                                                                                             \
    double strand[STRANDS] = {0};                                                                  \
    int64_t k = begin;                                                                             \
    for (; k + STRANDS <= end; k += STRANDS)                                                       \
      for (int s = 0; s < STRANDS; s++) {                                                          \
        int64_t i = k + s;                                                                         \
        update;                                                                                    \
        strand[s] += term;                                                                         \
      }                                                                                            \
    for (int s = 0; k < end; k++, s++) {                                                           \
      int64_t i = k;                                                                               \
      update;                                                                                      \
      strand[s] += term;                                                                           \
    }                                                                                              \
    sum = ((strand[0] + strand[4]) + (strand[1] + strand[5])) +                                    \
          ((strand[2] + strand[6]) + (strand[3] + strand[7]));                                     \
  } while (0)

static bw_status body(void *data, int64_t begin, int64_t end, int worker) {
  const pass *w = data;
  const double *restrict a = w->a, *restrict b = w->b;
  double *restrict c = w->c, *restrict d = w->d;
  const double alpha = w->alpha, beta = w->beta;
  double sum = 0;
  (void)worker;
  switch (w->operation) {
  case DOT:
    LOOP((void)0, a[i] * w->b[i]);
    break;
  case SUBTRACT:
    LOOP(c[i] = a[i] - c[i], c[i] * c[i]);
    break;
  case ADD_SCALED:
    if (beta == 0)
      for (int64_t i = begin; i < end; i++)
        c[i] = a[i];
    else
      for (int64_t i = begin; i < end; i++)
        c[i] = a[i] + beta * c[i];
    break;
  case STEP:
    LOOP((c[i] += alpha * a[i], d[i] -= alpha * b[i]), d[i] * d[i]);
    break;
  case DIRECTION:
    for (int64_t i = begin; i < end; i++)
      c[i] = a[i] + beta * (c[i] - alpha * b[i]);
    break;
  }
  if (w->sum)
    w->sum[begin / BLOCK] = sum;
  return BW_OK;
}

static bw_status run(bw_context *context, size_t n, pass *w, double *total) {
  double few[BLOCKS_AT_ONCE];
  size_t blocks = (n + BLOCK - 1) / BLOCK;
  double *sum = few;
  if (blocks > BLOCKS_AT_ONCE && total && !(sum = BW_NEW(context, double, blocks)))
    return BW_MEMORY;
  w->sum = total ? sum : NULL;
  bw_status status = bw_parallel(context, (int64_t)n, BLOCK, body, w);
  if (total) {
    *total = 0;
    for (size_t k = 0; k < blocks; k++)
      *total += sum[k];
  }
  if (sum != few)
    bw_free(sum);
  return status;
}

bw_status bwi_blocked_dot(bw_context *context, size_t n, const double *a, const double *b,
                          double *sum) {
  pass w = {.operation = DOT, .a = a, .b = b};
  return run(context, n, &w, sum);
}

bw_status bwi_subtract_from(bw_context *context, size_t n, const double *b, double *r,
                            double *square) {
  pass w = {.operation = SUBTRACT, .a = b, .c = r};
  return run(context, n, &w, square);
}

bw_status bwi_add_scaled(bw_context *context, size_t n, double beta, const double *z, double *p) {
  pass w = {.operation = ADD_SCALED, .a = z, .c = p, .beta = beta};
  return run(context, n, &w, NULL);
}

bw_status bwi_step(bw_context *context, size_t n, double alpha, const double *p, const double *q,
                   double *x, double *r, double *square) {
  pass w = {.operation = STEP, .a = p, .b = q, .c = x, .d = r, .alpha = alpha};
  return run(context, n, &w, square);
}

bw_status bwi_direction(bw_context *context, size_t n, double beta, double omega, const double *r,
                        const double *v, double *p) {
  pass w = {.operation = DIRECTION, .a = r, .b = v, .c = p, .alpha = omega, .beta = beta};
  return run(context, n, &w, NULL);
}
