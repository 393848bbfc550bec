/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A sheet goes over to another mesh. */
#include "responsive/sheet.h"

static bw_status transfer_field(bw_context *context, const bw_sheet *sheet,
                                const bw_plane_mesh *mesh, const double *value,
                                double **transferred) {
  if (!value)
    return BW_OK;
  *transferred = BW_NEW(context, double, 2 * (size_t)mesh->topology->nodes->node_count);
  return *transferred ? bw_plane_transfer(context, sheet->mesh, mesh, 2, value, *transferred)
                      : BW_MEMORY;
}

/* Conditions by the names of tags on the outline of a new mesh, which must have a section for each
 * of its regions. */
static bw_status rename_conditions(bw_context *context, const bw_sheet *sheet,
                                   const bw_plane_mesh *mesh, bw_condition *condition) {
  bw_status status = BW_OK;
  const struct bwi_sheet *inner = sheet->inner;
  const bw_plane_topology *topology = mesh->topology;
  bw_condition *renamed = NULL;
  int32_t regions = 0;
  for (int32_t e = 0; e < topology->element_count; e++)
    if (topology->region[e] + 1 > regions)
      regions = topology->region[e] + 1;
  if (inner->section_count != 1 && inner->section_count < regions)
    return bw_fail(context, BW_INVALID, "%d sections for the %d regions of the new mesh",
                   inner->section_count, regions);
  BW_TRY(bwi_conditions_renamed(context, sheet->mesh->outline, mesh->outline,
                                inner->condition_count, inner->condition, &renamed));
  BW_TRY(bwi_conditions_check(context, mesh, 2, inner->condition_count, renamed));
  for (int32_t i = 0; i < inner->condition_count; i++)
    condition[i] = renamed[i];
done:
  bw_free(renamed);
  return status;
}

bw_status bw_sheet_follow(bw_context *context, bw_sheet *sheet, const bw_plane_mesh *mesh,
                          bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  const bw_plane_topology *was = sheet->mesh->topology, *now = mesh->topology;
  bw_sheet_state *next = NULL;
  double start = bw_seconds();
  bw_level level = mesh == sheet->mesh        ? BW_LEVEL_NONE
                   : now == was               ? BW_LEVEL_RELOCATION
                   : now->nodes == was->nodes ? BW_LEVEL_RECONNECTING
                                              : BW_LEVEL_RECONSTRUCTION;
  if (now->nodes->order != was->nodes->order)
    return bw_fail(context, BW_INVALID, "a mesh of order %d for a sheet of order %d",
                   now->nodes->order, was->nodes->order);
  if (level != BW_LEVEL_NONE) {
    /* With order 1 and the same nodes every value stays with its node. */
    bool stays =
        level == BW_LEVEL_RELOCATION || (level == BW_LEVEL_RECONNECTING && now->nodes->order == 1);
    BW_TRY(bwi_sheet_next(context, sheet, mesh, stays, &next));
    if (level == BW_LEVEL_RECONSTRUCTION)
      BW_TRY(rename_conditions(context, sheet, mesh, next->condition));
    if (!stays) {
      BW_TRY(transfer_field(context, sheet, mesh, sheet->displacement, &next->displacement));
      BW_TRY(transfer_field(context, sheet, mesh, sheet->velocity, &next->velocity));
      BW_TRY(transfer_field(context, sheet, mesh, sheet->acceleration, &next->acceleration));
    }
    next->statics = false;
    BW_TRY(bwi_sheet_commit(context, sheet, next));
  }
  if (reuse && level > reuse->level)
    reuse->level = level;
done:
  bw_release(next);
  if (reuse)
    reuse->seconds_mesh += bw_seconds() - start;
  return status;
}
