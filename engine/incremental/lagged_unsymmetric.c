/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* LU factors of unsymmetric matrices on plane patterns, by UMFPACK.
 *
 * UMFPACK takes compressed columns. Rows are what a pattern has: the arrays hold the transposed
 * matrix, and solves ask for the transposed system. Columns are ordered by nodes, with an order
 * that is kept as long as the nodes are (lagged_symmetric.c); UMFPACK may still choose pivots
 * elsewhere where numbers ask for it. */
#include <limits.h>
#include <string.h>

#include <umfpack.h>

#include "incremental/lagged_factor.h"
#include "linear/blas.h"

struct bwi_lagged_unsymmetric {
  int components;
  const bw_plane_nodes *nodes;       /* retained: what the order is of */
  int32_t *order;                    /* unknowns as they are eliminated */
  double ordered;                    /* operations estimated when it was new */
  const bw_plane_topology *topology; /* retained: what the analysis is of */
  int size;
  int *start, *row;
  double *value;
  void *symbolic, *numeric;
  int *work_index;
  double *workspace;
};

bw_status bwi_lagged_unsymmetric_create(bw_context *context, int components,
                                        bwi_lagged_unsymmetric **out) {
  bwi_lagged_unsymmetric *s = BW_NEW0(context, bwi_lagged_unsymmetric, 1);
  if (!s)
    return BW_MEMORY;
  s->components = components;
  *out = s;
  return BW_OK;
}

static void forget_analysis(bwi_lagged_unsymmetric *s) {
  if (s->symbolic)
    umfpack_di_free_symbolic(&s->symbolic);
  bw_release(s->topology);
  bw_free(s->start);
  bw_free(s->row);
  bw_free(s->value);
  s->symbolic = NULL;
  s->topology = NULL;
  s->start = s->row = NULL;
  s->value = NULL;
}

void bwi_lagged_unsymmetric_reset(bwi_lagged_unsymmetric *s) {
  forget_analysis(s);
  if (s->numeric)
    umfpack_di_free_numeric(&s->numeric);
  bw_release(s->nodes);
  bw_free(s->order);
  bw_free(s->work_index);
  bw_free(s->workspace);
  *s = (bwi_lagged_unsymmetric){.components = s->components};
}

void bwi_lagged_unsymmetric_destroy(bwi_lagged_unsymmetric *s) {
  if (!s)
    return;
  bwi_lagged_unsymmetric_reset(s);
  bw_free(s);
}

/* Quiet, without iterative refinement, and for a pattern that is symmetric. */
static void controls(double *control) {
  umfpack_di_defaults(control);
  control[UMFPACK_PRL] = 0;
  control[UMFPACK_IRSTEP] = 0;
  control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
}

static bw_status check(bw_context *context, const bwi_lagged_unsymmetric *s, int code,
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

static bw_status order_unknowns(bw_context *context, bwi_lagged_unsymmetric *s,
                                const bw_plane_pattern *pattern) {
  bw_status status = BW_OK;
  int32_t *nodes = BW_NEW(context, int32_t, pattern->node_count);
  if (!s->order)
    s->order = BW_NEW(context, int32_t, s->size);
  if (!s->work_index)
    s->work_index = BW_NEW(context, int, s->size);
  if (!s->workspace)
    s->workspace = BW_NEW(context, double, s->size);
  if (!nodes || !s->order || !s->work_index || !s->workspace) {
    status = BW_MEMORY;
    goto done;
  }
  BW_TRY(bwi_lagged_order(context, pattern, s->nodes != NULL, nodes));
  for (int32_t i = 0; i < pattern->node_count; i++)
    for (int c = 0; c < s->components; c++)
      s->order[i * s->components + c] = nodes[i] * s->components + c;
  if (!s->nodes)
    s->nodes = bw_retain(pattern->topology->nodes);
done:
  bw_free(nodes);
  return status;
}

static void fill_values(bwi_lagged_unsymmetric *s, const bw_plane_pattern *pattern,
                        const double *values) {
  const int C = s->components;
  int fill = 0;
  for (int32_t i = 0; i < pattern->node_count; i++)
    for (int r = 0; r < C; r++)
      for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++)
        for (int c = 0; c < C; c++)
          s->value[fill++] = values[C * C * p + C * r + c];
}

static bw_status analyse(bw_context *context, bwi_lagged_unsymmetric *s,
                         const bw_plane_pattern *pattern, const double *values,
                         bwi_lagged_work *work) {
  bw_status status = BW_OK;
  double control[UMFPACK_CONTROL], info[UMFPACK_INFO];
  const int C = s->components;
  int64_t entries = pattern->block_count * C * C;
  if (s->topology == pattern->topology) {
    fill_values(s, pattern, values);
    return BW_OK;
  }
  if (entries > INT_MAX)
    return bw_fail(context, BW_LIMIT,
                   "%lld matrix entries: more than the integers of UMFPACK can count",
                   (long long)entries);
  work->analysed = true;
  forget_analysis(s);
  if (s->nodes != pattern->topology->nodes) {
    bwi_lagged_unsymmetric_reset(s);
    work->reordered = true;
  }
  s->size = pattern->node_count * C;
  if (!s->nodes)
    BW_TRY(order_unknowns(context, s, pattern));
  s->start = BW_NEW(context, int, (size_t)s->size + 1);
  s->row = BW_NEW(context, int, entries);
  s->value = BW_NEW(context, double, entries);
  if (!s->start || !s->row || !s->value) {
    status = BW_MEMORY;
    goto done;
  }
  int fill = 0;
  for (int32_t i = 0; i < pattern->node_count; i++)
    for (int r = 0; r < C; r++) {
      s->start[i * C + r] = fill;
      for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++)
        for (int c = 0; c < C; c++)
          s->row[fill++] = pattern->column[p] * C + c;
    }
  s->start[s->size] = fill;
  fill_values(s, pattern, values);
  controls(control);
  BW_TRY(bw_check_cancel(context));
  for (;;) {
    int code = umfpack_di_qsymbolic(s->size, s->size, s->start, s->row, s->value, s->order,
                                    &s->symbolic, control, info);
    BW_TRY(check(context, s, code, 1));
    double flops = info[UMFPACK_FLOPS_ESTIMATE];
    if (work->reordered)
      s->ordered = flops;
    if (flops <= BWI_MAX_WORK_GROWTH * s->ordered)
      break;
    umfpack_di_free_symbolic(&s->symbolic);
    s->symbolic = NULL;
    work->reordered = true;
    BW_TRY(order_unknowns(context, s, pattern));
  }
  s->topology = bw_retain(pattern->topology);
done:
  if (status != BW_OK)
    forget_analysis(s);
  return status;
}

bw_status bwi_lagged_unsymmetric_factor(bw_context *context, bwi_lagged_unsymmetric *s,
                                        const bw_plane_pattern *pattern, const double *values,
                                        bwi_lagged_work *work) {
  bw_status status = BW_OK;
  double control[UMFPACK_CONTROL], info[UMFPACK_INFO];
  void *numeric = NULL;
  *work = (bwi_lagged_work){0};
  BW_TRY(analyse(context, s, pattern, values, work));
  BW_TRY(bw_check_cancel(context));
  controls(control);
  bwi_blas_enter();
  int code = umfpack_di_numeric(s->start, s->row, s->value, s->symbolic, &numeric, control, info);
  bwi_blas_leave();
  status = check(context, s, code, info[UMFPACK_RCOND]);
  if (s->numeric)
    umfpack_di_free_numeric(&s->numeric);
  s->numeric = NULL;
  if (status != BW_OK) {
    if (numeric)
      umfpack_di_free_numeric(&numeric);
    goto done;
  }
  s->numeric = numeric;
  work->flops = info[UMFPACK_FLOPS];
  work->bytes = 12 * (info[UMFPACK_LNZ] + info[UMFPACK_UNZ]);
done:
  return status;
}

bw_status bwi_lagged_unsymmetric_apply(bw_context *context, bwi_lagged_unsymmetric *s,
                                       const double *r, double *z) {
  double control[UMFPACK_CONTROL], info[UMFPACK_INFO];
  if (!s->numeric)
    return bw_fail(context, BW_INTERNAL, "there is no factor to apply");
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
