/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* Elastic sheets: making, linear statics. What belongs to a topology or to the nodes is made when
 * it is first needed and dropped when they change (sheet_follow.c). */
#include <math.h>
#include <string.h>

#include "incremental/lagged_factor.h"
#include "linear/vectors.h"
#include "responsive/sheet.h"

static void sheet_destroy(void *object) {
  bw_sheet *sheet = object;
  struct bwi_sheet *inner = sheet->inner;
  if (inner) {
    for (int32_t k = 0; k < inner->section_count && inner->material; k++)
      bw_release(inner->material[k]);
    bw_free(inner->material);
    bw_free(inner->section);
    bw_free(inner->thickness);
    bw_free(inner->condition);
    bw_lagged_factor_destroy(inner->lagged);
    bw_release(inner->pattern);
    bw_free(inner->stiffness);
    bw_free(inner->matrix);
    bw_free(inner->mass);
    bw_free(inner->workspace);
    bw_free(inner->is_prescribed);
    bw_free(inner->prescribed);
    bw_free(inner->force);
    bw_free(inner->rhs);
    bw_free(inner->work);
    bw_release(inner->now);
    bw_free(inner);
  }
  bw_free(sheet);
}

static size_t sheet_bytes(const void *object) {
  const bw_sheet *sheet = object;
  const struct bwi_sheet *inner = sheet->inner;
  size_t bytes = sizeof *sheet + sizeof *inner;
  size_t nodes = (size_t)sheet->mesh->topology->nodes->node_count;
  bytes += bw_bytes(inner->now) + nodes * 8 * (inner->prescribed ? 9 : 0);
  if (inner->pattern)
    bytes += bw_bytes(inner->pattern) + 8 * (9 * (size_t)inner->pattern->block_count +
                                             bwi_plane_workspace_size(inner->pattern, 2));
  return bytes;
}

static const bw_kind kind = {"sheet", sheet_destroy, sheet_bytes};

static bw_status copy_description(bw_context *context, struct bwi_sheet *inner,
                                  const bw_sheet_description *d) {
  inner->section = BW_NEW0(context, bwi_section, d->section_count);
  inner->material = BW_NEW0(context, const bw_material *, d->section_count);
  inner->thickness = BW_NEW(context, double, d->section_count);
  if (!inner->section || !inner->thickness || !inner->material)
    return BW_MEMORY;
  inner->section_count = d->section_count;
  for (int32_t k = 0; k < d->section_count; k++) {
    bw_status status = bwi_section_create(context, &d->section[k], &inner->section[k]);
    if (status != BW_OK)
      return status;
    inner->material[k] = bw_retain(d->section[k].material);
    inner->thickness[k] = d->section[k].thickness;
  }
  inner->condition_count = d->condition_count;
  memcpy(inner->gravity, d->gravity, sizeof inner->gravity);
  return bwi_conditions_copy(context, d->condition_count, d->condition, &inner->condition);
}

bw_status bw_sheet_create(bw_context *context, const bw_plane_mesh *mesh,
                          const bw_sheet_description *description, bw_sheet **out) {
  bw_status status = BW_OK;
  const bw_plane_topology *topology = mesh->topology;
  bw_sheet_state *first = NULL;
  int32_t regions = 0;
  for (int32_t e = 0; e < topology->element_count; e++)
    if (topology->region[e] + 1 > regions)
      regions = topology->region[e] + 1;
  if (description->section_count != 1 && description->section_count < regions)
    return bw_fail(context, BW_INVALID,
                   "%d sections for %d regions: one, or one for each region, expected",
                   description->section_count, regions);
  if (!isfinite(description->gravity[0]) || !isfinite(description->gravity[1]))
    return bw_fail(context, BW_INVALID, "gravity is not finite");
  bw_sheet *sheet = BW_NEW0(context, bw_sheet, 1);
  if (!sheet)
    return BW_MEMORY;
  bw_object_init(sheet, &kind);
  sheet->inner = BW_NEW0(context, struct bwi_sheet, 1);
  BW_TRY_MEMORY(sheet->inner);
  BW_TRY(copy_description(context, sheet->inner, description));
  BW_TRY(bwi_sheet_next(context, sheet, mesh, false, &first));
  first->displacement = BW_NEW0(context, double, 2 * (size_t)topology->nodes->node_count);
  BW_TRY_MEMORY(first->displacement);
  bwi_sheet_adopt(sheet, first);
  BW_TRY(
      bwi_conditions_check(context, mesh, 2, description->condition_count, description->condition));
  BW_TRY(bw_lagged_factor_create(context, true, 2, &sheet->inner->lagged));
done:
  bw_release(first);
  if (status == BW_OK)
    *out = sheet;
  else
    bw_release(sheet);
  return status;
}

/* A drag goes on as it went: from the last solution the guess in inner->work is moved along the
 * last change as far as is best in energy. */
static bw_status extrapolate(bw_context *context, const bw_sheet *sheet, size_t size) {
  bw_status status = BW_OK;
  const struct bwi_sheet *inner = sheet->inner;
  double *workspace = BW_NEW(context, double, 2 * size), along, curvature;
  double *change = workspace, *product = workspace + size;
  if (!workspace)
    return BW_MEMORY;
  for (size_t i = 0; i < size; i++)
    change[i] = inner->is_prescribed[i] ? 0 : sheet->displacement[i] - inner->now->before[i];
  BW_TRY(bw_plane_multiply(context, inner->pattern, 2, inner->matrix, inner->work, product));
  BW_TRY(bwi_subtract_from(context, size, inner->rhs, product, NULL));
  BW_TRY(bwi_blocked_dot(context, size, change, product, &along));
  BW_TRY(bw_plane_multiply(context, inner->pattern, 2, inner->matrix, change, product));
  BW_TRY(bwi_blocked_dot(context, size, change, product, &curvature));
  double length = along / curvature;
  if (curvature > 0 && isfinite(length))
    for (size_t i = 0; i < size; i++)
      inner->work[i] += length * change[i];
done:
  bw_free(workspace);
  return status;
}

bw_status bwi_sheet_statics(bw_context *context, bw_sheet *sheet, bool *made) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = sheet->inner;
  BW_TRY(bwi_sheet_prepare(context, sheet, made));
  inner->matrix_step[0] = 0;
  BW_TRY(bwi_sheet_prescribe(context, sheet, sheet->time));
  if (!inner->prescribed_checked)
    BW_TRY(bwi_sheet_check_constraints(context, sheet));
  inner->prescribed_checked = true;
  BW_TRY(bwi_sheet_force(context, sheet, sheet->time));
  BW_TRY(bwi_sheet_stiffness(context, sheet));
  memcpy(inner->matrix, inner->stiffness, 4 * (size_t)inner->pattern->block_count * sizeof(double));
  memcpy(inner->rhs, inner->force, 2 * (size_t)inner->pattern->node_count * sizeof(double));
  BW_TRY(bw_plane_prescribe(context, inner->pattern, 2, inner->is_prescribed, inner->prescribed,
                            inner->matrix, inner->rhs));
  inner->matrix_step[0] = -1;
done:
  return status;
}

bw_status bw_sheet_static(bw_context *context, bw_sheet *sheet,
                          const bw_lagged_factor_options *options, bw_plane_reuse *reuse) {
  bw_status status = BW_OK;
  struct bwi_sheet *inner = sheet->inner;
  bw_sheet_state *next = NULL;
  bw_plane_reuse ignored = {0};
  bool made;
  reuse = bwi_reuse_of(reuse, &ignored);
  double start = bw_seconds();
  BW_TRY(bwi_sheet_next(context, sheet, sheet->mesh, true, &next));
  BW_TRY(bwi_sheet_statics(context, sheet, &made));
  size_t size = 2 * (size_t)inner->pattern->node_count;
  reuse->pattern = !made;
  reuse->solution = next->solved;
  for (size_t i = 0; i < size; i++)
    inner->work[i] = inner->is_prescribed[i] ? inner->prescribed[i] : sheet->displacement[i];
  if (next->before)
    BW_TRY(extrapolate(context, sheet, size));
  else if (next->solved)
    next->before = BW_NEW(context, double, size);
  if (next->solved && !next->before) {
    status = BW_MEMORY;
    goto done;
  }
  reuse->seconds_assemble += bw_seconds() - start;
  BW_TRY(bw_lagged_factor_solve(context, inner->lagged, inner->pattern, inner->matrix, inner->rhs,
                                inner->work, options, reuse));
  if (next->before)
    memcpy(next->before, sheet->displacement, size * sizeof(double));
  memcpy(next->displacement, inner->work, size * sizeof(double));
  next->solved = next->statics = true;
  next->large = next->moving = false;
  BW_TRY(bwi_sheet_commit(context, sheet, next));
done:
  bw_release(next);
  return status;
}
