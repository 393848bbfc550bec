/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What lagged factors of all kinds share: their life, and which order and analysis they keep. */
#include "incremental/lagged_factor.h"

/* An order under which the work has grown by more than this is recomputed. */
#define MAX_WORK_GROWTH 1.25

bw_status bwi_lagged_create(bw_context *context, const bwi_lagged_kind *kind, int components,
                            bwi_lagged **out) {
  bwi_lagged *s = bw_calloc(context, 1, kind->size);
  if (!s)
    return BW_MEMORY;
  s->kind = kind;
  s->components = components;
  *out = s;
  return BW_OK;
}

static void forget_analysis(bwi_lagged *s) {
  s->kind->forget_analysis(s);
  bw_release(s->topology);
  s->topology = NULL;
}

void bwi_lagged_reset(bwi_lagged *s) {
  if (!s)
    return;
  forget_analysis(s);
  s->kind->forget(s);
  bw_release(s->nodes);
  bw_free(s->permutation);
  s->nodes = NULL;
  s->permutation = NULL;
  s->made = false;
}

void bwi_lagged_destroy(bwi_lagged *s) {
  bwi_lagged_reset(s);
  bw_free(s);
}

bw_status bwi_lagged_adjacency(bw_context *context, const bw_plane_pattern *pattern,
                               bwi_adjacency *near) {
  const bw_block_pattern rows = {
      .node_count = pattern->node_count, .start = pattern->start, .column = pattern->column};
  return near->start ? BW_OK : bwi_adjacency_create(context, &rows, NULL, near);
}

/* Nested dissection makes the better order for large meshes. Approximate minimum degree costs a
 * fifteenth of its time and for meshes up to SMALL nodes its factor takes no longer to make: for
 * those, and for orders that will soon be recomputed. */
enum { SMALL = 30000 };

static bw_status find_order(bw_context *context, bwi_lagged *s, const bw_plane_pattern *pattern,
                            bwi_adjacency *near) {
  bw_status status = BW_OK;
  if (!s->permutation)
    s->permutation = BW_NEW(context, idx_t, pattern->node_count);
  BW_TRY_MEMORY(s->permutation);
  BW_TRY(bwi_lagged_adjacency(context, pattern, near));
  BW_TRY(s->nodes || near->size <= SMALL
             ? bwi_minimum_degree(context, near->size, near->start, near->neighbour, s->permutation)
             : bwi_dissect(context, near->size, near->start, near->neighbour, s->permutation));
done:
  return status;
}

static bw_status analyse(bw_context *context, bwi_lagged *s, const bw_plane_pattern *pattern,
                         const double *values, bwi_lagged_work *work) {
  bw_status status = BW_OK;
  bwi_adjacency near = {0};
  if (s->topology == pattern->topology)
    return BW_OK;
  work->analysed = true;
  forget_analysis(s);
  if (s->nodes != pattern->topology->nodes)
    bwi_lagged_reset(s);
  if (s->nodes)
    BW_TRY(s->kind->analyse(context, s, pattern, values, &near));
  if (!s->nodes || s->flops > MAX_WORK_GROWTH * s->ordered) {
    work->reordered = true;
    forget_analysis(s);
    BW_TRY(find_order(context, s, pattern, &near));
    if (!s->nodes)
      s->nodes = bw_retain(pattern->topology->nodes);
    BW_TRY(s->kind->analyse(context, s, pattern, values, &near));
    s->ordered = s->flops;
  }
  s->topology = bw_retain(pattern->topology);
done:
  bwi_adjacency_clear(&near);
  if (status != BW_OK)
    bwi_lagged_reset(s);
  return status;
}

bw_status bwi_lagged_factor(bw_context *context, bwi_lagged *s, const bw_plane_pattern *pattern,
                            const double *values, bwi_lagged_work *work) {
  bw_status status = BW_OK;
  *work = (bwi_lagged_work){0};
  s->made = false;
  BW_TRY(analyse(context, s, pattern, values, work));
  BW_TRY(bw_check_cancel(context));
  BW_TRY(s->kind->factor(context, s, pattern, values, work));
  s->made = !work->refused;
done:
  return status;
}

bw_status bwi_lagged_apply(bw_context *context, bwi_lagged *s, bool old, const double *r,
                           double *z) {
  return s->made ? s->kind->apply(context, s, old, r, z)
                 : bw_fail(context, BW_INTERNAL, "there is no factor to apply");
}
