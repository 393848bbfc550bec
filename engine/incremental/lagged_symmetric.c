/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Cholesky factors of symmetric positive definite matrices on plane patterns, by the engine's
 * multifrontal factorisation (linear/).
 *
 * A reconnected mesh has the same nodes, and while flips are few the elimination order stays good:
 * only the analysis under it is rebuilt. Flips across separators add fill; an order under which
 * the work has grown by more than BWI_MAX_WORK_GROWTH is recomputed too. Numbers are factored in
 * place where the analysis is kept, since the first touch of new memory costs as much as
 * arithmetic does. */
#include <string.h>

#include "incremental/lagged_factor.h"
#include "incremental/triangular_solve.h"
#include "linear/order.h"

struct bwi_lagged_symmetric {
  int components;
  const bw_plane_nodes *nodes; /* retained: what the order is of */
  int32_t *permutation;
  double ordered;                    /* operations under the order when it was new */
  const bw_plane_topology *topology; /* retained: what symbolic is of */
  bwi_symbolic *symbolic;
  bwi_factor *factor; /* of this symbolic or, until the next factorisation, an older one */
  bwi_triangular_solve *triangular; /* of it; NULL until it pays */
};

bw_status bwi_lagged_symmetric_create(bw_context *context, int components,
                                      bwi_lagged_symmetric **out) {
  bwi_lagged_symmetric *s = BW_NEW0(context, bwi_lagged_symmetric, 1);
  if (!s)
    return BW_MEMORY;
  s->components = components;
  *out = s;
  return BW_OK;
}

static void forget_analysis(bwi_lagged_symmetric *s) {
  bw_release(s->topology);
  bw_release(s->symbolic);
  s->topology = NULL;
  s->symbolic = NULL;
}

void bwi_lagged_symmetric_reset(bwi_lagged_symmetric *s) {
  forget_analysis(s);
  bwi_triangular_solve_destroy(s->triangular);
  s->triangular = NULL;
  bw_release(s->factor);
  bw_release(s->nodes);
  bw_free(s->permutation);
  s->factor = NULL;
  s->nodes = NULL;
  s->permutation = NULL;
}

void bwi_lagged_symmetric_destroy(bwi_lagged_symmetric *s) {
  if (!s)
    return;
  bwi_lagged_symmetric_reset(s);
  bw_free(s);
}

static bw_status adjacency(bw_context *context, const bw_plane_pattern *pattern,
                           bwi_adjacency *near) {
  int32_t nodes = pattern->node_count;
  int64_t entries = pattern->block_count - nodes;
  *near = (bwi_adjacency){.size = nodes, .node_count = nodes};
  if (entries > INT32_MAX)
    return bw_fail(context, BW_LIMIT,
                   "the mesh has %lld pairs of neighbouring nodes: more than the integers of the "
                   "ordering can count",
                   (long long)entries);
  near->start = BW_NEW(context, idx_t, (size_t)nodes + 1);
  near->neighbour = BW_NEW(context, idx_t, entries);
  near->node_of = BW_NEW(context, int32_t, nodes);
  near->compact = BW_NEW(context, int32_t, nodes);
  if (!near->start || !near->neighbour || !near->node_of || !near->compact)
    return BW_MEMORY;
  idx_t count = 0;
  for (int32_t i = 0; i < nodes; i++) {
    near->start[i] = count;
    near->node_of[i] = near->compact[i] = i;
    for (int64_t p = pattern->start[i]; p < pattern->start[i + 1]; p++)
      if (pattern->column[p] != i)
        near->neighbour[count++] = pattern->column[p];
  }
  near->start[nodes] = count;
  return BW_OK;
}

/* Nested dissection makes the better order for large meshes. Approximate minimum degree costs a
 * fifteenth of its time and for meshes up to SMALL nodes its factor takes no longer to make: for
 * those, and (`quick`) for orders that will soon be recomputed. */
enum { SMALL = 30000 };

static bw_status order_nodes(bw_context *context, const bwi_adjacency *near, bool quick,
                             int32_t *permutation) {
  bw_status status = BW_OK;
  idx_t *wide = BW_NEW(context, idx_t, near->size);
  if (!wide)
    return BW_MEMORY;
  BW_TRY(quick || near->size <= SMALL
             ? bwi_minimum_degree(context, near->size, near->start, near->neighbour, wide)
             : bwi_dissect(context, near->size, near->start, near->neighbour, NULL, wide));
  for (idx_t i = 0; i < near->size; i++)
    permutation[i] = (int32_t)wide[i];
done:
  bw_free(wide);
  return status;
}

bw_status bwi_lagged_order(bw_context *context, const bw_plane_pattern *pattern, bool quick,
                           int32_t *permutation) {
  bw_status status = BW_OK;
  bwi_adjacency near = {0};
  BW_TRY(adjacency(context, pattern, &near));
  BW_TRY(order_nodes(context, &near, quick, permutation));
done:
  bwi_adjacency_clear(&near);
  return status;
}

/* The analysis under s->permutation. */
static bw_status analyse_ordered(bw_context *context, bwi_lagged_symmetric *s,
                                 const bwi_adjacency *near, const int32_t *unknown) {
  bw_status status = BW_OK;
  bwi_order *order = NULL;
  idx_t *wide = BW_NEW(context, idx_t, near->size);
  if (!wide)
    return BW_MEMORY;
  for (int32_t i = 0; i < near->size; i++)
    wide[i] = s->permutation[i];
  BW_TRY(bwi_order_analyse(context, near, wide, &order));
  BW_TRY(bwi_symbolic_create(context, order, s->components, unknown, &s->symbolic));
done:
  bw_release(order);
  bw_free(wide);
  return status;
}

static bw_status analyse(bw_context *context, bwi_lagged_symmetric *s,
                         const bw_plane_pattern *pattern, bwi_lagged_work *work) {
  bw_status status = BW_OK;
  bwi_adjacency near = {0};
  int32_t *unknown = NULL;
  if (s->topology == pattern->topology)
    return BW_OK;
  forget_analysis(s);
  work->analysed = true;
  if (s->nodes != pattern->topology->nodes)
    bwi_lagged_symmetric_reset(s);
  BW_TRY(adjacency(context, pattern, &near));
  unknown = BW_NEW0(context, int32_t, (size_t)pattern->node_count * (size_t)s->components);
  if (!unknown) {
    status = BW_MEMORY;
    goto done;
  }
  if (s->nodes)
    BW_TRY(analyse_ordered(context, s, &near, unknown));
  if (!s->nodes || s->symbolic->flops > BWI_MAX_WORK_GROWTH * s->ordered) {
    work->reordered = true;
    bw_release(s->symbolic);
    s->symbolic = NULL;
    if (!s->permutation)
      s->permutation = BW_NEW(context, int32_t, pattern->node_count);
    if (!s->permutation) {
      status = BW_MEMORY;
      goto done;
    }
    BW_TRY(order_nodes(context, &near, s->nodes != NULL, s->permutation));
    BW_TRY(analyse_ordered(context, s, &near, unknown));
    s->ordered = s->symbolic->flops;
    if (!s->nodes)
      s->nodes = bw_retain(pattern->topology->nodes);
  }
  s->topology = bw_retain(pattern->topology);
done:
  bwi_adjacency_clear(&near);
  bw_free(unknown);
  return status;
}

bw_status bwi_lagged_symmetric_factor(bw_context *context, bwi_lagged_symmetric *s,
                                      const bw_plane_pattern *pattern, const double *values,
                                      bwi_lagged_work *work) {
  bw_status status = BW_OK;
  bwi_elimination_reach *reach = NULL;
  bwi_factor *factor = NULL;
  int32_t bad_node = -1;
  *work = (bwi_lagged_work){0};
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
  BW_TRY(analyse(context, s, pattern, work));
  bwi_triangular_solve_destroy(s->triangular);
  s->triangular = NULL;
  if (s->factor && s->factor->symbolic == s->symbolic) {
    status = bwi_factor_update(context, s->factor, &matrix, NULL, NULL, &bad_node);
  } else {
    BW_TRY(bwi_elimination_reach_create_whole(context, s->symbolic, &reach));
    status =
        bwi_factor_create_with_updates(context, s->symbolic, &matrix, reach, &factor, &bad_node);
    bw_release(s->factor);
    s->factor = factor;
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

bw_status bwi_lagged_symmetric_apply(bw_context *context, bwi_lagged_symmetric *s, bool old,
                                     const double *r, double *z) {
  bw_status status = BW_OK;
  if (!s->factor)
    return bw_fail(context, BW_INTERNAL, "there is no factor to apply");
  if (!old)
    return bwi_solve_fields(context, s->factor, NULL, 1, r, z);
  if (!s->triangular)
    BW_TRY(bwi_triangular_solve_create(context, s->factor, &s->triangular));
  bwi_triangular_solve_apply(s->triangular, r, z);
done:
  return status;
}
