/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
#include "cholmod_baseline.h"

#include <limits.h>
#include <string.h>

#include <cholmod.h>

void openblas_set_num_threads(int);
int openblas_get_num_threads(void);

/* The lower triangle by unknowns in elimination order; rows of a column in no order. */
static bw_status reduced_matrix(bw_context *context, const bwi_symbolic *symbolic,
                                const bwi_matrix *matrix, cholmod_common *common,
                                cholmod_sparse **out) {
  const bwi_order *order = symbolic->order;
  const bw_block_pattern *pattern = matrix->pattern;
  const int32_t *at = symbolic->at;
  size_t size = (size_t)symbolic->unknowns, entries = 0;
  cholmod_sparse *a = NULL;
  int32_t *start = NULL, *row = NULL;
  double *value = NULL;
  /* once to count, once to fill */
  for (int pass = 0; pass < 2; pass++) {
    if (pass == 1) {
      if (entries > INT_MAX)
        return bw_fail(context, BW_LIMIT,
                       "%zu matrix entries: more than the integers of CHOLMOD can count", entries);
      a = cholmod_allocate_sparse(size, size, entries, 0, 1, -1, CHOLMOD_REAL, common);
      if (!a)
        return bw_fail(context, BW_MEMORY, "no memory for a matrix of %zu entries", entries);
      start = a->p;
      row = a->i;
      value = a->x;
    }
    size_t fill = 0;
    for (int32_t p = 0; p < order->size; p++) {
      int32_t node = order->node_at[p];
      for (int j = 0; j < 3; j++) {
        int32_t column = at[3 * (int64_t)node + j];
        if (column < 0)
          continue;
        if (start)
          start[column] = (int32_t)fill;
        for (int half = 0; half < 2; half++) {
          const int64_t *from = half ? pattern->upper_start : pattern->start;
          for (int64_t k = from[node]; k < from[node + 1]; k++) {
            int32_t other = half ? pattern->upper_row[k] : pattern->column[k];
            double block[9];
            if (order->position[other] < p)
              continue;
            if (value)
              bwi_matrix_block(matrix, 3, half ? bw_upper_block(pattern, k) : k, !half, other, node,
                               block);
            for (int i = 0; i < 3; i++) {
              int32_t r = at[3 * (int64_t)other + i];
              if (r < column)
                continue;
              if (value) {
                row[fill] = r;
                value[fill] = block[3 * i + j];
              }
              fill++;
            }
          }
        }
      }
    }
    entries = fill;
  }
  start[size] = (int32_t)entries;
  *out = a;
  return BW_OK;
}

bw_status cholmod_baseline(bw_context *context, const bwi_symbolic *symbolic,
                           const bwi_matrix *matrix, double *x, cholmod_times *times) {
  bw_status status = BW_OK;
  size_t size = (size_t)symbolic->unknowns;
  cholmod_common common;
  cholmod_sparse *a = NULL;
  cholmod_factor *l = NULL;
  cholmod_dense *b = NULL, *u = NULL;
  *times = (cholmod_times){0};
  cholmod_start(&common);
  common.print = 0;
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_NATURAL;
  common.postorder = 1;
  common.supernodal = CHOLMOD_SUPERNODAL;
  int before = openblas_get_num_threads();
  openblas_set_num_threads(bw_threads(context));
  BW_TRY(reduced_matrix(context, symbolic, matrix, &common, &a));
  double start = bw_seconds();
  l = cholmod_analyze(a, &common);
  times->analysis = bw_seconds() - start;
  b = cholmod_allocate_dense(size, 1, size, CHOLMOD_REAL, &common);
  if (!l || !b) {
    status = bw_fail(context, BW_MEMORY, "no memory for CHOLMOD with %zu unknowns", size);
    goto done;
  }
  memcpy(b->x, x, size * sizeof(double));
  start = bw_seconds();
  cholmod_factorize(a, l, &common);
  times->factor = bw_seconds() - start;
  if (common.status < CHOLMOD_OK) {
    status = bw_fail(context, BW_MEMORY, "no memory for CHOLMOD's factor");
    goto done;
  }
  if (common.status == CHOLMOD_NOT_POSDEF) {
    status = bw_fail(context, BW_SINGULAR, "CHOLMOD finds the matrix not positive definite");
    goto done;
  }
  start = bw_seconds();
  u = cholmod_solve(CHOLMOD_A, l, b, &common);
  times->solve = bw_seconds() - start;
  if (!u) {
    status = bw_fail(context, BW_MEMORY, "no memory for CHOLMOD's solution");
    goto done;
  }
  memcpy(x, u->x, size * sizeof(double));
  times->flops = common.fl;
  times->entries = common.lnz;
done:
  openblas_set_num_threads(before);
  cholmod_free_dense(&u, &common);
  cholmod_free_dense(&b, &common);
  cholmod_free_factor(&l, &common);
  cholmod_free_sparse(&a, &common);
  cholmod_finish(&common);
  return status;
}
