/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Cholesky factors of symmetric positive definite matrices on plane patterns, by the engine's
 * multifrontal factorisation (linear/). Numbers are factored in place where the analysis is kept,
 * since the first touch of new memory costs as much as arithmetic does. */

#include "incremental/lagged_factor.h"
#include "incremental/triangular_solve.h"

typedef struct lagged_symmetric {
  bwi_lagged shared;
  bwi_symbolic *symbolic;
  bwi_factor *factor; /* of this symbolic or, until the next factorisation, an older one */
  bwi_triangular_solve *triangular; /* of it; NULL until it pays */
} lagged_symmetric;

static void forget_analysis(bwi_lagged *shared) {
  lagged_symmetric *s = (lagged_symmetric *)shared;
  bw_release(s->symbolic);
  s->symbolic = NULL;
}

static void forget(bwi_lagged *shared) {
  lagged_symmetric *s = (lagged_symmetric *)shared;
  bwi_triangular_solve_destroy(s->triangular);
  s->triangular = NULL;
  bw_release(s->factor);
  s->factor = NULL;
}

static bw_status analyse(bw_context *context, bwi_lagged *shared, const bw_plane_pattern *pattern,
                         const double *values, bwi_adjacency *near) {
  bw_status status = BW_OK;
  lagged_symmetric *s = (lagged_symmetric *)shared;
  bwi_order *order = NULL;
  size_t unknowns = (size_t)pattern->node_count * (size_t)shared->components;
  int32_t *unknown = BW_NEW0(context, int32_t, unknowns);
  (void)values;
  BW_TRY_MEMORY(unknown);
  BW_TRY(bwi_lagged_adjacency(context, pattern, near));
  BW_TRY(bwi_order_analyse(context, near, shared->permutation, &order));
  BW_TRY(bwi_symbolic_create(context, order, shared->components, unknown, &s->symbolic));
  shared->flops = s->symbolic->flops;
done:
  bw_release(order);
  bw_free(unknown);
  return status;
}

static bw_status factor(bw_context *context, bwi_lagged *shared, const bw_plane_pattern *pattern,
                        const double *values, bwi_lagged_work *work) {
  lagged_symmetric *s = (lagged_symmetric *)shared;
  bw_status status = BW_OK;
  bwi_elimination_reach *reach = NULL;
  bwi_factor *fresh = NULL;
  int32_t bad_node = -1;
  /* The factorisation reads the blocks of a lower triangle and those above it; given whole rows as
     the one and nothing as the other it finds each entry where it looks for it. */
  bw_block_pattern rows = {.node_count = pattern->node_count,
                           .block_count = pattern->block_count,
                           .start = pattern->start,
                           .column = pattern->column};
  bwi_matrix matrix = {.pattern = &rows, .stiffness = values};
  rows.upper_start = BW_NEW0(context, int64_t, (size_t)pattern->node_count + 1);
  if (!rows.upper_start)
    return BW_MEMORY;
  bwi_triangular_solve_destroy(s->triangular);
  s->triangular = NULL;
  if (s->factor && s->factor->symbolic == s->symbolic) {
    status = bwi_factor_update(context, s->factor, &matrix, NULL, NULL, &bad_node);
  } else {
    BW_TRY(bwi_elimination_reach_create_whole(context, s->symbolic, &reach));
    status = bwi_factor_create_in(context, s->symbolic, &matrix, reach, &bwi_kernels_double, &fresh,
                                  &bad_node);
    bw_release(s->factor);
    s->factor = fresh;
  }
  if (status == BW_SINGULAR) {
    bw_fail(context, BW_SINGULAR,
            "the matrix of %d nodes is not positive definite at node %d: something there can move "
            "freely, or an element is inverted",
            pattern->node_count, bad_node + 1);
    bw_detail_number(context, "node", bad_node + 1);
  }
  if (status != BW_OK) {
    bw_release(s->factor);
    s->factor = NULL;
    goto done;
  }
  work->flops = s->symbolic->flops;
  work->bytes = 8.0 * (double)s->symbolic->panel[s->symbolic->order->super_count];
done:
  bw_free(rows.upper_start);
  bw_release(reach);
  return status;
}

/* An old factor in single precision, else to all digits that it has. */
static bw_status apply(bw_context *context, bwi_lagged *shared, bool old, const double *r,
                       double *z) {
  bw_status status = BW_OK;
  lagged_symmetric *s = (lagged_symmetric *)shared;
  if (!old)
    return bwi_solve_fields(context, s->factor, NULL, 1, r, z);
  if (!s->triangular)
    BW_TRY(bwi_triangular_solve_create(context, s->factor, &s->triangular));
  bwi_triangular_solve_apply(s->triangular, r, z);
done:
  return status;
}

const bwi_lagged_kind bwi_lagged_symmetric = {sizeof(lagged_symmetric), analyse, factor, apply,
                                              forget_analysis,          forget};
