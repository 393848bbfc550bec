/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A sheet goes over to another mesh: what may be kept is what belongs to objects that are the same.
 */
#include "responsive/sheet.h"

static void drop(double **block) {
  bw_free(*block);
  *block = NULL;
}

static bw_status carry(bw_context *context, const bw_sheet *sheet, const bw_plane_mesh *mesh,
                       const double *value, double **carried) {
  if (!value)
    return BW_OK;
  *carried = BW_NEW(context, double, 2 * (size_t)mesh->topology->nodes->node_count);
  return *carried ? bw_plane_carry(context, sheet->mesh, mesh, 2, value, *carried) : BW_MEMORY;
}

bw_status bw_sheet_follow(bw_context *context, bw_sheet *sheet, const bw_plane_mesh *mesh,
                          bw_kept *kept) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = sheet->inner;
  const bw_plane_topology *was = sheet->mesh->topology, *now = mesh->topology;
  double *u = NULL, *v = NULL, *a = NULL, start = bw_seconds();
  bw_condition *conditions = NULL;
  bw_level level = mesh == sheet->mesh        ? BW_LEVEL_NONE
                   : now == was               ? BW_LEVEL_RELOCATION
                   : now->nodes == was->nodes ? BW_LEVEL_RECONNECTING
                                              : BW_LEVEL_RECONSTRUCTION;
  if (level != BW_LEVEL_NONE) {
    if (level == BW_LEVEL_RECONSTRUCTION) {
      int32_t regions = 0;
      for (int32_t e = 0; e < now->element_count; e++)
        if (now->region[e] + 1 > regions)
          regions = now->region[e] + 1;
      if (inner->section_count != 1 && inner->section_count < regions)
        return bw_fail(context, BW_INVALID, "%d sections for the %d regions of the new mesh",
                       inner->section_count, regions);
      BW_TRY(bwi_conditions_renamed(context, sheet->mesh->outline, mesh->outline,
                                    inner->condition_count, inner->condition, &conditions));
      BW_TRY(bwi_conditions_check(context, mesh, 2, inner->condition_count, conditions));
    }
    /* With order 1 and the same nodes every value stays with its node. */
    if (level == BW_LEVEL_RECONSTRUCTION ||
        (level == BW_LEVEL_RECONNECTING && now->nodes->order == 2)) {
      BW_TRY(carry(context, sheet, mesh, sheet->displacement, &u));
      BW_TRY(carry(context, sheet, mesh, sheet->velocity, &v));
      BW_TRY(carry(context, sheet, mesh, sheet->acceleration, &a));
    }
    if (conditions) {
      bw_condition *former = inner->condition;
      inner->condition = conditions, conditions = former;
    }
    if (u) {
      drop(&inner->before);
      drop(&inner->former);
      double *swap = sheet->displacement;
      sheet->displacement = u, u = swap;
      swap = sheet->velocity;
      sheet->velocity = v, v = swap;
      swap = sheet->acceleration;
      sheet->acceleration = a, a = swap;
    }
    if (level >= BW_LEVEL_RECONNECTING) {
      bw_release(inner->graph);
      inner->graph = NULL;
      inner->held_checked = false;
      drop(&inner->stiffness);
      drop(&inner->matrix);
      drop(&inner->room);
    }
    if (level == BW_LEVEL_RECONSTRUCTION) {
      drop(&inner->prescribed);
      drop(&inner->force);
      drop(&inner->rhs);
      drop(&inner->work);
      bw_free(inner->held);
      inner->held = NULL;
    }
    drop(&inner->mass);
    inner->stiffness_current = false;
    inner->matrix_step[0] = 0;
    bw_retain(mesh);
    bw_release(sheet->mesh);
    sheet->mesh = mesh;
    sheet->object.revision++;
  }
  if (kept && level > kept->level)
    kept->level = level;
done:
  if (kept)
    kept->seconds_mesh += bw_seconds() - start;
  bw_free(conditions);
  bw_free(u);
  bw_free(v);
  bw_free(a);
  return status;
}
