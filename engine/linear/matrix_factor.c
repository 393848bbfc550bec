/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Factors of sparse matrices. The engine's factor works on blocks of nodes; here a row is a node
 * with one component. Only lower triangles are read. */
#include "linear/matrix_factor.h"

#include <math.h>

#include "assemble/internal.h"
#include "barwright/job.h"
#include "linear/pcg.h"

void bwi_matrix_pair_clear(bwi_matrix_pair *pair) {
  bw_release(pair->pattern);
  bw_free(pair->k);
  bw_free(pair->m);
  *pair = (bwi_matrix_pair){0};
}

/* Where the next entry of row i of a matrix stands that lies in column `at` or behind it, up to the
 * diagonal; its column, or INT32_MAX. */
static int32_t column_at(const bw_sparse_matrix *a, int32_t i, int64_t at) {
  return a && at < a->start[i + 1] && a->column[at] <= i ? a->column[at] : INT32_MAX;
}

/* Row i of the pattern: the columns of both, and the diagonal last. Returns how many; `column` and
 * the values NULL: they are only counted. */
static int64_t merge_row(const bw_sparse_matrix *k, const bw_sparse_matrix *m, int32_t i,
                         int32_t *column, double *k_value, double *m_value) {
  int64_t a = k->start[i], b = m ? m->start[i] : 0, count = 0;
  for (int32_t j = -1; j < i; count++) {
    int32_t of_k = column_at(k, i, a), of_m = column_at(m, i, b);
    j = of_k < of_m ? of_k : of_m;
    if (j > i)
      j = i;
    if (column) {
      column[count] = j;
      k_value[count] = of_k == j ? k->value[a] : 0;
      m_value[count] = m ? (of_m == j ? m->value[b] : 0) : j == i;
    }
    a += of_k == j;
    b += of_m == j;
  }
  return count;
}

bw_status bwi_matrix_pair_open(bw_context *context, const bw_sparse_matrix *k,
                               const bw_sparse_matrix *m, bwi_matrix_pair *pair) {
  bw_status status = BW_OK;
  int32_t rows = k->rows;
  int32_t *column = NULL;
  int64_t *start = BW_NEW0(context, int64_t, (int64_t)rows + 1);
  *pair = (bwi_matrix_pair){0};
  if (!start)
    return BW_MEMORY;
  for (int32_t i = 0; i < rows; i++)
    start[i + 1] = start[i] + merge_row(k, m, i, NULL, NULL, NULL);
  column = BW_NEW(context, int32_t, start[rows]);
  pair->k = BW_NEW(context, double, start[rows]);
  pair->m = BW_NEW(context, double, start[rows]);
  BW_TRY_MEMORY(column && pair->k && pair->m);
  for (int32_t i = 0; i < rows; i++)
    merge_row(k, m, i, column + start[i], pair->k + start[i], pair->m + start[i]);
  BW_TRY(bwi_block_pattern_of_rows(context, rows, start, column, &pair->pattern));
  start = NULL;
  column = NULL;
done:
  bw_free(start);
  bw_free(column);
  return status;
}

static bw_status check_memory(bw_context *context, const bwi_symbolic *symbolic,
                              const bwi_kernels *kernels, const char *name, const char *advice) {
  double available = bw_available_memory();
  double wanted =
      bwi_factor_peak_bytes(symbolic, bw_threads(context)) * (double)kernels->size / sizeof(double);
  if (wanted <= available)
    return BW_OK;
  bw_fail(context, BW_MEMORY,
          "the factor of \"%s\" with %d rows takes %.3g GB of memory, more than the %.3g GB "
          "available: %s",
          name, (int)symbolic->unknowns, wanted / 1e9, available / 1e9, advice);
  bw_detail_number(context, "bytes", wanted);
  bw_detail_number(context, "free_bytes", available);
  return BW_MEMORY;
}

static bw_status order_pair(bw_context *context, const bwi_matrix_pair *pair,
                            const bw_solver *solver, bwi_symbolic **symbolic) {
  bw_status status = BW_OK;
  bwi_order *order = NULL;
  int32_t *unknown = BW_NEW0(context, int32_t, pair->pattern->node_count);
  if (!unknown)
    return BW_MEMORY;
  bw_progress(context, "ordering", 0);
  BW_TRY(bwi_order_create_by(context, pair->pattern, NULL,
                             solver ? solver->options.ordering : BW_ORDERING_AUTO, &order));
  BW_TRY(bwi_symbolic_create(context, order, 1, unknown, symbolic));
done:
  bw_free(unknown);
  bw_release(order);
  return status;
}

bw_status bwi_matrix_pair_factor(bw_context *context, const bwi_matrix_pair *pair, double sigma,
                                 const bw_solver *solver, const char *name, const char *advice,
                                 bwi_symbolic *symbolic, bwi_factor **factor) {
  bw_status status = BW_OK;
  const bwi_kernels *kernels = bwi_kernels_of(solver);
  int32_t bad = 0;
  bwi_symbolic *own = NULL;
  bwi_matrix matrix = {.pattern = pair->pattern,
                       .stiffness = pair->k,
                       .mass = sigma != 0 ? pair->m : NULL,
                       .shift = -sigma};
  if (!symbolic)
    BW_TRY(order_pair(context, pair, solver, &own));
  symbolic = symbolic ? symbolic : own;
  BW_TRY(check_memory(context, symbolic, kernels, name, advice));
  bw_progress(context, "factorisation", 0);
  status = bwi_factor_create_in(context, symbolic, &matrix, NULL, kernels, factor, &bad);
  if (status == BW_SINGULAR) {
    bw_fail(context, BW_SINGULAR, "\"%s\" is not positive definite: elimination fails at row %d",
            name, bad + 1);
    bw_detail_number(context, "row", bad + 1);
  }
done:
  bw_release(own);
  return status;
}

bw_status bwi_matrix_solve(bw_context *context, const bw_sparse_matrix *matrix, const char *name,
                           const char *advice, int64_t count, double *x) {
  bw_status status = BW_OK;
  bwi_matrix_pair pair = {0};
  bwi_factor *factor = NULL;
  if (matrix->rows == 0)
    return BW_OK;
  BW_TRY(bwi_matrix_pair_open(context, matrix, NULL, &pair));
  BW_TRY(bwi_matrix_pair_factor(context, &pair, 0, NULL, name, advice, NULL, &factor));
  BW_TRY(bwi_solve_fields(context, factor, NULL, count, x, x));
done:
  bw_release(factor);
  bwi_matrix_pair_clear(&pair);
  return status;
}
