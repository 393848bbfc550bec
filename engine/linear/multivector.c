/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Dense algebra on a few long vectors (column-major, `size` numbers each). Long dimensions are cut
 * into chunks of fixed length whose partial sums are added in order: the same bits for any number
 * of threads. */
#include <string.h>

#include "linear/blas.h"
#include "linear/multivector.h"

enum { CHUNK = 4096 };

typedef struct product {
  int64_t size;
  int a_count, b_count;
  const double *a, *b;
  double *partial, *c;
  const double *weights;
  int weights_ld;
  double alpha, beta;
} product;

static bw_status dot_chunk(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const product *p = data;
  int rows = (int)(end - begin), ld = (int)p->size;
  const double one = 1, zero = 0;
  dgemm_("T", "N", &p->a_count, &p->b_count, &rows, &one, p->a + begin, &ld, p->b + begin, &ld,
         &zero, p->partial + begin / CHUNK * p->a_count * p->b_count, &p->a_count);
  return BW_OK;
}

bw_status bwi_multi_dot(bw_context *context, int64_t size, int a_count, const double *a,
                        int b_count, const double *b, double *c) {
  if (a_count == 0 || b_count == 0)
    return BW_OK;
  int64_t chunks = (size + CHUNK - 1) / CHUNK, entries = (int64_t)a_count * b_count;
  product p = {.size = size, .a_count = a_count, .b_count = b_count, .a = a, .b = b};
  p.partial = BW_NEW(context, double, chunks *entries);
  if (!p.partial)
    return BW_MEMORY;
  bwi_blas_enter();
  bw_status status = bw_parallel(context, size, CHUNK, dot_chunk, &p);
  bwi_blas_leave();
  memset(c, 0, (size_t)entries * sizeof(double));
  for (int64_t k = 0; status == BW_OK && k < chunks; k++)
    for (int64_t i = 0; i < entries; i++)
      c[i] += p.partial[k * entries + i];
  bw_free(p.partial);
  return status;
}

static bw_status combine_chunk(void *data, int64_t begin, int64_t end, int worker) {
  (void)worker;
  const product *p = data;
  int rows = (int)(end - begin), ld = (int)p->size;
  dgemm_("N", "N", &rows, &p->b_count, &p->a_count, &p->alpha, p->a + begin, &ld, p->weights,
         &p->weights_ld, &p->beta, p->c + begin, &ld);
  return BW_OK;
}

bw_status bwi_multi_combine(bw_context *context, int64_t size, int a_count, const double *a,
                            int b_count, const double *weights, int weights_ld, double alpha,
                            double beta, double *c) {
  if (a_count == 0 || b_count == 0)
    return BW_OK;
  product p = {.size = size,
               .a_count = a_count,
               .b_count = b_count,
               .a = a,
               .c = c,
               .weights = weights,
               .weights_ld = weights_ld,
               .alpha = alpha,
               .beta = beta};
  bwi_blas_enter();
  bw_status status = bw_parallel(context, size, CHUNK, combine_chunk, &p);
  bwi_blas_leave();
  return status;
}
