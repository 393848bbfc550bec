/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Direct solutions: the engine's multifrontal factor on a solid's pattern.
 *
 * Invariants: `symbolic` is of `pattern` and `constrained`, all NULL before the first analysis;
 * `factor`, when there is one, is of `symbolic`, and its numbers are to be used while `usable`. */
#include "nonlinear/direct.h"

#include <string.h>

#include "linear/order.h"

struct bwi_direct {
  const bw_block_pattern *pattern; /* retained */
  uint8_t *constrained;            /* 3 pattern->node_count */
  bwi_symbolic *symbolic;
  bwi_factor *factor;
  bool usable;
};

bw_status bwi_direct_create(bw_context *context, bwi_direct **out) {
  bwi_direct *direct = BW_NEW0(context, bwi_direct, 1);
  if (!direct)
    return BW_MEMORY;
  *out = direct;
  return BW_OK;
}

static void forget(bwi_direct *direct) {
  bw_release(direct->factor);
  bw_release(direct->symbolic);
  bw_release(direct->pattern);
  bw_free(direct->constrained);
  *direct = (bwi_direct){0};
}

void bwi_direct_destroy(bwi_direct *direct) {
  if (!direct)
    return;
  forget(direct);
  bw_free(direct);
}

size_t bwi_direct_bytes(const bwi_direct *direct) {
  return direct ? sizeof *direct + bw_bytes(direct->symbolic) + bw_bytes(direct->factor) : 0;
}

/* Nested dissection makes the better order; for so few nodes minimum degree takes a fraction of its
 * time and the factor is made as fast. */
enum { SMALL = 1000 };

static bw_status order_nodes(bw_context *context, const bw_block_pattern *pattern,
                             const uint8_t *take, bwi_order **order) {
  bw_status status = BW_OK;
  bwi_adjacency near = {0};
  idx_t *permutation = NULL;
  if (pattern->node_count > SMALL)
    return bwi_order_create(context, pattern, take, order);
  BW_TRY(bwi_adjacency_create(context, pattern, take, &near));
  permutation = BW_NEW(context, idx_t, near.size);
  BW_TRY_MEMORY(permutation);
  BW_TRY(bwi_minimum_degree(context, near.size, near.start, near.neighbour, permutation));
  BW_TRY(bwi_order_analyse(context, &near, permutation, order));
done:
  bwi_adjacency_clear(&near);
  bw_free(permutation);
  return status;
}

/* Patterns of the same elements are the same, whichever solid they were made for. */
static bool same_pattern(const bw_block_pattern *a, const bw_block_pattern *b) {
  return a == b ||
         (a->node_count == b->node_count && a->block_count == b->block_count &&
          memcmp(a->start, b->start, ((size_t)a->node_count + 1) * sizeof *a->start) == 0 &&
          memcmp(a->column, b->column, (size_t)a->block_count * sizeof *a->column) == 0);
}

bool bwi_direct_keeps(const bwi_direct *direct, const bw_block_pattern *pattern,
                      const uint8_t *constrained) {
  return direct->symbolic && same_pattern(direct->pattern, pattern) &&
         memcmp(direct->constrained, constrained, 3 * (size_t)pattern->node_count) == 0;
}

bw_status bwi_direct_analyse(bw_context *context, bwi_direct *direct,
                             const bw_block_pattern *pattern, const uint8_t *constrained) {
  bw_status status = BW_OK;
  size_t nodes = (size_t)pattern->node_count, size = 3 * nodes;
  uint8_t *take = NULL;
  int32_t *unknown = NULL, count = 0;
  bwi_order *order = NULL;
  if (bwi_direct_keeps(direct, pattern, constrained))
    return BW_OK;
  forget(direct);
  take = BW_NEW0(context, uint8_t, nodes);
  unknown = BW_NEW(context, int32_t, size);
  direct->constrained = BW_NEW(context, uint8_t, size);
  BW_TRY_MEMORY(take && unknown && direct->constrained);
  memcpy(direct->constrained, constrained, size);
  for (size_t i = 0; i < size; i++) {
    unknown[i] = constrained[i] ? -1 : count++;
    take[i / 3] = (uint8_t)(take[i / 3] | !constrained[i]);
  }
  if (count == 0)
    BW_TRY(bw_fail(context, BW_INTERNAL, "a matrix without unknowns cannot be factorised"));
  BW_TRY(order_nodes(context, pattern, take, &order));
  BW_TRY(bwi_symbolic_create(context, order, 3, unknown, &direct->symbolic));
  direct->pattern = bw_retain(pattern);
done:
  if (status != BW_OK)
    forget(direct);
  bw_release(order);
  bw_free(take);
  bw_free(unknown);
  return status;
}

bool bwi_direct_count(const bwi_direct *direct, double *flops, double *entries) {
  const bwi_symbolic *symbolic = direct->symbolic;
  if (!symbolic)
    return false;
  *flops = symbolic->flops;
  *entries = (double)symbolic->panel[symbolic->order->super_count];
  return true;
}

bw_status bwi_direct_factor(bw_context *context, bwi_direct *direct,
                            const bw_block_pattern *pattern, const uint8_t *constrained,
                            const double *stiffness, bool *definite, int32_t *node) {
  bw_status status = BW_OK;
  bwi_elimination_reach *reach = NULL;
  bwi_matrix matrix = {.pattern = pattern, .stiffness = stiffness};
  int32_t bad_node = -1;
  direct->usable = false;
  *definite = false;
  BW_TRY(bwi_direct_analyse(context, direct, pattern, constrained));
  if (direct->factor)
    status = bwi_factor_update(context, direct->factor, &matrix, NULL, NULL, &bad_node);
  else {
    BW_TRY(bwi_elimination_reach_create_whole(context, direct->symbolic, &reach));
    status = bwi_factor_create_in(context, direct->symbolic, &matrix, reach, &bwi_kernels_double,
                                  &direct->factor, &bad_node);
  }
  if (status == BW_SINGULAR) {
    bw_clear_failure(context);
    status = BW_OK;
    if (node)
      *node = bad_node;
  } else if (status == BW_OK)
    direct->usable = *definite = true;
done:
  bw_release(reach);
  return status;
}

bw_status bwi_direct_solve(bw_context *context, const bwi_direct *direct, const double *force,
                           double *displacement) {
  if (!direct->usable)
    return bw_fail(context, BW_INTERNAL, "there is no factor to solve with");
  return bwi_solve_fields(context, direct->factor, NULL, 1, force, displacement);
}
