/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* What of a mesh's boundary is a cut through the body and no surface of it: no load from outside
 * acts there. */
#include "model/internal.h"

static void mark(const bw_selection *on, uint8_t *mask, bool *any) {
  for (int32_t f = 0; on && f < on->facet_count; f++) {
    mask[on->facet[f]] = 1;
    *any = true;
  }
}

bw_status bw_model_cuts(bw_context *context, const bw_model *model, bw_selection **cuts) {
  bw_status status = BW_OK;
  bool any = false;
  uint8_t *mask = BW_NEW0(context, uint8_t, model->mesh->facet_count);
  *cuts = NULL;
  BW_TRY_MEMORY(mask);
  for (int i = 0; i < model->support_count; i++)
    if (model->support[i].symmetry != BW_NO_SYMMETRY)
      mark(model->support[i].on, mask, &any);
  for (int b = 0; b < model->bond_count; b++)
    mark(model->bond[b].covered, mask, &any);
  if (model->cyclic) {
    mark(model->cyclic->low, mask, &any);
    mark(model->cyclic->high, mask, &any);
  }
  if (any)
    BW_TRY(bw_select_mask(context, model->mesh, mask, NULL, cuts));
done:
  bw_free(mask);
  return status;
}
