/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The states of a sheet: each immutable once it stands. */
#include <math.h>

#include "responsive/sheet.h"

static void destroy(void *object) {
  bw_sheet_state *s = object;
  bw_release(s->mesh);
  bw_free(s->condition);
  bw_free(s->displacement);
  bw_free(s->velocity);
  bw_free(s->acceleration);
  bw_free(s->before);
  bw_free(s->former);
  bw_free(s);
}

static size_t bytes(const void *object) {
  const bw_sheet_state *s = object;
  size_t fields = 1 + 2 * (s->velocity != NULL) + (s->before != NULL) + (s->former != NULL);
  return sizeof *s + (size_t)s->mesh->topology->nodes->node_count * 2 * sizeof(double) * fields;
}

static const bw_kind kind = {"sheet state", destroy, bytes};

bw_status bwi_sheet_next(bw_context *context, const bw_sheet *sheet, const bw_plane_mesh *mesh,
                         bool fields, bw_sheet_state **next) {
  bw_status status = BW_OK;
  const struct bwi_sheet *inner = sheet->inner;
  const bw_sheet_state *now = inner->now;
  size_t size = 2 * (size_t)mesh->topology->nodes->node_count;
  bw_sheet_state *s = BW_NEW0(context, bw_sheet_state, 1);
  if (!s)
    return BW_MEMORY;
  bw_object_init(s, &kind);
  s->mesh = bw_retain(mesh);
  s->time = sheet->time;
  s->condition_count = inner->condition_count;
  BW_TRY(bwi_conditions_copy(context, s->condition_count, inner->condition, &s->condition));
  if (now) {
    s->solved = now->solved;
    s->statics = now->statics;
    s->large = now->large;
    s->moving = now->moving;
  }
  if (now && fields) {
    BW_TRY(bwi_copy_block(context, now->displacement, size, &s->displacement));
    BW_TRY(bwi_copy_block(context, now->velocity, size, &s->velocity));
    BW_TRY(bwi_copy_block(context, now->acceleration, size, &s->acceleration));
    BW_TRY(bwi_copy_block(context, now->before, size, &s->before));
    BW_TRY(bwi_copy_block(context, now->former, size, &s->former));
  }
done:
  if (status == BW_OK)
    *next = s;
  else
    bw_release(s);
  return status;
}

static void drop(double **block) {
  bw_free(*block);
  *block = NULL;
}

/* What is kept belongs to objects that are the same. */
static void drop_what_is_of(struct bwi_sheet *inner, const bw_plane_mesh *was,
                            const bw_plane_mesh *now) {
  if (now == was)
    return;
  drop(&inner->mass);
  inner->stiffness_current = false;
  inner->matrix_step[0] = 0;
  if (now->topology == was->topology)
    return;
  bw_release(inner->pattern);
  inner->pattern = NULL;
  inner->prescribed_checked = false;
  drop(&inner->stiffness);
  drop(&inner->matrix);
  drop(&inner->workspace);
  if (now->topology->nodes == was->topology->nodes)
    return;
  drop(&inner->prescribed);
  drop(&inner->force);
  drop(&inner->rhs);
  drop(&inner->work);
  bw_free(inner->is_prescribed);
  inner->is_prescribed = NULL;
}

void bwi_sheet_adopt(bw_sheet *sheet, const bw_sheet_state *state) {
  struct bwi_sheet *inner = sheet->inner;
  const bw_sheet_state *former = inner->now;
  if (former)
    drop_what_is_of(inner, former->mesh, state->mesh);
  inner->now = bw_retain(state);
  bwi_conditions_take_tags(inner->condition_count, state->condition, inner->condition);
  sheet->mesh = state->mesh;
  sheet->displacement = state->displacement;
  sheet->velocity = state->velocity;
  sheet->acceleration = state->acceleration;
  sheet->time = state->time;
  sheet->object.revision++;
  bw_release(former);
}

bw_status bwi_sheet_commit(bw_context *context, bw_sheet *sheet, const bw_sheet_state *next) {
  bw_status status = bw_check_cancel(context);
  if (status == BW_OK)
    bwi_sheet_adopt(sheet, next);
  return status;
}

const bw_sheet_state *bw_sheet_keep(const bw_sheet *sheet) {
  return bw_retain(sheet->inner->now);
}

/* Conditions stay the sheet's own but for their tags: a state may outlive its sheet, and what their
 * functions stand on. */
bw_status bw_sheet_return(bw_context *context, bw_sheet *sheet, const bw_sheet_state *state) {
  const struct bwi_sheet *inner = sheet->inner;
  bool fits = state->condition_count == inner->condition_count &&
              state->mesh->topology->nodes->order == sheet->mesh->topology->nodes->order &&
              bwi_conditions_alike(inner->condition_count, state->condition, inner->condition);
  if (!fits)
    return bw_fail(context, BW_INVALID, "the state is that of another sheet");
  if (state != inner->now)
    bwi_sheet_adopt(sheet, state);
  return BW_OK;
}

static bw_status check_field(bw_context *context, const char *what, const double *field,
                             size_t count) {
  for (size_t i = 0; field && i < count; i++)
    if (!isfinite(field[i]))
      return bw_fail(context, BW_INTERNAL, "the %s of node %zu is %g", what, i / 2 + 1, field[i]);
  return BW_OK;
}

bw_status bw_sheet_check(bw_context *context, const bw_sheet *sheet) {
  bw_status status = BW_OK;
  const struct bwi_sheet *inner = sheet->inner;
  const bw_sheet_state *now = inner->now;
  const bw_plane_topology *topology = now->mesh->topology;
  size_t size = 2 * (size_t)topology->nodes->node_count;
  BW_TRY(bw_plane_mesh_check(context, now->mesh));
  BW_TRY(bwi_conditions_check(context, now->mesh, 2, inner->condition_count, inner->condition));
  BW_TRY(check_field(context, "displacement", now->displacement, size));
  BW_TRY(check_field(context, "velocity", now->velocity, size));
  BW_TRY(check_field(context, "acceleration", now->acceleration, size));
  BW_TRY(check_field(context, "former displacement", now->before, size));
  BW_TRY(check_field(context, "displacement before that", now->former, size));
  if (sheet->mesh != now->mesh || sheet->displacement != now->displacement ||
      sheet->velocity != now->velocity || sheet->acceleration != now->acceleration ||
      sheet->time != now->time || !isfinite(now->time))
    status = bw_fail(context, BW_INTERNAL, "a sheet has other fields than its state");
  else if (!now->displacement || !now->velocity != !now->acceleration ||
           (now->former && !now->before) || (now->moving && !now->velocity) ||
           (now->statics && (now->large || now->moving || !now->solved)))
    status = bw_fail(context, BW_INTERNAL, "a sheet's fields do not go together");
  else if ((inner->pattern && inner->pattern->topology != topology) ||
           (inner->matrix_step[0] < 0 && !inner->stiffness_current) ||
           (inner->stiffness_current && !inner->pattern))
    status = bw_fail(context, BW_INTERNAL, "a sheet's matrices are of another mesh");
done:
  return status;
}
