/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* LU factors of unsymmetric matrices on plane patterns, by UMFPACK.
 *
 * UMFPACK takes compressed columns. Rows are what a pattern has: the arrays hold the transposed
 * matrix, and solves ask for the transposed system. Columns are ordered by nodes, with the order
 * that is kept as long as the nodes are; UMFPACK may still choose pivots elsewhere where numbers
 * ask for it. */
#include <limits.h>

#include <umfpack.h>

#include "incremental/lagged_factor.h"
#include "linear/blas.h"

typedef struct lagged_unsymmetric {
  bwi_lagged shared;
  int size;
  int *order; /* unknowns as they are eliminated */
  int *start, *row;
  double *value;
  void *symbolic, *numeric;
  int *work_index;
  double *workspace;
} lagged_unsymmetric;

static void forget_analysis(bwi_lagged *shared) {
  lagged_unsymmetric *s = (lagged_unsymmetric *)shared;
  if (s->symbolic)
    umfpack_di_free_symbolic(&s->symbolic);
  bw_free(s->start);
  bw_free(s->row);
  bw_free(s->value);
  s->start = s->row = NULL;
  s->value = NULL;
}

static void forget(bwi_lagged *shared) {
  lagged_unsymmetric *s = (lagged_unsymmetric *)shared;
  if (s->numeric)
    umfpack_di_free_numeric(&s->numeric);
  bw_free(s->order);
  bw_free(s->work_index);
  bw_free(s->workspace);
  s->order = s->work_index = NULL;
  s->workspace = NULL;
}

/* Quiet, without iterative refinement, and for a pattern that is symmetric. */
static void controls(double *control) {
  umfpack_di_defaults(control);
  control[UMFPACK_PRL] = 0;
  control[UMFPACK_IRSTEP] = 0;
  control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
}

static bw_status check(bw_context *context, const lagged_unsymmetric *s, int code,
                       double smallest_pivot) {
  if (code == UMFPACK_WARNING_singular_matrix || (code == UMFPACK_OK && !(smallest_pivot > 0))) {
    bw_fail(context, BW_SINGULAR,
            "the matrix of %d unknowns is singular (its smallest pivot is %.3g times the largest): "
            "a part is not constrained by any condition, or a coefficient is 0 or not finite",
            s->size, smallest_pivot);
    bw_detail_number(context, "pivot_ratio", smallest_pivot);
    return BW_SINGULAR;
  }
  if (code == UMFPACK_ERROR_out_of_memory)
    return bw_fail(context, BW_MEMORY, "no memory for the LU factor of %d unknowns", s->size);
  if (code != UMFPACK_OK)
    return bw_fail(context, BW_INTERNAL, "UMFPACK failed on a matrix of %d unknowns (code %d)",
                   s->size, code);
  return BW_OK;
}

static void fill_values(lagged_unsymmetric *s, const bw_plane_pattern *pattern,
                        const double *values) {
  const int C = s->shared.components;
  int fill = 0;
  for (int32_t i = 0; i < pattern->node_count; i++)
    for (int r = 0; r < C; r++)
      for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++)
        for (int c = 0; c < C; c++)
          s->value[fill++] = values[C * C * p + C * r + c];
}

static bw_status analyse(bw_context *context, bwi_lagged *shared, const bw_plane_pattern *pattern,
                         const double *values, bwi_adjacency *near) {
  bw_status status = BW_OK;
  lagged_unsymmetric *s = (lagged_unsymmetric *)shared;
  double control[UMFPACK_CONTROL], info[UMFPACK_INFO];
  const int C = shared->components;
  int64_t entries = pattern->block_count * C * C;
  (void)near;
  if (entries > INT_MAX)
    return bw_fail(context, BW_LIMIT,
                   "%lld matrix entries: more than the integers of UMFPACK can count",
                   (long long)entries);
  s->size = pattern->node_count * C;
  if (!s->order)
    s->order = BW_NEW(context, int, s->size);
  if (!s->work_index)
    s->work_index = BW_NEW(context, int, s->size);
  if (!s->workspace)
    s->workspace = BW_NEW(context, double, s->size);
  s->start = BW_NEW(context, int, (size_t)s->size + 1);
  s->row = BW_NEW(context, int, entries);
  s->value = BW_NEW(context, double, entries);
  BW_TRY_MEMORY(s->order && s->work_index && s->workspace && s->start && s->row && s->value);
  int fill = 0;
  for (int32_t i = 0; i < pattern->node_count; i++)
    for (int r = 0; r < C; r++) {
      s->order[i * C + r] = (int)shared->permutation[i] * C + r;
      s->start[i * C + r] = fill;
      for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++)
        for (int c = 0; c < C; c++)
          s->row[fill++] = pattern->column[p] * C + c;
    }
  s->start[s->size] = fill;
  fill_values(s, pattern, values);
  controls(control);
  BW_TRY(bw_check_cancel(context));
  BW_TRY(check(context, s,
               umfpack_di_qsymbolic(s->size, s->size, s->start, s->row, s->value, s->order,
                                    &s->symbolic, control, info),
               1));
  shared->flops = info[UMFPACK_FLOPS_ESTIMATE];
done:
  return status;
}

static bw_status factor(bw_context *context, bwi_lagged *shared, const bw_plane_pattern *pattern,
                        const double *values, bwi_lagged_work *work) {
  lagged_unsymmetric *s = (lagged_unsymmetric *)shared;
  double control[UMFPACK_CONTROL], info[UMFPACK_INFO];
  if (!work->analysed) /* else the analysis read them */
    fill_values(s, pattern, values);
  controls(control);
  if (s->numeric)
    umfpack_di_free_numeric(&s->numeric);
  bwi_blas_enter();
  int code =
      umfpack_di_numeric(s->start, s->row, s->value, s->symbolic, &s->numeric, control, info);
  bwi_blas_leave();
  work->flops = info[UMFPACK_FLOPS];
  work->bytes = 12 * (info[UMFPACK_LNZ] + info[UMFPACK_UNZ]);
  return check(context, s, code, info[UMFPACK_RCOND]);
}

static bw_status apply(bw_context *context, bwi_lagged *shared, bool old, const double *r,
                       double *z) {
  lagged_unsymmetric *s = (lagged_unsymmetric *)shared;
  double control[UMFPACK_CONTROL], info[UMFPACK_INFO];
  (void)old;
  controls(control);
  bwi_blas_enter();
  int code = umfpack_di_wsolve(UMFPACK_At, s->start, s->row, s->value, z, r, s->numeric, control,
                               info, s->work_index, s->workspace);
  bwi_blas_leave();
  if (code != UMFPACK_OK)
    return bw_fail(context, BW_INTERNAL, "UMFPACK's solve of %d unknowns failed (code %d)", s->size,
                   code);
  return BW_OK;
}

const bwi_lagged_kind bwi_lagged_unsymmetric = {
    sizeof(lagged_unsymmetric), analyse, factor, apply, forget_analysis, forget};
