/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* A system that follows edits: how it is made, and what it shows. */
#include <string.h>

#include "incremental/incremental.h"

/* ---- the view ------------------------------------------------------------------------------ */

/* What the incremental system shows as a bw_system: it keeps the stiffness alive that it points
 * into. */
typedef struct view {
  bw_system system;
  const bw_subdomain_stiffness *stiffness;
} view;

static void view_destroy(void *object) {
  view *v = object;
  bw_release(v->system.mesh);
  bw_release(v->system.material);
  bw_release(v->system.dof_map);
  bw_release(v->system.pattern);
  bw_release(v->system.factor);
  bw_release(v->stiffness);
  bw_free(v->system.mass);
  bw_free(v);
}

static const bw_kind view_kind = {"system", view_destroy, NULL};

/* ---- life ---------------------------------------------------------------------------------- */

static void inner_free(bwi_incremental *inner) {
  if (!inner)
    return;
  bw_release(inner->rest);
  bw_release(inner->model);
  bw_free(inner->element_subdomain);
  bw_free(inner->node_subdomain);
  bw_free(inner->edit_start);
  bw_free(inner->edit);
  bw_free(inner->motion);
  bw_free(inner->frame);
  bw_free(inner->supports);
  bw_free(inner->touched);
  bw_free(inner->latest);
  bw_free(inner->iterated_on);
  bw_free(inner->factored_frame);
  bw_release(inner->factored);
  bw_release(inner->factored_material);
  bw_release(inner->reach);
  bw_release(inner->factor);
  bw_release(inner->two_level);
  bw_free(inner);
}

static void incremental_destroy(void *object) {
  bw_incremental_system *incremental = object;
  bw_release(incremental->system);
  bw_release(incremental->stiffness);
  inner_free(incremental->inner);
  bw_free(incremental);
}

void bw_incremental_system_memory(const bw_incremental_system *incremental, size_t *factor,
                                  size_t *updates) {
  size_t work = 0;
  *factor = *updates = 0;
  if (incremental->inner->factor) {
    *factor = bwi_factor_bytes(incremental->inner->factor);
    bwi_factor_update_bytes(incremental->inner->factor, updates, &work);
  }
}

size_t bw_incremental_system_two_level_bytes(const bw_incremental_system *incremental) {
  return bw_bytes(incremental->inner->two_level);
}

static size_t incremental_bytes(const void *object) {
  const bw_incremental_system *incremental = object;
  return sizeof *incremental + bw_bytes(incremental->stiffness) +
         bw_bytes(incremental->system->pattern) + bw_bytes(incremental->inner->factor) +
         bw_bytes(incremental->inner->two_level);
}

static const bw_kind incremental_kind = {"incremental system", incremental_destroy,
                                         incremental_bytes};

static bw_status copy_edits(bw_context *context, bwi_incremental *inner, const bw_edits *edits) {
  size_t starts = (size_t)inner->subdomain_count + 1;
  size_t count = (size_t)edits->start[inner->subdomain_count];
  inner->edit_start = BW_NEW(context, int32_t, starts);
  inner->edit = BW_NEW(context, int32_t, count);
  if (!inner->edit_start || !inner->edit)
    return BW_MEMORY;
  memcpy(inner->edit_start, edits->start, starts * sizeof *inner->edit_start);
  memcpy(inner->edit, edits->edit, count * sizeof *inner->edit);
  inner->edits = (bw_edits){edits->count, inner->edit_start, inner->edit};
  return BW_OK;
}

static bw_status inner_create(bw_context *context, const bw_model *model, bool rotate_material,
                              int32_t subdomain_count, const int32_t *element_subdomain,
                              const int32_t *node_subdomain, bwi_incremental **out) {
  size_t elements = (size_t)model->mesh->element_count, nodes = (size_t)model->mesh->node_count;
  size_t subdomains = (size_t)subdomain_count;
  bwi_incremental *inner = BW_NEW0(context, bwi_incremental, 1);
  if (!inner)
    return BW_MEMORY;
  inner->rest = bw_retain(model);
  inner->model = bw_retain(model);
  inner->rotate_material = rotate_material;
  inner->subdomain_count = subdomain_count;
  inner->element_subdomain = BW_NEW(context, int32_t, elements);
  inner->node_subdomain = BW_NEW(context, int32_t, nodes);
  inner->motion = BW_NEW0(context, bw_subdomain_motion, subdomains);
  inner->frame = BW_NEW(context, double, 9 * subdomains);
  inner->factored_frame = BW_NEW0(context, double, 9 * subdomains);
  inner->touched = BW_NEW0(context, uint8_t, subdomains);
  inner->latest = BW_NEW0(context, uint8_t, subdomains);
  inner->iterated_on = BW_NEW0(context, uint8_t, subdomains);
  inner->iteration_ratio = 1;
  if (!inner->element_subdomain || !inner->node_subdomain || !inner->motion || !inner->frame ||
      !inner->factored_frame || !inner->touched || !inner->latest || !inner->iterated_on) {
    inner_free(inner);
    return BW_MEMORY;
  }
  memcpy(inner->element_subdomain, element_subdomain, elements * sizeof *element_subdomain);
  memcpy(inner->node_subdomain, node_subdomain, nodes * sizeof *node_subdomain);
  for (size_t d = 0; d < subdomains; d++) {
    bw_subdomain_motion_rest(&inner->motion[d]);
    memcpy(inner->frame + 9 * d, inner->motion[d].frame, 9 * sizeof *inner->frame);
  }
  *out = inner;
  return BW_OK;
}

static bw_status check_subdomains(bw_context *context, const bw_mesh *mesh, int32_t subdomain_count,
                                  const int32_t *element_subdomain, const int32_t *node_subdomain,
                                  const bw_edits *edits) {
  if (subdomain_count < 1)
    return bw_fail(context, BW_INVALID, "%d subdomains: at least one expected", subdomain_count);
  for (int32_t e = 0; e < mesh->element_count; e++)
    if (element_subdomain[e] < 0 || element_subdomain[e] >= subdomain_count)
      return bw_fail(context, BW_INVALID,
                     "element %d is in subdomain %d: the subdomains are 1 to %d", e + 1,
                     element_subdomain[e] + 1, subdomain_count);
  for (int32_t i = 0; i < mesh->node_count; i++)
    if (node_subdomain[i] < -1 || node_subdomain[i] >= subdomain_count)
      return bw_fail(context, BW_INVALID, "node %d is in subdomain %d: the subdomains are 1 to %d",
                     i + 1, node_subdomain[i] + 1, subdomain_count);
  for (int32_t k = 0; edits && k < edits->start[subdomain_count]; k++)
    if (edits->edit[k] < 0 || edits->edit[k] >= edits->count)
      return bw_fail(context, BW_INVALID,
                     "entry %d of the list names edit %d: the edits are 1 to %d", k + 1,
                     edits->edit[k] + 1, edits->count);
  return BW_OK;
}

static bw_status view_create(bw_context *context, const bw_model *model, bw_system **out) {
  view *made = BW_NEW0(context, view, 1);
  if (!made)
    return BW_MEMORY;
  bw_object_init(made, &view_kind);
  made->system.mesh = bw_retain(model->mesh);
  made->system.material = bw_retain(model->material);
  *out = &made->system;
  return BW_OK;
}

/* ---- making -------------------------------------------------------------------------------- */

bw_status bw_incremental_system_create(bw_context *context, const bw_model *model,
                                       bool rotate_material, int32_t subdomain_count,
                                       const int32_t *element_subdomain,
                                       const int32_t *node_subdomain, const bw_edits *edits,
                                       bw_incremental_system **out) {
  bw_status status = BW_OK;
  bw_incremental_system *incremental = NULL;
  bw_dof_map *dof_map = NULL;
  bw_subdomain_stiffness *stiffness = NULL;
  bool same;
  BW_TRY(check_subdomains(context, model->mesh, subdomain_count, element_subdomain, node_subdomain,
                          edits));
  incremental = BW_NEW0(context, bw_incremental_system, 1);
  if (!incremental)
    return BW_MEMORY;
  bw_object_init(incremental, &incremental_kind);
  BW_TRY(view_create(context, model, &incremental->system));
  BW_TRY(inner_create(context, model, rotate_material, subdomain_count, element_subdomain,
                      node_subdomain, &incremental->inner));
  bwi_incremental *inner = incremental->inner;
  if (edits)
    BW_TRY(copy_edits(context, inner, edits));
  bw_system *system = incremental->system;
  BW_TRY(bw_dof_map_follow(context, model, NULL, subdomain_count, node_subdomain, inner->frame,
                           &same, &dof_map));
  system->dof_map = dof_map;
  BW_TRY(bwi_incremental_supports(context, incremental, dof_map, inner->frame, &inner->supports));
  double start = bw_seconds();
  BW_TRY(bw_block_pattern_create(context, model->mesh, &system->pattern));
  system->times.pattern = bw_seconds() - start;
  start = bw_seconds();
  BW_TRY(bw_subdomain_stiffness_create(context, system->pattern, model->mesh, model->material,
                                       rotate_material, subdomain_count, element_subdomain,
                                       node_subdomain, &stiffness));
  incremental->stiffness = stiffness;
  system->stiffness = stiffness->values;
  ((view *)system)->stiffness = bw_retain(stiffness);
  system->times.stiffness = bw_seconds() - start;
  BW_TRY(bwi_incremental_factor(context, incremental, false, NULL));
done:
  if (status == BW_OK)
    *out = incremental;
  else
    bw_release(incremental);
  return status;
}
