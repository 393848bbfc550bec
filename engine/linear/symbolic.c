/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* From supernodes of nodes to panels of unknowns. */
#include <string.h>

#include "linear/internal.h"

static void symbolic_destroy(void *object) {
  bwi_symbolic *symbolic = object;
  bw_release(symbolic->order);
  bw_free(symbolic->first);
  bw_free(symbolic->at);
  bw_free(symbolic->panel);
  bw_free(symbolic->rows);
  bwi_plan_clear(&symbolic->plan);
  bw_free(symbolic);
}

static size_t symbolic_bytes(const void *object) {
  const bwi_symbolic *s = object;
  const bwi_order *o = s->order;
  return sizeof *s + (size_t)o->size * 4 + (size_t)o->node_count * (size_t)s->components * 4 +
         (size_t)o->super_count * 24 + (size_t)s->plan.task_count * sizeof(bwi_task);
}

static const bw_kind symbolic_kind = {"symbolic factor", symbolic_destroy, symbolic_bytes};

bool bwi_symbolic_fits(const bwi_symbolic *symbolic, int components, const int32_t *unknown) {
  if (!symbolic || symbolic->components != components)
    return false;
  int64_t entries = (int64_t)symbolic->order->node_count * components;
  for (int64_t i = 0; i < entries; i++)
    if ((symbolic->at[i] >= 0) != (unknown[i] >= 0))
      return false;
  return true;
}

static bw_status number_unknowns(bw_context *context, bwi_symbolic *symbolic,
                                 const int32_t *unknown) {
  const bwi_order *order = symbolic->order;
  int components = symbolic->components;
  int64_t entries = (int64_t)order->node_count * components, wanted = 0;
  for (int64_t i = 0; i < entries; i++) {
    symbolic->at[i] = -1;
    wanted += unknown[i] >= 0;
  }
  int32_t next = 0;
  for (int32_t p = 0; p < order->size; p++) {
    int64_t node = order->node_at[p];
    symbolic->first[p] = next;
    for (int c = 0; c < components; c++)
      if (unknown[node * components + c] >= 0)
        symbolic->at[node * components + c] = next++;
  }
  symbolic->first[order->size] = next;
  symbolic->unknowns = next;
  if (next != wanted)
    return bw_fail(context, BW_INTERNAL, "%lld unknowns lie outside the elimination order",
                   (long long)(wanted - next));
  return BW_OK;
}

bw_status bwi_symbolic_create(bw_context *context, bwi_order *order, int components,
                              const int32_t *unknown, bwi_symbolic **out) {
  bw_status status = BW_OK;
  bwi_symbolic *symbolic = BW_NEW0(context, bwi_symbolic, 1);
  if (!symbolic)
    return BW_MEMORY;
  bw_object_init(symbolic, &symbolic_kind);
  symbolic->order = bw_retain(order);
  symbolic->components = components;
  symbolic->first = BW_NEW(context, int32_t, order->size + 1);
  symbolic->at = BW_NEW(context, int32_t, (int64_t)order->node_count * components);
  symbolic->panel = BW_NEW(context, int64_t, order->super_count + 1);
  symbolic->rows = BW_NEW(context, int32_t, order->super_count);
  BW_TRY_MEMORY(symbolic->first && symbolic->at && symbolic->panel && symbolic->rows);
  BW_TRY(number_unknowns(context, symbolic, unknown));
  symbolic->panel[0] = 0;
  for (int32_t s = 0; s < order->super_count; s++) {
    int64_t rows = 0;
    for (int64_t k = order->row_start[s]; k < order->row_start[s + 1]; k++)
      rows += symbolic->first[order->row[k] + 1] - symbolic->first[order->row[k]];
    int64_t panel = rows * bwi_pivots(symbolic, s);
    symbolic->rows[s] = (int32_t)rows;
    symbolic->panel[s + 1] = symbolic->panel[s] + panel;
    if (rows > symbolic->max_rows)
      symbolic->max_rows = rows;
    if (panel > symbolic->max_panel)
      symbolic->max_panel = panel;
  }
  BW_TRY(bwi_plan_create(context, symbolic, NULL, NULL, &symbolic->plan));
  symbolic->flops = symbolic->plan.flops;
done:
  if (status == BW_OK)
    *out = symbolic;
  else
    bw_release(symbolic);
  return status;
}
