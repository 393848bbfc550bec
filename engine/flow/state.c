/* Copyright (C) 2026 the barwright authors. Licence: AGPL-3.0-or-later. */
/* The states of a flow, each immutable once it stands: kept and returned to bit for bit. Solving
 * again would take as long as the first time, and may end elsewhere: a steady flow need not be the
 * only one. */
#include <math.h>

#include "flow/internal.h"
#include "responsive/internal.h"

static void destroy(void *object) {
  bw_flow_state *s = object;
  bw_release(s->mesh);
  bw_release(s->pattern);
  bw_free(s->condition);
  bw_free(s->state);
  bw_free(s->before);
  bw_free(s->reaction);
  bw_free(s->old_point);
  bw_free(s->older_point);
  bw_free(s);
}

static size_t bytes(const void *object) {
  const bw_flow_state *s = object;
  size_t nodes = (size_t)s->mesh->topology->nodes->node_count;
  return sizeof *s + nodes * sizeof(double) * (3 * (size_t)s->components + 4);
}

static const bw_kind kind = {"flow state", destroy, bytes};

bw_status bwi_flow_blank(bw_context *context, const bw_flow *flow, const bw_plane_mesh *mesh,
                         const bw_plane_pattern *pattern, bw_flow_state **state) {
  const struct bwi_flow *in = flow->inner;
  bw_flow_state *s = BW_NEW0(context, bw_flow_state, 1);
  if (!s)
    return BW_MEMORY;
  bw_object_init(s, &kind);
  s->mesh = bw_retain(mesh);
  s->pattern = bw_retain(pattern);
  s->components = flow->components;
  s->time = flow->time;
  s->known = 1;
  s->condition_count = in->about.condition_count;
  bw_status status = bwi_conditions_copy(context, s->condition_count, in->condition, &s->condition);
  if (status == BW_OK)
    *state = s;
  else
    bw_release(s);
  return status;
}

bw_status bwi_flow_next(bw_context *context, const bw_flow *flow, bw_flow_state **next) {
  bw_status status = BW_OK;
  const bw_flow_state *now = flow->inner->now;
  size_t nodes = (size_t)now->mesh->topology->nodes->node_count;
  size_t unknowns = nodes * (size_t)now->components;
  bw_flow_state *s = NULL;
  BW_TRY(bwi_flow_blank(context, flow, now->mesh, now->pattern, &s));
  s->known = now->known;
  s->reacted = now->reacted;
  s->last_step = now->last_step;
  BW_TRY(bwi_copy_block(context, now->state, unknowns, &s->state));
  BW_TRY(bwi_copy_block(context, now->before, unknowns, &s->before));
  BW_TRY(bwi_copy_block(context, now->reaction, unknowns, &s->reaction));
  BW_TRY(bwi_copy_block(context, now->old_point, 2 * nodes, &s->old_point));
  BW_TRY(bwi_copy_block(context, now->older_point, 2 * nodes, &s->older_point));
  *next = s;
  s = NULL;
done:
  bw_release(s);
  return status;
}

void bwi_flow_adopt(bw_flow *flow, const bw_flow_state *state) {
  struct bwi_flow *in = flow->inner;
  const bw_flow_state *former = in->now;
  if (former && former->pattern != state->pattern)
    bwi_flow_workspace_clear(&in->workspace);
  if (former && former->mesh != state->mesh) {
    bw_plane_locator_destroy(in->locator);
    in->locator = NULL;
  }
  in->now = bw_retain(state);
  bwi_conditions_take_tags(in->about.condition_count, state->condition, in->condition);
  flow->mesh = state->mesh;
  flow->state = state->state;
  flow->before = state->before;
  flow->time = state->time;
  flow->object.revision++;
  bw_release(former);
}

bw_status bwi_flow_commit(bw_context *context, bw_flow *flow, const bw_flow_state *next) {
  bw_status status = bw_check_cancel(context);
  if (status == BW_OK)
    bwi_flow_adopt(flow, next);
  return status;
}

const bw_flow_state *bw_flow_keep(const bw_flow *flow) {
  return bw_retain(flow->inner->now);
}

/* Conditions stay the flow's own but for their tags: what was kept may outlive its flow, and what
 * their functions stand on. */
static bool fits(const bw_flow *flow, const bw_flow_state *s) {
  const struct bwi_flow *in = flow->inner;
  return s->components == flow->components && s->condition_count == in->about.condition_count &&
         bwi_conditions_alike(s->condition_count, s->condition, in->condition);
}

bw_status bw_flow_return(bw_context *context, bw_flow *flow, const bw_flow_state *state) {
  if (!fits(flow, state))
    return bw_fail(context, BW_INVALID, "the state is that of another flow");
  if (state != flow->inner->now)
    bwi_flow_adopt(flow, state);
  return BW_OK;
}

static bw_status check_field(bw_context *context, const char *what, const double *field,
                             size_t count) {
  for (size_t i = 0; field && i < count; i++)
    if (!isfinite(field[i]))
      return bw_fail(context, BW_INTERNAL, "number %zu of a flow's %s is %g", i, what, field[i]);
  return BW_OK;
}

bw_status bw_flow_check(bw_context *context, const bw_flow *flow) {
  bw_status status = BW_OK;
  const struct bwi_flow *in = flow->inner;
  const bw_flow_state *now = in->now;
  const bw_plane_topology *topology = now->mesh->topology;
  size_t nodes = (size_t)topology->nodes->node_count, unknowns = nodes * (size_t)now->components;
  BW_TRY(bw_plane_mesh_check(context, now->mesh));
  for (int i = 0; i < in->about.condition_count; i++)
    if (in->condition[i].tag >= now->mesh->outline->tag_count)
      return bw_fail(context, BW_INTERNAL, "condition %d of a flow is on tag %d of %d", i + 1,
                     in->condition[i].tag + 1, now->mesh->outline->tag_count);
  BW_TRY(check_field(context, "state", now->state, unknowns));
  BW_TRY(check_field(context, "state before", now->before, unknowns));
  BW_TRY(check_field(context, "reactions", now->reaction, unknowns));
  BW_TRY(check_field(context, "former places", now->old_point, 2 * nodes));
  BW_TRY(check_field(context, "places before that", now->older_point, 2 * nodes));
  if (flow->mesh != now->mesh || flow->state != now->state || flow->before != now->before ||
      flow->time != now->time || flow->components != now->components || !isfinite(now->time))
    status = bw_fail(context, BW_INTERNAL, "a flow has other fields than its state");
  else if (now->pattern->topology != topology || topology->nodes->order != 1 || !now->state ||
           !now->before || !now->reaction || now->known < 1 || now->known > 2 ||
           (now->known == 2 && !(now->last_step > 0)))
    status = bw_fail(context, BW_INTERNAL, "a flow's fields do not go together");
done:
  return status;
}
